//! The state of a search, from which another process goes on where this one ended.
//!
//! A sweep is divided into tasks, each a range of designs. Its state is which tasks are done, their counts, and the candidates
//! found so far. A task that was only begun is done again: what it found before is found again, so the candidates are the
//! same in the end, and the counts are those of whole tasks.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Keeps states of a search.
pub trait KeepState: Sync {
    /// Whether it is time to keep the state again.
    fn is_due(&self) -> bool;

    /// Keeps a state in place of the one before. If that fails, the search goes on all the same.
    fn keep(&self, state: &[u8]);
}

/// How a search goes on: the state that an earlier process left, and who keeps the next ones.
#[derive(Clone, Copy)]
pub struct Resume<'s> {
    /// The state of an earlier process; `None` to begin.
    pub from: Option<&'s [u8]>,
    /// Who keeps the states of this process.
    pub keeper: &'s dyn KeepState,
}

/// A set of tasks, as ranges that do not touch each other: the end of each range by its start.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Done(BTreeMap<u64, u64>);

impl Done {
    /// Adds a task.
    pub(super) fn insert(&mut self, task: u64) {
        let before = self.0.range(..=task).next_back().map(|(&start, &end)| (start, end));
        if before.is_some_and(|(_, end)| end > task) {
            return;
        }
        let start = before.filter(|(_, end)| *end == task).map_or(task, |(start, _)| start);
        let end = self.0.remove(&(task + 1)).unwrap_or(task + 1);
        self.0.insert(start, end);
    }

    /// Whether a task is in the set.
    pub(super) fn has(&self, task: u64) -> bool {
        self.0.range(..=task).next_back().is_some_and(|(_, &end)| end > task)
    }

    /// Whether every task is one of the first so many.
    pub(super) fn is_within(&self, tasks: u64) -> bool {
        self.0.iter().all(|(&start, &end)| start < end && end <= tasks)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_of_tasks_grow_together() {
        let mut done = Done::default();
        for task in [5, 3, 9, 4, 4, 0, 8] {
            done.insert(task);
        }
        assert_eq!(done.0.iter().map(|(&a, &b)| (a, b)).collect::<Vec<_>>(), [(0, 1), (3, 6), (8, 10)]);
        let there: Vec<u64> = (0..12).filter(|&task| done.has(task)).collect();
        assert_eq!(there, [0, 3, 4, 5, 8, 9]);
        assert!(done.is_within(10) && !done.is_within(9));
    }
}
