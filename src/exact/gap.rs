//! How near to every design of the study some found design is, after a search that was stopped.

use super::bound::BoxBound;
use crate::search::sweep::Candidate;
use rayon::prelude::*;

/// The least `ε` such that for every open box some design of the front, with mass and deflection divided by
/// `1 + ε` and mode multiplied by it, is no worse than the bound of the box. For every missed design some
/// design of the front is then worse by at most `ε` in each objective. `None` if a bound says nothing, or if
/// the front is empty.
pub(super) fn gap(open: &[BoxBound], front: &[Candidate]) -> Option<f64> {
    let of = |box_bound: &BoxBound| {
        let factor = |c: &Candidate| {
            let o = &c.objectives;
            (o.mass_kg / box_bound.mass_kg)
                .max(o.tip_deflection_m / box_bound.tip_m)
                .max(box_bound.hz / o.lowest_mode_hz)
        };
        front.iter().map(factor).fold(f64::INFINITY, f64::min)
    };
    let worst = open.par_iter().map(of).reduce(|| 1.0, f64::max);
    (worst.is_finite()).then_some(worst - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pareto::objectives::Objectives;

    #[test]
    fn the_gap_is_the_factor_to_the_nearest_design_of_the_front() {
        let at = |mass_kg: f64, tip_deflection_m: f64, lowest_mode_hz: f64| Candidate {
            number: 0,
            objectives: Objectives { tip_deflection_m, mass_kg, lowest_mode_hz },
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
