//! A few designs that represent many: one for each cell of a logarithmic grid over the objectives.

use crate::pareto::front::exact_front;
use crate::pareto::objectives::Objectives;
use std::collections::BTreeMap;

/// The best design of each cell that no other occupied cell dominates. For every design that is dropped, one
/// is kept that is worse by at most one `step` in the logarithm of each objective. With `step <= 0` all are
/// kept.
pub(super) fn thinned<T>(all: Vec<T>, step: f64, objectives: impl Fn(&T) -> &Objectives) -> Vec<T> {
    if step <= 0.0 {
        return all;
    }
    let mut cells: BTreeMap<[i64; 3], (f64, T)> = BTreeMap::new();
    for one in all {
        let o = objectives(&one);
        let at = [o.mass_kg, o.tip_deflection_m.max(1e-12), 1.0 / o.lowest_mode_hz].map(f64::ln);
        let (cell, merit) = (at.map(|x| (x / step).floor() as i64), at.iter().sum());
        if cells.get(&cell).is_none_or(|(best, _)| merit < *best) {
            cells.insert(cell, (merit, one));
        }
    }
    let points: Vec<[f64; 3]> = cells.keys().map(|cell| cell.map(|i| i as f64)).collect();
    let mut kept = vec![false; points.len()];
    // The cells are finite numbers, so the front exists.
    exact_front(&points).unwrap_or_default().into_iter().for_each(|i| kept[i] = true);
    cells.into_values().zip(kept).filter_map(|((_, one), kept)| kept.then_some(one)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn designs() -> impl Strategy<Value = Vec<Objectives>> {
        let design = (1.0f64..3.0, 1.0f64..3.0, 1.0f64..3.0).prop_map(
            |(mass_kg, tip_deflection_m, lowest_mode_hz)| Objectives {
                tip_deflection_m,
                mass_kg,
                lowest_mode_hz,
            },
        );
        prop::collection::vec(design, 1..60)
    }

    proptest! {
        #[test]
        fn for_every_design_one_is_kept_that_is_no_worse_by_more_than_a_step(all in designs(), step in 0.02f64..0.6) {
            let kept = thinned(all.clone(), step, |o| o);
            let most = step.exp() * (1.0 + 1e-12);
            for o in &all {
                prop_assert!(kept.iter().any(|k| k.mass_kg <= o.mass_kg * most
                    && k.tip_deflection_m <= o.tip_deflection_m * most
                    && k.lowest_mode_hz * most >= o.lowest_mode_hz));
            }
            let cells = kept.iter().map(|o| [o.mass_kg, o.tip_deflection_m].map(|x| (x.ln() / step).floor() as i64));
            let columns: std::collections::BTreeSet<[i64; 2]> = cells.collect();
            prop_assert_eq!(columns.len(), kept.len(), "two in one column of cells");
        }
    }
}
