//! Computes the stations of a space, one for each case, slot by slot.
//!
//! A station is a case prepared for the search: everything about it that does not depend on the design. A slot is what
//! the search adds to an arm in one step. A condensed link is a link reduced to the six motions of its end.
//!
//! A link may have a hundred thousand options, and the data of a condensed link take some kilobytes in each case.
//! Options are therefore condensed a few at a time, converted for every case with the same surroundings, and dropped.
//! What remains in memory are the stations, which grow with the number of options times the number of cases.

use super::design_space::{Case, DesignSpace, SpaceJoint, SpacePiece};
use super::effects::{Carried, Layer, along};
use super::station::{
    Block, BlockSlot, Modal, OnAxis, OnTube, Place, Station, StationJoint, StationLink, StationSlot, Turned,
    Walk, bodies_at, payload_in, weight_wrench,
};
use crate::arm::body::RigidBody;
use crate::arm::springs::{EndLoad, Side};
use crate::arm::structure::{LinkPiece, Structure};
use crate::arm::{Link, LinkModel};
use crate::mechanics::beam::{PreparedBeam, pull_on, section_frame};
use crate::mechanics::chain::wrench_of;
use crate::mechanics::condensed::{CondensedLink, PlacedLink};
use crate::mechanics::lowest::BlockLink;
use crate::mechanics::{Twist, Wrench, body_inertia, displacement_at, rotation_twist, stack};
use nalgebra::{Matrix3, Matrix3x6, Matrix6, SMatrix, SVector, Vector3};
use rayon::prelude::*;

/// Number of link options that are condensed at a time, to limit memory.
const AT_A_TIME: usize = 1024;

/// Indices of the motions within the x-z plane (first: x, z, rotation about y) and of the motions out of this plane
/// (second: y, rotations about x and z).
const PLANES: [[usize; 3]; 2] = [[0, 2, 4], [1, 3, 5]];
/// Indices of all six motions: three displacements and three rotations.
const ALL: [usize; 6] = [0, 1, 2, 3, 4, 5];

/// Largest component of a unit vector (or relative entry of a matrix) that counts as zero.
const ROUNDING: f64 = 1e-12;

impl Station {
    /// Computes the station of every case of a space.
    pub(crate) fn all(space: &DesignSpace) -> Vec<Self> {
        let layers = space.layers();
        let mut posed: Vec<Posed> = space.cases.iter().map(|case| Posed::new(space, case, &layers)).collect();
        let mut surroundings: Vec<Structure> = Vec::new();
        for of in &posed {
            if !surroundings.contains(&of.structure) {
                surroundings.push(of.structure.clone());
            }
        }
        for (slot, (piece, layer)) in layers.iter().enumerate() {
            let pulled_at = space.pulled_at(*piece);
            for structure in &surroundings {
                for tubes in few_at_a_time(space, structure, layer, &pulled_at) {
                    let alike = posed.iter_mut().filter(|of| of.structure == *structure);
                    alike.for_each(|of| of.add_options(slot, &tubes));
                }
            }
        }
        posed.into_iter().map(|of| of.station).collect()
    }
}

/// A tube, or a harness along a rigid offset, condensed and not yet placed in a pose.
struct Tube {
    /// The condensed link.
    condensed: CondensedLink,
    /// Length of the link \[m\].
    length_m: f64,
    /// Weight per length \[N/m\]. Buoyancy is subtracted.
    weight_n_per_m: f64,
}

impl Tube {
    /// Condenses a link to the motions of its end. Springs pull on it at the points `pulled_at` (0 at the root, 1 at
    /// the end). `structure` has gravity and water, and `model` tells which deformations are computed. `None` for a
    /// rigid offset that has no mass along it, and for a link without length.
    fn new(link: &LinkPiece, structure: &Structure, model: LinkModel, pulled_at: &[f64]) -> Option<Self> {
        let beam = PreparedBeam::new(link, structure, model)?;
        let condensed = CondensedLink::new(&beam, pulled_at);
        Some(Self { condensed, length_m: beam.length_m, weight_n_per_m: beam.weight_n_per_m })
    }
}

/// The condensed tubes of a layer, in the order of its options and in lists of at most `AT_A_TIME`. There are none
/// if the layer is not a link.
fn few_at_a_time<'a>(
    space: &'a DesignSpace,
    structure: &'a Structure,
    layer: &'a Layer,
    pulled_at: &'a [f64],
) -> impl Iterator<Item = Vec<Tube>> + 'a {
    let options = match layer {
        Layer::Piece(SpacePiece::Link(_)) => 1,
        Layer::Piece(SpacePiece::Choice(choice)) => choice.options.len(),
        _ => 0,
    };
    let tube = move |option: usize| match layer {
        Layer::Piece(SpacePiece::Link(link)) => {
            Tube::new(&space.link_piece(link), structure, space.links, pulled_at)
        }
        Layer::Piece(SpacePiece::Choice(choice)) => {
            let link = choice.link(&choice.options[option]);
            Tube::new(&space.link_piece(&link), structure, space.links, pulled_at)
        }
        _ => None,
    };
    (0..options)
        .step_by(AT_A_TIME)
        .map(move |first| (first..options.min(first + AT_A_TIME)).into_par_iter().filter_map(tube).collect())
}

/// A case whose slots are all placed in its pose. The options of its links are added one list after another.
struct Posed {
    /// Gravity, base and water around the arm.
    structure: Structure,
    /// Position of the tip in the pose \[m\].
    tip_m: Vector3<f64>,
    /// The station of the case, as far as it is computed.
    station: Station,
}

impl Posed {
    fn new(space: &DesignSpace, case: &Case, layers: &[(usize, Layer)]) -> Self {
        let around = space.surroundings();
        // The water of the case takes the place of the water that an effect states.
        let structure = Structure { water: case.water.or(around.water), ..around };
        let walk = Walk::new(space, case);
        let (start_wrench, start_inertia) = payload_in(space, case, structure.water, &walk);
        let springs = walk.spring_loads(space);
        let mut slots: Vec<StationSlot> = layers
            .iter()
            .map(|(piece, layer)| {
                let at = Builder {
                    space,
                    structure: &structure,
                    place: walk.place(*piece, layer),
                    angle_rad: walk.angles_rad[*piece],
                    tip_m: &walk.tip_m,
                    springs: &springs,
                };
                at.build(*piece, layer)
            })
            .collect();
        link_up(space, layers, &mut slots);
        let is_planar = planar(&slots, &start_inertia);
        if !is_planar {
            slots.iter_mut().for_each(put_into_one_block);
        }
        let modal = match is_planar {
            true => Modal::Planar(Box::new(PLANES.map(|motions| block(&slots, &start_inertia, motions)))),
            false => Modal::Spatial(Box::new(block(&slots, &start_inertia, ALL))),
        };
        Self {
            structure,
            tip_m: walk.tip_m,
            station: Station { slots, modal, start_wrench, start_inertia, down: space.down },
        }
    }

    /// Adds the options `tubes` to the link in `slot`, placed in the pose. Does nothing if the slot is not a link.
    fn add_options(&mut self, slot: usize, tubes: &[Tube]) {
        let down = &self.structure.down;
        let StationSlot::Link { options, place, carried } = &mut self.station.slots[slot] else { return };
        let placed = |tube: &Tube| {
            let mut placed = tube.condensed.place(&place.root_m, &place.end_m, &place.frame, down);
            // The bodies on the tube move with its root and have a slot of their own inboard of the tube. Their inertia
            // is therefore subtracted here.
            let mut root = placed.inertia[0].fixed_view_mut::<6, 6>(0, 0);
            root -= carried.inertia;
            placed
        };
        let placed: Vec<PlacedLink> = tubes.par_iter().map(placed).collect();
        let is_planar = matches!(self.station.modal, Modal::Planar(_));
        let option = |(tube, placed)| {
            let mut link = station_link(tube, placed, place, (&self.tip_m, down), is_planar);
            let pulls = tube.condensed.end_per_pull.iter().zip(&carried.pulls);
            pulls.for_each(|(end, (_, pull))| link.own_weight_end += end * pull);
            link
        };
        options.par_extend(tubes.par_iter().zip(&placed).map(option));
        match &mut self.station.modal {
            Modal::Planar(blocks) => {
                blocks.iter_mut().zip(PLANES).for_each(|(block, motions)| block.add(slot, &placed, motions));
            }
            Modal::Spatial(block) => block.add(slot, &placed, ALL),
        }
    }
}

/// Computes the slot at one place of a pose. The options of links are added later.
struct Builder<'a> {
    space: &'a DesignSpace,
    structure: &'a Structure,
    /// Position \[m\] and attitude of the frame in which the slot is.
    place: &'a (Vector3<f64>, nalgebra::Rotation3<f64>),
    /// Angle of the joint in this place \[rad\]; 0 for a link.
    angle_rad: f64,
    /// Position of the tip in the pose \[m\].
    tip_m: &'a Vector3<f64>,
    /// Forces and moments of the springs on the arm in the pose.
    springs: &'a [EndLoad],
}

impl Builder<'_> {
    fn build(&self, piece: usize, layer: &Layer) -> StationSlot {
        let (at_m, rotation) = self.place;
        match layer {
            Layer::Tilt(tilt) => self.hinge(&tilt.axis(rotation)),
            Layer::Bearing(spring) => self.hinge(&spring.axis(rotation)),
            Layer::Guide(spring) => self.hinge(&spring.axis(rotation)),
            Layer::Motor(motor) => self.weight_at(at_m + rotation * motor.place.point_m),
            Layer::Mass(mass_kg) | Layer::Travelling(mass_kg) | Layer::Extra(mass_kg) => {
                self.body(*mass_kg, at_m)
            }
            Layer::Bodies(Carried { bodies, .. }) => {
                let (inertia, weight) = bodies_at(bodies, self.space, self.place);
                StationSlot::Body { inertia, weight }
            }
            Layer::Piece(SpacePiece::Joint(joint)) => self.joint(joint),
            Layer::Piece(SpacePiece::Prismatic(slide)) => {
                let along = rotation * slide.joint.axis.into_inner();
                self.spring(stack(&along, &Vector3::zeros()))
            }
            Layer::Springs(side) => {
                let weight = self.springs_on(*side).map(wrench_of).sum();
                StationSlot::Body { inertia: Matrix6::zeros(), weight }
            }
            Layer::Piece(SpacePiece::Link(link)) => self.link(piece, link),
            Layer::Piece(SpacePiece::Choice(choice)) => {
                self.tube(piece, (&choice.vector_m, &choice.bodies), choice.options.len())
            }
        }
    }

    /// The joint at its angle in the pose. A torque that acts on it in addition to weight and load is included.
    fn joint(&self, joint: &SpaceJoint) -> StationSlot {
        let (_, rotation) = self.place;
        let mut slot = self.hinge(&(rotation * joint.axis));
        if let StationSlot::Joint(station) = &mut slot {
            station.angle_rad = self.angle_rad;
            station.own_nm = self.space.joint_torque(joint).at(self.angle_rad);
        }
        slot
    }

    /// A joint or a spring that turns about an axis through this place. The axis is given in world axes.
    fn hinge(&self, axis: &Vector3<f64>) -> StationSlot {
        self.spring(rotation_twist(axis, &self.place.0))
    }

    /// A joint or a spring at this place. `twist` is the motion of everything outboard per unit of its coordinate.
    fn spring(&self, twist: Twist) -> StationSlot {
        self.mass_on(twist, &self.place.0)
    }

    /// The slot of a mass without any compliance, at the point `at_m` \[m\]. The size of the mass depends on the
    /// design.
    fn weight_at(&self, at_m: Vector3<f64>) -> StationSlot {
        self.mass_on(Twist::zeros(), &at_m)
    }

    fn mass_on(&self, twist: Twist, at_m: &Vector3<f64>) -> StationSlot {
        StationSlot::Joint(StationJoint {
            twist,
            at_m: *at_m,
            tip_m_per_rad: displacement_at(&twist, self.tip_m),
            angle_rad: 0.0,
            own_nm: 0.0,
            inertia_per_kg: body_inertia(1.0, at_m, &Matrix3::zeros()),
            weight_per_kg: weight_wrench(self.structure.gravity_m_s2, &self.structure.down, at_m),
            // Rounding gives a rotated axis small components of the other plane. Such components do not count.
            block: usize::from(PLANES[1].iter().any(|&i| twist[i].abs() > ROUNDING * twist.amax())),
            turns: Vec::new(),
            is_passive: false,
        })
    }

    /// The slot of a point mass \[kg\] at a point.
    fn body(&self, mass_kg: f64, centre_m: &Vector3<f64>) -> StationSlot {
        StationSlot::Body {
            inertia: body_inertia(mass_kg, centre_m, &Matrix3::zeros()),
            weight: weight_wrench(mass_kg * self.structure.gravity_m_s2, &self.structure.down, centre_m),
        }
    }

    /// The slot of a given link: a tube, or a rigid offset with its point mass and the harness along it.
    fn link(&self, number: usize, link: &Link) -> StationSlot {
        let (at_m, rotation) = self.place;
        let piece = self.space.link_piece(link);
        let point = self.body(piece.point_mass_kg, &(at_m + rotation * link.vector_m / 2.0));
        let Some(tube) = Tube::new(&piece, self.structure, self.space.links, &[]) else { return point };
        if piece.beam.is_some() {
            return self.tube(number, (&link.vector_m, &link.bodies), 1);
        }
        let StationSlot::Body { inertia, weight } = point else { return point };
        // A harness on a rigid offset has mass but no compliance, so offset and harness are one rigid body.
        let place = self.place_of(&link.vector_m);
        let down = &self.structure.down;
        let placed = tube.condensed.place(&place.root_m, &place.end_m, &place.frame, down);
        let along = station_link(&tube, &placed, &place, (self.tip_m, down), false);
        StationSlot::Body { inertia: inertia + along.inertia, weight: weight + along.weight }
    }

    /// The slot of a tube that belongs to the piece `piece`, with memory for `options` options, which are added later.
    /// `vector_m` leads from its root to its end \[m\], and `bodies` are attached to it.
    fn tube(
        &self,
        piece: usize,
        (vector_m, bodies): (&Vector3<f64>, &[RigidBody]),
        options: usize,
    ) -> StationSlot {
        let of = |bodies| bodies_at(bodies, self.space, self.place);
        let is_symmetric = bodies.chunks(1).all(|body| uncoupled(&of(body).0));
        let (inertia, weight) = of(bodies);
        let place = self.place_of(vector_m);
        let pulls: Vec<&EndLoad> = self.springs_on(Side::Moving(piece)).collect();
        let on_axis = |load: &&EndLoad| pull_on(vector_m.norm(), &place.root_m, &place.frame, load);
        let hung = bodies
            .iter()
            .map(|body| OnAxis { xi: along(vector_m, &body.cg_m), wrench: of(std::slice::from_ref(body)).1 });
        let pulled = pulls.iter().map(|load| OnAxis { xi: on_axis(load).0, wrench: wrench_of(load) });
        let carried = OnTube {
            inertia,
            weight: weight + pulls.iter().map(|load| wrench_of(load)).sum::<Wrench>(),
            is_symmetric,
            loads: hung.chain(pulled).collect(),
            pulls: pulls.iter().map(on_axis).collect(),
        };
        StationSlot::Link { options: Vec::with_capacity(options), place, carried }
    }

    /// The forces and moments of springs on one side of a joint or on a link.
    fn springs_on(&self, side: Side) -> impl Iterator<Item = &EndLoad> {
        self.springs.iter().filter(move |load| load.on == side)
    }

    fn place_of(&self, vector_m: &Vector3<f64>) -> Place {
        let (root_m, rotation) = *self.place;
        let (vector_m, frame) = (rotation * vector_m, rotation.matrix() * section_frame(vector_m));
        Place { root_m, centre_m: root_m + vector_m / 2.0, end_m: root_m + vector_m, frame }
    }
}

/// The data of one option of a link in a pose. `tube` is the condensed option, `placed` the same in world axes, `place`
/// the position and attitude of the link. `tip_m` is the position of the tip \[m\], and `down` the direction of
/// gravity.
fn station_link(
    tube: &Tube,
    placed: &PlacedLink,
    place: &Place,
    (tip_m, down): (&Vector3<f64>, &Vector3<f64>),
    is_planar: bool,
) -> StationLink {
    let tips: Vec<Vector3<f64>> =
        (0..6).map(|g| displacement_at(&placed.end.column(g).into(), tip_m)).collect();
    StationLink {
        // This part of the inertia does not depend on the frequency and is taken for motions of the root: it is the
        // inertia of the link as a rigid body.
        inertia: placed.inertia[0].fixed_view::<6, 6>(0, 0).into_owned(),
        // The weight of a uniform tube acts at mid-length.
        weight: weight_wrench(tube.weight_n_per_m * tube.length_m, down, &place.centre_m),
        end: placed.end,
        own_weight_end: placed.end_per_weight * tube.weight_n_per_m + placed.end_under_bodies,
        tip: Matrix3x6::from_columns(&tips),
        end_inertia: placed.inertia[0].diagonal().fixed_rows::<6>(6).into_owned(),
        block: if is_planar { ends_by_block(placed) } else { [0; 6] },
        inner_trace_s2: placed.inner_trace_s2,
    }
}

/// Enters, at every driven joint in `slots`, the joints that turn along with it.
fn link_up(space: &DesignSpace, layers: &[(usize, Layer)], slots: &mut [StationSlot]) {
    let of_piece = |piece: usize| {
        layers
            .iter()
            .position(|(at, layer)| *at == piece && matches!(layer, Layer::Piece(SpacePiece::Joint(_))))
    };
    for linkage in space.linkages() {
        let (Some(driver), Some(slot)) = (of_piece(linkage.driver), of_piece(linkage.passive)) else {
            continue;
        };
        let StationSlot::Joint(passive) = &mut slots[slot] else { continue };
        passive.is_passive = true;
        let turned = Turned {
            slot,
            twist: passive.twist * linkage.factor,
            tip_m_per_rad: passive.tip_m_per_rad * linkage.factor,
            own_nm: passive.own_nm * linkage.factor,
        };
        if let StationSlot::Joint(joint) = &mut slots[driver] {
            joint.turns.push(turned);
        }
    }
}

fn put_into_one_block(slot: &mut StationSlot) {
    if let StationSlot::Joint(joint) = slot {
        joint.block = 0;
    }
}

/// Whether the inertia matrix `m` has no terms that couple motions within the x-z plane with motions across it.
fn uncoupled(m: &Matrix6<f64>) -> bool {
    let largest = m.amax();
    PLANES[0].iter().all(|&i| PLANES[1].iter().all(|&j| m[(i, j)].abs() <= ROUNDING * largest))
}

/// Whether motions within the x-z plane and motions across it are independent of each other in the whole arm: no
/// inertia, no joint axis and no link couples them.
fn planar(slots: &[StationSlot], payload: &Matrix6<f64>) -> bool {
    uncoupled(payload)
        && slots.iter().all(|slot| match slot {
            StationSlot::Joint(joint) => {
                let across = PLANES[1].iter().any(|&i| joint.twist[i].abs() > ROUNDING);
                let within = PLANES[0].iter().any(|&i| joint.twist[i].abs() > ROUNDING);
                !(across && within) && uncoupled(&joint.inertia_per_kg)
            }
            StationSlot::Body { inertia, .. } => uncoupled(inertia),
            StationSlot::Link { place, carried, .. } => is_symmetric(place) && carried.is_symmetric,
        })
}

/// Whether a link is symmetric about the x-z plane: its axis lies in the plane, and one axis of its section is across
/// the plane.
fn is_symmetric(place: &Place) -> bool {
    let size_m = place.root_m.amax().max(place.end_m.amax());
    let in_plane = |point_m: &Vector3<f64>| point_m.y.abs() <= ROUNDING * size_m;
    let one_of = |y: f64| y.abs() <= ROUNDING || (y.abs() - 1.0).abs() <= ROUNDING;
    in_plane(&place.root_m) && in_plane(&place.end_m) && place.frame.row(1).iter().all(|y| one_of(*y))
}

/// The block of each end coordinate of a link that is symmetric about the x-z plane: 0 within the plane, 1 across it.
/// Each block gets three coordinates.
fn ends_by_block(placed: &PlacedLink) -> [usize; 6] {
    let part = |column: usize, plane: usize| {
        let motions = placed.end.column(column);
        PLANES[plane].iter().map(|&i| motions[i].abs()).fold(0.0, f64::max)
    };
    // A coordinate that moves nothing (a direction without compliance) can be in either block. Such coordinates come
    // last and fill up the blocks.
    let mut order = ALL;
    order.sort_by_key(|&g| part(g, 0).max(part(g, 1)) == 0.0);
    let (mut blocks, mut counts) = ([0; 6], [0; 2]);
    for g in order {
        let wanted = usize::from(part(g, 1) > part(g, 0));
        let is_free = part(g, 0).max(part(g, 1)) == 0.0;
        blocks[g] = if is_free { usize::from(counts[0] == 3) } else { wanted };
        counts[blocks[g]] += 1;
    }
    blocks
}

/// The slots of an arm, restricted to the given motions (indices from 0 to 5). The options of links are added later.
fn block<const N: usize>(slots: &[StationSlot], payload: &Matrix6<f64>, motions: [usize; N]) -> Block<N> {
    let select = |m: &Matrix6<f64>| SMatrix::<f64, N, N>::from_fn(|i, j| m[(motions[i], motions[j])]);
    let restricted = |slot: &StationSlot| match slot {
        StationSlot::Joint(joint) => BlockSlot::Joint {
            twist: SVector::from_fn(|i, _| joint.twist[motions[i]]),
            inertia_per_kg: select(&joint.inertia_per_kg),
        },
        StationSlot::Body { inertia, .. } => BlockSlot::Body(select(inertia)),
        StationSlot::Link { options, .. } => BlockSlot::Links(Vec::with_capacity(options.capacity())),
    };
    Block { payload: select(payload), slots: slots.iter().map(restricted).collect() }
}

impl<const N: usize> Block<N> {
    /// Adds the options `placed` of the link in `slot`, restricted to the given motions (indices from 0 to 5).
    fn add(&mut self, slot: usize, placed: &[PlacedLink], motions: [usize; N]) {
        if let BlockSlot::Links(options) = &mut self.slots[slot] {
            options.par_extend(placed.par_iter().map(|placed| block_link(placed, motions)));
        }
    }
}

/// One option of a link, restricted to the given motions (indices from 0 to 5) and to the end coordinates that belong
/// to them.
fn block_link<const N: usize>(placed: &PlacedLink, motions: [usize; N]) -> BlockLink<N> {
    let mut ends = [0; N];
    // A single block of six motions has all end coordinates. Of two blocks, each has the three end coordinates that
    // move it.
    if N == 6 {
        ends.copy_from_slice(&ALL[..N]);
    } else {
        let blocks = ends_by_block(placed);
        let wanted = usize::from(motions[0] == PLANES[1][0]);
        let members = (0..6).filter(|&g| blocks[g] == wanted);
        ends.iter_mut().zip(members).for_each(|(slot, g)| *slot = g);
    }
    let part = |rows: [usize; N], columns: [usize; N]| {
        placed.inertia.map(|m| SMatrix::<f64, N, N>::from_fn(|i, j| m[(rows[i], columns[j])]))
    };
    // In the matrices of a condensed link, rows 0 to 5 belong to the motions of the root and rows 6 to 11 to the end
    // coordinates.
    let inner = ends.map(|g| 6 + g);
    BlockLink {
        root: part(motions, motions),
        cross: part(motions, inner),
        end_inertia: part(inner, inner),
        end: SMatrix::from_fn(|i, j| placed.end[(motions[i], ends[j])]),
    }
}
