//! Work in rounds, so that what comes of it does not depend on who is quicker.
//!
//! A search cuts by what it has found. Were a find told to all workers at once, what they cut would depend on when it
//! came, and so on their number. So tasks are done in rounds: each sees what was known when its round began and what it
//! finds itself, and once all of a round are done what they found is learned, in the order of the tasks.

use rayon::prelude::*;

/// Tasks of a round. More of them keep more workers busy and learn later.
const TASKS: usize = 32;

/// What a task leaves: tasks that come of it, the first to be done last, and what it found.
pub(super) struct Done<T, F> {
    pub tasks: Vec<T>,
    pub findings: F,
}

/// Does tasks and those that come of them, the last first; returns those that are left when the search is stopped.
pub(super) fn in_rounds<K: Sync, T: Send, F: Send>(
    known: &mut K,
    first: Vec<T>,
    stopped: impl Fn() -> bool,
    task: impl Fn(&K, T) -> Done<T, F> + Sync,
    learn: impl Fn(&mut K, F),
) -> Vec<T> {
    let mut tasks = first;
    while !tasks.is_empty() && !stopped() {
        let round = tasks.split_off(tasks.len().saturating_sub(TASKS));
        let done: Vec<Done<T, F>> = round.into_par_iter().map(|one| task(known, one)).collect();
        for one in done {
            tasks.extend(one.tasks);
            learn(known, one.findings);
        }
    }
    tasks
}
