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
//! The *inner* slots are the slots from the row level to the base. They are numbered from 0. A *hinge* is one elastic
//! coordinate of an inner slot: a joint or bearing spring has one hinge, and a given tube has six, one for each end
//! coordinate of its condensed link. The hinge of a joint has the number of its slot. The hinges of tubes are numbered
//! after all slots.

use super::row_bearing::RowBearing;
use super::row_case::{Hinge, RowCase, hinges};
use super::row_chunk::Chunk;
use super::row_drives::{DriveAttributes, drive_attributes};
use super::row_room::RowRoom;
use crate::arm::joint_law::JointLaw;
use crate::mechanics::lanes::LANES;
use crate::space::problem::{ArmProblem, Partial};
use crate::space::slot::Slot;

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
    /// The numbers of each case that do not depend on the option of the row level.
    pub cases: Vec<RowCase>,
    /// Masses and torsion curves of the drives that each inner slot can have, one entry for each inner slot. An entry
    /// for a link or an offset has no drives.
    pub drives: Vec<DriveAttributes>,
    /// Indices of the inner slots (from the row level to the base) that deflect elastically. The link of the row level
    /// is left out.
    pub compliant: Vec<usize>,
    /// The hinges (elastic coordinates) of all inner slots. The link of the row level is left out.
    pub hinges: Vec<Hinge>,
    /// Mass of the given drives, tubes and offsets among the inner slots \[kg\].
    pub fixed_kg: f64,
    /// Form of the torsion curves of the drives in each inner slot. It decides how their twist is computed.
    pub twisting: Vec<Twisting>,
    /// The output bearings with limits to be checked, of the joints inboard of the row level.
    pub bearings: Vec<RowBearing>,
    /// The space that links leave for gear and motor at the joints inboard of the row level.
    pub rooms: Vec<RowRoom>,
}

/// The form of the torsion curves that the drives of a joint have in the judged cases, which count for deflection and
/// lowest mode. The simpler forms save work in the sweep.
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
    /// Prepares the inner slots (from the row level to the base) of a problem for the evaluation of eight designs at
    /// once. `None` if the designs must be evaluated one by one, which is so in four cases:
    ///
    /// - The search has nothing to choose (there is no level).
    /// - A given tube inboard is too slender, so that no design meets the limits.
    /// - The space has linkages or effects that the code for eight designs does not know.
    /// - Springs pull on tubes. The code for eight designs does not check the stress at these points.
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
            compliant: (0..slots.len()).filter(|&k| hinges.iter().any(|hinge| hinge.slot == k)).collect(),
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

/// The form that the torsion curves of the drives in inner slot `k` have in the judged cases. `drives` are the drives
/// of this slot.
fn twisting(slot: &Slot, drives: &DriveAttributes, k: usize, cases: &[RowCase]) -> Twisting {
    let has_play = match slot {
        Slot::Given { law, .. } => law.has_play(),
        Slot::Sized(sized) => sized.laws.iter().any(JointLaw::has_play),
        _ => false,
    };
    // Only judged cases need the angle of a joint. Cases that only size drives need nothing but its torque.
    let turned = cases.iter().filter(|case| case.judged).any(|case| case.turned[k]);
    let [first, second, third] = &drives.compliance;
    match (has_play, turned) {
        (true, _) => Twisting::Play,
        (false, false) => Twisting::AtRest,
        (false, true) if first == second && second == third => Twisting::Line,
        (false, true) => Twisting::Segments,
    }
}
