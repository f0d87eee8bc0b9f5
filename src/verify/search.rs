//! The search through the boxes (sets of designs). A box is discarded if it is proved to have no missing design;
//! otherwise it is halved. A box of a single design that is not discarded is stored, to be judged by the full model.

use super::boxes::Boxes;
use super::branch_score::BranchScore;
use super::front_index::FrontIndex;
use super::halt::{Found, Halt};
use super::ledger::{Branch, Ledger};
use super::parts_box::PartsBox;
use super::upper_bound::UpperBound;

/// A search, box by box, for designs that belong on a front and are missing from it.
pub(super) struct Search<'s> {
    pub boxes: &'s Boxes,
    pub front: &'s FrontIndex,
    /// The search is only for designs below this upper bound.
    pub upper: UpperBound,
    pub halt: &'s Halt<'s>,
    pub ledger: &'s Ledger<'s>,
}

impl Search<'_> {
    /// Bounds a box, and explores its halves unless the box is discarded. Nothing is done if the ledger has the result
    /// of this branch already.
    pub(super) fn explore(&self, parts: &PartsBox, branch: Branch) -> Found {
        self.ledger.of(branch, self.halt, || self.explore_now(parts, branch))
    }

    fn explore_now(&self, parts: &PartsBox, branch: Branch) -> Found {
        if self.halt.stopped() {
            return Found { open: 1, ..Found::default() };
        }
        let here = Found { boxes: 1, ..Found::default() };
        let Some(level) = self.level_to_halve(parts) else { return here };
        let Some([a, b]) = level.and_then(|level| self.boxes.halves(parts, level)) else {
            self.halt.note(self.boxes.design(parts));
            return here;
        };
        let [of_a, of_b] = branch.halves();
        let (a, b) = rayon::join(|| self.explore(&a, of_a), || self.explore(&b, of_b));
        here.with(a).with(b)
    }

    /// The level at which the box `parts` is to be halved. `None` if the box is discarded, and `Some(None)` if it is a
    /// single design.
    fn level_to_halve(&self, parts: &PartsBox) -> Option<Option<usize>> {
        let boxes = self.boxes;
        let members = boxes.members(parts)?;
        let ideal = boxes.skeleton.ideal_point(&members)?;
        if !self.upper.is_in_reach_of(&ideal) {
            return None;
        }
        let beaten_hz = self.front.beaten_up_to_hz(ideal.mass_kg, ideal.tip_m);
        let too_slow_hz = beaten_hz.max(boxes.skeleton.required_hz()).max(self.upper.hz);
        let slow = boxes.skeleton.slowest(&members, too_slow_hz)?;
        let open = boxes.open_levels(parts);
        if open.len() < 2 {
            return Some(open.first().copied());
        }
        let score = BranchScore { boxes, members: &members, ideal: &ideal, slow: &slow, parts };
        open.into_iter()
            .map(|level| (level, score.score_of(level)))
            .reduce(|a, b| if b.1 > a.1 { b } else { a })
            .map(|(level, _)| Some(level))
    }
}
