//! The options that each piece may still have, tip first.

use super::row::Row;
use crate::space::problem::ArmProblem;
use crate::space::slot::Slot;

/// Options and masses of every slot.
pub(super) struct Parts {
    /// Options, ascending, that are left of each slot.
    pub alive: Vec<Vec<u32>>,
    /// The known design's option of each slot.
    pub known: Vec<u32>,
    mass_kg: Vec<Vec<f64>>,
}

impl Parts {
    /// Every option of every slot.
    pub fn new(problem: &ArmProblem, known: &[u32]) -> Self {
        let mass_kg: Vec<Vec<f64>> = problem.slots().iter().map(slot_masses).collect();
        let alive = problem
            .slots()
            .iter()
            .zip(&mass_kg)
            .map(|(slot, masses)| {
                let whole = 0..masses.len() as u32;
                match slot {
                    Slot::Link { options, .. } => whole.filter(|&o| !options[o as usize].slender).collect(),
                    Slot::Sized(sized) if !sized.all_fits => sized.table.first_fit_candidates().to_vec(),
                    _ => whole.collect(),
                }
            })
            .collect();
        Self { alive, known: known.to_vec(), mass_kg }
    }

    /// Mass of an option \[kg\].
    pub fn mass_kg(&self, slot: usize, option: u32) -> f64 {
        self.mass_kg[slot][option as usize]
    }

    /// Masses of what is left.
    pub fn masses(&self) -> Vec<Vec<f64>> {
        self.each(|slot, option| self.mass_kg(slot, option))
    }

    /// A number for every option that is left.
    pub fn each(&self, number: impl Fn(usize, u32) -> f64) -> Vec<Vec<f64>> {
        let slots = self.alive.iter().enumerate();
        slots.map(|(slot, alive)| alive.iter().map(|&o| number(slot, o)).collect()).collect()
    }

    /// Drops options with which a row exceeds its limit whatever the others are. Says whether any went.
    pub fn drop_by(&mut self, row: &Row) -> bool {
        let least = row.least();
        let total: f64 = least.iter().sum();
        let mut dropped = false;
        for (slot, coefficients) in row.coefficients.iter().enumerate() {
            if coefficients.len() != self.alive[slot].len() {
                // an earlier row has dropped options here: the next round sees this one again
                continue;
            }
            let room = row.limit - (total - least[slot]) + 1e-12 * row.limit.abs();
            dropped |= self.keep(slot, |at, _| coefficients[at] <= room);
        }
        dropped
    }

    /// Keeps the options of a slot that pass, given their place and number, and the known one always.
    /// Says whether any went.
    pub fn keep(&mut self, slot: usize, passes: impl Fn(usize, u32) -> bool) -> bool {
        let known = self.known[slot];
        let before = self.alive[slot].len();
        let mut at = 0;
        self.alive[slot].retain(|&option| {
            at += 1;
            option == known || passes(at - 1, option)
        });
        self.alive[slot].len() < before
    }
}

fn slot_masses(slot: &Slot) -> Vec<f64> {
    match slot {
        Slot::Given { mass_kg, .. } | Slot::Offset { mass_kg } => vec![*mass_kg],
        Slot::Sized(sized) => (0..sized.table.len()).map(|i| sized.table.mass_kg(i)).collect(),
        Slot::Link { options, .. } => options.iter().map(|o| o.mass_kg).collect(),
    }
}
