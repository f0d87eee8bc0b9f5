//! Tasks in rounds, so that the result does not depend on the number of threads.
//!
//! A search prunes by what it has found. If a design found were told to all workers at once, what they prune
//! would depend on when it was found. Therefore tasks are done in rounds. Each task sees what was known when
//! its round began, and what it finds itself. When all tasks of a round are done, their findings are learned
//! in the order of the tasks.

use rayon::prelude::*;

/// Number of tasks in a round. More tasks keep more threads busy, but their findings are learned later.
const TASKS: usize = 32;

/// The result of a task: its findings, and new tasks, of which the last is done first.
pub(super) struct Done<T, F> {
    pub tasks: Vec<T>,
    pub findings: F,
}

/// Does the tasks in `first` and the tasks that they produce, the last first. `see` is shown what is known and which
/// tasks are open after each round. Returns the tasks that remain when the search is stopped.
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
        let round = tasks.split_off(tasks.len().saturating_sub(TASKS));
        let done: Vec<Done<T, F>> = round.into_par_iter().map(|one| task(known, one)).collect();
        for one in done {
            tasks.extend(one.tasks);
            learn(known, one.findings);
        }
        see(known, &tasks);
    }
    tasks
}
