//! Rows that have begun: what depends on the arm outboard of a row, worked out once for all its designs.

use super::arms::EightArms;
use super::row::{AtJoint, AtJoints, Row, hinge_numbers};
use super::row_bearing::BearingsBegun;
use crate::mechanics::lowest_lanes::Outboard;
use crate::sizing::bearing::BearingDemand;
use crate::sizing::fit::LinkRoom;
use crate::space::problem::{ArmProblem, Partial, block_steps};
use crate::space::station::{Modal, StationSlot};

/// Working space in which rows are finished.
pub struct RowScratch {
    pub(crate) rows: Vec<Begun>,
    pub(crate) arms: EightArms,
    /// An arm for designs that are finished one by one.
    pub(crate) spare: Partial,
}

/// A row that has begun: what depends on the arm outboard of it.
pub(crate) struct Begun {
    pub cases: Vec<CaseBegun>,
    /// For each inner joint, the step of the drive table at which the drive of the last design was found. The next search
    /// starts there, because the demands of neighbouring designs are similar.
    pub steps: Vec<usize>,
    /// Loads on the bearing of the row level, if that is the drive of a joint.
    pub of_row: BearingDemand,
    /// The room at that joint.
    pub room_of_row: LinkRoom,
    pub bearings: BearingsBegun,
}

/// A row that has begun, in one case.
pub(crate) struct CaseBegun {
    pub outboard: CaseOutboard,
    /// Torque and inertia at each hinge: of everything outboard of the row, and of the inner pieces that are not
    /// chosen.
    pub at: AtJoints,
    /// The entries of the outboard inertia that the ends of the links move ([`RowCase::spread_entries`](super::row::RowCase::spread_entries)).
    pub spread: Vec<f64>,
    /// Axial force, torsion and both bending moments of everything outboard, at the link's end and at its root.
    pub at_end: [f64; 4],
    pub at_root: [f64; 4],
}

/// The arm outboard of a row as the pass for the lowest mode sees it.
pub(crate) enum CaseOutboard {
    Planar(Box<[Outboard<3>; 2]>),
    Spatial(Box<Outboard<6>>),
}

impl RowScratch {
    /// Working space for the rows of a problem.
    pub(crate) fn new(problem: &ArmProblem) -> Self {
        Self { rows: Vec::new(), arms: EightArms::new(problem), spare: problem.empty() }
    }

    /// Begins rows: works out what the designs of each row share.
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
    /// Working space for one row of a problem.
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

    /// Begins the row beyond the arm `from`. Memory of the row before is used again.
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
            begun.spread.extend(case.spread_entries.iter().map(|&(_, i, j)| {
                // the inertia is symmetric: an entry of the lower triangle stands for its mirror image too
                let both = if i == j { 1.0 } else { 2.0 };
                both * state.inertia[(i, j)]
            }));
            // a case that only sizes drives has no modes to find
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
