//! The designs found so far, and whether one of them beats a box.
//!
//! A table ([`Archive`]) answers for designs that are better by a cell in mass and deflection; a list a
//! row and a list a column of cells hold the designs that share one of them.

use super::bound::BoxBound;
use crate::pareto::archive::Archive;
use crate::pareto::objectives::Objectives;
use std::collections::HashMap;

/// What two objectives may differ by and still count as equal.
const EQUAL: f64 = 1e-9;
/// By how much the better design must be better in one objective.
const BETTER: f64 = 1e-7;
/// How much a better trial shape may lower a ceiling's frequency.
const NEAR: f64 = 0.4;
/// Steps an octave of the lists.
const STEPS: f64 = 64.0;

/// Designs that meet every constraint.
pub(super) struct Incumbents {
    table: Archive,
    rows: HashMap<i32, Vec<Objectives>>,
    columns: HashMap<i32, Vec<Objectives>>,
    all: Vec<Objectives>,
}

impl Default for Incumbents {
    fn default() -> Self {
        Self { table: Archive::new(6), rows: HashMap::new(), columns: HashMap::new(), all: Vec::new() }
    }
}

impl Incumbents {
    /// Enters a design that meets every constraint.
    pub fn enter(&mut self, found: &Objectives) {
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
            if !list.iter().any(|o| is_beaten(o, found)) {
                list.retain(|o| !is_beaten(found, o));
                list.push(*found);
            }
        }
    }

    /// All designs, in the order in which they were entered.
    pub fn all(&self) -> &[Objectives] {
        &self.all
    }

    /// Whether some design found beats every member of a box.
    pub fn dominates(&self, box_bound: &BoxBound) -> bool {
        let best = Objectives::from(*box_bound);
        if self.table.rejects(&best) {
            return true;
        }
        let in_list = |list: Option<&Vec<Objectives>>| {
            list.is_some_and(|list| list.iter().any(|o| is_better(o, &best)))
        };
        in_list(self.rows.get(&step(best.mass_kg))) || in_list(self.columns.get(&step(best.tip_deflection_m)))
    }

    /// Whether some design found would beat the box if its ceiling were a little lower in frequency: then
    /// a better trial shape is worth its price.
    pub fn nearly_dominates(&self, box_bound: &BoxBound) -> bool {
        self.dominates(&BoxBound { hz: box_bound.hz * NEAR, ..*box_bound })
    }
}

/// The step of a positive number on a logarithmic scale.
fn step(x: f64) -> i32 {
    (x.max(f64::MIN_POSITIVE).log2() * STEPS).floor() as i32
}

/// Better in one objective, and not worse in any by more than rounding.
pub(super) fn is_better(a: &Objectives, b: &Objectives) -> bool {
    let pairs = [
        (a.mass_kg, b.mass_kg),
        (a.tip_deflection_m, b.tip_deflection_m),
        (b.lowest_mode_hz, a.lowest_mode_hz),
    ];
    pairs.iter().all(|(a, b)| *a <= b * (1.0 + EQUAL)) && pairs.iter().any(|(a, b)| *a < b * (1.0 - BETTER))
}
