//! Designs near a finished front, box by box.
//!
//! No member of a box has a smaller shortfall ([`Shortfall`]) than its ceiling has, for every objective of the ceiling
//! is at least as good. So a box is cut if its ceiling is not near; nothing found on the way counts, and no drive is
//! pointless. Once as many designs as are asked for are held, only nearer ones are looked for.

use super::bound::{Ceiling, Verdict, Work};
use super::kinds::Alike;
use super::problem::Problem;
use super::run::{Exact, Opened, lock};
use crate::search::Objectives;
use crate::search::design::number;
use crate::search::near::{BUFFER, NearDesign, NearDesigns, ROUNDING, Shortfall, Slack, keep_nearest};
use crate::search::sweep::Candidate;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// How much a better trial shape may lower a ceiling's frequency.
const NEAR: f64 = 0.4;

impl Exact<'_> {
    /// Finds the designs that keep the constraints and whose shortfall is at most the slack, those of the front among
    /// them; `None` if it was stopped. Of far more designs than are asked for the number is not known.
    pub fn near(&self, front: &[Candidate], slack: Slack) -> Option<NearDesigns> {
        let seeker = Seeker {
            shortfall: Shortfall::of(front.iter().map(|c| c.objectives)),
            most: slack.most,
            reach: AtomicU64::new((slack.part + ROUNDING).to_bits()),
            found: AtomicU64::new(0),
            nearest: Mutex::new(Vec::new()),
        };
        let is_cut_short = AtomicBool::new(false);
        if let Some(problem) = self.problem(&|_| true, Alike::Apart) {
            self.every_box(
                &problem,
                |here, work, children| self.open_near(&problem, &seeker, here, work, children),
                |_| is_cut_short.store(true, Ordering::Relaxed),
            );
        }
        let mut nearest = seeker.nearest.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        keep_nearest(&mut nearest, slack.most);
        let found = seeker.found.into_inner();
        let total = (found <= held_at_most(slack.most) as u64).then_some(found);
        (!is_cut_short.into_inner()).then_some(NearDesigns { nearest, total })
    }

    /// Bounds a box and halves it, or keeps it if it is one design.
    fn open_near(
        &self,
        problem: &Problem,
        seeker: &Seeker,
        mut here: Opened,
        work: &mut Work,
        children: &mut Vec<Opened>,
    ) {
        self.count_box();
        let lower = |ceiling: &Ceiling| Ceiling { hz: ceiling.hz * NEAR, ..*ceiling };
        let verdict = problem.bound(
            &mut here.cell,
            &mut here.shapes,
            work,
            |ceiling| !seeker.is_near(ceiling),
            |ceiling| !seeker.is_near(&lower(ceiling)),
        );
        let Verdict::Open(ceiling) = verdict else { return };
        let Some(level) = problem.widest_level(&here.cell, &here.shapes, work) else {
            let Some(options) = problem.options(&here.cell) else { return };
            let objectives = problem.objectives(&ceiling, work);
            if !problem.space.constraints.broken(&objectives).contains(&true) {
                seeker.offer(Candidate { number: number(&problem.level_sizes, &options), objectives });
            }
            return;
        };
        let Some(halves) = problem.halves(&here.cell, level) else { return };
        for half in halves {
            let mut cell = here.cell.clone();
            cell[level] = half;
            children.push(Opened { cell, shapes: here.shapes.clone(), ceiling });
        }
    }
}

/// Designs that are held before the nearest of them are told from the others.
fn held_at_most(most: usize) -> usize {
    2 * most + BUFFER
}

/// What all workers share.
struct Seeker {
    shortfall: Shortfall,
    most: usize,
    /// Bits of the largest shortfall that is looked for: they rise with it.
    reach: AtomicU64,
    found: AtomicU64,
    nearest: Mutex<Vec<NearDesign>>,
}

impl Seeker {
    fn reach(&self) -> f64 {
        f64::from_bits(self.reach.load(Ordering::Relaxed))
    }

    /// Whether a box with this ceiling may have a member that is near.
    fn is_near(&self, ceiling: &Ceiling) -> bool {
        self.shortfall.is_within(self.reach(), &Objectives::from(*ceiling))
    }

    /// Keeps a design that is near.
    fn offer(&self, candidate: Candidate) {
        let Some(shortfall) = self.shortfall.within(self.reach(), &candidate.objectives) else { return };
        self.found.fetch_add(1, Ordering::Relaxed);
        let mut nearest = lock(&self.nearest);
        nearest.push(NearDesign { candidate, shortfall });
        if nearest.len() > held_at_most(self.most) {
            keep_nearest(&mut nearest, self.most);
            let last = nearest.last().map_or(0.0, |near| near.shortfall);
            self.reach.fetch_min((last + ROUNDING).to_bits(), Ordering::Relaxed);
        }
    }
}
