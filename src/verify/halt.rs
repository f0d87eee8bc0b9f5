//! Counters of a search, and the conditions that end it early.

use super::parts_box::Design;
use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// The search stops when more single designs than this are left to be judged. So many designs mean that the checked
/// front lacks a large part of the true front.
const MOST_DESIGNS: usize = 200_000;

/// Number of boxes that a search has bounded, and number of boxes that it left open.
#[derive(Default)]
pub(super) struct Found {
    pub boxes: u64,
    pub open: u64,
}

impl Found {
    pub(super) fn with(self, other: Self) -> Self {
        Self { boxes: self.boxes + other.boxes, open: self.open + other.open }
    }
}

/// The designs that a search has reached, together with the conditions that end it early.
pub(super) struct Halt<'s> {
    pub stop: &'s AtomicBool,
    pub deadline: Option<Instant>,
    /// Single designs that no bound discarded, each of which is to be judged by the full model. `count` is their
    /// number, which can be read without a lock.
    pub designs: Mutex<BTreeSet<Design>>,
    pub count: AtomicUsize,
}

impl Halt<'_> {
    /// Whether the search has to end early.
    pub(super) fn stopped(&self) -> bool {
        self.count.load(Ordering::Relaxed) > MOST_DESIGNS || self.out_of_time()
    }

    /// Stores a design that no bound discarded; `None` stores nothing. The designs are a set, because the same design
    /// may be found in several regions.
    pub(super) fn note(&self, design: Option<Design>) {
        let mut designs = self.designs.lock().unwrap_or_else(PoisonError::into_inner);
        designs.extend(design);
        self.count.store(designs.len(), Ordering::Relaxed);
    }

    /// Whether the user has stopped the search or its deadline has passed.
    pub(super) fn out_of_time(&self) -> bool {
        self.stop.load(Ordering::Relaxed) || self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }
}
