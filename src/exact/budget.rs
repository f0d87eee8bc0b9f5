//! The budget of a search: when it has to end, and how many boxes it has bounded.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

/// The limits of a search, shared by all of its workers.
pub(super) struct Budget<'p> {
    stop: &'p AtomicBool,
    deadline: Option<Instant>,
    boxes: AtomicU64,
}

impl<'p> Budget<'p> {
    /// A budget that ends the search when `stop` is set or the deadline has passed.
    pub(super) fn new(stop: &'p AtomicBool, deadline: Option<Instant>) -> Self {
        Self { stop, deadline, boxes: AtomicU64::new(0) }
    }

    /// The time at which the search ends at the latest.
    pub(super) fn deadline(&self) -> Option<Instant> {
        self.deadline
    }

    /// The number of boxes bounded so far.
    pub(super) fn boxes(&self) -> u64 {
        self.boxes.load(Ordering::Relaxed)
    }

    /// Counts one more box.
    pub(super) fn count_box(&self) {
        self.boxes.fetch_add(1, Ordering::Relaxed);
    }

    /// Whether the search has to end now.
    pub(super) fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed) || self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }
}
