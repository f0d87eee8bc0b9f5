//! The front by comparing all pairs.

use super::design::Design;

/// How much better or worse than computed a deflection or a mode may be.
pub const SLACK: f64 = 1e-6;
/// The same for masses, which both compute exactly.
const MASS_SLACK_KG: f64 = 1e-9;
/// Relative differences that are rounding.
const TIE: f64 = 1e-12;

/// Where a design stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Not dominated, even if it were worse by the slack.
    On,
    /// Dominated, even if it were better by the slack.
    Off,
    /// Which of the two depends on the last millionth.
    Close,
}

/// The place of every design among all.
pub fn places(designs: &[&Design]) -> Vec<Place> {
    let place = |a: &&Design| {
        let others = || designs.iter().filter(|b| !std::ptr::eq(**b, *a));
        if others().any(|b| dominates(b, a, -SLACK)) {
            Place::Off
        } else if others().any(|b| dominates(b, a, SLACK)) {
            Place::Close
        } else {
            Place::On
        }
    };
    designs.iter().map(place).collect()
}

/// Whether two designs are equal in all three but for rounding.
pub fn are_tied(a: &Design, b: &Design) -> bool {
    let is_same = |x: f64, y: f64| (x / y - 1.0).abs() < TIE;
    is_same(a.tip_deflection_mm, b.tip_deflection_mm)
        && is_same(a.mass_kg, b.mass_kg)
        && is_same(a.lowest_mode_hz, b.lowest_mode_hz)
}

/// The designs that no other dominates, by the numbers as they are.
pub fn exact_front_size(designs: &[&Design]) -> usize {
    let is_dominated = |a: &Design| {
        let is_better = |b: &Design| {
            b.tip_deflection_mm < a.tip_deflection_mm
                || b.mass_kg < a.mass_kg
                || b.lowest_mode_hz > a.lowest_mode_hz
        };
        designs.iter().any(|b| dominates(b, a, 0.0) && is_better(b))
    };
    designs.iter().filter(|a| !is_dominated(a)).count()
}

/// Whether b is no worse than a in all three, when a's deflection and mode are worse than computed by `slack`.
fn dominates(b: &Design, a: &Design, slack: f64) -> bool {
    b.tip_deflection_mm <= a.tip_deflection_mm * (1.0 + slack)
        && b.mass_kg <= a.mass_kg + MASS_SLACK_KG * slack.signum()
        && b.lowest_mode_hz >= a.lowest_mode_hz * (1.0 - slack)
}
