//! Stations: the cases of a study, compiled. A station has everything about a pose that does not depend on the design.
//!
//! Twists and wrenches are taken about the world's origin, so that what an option does can be tabulated once and then
//! added for every design that has it.
//!
//! A pose is *planar* if every joint axis, link and load in it is symmetric about the x-z plane. Then the motions within
//! the plane (x, z, rotation about y) and those across it (y, rotations about x and z) do not couple. The lowest mode is
//! then found in two blocks of three motions instead of one block of six, which is less work.

use super::design_space::{Case, DesignSpace, SpacePiece};
use super::effects::Layer;
use crate::arm::load::Water;
use crate::arm::structure::{LinkPiece, Structure};
use crate::arm::{Link, LinkModel};
use crate::mechanics::beam::{PreparedBeam, section_frame};
use crate::mechanics::condensed::{CondensedLink, PlacedLink};
use crate::mechanics::lowest::BlockLink;
use crate::mechanics::{
    Twist, Wrench, angular, body_inertia, displacement_at, force_wrench, linear, rotation_twist,
};
use nalgebra::{Matrix3, Matrix3x6, Matrix6, Rotation3, SMatrix, SVector, Vector3, Vector6};
use rayon::prelude::*;

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
}

/// What the search adds in one step, in a pose.
pub(crate) enum StationSlot {
    /// A joint.
    Joint(StationJoint),
    /// A rigid body: a point mass, or a rigid offset with the harness along it.
    Body { inertia: Matrix6<f64>, weight: Wrench },
    /// A tube, with one entry for each option.
    Link { options: Vec<StationLink>, place: Place },
}

/// A joint in a pose.
pub(crate) struct StationJoint {
    /// Motion of everything outboard per radian of the joint's rotation.
    pub twist: Twist,
    /// Where the joint is.
    pub at_m: Vector3<f64>,
    /// Displacement of the tip per radian.
    pub tip_m_per_rad: Vector3<f64>,
    /// Inertia and weight of one kilogram at the joint.
    pub inertia_per_kg: Matrix6<f64>,
    pub weight_per_kg: Wrench,
    /// The block in which the joint moves the arm: 0 within the plane, 1 across it.
    pub block: usize,
}

/// Where a link is in a pose.
pub(crate) struct Place {
    pub root_m: Vector3<f64>,
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

/// Motions within the x-z plane (x, z, rotation about y) and across it (y, rotations about x and z).
const PLANES: [[usize; 3]; 2] = [[0, 2, 4], [1, 3, 5]];
/// All six motions: three displacements and three rotations.
const ALL: [usize; 6] = [0, 1, 2, 3, 4, 5];

/// A tube or a harness, independent of the pose.
struct Tube {
    condensed: CondensedLink,
    length_m: f64,
    /// Net weight: buoyancy is subtracted.
    weight_n_per_m: f64,
}

/// The tubes of each layer. Condensing a tube is the costly part and does not depend on the pose, so all cases with the
/// same surroundings share them.
struct Tubes {
    structure: Structure,
    layers: Vec<Vec<Tube>>,
}

impl Tube {
    /// Condenses a link; `None` for a rigid offset without mass along it, or without length.
    fn new(link: &LinkPiece, structure: &Structure, model: LinkModel) -> Option<Self> {
        let beam = PreparedBeam::new(link, structure, model)?;
        let condensed = CondensedLink::new(&beam);
        Some(Self { condensed, length_m: beam.length_m, weight_n_per_m: beam.weight_n_per_m })
    }
}

impl Tubes {
    /// The tubes of a space in the surroundings that `structure` gives.
    fn new(space: &DesignSpace, structure: Structure) -> Self {
        let tube = |link: &Link| Tube::new(&space.link_piece(link), &structure, space.links);
        let of = |layer| match layer {
            Layer::Piece(SpacePiece::Link(link)) => tube(link).into_iter().collect(),
            Layer::Piece(SpacePiece::Choice(choice)) => {
                choice.options.par_iter().filter_map(|option| tube(&choice.link(option))).collect()
            }
            _ => Vec::new(),
        };
        let layers = space.layers().into_iter().map(|(_, layer)| of(layer)).collect();
        Self { structure, layers }
    }
}

impl Station {
    /// Compiles every case of a space.
    pub(crate) fn all(space: &DesignSpace) -> Vec<Self> {
        let around = space.surroundings();
        let mut known: Vec<Tubes> = Vec::new();
        let mut stations = Vec::with_capacity(space.cases.len());
        for case in &space.cases {
            // the water of a case comes before the water of an effect
            let structure = Structure { water: case.water.or(around.water), ..around.clone() };
            let tubes = known.iter().position(|tubes| tubes.structure == structure).unwrap_or_else(|| {
                known.push(Tubes::new(space, structure));
                known.len() - 1
            });
            stations.push(Self::new(space, case, &known[tubes]));
        }
        stations
    }

    /// Compiles one case.
    fn new(space: &DesignSpace, case: &Case, Tubes { structure, layers: tubes }: &Tubes) -> Self {
        let walk = Walk::new(space, case);
        let (start_wrench, start_inertia) = payload_in(space, case, structure.water, &walk);
        let built: Vec<Built> = space
            .layers()
            .into_iter()
            .zip(tubes)
            .map(|((piece, layer), tubes)| {
                Builder { space, structure, tubes, place: &walk.places[piece], tip_m: &walk.tip_m }
                    .build(layer)
            })
            .collect();
        let modal = match planar(&built, &start_inertia) {
            true => Modal::Planar(Box::new(PLANES.map(|p| block(&built, &start_inertia, p)))),
            false => Modal::Spatial(Box::new(block(&built, &start_inertia, ALL))),
        };
        let split = matches!(modal, Modal::Planar(_));
        let slots = built.into_iter().map(|b| b.into_slot(split)).collect();
        Self { slots, modal, start_wrench, start_inertia }
    }
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
    let wrench = force_wrench(&case.tip_force_n, &walk.tip_m) + weight_wrench(weight_n, &cg_m);
    (wrench, body_inertia(payload.mass_kg, &cg_m, &inertia_kgm2))
}

/// The wrench of a weight \[N\] at a point.
pub(crate) fn weight_wrench(weight_n: f64, at_m: &Vector3<f64>) -> Wrench {
    force_wrench(&Vector3::new(0.0, 0.0, -weight_n), at_m)
}

/// Where each piece is in a pose.
pub(crate) struct Walk {
    /// Start and attitude of each piece, base to tip. A joint has the attitude before its own rotation.
    pub(crate) places: Vec<(Vector3<f64>, Rotation3<f64>)>,
    pub(crate) tip_m: Vector3<f64>,
    pub(crate) tip_rotation: Rotation3<f64>,
}

impl Walk {
    /// Forward kinematics of a case, base to tip.
    pub(crate) fn new(space: &DesignSpace, case: &Case) -> Self {
        let mut angles = case.pose_deg.iter().map(|a| a.to_radians());
        let (mut at_m, mut rotation) = (Vector3::zeros(), Rotation3::identity());
        let mut places = Vec::with_capacity(space.pieces.len());
        for piece in &space.pieces {
            places.push((at_m, rotation));
            match piece {
                SpacePiece::Joint(joint) => {
                    rotation *= Rotation3::from_axis_angle(&joint.axis, angles.next().unwrap_or_default());
                }
                SpacePiece::Link(link) => at_m += rotation * link.vector_m,
                SpacePiece::Choice(choice) => at_m += rotation * choice.vector_m,
            }
        }
        Self { places, tip_m: at_m, tip_rotation: rotation }
    }
}

/// Reach of each joint \[m\], base to tip: the largest distance of the tip from its axis over some cases.
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
    let mut reaches = vec![0.0f64; joints.len()];
    for case in cases {
        let walk = Walk::new(space, case);
        for (reach, (piece, axis)) in reaches.iter_mut().zip(&joints) {
            let (origin, rotation) = &walk.places[*piece];
            // the distance of a point from an axis through the origin is |axis x way to the point|
            *reach = reach.max((rotation * axis).cross(&(walk.tip_m - origin)).norm());
        }
    }
    reaches
}

/// A piece in a pose before it is split into blocks.
enum Built {
    Joint(StationJoint),
    Body { inertia: Matrix6<f64>, weight: Wrench },
    Link { options: Vec<(PlacedLink, StationLink)>, place: Place },
}

/// Builds the slot at one place of a pose.
struct Builder<'a> {
    space: &'a DesignSpace,
    structure: &'a Structure,
    tubes: &'a [Tube],
    place: &'a (Vector3<f64>, Rotation3<f64>),
    tip_m: &'a Vector3<f64>,
}

impl Builder<'_> {
    fn build(&self, layer: Layer) -> Built {
        let (at_m, rotation) = self.place;
        match layer {
            Layer::Tilt(tilt) => self.hinge(&tilt.axis(rotation)),
            Layer::Bearing(spring) => self.hinge(&spring.axis(rotation)),
            Layer::Mass(mass_kg) | Layer::Extra(mass_kg) => self.body(mass_kg, at_m),
            Layer::Piece(SpacePiece::Joint(joint)) => self.hinge(&(rotation * joint.axis)),
            Layer::Piece(SpacePiece::Link(link)) => self.link(link),
            Layer::Piece(SpacePiece::Choice(choice)) => self.tube(&choice.vector_m),
        }
    }

    /// A joint or a spring that turns about an axis of the world through this place.
    fn hinge(&self, axis: &Vector3<f64>) -> Built {
        let (at_m, _) = self.place;
        let twist = rotation_twist(axis, at_m);
        Built::Joint(StationJoint {
            twist,
            at_m: *at_m,
            tip_m_per_rad: displacement_at(&twist, self.tip_m),
            inertia_per_kg: body_inertia(1.0, at_m, &Matrix3::zeros()),
            weight_per_kg: weight_wrench(self.structure.gravity_m_s2, at_m),
            // rounding leaves traces of the other plane in an axis that was turned
            block: usize::from(PLANES[1].iter().any(|&i| twist[i].abs() > 1e-12 * twist.amax())),
        })
    }

    /// A point mass.
    fn body(&self, mass_kg: f64, centre_m: &Vector3<f64>) -> Built {
        Built::Body {
            inertia: body_inertia(mass_kg, centre_m, &Matrix3::zeros()),
            weight: weight_wrench(mass_kg * self.structure.gravity_m_s2, centre_m),
        }
    }

    /// A given tube, or a rigid offset with its point mass and the harness along it.
    fn link(&self, link: &Link) -> Built {
        let (at_m, rotation) = self.place;
        let piece = self.space.link_piece(link);
        let point = self.body(piece.point_mass_kg, &(at_m + rotation * link.vector_m / 2.0));
        // neither tube nor harness
        if self.tubes.is_empty() {
            return point;
        }
        match (point, self.tube(&link.vector_m)) {
            (_, tube) if piece.beam.is_some() => tube,
            // a harness on a rigid offset has mass and no compliance, so both together are one rigid body
            (Built::Body { inertia, weight }, Built::Link { options, .. }) => {
                let along = &options[0].1;
                Built::Body { inertia: inertia + along.inertia, weight: weight + along.weight }
            }
            (point, _) => point,
        }
    }

    /// A tube with all its options.
    fn tube(&self, vector_m: &Vector3<f64>) -> Built {
        let (root_m, rotation) = *self.place;
        let vector = rotation * vector_m;
        let frame = rotation.matrix() * section_frame(vector_m);
        let place = Place { root_m, end_m: root_m + vector, frame };
        // a link may have a hundred thousand options
        let options =
            self.tubes.par_iter().map(|tube| place_option(tube, &place, &vector, self.tip_m)).collect();
        Built::Link { options, place }
    }
}

/// Puts one option of a link into the pose.
fn place_option(
    tube: &Tube,
    place: &Place,
    vector: &Vector3<f64>,
    tip_m: &Vector3<f64>,
) -> (PlacedLink, StationLink) {
    let placed = tube.condensed.place(&place.root_m, &place.end_m, &place.frame);
    let tips: Vec<Vector3<f64>> =
        (0..6).map(|g| displacement_at(&placed.end.column(g).into(), tip_m)).collect();
    let option = StationLink {
        // to order 0 in λ, over the motion of the root: the link as a rigid body
        inertia: placed.inertia[0].fixed_view::<6, 6>(0, 0).into_owned(),
        // a uniform weight acts at mid-length
        weight: weight_wrench(tube.weight_n_per_m * tube.length_m, &(place.root_m + vector / 2.0)),
        end: placed.end,
        own_weight_end: placed.end_per_weight * tube.weight_n_per_m,
        tip: Matrix3x6::from_columns(&tips),
        end_inertia: placed.inertia[0].diagonal().fixed_rows::<6>(6).into_owned(),
        // a pose in which some end lies in no single block is not split, and all blocks become 0
        block: ends_by_block(&placed).unwrap_or_default(),
        inner_trace_s2: placed.inner_trace_s2,
    };
    (placed, option)
}

impl Built {
    /// The slot, with every block number 0 if the pose was not `split` into two blocks.
    fn into_slot(self, split: bool) -> StationSlot {
        match self {
            Built::Joint(mut joint) => {
                joint.block *= usize::from(split);
                StationSlot::Joint(joint)
            }
            Built::Body { inertia, weight } => StationSlot::Body { inertia, weight },
            Built::Link { options, place } => {
                let options = options
                    .into_iter()
                    .map(|(_, mut option)| {
                        option.block = option.block.map(|b| b * usize::from(split));
                        option
                    })
                    .collect();
                StationSlot::Link { options, place }
            }
        }
    }
}

/// Whether the motions within the x-z plane and those across it are coupled nowhere: by no inertia, no joint axis and no
/// link.
fn planar(built: &[Built], payload: &Matrix6<f64>) -> bool {
    let uncoupled = |m: &Matrix6<f64>| {
        let largest = m.amax();
        PLANES[0].iter().all(|&i| PLANES[1].iter().all(|&j| m[(i, j)].abs() <= 1e-12 * largest))
    };
    uncoupled(payload)
        && built.iter().all(|b| match b {
            Built::Joint(joint) => {
                let across = PLANES[1].iter().any(|&i| joint.twist[i].abs() > 1e-12);
                let within = PLANES[0].iter().any(|&i| joint.twist[i].abs() > 1e-12);
                !(across && within) && uncoupled(&joint.inertia_per_kg)
            }
            Built::Body { inertia, .. } => uncoupled(inertia),
            Built::Link { options, .. } => options
                .iter()
                .all(|(placed, option)| uncoupled(&option.inertia) && ends_by_block(placed).is_some()),
        })
}

/// The block of each end coordinate; `None` unless each coordinate lies in one block and each block gets three.
fn ends_by_block(placed: &PlacedLink) -> Option<[usize; 6]> {
    let mut blocks = [2; 6];
    for (g, column) in placed.end.column_iter().enumerate() {
        let largest = column.amax();
        let touches = |plane: &[usize; 3]| plane.iter().any(|&i| column[i].abs() > 1e-12 * largest);
        match (touches(&PLANES[0]), touches(&PLANES[1])) {
            (true, true) => return None,
            (true, false) => blocks[g] = 0,
            (false, true) => blocks[g] = 1,
            (false, false) => {}
        }
    }
    // a coordinate that moves nothing (a direction without compliance) can stand in either block: it fills up the one
    // that has fewer than three
    for plane in 0..2 {
        while blocks.iter().filter(|&&b| b == plane).count() < 3 {
            *blocks.iter_mut().find(|b| **b == 2)? = plane;
        }
    }
    (blocks.iter().filter(|&&b| b == 0).count() == 3).then_some(blocks)
}

/// The slots restricted to the given motions.
fn block<const N: usize>(built: &[Built], payload: &Matrix6<f64>, motions: [usize; N]) -> Block<N> {
    let select = |m: &Matrix6<f64>| SMatrix::<f64, N, N>::from_fn(|i, j| m[(motions[i], motions[j])]);
    let slots = built
        .iter()
        .map(|b| match b {
            Built::Joint(joint) => BlockSlot::Joint {
                twist: SVector::from_fn(|i, _| joint.twist[motions[i]]),
                inertia_per_kg: select(&joint.inertia_per_kg),
            },
            Built::Body { inertia, .. } => BlockSlot::Body(select(inertia)),
            Built::Link { options, .. } => {
                BlockSlot::Links(options.par_iter().map(|(placed, _)| block_link(placed, motions)).collect())
            }
        })
        .collect();
    Block { payload: select(payload), slots }
}

/// One option of a link restricted to the given motions, with the end coordinates that belong to them.
fn block_link<const N: usize>(placed: &PlacedLink, motions: [usize; N]) -> BlockLink<N> {
    let mut ends = [0; N];
    // in one block of six every end coordinate takes part; in two blocks each takes the three that move it
    if N == 6 {
        ends.copy_from_slice(&ALL[..N]);
    } else {
        let blocks = ends_by_block(placed).unwrap_or_default();
        let wanted = usize::from(motions[0] == PLANES[1][0]);
        let members = (0..6).filter(|&g| blocks[g] == wanted);
        ends.iter_mut().zip(members).for_each(|(slot, g)| *slot = g);
    }
    let part = |rows: [usize; N], columns: [usize; N]| {
        placed.inertia.map(|m| SMatrix::<f64, N, N>::from_fn(|i, j| m[(rows[i], columns[j])]))
    };
    // a condensed link has the root motion in rows 0-5 and the end coordinates in rows 6-11
    let inner = ends.map(|g| 6 + g);
    BlockLink {
        root: part(motions, motions),
        cross: part(motions, inner),
        end_inertia: part(inner, inner),
        end: SMatrix::from_fn(|i, j| placed.end[(motions[i], ends[j])]),
    }
}
