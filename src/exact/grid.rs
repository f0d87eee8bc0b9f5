//! A few designs that represent many: one for each cell of a logarithmic grid over the objectives.

use crate::pareto::front::exact_front;
use crate::pareto::objectives::Objectives;
use std::collections::BTreeMap;

/// Thins designs to the best design of each cell of a logarithmic grid of width `step` over their `objectives`. The
/// best design of a cell has the least sum of the logarithms of mass, deflection and reciprocal mode. A cell is dropped
/// if another cell with a design dominates it. For every design that is dropped, a design is kept that is worse by at
/// most one `step` in the logarithm of each objective. With `step <= 0` all designs are kept.
pub(super) fn thinned<T>(all: Vec<T>, step: f64, objectives: impl Fn(&T) -> &Objectives) -> Vec<T> {
    if step <= 0.0 {
        return all;
    }
    let mut cells: BTreeMap<[i64; 3], (f64, T)> = BTreeMap::new();
    for one in all {
        let o = objectives(&one);
        let at = [o.mass_kg, o.tip_deflection_m.max(1e-12), 1.0 / o.lowest_mode_hz].map(libm::log);
        let (cell, merit) = (at.map(|x| (x / step).floor() as i64), at.iter().sum());
        if cells.get(&cell).is_none_or(|(best, _)| merit < *best) {
            cells.insert(cell, (merit, one));
        }
    }
    let points: Vec<[f64; 3]> = cells.keys().map(|cell| cell.map(|i| i as f64)).collect();
    let mut kept = vec![false; points.len()];
    // The cells are finite numbers, so there is no error.
    exact_front(&points).unwrap_or_default().into_iter().for_each(|i| kept[i] = true);
    cells.into_values().zip(kept).filter_map(|((_, one), kept)| kept.then_some(one)).collect()
}

#[cfg(test)]
#[path = "grid_tests.rs"]
mod tests;
