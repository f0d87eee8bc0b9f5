//! A first gap that is known long before the first pass of a search is done.
//!
//! The gap is the fraction by which the best design found may be worse than a design of the space, in each objective.
//! Short descents (dives) find a few designs. A cover of the space by a thousand boxes of designs
//! ([`cover`](super::cover)) tells how near these designs are to every design of the space. As more designs are found,
//! the gap of the same boxes falls.
//!
//! The result of a search does not depend on these designs. They are listed only if the search is stopped, because then
//! its gap may rest on them.

use super::bound::BoxBound;
use super::budget::Budget;
use super::cover::Cover;
use super::gap::gap;
use super::live_progress::{Known, LiveProgress};
use super::probe::dives;
use super::problem::Problem;
use super::search_state::{Findings, SearchState};
use crate::pareto::objectives::Objectives;

/// Number of dives.
const DIVES: usize = 16;
/// Number of boxes of the cover. Bounding this many boxes takes about as long as the dives.
const BOXES_OF_COVER: usize = 1024;

/// The designs and the cover that are known before the first pass.
pub(super) struct Early<'l> {
    /// Receives the gap and the counts for other threads to read.
    live: &'l LiveProgress,
    /// Bounds of the boxes of the cover. These boxes contain every design of the space, except designs that a design in
    /// `findings` dominates.
    cover: Vec<BoxBound>,
    /// The designs that the dives found.
    findings: Findings,
}

impl<'l> Early<'l> {
    /// Finds a few designs, makes the cover and reports the gap.
    pub(super) fn new(budget: &Budget, problem: &Problem, live: &'l LiveProgress) -> Self {
        let aside = budget.aside();
        let findings = dives(&aside, problem, DIVES);
        let found: Vec<Objectives> = findings.kept.iter().map(|c| c.objectives).collect();
        let cover = Cover::new(&aside, problem, &found, BOXES_OF_COVER).bounds();
        let early = Self { live, cover, findings };
        early.tell(&[], 0);
        early
    }

    /// Reports the gap that the cover proves with the designs of the dives and the designs `found` since. `designs` is
    /// the number of designs whose objectives were computed so far.
    pub(super) fn tell(&self, found: &[Objectives], designs: u64) {
        self.live.update(|| Known {
            gap: self.gap(found),
            front_size: found.len().max(self.findings.kept.len()) as u64,
            boxes_open: self.cover.len() as u64,
            designs: designs.max(self.findings.evaluated),
            ..Known::default()
        });
    }

    /// Adds the designs of the dives to `state`, the state of a search that was stopped. Returns the gap that the
    /// cover proves for all designs of `state` together (relative). `None` if it proves no gap.
    pub(super) fn into_state(self, state: &mut SearchState) -> Option<f64> {
        state.learn(self.findings);
        gap(&self.cover, &state.front())
    }

    /// The gap that the cover proves with the designs of the dives and the designs in `found` (relative). `None` if it
    /// proves no gap.
    fn gap(&self, found: &[Objectives]) -> Option<f64> {
        let dived = self.findings.kept.iter().map(|c| c.objectives);
        gap(&self.cover, &found.iter().copied().chain(dived).collect::<Vec<_>>())
    }
}
