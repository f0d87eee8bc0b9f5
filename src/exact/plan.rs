//! The slack of the next pass.
//!
//! A search goes over the whole space several times, in passes with less and less slack. In a pass with slack `ε`, a
//! box of designs is also discarded if it promises little: some design found before comes within the factor `1 + ε` of
//! the box's bound in all three objectives. A completed pass therefore proves this: every design has a design found
//! that is worse than it by at most `ε`. The time of a pass grows as a power of the reciprocal of its slack, `t ∝
//! ε^-g`. The exponent `g` is measured on the last two completed passes.
//!
//! Without a time limit the slacks come from a fixed list and do not depend on the machine. With a time limit they
//! come from the same list as long as a pass is short compared with the time left. They also come from the list if the
//! gap that was asked for can be proved in time. Otherwise the last pass gets the least slack for which there should be
//! time.

use serde::{Deserialize, Serialize};

/// The list of slacks (relative), in descending order.
const SLACKS: [f64; 25] = [
    1.0, 0.7, 0.5, 0.42, 0.35, 0.3, 0.25, 0.2, 0.16, 0.12, 0.09, 0.075, 0.06, 0.05, 0.04, 0.035, 0.03, 0.025,
    0.02, 0.015, 0.01, 0.007, 0.005, 0.0035, 0.0025,
];
/// Slacks below this are used only in a search by regions. In a search by boxes, passes with such slacks find no
/// further designs.
const FINE_SLACK: f64 = 0.02;
/// Greatest number of slacks of the list that are skipped between two passes, if the search is to end with the whole
/// front (a gap of zero).
const MOST_PASSED_OVER: usize = 4;
/// Greatest number of slacks of the list that are skipped between two passes, if the search is to end at a gap above
/// zero.
const PASSED_OVER_TO_A_GAP: usize = 8;
/// Exponent `g` of the growth `t ∝ ε^-g` of a pass's time. This value is assumed until two passes are completed. An
/// exponent measured later is limited to the interval from `LEAST_GROWTH` to `MOST_GROWTH`.
const GROWTH_EXPONENT: f64 = 3.3;
const LEAST_GROWTH: f64 = 1.0;
const MOST_GROWTH: f64 = 4.5;
/// The last pass is planned to take at most this fraction of the time left. The rest is a margin for errors of the
/// prediction.
const LAST_PASS_SHARE: f64 = 0.75;
/// A pass that is expected to take at most this fraction of the time left counts as short and is made with the slack
/// of the list.
const SHORT_PASS_SHARE: f64 = 0.05;
/// Greatest factor by which one pass divides the slack. A larger step would be predicted from times measured at a much
/// larger slack. An additional pass in between takes only a small part of the time of the next pass.
const LONGEST_STEP: f64 = 3.0;
/// If no finer pass is predicted to fit in the time left, a pass with the slack times this factor is still tried,
/// because the prediction may be wrong.
const SHORTEST_STEP: f64 = 0.95;

/// A completed pass: its slack (relative) and the time that it took \[s\].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Pass {
    pub slack: f64,
    pub took_s: f64,
}

/// The slacks of the passes of a search.
pub(super) struct Plan {
    /// Slacks in descending order. The last slack is the gap that was asked for.
    slacks: Vec<f64>,
    /// Greatest number of slacks of the list that are skipped at once.
    most_passed_over: usize,
}

impl Plan {
    /// The plan of a search that needs no passes with additional slack: one pass with the gap that was asked for.
    pub(super) fn single(gap: f64) -> Self {
        Self { slacks: vec![gap], most_passed_over: 0 }
    }

    /// The plan of a search by boxes or by regions: the slacks of the list above the gap, and then the gap that was
    /// asked for.
    pub(super) fn new(gap: f64, by_regions: bool) -> Self {
        let coarser = SLACKS.into_iter().filter(|slack| *slack > gap && (by_regions || *slack >= FINE_SLACK));
        let most_passed_over = if gap > 0.0 { PASSED_OVER_TO_A_GAP } else { MOST_PASSED_OVER };
        Self { slacks: coarser.chain([gap]).collect(), most_passed_over }
    }

    /// The slack of the next pass. `done` are the completed passes. `left_s` is the time left \[s\], `None` without a
    /// time limit. The result is `None` once the gap that was asked for is proved.
    pub(super) fn next(&self, done: &[Pass], left_s: Option<f64>) -> Option<f64> {
        let Some(last) = done.last() else { return self.slacks.first().copied() };
        let listed = self.listed(last.slack)?;
        let Some(left_s) = left_s.filter(|_| listed > 0.0) else { return Some(listed) };
        let is_goal = self.slacks.last() == Some(&listed);
        let part = if is_goal { LAST_PASS_SHARE } else { SHORT_PASS_SHARE };
        if listed >= least_slack_within(done, part * left_s) {
            return Some(listed);
        }
        let finest = self.slacks.iter().copied().rfind(|slack| *slack > 0.0)?;
        Some(step_to(least_slack_within(done, LAST_PASS_SHARE * left_s).max(finest), last.slack).max(finest))
    }

    /// The next slack of the list after the slack `last`. Up to `most_passed_over` slacks are skipped, but a skip
    /// never leads to the pass without slack; this pass comes only after all other passes. `None` if `last` is the
    /// last slack of the list.
    fn listed(&self, last: f64) -> Option<f64> {
        let finer = self.slacks.iter().copied().filter(|slack| *slack < last);
        let mut ahead = finer.take(1 + self.most_passed_over);
        let next = ahead.next()?;
        Some(ahead.take_while(|slack| *slack > 0.0).last().unwrap_or(next))
    }
}

/// The slack of the next pass on the way from the slack `from` to the finer slack `slack`. The way is divided into as
/// few equal steps of the logarithm as possible, none longer than [`LONGEST_STEP`].
fn step_to(slack: f64, from: f64) -> f64 {
    let finer = from / slack;
    if finer * SHORTEST_STEP < 1.0 {
        return from * SHORTEST_STEP;
    }
    let steps = (libm::log(finer) / libm::log(LONGEST_STEP)).ceil().max(1.0);
    from * libm::pow(finer, -steps.recip())
}

/// The exponent `g` of the growth `t ∝ ε^-g` of a pass's time with its slack, measured between the last two passes.
fn growth(done: &[Pass]) -> f64 {
    let [.., before, last] = done else { return GROWTH_EXPONENT };
    let measured = libm::log(last.took_s / before.took_s) / libm::log(before.slack / last.slack);
    // Passes that took no measurable time give no finite exponent.
    if measured.is_finite() { measured.clamp(LEAST_GROWTH, MOST_GROWTH) } else { GROWTH_EXPONENT }
}

/// The least slack for which a pass is predicted to take at most `within_s` \[s\]. Infinite if no pass in `done` is
/// completed yet.
fn least_slack_within(done: &[Pass], within_s: f64) -> f64 {
    let Some(last) = done.last() else { return f64::INFINITY };
    last.slack * libm::pow(last.took_s / within_s, growth(done).recip())
}

#[cfg(test)]
#[path = "plan_tests.rs"]
mod tests;
