//! What a search knows while it runs, for other threads to read.
//!
//! The gap that is told never rises: a bound that was proved once stays proved, for incumbents only get better.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// What an exact search knows at a moment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Known {
    /// Number of boxes bounded.
    pub boxes: u64,
    /// Number of boxes or regions that the present pass has yet to bound.
    pub boxes_open: u64,
    /// Number of designs whose three objectives were computed.
    pub designs: u64,
    /// Number of designs found that no other dominates.
    pub front_size: u64,
    /// The gap: for every design of the space some found one is worse by at most this part in each objective. `None`
    /// if nothing is known yet.
    pub gap: Option<f64>,
}

/// Least time between two updates.
const EVERY: Duration = Duration::from_millis(250);
/// An update may take at most one part in this of the time.
const SHARE: u32 = 50;

/// What is known of a search, shared by the search and those who watch it.
#[derive(Default)]
pub(super) struct Live(Mutex<Latest>);

#[derive(Default)]
struct Latest {
    known: Known,
    /// When the next update is due.
    due: Option<Instant>,
}

impl Live {
    /// What is known now, except for the number of boxes.
    pub(super) fn known(&self) -> Known {
        self.lock().known
    }

    /// Tells of a gap that was proved, unless a smaller one was proved before.
    pub(super) fn prove(&self, gap: Option<f64>) {
        let known = &mut self.lock().known;
        known.gap = least(known.gap, gap);
    }

    /// Tells of what has changed, if an update is due. An update that takes long is due less often.
    pub(super) fn update(&self, news: impl FnOnce() -> Known) {
        let began = Instant::now();
        if self.lock().due.is_some_and(|due| began < due) {
            return;
        }
        self.tell(news());
        let after = EVERY.max(began.elapsed() * SHARE);
        self.lock().due = Some(Instant::now() + after);
    }

    /// Tells of what has changed.
    pub(super) fn tell(&self, news: Known) {
        let known = &mut self.lock().known;
        *known = Known { gap: least(known.gap, news.gap), ..news };
    }

    fn lock(&self) -> MutexGuard<'_, Latest> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The smaller of two bounds; a bound that is `None` is unknown and does not count.
pub(super) fn least(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    a.into_iter().chain(b).reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_that_was_proved_stays_proved() {
        let live = Live::default();
        let gaps = [None, Some(0.7), None, Some(0.9), Some(0.2)].map(|gap| {
            live.tell(Known { gap, ..Known::default() });
            live.known().gap
        });
        assert_eq!(gaps, [None, Some(0.7), Some(0.7), Some(0.7), Some(0.2)]);
        live.prove(Some(0.5));
        assert_eq!(live.known().gap, Some(0.2));
    }
}
