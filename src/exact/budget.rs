//! The budget of a search: its time limit, and a count of the boxes that it has bounded.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

/// The stop signal, the time limit and the count of boxes of a search, shared by all of its workers.
pub(super) struct Budget<'p> {
    stop: &'p AtomicBool,
    started: Instant,
    deadline: Option<Instant>,
    boxes: AtomicU64,
}

impl<'p> Budget<'p> {
    /// A budget that ends the search when `stop` is set or the deadline has passed.
    pub(super) fn new(stop: &'p AtomicBool, deadline: Option<Instant>) -> Self {
        Self { stop, started: Instant::now(), deadline, boxes: AtomicU64::new(0) }
    }

    /// A budget with the same stop signal and time limit, but with a separate count of boxes. It is for work whose
    /// boxes are not counted as boxes of the search.
    pub(super) fn aside(&self) -> Self {
        Self { boxes: AtomicU64::new(0), ..*self }
    }

    /// Sets the count to the number of boxes that an earlier process has bounded.
    pub(super) fn set_boxes(&self, boxes: u64) {
        self.boxes.store(boxes, Ordering::Relaxed);
    }

    /// Time left until the deadline \[s\]; 0 if it has passed, `None` without a time limit.
    pub(super) fn left_s(&self) -> Option<f64> {
        let left = |deadline: Instant| deadline.saturating_duration_since(Instant::now()).as_secs_f64();
        self.deadline.map(left)
    }

    /// Whether the fraction `part` of the time limit has passed, or the search has to end now.
    pub(super) fn has_spent(&self, part: f64) -> bool {
        let limit = self.deadline.map(|deadline| deadline.saturating_duration_since(self.started));
        self.stopped() || limit.is_some_and(|limit| self.started.elapsed() >= limit.mul_f64(part))
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
