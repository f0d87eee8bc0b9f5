//! The outcome of one check of a drive: needed and allowed value, margin, and whether the check could be made at all.

use super::drive::{MissingRating, Rating};
use std::fmt;

/// The limits of a drive that are checked: limits of its gear, of its output bearing and of its motor, and limits on
/// their sizes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum CheckKind {
    /// Static plus linear torque is at most the gear's limit for repeated peaks.
    GearPeak,
    /// The cubic mean of the torque is at most the gear's limit for average torque.
    GearMean,
    /// Torque in an emergency stop is at most the gear's limit for momentary peaks.
    GearStop,
    /// Torque in an emergency stop is at most the torque at which the flexspline buckles.
    GearBuckling,
    /// Torque in an emergency stop is at most the torque at which the teeth jump (ratcheting).
    GearRatcheting,
    /// The largest moment across the axis while the joint turns is at most the moment that the output bearing permits.
    BearingMoment,
    /// Static safety of the output bearing at rest is at least the required one.
    BearingRest,
    /// Static safety of the output bearing in an emergency stop is at least the required one.
    BearingStop,
    /// L10 life of the output bearing is at least the required life.
    BearingLife,
    /// Ratio N times the largest speed of the joint is at most the gear's largest input speed.
    GearSpeed,
    /// Ratio N times the mean speed of the joint is at most the gear's limit for average input speed.
    GearMeanSpeed,
    /// L10 life of the gear (of a strain-wave gear: of its wave-generator bearing) is at least the required life.
    GearLife,
    /// The gear withstands the number of emergency stops that the study asks for. This check is listed only if the
    /// study states a number.
    GearStops,
    /// The motor can hold the static torque continuously.
    MotorHold,
    /// The motor can give static, linear and rotary torque for the duration of the ramp.
    MotorPeak,
    /// Root mean square of the motor's torque over the cycle is at most its continuous torque.
    MotorRms,
    /// Ratio N times the largest speed of the joint is at most the motor's largest speed.
    MotorSpeed,
    /// The outer diameter of the gear is at most a stated multiple of the width of the link that the joint carries.
    /// Checks of size are listed only if the study asks for them.
    GearWidth,
    /// The motor is narrow enough for the hollow of the link that the joint carries.
    MotorWidth,
    /// A motor in the hollow of the link that the joint carries is no longer than this link.
    MotorLength,
    /// The bore of the gear is wide enough for the cables.
    GearBore,
    /// The bore of a motor that is mounted behind the gear is wide enough for the cables.
    MotorBore,
    /// The drive is no longer than the space that the study states for this joint.
    DriveLength,
    /// The torsion curve of the gear is known. This check is listed only if it is not.
    Torsion,
    /// The mass of the drive is known. This check is listed only if it is not.
    Mass,
}

impl CheckKind {
    /// Name of the check in messages. The name of the part precedes it.
    pub fn name(self) -> &'static str {
        match self {
            CheckKind::GearPeak | CheckKind::MotorPeak => "peak",
            CheckKind::GearMean => "mean",
            CheckKind::GearStop => "stop",
            CheckKind::BearingMoment => "bearing moment",
            CheckKind::BearingRest => "bearing safety at rest",
            CheckKind::BearingStop => "bearing safety in a stop",
            CheckKind::BearingLife => "bearing life",
            CheckKind::GearSpeed => "input speed",
            CheckKind::GearMeanSpeed => "mean input speed",
            CheckKind::GearLife => "life",
            CheckKind::GearBuckling => "buckling",
            CheckKind::GearRatcheting => "ratcheting",
            CheckKind::GearStops => "number of stops",
            CheckKind::MotorHold => "hold",
            CheckKind::MotorRms => "rms",
            CheckKind::MotorSpeed => "speed",
            CheckKind::GearWidth | CheckKind::MotorWidth => "width",
            CheckKind::GearBore | CheckKind::MotorBore => "bore",
            CheckKind::MotorLength => "length",
            CheckKind::DriveLength => "length of the drive",
            CheckKind::Torsion => "torsion",
            CheckKind::Mass => "mass",
        }
    }

    /// Name of the check together with the kind of part, for tables.
    pub fn label(self) -> &'static str {
        match self {
            CheckKind::GearPeak => "gear peak",
            CheckKind::GearMean => "gear mean",
            CheckKind::GearStop => "gear stop",
            CheckKind::BearingMoment => "bearing moment",
            CheckKind::BearingRest => "bearing rest",
            CheckKind::BearingStop => "bearing stop",
            CheckKind::BearingLife => "bearing life",
            CheckKind::GearSpeed => "gear speed",
            CheckKind::GearMeanSpeed => "gear av.speed",
            CheckKind::GearLife => "gear life",
            CheckKind::MotorHold => "motor hold",
            CheckKind::GearBuckling => "gear buckling",
            CheckKind::GearRatcheting => "gear ratchet",
            CheckKind::GearStops => "gear stops",
            CheckKind::MotorPeak => "motor peak",
            CheckKind::MotorRms => "motor rms",
            CheckKind::MotorSpeed => "motor speed",
            CheckKind::GearWidth => "gear width",
            CheckKind::MotorWidth => "motor width",
            CheckKind::MotorLength => "motor length",
            CheckKind::GearBore => "gear bore",
            CheckKind::MotorBore => "motor bore",
            CheckKind::DriveLength => "drive length",
            CheckKind::Torsion => "gear torsion",
            CheckKind::Mass => "mass",
        }
    }

    /// Unit of the needed and the allowed value.
    pub fn unit(self) -> &'static str {
        match self {
            CheckKind::GearSpeed | CheckKind::GearMeanSpeed | CheckKind::MotorSpeed => "rpm",
            CheckKind::GearLife | CheckKind::BearingLife => "h",
            CheckKind::BearingRest | CheckKind::BearingStop => "times",
            CheckKind::GearStops => "stops",
            CheckKind::Torsion => "N m/rad",
            CheckKind::Mass => "kg",
            fit if fit.is_fit() => "mm",
            _ => "N m",
        }
    }

    /// Exponent p of the torque in this check: its margin is proportional to torque^-p. It is 1 except for lives. A
    /// gear whose catalog row states another life exponent overrides it in [`Check::torque_exponent`].
    pub fn torque_exponent(self) -> f64 {
        match self {
            CheckKind::GearLife => 3.0,
            CheckKind::BearingLife => 10.0 / 3.0,
            _ => 1.0,
        }
    }

    /// Whether the check is about the output bearing of the joint.
    pub fn is_bearing(self) -> bool {
        use CheckKind::{BearingLife, BearingMoment, BearingRest, BearingStop};
        matches!(self, BearingMoment | BearingRest | BearingStop | BearingLife)
    }

    /// Whether the check compares sizes of parts, so that no torque changes its result.
    pub fn is_fit(self) -> bool {
        use CheckKind::{DriveLength, GearBore, GearWidth, MotorBore, MotorLength, MotorWidth};
        matches!(self, GearWidth | MotorWidth | MotorLength | GearBore | MotorBore | DriveLength)
    }

    /// Whether a drive is excluded if the rating that this check needs is blank. Blank ratings of an output bearing and
    /// blank sizes do not exclude it; they are left unchecked. Blank buckling and ratcheting torques do not exclude it
    /// either, because few vendors state them and both lie above the momentary peak torque, which must be known. The
    /// number of stops is left unchecked for kinds of gears that have no rule for it.
    pub fn needs_its_rating(self) -> bool {
        !self.is_bearing()
            && !self.is_fit()
            && !matches!(self, CheckKind::GearBuckling | CheckKind::GearRatcheting | CheckKind::GearStops)
    }

    /// Whether the check is about gear and bearing alone, so that its result is the same with every motor.
    pub fn is_gear(self) -> bool {
        use CheckKind::{
            DriveLength, Mass, MotorBore, MotorHold, MotorLength, MotorPeak, MotorRms, MotorSpeed, MotorWidth,
        };
        !matches!(
            self,
            MotorHold
                | MotorPeak
                | MotorRms
                | MotorSpeed
                | MotorWidth
                | MotorLength
                | MotorBore
                | DriveLength
                | Mass
        )
    }
}

/// Factor on a largest speed that allows for rounding. Studies and catalogs state speeds in different units. A joint that
/// is exactly as fast as its part allows could else fail in the last digit of the conversion.
pub(crate) const WITH_ROUNDING: f64 = 1.0 + 1e-12;

/// Outcome of a check.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CheckState {
    /// The limit is met.
    Holds,
    /// The limit is exceeded.
    Fails,
    /// A rating that the check needs is blank.
    NotChecked(MissingRating),
}

/// The comparison of one limit of a part with one demand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Check {
    /// The limit that is checked.
    pub kind: CheckKind,
    /// The needed value in [`CheckKind::unit`]; `None` if it cannot be computed.
    pub needed: Option<f64>,
    /// The value that the part allows (or, for life, that it reaches); `None` if it is unknown.
    pub allowed: Option<f64>,
    /// Result of the check.
    pub state: CheckState,
    /// Exponent p of the torque: the margin is proportional to torque^-p. It is 1 for most checks, and for lives the
    /// exponent of the life formula.
    pub torque_exponent: f64,
    /// Whether the joint slides. The check then compares forces along the travel \[N\] in the place of torques.
    pub slides: bool,
}

impl Check {
    /// Unit of the needed and of the allowed value.
    pub fn unit(&self) -> &'static str {
        match self.kind.unit() {
            "N m" if self.slides && self.kind.is_gear() => "N",
            "N m/rad" if self.slides => "N/m",
            unit => unit,
        }
    }

    /// A check of the kind `kind` that could not be made because `rating` is blank.
    pub(super) fn not_made(kind: CheckKind, rating: MissingRating) -> Self {
        let torque_exponent = kind.torque_exponent();
        Self {
            kind,
            needed: None,
            allowed: None,
            state: CheckState::NotChecked(rating),
            torque_exponent,
            slides: false,
        }
    }

    /// Allowed value divided by needed value; below 1 the check fails. Infinite if nothing is needed, `None` if the
    /// check could not be made.
    pub fn margin(&self) -> Option<f64> {
        match (self.needed?, self.allowed?) {
            (0.0, _) => Some(f64::INFINITY),
            (needed, allowed) => Some(allowed / needed),
        }
    }

    /// Margin of the check as a factor on the torque, which makes different checks comparable. A life is proportional
    /// to a power of the torque (cube for a strain-wave gear, 10/3 for a bearing), so the root of its margin is taken.
    /// The number of stops does not depend on the torque; its margin is returned as it is. A size that fits does so at
    /// any torque, so its margin is infinite. `None` if the check could not be made.
    pub fn torque_margin(&self) -> Option<f64> {
        let margin = self.margin()?;
        Some(match self.kind {
            CheckKind::GearLife if self.torque_exponent == 3.0 => libm::cbrt(margin),
            CheckKind::GearLife => libm::pow(margin, 1.0 / self.torque_exponent),
            CheckKind::BearingLife => libm::pow(margin, 0.3),
            fit if fit.is_fit() && self.state == CheckState::Holds => f64::INFINITY,
            _ => margin,
        })
    }

    /// Needed minus allowed value, in [`CheckKind::unit`]; positive if the check fails, `None` if one of the two is
    /// unknown.
    pub fn shortfall(&self) -> Option<f64> {
        Some(self.needed? - self.allowed?)
    }

    /// Whether the check lets the drive pass: its limit is met, or it could not be made and
    /// [`CheckKind::needs_its_rating`] is false.
    pub fn holds(&self) -> bool {
        match self.state {
            CheckState::Holds => true,
            CheckState::Fails => false,
            CheckState::NotChecked(_) => !self.kind.needs_its_rating(),
        }
    }
}

impl fmt::Display for Check {
    /// A message such as `peak 568 N m needed, 523 allowed` or `peak not checked: lacks peak_torque_nm`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.kind.name();
        match (self.state, self.needed, self.allowed) {
            (CheckState::NotChecked(rating), _, _) => write!(f, "{name} not checked: lacks {rating}"),
            (_, Some(needed), Some(allowed)) => {
                let digits = digits_that_differ(needed, allowed);
                let unit = self.unit();
                match self.kind {
                    CheckKind::BearingRest | CheckKind::BearingStop => {
                        write!(f, "{name} {needed:.digits$} needed, {allowed:.digits$} reached")
                    }
                    CheckKind::BearingLife => {
                        write!(f, "{name} {needed:.digits$} {unit} needed, {allowed:.digits$} reached")
                    }
                    _ => write!(f, "{name} {needed:.digits$} {unit} needed, {allowed:.digits$} allowed"),
                }
            }
            _ => write!(f, "{name}"),
        }
    }
}

/// Number of decimals that print `x` with about three significant digits.
pub(super) fn digits_of(x: f64) -> usize {
    match x.abs() {
        x if x >= 100.0 => 0,
        x if x >= 10.0 => 1,
        x if x >= 1.0 => 2,
        _ => 3,
    }
}

/// Number of decimals that print the larger of `a` and `b` with about three significant digits. If the two numbers
/// would then look the same, it is the smallest number of decimals with which they differ.
fn digits_that_differ(a: f64, b: f64) -> usize {
    let least = digits_of(a.abs().max(b.abs()));
    (least..12).find(|&n| format!("{a:.n$}") != format!("{b:.n$}")).unwrap_or(least)
}

/// A check of the kind `kind`, which passes if `load` is at most `threshold`; these are the same numbers as in the
/// search. `needed` and `allowed` state the comparison in units for people and are only printed: they have been
/// converted, and rounding could change the result.
pub(super) fn check(kind: CheckKind, needed: Rating, allowed: Rating, load: f64, threshold: Rating) -> Check {
    let state = match threshold {
        Ok(threshold) if load <= threshold => CheckState::Holds,
        Ok(_) => CheckState::Fails,
        Err(rating) => CheckState::NotChecked(rating),
    };
    let torque_exponent = kind.torque_exponent();
    Check { kind, needed: needed.ok(), allowed: allowed.ok(), state, torque_exponent, slides: false }
}

/// A check whose printed values are also the numbers that are compared: it passes if `needed` is at most `allowed`.
pub(super) fn plain(kind: CheckKind, needed: f64, allowed: Rating) -> Check {
    check(kind, Ok(needed), allowed, needed, allowed)
}

/// A check of a speed. It passes if `needed` is at most `allowed`, except for rounding.
pub(super) fn of_speed(kind: CheckKind, needed: f64, allowed: Rating) -> Check {
    check(kind, Ok(needed), allowed, needed, allowed.map(|most| most * WITH_ROUNDING))
}
