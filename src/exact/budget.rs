//! When a search has to end, and how many boxes it has bounded.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

/// The limits of a search that all of its workers share.
pub(super) struct Budget<'p> {
    stop: &'p AtomicBool,
    deadline: Option<Instant>,
    boxes: AtomicU64,
}

impl<'p> Budget<'p> {
    /// A budget that ends when `stop` is set or the deadline has passed.
    pub fn new(stop: &'p AtomicBool, deadline: Option<Instant>) -> Self {
        Self { stop, deadline, boxes: AtomicU64::new(0) }
    }

    /// When the search ends at the latest.
    pub fn deadline(&self) -> Option<Instant> {
        self.deadline
    }

    /// Boxes bounded so far.
    pub fn boxes(&self) -> u64 {
        self.boxes.load(Ordering::Relaxed)
    }

    pub fn count_box(&self) {
        self.boxes.fetch_add(1, Ordering::Relaxed);
    }

    pub fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed) || self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }
}
