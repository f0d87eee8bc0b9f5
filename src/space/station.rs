//! Stations: the cases of a study, prepared for the search ([`posed`](super::posed)). A station has everything about
//! a case that does not depend on the design.
//!
//! Twists (velocities and angular velocities) and wrenches (forces and moments) are taken about the world's origin.
//! Thus the contribution of an option can be computed once, and then added for every design that has this option.
//!
//! A pose is *planar* if every joint axis, link and mass in it is symmetric about the x-z plane. Then motions within
//! the plane (x, z, rotation about y) and motions across it (y, rotations about x and z) do not couple. The lowest
//! mode is found in two blocks of three motions instead of one block of six, which is less work.

use super::design_space::{Case, DesignSpace, SpacePiece};
use super::effects::Layer;
use crate::arm::body::RigidBody;
use crate::arm::load::Water;
use crate::arm::springs::{ElementFrame, EndLoad, end_loads};
use crate::mechanics::lowest::BlockLink;
use crate::mechanics::{Twist, Wrench, angular, body_inertia, force_wrench, linear, stack};
use nalgebra::{Matrix3, Matrix3x6, Matrix6, Rotation3, SMatrix, SVector, Vector3, Vector6};

/// One case (a pose with its load), prepared for the search.
pub(crate) struct Station {
    /// The data of each slot in this pose, tip first.
    pub slots: Vec<StationSlot>,
    /// The slots in the form that the computation of the lowest mode needs.
    pub modal: Modal,
    /// Force and moment of the payload's weight and of the tip load, as a wrench.
    pub start_wrench: Wrench,
    /// Inertia matrix of the payload about the world's origin.
    pub start_inertia: Matrix6<f64>,
    /// Direction of gravity in the world, a unit vector.
    pub down: Vector3<f64>,
}

/// The data of one slot in a pose.
pub(crate) enum StationSlot {
    /// A joint or a spring.
    Joint(StationJoint),
    /// A rigid body with its inertia matrix and its weight (both about the world's origin): a point mass, a body of a
    /// piece, a spring force, or a rigid offset with the harness along it.
    Body { inertia: Matrix6<f64>, weight: Wrench },
    /// A tube: the data of each option, the position of the tube, and the loads of bodies and springs on it.
    Link { options: Vec<StationLink>, place: Place, carried: OnTube },
}

/// The bodies on a tube in a pose and the pull of springs on it, as they act on a tube without deformation. The
/// bodies have slots of their own inboard of the tube. What they add to the bending of the tube is in the options of
/// the tube.
pub(crate) struct OnTube {
    /// Inertia matrix of the bodies about the world's origin.
    pub inertia: Matrix6<f64>,
    /// Weight of the bodies and pull of the springs, as one wrench.
    pub weight: Wrench,
    /// Whether every body is symmetric about the x-z plane.
    pub is_symmetric: bool,
    /// The weight of each body and the pull of each spring, each with its point on the axis.
    pub loads: Vec<OnAxis>,
    /// The points at which springs pull (0 at the root, 1 at the end), each with the force and moment of the spring
    /// about this point, in the section frame.
    pub pulls: Vec<(f64, Wrench)>,
}

/// A load on a tube, at a point of its axis.
pub(crate) struct OnAxis {
    /// Place of the load on the tube's axis, from 0 (root) to 1 (end).
    pub xi: f64,
    /// Force and moment of the load, about the world's origin.
    pub wrench: Wrench,
}

impl OnTube {
    /// The points of the tube at which springs pull, each with the load on the section just outboard of the point and
    /// on the section just inboard of it. The two differ by what acts at the point itself. Both are taken about the
    /// world's origin. `outboard` is the load on the end of the tube, and `own` is the weight of the tube.
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

/// A joint or a spring in a pose.
pub(crate) struct StationJoint {
    /// Motion (velocity and angular velocity) of everything outboard per radian of the joint's rotation; per metre
    /// for a prismatic joint.
    pub twist: Twist,
    /// Position of the joint in the world \[m\].
    pub at_m: Vector3<f64>,
    /// Displacement of the tip per radian of the joint's rotation \[m/rad\].
    pub tip_m_per_rad: Vector3<f64>,
    /// Angle of the joint in the pose \[rad\]; 0 for a spring.
    pub angle_rad: f64,
    /// Torque that acts on the joint in addition to weight and load \[N m\].
    pub own_nm: f64,
    /// Inertia matrix of a mass of one kilogram at the joint, about the world's origin.
    pub inertia_per_kg: Matrix6<f64>,
    /// Weight of a mass of one kilogram at the joint, as a wrench.
    pub weight_per_kg: Wrench,
    /// The block of motions that the joint belongs to: 0 within the x-z plane, 1 across it. It is 0 if the pose is
    /// not planar.
    pub block: usize,
    /// The joints that turn along with this joint, by a linkage or because their motors sit inboard of this joint. All
    /// of them are outboard of it.
    pub turns: Vec<Turned>,
    /// Whether this joint turns along with another joint, by a linkage or because its own motor sits inboard of that
    /// other joint.
    pub is_passive: bool,
}

/// A joint that turns along with another joint, the driving joint. It is called the passive joint here, even if it has
/// a motor of its own.
pub(crate) struct Turned {
    /// Slot of the passive joint.
    pub slot: usize,
    /// Motion of everything outboard of the passive joint, per radian of the driving joint.
    pub twist: Twist,
    /// Displacement of the tip due to the rotation of the passive joint, per radian of the driving joint \[m/rad\].
    pub tip_m_per_rad: Vector3<f64>,
    /// Torque on the driving joint from the torque that acts on the passive joint in addition to weight and load \[N
    /// m\].
    pub own_nm: f64,
}

/// Position and attitude of a link in a pose.
pub(crate) struct Place {
    /// Position of the root of the link \[m\].
    pub root_m: Vector3<f64>,
    /// Position of the middle of the link \[m\].
    pub centre_m: Vector3<f64>,
    /// Position of the end of the link \[m\].
    pub end_m: Vector3<f64>,
    /// Axes of the section frame in the world, as columns: x (along the link), y and z.
    pub frame: Matrix3<f64>,
}

impl Place {
    /// Axial force \[N\], torsion and both bending moments \[N m\] that the section at the point `at_m` of the link
    /// transmits. `wrench` is the load outboard of this section, about the world's origin.
    pub(crate) fn local(&self, wrench: &Wrench, at_m: &Vector3<f64>) -> [f64; 4] {
        let force = self.frame.tr_mul(&linear(wrench));
        let moment = self.frame.tr_mul(&(angular(wrench) - at_m.cross(&linear(wrench))));
        [force.x, moment.x, moment.y, moment.z]
    }
}

/// The data of one option of a link in a pose.
///
/// The end coordinates are the six motions of the end of a condensed link, scaled to unit stiffness
/// ([`condensed`](crate::mechanics::condensed)).
pub(crate) struct StationLink {
    /// Inertia matrix of the link as a rigid body, about the world's origin.
    pub inertia: Matrix6<f64>,
    /// Weight of the link less buoyancy, as a wrench.
    pub weight: Wrench,
    /// Motion (velocity and angular velocity) of everything outboard, per unit of each end coordinate: one column for
    /// each.
    pub end: Matrix6<f64>,
    /// Values of the six end coordinates (motions of the link's end) under the weight of the link, the bodies on it and
    /// the pull of springs.
    pub own_weight_end: Vector6<f64>,
    /// Displacement of the tip per unit of each end coordinate: one column for each.
    pub tip: Matrix3x6<f64>,
    /// Inertia of the link itself for a unit of each end coordinate (motion of the link's end). It is a term of
    /// Dunkerley's sum (of `1/λ` over all modes) \[s²\], because the stiffness of each end coordinate is 1.
    pub end_inertia: Vector6<f64>,
    /// Block to which each end coordinate belongs: 0 within the x-z plane, 1 across it.
    pub block: [usize; 6],
    /// Sum of `1/λ` over the inner modes of the link \[s²\]. These modes do not move the end of the link, so the end
    /// coordinates do not contain them.
    pub inner_trace_s2: f64,
}

impl StationLink {
    /// Weight of the link less buoyancy \[N\], positive in the direction of gravity `down`.
    pub(crate) fn weight_n(&self, down: &Vector3<f64>) -> f64 {
        down.dot(&linear(&self.weight))
    }

    /// Displacement of the tip per unit of each of the six components of the wrench on the link's end \[m/N and m/(N
    /// m)\].
    pub(crate) fn flexibility(&self) -> Matrix3x6<f64> {
        // The end coordinates have unit stiffness, so a wrench w deflects them by endᵀ w.
        self.tip * self.end.transpose()
    }

    /// Displacement of the tip \[m\] by the weight of the link, the bodies on it and the pull of springs.
    pub(crate) fn own_weight_deflection_m(&self) -> Vector3<f64> {
        self.tip * self.own_weight_end
    }
}

/// The slots in the form that the computation of the lowest mode needs: two blocks of three motions if the pose is
/// planar, otherwise one block of six.
pub(crate) enum Modal {
    Planar(Box<[Block<3>; 2]>),
    Spatial(Box<Block<6>>),
}

/// The slots, restricted to `N` of the six motions. These `N` motions do not couple with the remaining motions.
pub(crate) struct Block<const N: usize> {
    /// Inertia matrix of the payload.
    pub payload: SMatrix<f64, N, N>,
    /// The slots, tip first.
    pub slots: Vec<BlockSlot<N>>,
}

/// One slot, restricted to `N` of the six motions.
pub(crate) enum BlockSlot<const N: usize> {
    Joint { twist: SVector<f64, N>, inertia_per_kg: SMatrix<f64, N, N> },
    Body(SMatrix<f64, N, N>),
    Links(Vec<BlockLink<N>>),
}

/// Payload and tip load as a wrench, and the inertia matrix of the payload, both about the world's origin.
///
/// In water, the buoyancy is subtracted from the weight of the payload. Its inertia stays the same, and no added mass
/// is counted.
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

/// The wrench of a weight \[N\] at the point `at_m`. `down` is the direction of gravity.
pub(crate) fn weight_wrench(weight_n: f64, down: &Vector3<f64>, at_m: &Vector3<f64>) -> Wrench {
    force_wrench(&(down * weight_n), at_m)
}

/// Positions of all pieces in a pose.
pub(crate) struct Walk {
    /// Position \[m\] and attitude of the beginning of each piece, base to tip; the last entry is the tip. The
    /// attitude of a joint is its attitude before its own rotation.
    pub(crate) places: Vec<(Vector3<f64>, Rotation3<f64>)>,
    /// Angle of each piece, base to tip \[rad\]; 0 for links.
    pub(crate) angles_rad: Vec<f64>,
    /// Position of the tip \[m\].
    pub(crate) tip_m: Vector3<f64>,
    /// Attitude of the tip.
    pub(crate) tip_rotation: Rotation3<f64>,
}

impl Walk {
    /// Positions of all pieces in the pose of a case (forward kinematics), base to tip.
    pub(crate) fn new(space: &DesignSpace, case: &Case) -> Self {
        let mut angles = space.angles_rad(case).into_iter();
        let mut travels = space.travels_m(case).into_iter();
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
                SpacePiece::Prismatic(slide) => {
                    at_m += rotation * slide.joint.axis.into_inner() * travels.next().unwrap_or_default();
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
    /// The forces and moments of all springs on the arm in the pose.
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
                // A spring on a prismatic joint pulls at the part that travels.
                SpacePiece::Prismatic(_) => {
                    ElementFrame { at_m: self.places[index + 1].0, rotation, hinge: None }
                }
                _ => ElementFrame { at_m, rotation, hinge: None },
            }
        };
        let frames: Vec<ElementFrame> = space.pieces.iter().enumerate().map(frame).collect();
        end_loads(&space.springs, &frames)
    }

    /// Position and attitude of a layer of the piece with the number `piece`: at the beginning of the piece, or at its
    /// end.
    pub(crate) fn place(&self, piece: usize, layer: &Layer) -> &(Vector3<f64>, Rotation3<f64>) {
        &self.places[piece + usize::from(layer.is_at_end())]
    }
}

/// Inertia matrix and weight of bodies, about the world's origin. `at_m` and `rotation` are the beginning of their
/// piece in a pose.
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

/// Reach of each joint, base to tip \[m\]: the largest displacement of the tip per radian of the joint over the given
/// cases. It is the distance of the tip from the joint's axis. If the joint turns passive joints (joints of a linkage),
/// it differs from this distance, because the tip moves with these joints too.
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
