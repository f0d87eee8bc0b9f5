//! The gap of a search: how near to every design of the study some found design is while boxes are open.
//!
//! A box is a set of designs. It is open if it was neither discarded nor evaluated. Its bound has the best mass, tip
//! deflection and lowest mode that one of its designs could have.

use super::bound::BoxBound;
use crate::pareto::objectives::Objectives;
use rayon::prelude::*;

/// The gap of a search: the least `ε` such that every open box is near some design in `found`. Near means that the
/// design is worse than the bound of the box by at most the factor `1 + ε` in each of mass, deflection and mode. For
/// every design that was missed, some design in `found` is then worse by at most this factor, too. `None` if some box
/// has no bound yet, or if no design was found.
pub(super) fn gap(open: &[BoxBound], found: &[Objectives]) -> Option<f64> {
    let worst = open.par_iter().map(|bound| gap_of(bound, found)).reduce(|| 0.0, f64::max);
    worst.is_finite().then_some(worst)
}

/// The gap that one open box leaves (relative). It is the least `ε` for which some design in `found` is worse than
/// `bound` by at most the factor `1 + ε` in each objective. It is infinite if the box has no bound yet, or if no design
/// was found.
pub(super) fn gap_of(bound: &BoxBound, found: &[Objectives]) -> f64 {
    let factor = |o: &Objectives| {
        (o.mass_kg / bound.mass_kg).max(o.tip_deflection_m / bound.tip_m).max(bound.hz / o.lowest_mode_hz)
    };
    (found.iter().map(factor).fold(f64::INFINITY, f64::min) - 1.0).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gap_is_the_factor_to_the_nearest_design_of_the_front() {
        let at = |mass_kg: f64, tip_deflection_m: f64, lowest_mode_hz: f64| Objectives {
            tip_deflection_m,
            mass_kg,
            lowest_mode_hz,
        };
        let front = [at(10.0, 1e-3, 20.0), at(20.0, 5e-4, 30.0)];
        let box_bound = |mass_kg, tip_m, hz| BoxBound { mass_kg, tip_m, hz };
        let near = |a: Option<f64>, b: f64| assert!((a.unwrap() - b).abs() < 1e-12, "{a:?} {b}");
        near(gap(&[], &front), 0.0);
        near(gap(&[box_bound(10.0, 1e-3, 22.0)], &front), 0.1);
        near(gap(&[box_bound(16.0, 5e-4, 30.0), box_bound(10.0, 1e-3, 20.2)], &front), 0.25);
        assert_eq!(gap(&[BoxBound::OPEN], &front), None);
        assert_eq!(gap(&[box_bound(1.0, 1.0, 1.0)], &[]), None);
    }
}
