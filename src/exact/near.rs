//! Designs near a finished front, box by box.
//!
//! No member of a box has a smaller shortfall ([`Shortfall`]) than its ceiling has, for every objective of the ceiling
//! is at least as good. So a box is cut if its ceiling is not near; nothing found on the way counts, and no drive is
//! pointless. Once as many designs as are asked for are held, only nearer ones are looked for.

use super::bound::{BoxBound, Verdict};
use super::boxes::{OpenBox, open_all_boxes};
use super::kinds::Ties;
use super::problem::Problem;
use super::run::Exact;
use super::work::Work;
use crate::pareto::objectives::Objectives;
use crate::search::near::{BUFFER, NearDesign, NearDesigns, ROUNDING, Shortfall, Slack, keep_nearest};
use crate::search::sweep::Candidate;
use crate::space::design::number;

/// How much a better trial shape may lower a ceiling's frequency.
const NEAR: f64 = 0.4;

impl Exact<'_> {
    /// Finds the designs that keep the constraints and whose shortfall is at most the slack, those of the front among
    /// them; `None` if it was stopped. Of far more designs than are asked for the number is not known.
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
            );
            if !left.is_empty() {
                return None;
            }
        }
        let Seeker { mut nearest, found, .. } = seeker;
        keep_nearest(&mut nearest, slack.most);
        let total = (found <= held_at_most(slack.most) as u64).then_some(found);
        Some(NearDesigns { nearest, total })
    }

    /// Bounds a box and halves it, or keeps it if it is one design.
    fn open_near(
        &self,
        problem: &Problem,
        seeker: &Seeker,
        mut here: OpenBox,
        work: &mut Work,
        near: &mut Vec<NearDesign>,
    ) -> Vec<OpenBox> {
        self.budget.count_box();
        let lower = |box_bound: &BoxBound| BoxBound { hz: box_bound.hz * NEAR, ..*box_bound };
        let verdict = problem.bound(
            &mut here.design_box,
            &mut here.shapes,
            work,
            |box_bound| !seeker.is_near(box_bound),
            |box_bound| !seeker.is_near(&lower(box_bound)),
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

/// Designs that are held before the nearest of them are told from the others.
fn held_at_most(most: usize) -> usize {
    2 * most + BUFFER
}

/// What is known of the designs near a front.
struct Seeker {
    shortfall: Shortfall,
    most: usize,
    /// The largest shortfall that is looked for.
    reach: f64,
    found: u64,
    nearest: Vec<NearDesign>,
}

impl Seeker {
    /// Whether a box with this ceiling may have a member that is near.
    fn is_near(&self, box_bound: &BoxBound) -> bool {
        self.shortfall.is_within(self.reach, &Objectives::from(*box_bound))
    }

    fn if_near(&self, candidate: Candidate) -> Option<NearDesign> {
        let shortfall = self.shortfall.within(self.reach, &candidate.objectives)?;
        Some(NearDesign { candidate, shortfall })
    }

    /// Keeps designs that are near.
    fn learn(&mut self, near: Vec<NearDesign>) {
        self.found += near.len() as u64;
        self.nearest.extend(near);
        if self.nearest.len() > held_at_most(self.most) {
            keep_nearest(&mut self.nearest, self.most);
            let last = self.nearest.last().map_or(0.0, |near| near.shortfall);
            self.reach = self.reach.min(last + ROUNDING);
        }
    }
}
