//! Walking through every design of a tree, in parallel.
//!
//! The tree's first levels are cut into tasks; each task walks its part depth first with one partial arm a
//! level, and keeps what it finds for itself.

use super::design::number;
use super::{Finished, OutwardIn};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Tasks to aim for: enough for balance and for a progress report.
const TASKS: u128 = 512;

/// What a task does with the designs of its part.
pub(super) trait Keep: Send {
    /// A design that holds.
    fn complete(&mut self, number: u128, finished: Finished);

    /// So many designs cannot hold.
    fn exclude(&mut self, designs: u128);
}

/// A walk that others can watch and stop.
pub(super) struct Visit<'p, P: OutwardIn> {
    pub problem: &'p P,
    /// Designs visited or excluded so far.
    pub visited: &'p AtomicU64,
    pub stop: &'p AtomicBool,
}

impl<P: OutwardIn> Visit<'_, P> {
    /// Visits every design beyond the empty arm; what the tasks kept comes in the order of the tasks.
    pub fn every_design<'v, K: Keep + 'v>(
        &'v self,
        root: &'v P::Partial,
        keeper: impl Fn() -> K + Send + Sync + 'v,
    ) -> impl ParallelIterator<Item = K> + 'v {
        self.tasks().into_par_iter().map(move |beginning| self.task(&beginning, root, keeper()))
    }

    /// Beginnings of designs, tip first, each a task.
    fn tasks(&self) -> Vec<Vec<u32>> {
        let sizes = self.problem.level_sizes();
        let mut tasks: Vec<Vec<u32>> = vec![Vec::new()];
        for &size in sizes.iter().take(sizes.len().saturating_sub(1)) {
            if tasks.len() as u128 >= TASKS {
                break;
            }
            tasks = tasks
                .into_iter()
                .flat_map(|t| (0..size).map(move |option| [t.as_slice(), &[option]].concat()))
                .collect();
        }
        tasks
    }

    fn task<K: Keep>(&self, beginning: &[u32], root: &P::Partial, keeper: K) -> K {
        let mut walker = Walker { visit: self, keeper, options: beginning.to_vec(), scratch: None };
        if self.stop.load(Ordering::Relaxed) {
            return walker.keeper;
        }
        let mut partial = root.clone();
        for (level, &option) in beginning.iter().enumerate() {
            let mut next = root.clone();
            if !self.problem.extend(level, option, &partial, &mut next) {
                // other tasks with this beginning count their own designs
                walker.exclude(beginning.len());
                return walker.keeper;
            }
            partial = next;
        }
        let levels_left = self.problem.level_sizes().len() - beginning.len();
        let mut stack = vec![partial; levels_left.max(1)];
        walker.descend(beginning.len(), &mut stack);
        walker.keeper
    }
}

/// One task at work.
struct Walker<'v, 'p, P: OutwardIn, K> {
    visit: &'v Visit<'p, P>,
    keeper: K,
    options: Vec<u32>,
    scratch: Option<P::Scratch>,
}

impl<P: OutwardIn, K: Keep> Walker<'_, '_, P, K> {
    fn descend(&mut self, level: usize, stack: &mut [P::Partial]) {
        let problem = self.visit.problem;
        let sizes = problem.level_sizes();
        if level + 1 >= sizes.len() {
            self.finish_row(&stack[0]);
            return;
        }
        for option in 0..sizes[level] {
            if self.visit.stop.load(Ordering::Relaxed) {
                return;
            }
            let (here, beyond) = stack.split_at_mut(1);
            if !problem.extend(level, option, &here[0], &mut beyond[0]) {
                self.exclude(level + 1);
                continue;
            }
            self.options.push(option);
            self.descend(level + 1, beyond);
            self.options.pop();
        }
    }

    /// Every option of the innermost level. A space without levels is one design.
    fn finish_row(&mut self, from: &P::Partial) {
        let problem = self.visit.problem;
        let Some(&size) = problem.level_sizes().last() else {
            if let Some(objectives) = problem.objectives(from) {
                self.keeper.complete(0, Finished { objectives, group: problem.group(from) });
            }
            return;
        };
        let first = number(problem.level_sizes(), &self.options) * u128::from(size);
        let mut scratch = self.scratch.take().unwrap_or_else(|| problem.scratch());
        problem.finish(from, 0..size, &mut scratch, |option, finished| match finished {
            Some(finished) => self.keeper.complete(first + u128::from(option), finished),
            None => self.keeper.exclude(1),
        });
        self.scratch = Some(scratch);
        self.visit.visited.fetch_add(u64::from(size), Ordering::Relaxed);
    }

    /// Counts every design with the present beginning of `levels` levels as excluded.
    fn exclude(&mut self, levels: usize) {
        let sizes = self.visit.problem.level_sizes();
        let below: u128 = sizes[levels..].iter().map(|&s| u128::from(s)).product();
        self.keeper.exclude(below);
        if levels < sizes.len() {
            self.visit.visited.fetch_add(u64::try_from(below).unwrap_or(u64::MAX), Ordering::Relaxed);
        }
    }
}
