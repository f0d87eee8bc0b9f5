//! Advice on output bearings at one joint: how many gears fail because of their bearings, what helps, and which
//! bearings could not be checked.

use super::bearing_checks::{BlankRatings, RigidBearing, bearing_that_holds};
use super::check::Check;
use super::checks::gear_checks;
use super::demand::JointDemand;
use super::explain::not_holding;
use super::select::DriveTable;
use crate::arm::bearing::BearingSource;
use crate::catalog::gear::Gear;

/// A gear whose output bearing fails a check.
struct Overloaded<'t> {
    gear: &'t str,
    /// The failed check of this gear's bearing. If several checks fail, it is the check with the smallest margin.
    check: Check,
    /// All checks of gear and bearing that fail.
    failed: Vec<Check>,
    /// Whether the bearing is the only reason why the gear is rejected.
    is_alone: bool,
}

impl DriveTable<'_> {
    /// Sentences about the output bearings of this joint: how many gears they exclude and what helps, which ratings are
    /// blank, and which bearings are taken as rigid. Empty if every bearing passes its checks and all numbers are
    /// known.
    pub fn explain_bearings(&self, demand: &JointDemand) -> Vec<String> {
        let said = self.overloaded_bearings(demand).into_iter().chain(self.blank_bearings());
        said.chain(self.rigid_bearings()).collect()
    }

    /// The bearings whose tilting stiffness is blank, one line each. A stated bearing is the same with every gear and
    /// gets a single line.
    fn rigid_bearings(&self) -> Vec<String> {
        let rigid = |gear: &Gear| {
            let (whose, rigid) =
                (self.whose(gear), RigidBearing::of(self.bearing_source(), gear, self.gear_mass())?);
            Some(format!("joint {}: {}", self.joint(), rigid.words(&[whose])))
        };
        let mut lines: Vec<String> = self.gears().iter().filter_map(|gear| rigid(gear)).collect();
        lines.dedup();
        lines
    }

    /// Whose bearing the joint has if `gear` is its gear, for messages: the name of the gear, or "the stated bearing".
    fn whose<'g>(&self, gear: &'g Gear) -> &'g str {
        match self.bearing_source() {
            BearingSource::OfGear => &gear.id,
            BearingSource::Stated(_) => "the stated bearing",
        }
    }

    /// One sentence: how many gears are rejected because of their bearings, the gear with the largest margin among
    /// them, and what helps. `None` if no bearing fails.
    fn overloaded_bearings(&self, demand: &JointDemand) -> Option<String> {
        let overloaded: Vec<Overloaded> =
            self.gears().iter().filter_map(|gear| self.overloaded(gear, demand)).collect();
        let alone = overloaded.iter().filter(|o| o.is_alone).count();
        let nearness = |o: &&Overloaded| (o.is_alone, o.check.torque_margin().unwrap_or(0.0));
        let nearest = overloaded.iter().reduce(|a, b| if nearness(&b) > nearness(&a) { b } else { a })?;
        let own = bearing_that_holds(&nearest.failed).map_or(String::new(), |own| format!(", or {own}"));
        Some(format!(
            "joint {}: output bearings reject {} of {} gears, {alone} for no other reason; nearest {}: {}. What helps: less \
             mass, payload or reach outboard, slower ramps and stops of every joint, a link that attaches closer to the \
             bearing{own}",
            self.joint(),
            overloaded.len(),
            self.gears().len(),
            nearest.gear,
            nearest.check,
        ))
    }

    /// The failed check of the output bearing that the joint has with `gear`; `None` if the bearing passes. If several
    /// checks of the bearing fail, it is the check with the smallest margin.
    fn overloaded<'t>(&self, gear: &'t Gear, demand: &JointDemand) -> Option<Overloaded<'t>> {
        let bearing = self.bearing_of(gear);
        let checks = gear_checks(gear, self.gear_mass(), bearing.as_ref(), self.motion(), demand);
        let failed = not_holding(checks);
        let check = *failed.iter().find(|check| check.kind.is_bearing())?;
        let is_alone = failed.iter().all(|check| check.kind.is_bearing());
        Some(Overloaded { gear: &gear.id, check, failed, is_alone })
    }

    /// The bearings that cannot be checked in full, one line each. A bearing that the study states is the same with
    /// every gear and gets a single line.
    fn blank_bearings(&self) -> Vec<String> {
        let blank = |gear| BlankRatings::of(self.bearing_source(), gear, self.gear_mass());
        let line =
            |blank: BlankRatings, whose: &str| format!("joint {}: {}", self.joint(), blank.words(&[whose]));
        match self.bearing_source() {
            BearingSource::Stated(_) => {
                let first = self.gears().first().and_then(|gear| blank(gear));
                first.map(|blank| line(blank, "the stated bearing")).into_iter().collect()
            }
            BearingSource::OfGear => {
                let gears = self.gears().iter();
                gears.filter_map(|gear| Some(line(blank(gear)?, &gear.id))).collect()
            }
        }
    }
}
