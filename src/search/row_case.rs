//! The numbers of a row that depend on the case, but not on the option of the row level: the torques and inertias about
//! the hinges, and the numbers that the eigenvalue problem of the case needs. An inner slot is a place of the
//! arm from the row level to the base. A hinge is one elastic coordinate of an inner slot.

use crate::mechanics::{Twist, Wrench};
use crate::space::slot::Slot;
use crate::space::station::{Block, BlockSlot, Modal, Station, StationLink, StationSlot};
use nalgebra::{Matrix6, Vector3, Vector6};
use std::ops::Range;

/// A hinge: one elastic coordinate of an inner slot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Hinge {
    /// Number of the hinge. It is the hinge's index in lists that have an entry per hinge.
    pub number: usize,
    /// Inner slot that has this coordinate.
    pub slot: usize,
    /// Number of the end coordinate (motion of the tube's end, 0 to 5) of a given tube; `None` for a joint.
    pub end: Option<usize>,
}

/// Static torque about a hinge from the loads on pieces outboard of it, and the inertia of these pieces about it. The
/// units are those of a joint that turns.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct AtJoint {
    /// Torque of the loads on these pieces about the axis of the hinge \[N m\].
    pub torque_nm: f64,
    /// Inertia of these pieces about the axis of the hinge \[kg m²\].
    pub inertia_kgm2: f64,
}

/// Torque and inertia about each hinge; the index is the number of the hinge.
pub(crate) type AtJoints = Vec<AtJoint>;

/// Position of an entry of an inertia matrix: its block of the eigenvalue problem, its row and its column.
#[derive(Clone, Copy)]
pub(crate) struct Entry {
    pub block: usize,
    pub row: usize,
    pub column: usize,
}

/// Numbers of one case that depend on the pose but not on the option of the row level.
pub(crate) struct RowCase {
    /// For each hinge, whether some load or weight turns it. At the other hinges the torque is zero in every arm.
    pub turned: Vec<bool>,
    /// Torque and inertia about each hinge per kilogram of the drive in an inner slot; first index the inner slot of
    /// the drive, second the number of the hinge.
    pub per_kg: Vec<AtJoints>,
    /// Torque and inertia about each hinge, caused by the inner pieces whose mass is given.
    pub fixed: AtJoints,
    /// Torque \[N m\] on each hinge per newton of the weight of the row's link. All options of a link have the same
    /// centre of mass, so one number serves for all.
    pub link_torque: Vec<f64>,
    /// Loads at the root of the row's link per newton of the link's own weight: axial force \[N\], torsion and both
    /// bending moments \[N m\].
    pub link_weight_at_root: [f64; 4],
    /// Whether bending of the row's link (the link of the row level) can move the tip in x, in y and in z.
    pub bends: [bool; 3],
    /// The entries of the outboard inertia matrix that enter Dunkerley's sum. Row and column are motions of the block in
    /// which the end of the row's link can move. Empty if the row's link is rigid.
    pub spread_entries: Vec<Entry>,
    /// For each block of the eigenvalue problem, the range of `spread_entries` that belongs to it.
    pub spread_of: [Range<usize>; 2],
    /// For each block of the eigenvalue problem, the number of inner slots that take part in its modes: all from the
    /// row level to the last compliant one. Slots inboard of that slot stand still in every mode.
    pub ends: [usize; 2],
    /// Whether at least one option of the row's link is elastic in this case. If none is, the link is rigid (or the row
    /// level is not a link).
    pub links_are_compliant: bool,
    /// Contribution of the given tubes to Dunkerley's sum (the sum of `1/λ` over the eigenvalues) of each block \[s²\].
    /// Only the mass of each tube itself is included, and not the mass outboard of it.
    pub tubes_trace_s2: [f64; 2],
    /// Whether the case counts for deflection and lowest mode.
    pub judged: bool,
    /// Whether the drives are checked in the case.
    pub sizing: bool,
}

/// The hinges (elastic coordinates) of the inner slots `slots`, without the hinges of the row's link.
pub(super) fn hinges(slots: &[Slot]) -> Vec<Hinge> {
    let mut tubes = slots.len();
    let mut hinges = Vec::new();
    for (slot, piece) in slots.iter().enumerate() {
        match piece {
            Slot::Given { .. } | Slot::Sized(_) | Slot::Bearing { .. } => {
                hinges.push(Hinge { number: slot, slot, end: None });
            }
            // The first slot may have the link of the row, which has no hinges.
            Slot::Link { .. } if slot > 0 => {
                hinges.extend((0..6).map(|end| Hinge { number: tubes + end, slot, end: Some(end) }));
                tubes += 6;
            }
            _ => {}
        }
    }
    hinges
}

/// Length of a list that is indexed by the number of a hinge. Every slot reserves one number, also a slot without a
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

impl RowCase {
    /// Computes the numbers of the case `station`. `pieces` are the inner slots, and `first` is the slot of the row
    /// level. `judged` tells whether the case counts for deflection and lowest mode, and `sizing` whether drives are
    /// checked in it.
    pub(super) fn new(
        station: &Station,
        pieces: &[Slot],
        hinges: &[Hinge],
        first: usize,
        [judged, sizing]: [bool; 2],
    ) -> Self {
        let slots = &station.slots[first..];
        let numbers = hinge_numbers(pieces);
        let (per_kg, fixed) = at_joints_of_pieces(slots, pieces, hinges, numbers);
        let links = link_options(&slots[0]);
        let link_weight = link_weight_per_n(links, &station.down);
        let links_are_compliant = links.iter().any(|l| l.end.amax() > 0.0);
        let link_weight_at_root = match &slots[0] {
            StationSlot::Link { place, .. } => place.local(&link_weight, &place.root_m),
            _ => [0.0; 4],
        };
        let spread_entries = if links_are_compliant { spread_entries(&station.modal) } else { Vec::new() };
        // The entries of block 0 stand before those of block 1.
        let of_first = spread_entries.partition_point(|entry| entry.block == 0);
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
            ends: compliant_ends(&station.modal, first, links_are_compliant),
            links_are_compliant,
            tubes_trace_s2: tubes_trace_s2(&slots[1..]),
            judged,
            sizing,
        }
    }
}

/// Torque and inertia about each hinge that the inner pieces cause, in two lists. The first has torque and inertia per
/// kilogram of the drive in each inner slot. The second has torque and inertia due to all pieces with a given mass.
/// `slots` are the inner slots of the case, and `pieces` the same slots of the problem. `numbers` is the length of a
/// list with an entry for the number of every hinge.
fn at_joints_of_pieces(
    slots: &[StationSlot],
    pieces: &[Slot],
    hinges: &[Hinge],
    numbers: usize,
) -> (Vec<AtJoints>, AtJoints) {
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
        // The mass of a drive is inboard of its own joint, so a piece loads only hinges that are inboard of the piece.
        for hinge in hinges.iter().filter(|hinge| hinge.slot > k) {
            let own = AtJoint::new(&hinge.twist(slots), inertia, weight);
            // The torque of a given mass is added once for all rows. The mass of a drive that is chosen or sized
            // differs from design to design, so its torque is stored per kilogram.
            match fixed_times {
                Some(times) => fixed[hinge.number].add(own, times),
                None => per_kg[k][hinge.number] = own,
            }
        }
    }
    (per_kg, fixed)
}

/// The options of the link in a slot; none if the slot has no link.
fn link_options(slot: &StationSlot) -> &[StationLink] {
    match slot {
        StationSlot::Link { options, .. } => options,
        _ => &[],
    }
}

/// Wrench of the weight of the row's link per newton; zero if no option has weight. `down` is the direction of gravity.
/// The weights of the options differ in size but not in line of action, so any option gives this wrench.
fn link_weight_per_n(links: &[StationLink], down: &Vector3<f64>) -> Wrench {
    links.iter().find(|l| l.weight_n(down) != 0.0).map_or(Vector6::zeros(), |l| l.weight / l.weight_n(down))
}

/// For each block of the eigenvalue problem, the number of inner slots that take part in its modes: all from the row
/// level to the last compliant one. `first` is the slot of the row level, and `links_are_compliant` tells whether some
/// option of the row's link is compliant.
fn compliant_ends(modal: &Modal, first: usize, links_are_compliant: bool) -> [usize; 2] {
    match modal {
        Modal::Planar(blocks) => [0, 1].map(|b| last_compliant(&blocks[b], first, links_are_compliant)),
        Modal::Spatial(block) => [last_compliant(block, first, links_are_compliant), 0],
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
/// Only the mass of each tube itself is included, and not the mass outboard of it.
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
        // The twist is compared with exact zeros, so that only a torque that is zero by symmetry is left out. A torque
        // that is merely small counts.
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

/// Number of inner slots from the row level to the last slot that is compliant in this block; 0 if none is. `first` is
/// the slot of the row level, and `links_are_compliant` tells whether some option of the row's link is compliant.
fn last_compliant<const N: usize>(block: &Block<N>, first: usize, links_are_compliant: bool) -> usize {
    let is_compliant = |slot: &BlockSlot<N>| match slot {
        BlockSlot::Joint { twist, .. } => twist.amax() > 0.0,
        BlockSlot::Links(options) => options[0].is_compliant(),
        BlockSlot::Body(_) => false,
    };
    // The first slot may have the link of the row. This link counts if some of its options are compliant.
    let inner = block.slots[first + 1..].iter().rposition(is_compliant).map(|last| last + 2);
    let of_row = match &block.slots[first] {
        BlockSlot::Links(_) => links_are_compliant,
        slot => is_compliant(slot),
    };
    inner.unwrap_or(usize::from(of_row))
}

/// The entries in the lower triangle of the outboard inertia matrix that enter Dunkerley's sum. Row and column are both
/// motions of the same block.
fn spread_entries(modal: &Modal) -> Vec<Entry> {
    let lower = |block: usize, motions: &[usize]| -> Vec<Entry> {
        let pairs = motions.iter().flat_map(|&i| motions.iter().map(move |&j| (i, j)));
        pairs
            .filter(|(row, column)| row >= column)
            .map(|(row, column)| Entry { block, row, column })
            .collect()
    };
    match modal {
        Modal::Planar(_) => [lower(0, &[0, 2, 4]), lower(1, &[1, 3, 5])].concat(),
        Modal::Spatial(_) => lower(0, &[0, 1, 2, 3, 4, 5]),
    }
}
