//! Tasks in rounds, so that the result does not depend on the number of threads.
//!
//! A search prunes boxes by the designs that it has found. If each new design were told to all workers at once, the
//! boxes that they prune would depend on the moment at which it was found. Therefore tasks are done in rounds. Each
//! task knows the designs that were known when its round began and the designs that it finds itself. When all tasks of
//! a round are done, their findings are learned in the order of the tasks.

use rayon::prelude::*;

/// Number of tasks in a round. With more tasks in a round more threads are busy, but the findings of each task reach
/// the other tasks later.
const TASKS_PER_ROUND: usize = 32;

/// The result of a task: its findings, and the new tasks that it leaves. The last of the new tasks is done first.
pub(super) struct Done<T, F> {
    pub tasks: Vec<T>,
    pub findings: F,
}

/// Does the tasks in `first` and all tasks that these leave, in rounds; the last task of the list is done first. `task`
/// does one task with the knowledge `known`. After each round, `learn` adds the findings of each task to `known`, and
/// then `see` is shown `known` and the open tasks. Returns the tasks that are open when `stopped` becomes true.
pub(super) fn in_rounds<K: Sync, T: Send, F: Send>(
    known: &mut K,
    first: Vec<T>,
    stopped: impl Fn() -> bool,
    task: impl Fn(&K, T) -> Done<T, F> + Sync,
    learn: impl Fn(&mut K, F),
    see: impl Fn(&K, &[T]),
) -> Vec<T> {
    let mut tasks = first;
    while !tasks.is_empty() && !stopped() {
        let round = tasks.split_off(tasks.len().saturating_sub(TASKS_PER_ROUND));
        let done: Vec<Done<T, F>> = round.into_par_iter().map(|one| task(known, one)).collect();
        for one in done {
            tasks.extend(one.tasks);
            learn(known, one.findings);
        }
        see(known, &tasks);
    }
    tasks
}
