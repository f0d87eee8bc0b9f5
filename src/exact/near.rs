//! The search for designs near a finished front, box by box.
//!
//! The shortfall of a design ([`Shortfall`]) is the least fraction by which it is worse than some design of the front.
//! A box is a set of designs, its members. Every objective of a box's bound is at least as good as the same objective
//! of any member, so no member has a smaller shortfall than the bound. A box is pruned if the shortfall of its bound is
//! too large.
//!
//! Near designs may be dominated. Therefore a box is not pruned because a known design dominates it, and drives that a
//! lighter drive dominates are not removed. Once more designs have been found than were asked for, the greatest allowed
//! shortfall is lowered.

use super::bound::{BoxBound, Verdict};
use super::box_work::BoxWork;
use super::boxes::{OpenBox, open_all_boxes};
use super::kinds::Ties;
use super::problem::Problem;
use super::run::Exact;
use crate::pareto::objectives::Objectives;
use crate::search::near::{
    BUFFERED_DESIGNS, NearDesign, NearDesigns, ROUNDING, Shortfall, Slack, keep_nearest,
};
use crate::search::sweep::Candidate;
use crate::space::design::number;

impl Exact<'_> {
    /// Finds the designs that meet the constraints and are near `front`. A design is near if its shortfall, the
    /// fraction by which it is worse than some design of the front, is at most the slack. The designs of the front are
    /// included. `None` if the search was stopped. If there are far more designs than were asked for, their total
    /// number is not counted.
    pub fn near(&self, front: &[Candidate], slack: Slack) -> Option<NearDesigns> {
        let mut seeker = Seeker {
            shortfall: Shortfall::of(front.iter().map(|c| c.objectives)),
            most: slack.most,
            reach: slack.part + ROUNDING,
            found: 0,
            nearest: Vec::new(),
        };
        if let Some(problem) = self.problem(&|_| true, Ties::Separate) {
            let left = open_all_boxes(
                &self.budget,
                &problem,
                &mut seeker,
                |seeker, next, work, near| self.open_near(&problem, seeker, next, work, near),
                Seeker::learn,
                |_, _| (),
            );
            if !left.is_empty() {
                return None;
            }
        }
        let Seeker { mut nearest, found, .. } = seeker;
        keep_nearest(&mut nearest, slack.most);
        let total = (found <= kept_at_most(slack.most) as u64).then_some(found);
        Some(NearDesigns { nearest, total })
    }

    /// Bounds the box `here` and returns its two halves. If the box is one design, nothing is returned, and the design
    /// is added to `near` if it is near the front.
    fn open_near(
        &self,
        problem: &Problem,
        seeker: &Seeker,
        mut here: OpenBox,
        work: &mut BoxWork,
        near: &mut Vec<NearDesign>,
    ) -> Vec<OpenBox> {
        self.budget.count_box();
        let verdict = problem.bound(
            &mut here.design_box,
            &mut here.shapes,
            work,
            |box_bound| !seeker.is_near(box_bound),
            |box_bound| !seeker.is_near(&box_bound.with_better_shape()),
        );
        let Verdict::Open(box_bound) = verdict else { return Vec::new() };
        let Some(level) = problem.widest_level(&here.design_box, &here.shapes, work) else {
            let Some(options) = problem.options(&here.design_box) else { return Vec::new() };
            let objectives = problem.objectives(&box_bound, work);
            if !problem.space.constraints.broken(&objectives).contains(&true) {
                let candidate = Candidate { number: number(&problem.level_sizes, &options), objectives };
                near.extend(seeker.if_near(candidate));
            }
            return Vec::new();
        };
        here.halves(problem, level, box_bound)
    }
}

/// How many near designs may be stored before the list is cut back to the `most` nearest designs, which the user asked
/// for. It is twice `most` and a buffer, so that the list is not cut back at every find.
fn kept_at_most(most: usize) -> usize {
    2 * most + BUFFERED_DESIGNS
}

/// The state of the search for near designs.
struct Seeker {
    shortfall: Shortfall,
    /// Number of near designs that were asked for.
    most: usize,
    /// The greatest shortfall with which a design can still be listed (relative). It falls as nearer designs are found.
    reach: f64,
    /// Number of near designs found so far, including designs that are no longer stored.
    found: u64,
    nearest: Vec<NearDesign>,
}

impl Seeker {
    /// Whether a box with the bound `box_bound` may have a near member.
    fn is_near(&self, box_bound: &BoxBound) -> bool {
        self.shortfall.is_within(self.reach, &Objectives::from(*box_bound))
    }

    /// The design with its shortfall; `None` if the shortfall is too large for a near design.
    fn if_near(&self, candidate: Candidate) -> Option<NearDesign> {
        let shortfall = self.shortfall.within(self.reach, &candidate.objectives)?;
        Some(NearDesign { candidate, shortfall })
    }

    /// Stores near designs. Once there are more than enough of them, keeps the nearest and lowers the greatest allowed
    /// shortfall.
    fn learn(&mut self, near: Vec<NearDesign>) {
        self.found += near.len() as u64;
        self.nearest.extend(near);
        // The limit falls to the shortfall of the last design that is kept, with a margin for rounding.
        if self.nearest.len() > kept_at_most(self.most) {
            keep_nearest(&mut self.nearest, self.most);
            let last = self.nearest.last().map_or(0.0, |near| near.shortfall);
            self.reach = self.reach.min(last + ROUNDING);
        }
    }
}
