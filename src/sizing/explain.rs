//! Explanations: why a part was rejected, and how far torque or speed must be reduced if no drive meets the demand.

use super::bearing_checks::bearing_that_holds;
use super::check::{Check, CheckKind, CheckState, digits_of};
use super::checks::{binding, checks, gear_checks, motor_checks, torsion_checks};
use super::demand::{JointDemand, JointMotion};
use super::drive::Drive;
use super::limits::DriveLimits;
use super::select::DriveTable;
use crate::catalog::gear::{Gear, GearKind};
use crate::catalog::motor::MotorKind;
use std::fmt;

/// The part that a rejection is about.
#[derive(Debug, Clone, PartialEq)]
pub enum RejectedPart {
    /// A gear that fails a check whatever the motor.
    Gear {
        /// Name of the gear.
        gear: String,
    },
    /// An actuator, which is checked as a whole: its gear goes with its own motor only.
    Actuator {
        /// Name of the actuator.
        actuator: String,
    },
    /// A gear that passes its own checks, but that has no motor which passes too. The listed checks were made with the
    /// nearest motor: the motor whose smallest margin is the largest.
    GearWithoutMotor {
        /// Name of the gear.
        gear: String,
        /// Name of the nearest motor, whose smallest margin is the largest.
        nearest_motor: String,
    },
    /// A motor that fails with some of the gears that pass their own checks. The listed checks were made with the
    /// nearest gear: the gear with which the smallest margin of the motor is the largest.
    Motor {
        /// Name of the motor.
        motor: String,
        /// Name of the nearest gear, with which the listed checks were made.
        nearest_gear: String,
        /// Names of all gears that pass their own checks, but with which this motor fails a check.
        rejected_with: Vec<String>,
        /// Names of all gears with which this motor passes every check.
        fits_with: Vec<String>,
    },
}

/// Why a part was rejected at one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Rejection {
    /// Name of the joint.
    pub joint: String,
    /// The part that was rejected.
    pub part: RejectedPart,
    /// Every check that excludes the part, at least one. The smallest margin comes first; checks that could not be
    /// made come last.
    pub checks: Vec<Check>,
    /// Further catalog columns that the part leaves blank, which no check names. Empty if every check was made.
    pub also_lacks: Vec<&'static str>,
}

impl Rejection {
    /// Whether the part exceeds no limit and is excluded only because ratings are blank.
    pub fn is_not_checked(&self) -> bool {
        self.checks.iter().all(|c| matches!(c.state, CheckState::NotChecked(_)))
    }

    /// The ratings that are blank, each once and with its checks, then the further blank columns:
    /// `no inertia_output_kgm2 (peak and rms), no mass_kg`.
    fn lacking(&self) -> String {
        let mut ratings: Vec<(&str, Vec<&str>)> = Vec::new();
        for check in &self.checks {
            let CheckState::NotChecked(rating) = check.state else { continue };
            // a row of actuators.csv has gear and motor in one, so a rating of the motor is a column of the same row
            let column = rating.0.strip_prefix("motor ").unwrap_or(rating.0);
            match ratings.iter_mut().find(|(other, _)| *other == column) {
                Some((_, checks)) => checks.push(check.kind.name()),
                None => ratings.push((column, vec![check.kind.name()])),
            }
        }
        let rating = |(column, checks): &(&str, Vec<&str>)| format!("no {column} ({})", checks.join(" and "));
        let further = self.also_lacks.iter().map(|column| format!("no {column}"));
        ratings.iter().map(rating).chain(further).collect::<Vec<_>>().join(", ")
    }
}

impl fmt::Display for Rejection {
    /// A message such as `joint j2: HFUC-40-100 peak 568 N m needed, 523 allowed`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "joint {}: ", self.joint)?;
        match &self.part {
            RejectedPart::Actuator { actuator } if self.is_not_checked() => {
                return write!(f, "{actuator} cannot be checked: {}", self.lacking());
            }
            RejectedPart::Gear { gear: name } | RejectedPart::Actuator { actuator: name } => {
                write!(f, "{name} ")?
            }
            RejectedPart::GearWithoutMotor { gear, nearest_motor } => {
                write!(f, "{gear} finds no motor, nearest {nearest_motor}: ")?
            }
            RejectedPart::Motor { motor, nearest_gear, .. } => write!(f, "{motor} behind {nearest_gear} ")?,
        }
        let reasons: Vec<_> = self.checks.iter().map(Check::to_string).collect();
        f.write_str(&reasons.join("; "))?;
        if !self.also_lacks.is_empty() {
            write!(f, "; also lacks {}", self.also_lacks.join(", "))?;
        }
        if let RejectedPart::Motor { rejected_with, fits_with, .. } = &self.part {
            let gears = rejected_with.len() + fits_with.len();
            write!(f, " (rejected with {} of {gears} gears that hold)", rejected_with.len())?;
        }
        Ok(())
    }
}

/// Which quantity a [`Relaxation`] reduces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RelaxationKind {
    /// Every torque on the joint. It falls with less payload, outboard mass or reach.
    Torque,
    /// Speed and acceleration, with the same ramp time.
    Speed,
}

/// A reduction of torque or speed with which at least one drive meets the demand.
#[derive(Debug, Clone, PartialEq)]
pub struct Relaxation {
    /// Which quantity is reduced.
    pub kind: RelaxationKind,
    /// Factor on torque or speed, below 1 and a whole number of percent.
    pub factor: f64,
    /// Whether the study states torques of the joint in a duty. No lighter arm reduces these.
    pub has_duty: bool,
    /// Whether the joint slides, so that it has a force in place of a torque.
    pub slides: bool,
    /// Name of the lightest drive that meets the reduced demand.
    pub drive: String,
}

impl Relaxation {
    /// The factor on the payload that reduces the torque as much as this relaxation does. `payload_share` is the
    /// fraction of the torque that comes from the payload. `None` if speed is reduced, or if even an arm without
    /// payload would not meet the limits.
    pub fn payload_factor(&self, payload_share: f64) -> Option<f64> {
        let factor = 1.0 - (1.0 - self.factor) / payload_share;
        (self.kind == RelaxationKind::Torque && factor >= 0.0).then_some(factor)
    }
}

impl fmt::Display for Relaxation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = self.factor * 100.0;
        match self.kind {
            RelaxationKind::Torque => {
                let of_duty = if self.has_duty { ", and the torques of its duty" } else { "" };
                match self.slides {
                    true => write!(f, "force on the rail (payload, outboard mass) down to {percent:.0} %")?,
                    false => write!(
                        f,
                        "torque on the joint (payload, outboard mass, reach{of_duty}) down to {percent:.0} %"
                    )?,
                }
            }
            RelaxationKind::Speed => {
                write!(f, "speed, acceleration and emergency deceleration down to {percent:.0} %")?
            }
        }
        write!(f, ", then {} holds", self.drive)
    }
}

/// The shortfall at a joint for which no drive meets the demand: the nearest drive, the check that it fails, and the
/// reductions that would help.
#[derive(Debug, Clone, PartialEq)]
pub struct Shortfall {
    /// Name of the joint.
    pub joint: String,
    /// Name of the nearest drive: the drive whose smallest margin is the largest.
    pub drive: String,
    /// The check of this drive that has the smallest margin.
    pub check: Check,
    /// All checks that this drive fails.
    pub failed: Vec<Check>,
    /// Reductions of torque or speed that help, the smallest reduction first. Empty if neither helps alone.
    pub relaxations: Vec<Relaxation>,
}

impl fmt::Display for Shortfall {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "joint {}: no drive holds; nearest {}: {}", self.joint, self.drive, self.check)?;
        // a difference of safety factors says nothing
        let is_factor = matches!(self.check.kind, CheckKind::BearingRest | CheckKind::BearingStop);
        if let Some(missing) = self.check.shortfall().filter(|_| !is_factor) {
            let (digits, unit) = (digits_of(missing), self.check.unit());
            write!(f, " (short by {missing:.digits$} {unit})")?;
        }
        let steps: Vec<_> = self.relaxations.iter().map(Relaxation::to_string).collect();
        match steps.is_empty() {
            true if self.check.kind.is_fit() => {
                f.write_str("; give it more room (\"fit\" of the study or of the joint), or widen \"drives\"")
            }
            true => f.write_str("; neither less torque nor less speed alone lets one hold"),
            false => write!(f, "; smallest relaxation that helps: {}", steps.join("; or ")),
        }?;
        match bearing_that_holds(&self.failed) {
            Some(bearing) => write!(f, "; or {bearing}"),
            None => Ok(()),
        }
    }
}

/// A gear that passes its own checks, combined with a motor, and the checks that this motor fails. `worst_margin` is
/// the smallest torque margin of the motor's checks.
struct Trial<'c> {
    drive: Drive<'c>,
    worst_margin: f64,
    failed: Vec<Check>,
}

impl<'c> DriveTable<'c> {
    /// Why parts were rejected for `demand`. The list has every gear and every actuator that fails by itself. It also
    /// has every gear that passes but has no motor that passes with it, and every motor that fails with some gear that
    /// passes. Gears come first; gears and motors are each in the order of the catalog.
    pub fn explain(&self, demand: &JointDemand) -> Vec<Rejection> {
        let (mut rejections, trials) = (Vec::new(), self.trials(demand));
        for gear in self.gears() {
            let failed = not_holding(self.checks_of_gear(gear, demand));
            let mut with_gear = trials.iter().filter(|t| t.drive.gear.id == gear.id);
            if gear.kind == GearKind::Actuator {
                let of_motor = with_gear.next().map_or(Vec::new(), |trial| trial.failed.clone());
                let failed = if failed.is_empty() { of_motor } else { failed };
                let part = RejectedPart::Actuator { actuator: gear.id.clone() };
                rejections.extend((!failed.is_empty()).then(|| self.rejection(part, failed)));
            } else if failed.is_empty() {
                rejections.extend(self.gear_without_motor(with_gear));
            } else {
                rejections.push(self.rejection(RejectedPart::Gear { gear: gear.id.clone() }, failed));
            }
        }
        // the motor of an actuator was reported with its gear
        for motor in self.motors().iter().filter(|motor| motor.kind != MotorKind::OfActuator) {
            rejections.extend(self.rejected_motor(trials.iter().filter(|t| t.drive.motor.id == motor.id)));
        }
        rejections
    }

    /// The nearest drive if no drive meets the demand, with its worst check and the reductions that would help.
    /// `None` if a drive meets the demand, or if no drive has all ratings that the checks need.
    pub fn smallest_shortfall(&self, demand: &JointDemand) -> Option<Shortfall> {
        if self.first_fit(demand).is_some() {
            return None;
        }
        let (drive, checks) = self.nearest(demand)?;
        let check = *binding(&checks)?;
        let mut relaxations: Vec<_> = [RelaxationKind::Torque, RelaxationKind::Speed]
            .into_iter()
            .filter_map(|kind| self.relaxation(kind, demand))
            .collect();
        relaxations.sort_by(|a, b| b.factor.total_cmp(&a.factor));
        let (joint, failed) = (self.joint().to_string(), not_holding(checks));
        Some(Shortfall { joint, drive: drive.name(), check, failed, relaxations })
    }

    /// The checks of a gear, and its blank torsion ratings if the deflection of the joint is to be computed.
    fn checks_of_gear(&self, gear: &Gear, demand: &JointDemand) -> Vec<Check> {
        let mut checks =
            gear_checks(gear, self.gear_mass(), self.bearing_of(gear).as_ref(), self.motion(), demand);
        if !self.knows_torsion(gear) {
            checks.extend(torsion_checks(gear));
        }
        checks
    }

    /// The smallest margin of the nearest drive, as a factor on torque, for a demand that no drive meets. The nearest
    /// drive is the drive whose smallest margin is the largest. 0 if no drive could be checked.
    pub(crate) fn nearest_margin(&self, demand: &JointDemand) -> f64 {
        self.nearest(demand).and_then(|(_, checks)| binding(&checks)?.torque_margin()).unwrap_or(0.0)
    }

    /// Every gear that passes its own checks, combined with every motor that goes with it.
    fn trials(&self, demand: &JointDemand) -> Vec<Trial<'c>> {
        let mut trials = Vec::new();
        for gear in self.gears() {
            if !not_holding(self.checks_of_gear(gear, demand)).is_empty() {
                continue;
            }
            for motor in self.motors().iter().filter(|motor| gear.goes_with(motor)) {
                let drive = self.pair(gear, motor);
                let checks = motor_checks(&drive, self.motion(), demand);
                // a motor for which no check could be made counts as the worst
                let worst_margin = binding(&checks).and_then(Check::torque_margin).unwrap_or(0.0);
                trials.push(Trial { drive, worst_margin, failed: not_holding(checks) });
            }
        }
        trials
    }

    fn gear_without_motor<'t>(&self, trials: impl Iterator<Item = &'t Trial<'c>> + Clone) -> Option<Rejection>
    where
        'c: 't,
    {
        if trials.clone().any(|t| t.failed.is_empty()) {
            return None;
        }
        let nearest = nearest_trial(trials)?;
        let part = RejectedPart::GearWithoutMotor {
            gear: nearest.drive.gear.id.clone(),
            nearest_motor: nearest.drive.motor.id.clone(),
        };
        Some(self.rejection(part, nearest.failed.clone()))
    }

    fn rejected_motor<'t>(&self, trials: impl Iterator<Item = &'t Trial<'c>>) -> Option<Rejection>
    where
        'c: 't,
    {
        let (fits, rejected): (Vec<_>, Vec<_>) = trials.partition(|t| t.failed.is_empty());
        let nearest = nearest_trial(rejected.iter().copied())?;
        let gears = |trials: &[&Trial]| trials.iter().map(|t| t.drive.gear.id.clone()).collect();
        let part = RejectedPart::Motor {
            motor: nearest.drive.motor.id.clone(),
            nearest_gear: nearest.drive.gear.id.clone(),
            rejected_with: gears(&rejected),
            fits_with: gears(&fits),
        };
        Some(self.rejection(part, nearest.failed.clone()))
    }

    fn rejection(&self, part: RejectedPart, checks: Vec<Check>) -> Rejection {
        let also_lacks = self.also_lacks(&part, &checks);
        Rejection { joint: self.joint().to_string(), part, checks, also_lacks }
    }

    /// The columns that a rejected part leaves blank, except the columns that `checks` name already. Empty if every
    /// check was made. A check names only the first rating that it lacks.
    fn also_lacks(&self, part: &RejectedPart, checks: &[Check]) -> Vec<&'static str> {
        let named: Vec<&str> = checks
            .iter()
            .filter_map(|check| match &check.state {
                CheckState::NotChecked(rating) => Some(rating.0),
                _ => None,
            })
            .collect();
        if named.is_empty() {
            return Vec::new();
        }
        let of_gear = |id: &String| self.gears().iter().find(|gear| gear.id == *id);
        let of_motor = |id: &String| self.motors().iter().find(|motor| motor.id == *id);
        let lacks = match part {
            RejectedPart::Gear { gear } => of_gear(gear).map(|gear| gear.lacks(self.gear_mass())),
            RejectedPart::Actuator { actuator } => {
                of_gear(actuator).zip(of_motor(actuator)).map(|(gear, motor)| {
                    let of_gear = gear.lacks(self.gear_mass());
                    let known = |figure: &str| of_gear.iter().any(|lack| lack.figure == figure);
                    let of_motor: Vec<_> =
                        motor.lacks().into_iter().filter(|lack| !known(lack.figure)).collect();
                    of_gear.iter().copied().chain(of_motor).collect()
                })
            }
            RejectedPart::GearWithoutMotor { nearest_motor: motor, .. }
            | RejectedPart::Motor { motor, .. } => of_motor(motor).map(|motor| motor.lacks()),
        };
        let figures = lacks.unwrap_or_default().into_iter().map(|lack| lack.figure);
        figures.filter(|figure| !named.iter().any(|name| name.ends_with(figure))).collect()
    }

    /// The nearest drive and its checks. It is the drive whose smallest margin is the largest, among the drives for which
    /// every check could be made. `None` if there is no such drive.
    fn nearest(&self, demand: &JointDemand) -> Option<(Drive<'c>, Vec<Check>)> {
        let mut best: Option<(f64, Drive<'c>, Vec<Check>)> = None;
        for drive in self.all_drives().filter(|drive| self.knows_torsion(drive.gear)) {
            let checks = checks(&drive, self.motion(), demand);
            if checks.iter().any(|c| !c.holds() && matches!(c.state, CheckState::NotChecked(_))) {
                continue;
            }
            let Some(worst) = binding(&checks) else { continue };
            let margin = worst.torque_margin().unwrap_or(0.0);
            if best.as_ref().is_none_or(|(most, ..)| margin > *most) {
                best = Some((margin, drive, checks));
            }
        }
        best.map(|(_, drive, checks)| (drive, checks))
    }

    /// The largest factor below 1, in whole percents, such that some drive meets `demand` with its torque or its speed
    /// (`kind`) multiplied by the factor. `None` if not even 1 % suffices.
    fn relaxation(&self, kind: RelaxationKind, demand: &JointDemand) -> Option<Relaxation> {
        (1..100).rev().find_map(|percent| {
            let factor = f64::from(percent) / 100.0;
            let drive = match kind {
                RelaxationKind::Torque => self.relieved(factor, demand),
                RelaxationKind::Speed => {
                    let (motion, slower) = self.slowed(factor, demand);
                    self.lightest(&motion, &slower)
                }
            }?;
            let (has_duty, slides) = (demand.stated_peak_nm > 0.0, drive.gear.kind.slides());
            Some(Relaxation { kind, factor, has_duty, slides, drive: drive.name() })
        })
    }

    /// The lightest drive that meets `demand` if every torque is multiplied by `factor`; `None` if no drive does. The
    /// torques of a duty that the study states are part of the motion, so that the limits of the drives change with them.
    fn relieved(&self, factor: f64, demand: &JointDemand) -> Option<Drive<'c>> {
        let relieved = demand.scaled(factor);
        match self.motion().stated {
            None => self.first_fit(&relieved).map(|i| self.drive(i)),
            Some(_) => self.lightest(&self.motion().with_torques_times(factor), &relieved),
        }
    }

    /// The motion of the joint, and `demand`, if speed and acceleration are multiplied by `factor`.
    fn slowed(&self, factor: f64, demand: &JointDemand) -> (JointMotion, JointDemand) {
        let motion = self.motion().slowed(factor);
        let slower = motion
            .demand_of_torques(demand.static_torque_nm, demand.linear_torque_nm * factor)
            .with_bearing(demand.bearing.slowed(factor))
            .with_room(demand.room);
        (motion, slower)
    }

    /// The lightest drive that meets `demand` if the joint moves as `motion` says. All pairs of gear and motor are
    /// tried, not only the pairs of the table: a pair that was excluded as too fast may pass at a lower speed. `None` if
    /// no pair passes.
    fn lightest(&self, motion: &JointMotion, demand: &JointDemand) -> Option<Drive<'c>> {
        let known = self.all_drives().filter(|drive| self.knows_torsion(drive.gear));
        let holding = known.filter_map(|drive| {
            let limits = DriveLimits::of(&drive, motion).ok()?;
            let mass_kg = drive.mass_with_extras_kg().ok()?;
            limits.hold(demand).then_some((mass_kg, drive))
        });
        holding.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, drive)| drive)
    }
}

/// The pair of gear and motor whose smallest margin is the largest. Of pairs with equal margins, the pair with the
/// fewest failed checks is taken, then the first pair. `None` if there are no trials.
fn nearest_trial<'t, 'c: 't>(trials: impl Iterator<Item = &'t Trial<'c>>) -> Option<&'t Trial<'c>> {
    let nearness = |t: &Trial| (t.worst_margin, std::cmp::Reverse(t.failed.len()));
    trials.reduce(|best, t| if nearness(t) > nearness(best) { t } else { best })
}

/// The checks in `checks` that exclude a part. The smallest margin comes first; checks that could not be made come
/// last.
pub(super) fn not_holding(checks: Vec<Check>) -> Vec<Check> {
    let mut failed: Vec<_> = checks.into_iter().filter(|c| !c.holds()).collect();
    let key = |c: &Check| c.torque_margin().unwrap_or(f64::INFINITY);
    failed.sort_by(|a, b| key(a).total_cmp(&key(b)));
    failed
}

#[cfg(test)]
#[path = "explain_tests.rs"]
mod tests;
