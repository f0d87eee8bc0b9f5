//! Which slack the next pass gets.
//!
//! A search has passes with less and less slack. With slack a box is also pruned if an incumbent comes that close to its
//! bound, so a completed pass proves that every design has a found one that close. The time of a pass grows as a power of
//! the reciprocal of its slack, `t ∝ ε^-g`. The exponent is measured: it is that between the last two passes done.
//!
//! Without a time limit the slacks are those of a list and do not depend on the machine. With a time limit they are the
//! same as long as passes are short beside the time left, and if the gap that was asked for can be proved in time.
//! Otherwise the plan is to make its last pass with the least slack for which there should be time.

use serde::{Deserialize, Serialize};

/// The slacks of the list.
const SLACKS: [f64; 25] = [
    1.0, 0.7, 0.5, 0.42, 0.35, 0.3, 0.25, 0.2, 0.16, 0.12, 0.09, 0.075, 0.06, 0.05, 0.04, 0.035, 0.03, 0.025,
    0.02, 0.015, 0.01, 0.007, 0.005, 0.0035, 0.0025,
];
/// Slacks below this are used only in searches by regions. A search by boxes finds as much without such passes.
const FINE: f64 = 0.02;
/// At most this many slacks of the list are skipped at once.
const MOST_PASSED_OVER: usize = 4;
/// The same with a target gap.
const PASSED_OVER_TO_A_GAP: usize = 8;
/// The exponent of the growth before two passes are done, and the limits of what a measurement may say.
const GROWTH: f64 = 3.3;
const LEAST_GROWTH: f64 = 1.0;
const MOST_GROWTH: f64 = 4.5;
/// The last pass should take at most this part of the time left.
const SAFE: f64 = 0.75;
/// A pass that should take at most this part of the time left is short.
const SHORT: f64 = 0.05;
/// The most by which one pass divides the slack. A longer step would rest on a measurement from too far away; an additional
/// pass takes a small part of the time of the next.
const LONGEST_STEP: f64 = 3.0;
/// If there should be no time for any finer pass, the slack is still multiplied by this: the prediction may be wrong.
const SHORTEST_STEP: f64 = 0.95;

/// A completed pass.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Pass {
    pub slack: f64,
    pub took_s: f64,
}

/// The slacks of a search.
pub(super) struct Plan {
    /// Descending; the last is the gap that was asked for.
    slacks: Vec<f64>,
    most_passed_over: usize,
}

impl Plan {
    /// The only pass of a search that needs none with slack.
    pub(super) fn single(gap: f64) -> Self {
        Self { slacks: vec![gap], most_passed_over: 0 }
    }

    /// The passes of a search by boxes or by regions to a gap.
    pub(super) fn new(gap: f64, by_regions: bool) -> Self {
        let coarser = SLACKS.into_iter().filter(|slack| *slack > gap && (by_regions || *slack >= FINE));
        let most_passed_over = if gap > 0.0 { PASSED_OVER_TO_A_GAP } else { MOST_PASSED_OVER };
        Self { slacks: coarser.chain([gap]).collect(), most_passed_over }
    }

    /// The slack of the next pass. `left_s` is the time that is left \[s\]; `None` without a time limit. `None` once the
    /// gap that was asked for is proved.
    pub(super) fn next(&self, done: &[Pass], left_s: Option<f64>) -> Option<f64> {
        let Some(last) = done.last() else { return self.slacks.first().copied() };
        let listed = self.listed(last.slack)?;
        let Some(left_s) = left_s.filter(|_| listed > 0.0) else { return Some(listed) };
        let is_goal = self.slacks.last() == Some(&listed);
        let part = if is_goal { SAFE } else { SHORT };
        if listed >= least_slack_within(done, part * left_s) {
            return Some(listed);
        }
        let finest = self.slacks.iter().copied().rfind(|slack| *slack > 0.0)?;
        Some(step_to(least_slack_within(done, SAFE * left_s).max(finest), last.slack).max(finest))
    }

    /// The next slack of the list, after those that are skipped. The pass without slack is never skipped to; it comes
    /// last in any case.
    fn listed(&self, last: f64) -> Option<f64> {
        let finer = self.slacks.iter().copied().filter(|slack| *slack < last);
        let mut ahead = finer.take(1 + self.most_passed_over);
        let next = ahead.next()?;
        Some(ahead.take_while(|slack| *slack > 0.0).last().unwrap_or(next))
    }
}

/// The first of as few equal steps as possible from a slack to a finer one, in the logarithm.
fn step_to(slack: f64, from: f64) -> f64 {
    let finer = from / slack;
    if finer * SHORTEST_STEP < 1.0 {
        return from * SHORTEST_STEP;
    }
    let steps = (libm::log(finer) / libm::log(LONGEST_STEP)).ceil().max(1.0);
    from * libm::pow(finer, -steps.recip())
}

/// The exponent `g` of the growth `t ∝ ε^-g`, measured between the last two passes.
fn growth(done: &[Pass]) -> f64 {
    let [.., before, last] = done else { return GROWTH };
    let measured = libm::log(last.took_s / before.took_s) / libm::log(before.slack / last.slack);
    // The times of passes that took no time measure nothing.
    if measured.is_finite() { measured.clamp(LEAST_GROWTH, MOST_GROWTH) } else { GROWTH }
}

/// The least slack of a pass that should be done within a time \[s\].
fn least_slack_within(done: &[Pass], within_s: f64) -> f64 {
    let Some(last) = done.last() else { return f64::INFINITY };
    last.slack * libm::pow(last.took_s / within_s, growth(done).recip())
}

#[cfg(test)]
#[path = "plan_tests.rs"]
mod tests;
