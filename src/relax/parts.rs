//! The remaining options of each slot (piece of the arm), tip first.

use super::row::Row;
use crate::space::problem::ArmProblem;
use crate::space::slot::Slot;

/// Remaining options of every slot, and the masses of all options.
pub(super) struct Parts {
    /// For each slot, the indices of the options that remain, in ascending order.
    pub alive: Vec<Vec<u32>>,
    /// For each slot, the option of the known design.
    pub known: Vec<u32>,
    mass_kg: Vec<Vec<f64>>,
    /// Slots that have the same option as a drive: each spring of a sized gear's bearing, and each motor that stands
    /// away from its joint. Each is listed with the slot of the joint to which it belongs.
    bearings: Vec<(usize, usize)>,
}

impl Parts {
    /// Starts with all options of every slot that can be part of a design.
    pub(super) fn new(problem: &ArmProblem, known: &[u32]) -> Self {
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
        let bearing = |(slot, piece): (usize, &Slot)| match piece {
            Slot::Bearing { joint, .. } | Slot::Motor { joint, .. } => Some((slot, *joint)),
            _ => None,
        };
        let bearings = problem.slots().iter().enumerate().filter_map(bearing).collect();
        Self { alive, known: known.to_vec(), mass_kg, bearings }
    }

    /// Drops the options of every bearing, and of every motor that stands elsewhere, that their drive no longer has.
    /// Bearing and motor come with the drive, so they have the same options.
    pub(super) fn follow_drives(&mut self) {
        for &(bearing, joint) in &self.bearings {
            self.alive[bearing] = self.alive[joint].clone();
        }
    }

    /// The inequality `row`, rewritten for a program in which a drive and its bearings have the same weights. The
    /// coefficients of each bearing are added to the coefficients of its drive and then set to zero.
    /// [`Self::follow_drives`] must have been called before.
    pub(super) fn with_drives(&self, mut row: Row) -> Row {
        for &(bearing, joint) in &self.bearings {
            for at in 0..self.alive[joint].len() {
                let of_bearing = std::mem::take(&mut row.coefficients[bearing][at]);
                row.coefficients[joint][at] += of_bearing;
            }
        }
        row
    }

    /// The weights of all options in a mixture. A bearing gets the weights of the drive to which it belongs.
    pub(super) fn with_bearings(&self, weights: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let mut out = weights.to_vec();
        for &(bearing, joint) in &self.bearings {
            out[bearing] = weights[joint].clone();
        }
        out
    }

    /// Mass of an option of a slot \[kg\].
    pub(super) fn mass_kg(&self, slot: usize, option: u32) -> f64 {
        self.mass_kg[slot][option as usize]
    }

    /// Masses of the remaining options, slot by slot \[kg\].
    pub(super) fn masses(&self) -> Vec<Vec<f64>> {
        self.each(|slot, option| self.mass_kg(slot, option))
    }

    /// Computes `number(slot, option)` for each remaining option, slot by slot.
    pub(super) fn each(&self, number: impl Fn(usize, u32) -> f64) -> Vec<Vec<f64>> {
        let slots = self.alive.iter().enumerate();
        slots.map(|(slot, alive)| alive.iter().map(|&o| number(slot, o)).collect()).collect()
    }

    /// Drops the options that cannot satisfy the inequality `row`, even if every other slot takes the option with the
    /// least coefficient. Returns whether any option was dropped.
    pub(super) fn drop_by(&mut self, row: &Row) -> bool {
        let least = row.least();
        let total: f64 = least.iter().sum();
        let mut dropped = false;
        for (slot, coefficients) in row.coefficients.iter().enumerate() {
            if coefficients.len() != self.alive[slot].len() {
                // An earlier row has dropped options of this slot, so the coefficients no longer match the options. The
                // next round builds this row again.
                continue;
            }
            let room = row.limit - (total - least[slot]) + 1e-12 * row.limit.abs();
            dropped |= self.keep(slot, |at, _| coefficients[at] <= room);
        }
        dropped
    }

    /// Keeps the options of a slot for which `passes` is true, and always the option of the known design. `passes` gets
    /// the index of an option among the remaining options and its index among all options. Returns whether any option
    /// was dropped. A bearing loses options only together with its drive.
    pub(super) fn keep(&mut self, slot: usize, passes: impl Fn(usize, u32) -> bool) -> bool {
        if self.bearings.iter().any(|(bearing, _)| *bearing == slot) {
            return false;
        }
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

/// The mass of each option of a slot \[kg\].
pub(super) fn slot_masses(slot: &Slot) -> Vec<f64> {
    match slot {
        Slot::Given { mass_kg, .. } | Slot::Offset { mass_kg } => vec![*mass_kg],
        Slot::Sized(sized) => (0..sized.table.len()).map(|i| sized.table.mass_kg(i)).collect(),
        Slot::Link { options, .. } => options.iter().map(|o| o.mass_kg).collect(),
        Slot::Bearing { laws, .. } => vec![0.0; laws.len()],
        Slot::Motor { masses_kg, .. } => masses_kg.clone(),
    }
}
