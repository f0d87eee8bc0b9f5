//! The saved state of a sweep, from which another process can continue.
//!
//! A sweep is divided into tasks. Each task is a range of designs. The state contains the set of completed tasks, the
//! numbers of designs that these tasks evaluated and excluded, and the candidates found so far. A task that was begun
//! but not completed is done again from its start. It finds the same candidates again, so the result is the same as
//! without the interruption.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Saves states of a search, for instance in a file.
pub trait KeepState: Sync {
    /// Whether enough time has passed since the last save that the state is to be saved again.
    fn is_due(&self) -> bool;

    /// Saves a state in place of the state saved before. If saving fails, the search continues all the same.
    fn keep(&self, state: &[u8]);
}

/// Where a search starts from, and where it saves its states.
#[derive(Clone, Copy)]
pub struct Resume<'s> {
    /// The state that an earlier process saved; `None` to start from the beginning.
    pub from: Option<&'s [u8]>,
    /// Receives the states of this process.
    pub keeper: &'s dyn KeepState,
}

/// A set of numbers of completed tasks, stored as ranges that do not touch each other. Each entry of the map is a
/// range: the key is its first task, and the value is the first task after it.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Done(BTreeMap<u64, u64>);

impl Done {
    /// Adds the task with this number to the set, and joins ranges that touch each other.
    pub(super) fn insert(&mut self, task: u64) {
        let before = self.0.range(..=task).next_back().map(|(&start, &end)| (start, end));
        if before.is_some_and(|(_, end)| end > task) {
            return;
        }
        let start = before.filter(|(_, end)| *end == task).map_or(task, |(start, _)| start);
        let end = self.0.remove(&(task + 1)).unwrap_or(task + 1);
        self.0.insert(start, end);
    }

    /// Whether the task with this number is in the set.
    pub(super) fn has(&self, task: u64) -> bool {
        self.0.range(..=task).next_back().is_some_and(|(_, &end)| end > task)
    }

    /// Whether this set can belong to a sweep of `tasks` tasks: all its numbers must be below `tasks`. It is `false`
    /// also if a range is empty or reversed, as in a damaged file.
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
