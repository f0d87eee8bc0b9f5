//! Designs that are nearly on the front.
//!
//! The *shortfall* of a design is the smallest `s` for which some design of the front is better by at most the
//! part `s` in every objective (the multiplicative epsilon of multi-objective search):
//!
//! ```text
//! s(d) = min over f of the front of max(m_d/m_f, u_d/u_f, f_f/f_d) - 1
//! ```
//!
//! Designs of the front have none. All designs are visited a second time, with the front known: a table of the
//! front, worsened by the slack, rejects most of them at once ([`Archive`]: what a worsened design of the front beats
//! has none near it, for designs of the front do not beat each other); what it lets through is compared
//! with every design of the front. Memory follows the number of designs that are asked for.

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

/// The fast model and the full one differ by less than this part: no near design is lost to rounding.
pub(crate) const ROUNDING: f64 = 1e-9;

/// A front that designs are compared with.
pub struct Shortfall {
    /// Lightest first.
    front: Vec<Objectives>,
}

impl Shortfall {
    /// Takes the designs of a front.
    pub fn of(front: impl IntoIterator<Item = Objectives>) -> Self {
        let mut front: Vec<Objectives> = front.into_iter().collect();
        front.sort_by(|a, b| a.mass_kg.total_cmp(&b.mass_kg));
        Self { front }
    }

    /// The shortfall of a design; `None` if it is more than `most`.
    pub fn within(&self, most: f64, design: &Objectives) -> Option<f64> {
        let first = self.front.partition_point(|f| design.mass_kg > f.mass_kg * (1.0 + most));
        let worst = |other: &Objectives| worse_by(design, other).into_iter().fold(0.0, f64::max);
        self.front[first..].iter().map(worst).reduce(f64::min).filter(|shortfall| *shortfall <= most)
    }

    /// Whether the shortfall of a design is at most `most`.
    pub fn is_within(&self, most: f64, design: &Objectives) -> bool {
        let worse = 1.0 + most;
        let first = self.front.partition_point(|f| design.mass_kg > f.mass_kg * worse);
        self.front[first..].iter().any(|f| {
            design.tip_deflection_m <= f.tip_deflection_m * worse
                && f.lowest_mode_hz <= design.lowest_mode_hz * worse
        })
    }
}

/// By how much a design is worse than another in deflection, mass and lowest mode, as parts; negative where it
/// is better.
pub fn worse_by(design: &Objectives, other: &Objectives) -> [f64; 3] {
    let over = |a: f64, b: f64| if a == b { 0.0 } else { a / b - 1.0 };
    [
        over(design.tip_deflection_m, other.tip_deflection_m),
        over(design.mass_kg, other.mass_kg),
        over(other.lowest_mode_hz, design.lowest_mode_hz),
    ]
}

/// A design near the front.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearDesign {
    /// The design and its objectives by the fast model.
    pub candidate: Candidate,
    /// Its shortfall.
    pub shortfall: f64,
}

/// Designs near a front.
#[derive(Debug, Clone, PartialEq)]
pub struct NearDesigns {
    /// Nearest first; of equals the one with the smaller number.
    pub nearest: Vec<NearDesign>,
    /// How many there are; `None` if the search stopped counting because there are more than are kept.
    pub total: Option<u64>,
}

/// Which designs are looked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slack {
    /// Largest shortfall.
    pub part: f64,
    /// How many designs are kept at most.
    pub most: usize,
}

/// Finds the designs that are not among `front`, keep the constraints and whose shortfall is at most the slack;
/// `None` if it was stopped.
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

/// What all tasks share.
struct Seeker<'s> {
    constraints: &'s Constraints,
    archive: Archive,
    on_front: HashSet<u128>,
    shortfall: Shortfall,
    slack: Slack,
    nearest: Mutex<Vec<NearDesign>>,
}

/// Designs that a task keeps for itself before it hands them over.
pub(crate) const BUFFER: usize = 1 << 12;

struct Worker<'s> {
    seeker: &'s Seeker<'s>,
    found: u64,
    buffer: Vec<NearDesign>,
}

impl Keep for Worker<'_> {
    fn complete(&mut self, number: u128, Finished { objectives, .. }: Finished) {
        let Seeker { constraints, archive, on_front, shortfall, slack, .. } = self.seeker;
        if archive.rejects(&objectives) || constraints.broken(&objectives).contains(&true) {
            return;
        }
        let Some(shortfall) = shortfall.within(slack.part + ROUNDING, &objectives) else { return };
        if on_front.contains(&number) {
            return;
        }
        self.found += 1;
        self.buffer.push(NearDesign { candidate: Candidate { number, objectives }, shortfall });
        if self.buffer.len() >= BUFFER {
            self.hand_over();
        }
    }

    fn exclude(&mut self, _: u128) {}

    fn bar_hz(&self, _: Option<usize>, mass_kg: f64, tip_deflection_m: f64) -> f64 {
        self.seeker.archive.bar_hz(mass_kg, tip_deflection_m)
    }
}

impl Worker<'_> {
    fn hand_over(&mut self) {
        let most = self.seeker.slack.most;
        let mut all = self.seeker.nearest.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        all.append(&mut self.buffer);
        if all.len() > 2 * most + BUFFER {
            keep_nearest(&mut all, most);
        }
    }

    fn finish(mut self) -> u64 {
        self.hand_over();
        self.found
    }
}

pub(crate) fn keep_nearest(designs: &mut Vec<NearDesign>, most: usize) {
    designs.sort_unstable_by(|a, b| {
        a.shortfall.total_cmp(&b.shortfall).then(a.candidate.number.cmp(&b.candidate.number))
    });
    designs.truncate(most);
}
