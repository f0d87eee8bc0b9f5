//! Visits every design of a tree, in parallel.
//!
//! A *row* is the set of designs that differ in the row level alone. Each task takes a range of rows. It builds the
//! arm outboard of a row level by level, and reuses the levels that are the same as in the row before. The designs of
//! several rows are evaluated together, in batches. A task keeps its results to itself until it ends, so that tasks
//! do not wait for each other.

use super::finish::FinishRows;
use crate::space::design::options;
use crate::space::levels::{DesignRow, Finished, Keep};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Number of tasks to aim for: enough to give all threads equal work and to report progress.
const TASKS: u128 = 512;
/// A task has at least a whole batch of rows, unless this would give fewer than this number of tasks. In a small space
/// tasks are smaller than a batch, because idle threads cost more than incomplete batches.
const LEAST_TASKS: u128 = 64;
/// Largest number of rows in a batch. All rows of a batch are evaluated together, so that each chunk of the row level
/// is read from memory once for the batch.
const ROWS_PER_BATCH: usize = 16;
/// Largest number of designs in a batch.
const BATCH_DESIGNS: usize = 1 << 18;

/// Largest number of designs of a task. Their evaluation takes some seconds, and is lost if the task is interrupted.
const TASK_DESIGNS: u128 = 1 << 24;

/// A visit to all designs of a tree. Other threads can read its progress and stop it.
pub(crate) struct Visit<'p, P: FinishRows> {
    pub problem: &'p P,
    /// The numbers of the row level that are the same in all rows.
    pub compiled: P::Compiled,
    /// Number of designs visited or excluded so far.
    pub visited: &'p AtomicU64,
    /// Set by another thread to stop the visit.
    pub stop: &'p AtomicBool,
}

impl<P: FinishRows> Visit<'_, P> {
    /// Visits every design below `root`, the arm without any chosen part. `keeper` makes the keeper that collects the
    /// designs of one task. The keepers are returned in the order of the tasks.
    pub(crate) fn every_design<'v, K: Keep + Send + 'v>(
        &'v self,
        root: &'v P::Partial,
        keeper: impl Fn() -> K + Send + Sync + 'v,
    ) -> impl ParallelIterator<Item = K> + 'v {
        let tasks = Tasks::of(self.problem, 0..blocks(self.problem).count);
        self.tasks(tasks, root, |_| true, keeper).map(|walked| walked.keeper)
    }

    /// Does the tasks with numbers for which `is_wanted` is true, until the visit is stopped. `keeper` makes the keeper
    /// that collects the designs of one task.
    pub(crate) fn tasks<'v, K: Keep + Send + 'v>(
        &'v self,
        Tasks { start, rows, each, number }: Tasks,
        root: &'v P::Partial,
        is_wanted: impl Fn(u64) -> bool + Send + Sync + 'v,
        keeper: impl Fn() -> K + Send + Sync + 'v,
    ) -> impl ParallelIterator<Item = Walked<K>> + 'v {
        let is_wanted = move |task: &u64| is_wanted(*task) && !self.stop.load(Ordering::Relaxed);
        (0..number).into_par_iter().filter(is_wanted).map(move |task| {
            let first = u128::from(task) * each;
            let mut walker = Walker::new(self, root, keeper());
            let is_whole = walker.walk(start + first..start + (first + each).min(rows));
            Walked { task, is_whole, keeper: walker.keeper }
        })
    }
}

/// The tasks of a visit: consecutive ranges of rows. They depend on the problem alone, so that another process
/// divides it in the same way.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tasks {
    /// Number of the first row that the visit covers.
    start: u128,
    /// Number of rows that the visit covers.
    rows: u128,
    /// Number of rows in each task; the last task may have fewer.
    each: u128,
    /// Number of tasks into which these rows are divided.
    pub number: u64,
}

impl Tasks {
    /// Divides the designs of a range of [blocks] into tasks. `blocks` is the range of the block numbers.
    pub(crate) fn of(problem: &impl FinishRows, blocks: Range<u128>) -> Self {
        let Levels { row, inner, .. } = Levels::of(problem);
        let choices = product(inner);
        let (start, rows) = (blocks.start * choices, (blocks.end - blocks.start) * choices);
        let balanced = (rows / TASKS).max((ROWS_PER_BATCH as u128).min(rows / LEAST_TASKS));
        let each = balanced.min(TASK_DESIGNS / u128::from(row.max(1))).max(1);
        Self { start, rows, each, number: u64::try_from(rows.div_ceil(each)).unwrap_or(u64::MAX) }
    }
}

/// A task that has ended.
pub(crate) struct Walked<K> {
    /// Number of the task.
    pub task: u64,
    /// Whether all rows of the task were visited; `false` if the visit was stopped before.
    pub is_whole: bool,
    /// The keeper of the task, with the designs that it collected.
    pub keeper: K,
}

/// The blocks of a tree. A block has all designs with the same arm outboard of the row level; their numbers follow each
/// other.
pub(crate) struct Blocks {
    pub count: u128,
    /// Number of designs in each block.
    pub designs_each: u128,
}

pub(crate) fn blocks(problem: &impl FinishRows) -> Blocks {
    let Levels { outer, row, inner } = Levels::of(problem);
    Blocks { count: product(outer), designs_each: u128::from(row) * product(inner) }
}

/// Number of options at each level, in three parts: the levels outboard of the row level, the row level itself, and the
/// levels inboard of it.
struct Levels<'p> {
    outer: &'p [u32],
    row: u32,
    inner: &'p [u32],
}

impl<'p> Levels<'p> {
    /// Splits the levels of a problem. A problem without levels gets a row of one design.
    fn of(problem: &'p impl FinishRows) -> Self {
        let (outer, inward) = problem.level_sizes().split_at(problem.row_level());
        let (row, inner) = inward.split_first().map_or((1, inward), |(&row, inner)| (row, inner));
        Self { outer, row, inner }
    }
}

fn product(sizes: &[u32]) -> u128 {
    sizes.iter().map(|&size| u128::from(size)).product()
}

/// A worker's progress through the rows of one task.
struct Walker<'v, 'p, P: FinishRows, K> {
    visit: &'v Visit<'p, P>,
    keeper: K,
    /// The partial arms outboard of the last row: the empty arm, the arm with one level, with two levels, and so on.
    begun: Vec<P::Partial>,
    /// The options with which the arms in `begun` were built, tip first.
    options: Vec<u32>,
    /// Rows that wait to be evaluated together.
    batch: Vec<DesignRow<P::Partial>>,
    scratch: P::Scratch,
}

impl<'v, 'p, P: FinishRows, K: Keep> Walker<'v, 'p, P, K> {
    fn new(visit: &'v Visit<'p, P>, root: &P::Partial, keeper: K) -> Self {
        let levels = visit.problem.level_sizes().len();
        Self {
            visit,
            keeper,
            begun: vec![root.clone(); levels.max(1)],
            options: Vec::new(),
            batch: Vec::new(),
            scratch: visit.problem.scratch(),
        }
    }

    /// Visits every design of the rows with these numbers. Returns `false` if the visit was stopped before the end. A
    /// space without levels has a single design.
    fn walk(&mut self, rows: Range<u128>) -> bool {
        let problem = self.visit.problem;
        if problem.level_sizes().is_empty() {
            if let Some(objectives) = problem.objectives(&self.begun[0]) {
                let group = problem.group(&self.begun[0]);
                self.keeper.complete(0, Finished { objectives, group });
            }
            return true;
        }
        let Levels { outer, row: length, inner } = Levels::of(problem);
        let batch = (BATCH_DESIGNS / length.max(1) as usize).clamp(1, ROWS_PER_BATCH);
        // Rows with the same arm outboard follow each other. There is one for each combination of options inboard of
        // the row level.
        let choices = product(inner);
        let mut row = rows.start;
        while row < rows.end && !self.visit.stop.load(Ordering::Relaxed) {
            let (arm, choice) = (row / choices, row % choices);
            let next = match self.begin(outer, arm) {
                Ok(()) => {
                    self.batch.push(DesignRow {
                        from: self.begun[outer.len()].clone(),
                        arm,
                        inner: options(inner, choice).unwrap_or_default(),
                        first: arm * u128::from(length) * choices + choice,
                        step: choices,
                    });
                    row + 1
                }
                Err(level) => {
                    // Every row with the same options up to this level fails too, so the next row is the first that
                    // differs.
                    let rows_of_level = product(&outer[level + 1..]) * choices;
                    let next = ((row / rows_of_level + 1) * rows_of_level).min(rows.end);
                    let designs = (next - row) * u128::from(length);
                    self.keeper.exclude(designs);
                    self.count(designs);
                    next
                }
            };
            row = next;
            if self.batch.len() == batch {
                self.finish(length);
            }
        }
        self.finish(length);
        row >= rows.end
    }

    /// Builds the arm with the number `arm` among all arms outboard of the row level. `outer` are the numbers of
    /// options of the levels outboard of the row level.
    ///
    /// # Errors
    /// The level at which the arm breaks a limit, whatever the options of the later levels are.
    fn begin(&mut self, outer: &[u32], arm: u128) -> Result<(), usize> {
        let wanted = options(outer, arm).unwrap_or_default();
        // Neighbouring rows differ in their last levels. The partial arms up to the first difference are used again.
        let shared = self.options.iter().zip(&wanted).take_while(|(a, b)| a == b).count();
        self.options.truncate(shared);
        for (level, &option) in wanted.iter().enumerate().skip(shared) {
            let (outboard, inboard) = self.begun.split_at_mut(level + 1);
            if !self.visit.problem.extend(level, option, &outboard[level], &mut inboard[0]) {
                return Err(level);
            }
            self.options.push(option);
        }
        Ok(())
    }

    /// Evaluates the rows that wait in the batch. `row_length` is the number of designs in each row.
    fn finish(&mut self, row_length: u32) {
        let Visit { problem, compiled, .. } = self.visit;
        problem.finish(compiled, &self.batch, &mut self.scratch, &mut self.keeper);
        self.count(self.batch.len() as u128 * u128::from(row_length));
        self.batch.clear();
    }

    /// Adds to the number of visited designs, from which the progress is reported.
    fn count(&self, designs: u128) {
        self.visit.visited.fetch_add(u64::try_from(designs).unwrap_or(u64::MAX), Ordering::Relaxed);
    }
}
