//! The state of a search, and the findings that a task adds to it.

use super::bound::BoxBound;
use super::incumbents::{Incumbents, is_better};
use super::live_progress::Known;
use crate::pareto::front::{exact_front, not_clearly_beaten};
use crate::pareto::objectives::{Objective, Objectives};
use crate::search::sweep::{Candidate, SLACK};
use serde::{Deserialize, Serialize};
use std::collections::HashSet;

/// Number of candidates above which dominated candidates are removed from time to time: whenever the number reaches a
/// power of two.
const BUFFER: usize = 4096;

/// The state that all tasks of a round share.
#[derive(Default)]
pub(super) struct SearchState {
    pub incumbents: Incumbents,
    /// Numbers of the designs that were evaluated and may have joined the designs found.
    pub tried: HashSet<u128>,
    /// Designs found that meet every constraint. Dominated designs among them are removed from time to time.
    kept: Vec<Candidate>,
    /// Designs for which rounding leaves open whether a part carries its demand. The full model judges them.
    undecided: Vec<Candidate>,
    /// Number of designs whose three objectives were computed.
    pub evaluated: u64,
}

/// The state between two rounds, in the form that is saved for another process.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct KeptState {
    incumbents: Vec<Objectives>,
    tried: Vec<u128>,
    kept: Vec<Candidate>,
    undecided: Vec<Candidate>,
    evaluated: u64,
}

/// The findings of a task before other tasks know them.
#[derive(Default)]
pub(super) struct Findings {
    /// Designs found that meet every constraint.
    pub kept: Vec<Candidate>,
    /// Designs for which rounding leaves open whether a part carries its demand.
    pub undecided: Vec<Candidate>,
    /// Numbers of the designs that were evaluated as possible incumbents.
    pub tried: Vec<u128>,
    /// Number of designs whose three objectives were computed.
    pub evaluated: u64,
}

impl Findings {
    /// Appends the findings of another task to these findings.
    pub(super) fn append(&mut self, mut other: Self) {
        self.kept.append(&mut other.kept);
        self.undecided.append(&mut other.undecided);
        self.tried.append(&mut other.tried);
        self.evaluated += other.evaluated;
    }

    /// Whether a design that the task found dominates every member of a box.
    pub(super) fn dominates(&self, box_bound: &BoxBound) -> bool {
        let best = Objectives::from(*box_bound);
        self.kept.iter().any(|c| is_better(&c.objectives, &best))
    }
}

impl SearchState {
    /// The state at the beginning of a search. If one objective is given, it alone counts.
    pub(super) fn toward(only: Option<Objective>) -> Self {
        Self { incumbents: Incumbents::toward(only), ..Self::default() }
    }

    /// The state that another process needs to continue the search.
    pub(super) fn to_kept(&self) -> KeptState {
        let mut tried: Vec<u128> = self.tried.iter().copied().collect();
        tried.sort_unstable();
        KeptState {
            incumbents: self.incumbents.all().to_vec(),
            tried,
            kept: self.kept.clone(),
            undecided: self.undecided.clone(),
            evaluated: self.evaluated,
        }
    }

    /// Restores the state that an earlier process saved. Its designs are entered in the same order, so that the
    /// restored state equals the saved one. `only` is the only objective that counts, if there is one.
    pub(super) fn from_kept(of: KeptState, only: Option<Objective>) -> Self {
        let KeptState { incumbents, tried, kept, undecided, evaluated } = of;
        let mut state = Self::toward(only);
        incumbents.iter().for_each(|objectives| state.enter(objectives));
        Self { tried: tried.into_iter().collect(), kept, undecided, evaluated, ..state }
    }

    /// Adds the objectives of a design that is known from elsewhere. The design prunes but is not listed.
    pub(super) fn enter(&mut self, objectives: &Objectives) {
        self.incumbents.enter(objectives);
    }

    /// The objectives of the designs found so far that no other dominates.
    pub(super) fn front(&self) -> Vec<Objectives> {
        let points: Vec<[f64; 3]> = self.kept.iter().map(|c| c.objectives.minimized()).collect();
        // No objective is NaN, so there is no error.
        exact_front(&points).unwrap_or_default().into_iter().map(|i| self.kept[i].objectives).collect()
    }

    /// The progress of the search as other threads read it. `front` are the designs found that no other dominates,
    /// `open` is the number of open boxes or regions, and `gap` a gap that was proved. If it is `None`, the gap
    /// reported before remains.
    pub(super) fn known(&self, front: &[Objectives], open: usize, gap: Option<f64>) -> Known {
        Known {
            boxes_open: open as u64,
            designs: self.evaluated,
            front_size: front.len() as u64,
            gap,
            ..Known::default()
        }
    }

    /// Adds the findings of a task to the state.
    pub(super) fn learn(&mut self, findings: Findings) {
        self.evaluated += findings.evaluated;
        self.tried.extend(findings.tried);
        self.undecided.extend(findings.undecided);
        for candidate in findings.kept {
            self.incumbents.enter(&candidate.objectives);
            self.kept.push(candidate);
            if self.kept.len().is_power_of_two() && self.kept.len() > BUFFER {
                clear(&mut self.kept);
            }
        }
    }

    /// The designs found that no other design dominates, by ascending number, and the undecided designs.
    pub(super) fn into_found(self) -> [Vec<Candidate>; 2] {
        [nondominated(self.kept), self.undecided]
    }
}

/// The designs of the list that no other design of the list dominates, by ascending number.
pub(super) fn nondominated(mut front: Vec<Candidate>) -> Vec<Candidate> {
    clear(&mut front);
    front.sort_unstable_by_key(|c| c.number);
    front.dedup_by_key(|c| c.number);
    // A design that is better than another by less than a small margin does not prune it. So whether both were found
    // depends on the order of discovery. Every design that another design of the list would have pruned is removed, so
    // that the result does not depend on this order.
    let all = front.clone();
    front.retain(|c| !all.iter().any(|other| is_better(&other.objectives, &c.objectives)));
    front
}

/// Removes the candidates that another candidate dominates.
fn clear(kept: &mut Vec<Candidate>) {
    let points: Vec<[f64; 3]> = kept.iter().map(|c| c.objectives.minimized()).collect();
    *kept = not_clearly_beaten(&points, SLACK).into_iter().map(|i| kept[i]).collect();
}
