//! Visiting every design, in parallel and in constant memory.
//!
//! `Visit` walks the tree in tasks. Designs that something else clearly beats are dropped at once ([`Archive`]); the rest
//! are filtered exactly now and then, so that memory follows the front and not the space. What is kept
//! at the end does not depend on the order of visits or the number of threads.

use super::finish::FinishRows;
use super::visit::Visit;
use crate::pareto::archive::Archive;
use crate::pareto::front::not_clearly_beaten;
use crate::pareto::objectives::Objectives;
use crate::space::constraint::Constraints;
use crate::space::levels::{Finished, Keep};
use rayon::prelude::*;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Two designs closer than this in an objective are told apart by the full model, not by the sweep.
pub const SLACK: f64 = 1e-7;
/// Candidates are filtered whenever there are this many more than after the last filtering.
const BUFFER: usize = 1 << 15;

/// How a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// No design outside the front can be on it: proved without visiting every one.
    Certified,
    /// Every design was visited.
    Complete,
    /// Stopped early: what was found, and how much it may lack.
    Partial,
    /// Every design was visited and none meets the constraints.
    Infeasible,
    /// Stopped before every design was visited.
    Interrupted,
}

impl Status {
    /// The word in files.
    pub fn word(self) -> &'static str {
        match self {
            Status::Certified => "certified",
            Status::Complete => "complete",
            Status::Partial => "partial",
            Status::Infeasible => "infeasible",
            Status::Interrupted => "interrupted",
        }
    }
}

/// A design that no other clearly beats.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// Number of the design in its space.
    pub number: u128,
    /// Its objectives by the fast model.
    pub objectives: Objectives,
}

/// What a sweep found.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepOutcome {
    /// How it ended.
    pub status: Status,
    /// Designs in the space.
    pub designs_total: u128,
    /// Designs that hold and were judged: by their three objectives, or by mass, deflection and a lowest mode
    /// that is below that of a design no worse in both.
    pub designs_evaluated: u64,
    /// Designs left out because their outboard part, or a drive, stress, mass or cost limit, cannot hold.
    pub designs_excluded: u128,
    /// Candidates of the front of all designs.
    pub front: Vec<Candidate>,
    /// Candidates of each group's own front.
    pub groups: Vec<Vec<Candidate>>,
    /// The best of each objective among the designs that break only that objective's constraint:
    /// the smallest relaxation that would help.
    pub near_misses: [Option<f64>; 3],
}

/// A sweep that others can watch and stop.
pub struct Sweep<'p, P: FinishRows> {
    problem: &'p P,
    constraints: Constraints,
    visited: AtomicU64,
    stop: &'p AtomicBool,
}

/// Candidates of one front, shared by the tasks.
struct Pool {
    archive: Archive,
    candidates: Mutex<(Vec<Candidate>, usize)>,
}

impl Pool {
    fn new(bits: u32) -> Self {
        Self { archive: Archive::new(bits), candidates: Mutex::new((Vec::new(), 0)) }
    }

    /// Takes a candidate unless one before it surely beats it.
    fn offer(&self, candidate: Candidate, buffer: &mut Vec<Candidate>) -> bool {
        if self.archive.rejects(&candidate.objectives) {
            return false;
        }
        self.archive.enter(&candidate.objectives);
        buffer.push(candidate);
        if buffer.len() >= BUFFER {
            self.empty(buffer);
        }
        true
    }

    fn empty(&self, buffer: &mut Vec<Candidate>) {
        clear_beaten(buffer);
        let mut pool = self.candidates.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let (all, settled) = &mut *pool;
        all.append(buffer);
        if all.len() > *settled + BUFFER {
            clear_beaten(all);
            *settled = all.len();
        }
    }

    fn finish(self) -> Vec<Candidate> {
        let mut all = self.candidates.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner).0;
        clear_beaten(&mut all);
        all.sort_unstable_by_key(|c| c.number);
        all
    }
}

fn clear_beaten(candidates: &mut Vec<Candidate>) {
    let points: Vec<[f64; 3]> = candidates.iter().map(|c| c.objectives.minimized()).collect();
    let kept = not_clearly_beaten(&points, SLACK);
    *candidates = kept.into_iter().map(|i| candidates[i]).collect();
}

/// What one task counts.
#[derive(Default)]
struct Tally {
    evaluated: u64,
    excluded: u128,
    near_misses: [Option<f64>; 3],
}

impl Tally {
    fn merge(mut self, other: Tally) -> Tally {
        self.evaluated += other.evaluated;
        self.excluded += other.excluded;
        for (mine, theirs) in self.near_misses.iter_mut().zip(other.near_misses) {
            if let Some(x) = theirs {
                note(mine, x);
            }
        }
        self
    }

    /// Whether the design meets every constraint; if it breaks just one, how nearly.
    fn meets(&mut self, constraints: &Constraints, o: &Objectives) -> bool {
        let broken = constraints.broken(o);
        if broken.iter().filter(|b| **b).count() == 1 {
            let values = [o.tip_deflection_m, o.mass_kg, -o.lowest_mode_hz];
            for (k, _) in broken.iter().enumerate().filter(|(_, b)| **b) {
                note(&mut self.near_misses[k], values[k]);
            }
        }
        !broken.contains(&true)
    }
}

fn note(best: &mut Option<f64>, x: f64) {
    *best = Some(best.map_or(x, |b| b.min(x)));
}

impl<'p, P: FinishRows> Sweep<'p, P> {
    /// A sweep of a problem's designs; it ends early when `stop` is set.
    pub fn new(problem: &'p P, constraints: Constraints, stop: &'p AtomicBool) -> Self {
        Self { problem, constraints, visited: AtomicU64::new(0), stop }
    }

    /// Designs visited or excluded so far.
    pub fn visited(&self) -> u64 {
        self.visited.load(Ordering::Relaxed)
    }

    /// Number of designs in the space.
    pub fn total(&self) -> u128 {
        self.problem.level_sizes().iter().map(|&s| u128::from(s)).product()
    }

    /// Visits every design.
    pub fn run(&self) -> SweepOutcome {
        let sizes = self.problem.level_sizes();
        let overall = Pool::new(6);
        let groups: Vec<Pool> = (0..self.problem.groups()).map(|_| Pool::new(5)).collect();
        let tally = match self.problem.root() {
            None => Tally { excluded: self.total(), ..Tally::default() },
            Some(root) => Visit {
                problem: self.problem,
                compiled: self.problem.compile(),
                visited: &self.visited,
                stop: self.stop,
            }
            .every_design(&root, || Worker {
                constraints: &self.constraints,
                overall: &overall,
                groups: &groups,
                tally: Tally::default(),
                buffer: Vec::new(),
                group_buffers: vec![Vec::new(); groups.len()],
            })
            .map(Worker::finish)
            .reduce(Tally::default, Tally::merge),
        };
        let front = overall.finish();
        let status = match (self.stop.load(Ordering::Relaxed), front.is_empty() || sizes.contains(&0)) {
            (true, _) => Status::Interrupted,
            (false, true) => Status::Infeasible,
            (false, false) => Status::Complete,
        };
        SweepOutcome {
            status,
            designs_total: self.total(),
            designs_evaluated: tally.evaluated,
            designs_excluded: tally.excluded,
            front,
            groups: groups.into_iter().map(Pool::finish).collect(),
            near_misses: tally.near_misses,
        }
    }
}

/// What one task keeps.
struct Worker<'s> {
    constraints: &'s Constraints,
    overall: &'s Pool,
    groups: &'s [Pool],
    tally: Tally,
    buffer: Vec<Candidate>,
    group_buffers: Vec<Vec<Candidate>>,
}

impl Keep for Worker<'_> {
    fn complete(&mut self, number: u128, Finished { objectives, group }: Finished) {
        self.tally.evaluated += 1;
        if !self.tally.meets(self.constraints, &objectives) {
            return;
        }
        let candidate = Candidate { number, objectives };
        // what one of its own group beats, one of all designs beats
        let beaten =
            group.is_some_and(|group| !self.groups[group].offer(candidate, &mut self.group_buffers[group]));
        if !beaten {
            self.overall.offer(candidate, &mut self.buffer);
        }
    }

    fn exclude(&mut self, designs: u128) {
        self.tally.excluded += designs;
    }

    // what one of its own group beats, one of all designs beats; those entered keep the constraints, so that near
    // misses no longer matter once there is a bar
    fn bar_hz(&self, group: Option<usize>, mass_kg: f64, tip_deflection_m: f64) -> f64 {
        let pool = group.map_or(self.overall, |group| &self.groups[group]);
        pool.archive.bar_hz(mass_kg, tip_deflection_m)
    }

    fn below_bar(&mut self, designs: u64) {
        self.tally.evaluated += designs;
    }
}

impl Worker<'_> {
    fn finish(mut self) -> Tally {
        self.overall.empty(&mut self.buffer);
        for (pool, buffer) in self.groups.iter().zip(&mut self.group_buffers) {
            pool.empty(buffer);
        }
        self.tally
    }
}
