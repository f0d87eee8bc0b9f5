//! The numbers of a row that depend on the arm outboard of it. They are computed once for all designs of the row.
//!
//! A row is the set of designs that differ in the choice of one part alone, the row level. Its designs have the arm
//! outboard of the row level in common. If the row level is a link, this link is the row's link. Inner slots are the
//! places of the arm from the row level to the base, and a hinge is one elastic coordinate of an inner slot.

use super::arms::EightArms;
use super::row::Row;
use super::row_bearing::BearingsBegun;
use super::row_case::{AtJoint, AtJoints, Entry, hinge_numbers};
use crate::mechanics::lowest_lanes::Outboard;
use crate::sizing::bearing::BearingDemand;
use crate::sizing::fit::LinkRoom;
use crate::space::problem::{ArmProblem, Partial, block_steps};
use crate::space::station::{Modal, StationSlot};

/// Working space in which the designs of rows are evaluated.
pub struct RowScratch {
    /// One entry for each row of a batch: the numbers of this row that depend on the arm outboard of it.
    pub(crate) rows: Vec<Begun>,
    /// Eight arms that are being completed.
    pub(crate) arms: EightArms,
    /// An arm for designs that are evaluated one by one.
    pub(crate) spare: Partial,
}

/// The numbers of a row that depend on the arm outboard of it.
pub(crate) struct Begun {
    /// The numbers of each case (a pose with its loads).
    pub cases: Vec<CaseBegun>,
    /// For each inner joint (from the row level to the base), the place of the last design's drive in the ladder of the
    /// drive table. The ladder lists, lightest first, the drives that can be the lightest for some demand. The
    /// search for the drive of the next design starts at this place, because the demands of neighbouring designs are
    /// similar.
    pub steps: Vec<usize>,
    /// Loads on the output bearing of the joint that is the row level; zero if the row level is a link.
    pub of_row: BearingDemand,
    /// Largest widths of gear and motor at the joint that is the row level; unlimited if the row level is a
    /// link.
    pub room_of_row: LinkRoom,
    /// Loads that everything outboard of the row makes on the output bearings inboard of the row level.
    pub bearings: BearingsBegun,
}

/// The numbers of a row that depend on the arm outboard of it, in one case.
pub(crate) struct CaseBegun {
    /// The arm outboard of the row, prepared for the lowest modes.
    pub outboard: CaseOutboard,
    /// Torque and inertia about each hinge, caused by everything outboard of the row and by the inner pieces whose mass
    /// is given.
    pub at: AtJoints,
    /// The entries of the inertia matrix of everything outboard that count in Dunkerley's sum (the sum of `1/λ` over
    /// the eigenvalues). Entries off the diagonal are doubled. The order is the same as in
    /// [`RowCase::spread_entries`](super::row_case::RowCase::spread_entries).
    pub spread: Vec<f64>,
    /// Loads at the end of the row's link from everything outboard: axial force \[N\], torsion and both bending moments
    /// \[N m\].
    pub at_end: [f64; 4],
    /// Loads at the root of the row's link from everything outboard, without the weight of the link: axial force \[N\],
    /// torsion and both bending moments \[N m\].
    pub at_root: [f64; 4],
}

/// The arm outboard of a row as the computation of the lowest mode needs it: two blocks of three motions each in a
/// planar pose, or one block of six motions in a spatial pose.
pub(crate) enum CaseOutboard {
    Planar(Box<[Outboard<3>; 2]>),
    Spatial(Box<Outboard<6>>),
}

impl RowScratch {
    /// Allocates the working space for the rows of a problem.
    pub(crate) fn new(problem: &ArmProblem) -> Self {
        Self { rows: Vec::new(), arms: EightArms::new(problem), spare: problem.empty() }
    }

    /// Computes, for each row of a batch, the numbers that all its designs have in common. `from` are the arms outboard
    /// of the rows, one for each row.
    pub(crate) fn begin<'p>(
        &mut self,
        problem: &ArmProblem,
        row: &Row,
        from: impl ExactSizeIterator<Item = &'p Partial>,
    ) {
        self.rows.resize_with(from.len().max(self.rows.len()), || Begun::new(problem));
        for (begun, from) in self.rows.iter_mut().zip(from) {
            begun.refill(problem, row, from);
        }
    }
}

impl Begun {
    /// Allocates memory for the numbers of one row of a problem.
    fn new(problem: &ArmProblem) -> Self {
        let inner = &problem.slots()[problem.row_slot().unwrap_or(0)..];
        let numbers = hinge_numbers(inner);
        let cases = problem.stations().iter().map(|station| CaseBegun {
            outboard: match &station.modal {
                Modal::Planar(_) => CaseOutboard::Planar(Box::default()),
                Modal::Spatial(_) => CaseOutboard::Spatial(Box::default()),
            },
            at: vec![AtJoint::default(); numbers],
            spread: Vec::new(),
            at_end: [0.0; 4],
            at_root: [0.0; 4],
        });
        Self {
            cases: cases.collect(),
            steps: vec![0; inner.len()],
            of_row: BearingDemand::default(),
            room_of_row: LinkRoom::ANY,
            bearings: Vec::new(),
        }
    }

    /// Computes the numbers of the row that continues the arm `from`. The memory of an earlier row is used again.
    fn refill(&mut self, problem: &ArmProblem, row: &Row, from: &Partial) {
        self.of_row = from.next_demand.map_or(BearingDemand::default(), |demand| demand.bearing);
        self.room_of_row = from.next_demand.map_or(LinkRoom::ANY, |demand| demand.room);
        self.bearings.resize_with(row.bearings.len(), Vec::new);
        for (bearing, begun) in row.bearings.iter().zip(&mut self.bearings) {
            bearing.begin(from, begun);
        }
        for (k, begun) in self.cases.iter_mut().enumerate() {
            let (station, state, case) = (&problem.stations()[k], &from.stations[k], &row.cases[k]);
            for hinge in &row.hinges {
                let twist = hinge.twist(&station.slots[row.first..]);
                let at = &mut begun.at[hinge.number];
                *at = AtJoint::new(&twist, &state.inertia, &state.wrench);
                at.add(case.fixed[hinge.number], 1.0);
            }
            if let StationSlot::Link { place, carried, .. } = &station.slots[row.first] {
                begun.at_end = place.local(&state.wrench, &place.end_m);
                begun.at_root = place.local(&(state.wrench + carried.weight), &place.root_m);
            }
            begun.spread.clear();
            begun.spread.extend(case.spread_entries.iter().map(|&Entry { row, column, .. }| {
                // The matrix is symmetric, and only the entries of its lower triangle are listed. An entry off the
                // diagonal stands for two, so it counts twice.
                let both = if row == column { 1.0 } else { 2.0 };
                both * state.inertia[(row, column)]
            }));
            // A case that is not judged needs no modes.
            if !case.judged {
                continue;
            }
            match (&mut begun.outboard, &station.modal) {
                (CaseOutboard::Planar(mine), Modal::Planar(blocks)) => {
                    for (mine, block) in mine.iter_mut().zip(blocks.iter()) {
                        mine.refill(block_steps(block, from, state, row.first));
                    }
                }
                (CaseOutboard::Spatial(mine), Modal::Spatial(block)) => {
                    mine.refill(block_steps(block, from, state, row.first));
                }
                _ => unreachable!("a case keeps its kind"),
            }
        }
    }
}
