//! The parts of a drive table that cannot be checked, with the ratings that they lack.

use super::select::DriveTable;
use crate::catalog::needs::{Lack, words};

/// Number of parts that a message names.
const NAMED: usize = 4;

impl DriveTable<'_> {
    /// In words, the parts that cannot be checked and the ratings that they lack. Parts of the user's own catalogs
    /// come first. `None` if every part has all its ratings.
    ///
    /// `PLE-60-40: no rated_life_h (life), no efficiency_rated_2000rpm (motor torque)`
    pub fn missing_figures(&self) -> Option<String> {
        let gears = self.gears().iter().map(|g| (&g.id, &g.provenance, g.lacks(self.gear_mass())));
        let motors = self.motors().iter().map(|m| (&m.id, &m.provenance, m.lacks()));
        let mut lacking: Vec<(&String, bool, Vec<Lack>)> = Vec::new();
        for (id, from, lacks) in gears.chain(motors).filter(|(.., lacks)| !lacks.is_empty()) {
            // an actuator is listed both as a gear and as a motor, under the same name
            match lacking.iter_mut().find(|(other, ..)| *other == id) {
                Some((.., all)) => all.extend(lacks),
                None => lacking.push((id, from.is_built_in(), lacks)),
            }
        }
        lacking.sort_by_key(|(_, is_built_in, _)| *is_built_in);
        let named: Vec<String> =
            lacking.iter().take(NAMED).map(|(id, _, lacks)| format!("{id}: {}", words(lacks))).collect();
        let more = match lacking.len().saturating_sub(NAMED) {
            0 => String::new(),
            more => format!("; and {more} more parts"),
        };
        (!named.is_empty()).then(|| format!("{}{more}", named.join("; ")))
    }

    /// In words, the parts that cannot be checked and the ratings that they lack, for messages that also name the
    /// nearest drive. `None` if only built-in motors lack ratings.
    pub fn also_missing_figures(&self) -> Option<String> {
        let gears = self.gears().iter().any(|gear| !gear.lacks(self.gear_mass()).is_empty());
        let own = self.motors().iter().any(|m| !m.provenance.is_built_in() && !m.lacks().is_empty());
        (gears || own).then(|| self.missing_figures())?
    }
}
