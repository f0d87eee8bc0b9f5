//! Round limits at which fronts are compared, spread over the range where the fronts overlap.

use super::question::Question;
use crate::report::number::times_power_of_ten;
use crate::report::picks::{Design, Objective, best};
use serde::Serialize;

/// Number of limits that are chosen for each question.
const LIMITS_PER_QUESTION: usize = 3;

/// Limits at which fronts are compared. A question whose list is empty is not asked.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Thresholds {
    /// Limits on tip deflection \[mm\].
    pub deflection_mm: Vec<f64>,
    /// Limits on mass \[kg\].
    pub mass_kg: Vec<f64>,
    /// Limits on the lowest mode \[Hz\].
    pub mode_hz: Vec<f64>,
}

impl Thresholds {
    /// The limits at which a question is asked.
    pub fn of(&self, question: Question) -> &[f64] {
        match question.limited() {
            Objective::Deflection => &self.deflection_mm,
            Objective::Mass => &self.mass_kg,
            Objective::Mode => &self.mode_hz,
        }
    }

    /// Whether there is no limit at all.
    pub fn is_empty(&self) -> bool {
        self.deflection_mm.is_empty() && self.mass_kg.is_empty() && self.mode_hz.is_empty()
    }

    /// The limits of `self`, if it has at least one. Otherwise round limits are chosen for the given fronts, none of
    /// which may be empty. Most fronts can meet them, and for most fronts they still force a trade-off.
    pub fn or_chosen(&self, fronts: &[&[Design]]) -> Self {
        if !self.is_empty() || fronts.is_empty() {
            return self.clone();
        }
        let choose = |limited| {
            let (strict, loose) = overlap(limited, fronts);
            round_between(strict.min(loose), strict.max(loose), LIMITS_PER_QUESTION, limited)
        };
        Self {
            deflection_mm: choose(Objective::Deflection),
            mass_kg: choose(Objective::Mass),
            mode_hz: choose(Objective::Mode),
        }
    }
}

/// The range of useful limits on the objective `limited`. It starts at the strictest limit that three of four fronts
/// can meet, and ends at the loosest limit that still constrains half of them. Beyond this end the answer is simply the
/// best design of the front.
fn overlap(limited: Objective, fronts: &[&[Design]]) -> (f64, f64) {
    let at_best_of = |o, front: &[Design]| best(o, front).map(|d| limited.minimized(d));
    let strictest = fronts.iter().filter_map(|f| at_best_of(limited, f)).collect();
    let loosest_of = |front: &&[Design]| {
        let others = Objective::ALL.into_iter().filter(|o| *o != limited && asked(limited, *o));
        others.filter_map(|o| at_best_of(o, front)).max_by(f64::total_cmp)
    };
    let strict = quantile(strictest, 0.75);
    let loose = quantile(fronts.iter().filter_map(loosest_of).collect(), 0.5).max(strict);
    if limited == Objective::Mode { (-strict, -loose) } else { (strict, loose) }
}

/// Whether some question optimizes `sought` under a limit on `limited`.
fn asked(limited: Objective, sought: Objective) -> bool {
    Question::ALL.into_iter().any(|q| q.limited() == limited && q.sought() == sought)
}

/// The smallest value v of `values` such that at least the fraction `share` of the values is at most v; NaN without
/// values.
fn quantile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let index = (share * values.len() as f64).ceil() as usize;
    values.get(index.saturating_sub(1)).copied().unwrap_or(f64::NAN)
}

/// At most `count` round numbers from `low` to `high`, spread over the range and as coarse as possible. If the
/// range has no round number, the nearest number of two digits that most fronts can meet.
fn round_between(low: f64, high: f64, count: usize, limited: Objective) -> Vec<f64> {
    const STOPS: [&[u32]; 4] = [
        &[10, 20, 50],
        &[10, 15, 20, 30, 40, 50, 60, 80],
        &[10, 12, 14, 16, 18, 20, 25, 30, 35, 40, 45, 50, 55, 60, 65, 70, 75, 80, 85, 90, 95],
        &[],
    ];
    if !(low > 0.0 && high.is_finite()) {
        return Vec::new();
    }
    let mut found = Vec::new();
    for stops in STOPS {
        let finest: Vec<u32> = (10..100).collect();
        found = stops_between(low, high, if stops.is_empty() { &finest } else { stops });
        if found.len() >= count {
            break;
        }
    }
    if found.is_empty() {
        return vec![nearest_round(low, high, limited)];
    }
    spread(&found, low, high, count)
}

/// All numbers `stop * 10^n` in a range, in ascending order.
fn stops_between(low: f64, high: f64, stops: &[u32]) -> Vec<f64> {
    let (from, to) = (libm::log10(low).floor() as i32 - 1, libm::log10(high).ceil() as i32);
    (from..=to)
        .flat_map(|power| stops.iter().map(move |s| times_power_of_ten(f64::from(*s), power - 1)))
        .filter(|v| (low..=high).contains(v))
        .collect()
}

/// The numbers among `found`, which are in ascending order, that are nearest to `count` points spread evenly from `low`
/// to `high` on a logarithmic scale.
fn spread(found: &[f64], low: f64, high: f64, count: usize) -> Vec<f64> {
    let place = |i: usize| low * libm::pow(high / low, (i as f64 + 0.5) / count as f64);
    let mut out: Vec<f64> = (0..count)
        .filter_map(|i| {
            let off = |v: &f64| libm::log(v / place(i)).abs();
            found.iter().copied().min_by(|a, b| off(a).total_cmp(&off(b)))
        })
        .collect();
    out.dedup();
    out
}

/// The nearest number with two significant digits that most fronts can meet as a limit. For a lower limit (lowest mode)
/// it is `low` rounded down, for an upper limit `high` rounded up.
fn nearest_round(low: f64, high: f64, limited: Objective) -> f64 {
    let (value, up) = if limited == Objective::Mode { (low, false) } else { (high, true) };
    let power = libm::log10(value).floor() as i32 - 1;
    let digits = value / 10f64.powi(power);
    times_power_of_ten(if up { digits.ceil() } else { digits.floor() }, power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_round_and_spread_over_the_range() {
        assert_eq!(round_between(0.8, 22.0, 3, Objective::Deflection), [1.0, 5.0, 10.0]);
        assert_eq!(round_between(31.0, 88.0, 3, Objective::Mass), [40.0, 50.0, 80.0]);
        assert_eq!(round_between(31.2, 31.9, 3, Objective::Mass), [32.0]);
        assert_eq!(round_between(7.11, 7.19, 3, Objective::Mode), [7.1]);
        assert!(round_between(f64::NAN, 1.0, 3, Objective::Mass).is_empty());
    }

    #[test]
    fn three_of_four_fronts_keep_the_strictest_limit() {
        assert_eq!(quantile(vec![4.0, 1.0, 3.0, 2.0], 0.75), 3.0);
        assert_eq!(quantile(vec![5.0], 0.75), 5.0);
    }
}
