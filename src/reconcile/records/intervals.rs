//! Intervals of estimates: whether they exclude zero, and how they are widened.

use crate::reconcile::model::estimate::Estimate;

/// Whether the whole interval of the estimate lies above zero. `false` if the lower end is open.
pub(super) fn is_positive(estimate: &Estimate) -> bool {
    estimate.low.is_some_and(|low| low > 0.0)
}

/// The estimate `one` with its interval widened to cover the interval of `other`. An end that is open (`None`) in
/// either is open.
pub(super) fn covering(one: Estimate, other: Estimate) -> Estimate {
    Estimate {
        value: one.value,
        low: one.low.zip(other.low).map(|(a, b)| a.min(b)),
        high: one.high.zip(other.high).map(|(a, b)| a.max(b)),
    }
}

/// Half of the width of the interval; 0 if an end is open.
pub(super) fn half(estimate: &Estimate) -> f64 {
    estimate.high.zip(estimate.low).map_or(0.0, |(high, low)| 0.5 * (high - low))
}

/// The estimate with its interval widened so that each end is at least `least` away from the value.
pub(super) fn widened(estimate: Estimate, least: f64) -> Estimate {
    Estimate {
        low: estimate.low.map(|low| low.min(estimate.value - least)),
        high: estimate.high.map(|high| high.max(estimate.value + least)),
        ..estimate
    }
}

/// The estimate of a coefficient that a fit may make too small. `least`, from 0 to 1, is the smallest possible ratio of
/// the fitted to the true value. The interval is widened to cover every true value that is possible; with a ratio of 0
/// its ends are infinite. The value stays.
pub(super) fn attenuated(estimate: Estimate, least: f64) -> Estimate {
    let up = |end: f64| if end > 0.0 { end.max(end / least) } else { end };
    let down = |end: f64| if end < 0.0 { end.min(end / least) } else { end };
    Estimate { value: estimate.value, low: estimate.low.map(down), high: estimate.high.map(up) }
}

/// Whether the whole interval lies above zero, or the whole of it below zero.
pub(super) fn excludes_zero(estimate: &Estimate) -> bool {
    is_positive(estimate) || estimate.high.is_some_and(|h| h < 0.0)
}
