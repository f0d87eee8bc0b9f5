//! The sweep: it evaluates every design, in parallel.
//!
//! `Visit` walks the tree of designs in tasks. A design that another one clearly dominates is dropped at once
//! (`Archive`). The remaining designs are compared exactly from time to time. Memory therefore grows with the front
//! and with the tables of the problem (for arms some kilobytes per option and case), not with the number of designs.
//! The result does not depend on the order of visits or on the number of threads.

use super::finish::FinishRows;
use super::resume::Done;
use super::visit::{Tasks, Visit, Walked, blocks};
use crate::pareto::archive::Archive;
use crate::pareto::front::not_clearly_beaten;
use crate::pareto::objectives::Objectives;
use crate::space::constraint::Constraints;
use crate::space::levels::{Finished, Keep};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// When candidates are compared exactly, a candidate is dropped only if another candidate is better by more than this
/// fraction in every objective. The full model decides between closer candidates later, because the fast model has
/// rounding errors.
pub const SLACK: f64 = 1e-7;
/// Number of added candidates after which the dominated candidates are removed.
const BUFFER: usize = 1 << 15;

/// How a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// The front is proved to be complete, without a visit to every design.
    Certified,
    /// Every design was visited.
    Complete,
    /// The search stopped before the proof was complete. The result states how much may be missing.
    Partial,
    /// Every design was visited, and none meets the limits.
    Infeasible,
    /// The sweep was stopped before every design was visited.
    Interrupted,
}

impl Status {
    /// The word for this status in files.
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

/// A design that no other design found so far clearly dominates, that is, beats in all three objectives by more than
/// the fraction [`SLACK`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Candidate {
    /// Number of the design in its design space.
    pub number: u128,
    /// Objectives of the design by the fast model of the search, which condenses links.
    pub objectives: Objectives,
}

/// The result of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepOutcome {
    /// How the sweep ended.
    pub status: Status,
    /// Number of designs in the space.
    pub designs_total: u128,
    /// Number of designs that meet the limits on drives, stress, slenderness, mass and cost, and were judged. Most
    /// are judged by mass, deflection and an upper bound of the lowest mode, which shows that another design is no
    /// worse in any objective. The rest are judged by all three objectives.
    pub designs_evaluated: u64,
    /// Number of designs that a limit on a drive, stress, slenderness, mass or cost excludes.
    pub designs_excluded: u128,
    /// Candidates for the front of all designs.
    pub front: Vec<Candidate>,
    /// Candidates for the front of each group (material), in the order of the study's materials.
    pub groups: Vec<Vec<Candidate>>,
}

/// The state of a sweep that can be saved and continued by another process.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct SweepState {
    /// Number of tasks into which the sweep is divided.
    tasks: u64,
    /// The numbers of the completed tasks.
    done: Done,
    /// Number of designs that the completed tasks judged by their objectives.
    evaluated: u64,
    /// Number of designs that a limit excluded in the completed tasks.
    excluded: u128,
    /// Candidates for the front of all designs.
    front: Vec<Candidate>,
    /// Candidates for the front of each group (material).
    groups: Vec<Vec<Candidate>>,
}

impl SweepState {
    /// The state as bytes that can be written to a file.
    pub fn to_bytes(&self) -> Vec<u8> {
        postcard::to_stdvec(self).expect("numbers can be written to memory")
    }

    /// Reads the bytes that [`to_bytes`](Self::to_bytes) wrote.
    ///
    /// # Errors
    /// An explanation, if the bytes are not a state.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, String> {
        postcard::from_bytes(bytes).map_err(|e| e.to_string())
    }
}

/// One of the parts into which a space is divided, so that several computers can sweep it. It is part `number` of `of`
/// parts, counted from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Number of this part, counted from 1.
    pub number: u32,
    /// Number of all parts.
    pub of: u32,
}

impl Shard {
    /// A single part that is the whole space.
    pub const WHOLE: Self = Self { number: 1, of: 1 };
}

/// A sweep whose progress other threads can read, and which they can stop.
///
/// The problem is any tree of designs that implements [`FinishRows`]. For arms it is
/// [`ArmProblem`](crate::space::ArmProblem).
///
/// ```
/// use armwright::catalog::Catalogs;
/// use armwright::input::Document;
/// use armwright::search::{Status, Sweep};
/// use armwright::space::{ArmProblem, evaluate};
/// use armwright::study::read_study;
/// use std::sync::atomic::AtomicBool;
///
/// let text = r#"{"name": "one link",
///     "chain": [
///         {"type": "joint", "name": "j2", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e5, "mass_kg": 8},
///         {"type": "link", "name": "arm", "vector_m": [0.5, 0, 0], "choose": {
///             "materials": ["Structural steel S355"],
///             "sections": [{"shape": "round_tube", "diameter_mm": 70, "wall_mm": [2, 3, 4]}]}}],
///     "payload": {"mass_kg": 5},
///     "poses": [{"name": "stretched", "pose_deg": [0]}]}"#;
/// let catalogs = Catalogs::builtin();
/// let study = read_study(Document::parse("study.json", text).expect("JSON"), &catalogs).expect("a sound study");
///
/// let problem = ArmProblem::new(&study.space, &catalogs);
/// let stop = AtomicBool::new(false);
/// let outcome = Sweep::new(&problem, study.space.constraints, &stop).run();
/// assert_eq!((outcome.status, outcome.designs_total), (Status::Complete, 3));
/// // the full model gives the numbers that count
/// let lightest = evaluate(&problem, outcome.front[0].number).expect("a design that holds");
/// assert!(lightest.objectives.mass_kg > 8.0 && lightest.objectives.lowest_mode_hz > 1.0);
/// ```
pub struct Sweep<'p, P: FinishRows> {
    problem: &'p P,
    constraints: Constraints,
    visited: AtomicU64,
    stop: &'p AtomicBool,
    shard: Shard,
    overall: Pool,
    groups: Vec<Pool>,
    /// The completed tasks, and the numbers of designs that these tasks evaluated and excluded.
    done: Mutex<(Done, Tally)>,
}

/// The candidates that all tasks have found for one front: the front of all designs, or the front of one material.
struct Pool {
    /// Table that rejects dominated candidates at once.
    archive: Archive,
    /// The candidates, and the number of them that were left after the last removal of dominated candidates.
    candidates: Mutex<(Vec<Candidate>, usize)>,
}

impl Pool {
    fn new(bits: u32) -> Self {
        Self { archive: Archive::new(bits), candidates: Mutex::new((Vec::new(), 0)) }
    }

    /// Adds a candidate for this front to the buffer of a task, unless the table of earlier candidates shows that one
    /// of them surely dominates it. Returns whether it was added.
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

    /// Moves the candidates from the buffer of a task into the pool.
    fn empty(&self, buffer: &mut Vec<Candidate>) {
        // A task compares its own candidates first, so that it holds the lock only for the few that remain.
        clear_dominated(buffer);
        let mut pool = lock(&self.candidates);
        let (all, settled) = &mut *pool;
        all.append(buffer);
        if all.len() > *settled + BUFFER {
            clear_dominated(all);
            *settled = all.len();
        }
    }

    /// Puts the candidates of an earlier process into the pool.
    fn refill(&self, candidates: Vec<Candidate>) {
        candidates.iter().for_each(|candidate| self.archive.enter(&candidate.objectives));
        *lock(&self.candidates) = (candidates, 0);
    }

    /// The candidates that no other candidate found so far clearly dominates, in the order of their numbers.
    fn candidates(&self) -> Vec<Candidate> {
        let mut all = lock(&self.candidates).0.clone();
        clear_dominated(&mut all);
        // Tasks end in any order. Sorting makes the result independent of this order.
        all.sort_unstable_by_key(|c| c.number);
        // A candidate is in the list twice if an earlier process found it in a task that it did not complete.
        all.dedup_by_key(|c| c.number);
        all
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Number of blocks (sets of designs with the same arm outboard of the row level) that the first `shards` of `of`
/// shards have together. There are `all` blocks. The result is `all * shards / of`, rounded down. It is exact even
/// where the product would overflow.
fn share(all: u128, shards: u32, of: u32) -> u128 {
    let (shards, of) = (u128::from(shards), u128::from(of));
    all / of * shards + all % of * shards / of
}

/// Drops each candidate that another candidate beats in all three objectives by more than [`SLACK`].
pub(crate) fn clear_dominated(candidates: &mut Vec<Candidate>) {
    let points: Vec<[f64; 3]> = candidates.iter().map(|c| c.objectives.minimized()).collect();
    let kept = not_clearly_beaten(&points, SLACK);
    *candidates = kept.into_iter().map(|i| candidates[i]).collect();
}

/// Counts of designs that a task, or all tasks together, visited.
#[derive(Debug, Clone, Copy, Default)]
struct Tally {
    evaluated: u64,
    excluded: u128,
}

impl Tally {
    fn add(&mut self, other: Tally) {
        self.evaluated += other.evaluated;
        self.excluded += other.excluded;
    }
}

impl<'p, P: FinishRows> Sweep<'p, P> {
    /// A sweep of all designs of a problem. It stops early when another thread sets `stop`.
    pub fn new(problem: &'p P, constraints: Constraints, stop: &'p AtomicBool) -> Self {
        Self {
            problem,
            constraints,
            visited: AtomicU64::new(0),
            stop,
            shard: Shard::WHOLE,
            overall: Pool::new(6),
            groups: (0..problem.groups()).map(|_| Pool::new(5)).collect(),
            done: Mutex::default(),
        }
    }

    /// Restricts the sweep to the designs of one shard.
    #[must_use]
    pub fn of_shard(self, shard: Shard) -> Self {
        Self { shard, ..self }
    }

    /// The numbers of the designs that this sweep visits. The ranges of all shards follow each other and cover the
    /// space.
    pub fn range(&self) -> Range<u128> {
        let each = blocks(self.problem).designs_each;
        let Range { start, end } = self.blocks();
        start * each..end * each
    }

    fn blocks(&self) -> Range<u128> {
        let all = blocks(self.problem).count;
        let Shard { number, of } = self.shard;
        let before = |shards: u32| share(all, shards, of);
        before(number - 1)..before(number)
    }

    /// Number of designs visited or excluded so far, by this process and by earlier processes that it continues.
    pub fn visited(&self) -> u64 {
        self.visited.load(Ordering::Relaxed)
    }

    /// Number of designs in the whole space, even if only a shard is visited.
    pub fn total(&self) -> u128 {
        self.problem.level_sizes().iter().map(|&s| u128::from(s)).product()
    }

    fn tasks(&self) -> Tasks {
        Tasks::of(self.problem, self.blocks())
    }

    /// Continues from a saved state of the same sweep. The tasks that are completed in it are not done again.
    ///
    /// # Errors
    /// An explanation, if the state belongs to another sweep: the number of tasks or of groups differs.
    pub fn go_on_from(self, state: SweepState) -> Result<Self, String> {
        let SweepState { tasks, done, evaluated, excluded, front, groups } = state;
        let here = self.tasks().number;
        if tasks != here || !done.is_within(here) || groups.len() != self.groups.len() {
            return Err(format!("a state of {tasks} tasks and {} groups", groups.len()));
        }
        let visited = u128::from(evaluated) + excluded;
        self.visited.store(u64::try_from(visited).unwrap_or(u64::MAX), Ordering::Relaxed);
        *lock(&self.done) = (done, Tally { evaluated, excluded });
        self.overall.refill(front);
        self.groups.iter().zip(groups).for_each(|(pool, candidates)| pool.refill(candidates));
        Ok(self)
    }

    /// The present state, from which another process can continue.
    pub fn state(&self) -> SweepState {
        // The completed tasks are read first. Their candidates are in the pools already.
        let (done, Tally { evaluated, excluded }) = lock(&self.done).clone();
        SweepState {
            tasks: self.tasks().number,
            done,
            evaluated,
            excluded,
            front: self.overall.candidates(),
            groups: self.groups.iter().map(Pool::candidates).collect(),
        }
    }

    /// Visits every design and returns the candidates for the fronts. The full model must then evaluate them
    /// ([`evaluate`](crate::space::evaluate)) and decide between candidates that differ by less than [`SLACK`].
    pub fn run(&self) -> SweepOutcome {
        let sizes = self.problem.level_sizes();
        let before = lock(&self.done).clone();
        // If the sweep is stopped, the designs that were visited in uncompleted tasks count too.
        let tally = match self.problem.root() {
            None => {
                let range = self.range();
                Tally { excluded: range.end - range.start, ..Tally::default() }
            }
            Some(root) => {
                let mut tally = before.1;
                tally.add(self.visit(&root, &before.0));
                tally
            }
        };
        let front = self.overall.candidates();
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
            groups: self.groups.iter().map(Pool::candidates).collect(),
        }
    }

    /// Does the tasks that are not completed in `before`. Returns how many designs they evaluated and excluded. `root`
    /// is the arm without any chosen part.
    fn visit(&self, root: &P::Partial, before: &Done) -> Tally {
        let Self { problem, visited, stop, constraints, overall, groups, .. } = self;
        let visit = Visit { problem: *problem, compiled: problem.compile(), visited, stop };
        let worker = || Worker {
            constraints,
            overall,
            groups,
            tally: Tally::default(),
            buffer: Vec::new(),
            group_buffers: vec![Vec::new(); groups.len()],
        };
        let end = |walked: Walked<Worker>| {
            let counted = walked.keeper.finish();
            if walked.is_whole {
                let mut done = lock(&self.done);
                done.0.insert(walked.task);
                done.1.add(counted);
            }
            counted
        };
        let sum = |mut a: Tally, b: Tally| {
            a.add(b);
            a
        };
        visit.tasks(self.tasks(), root, |task| !before.has(task), worker).map(end).reduce(Tally::default, sum)
    }
}

/// Collects the candidates of one task.
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
        if self.constraints.broken(&objectives).contains(&true) {
            return;
        }
        let candidate = Candidate { number, objectives };
        // A design that another design of its own group dominates is dominated in the front of all designs too.
        let dominated =
            group.is_some_and(|group| !self.groups[group].offer(candidate, &mut self.group_buffers[group]));
        if !dominated {
            self.overall.offer(candidate, &mut self.buffer);
        }
    }

    fn exclude(&mut self, designs: u128) {
        self.tally.excluded += designs;
    }

    // A design of a group can be on two fronts: the front of the group and the front of all designs. If a design of
    // its own group dominates it, it is on neither front, so the bar of the group is used.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_bytes_are_a_state_or_an_error() {
        let state = SweepState { tasks: 7, evaluated: 3, groups: vec![vec![], vec![]], ..Default::default() };
        let bytes = state.to_bytes();
        assert_eq!(SweepState::from_bytes(&bytes), Ok(state));
        assert!(SweepState::from_bytes(&bytes[..bytes.len() - 1]).is_err());
        assert!(SweepState::from_bytes(&[0xff; 40]).is_err());
    }
}
