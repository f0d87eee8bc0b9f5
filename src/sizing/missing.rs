//! The parts of a drive table that cannot be checked, with the ratings that they lack.

use super::select::DriveTable;
use crate::catalog::envelope::Envelope;
use crate::catalog::lookup::first_names;
use crate::catalog::motor::Motor;
use crate::catalog::needs::{Lack, words};

/// Largest number of groups of parts that a message names.
const GROUPS_NAMED: usize = 4;
/// Largest number of parts of one group that a message names.
const NAMED_OF_GROUP: usize = 3;

/// A part that lacks ratings.
struct LackingPart<'t> {
    id: &'t str,
    is_built_in: bool,
    /// Whether the sizes of the part that are known are within the study's limits.
    fits: bool,
    lacks: Vec<Lack>,
}

impl DriveTable<'_> {
    /// The parts that cannot be checked and the ratings that they lack, in words. Parts of the user's own catalogs come
    /// first. Built-in parts whose known sizes do not fit are left out if others fit. `None` if every part has all its
    /// ratings.
    ///
    /// `PLE-60-40, PLE-60-50: no rated_life_h (life), no efficiency_rated_2000rpm (motor torque)`
    pub fn missing_figures(&self) -> Option<String> {
        let mut groups: Vec<(String, Vec<&str>)> = Vec::new();
        for part in self.lacking_parts() {
            let lacks = words(&part.lacks);
            match groups.iter_mut().find(|(other, _)| *other == lacks) {
                Some((_, names)) => names.push(part.id),
                None => groups.push((lacks, vec![part.id])),
            }
        }
        let named = groups
            .iter()
            .take(GROUPS_NAMED)
            .map(|(lacks, names)| format!("{}: {lacks}", first_names(names, NAMED_OF_GROUP)));
        let more: usize = groups.iter().skip(GROUPS_NAMED).map(|(_, names)| names.len()).sum();
        let more = (more > 0).then(|| format!("and {more} more parts"));
        (!groups.is_empty()).then(|| named.chain(more).collect::<Vec<_>>().join("; "))
    }

    /// The parts that cannot be checked because they lack ratings, parts of the user's own catalogs first. Built-in
    /// parts whose known sizes do not fit are left out if other parts fit.
    fn lacking_parts(&self) -> Vec<LackingPart<'_>> {
        let fit = &self.motion().fit;
        let no_size = Envelope::default();
        let gears = self.gears().iter().map(|g| LackingPart {
            id: &g.id,
            is_built_in: g.provenance.is_built_in(),
            fits: fit.allows(&g.envelope_as(self.gear_mass()), &no_size),
            lacks: g.lacks(self.gear_mass()),
        });
        // a motor that goes with none of the allowed gears does not matter; if only actuators may be chosen, this is
        // every other motor
        let matters = |m: &&&Motor| self.gears().iter().any(|gear| gear.goes_with(m));
        let motors = self.motors().iter().filter(matters).map(|m| LackingPart {
            id: &m.id,
            is_built_in: m.provenance.is_built_in(),
            fits: fit.allows(&no_size, &m.envelope),
            lacks: m.lacks(),
        });
        let mut lacking: Vec<LackingPart> = Vec::new();
        for part in gears.chain(motors).filter(|part| !part.lacks.is_empty()) {
            // an actuator is listed both as a gear and as a motor, under the same name
            match lacking.iter_mut().find(|other| other.id == part.id) {
                Some(other) => other.lacks.extend(part.lacks),
                None => lacking.push(part),
            }
        }
        // a part that does not fit cannot be chosen, whatever its other ratings are
        if lacking.iter().any(|part| part.fits) {
            lacking.retain(|part| part.fits || !part.is_built_in);
        }
        lacking.sort_by_key(|part| (part.is_built_in, !part.fits));
        lacking
    }

    /// The parts that cannot be checked and the ratings that they lack, in words, for messages that also name the
    /// nearest drive. `None` if only built-in motors lack ratings.
    pub fn also_missing_figures(&self) -> Option<String> {
        let gears = self.gears().iter().any(|gear| !gear.lacks(self.gear_mass()).is_empty());
        let own = self.motors().iter().any(|m| !m.provenance.is_built_in() && !m.lacks().is_empty());
        (gears || own).then(|| self.missing_figures())?
    }
}
