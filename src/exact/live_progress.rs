//! The progress of a search while it runs, for other threads to read.
//!
//! The reported gap never rises. A bound that was proved once stays proved, because the designs found so
//! far only get better.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// The progress of an exact search at one moment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Known {
    /// Number of boxes whose bound was computed.
    pub boxes: u64,
    /// Number of boxes or regions that the present pass has yet to bound.
    pub boxes_open: u64,
    /// Number of designs whose three objectives were computed.
    pub designs: u64,
    /// Number of designs found that no other dominates.
    pub front_size: u64,
    /// Gap: for every design of the space, some design found is worse by at most this fraction in each objective.
    /// `None` if nothing is proved yet.
    pub gap: Option<f64>,
}

/// Least time between two updates.
const UPDATE_INTERVAL: Duration = Duration::from_millis(250);
/// Least ratio of the time between two updates to the time that one update takes. Updates thus take at most 2 % of the
/// time.
const UPDATE_INTERVAL_RATIO: u32 = 50;

/// The latest progress of a search, shared by the search and the threads that watch it.
#[derive(Default)]
pub(super) struct LiveProgress(Mutex<Latest>);

#[derive(Default)]
struct Latest {
    known: Known,
    /// Time from which the next update is due; `None` before the first update.
    due: Option<Instant>,
}

impl LiveProgress {
    /// The latest progress, except for the number of boxes, which is not known here.
    pub(super) fn known(&self) -> Known {
        self.lock().known
    }

    /// Reports a gap that was proved (relative). A gap that is not smaller than the last reported gap is ignored.
    /// `None` is ignored too.
    pub(super) fn prove(&self, gap: Option<f64>) {
        let known = &mut self.lock().known;
        known.gap = least(known.gap, gap);
    }

    /// Reports the progress that `news` returns, if an update is due. If updates take long, they are due less often.
    pub(super) fn update(&self, news: impl FnOnce() -> Known) {
        let began = Instant::now();
        if self.lock().due.is_some_and(|due| began < due) {
            return;
        }
        self.tell(news());
        let after = UPDATE_INTERVAL.max(began.elapsed() * UPDATE_INTERVAL_RATIO);
        self.lock().due = Some(Instant::now() + after);
    }

    /// Reports the new progress `news`. The reported gap is replaced only by a smaller gap.
    pub(super) fn tell(&self, news: Known) {
        let known = &mut self.lock().known;
        *known = Known { gap: least(known.gap, news.gap), ..news };
    }

    fn lock(&self) -> MutexGuard<'_, Latest> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The smaller of two gaps. `None` means that a gap is unknown; then the other gap is returned.
pub(super) fn least(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    a.into_iter().chain(b).reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_that_was_proved_stays_proved() {
        let live = LiveProgress::default();
        let gaps = [None, Some(0.7), None, Some(0.9), Some(0.2)].map(|gap| {
            live.tell(Known { gap, ..Known::default() });
            live.known().gap
        });
        assert_eq!(gaps, [None, Some(0.7), Some(0.7), Some(0.7), Some(0.2)]);
        live.prove(Some(0.5));
        assert_eq!(live.known().gap, Some(0.2));
    }
}
