//! Near designs: designs that are not on the front, but worse than some design of it by at most a stated percentage.
//!
//! The *shortfall* `s` of a design says how near it is to the front. It is the smallest number for which some design of
//! the front is better by at most the fraction `s` in every objective. It is the multiplicative epsilon of
//! multi-objective optimization. With mass m, deflection u and lowest mode f (index d: the design; index k: a design of
//! the front):
//!
//! ```text
//! s(d) = min over k of the front of max(m_d/m_k, u_d/u_k, f_k/f_d) - 1
//! ```
//!
//! The shortfall of a design of the front is zero.
//!
//! All designs are visited a second time, after the front is known. The designs of the front, each made worse by the
//! slack, fill a table (`Archive`) that rejects most designs at once: every design that a worsened design dominates. No
//! near design is rejected. A rejected design is worse than some design k of the front by at least the slack in every
//! objective. A design of the front within the slack of it would therefore be dominated by k, and no design of the
//! front dominates another.
//!
//! The designs that the table does not reject are compared with the front one by one. The search needs memory in
//! proportion to the number of near designs that are asked for.

use super::finish::FinishRows;
use super::sweep::Candidate;
use super::visit::Visit;
use crate::pareto::archive::Archive;
use crate::pareto::objectives::Objectives;
use crate::space::constraint::Constraints;
use crate::space::levels::{Finished, Keep};
use rayon::prelude::*;
use std::collections::HashSet;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Upper bound of the relative difference between the fast model and the full model. The slack is made larger by it,
/// so that no near design is lost to rounding.
pub(crate) const ROUNDING: f64 = 1e-9;

/// A front, prepared to compute the shortfall of designs.
pub struct Shortfall {
    /// Objectives of the designs of the front, lightest first.
    front: Vec<Objectives>,
}

impl Shortfall {
    /// Prepares a front for the computation of shortfalls. Its designs may be in any order.
    pub fn of(front: impl IntoIterator<Item = Objectives>) -> Self {
        let mut front: Vec<Objectives> = front.into_iter().collect();
        front.sort_by(|a, b| a.mass_kg.total_cmp(&b.mass_kg));
        Self { front }
    }

    /// The shortfall of a design: the fraction by which it is worse than the nearest design of the front (0.02 for 2
    /// %). `None` if it is larger than `most`.
    pub fn within(&self, most: f64, design: &Objectives) -> Option<f64> {
        // the lightest designs of the front cannot count: each is lighter than the design by more than the fraction
        // `most`
        let first = self.front.partition_point(|f| design.mass_kg > f.mass_kg * (1.0 + most));
        let worst = |other: &Objectives| worse_by(design, other).into_iter().fold(0.0, f64::max);
        self.front[first..].iter().map(worst).reduce(f64::min).filter(|shortfall| *shortfall <= most)
    }

    /// Whether the shortfall of a design is at most `most`: some design of the front is then better by no more than
    /// this fraction in every objective.
    pub fn is_within(&self, most: f64, design: &Objectives) -> bool {
        let worse = 1.0 + most;
        let first = self.front.partition_point(|f| design.mass_kg > f.mass_kg * worse);
        self.front[first..].iter().any(|f| {
            design.tip_deflection_m <= f.tip_deflection_m * worse
                && f.lowest_mode_hz <= design.lowest_mode_hz * worse
        })
    }
}

/// The fractions by which `design` is worse than `other` in deflection, mass and lowest mode, in this order. A fraction
/// is negative where `design` is better.
pub fn worse_by(design: &Objectives, other: &Objectives) -> [f64; 3] {
    let over = |a: f64, b: f64| if a == b { 0.0 } else { a / b - 1.0 };
    [
        over(design.tip_deflection_m, other.tip_deflection_m),
        over(design.mass_kg, other.mass_kg),
        over(other.lowest_mode_hz, design.lowest_mode_hz),
    ]
}

/// A design that is not on the front, but within the slack of a design on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearDesign {
    /// Number of the design, and its objectives by the fast model.
    pub candidate: Candidate,
    /// Shortfall of the design, as a fraction (0.02 for 2 %).
    pub shortfall: f64,
}

/// The result of a search for near designs.
#[derive(Debug, Clone, PartialEq)]
pub struct NearDesigns {
    /// The near designs, smallest shortfall first. Of designs with an equal shortfall, the design with the smaller
    /// number comes first.
    pub nearest: Vec<NearDesign>,
    /// Number of near designs, which may be larger than the length of `nearest`; `None` if the search stopped
    /// counting.
    pub total: Option<u64>,
}

/// What is asked of a search for near designs: how near they must be, and how many are returned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slack {
    /// Largest shortfall of a near design, as a fraction.
    pub part: f64,
    /// Largest number of designs to return.
    pub most: usize,
}

/// Finds the designs that are not on `front`, meet the constraints and have a shortfall of at most the slack. Returns
/// `None` if `stop` was set before the end.
pub fn near_designs<P: FinishRows>(
    problem: &P,
    constraints: &Constraints,
    front: &[Candidate],
    slack: Slack,
    stop: &AtomicBool,
) -> Option<NearDesigns> {
    let archive = Archive::new(6);
    for Candidate { objectives: o, .. } in front {
        let worse = 1.0 + slack.part + ROUNDING;
        archive.enter(&Objectives {
            tip_deflection_m: o.tip_deflection_m * worse,
            mass_kg: o.mass_kg * worse,
            lowest_mode_hz: o.lowest_mode_hz / worse,
        });
    }
    let seeker = Seeker {
        constraints,
        archive,
        on_front: front.iter().map(|c| c.number).collect(),
        shortfall: Shortfall::of(front.iter().map(|c| c.objectives)),
        slack,
        nearest: Mutex::new(Vec::new()),
    };
    let visited = AtomicU64::new(0);
    let total = problem.root().map_or(0, |root| {
        Visit { problem, compiled: problem.compile(), visited: &visited, stop }
            .every_design(&root, || Worker { seeker: &seeker, found: 0, buffer: Vec::new() })
            .map(Worker::finish)
            .sum()
    });
    let mut nearest = seeker.nearest.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    keep_nearest(&mut nearest, slack.most);
    (!stop.load(Ordering::Relaxed)).then_some(NearDesigns { nearest, total: Some(total) })
}

/// The inputs of a search for near designs, and the list of findings that all tasks share.
struct Seeker<'s> {
    constraints: &'s Constraints,
    archive: Archive,
    on_front: HashSet<u128>,
    shortfall: Shortfall,
    slack: Slack,
    nearest: Mutex<Vec<NearDesign>>,
}

/// Number of designs that a task collects before it adds them to the shared list.
pub(crate) const BUFFERED_DESIGNS: usize = 1 << 12;

/// Collects the near designs that one task finds.
struct Worker<'s> {
    seeker: &'s Seeker<'s>,
    found: u64,
    buffer: Vec<NearDesign>,
}

impl Keep for Worker<'_> {
    fn complete(&mut self, number: u128, Finished { objectives, .. }: Finished) {
        let Seeker { constraints, archive, on_front, shortfall, slack, .. } = self.seeker;
        // the cheapest test comes first; it rejects most designs
        if archive.rejects(&objectives) || constraints.broken(&objectives).contains(&true) {
            return;
        }
        let Some(shortfall) = shortfall.within(slack.part + ROUNDING, &objectives) else { return };
        if on_front.contains(&number) {
            return;
        }
        self.found += 1;
        self.buffer.push(NearDesign { candidate: Candidate { number, objectives }, shortfall });
        if self.buffer.len() >= BUFFERED_DESIGNS {
            self.hand_over();
        }
    }

    fn exclude(&mut self, _: u128) {}

    fn bar_hz(&self, _: Option<usize>, mass_kg: f64, tip_deflection_m: f64) -> f64 {
        self.seeker.archive.bar_hz(mass_kg, tip_deflection_m)
    }
}

impl Worker<'_> {
    /// Adds the designs that this task has collected to the list that all tasks share.
    fn hand_over(&mut self) {
        let most = self.seeker.slack.most;
        let mut all = self.seeker.nearest.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        all.append(&mut self.buffer);
        if all.len() > 2 * most + BUFFERED_DESIGNS {
            keep_nearest(&mut all, most);
        }
    }

    fn finish(mut self) -> u64 {
        self.hand_over();
        self.found
    }
}

/// Sorts `designs` by their shortfalls and keeps the first `most` of them, which are nearest to the front.
pub(crate) fn keep_nearest(designs: &mut Vec<NearDesign>, most: usize) {
    designs.sort_unstable_by(|a, b| {
        a.shortfall.total_cmp(&b.shortfall).then(a.candidate.number.cmp(&b.candidate.number))
    });
    designs.truncate(most);
}
