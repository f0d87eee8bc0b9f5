//! The parts of a table that cannot be checked, with the figures they lack.

use super::select::DriveTable;
use crate::catalog::needs::{Lack, words};

/// Number of parts that a message names.
const NAMED: usize = 4;

impl DriveTable<'_> {
    /// What the parts lack that cannot be checked, in words; `None` if every part has all its figures.
    ///
    /// `PLE-60-40: no rated_life_h (life), no efficiency_rated_2000rpm (motor torque)`
    pub fn missing_figures(&self) -> Option<String> {
        let gears = self.gears().iter().map(|gear| (&gear.id, gear.lacks(self.gear_mass())));
        let motors = self.motors().iter().map(|motor| (&motor.id, motor.lacks()));
        let mut lacking: Vec<(&String, Vec<Lack>)> = Vec::new();
        for (id, lacks) in gears.chain(motors).filter(|(_, lacks)| !lacks.is_empty()) {
            // an actuator is a gear and a motor of one name
            match lacking.iter_mut().find(|(other, _)| *other == id) {
                Some((_, all)) => all.extend(lacks),
                None => lacking.push((id, lacks)),
            }
        }
        let named: Vec<String> =
            lacking.iter().take(NAMED).map(|(id, lacks)| format!("{id}: {}", words(lacks))).collect();
        let more = match lacking.len().saturating_sub(NAMED) {
            0 => String::new(),
            more => format!("; and {more} more parts"),
        };
        (!named.is_empty()).then(|| format!("{}{more}", named.join("; ")))
    }
}
