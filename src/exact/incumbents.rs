//! The incumbents are the designs found so far. This module tells whether one of them dominates the bound of a box.
//!
//! A table ([`Archive`]) finds incumbents that are better than a bound by at least one grid cell in both mass and
//! deflection. An incumbent may also share a cell with the bound in one of these two objectives. Such an incumbent is
//! found in a list: there is one list for each row and one for each column of cells.

use super::bound::BoxBound;
use crate::pareto::archive::Archive;
use crate::pareto::objectives::{Objective, Objectives};
use std::collections::HashMap;

/// Two values of an objective that differ by less than this (relative) count as equal.
const EQUAL_WITHIN: f64 = 1e-9;
/// A design dominates another only if it is better by at least this fraction in one objective, so that rounding cannot
/// decide.
pub(super) const BETTER_BY: f64 = 1e-7;
/// Number of grid steps in a factor of two of mass or deflection.
const STEPS: f64 = 64.0;

/// Designs that meet every constraint.
pub(super) struct Incumbents {
    table: Archive,
    /// The incumbents, in one list for each grid step of mass. The key is the number of the step on a logarithmic
    /// scale.
    rows: HashMap<i32, Vec<Objectives>>,
    /// The incumbents, in one list for each grid step of deflection. The key is the number of the step on a logarithmic
    /// scale.
    columns: HashMap<i32, Vec<Objectives>>,
    /// All incumbents in the order in which they were added.
    all: Vec<Objectives>,
    /// If a single objective counts: this objective, and its least cost among the designs entered so far. `None` if all
    /// three count.
    only: Option<(Objective, f64)>,
}

impl Default for Incumbents {
    fn default() -> Self {
        Self {
            table: Archive::new(6),
            rows: HashMap::new(),
            columns: HashMap::new(),
            all: Vec::new(),
            only: None,
        }
    }
}

impl Incumbents {
    /// An empty set of incumbents. If `only` is given, that objective alone counts, and a design dominates every design
    /// that is no better in it.
    pub(super) fn toward(only: Option<Objective>) -> Self {
        Self { only: only.map(|objective| (objective, f64::INFINITY)), ..Self::default() }
    }

    /// Adds a design that meets every constraint.
    pub(super) fn enter(&mut self, found: &Objectives) {
        if let Some((objective, least)) = &mut self.only {
            *least = least.min(objective.cost(found));
        }
        self.table.enter(found);
        self.all.push(*found);
        let keys = [step(found.mass_kg), step(found.tip_deflection_m)];
        for (lists, key) in [&mut self.rows, &mut self.columns].into_iter().zip(keys) {
            let list = lists.entry(key).or_default();
            let is_beaten = |by: &Objectives, o: &Objectives| {
                by.mass_kg <= o.mass_kg
                    && by.tip_deflection_m <= o.tip_deflection_m
                    && by.lowest_mode_hz >= o.lowest_mode_hz
            };
            // Dominated designs are removed from the lists, so that the lists stay short.
            if !list.iter().any(|o| is_beaten(o, found)) {
                list.retain(|o| !is_beaten(found, o));
                list.push(*found);
            }
        }
    }

    /// All designs, in the order in which they were added.
    pub(super) fn all(&self) -> &[Objectives] {
        &self.all
    }

    /// Whether an incumbent dominates every member of a box with the bound `box_bound`.
    pub(super) fn dominates(&self, box_bound: &BoxBound) -> bool {
        let best = Objectives::from(*box_bound);
        if let Some((objective, least)) = self.only {
            return objective.cost(&best) >= least * (1.0 - BETTER_BY);
        }
        if self.table.rejects(&best) {
            return true;
        }
        let in_list = |list: Option<&Vec<Objectives>>| {
            list.is_some_and(|list| list.iter().any(|o| is_better(o, &best)))
        };
        in_list(self.rows.get(&step(best.mass_kg))) || in_list(self.columns.get(&step(best.tip_deflection_m)))
    }

    /// Whether an incumbent might dominate the bound of a box after its trial shape (the motion that bounds the lowest
    /// mode) is improved. Only then is a better shape worth its time.
    pub(super) fn nearly_dominates(&self, box_bound: &BoxBound) -> bool {
        self.dominates(&box_bound.with_better_shape())
    }
}

/// The number of the grid step in which a positive number lies, on a logarithmic scale with [`STEPS`] steps in a factor
/// of two.
fn step(x: f64) -> i32 {
    (libm::log2(x.max(f64::MIN_POSITIVE)) * STEPS).floor() as i32
}

/// Whether `a` dominates `b`: better in at least one objective, and worse in none by more than rounding.
pub(super) fn is_better(a: &Objectives, b: &Objectives) -> bool {
    let pairs = [
        (a.mass_kg, b.mass_kg),
        (a.tip_deflection_m, b.tip_deflection_m),
        (b.lowest_mode_hz, a.lowest_mode_hz),
    ];
    pairs.iter().all(|(a, b)| *a <= b * (1.0 + EQUAL_WITHIN))
        && pairs.iter().any(|(a, b)| *a < b * (1.0 - BETTER_BY))
}
