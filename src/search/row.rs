//! Rows: the options of the row level, prepared so that eight designs are evaluated at once.
//!
//! All designs of a row have the same arm outboard of the row level and the same chosen drives inboard of it. A sweep
//! therefore evaluates them together. Three things are needed for this:
//!
//! - [`Chunk`] has the numbers of eight options, next to each other in memory. They are computed once for the whole
//!   sweep.
//! - [`Begun`](super::row_begun::Begun) has the numbers that depend on the arm outboard. They are computed once for
//!   each row.
//! - [`row_lanes`](super::row_lanes) computes the designs from both.
//!
//! Each of the eight designs has a *lane*: its place in every list of eight numbers. A chunk takes some tens of
//! kilobytes. The designs of several rows are evaluated in a batch, so that a chunk stays in the nearest cache while
//! it is used for all these rows.
//!
//! An *inner* slot is one from the row level to the base. Inner slots are numbered from 0. A *hinge* is one elastic
//! coordinate of an inner slot: a joint or bearing spring has one hinge, and a given tube has six, one for each end
//! coordinate of its condensed link. The hinge of a joint has the number of its slot. The hinges of tubes are
//! numbered after all slots.

use super::row_bearing::RowBearing;
use super::row_drives::{DriveAttributes, drive_attributes};
use super::row_room::RowRoom;
use crate::arm::joint_law::JointLaw;
use crate::mechanics::lanes::{Eight, LANES};
use crate::mechanics::lowest_lanes::LaneLink;
use crate::mechanics::{Twist, Wrench};
use crate::space::attributes::OptionAttributes;
use crate::space::problem::{ArmProblem, Partial};
use crate::space::slot::Slot;
use crate::space::station::{Block, BlockSlot, Modal, Station, StationLink, StationSlot};
use nalgebra::{Matrix3x6, Matrix6, Vector3, Vector6};
use std::ops::Range;

/// The slots from the row level to the base (inner slots), with every number of theirs that is the same in all rows.
pub(crate) struct Row {
    /// Slot number of the row level.
    pub first: usize,
    /// One entry for each inner slot (the slots from the row level to the base). If the search chooses the drive of the
    /// slot: the index of this choice among the levels inboard of the row level, in order towards the base. Otherwise
    /// `None`.
    pub chosen: Vec<Option<usize>>,
    /// The options of the row's link, eight in a chunk; empty if the row level is the drive of a joint.
    pub chunks: Vec<Chunk>,
    /// For each case, the numbers that do not depend on the option of the row level.
    pub cases: Vec<RowCase>,
    /// Masses and torsion curves of the drives that each inner slot can have, one entry for each inner slot. An entry
    /// for a link or an offset has no drives.
    pub drives: Vec<DriveAttributes>,
    /// Indices of the inner slots that deflect elastically. The link of the row level is left out.
    pub yielding: Vec<usize>,
    /// The hinges (elastic coordinates) of all inner slots. The link of the row level is left out.
    pub hinges: Vec<Hinge>,
    /// Mass of the given drives, tubes and offsets among the inner slots \[kg\].
    pub fixed_kg: f64,
    /// Form of the torsion curves of the drives in each inner slot. It decides how their twist is computed.
    pub twisting: Vec<Twisting>,
    /// The checked output bearings of the joints inboard of the row level.
    pub bearings: Vec<RowBearing>,
    /// The room for gear and motor at the joints inboard of the row level.
    pub rooms: Vec<RowRoom>,
}

/// A hinge: one elastic coordinate of an inner slot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Hinge {
    /// Number of the hinge. It is the hinge's index in lists that have an entry per hinge.
    pub number: usize,
    /// Inner slot that has this coordinate.
    pub slot: usize,
    /// Number of the end coordinate (0 to 5) of a given tube; `None` for a joint.
    pub end: Option<usize>,
}

/// The form of the torsion curves that the drives of a joint have in the judged cases. The simpler forms save work in
/// the sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Twisting {
    /// No load turns the joint. The angle stays zero, and modes use the first slope of the curve.
    AtRest,
    /// The curve of every drive has a single slope.
    Line,
    /// The curves of the drives have three segments.
    Segments,
    /// The joint has play or friction. Each of the eight drives is computed alone.
    Play,
}

/// Torque and inertia about the axis of a joint. Both are caused by some piece, or by several pieces, outboard of the
/// joint.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct AtJoint {
    /// Torque about the joint's axis that these pieces make \[N m\].
    pub torque_nm: f64,
    /// Inertia of these pieces about the joint's axis \[kg m²\].
    pub inertia_kgm2: f64,
}

/// Torque and inertia about each hinge; the index is the number of the hinge.
pub(crate) type AtJoints = Vec<AtJoint>;

/// Numbers of one case that depend on the pose but not on the option of the row level.
pub(crate) struct RowCase {
    /// For each hinge, whether some load or weight turns it. At the other hinges the torque is zero in every arm.
    pub turned: Vec<bool>,
    /// Torque and inertia about each hinge per kilogram of the drive in an inner slot; first index the inner slot of
    /// the drive, second the number of the hinge.
    pub per_kg: Vec<AtJoints>,
    /// Torque and inertia about each hinge that the inner pieces with a given mass cause.
    pub fixed: AtJoints,
    /// Torque \[N m\] on each hinge per newton of the weight of the row's link. All options of a link have the same
    /// centre of mass, so one number serves for all.
    pub link_torque: Vec<f64>,
    /// Loads at the root of the row's link per newton of the link's own weight: axial force \[N\], torsion and both
    /// bending moments \[N m\].
    pub link_weight_at_root: [f64; 4],
    /// Whether bending of the row's link (the link of the row level) can move the tip in x, in y and in z.
    pub bends: [bool; 3],
    /// The entries (block, row, column) of the inertia matrix of everything outboard that count in Dunkerley's sum.
    /// They are those that the end of the row's link sets in motion.
    pub spread_entries: Vec<(usize, usize, usize)>,
    /// For each block of the eigenvalue problem, the range of `spread_entries` that belongs to it.
    pub spread_of: [Range<usize>; 2],
    /// For each block of the eigenvalue problem, the number of inner slots that take part in its modes: all from the
    /// row level to the last compliant one. Slots inboard of that one stand still in every mode.
    pub ends: [usize; 2],
    /// Whether at least one option of the row's link is elastic in this case. If none is, the link is rigid (or the row
    /// level is not a link).
    pub links_yield: bool,
    /// Contribution of the given tubes to Dunkerley's sum (the sum of `1/λ` over the eigenvalues) of each block \[s²\].
    /// It counts the mass of each tube itself, without the mass outboard of it.
    pub tubes_trace_s2: [f64; 2],
    /// Whether the case counts for deflection and lowest mode.
    pub judged: bool,
    /// Whether the drives are checked in the case.
    pub sizing: bool,
}

/// Eight options of the row's link. The last chunk is filled up with copies of the last option.
pub(crate) struct Chunk {
    /// Mass of each option \[kg\].
    pub mass_kg: Eight,
    /// Material cost of each option \[EUR\]; 0 if it is not known.
    pub cost_eur: Eight,
    /// Number of the material of each option, in the list of the materials that get a front of their own.
    pub materials: [Option<usize>; LANES],
    /// Whether the eight options are of the same material.
    pub of_one_material: bool,
    /// Bit mask, one bit per option: the options whose wall is too slender.
    pub slender: u8,
    /// Factors from which the stress in the link follows with each option.
    pub stress: StressEight,
    /// The eight options in each case.
    pub cases: Vec<CaseChunk>,
}

/// Ratio of stress to strength, per unit of force or moment, for eight link options. It is 0 if the strength is not
/// known.
#[derive(Default)]
pub(crate) struct StressEight {
    /// Ratio of stress to strength per newton of axial force.
    pub per_axial_n: Eight,
    /// Ratio of stress to strength per newton metre of bending moment about the section's y axis.
    pub per_moment_y: Eight,
    /// Ratio of stress to strength per newton metre of bending moment about the section's z axis.
    pub per_moment_z: Eight,
    /// Ratio of stress to strength per newton metre of torsion.
    pub per_torsion: Eight,
    /// Bit mask, one bit per option: the options of round section, in which both bending moments add as vectors.
    pub round: u8,
}

/// What eight options of the row's link contribute in one case: weight, tip displacement, inertia about the inner
/// joints, and the terms for the lowest mode.
pub(crate) struct CaseChunk {
    /// Weight of each option \[N\].
    pub weight_n: Eight,
    /// Displacement of the tip \[m\] in x, y and z, per unit of each component of the wrench on the link's end.
    pub flexibility: [[Eight; 6]; 3],
    /// Displacement of the tip \[m\] in x, y and z, caused by the weight of the link itself.
    pub own_weight_deflection_m: [Eight; 3],
    /// Inertia of the row's link, with each option, about each hinge inboard \[kg m²\].
    pub inertia_at: Vec<Eight>,
    /// Contribution to Dunkerley's sum (the sum of `1/λ` over all eigenvalues) per unit of each entry of the outboard
    /// inertia matrix, in the order of [`RowCase::spread_entries`].
    pub spread: Vec<Eight>,
    /// Contribution of the row's link, with its own mass alone, to Dunkerley's sum (the sum of `1/λ` over the
    /// eigenvalues) of each block \[s²\].
    pub trace_s2: [Eight; 2],
    /// The eight link options in the form in which the computation of the lowest mode needs them.
    pub modal: ChunkModal,
}

/// Eight options of the row's link, in the form in which the computation of the lowest mode needs them.
pub(crate) enum ChunkModal {
    Planar(Box<[LaneLink<3>; 2]>),
    Spatial(Box<LaneLink<6>>),
}

/// Eight designs of one row: which row, and which chunk of its options.
#[derive(Clone, Copy)]
pub(crate) struct RowChunk<'a, 'c> {
    pub problem: &'a ArmProblem<'c>,
    pub row: &'a Row,
    /// The arm outboard of the row level, which all designs of the row have in common.
    pub from: &'a Partial,
    /// Option of each level inboard of the row level, in order towards the base.
    pub inner: &'a [u32],
    /// Number of the chunk (eight options of the row level) to which the eight designs belong.
    pub chunk: usize,
}

impl Row {
    /// Prepares the inner slots of a problem for the evaluation of eight designs at once. `None` where the designs must
    /// be evaluated one by one: if there is no level; if a given tube inboard is too slender, so that no design meets
    /// its limits; if the space has linkages or effects that are not written for eight designs at once; and if springs
    /// pull on tubes, because the stress is then not checked for eight designs at once.
    pub(crate) fn new(problem: &ArmProblem) -> Option<Self> {
        if problem.space().beyond_exact().is_some() || problem.space().pulls_on_tubes() {
            return None;
        }
        let first = problem.row_slot()?;
        let slots = &problem.slots()[first..];
        let given_tubes = || slots[1..].iter().filter_map(Slot::given_tube);
        if given_tubes().any(|tube| tube.slender) {
            return None;
        }
        let hinges = hinges(slots);
        let space = problem.space();
        let cases: Vec<RowCase> = problem
            .stations()
            .iter()
            .enumerate()
            .map(|(case, station)| {
                let (judged, sizing) =
                    (space.judged_cases.contains(&case), space.sizing_cases.contains(&case));
                RowCase::new(station, slots, &hinges, first, [judged, sizing])
            })
            .collect();
        let chunks = match &slots[0] {
            Slot::Link { options, .. } => (0..options.len().div_ceil(LANES))
                .map(|c| Chunk::new(problem, &cases, &hinges, options, c))
                .collect(),
            _ => Vec::new(),
        };
        let drives: Vec<DriveAttributes> = slots.iter().map(drive_attributes).collect();
        Some(Self {
            first,
            chosen: chosen(problem, first),
            chunks,
            yielding: (0..slots.len()).filter(|&k| hinges.iter().any(|hinge| hinge.slot == k)).collect(),
            fixed_kg: slots.iter().filter_map(Slot::fixed_kg).sum::<f64>()
                + given_tubes().map(|tube| tube.mass_kg).sum::<f64>(),
            twisting: (0..slots.len()).map(|k| twisting(&slots[k], &drives[k], k, &cases)).collect(),
            bearings: RowBearing::all(problem, first),
            rooms: RowRoom::all(problem, first),
            hinges,
            cases,
            drives,
        })
    }
}

/// One entry for each inner slot, the slots from `first` (the slot of the row level) to the base. If the search chooses
/// the drive of the slot: the index of this choice among the levels inboard of the row level. Otherwise `None`.
fn chosen(problem: &ArmProblem, first: usize) -> Vec<Option<usize>> {
    let inner: Vec<usize> = problem.level_slots().iter().copied().filter(|&slot| slot > first).collect();
    (first..problem.slots().len()).map(|slot| inner.iter().position(|&level| level == slot)).collect()
}

/// The hinges (elastic coordinates) of the inner slots `slots`, without those of the row's link.
fn hinges(slots: &[Slot]) -> Vec<Hinge> {
    let mut tubes = slots.len();
    let mut hinges = Vec::new();
    for (slot, piece) in slots.iter().enumerate() {
        match piece {
            Slot::Given { .. } | Slot::Sized(_) | Slot::Bearing { .. } => {
                hinges.push(Hinge { number: slot, slot, end: None });
            }
            // the first slot may be the link of the row, which is no hinge
            Slot::Link { .. } if slot > 0 => {
                hinges.extend((0..6).map(|end| Hinge { number: tubes + end, slot, end: Some(end) }));
                tubes += 6;
            }
            _ => {}
        }
    }
    hinges
}

/// Length of a list that has an entry for the number of every hinge. Each slot takes one number, even if it has no
/// hinge.
pub(super) fn hinge_numbers(slots: &[Slot]) -> usize {
    hinges(slots).iter().map(|hinge| hinge.number + 1).fold(slots.len(), usize::max)
}

impl Hinge {
    /// Motion of everything outboard of this hinge per unit of the hinge's coordinate: velocity and angular velocity at
    /// the world's origin. `slots` are the inner slots of a case.
    pub(super) fn twist(&self, slots: &[StationSlot]) -> Twist {
        match (&slots[self.slot], self.end) {
            (StationSlot::Joint(joint), _) => joint.twist,
            (StationSlot::Link { options, .. }, Some(end)) => options[0].end.column(end).into_owned(),
            _ => Twist::zeros(),
        }
    }
}

/// The form that the torsion curves of the drives in inner slot `k` have in the judged cases. `drives` are the drives
/// of this slot.
fn twisting(slot: &Slot, drives: &DriveAttributes, k: usize, cases: &[RowCase]) -> Twisting {
    let has_play = match slot {
        Slot::Given { law, .. } => law.has_play(),
        Slot::Sized(sized) => sized.laws.iter().any(JointLaw::has_play),
        _ => false,
    };
    // only judged cases need the angle of a joint; cases that only size drives need the torque alone
    let turned = cases.iter().filter(|case| case.judged).any(|case| case.turned[k]);
    let [first, second, third] = &drives.compliance;
    match (has_play, turned) {
        (true, _) => Twisting::Play,
        (false, false) => Twisting::AtRest,
        (false, true) if first == second && second == third => Twisting::Line,
        (false, true) => Twisting::Segments,
    }
}

impl RowCase {
    /// Computes the numbers of the case `station`. `pieces` are the inner slots, and `first` is the slot of the row
    /// level. `judged` and `sizing` tell what the case counts for.
    fn new(
        station: &Station,
        pieces: &[Slot],
        hinges: &[Hinge],
        first: usize,
        [judged, sizing]: [bool; 2],
    ) -> Self {
        let slots = &station.slots[first..];
        let numbers = hinge_numbers(pieces);
        let mut per_kg = vec![vec![AtJoint::default(); numbers]; slots.len()];
        let mut fixed = vec![AtJoint::default(); numbers];
        for (k, (slot, piece)) in slots.iter().zip(pieces).enumerate() {
            let (inertia, weight, fixed_times) = match slot {
                StationSlot::Joint(joint) => (&joint.inertia_per_kg, &joint.weight_per_kg, piece.fixed_kg()),
                StationSlot::Body { inertia, weight } => (inertia, weight, Some(1.0)),
                StationSlot::Link { options, .. } if k > 0 => {
                    (&options[0].inertia, &options[0].weight, Some(1.0))
                }
                StationSlot::Link { .. } => continue,
            };
            // the mass of a drive is inboard of its own joint, so a piece loads only hinges that are inboard of the
            // piece
            for hinge in hinges.iter().filter(|hinge| hinge.slot > k) {
                let own = AtJoint::new(&hinge.twist(slots), inertia, weight);
                // masses that are known are added once for all rows; the mass of a sized drive differs from design to
                // design
                match fixed_times {
                    Some(times) => fixed[hinge.number].add(own, times),
                    None => per_kg[k][hinge.number] = own,
                }
            }
        }
        let links: &[StationLink] = match &slots[0] {
            StationSlot::Link { options, .. } => options,
            _ => &[],
        };
        // the weights of the options differ in size but not in line of action, so any option gives the wrench per
        // newton
        let down = &station.down;
        let link_weight = links
            .iter()
            .find(|l| l.weight_n(down) != 0.0)
            .map_or(Vector6::zeros(), |l| l.weight / l.weight_n(down));
        let links_yield = links.iter().any(|l| l.end.amax() > 0.0);
        let link_weight_at_root = match &slots[0] {
            StationSlot::Link { place, .. } => place.local(&link_weight, &place.root_m),
            _ => [0.0; 4],
        };
        let ends = match &station.modal {
            Modal::Planar(blocks) => [0, 1].map(|b| last_yielding(&blocks[b], first, links_yield)),
            Modal::Spatial(block) => [last_yielding(block, first, links_yield), 0],
        };
        let spread_entries = if links_yield { spread_entries(&station.modal) } else { Vec::new() };
        // the entries of block 0 come first
        let of_first = spread_entries.partition_point(|(block, ..)| *block == 0);
        let (turned, link_torque) = turning(station, slots, hinges, numbers, &link_weight);
        Self {
            turned,
            per_kg,
            fixed,
            link_torque,
            link_weight_at_root,
            bends: bends(links),
            spread_of: [0..of_first, of_first..spread_entries.len()],
            spread_entries,
            ends,
            links_yield,
            tubes_trace_s2: tubes_trace_s2(&slots[1..]),
            judged,
            sizing,
        }
    }
}

impl AtJoint {
    /// Torque and inertia about an axis. `twist` is the motion per radian of turning about it. `inertia` is the inertia
    /// matrix of the bodies that move, and `wrench` the load on them.
    pub(super) fn new(twist: &Twist, inertia: &Matrix6<f64>, wrench: &Wrench) -> Self {
        Self { torque_nm: twist.dot(wrench), inertia_kgm2: twist.dot(&(inertia * twist)) }
    }

    /// Adds `times` times the torque and the inertia of `other`.
    pub(super) fn add(&mut self, other: Self, times: f64) {
        self.torque_nm += times * other.torque_nm;
        self.inertia_kgm2 += times * other.inertia_kgm2;
    }
}

/// Contribution of the given tubes to Dunkerley's sum (the sum of `1/λ` over all eigenvalues) of each block \[s²\].
/// Only the mass of each tube itself counts here, and not the mass outboard of it.
fn tubes_trace_s2(slots: &[StationSlot]) -> [f64; 2] {
    let mut sum_s2 = [0.0; 2];
    for slot in slots {
        if let StationSlot::Link { options, .. } = slot {
            let tube = &options[0];
            // the end coordinates have unit stiffness, so their inertias are the terms of the sum
            (0..6).for_each(|g| sum_s2[tube.block[g]] += tube.end_inertia[g]);
            sum_s2.iter_mut().for_each(|sum| *sum += tube.inner_trace_s2);
        }
    }
    sum_s2
}

/// For each hinge: whether some load of the case turns it, and the torque on it per newton of the weight of the row's
/// link. `link_weight` is the wrench of this weight per newton.
fn turning(
    station: &Station,
    slots: &[StationSlot],
    hinges: &[Hinge],
    numbers: usize,
    link_weight: &Wrench,
) -> (Vec<bool>, Vec<f64>) {
    let loaded = loaded(station);
    let (mut turned, mut link_torque) = (vec![false; numbers], vec![0.0; numbers]);
    for hinge in hinges {
        let twist = hinge.twist(slots);
        // compared with exact zeros: a torque that is zero by symmetry is left out, one that is merely small is not
        turned[hinge.number] = (0..6).any(|i| loaded[i] && twist[i] != 0.0);
        link_torque[hinge.number] = twist.dot(link_weight);
    }
    (turned, link_torque)
}

/// Whether the bending of a link moves the tip in x, in y and in z, for at least one of the options `links`.
fn bends(links: &[StationLink]) -> [bool; 3] {
    links.iter().fold([false; 3], |bends, link| {
        let (flexibility, own_m) = (link.flexibility(), link.own_weight_deflection_m());
        std::array::from_fn(|i| bends[i] || own_m[i] != 0.0 || flexibility.row(i).amax() > 0.0)
    })
}

/// For each of the six components of a wrench, whether some load or weight of the case has this component.
fn loaded(station: &Station) -> [bool; 6] {
    let weights = station.slots.iter().flat_map(|slot| match slot {
        StationSlot::Joint(joint) => vec![&joint.weight_per_kg],
        StationSlot::Body { weight, .. } => vec![weight],
        StationSlot::Link { options, .. } => options.iter().map(|option| &option.weight).collect(),
    });
    let mut loaded = [false; 6];
    for wrench in weights.chain([&station.start_wrench]) {
        loaded.iter_mut().zip(wrench.iter()).for_each(|(loaded, x)| *loaded |= *x != 0.0);
    }
    loaded
}

/// Number of inner slots from the row level to the last one that is compliant in this block; 0 if none is. `first` is
/// the slot of the row level, and `links_yield` tells whether some option of the row's link is compliant.
fn last_yielding<const N: usize>(block: &Block<N>, first: usize, links_yield: bool) -> usize {
    let yields = |slot: &BlockSlot<N>| match slot {
        BlockSlot::Joint { twist, .. } => twist.amax() > 0.0,
        BlockSlot::Links(options) => options[0].yields(),
        BlockSlot::Body(_) => false,
    };
    // the first slot may be the link of the row, of which some options may be compliant
    let inner = block.slots[first + 1..].iter().rposition(yields).map(|last| last + 2);
    let of_row = match &block.slots[first] {
        BlockSlot::Links(_) => links_yield,
        slot => yields(slot),
    };
    inner.unwrap_or(usize::from(of_row))
}

/// Entries (block, row, column) of the lower triangle of the outboard inertia matrix that the ends of links in each
/// block set in motion. No other entry counts in Dunkerley's sum.
fn spread_entries(modal: &Modal) -> Vec<(usize, usize, usize)> {
    let lower = |block: usize, motions: &[usize]| -> Vec<(usize, usize, usize)> {
        let pairs = motions.iter().flat_map(|&i| motions.iter().map(move |&j| (i, j)));
        pairs.filter(|(i, j)| i >= j).map(|(i, j)| (block, i, j)).collect()
    };
    match modal {
        Modal::Planar(_) => [lower(0, &[0, 2, 4]), lower(1, &[1, 3, 5])].concat(),
        Modal::Spatial(_) => lower(0, &[0, 1, 2, 3, 4, 5]),
    }
}

impl Chunk {
    /// Computes the numbers of chunk `c`: of the eight link options from number `8 c` on. `options` are all options of
    /// the link.
    fn new(
        problem: &ArmProblem,
        cases: &[RowCase],
        hinges: &[Hinge],
        options: &[OptionAttributes],
        c: usize,
    ) -> Self {
        let first = problem.row_slot().unwrap_or_default();
        // lanes beyond the last option repeat it; their results are ignored
        let at = |lane: usize| (LANES * c + lane).min(options.len() - 1);
        let lanes =
            |of: &dyn Fn(&OptionAttributes) -> f64| std::array::from_fn(|lane| of(&options[at(lane)]));
        let bits = |of: &dyn Fn(&OptionAttributes) -> bool| {
            (0..LANES).fold(0, |bits, lane| bits | u8::from(of(&options[at(lane)])) << lane)
        };
        let stress = |of: &dyn Fn(&crate::space::attributes::StressCheck) -> f64| {
            // the stress of a material of unknown strength is not checked: its ratio is 0
            lanes(&|o| o.stress.as_ref().map_or(0.0, |s| of(s) / s.strength_pa))
        };
        let materials: [Option<usize>; LANES] = std::array::from_fn(|lane| options[at(lane)].material);
        Self {
            mass_kg: lanes(&|o| o.mass_kg),
            cost_eur: lanes(&|o| o.cost_eur.unwrap_or(0.0)),
            materials,
            of_one_material: materials.iter().all(|m| *m == materials[0]),
            slender: bits(&|o| o.slender),
            stress: StressEight {
                per_axial_n: stress(&|s| s.per_axial_n),
                per_moment_y: stress(&|s| s.per_moment_y),
                per_moment_z: stress(&|s| s.per_moment_z),
                per_torsion: stress(&|s| s.per_torsion),
                round: bits(&|o| o.stress.as_ref().is_some_and(|s| s.round)),
            },
            cases: problem
                .stations()
                .iter()
                .zip(cases)
                .filter_map(|(station, case)| CaseChunk::new(station, case, hinges, first, &at))
                .collect(),
        }
    }
}

impl CaseChunk {
    /// Computes the numbers of the eight link options of a chunk in one case. `at(lane)` is the number of the option in
    /// a lane, and `first` the slot of the link.
    fn new(
        station: &Station,
        case: &RowCase,
        hinges: &[Hinge],
        first: usize,
        at: &dyn Fn(usize) -> usize,
    ) -> Option<Self> {
        let StationSlot::Link { options, .. } = &station.slots[first] else { return None };
        let links: [&StationLink; LANES] = std::array::from_fn(|lane| &options[at(lane)]);
        let lanes = |of: &dyn Fn(&StationLink) -> f64| links.map(of);
        let (flexibility, own_m) =
            (links.map(StationLink::flexibility), links.map(StationLink::own_weight_deflection_m));
        let mut inertia_at = vec![[0.0; LANES]; case.turned.len()];
        for hinge in hinges {
            let twist = hinge.twist(&station.slots[first..]);
            inertia_at[hinge.number] = lanes(&|l| twist.dot(&(l.inertia * twist)));
        }
        let trace = |block: usize| {
            lanes(&|l| {
                // the end coordinates have unit stiffness, so their inertias are the terms of the sum
                let ends: f64 = (0..6).filter(|&g| l.block[g] == block).map(|g| l.end_inertia[g]).sum();
                ends + l.inner_trace_s2
            })
        };
        Some(Self {
            // the weight acts along the direction of gravity, `down`
            weight_n: lanes(&|l| l.weight_n(&station.down)),
            flexibility: std::array::from_fn(|i| {
                std::array::from_fn(|j| flexibility.map(|f: Matrix3x6<f64>| f[(i, j)]))
            }),
            own_weight_deflection_m: std::array::from_fn(|i| own_m.map(|s: Vector3<f64>| s[i])),
            inertia_at,
            spread: case.spread_entries.iter().map(|entry| lanes(&|l| spread_of(l, *entry))).collect(),
            trace_s2: [trace(0), trace(1)],
            modal: chunk_modal(&station.modal, first, at),
        })
    }
}

/// Contribution of a link to Dunkerley's sum (the sum of `1/λ` over all eigenvalues) per unit of one entry of the
/// outboard inertia matrix. The entry is given by its block, row `i` and column `j`.
fn spread_of(link: &StationLink, (block, i, j): (usize, usize, usize)) -> f64 {
    (0..6).filter(|&g| link.block[g] == block).map(|g| link.end[(i, g)] * link.end[(j, g)]).sum()
}

/// The eight options of a chunk as the computation of the lowest mode needs them. `at(lane)` is the number of the
/// option in a lane, and `first` the slot of the link.
fn chunk_modal(modal: &Modal, first: usize, at: &dyn Fn(usize) -> usize) -> ChunkModal {
    match modal {
        Modal::Planar(blocks) => {
            let [within, across] = &**blocks;
            ChunkModal::Planar(Box::new([lane_link(within, first, at), lane_link(across, first, at)]))
        }
        Modal::Spatial(block) => ChunkModal::Spatial(Box::new(lane_link(block, first, at))),
    }
}

/// The eight options of a chunk in one block of the eigenvalue problem. `at(lane)` is the number of the option in a
/// lane, and `first` the slot of the link.
fn lane_link<const N: usize>(block: &Block<N>, first: usize, at: &dyn Fn(usize) -> usize) -> LaneLink<N> {
    match &block.slots[first] {
        BlockSlot::Links(options) => LaneLink::new(std::array::from_fn(|lane| &options[at(lane)])),
        _ => unreachable!("a chunk is made of a slot of links"),
    }
}
