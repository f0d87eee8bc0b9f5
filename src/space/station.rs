//! Stations: the cases of a study, compiled ([`posed`](super::posed)). A station has everything about a pose that does not
//! depend on the design.
//!
//! Twists and wrenches are taken about the world's origin, so that what an option does can be tabulated once and then
//! added for every design that has it.
//!
//! A pose is *planar* if every joint axis, link and load in it is symmetric about the x-z plane. Then the motions within
//! the plane (x, z, rotation about y) and those across it (y, rotations about x and z) do not couple. The lowest mode is
//! then found in two blocks of three motions instead of one block of six, which is less work.

use super::design_space::{Case, DesignSpace, SpacePiece};
use super::effects::{Carried, Carrier, Layer};
use crate::arm::body::RigidBody;
use crate::arm::load::Water;
use crate::arm::springs::{ElementFrame, EndLoad, end_loads};
use crate::mechanics::lowest::BlockLink;
use crate::mechanics::{Twist, Wrench, angular, body_inertia, force_wrench, linear, stack};
use nalgebra::{Matrix3, Matrix3x6, Matrix6, Rotation3, SMatrix, SVector, Vector3, Vector6};

/// A pose with its load, compiled for the slots of an arm.
pub(crate) struct Station {
    /// Each slot in this pose, tip first.
    pub slots: Vec<StationSlot>,
    /// The same slots as the pass for the lowest mode needs them.
    pub modal: Modal,
    /// Payload and tip force, as a wrench.
    pub start_wrench: Wrench,
    /// Inertia of the payload.
    pub start_inertia: Matrix6<f64>,
    /// Direction of gravity in the world.
    pub down: Vector3<f64>,
}

/// What the search adds in one step, in a pose.
pub(crate) enum StationSlot {
    /// A joint.
    Joint(StationJoint),
    /// A rigid body: a point mass, or a rigid offset with the harness along it.
    Body { inertia: Matrix6<f64>, weight: Wrench },
    /// A tube, with one entry for each option.
    Link { options: Vec<StationLink>, place: Place, carried: OnTube },
}

/// The bodies on a tube in a pose and what springs do to it, as they are if the tube does not yield. They have slots of their
/// own inboard of the tube; what they add to the bending of the tube is in its options.
pub(crate) struct OnTube {
    pub inertia: Matrix6<f64>,
    pub weight: Wrench,
    /// Whether every body is symmetric about the x-z plane.
    pub is_symmetric: bool,
    /// The weight of each body and the pull of each spring.
    pub loads: Vec<OnAxis>,
    /// Where springs pull, and their force and moment about that place of the axis in the section frame.
    pub pulls: Vec<(f64, Wrench)>,
}

/// What acts on a tube at a place of its axis.
pub(crate) struct OnAxis {
    /// The place, 0 at the root and 1 at the end.
    pub xi: f64,
    /// Force and moment about the world's origin.
    pub wrench: Wrench,
}

impl OnTube {
    /// Where springs pull on the tube, and the load of everything outboard of that place about the world's origin: without
    /// and with what acts there. `outboard` is the load on the end of the tube, `own` its own weight.
    pub(crate) fn at_pulls(
        &self,
        place: &Place,
        outboard: &Wrench,
        own: &Wrench,
    ) -> impl Iterator<Item = (Vector3<f64>, [Wrench; 2])> {
        let along_m = place.end_m - place.root_m;
        self.pulls.iter().map(move |(xi, _)| {
            let middle_m = place.root_m + along_m * ((1.0 + xi) / 2.0);
            let beyond = outboard + force_wrench(&(linear(own) * (1.0 - xi)), &middle_m);
            let sum = |acts: fn(f64, f64) -> bool| {
                self.loads.iter().filter(|load| acts(load.xi, *xi)).map(|load| load.wrench).sum::<Wrench>()
            };
            let loads = [beyond + sum(|load, here| load > here), beyond + sum(|load, here| load >= here)];
            (place.root_m + along_m * *xi, loads)
        })
    }
}

/// A joint in a pose.
pub(crate) struct StationJoint {
    /// Motion of everything outboard per radian of the joint's rotation.
    pub twist: Twist,
    /// Where the joint is.
    pub at_m: Vector3<f64>,
    /// Displacement of the tip per radian.
    pub tip_m_per_rad: Vector3<f64>,
    /// Angle of the joint \[rad\].
    pub angle_rad: f64,
    /// Torque that acts on the joint beside weight and load \[N m\].
    pub own_nm: f64,
    /// Inertia and weight of one kilogram at the joint.
    pub inertia_per_kg: Matrix6<f64>,
    pub weight_per_kg: Wrench,
    /// The block in which the joint moves the arm: 0 within the plane, 1 across it.
    pub block: usize,
    /// What a linkage turns together with the joint, each with the slot of the passive joint. All of them are outboard.
    pub turns: Vec<Turned>,
    /// Whether a linkage turns the joint.
    pub is_passive: bool,
}

/// A passive joint as its driver turns it.
pub(crate) struct Turned {
    pub slot: usize,
    /// Motion of everything outboard of the passive joint per radian of the driver.
    pub twist: Twist,
    /// Displacement of the tip by the passive joint per radian of the driver.
    pub tip_m_per_rad: Vector3<f64>,
    /// What the passive joint's own torque is on the driver \[N m\].
    pub own_nm: f64,
}

/// Where a link is in a pose.
pub(crate) struct Place {
    pub root_m: Vector3<f64>,
    pub centre_m: Vector3<f64>,
    pub end_m: Vector3<f64>,
    /// Section frame in the world: columns x (along the link), y and z.
    pub frame: Matrix3<f64>,
}

impl Place {
    /// Axial force \[N\], torsion and both bending moments \[N m\] of a wrench at a point of the link.
    pub(crate) fn local(&self, wrench: &Wrench, at_m: &Vector3<f64>) -> [f64; 4] {
        let force = self.frame.tr_mul(&linear(wrench));
        let moment = self.frame.tr_mul(&(angular(wrench) - at_m.cross(&linear(wrench))));
        [force.x, moment.x, moment.y, moment.z]
    }
}

/// One option of a link in a pose.
///
/// The end coordinates are the six motions of the condensed link's end, scaled to unit stiffness
/// ([`condensed`](crate::mechanics::condensed)).
pub(crate) struct StationLink {
    /// Inertia of the link as a rigid body.
    pub inertia: Matrix6<f64>,
    pub weight: Wrench,
    /// Twist of everything outboard per end coordinate.
    pub end: Matrix6<f64>,
    /// End coordinates under the link's own weight.
    pub own_weight_end: Vector6<f64>,
    /// Displacement of the tip per end coordinate.
    pub tip: Matrix3x6<f64>,
    /// Inertia of the link itself in each end coordinate.
    pub end_inertia: Vector6<f64>,
    /// Block of each end coordinate.
    pub block: [usize; 6],
    /// Sum of `1/λ` over the inner modes \[s²\].
    pub inner_trace_s2: f64,
}

impl StationLink {
    /// Its net weight, along the direction of gravity \[N\].
    pub(crate) fn weight_n(&self, down: &Vector3<f64>) -> f64 {
        down.dot(&linear(&self.weight))
    }

    /// Displacement of the tip per unit of the wrench on the link's end.
    pub(crate) fn flexibility(&self) -> Matrix3x6<f64> {
        // the end coordinates have unit stiffness: a wrench w deflects them by endᵀ w
        self.tip * self.end.transpose()
    }

    /// Displacement of the tip by the link's own weight \[m\].
    pub(crate) fn own_weight_deflection_m(&self) -> Vector3<f64> {
        self.tip * self.own_weight_end
    }
}

/// The slots as the pass for the lowest mode sees them: in two blocks if the pose is planar, else in one.
pub(crate) enum Modal {
    Planar(Box<[Block<3>; 2]>),
    Spatial(Box<Block<6>>),
}

/// The slots restricted to `N` of the six motions.
pub(crate) struct Block<const N: usize> {
    /// Inertia of the payload.
    pub payload: SMatrix<f64, N, N>,
    pub slots: Vec<BlockSlot<N>>,
}

/// One slot restricted to `N` motions.
pub(crate) enum BlockSlot<const N: usize> {
    Joint { twist: SVector<f64, N>, inertia_per_kg: SMatrix<f64, N, N> },
    Body(SMatrix<f64, N, N>),
    Links(Vec<BlockLink<N>>),
}

/// Payload and tip force as a wrench, and the inertia of the payload, both about the world's origin.
///
/// Water takes buoyancy from the weight of the payload. Its inertia stays, and no added mass is counted.
pub(crate) fn payload_in(
    space: &DesignSpace,
    case: &Case,
    water: Option<Water>,
    walk: &Walk,
) -> (Wrench, Matrix6<f64>) {
    let rotation = walk.tip_rotation.matrix();
    let payload = &case.payload;
    let cg_m = walk.tip_m + rotation * payload.cg_m;
    let inertia_kgm2 =
        rotation * Matrix3::from_diagonal(&payload.inertia_about_cg_kgm2) * rotation.transpose();
    let buoyancy = water.map_or(0.0, |w| w.density_kg_m3 / w.payload_density_kg_m3);
    let weight_n = payload.mass_kg * space.gravity_m_s2 * (1.0 - buoyancy);
    let wrench = force_wrench(&case.tip_force_n, &walk.tip_m)
        + stack(&Vector3::zeros(), &case.tip_moment_nm)
        + weight_wrench(weight_n, &space.down, &cg_m);
    (wrench, body_inertia(payload.mass_kg, &cg_m, &inertia_kgm2))
}

/// The wrench of a weight \[N\] at a point; `down` is the direction of gravity.
pub(crate) fn weight_wrench(weight_n: f64, down: &Vector3<f64>, at_m: &Vector3<f64>) -> Wrench {
    force_wrench(&(down * weight_n), at_m)
}

/// Where each piece is in a pose.
pub(crate) struct Walk {
    /// Start and attitude of each piece, base to tip, then those of the tip. A joint has the attitude before its own
    /// rotation.
    pub(crate) places: Vec<(Vector3<f64>, Rotation3<f64>)>,
    /// Angle of each piece, base to tip \[rad\]; 0 for links.
    pub(crate) angles_rad: Vec<f64>,
    pub(crate) tip_m: Vector3<f64>,
    pub(crate) tip_rotation: Rotation3<f64>,
}

impl Walk {
    /// Forward kinematics of a case, base to tip.
    pub(crate) fn new(space: &DesignSpace, case: &Case) -> Self {
        let mut angles = space.angles_rad(case).into_iter();
        let (mut at_m, mut rotation) = (Vector3::zeros(), Rotation3::identity());
        let mut places = Vec::with_capacity(space.pieces.len());
        let mut angles_rad = vec![0.0; space.pieces.len()];
        for (piece, angle_rad) in space.pieces.iter().zip(&mut angles_rad) {
            places.push((at_m, rotation));
            match piece {
                SpacePiece::Joint(joint) => {
                    *angle_rad = angles.next().unwrap_or_default();
                    rotation *= Rotation3::from_axis_angle(&joint.axis, *angle_rad);
                }
                SpacePiece::Link(link) => at_m += rotation * link.vector_m,
                SpacePiece::Choice(choice) => at_m += rotation * choice.vector_m,
            }
        }
        places.push((at_m, rotation));
        Self { places, angles_rad, tip_m: at_m, tip_rotation: rotation }
    }
}

impl Walk {
    /// What springs do to the arm in the pose.
    pub(crate) fn spring_loads(&self, space: &DesignSpace) -> Vec<EndLoad> {
        if space.springs.is_empty() {
            return Vec::new();
        }
        let frame = |(index, piece): (usize, &SpacePiece)| {
            let (at_m, rotation) = self.places[index];
            match piece {
                SpacePiece::Joint(joint) => {
                    let hinge = ((rotation * joint.axis).into_inner(), self.angles_rad[index]);
                    ElementFrame { at_m, rotation: self.places[index + 1].1, hinge: Some(hinge) }
                }
                _ => ElementFrame { at_m, rotation, hinge: None },
            }
        };
        let frames: Vec<ElementFrame> = space.pieces.iter().enumerate().map(frame).collect();
        end_loads(&space.springs, &frames)
    }

    /// The place and attitude in which a layer of a piece stands.
    pub(crate) fn place(&self, piece: usize, layer: &Layer) -> &(Vector3<f64>, Rotation3<f64>) {
        match layer {
            Layer::Bodies(Carried { by: Carrier::RotatedFrame, .. }) => &self.places[piece + 1],
            _ => &self.places[piece],
        }
    }
}

/// Inertia and weight of bodies whose piece begins at a place of a pose, about the world's origin.
pub(crate) fn bodies_at(
    bodies: &[RigidBody],
    space: &DesignSpace,
    (at_m, rotation): &(Vector3<f64>, Rotation3<f64>),
) -> (Matrix6<f64>, Wrench) {
    let turn = rotation.matrix();
    let (mut inertia, mut weight) = (Matrix6::zeros(), Wrench::zeros());
    for body in bodies {
        let cg_m = at_m + turn * body.cg_m;
        inertia += body_inertia(body.mass_kg, &cg_m, &(turn * body.inertia_kgm2 * turn.transpose()));
        weight += weight_wrench(body.mass_kg * space.gravity_m_s2, &space.down, &cg_m);
    }
    (inertia, weight)
}

/// Reach of each joint \[m\], base to tip: the largest way of the tip per radian over some cases. That is the distance of the
/// tip from the axis, unless the joint turns passive joints too.
pub(crate) fn reaches_m<'a>(space: &DesignSpace, cases: impl Iterator<Item = &'a Case>) -> Vec<f64> {
    let joints: Vec<(usize, Vector3<f64>)> = space
        .pieces
        .iter()
        .enumerate()
        .filter_map(|(i, p)| match p {
            SpacePiece::Joint(joint) => Some((i, joint.axis.into_inner())),
            _ => None,
        })
        .collect();
    let linkages = space.linkages();
    let mut reaches = vec![0.0f64; joints.len()];
    for case in cases {
        let walk = Walk::new(space, case);
        let way = |piece: usize| {
            let (origin, rotation) = &walk.places[piece];
            let axis =
                joints.iter().find(|(joint, _)| *joint == piece).map_or(Vector3::zeros(), |(_, axis)| *axis);
            (rotation * axis).cross(&(walk.tip_m - origin))
        };
        for (reach, (piece, _)) in reaches.iter_mut().zip(&joints) {
            let turned = linkages.iter().filter(|linkage| linkage.driver == *piece);
            let all = turned.fold(way(*piece), |sum, linkage| sum + way(linkage.passive) * linkage.factor);
            *reach = reach.max(all.norm());
        }
    }
    reaches
}
