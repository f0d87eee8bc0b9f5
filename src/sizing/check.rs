//! The checks of a drive, one by one, for people: needed, allowed, margin, and whether a check could be made at all.

use super::bearing::{self, BearingDemand, BearingLimits, BearingLoad};
use super::demand::{JointDemand, JointMotion};
use super::drive::{Drive, MissingRating, Rating, known};
use super::fit::{FitRequirement, LinkRoom, MotorPlace};
use super::heat::{self, MotorHeat};
use super::limits as limit;
use crate::arm::bearing::Bearing;
use crate::catalog::gear::Gear;
use std::fmt;

/// One limit of a gear or a motor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum CheckKind {
    /// Static plus linear torque is below the gear's limit for repeated peaks.
    GearPeak,
    /// Cubic mean torque is below the gear's limit for average torque.
    GearMean,
    /// Torque in an emergency stop is below the gear's limit for momentary peaks.
    GearStop,
    /// Torque in an emergency stop is below the torque at which the flexspline buckles.
    GearBuckling,
    /// Torque in an emergency stop is below the torque at which the teeth jump.
    GearRatcheting,
    /// The largest moment across the axis while the joint turns is below what the output bearing permits.
    BearingMoment,
    /// Static safety of the output bearing at rest.
    BearingRest,
    /// Static safety of the output bearing in an emergency stop.
    BearingStop,
    /// L10 life of the output bearing is above the required life.
    BearingLife,
    /// N times speed is below the gear's largest input speed.
    GearSpeed,
    /// N times mean speed is below the gear's limit for average input speed.
    GearMeanSpeed,
    /// L10 life of the wave-generator bearing is above the required life.
    GearLife,
    /// The gear bears the number of emergency stops that the study asks for. This check is listed only if it does.
    GearStops,
    /// The motor can hold the static torque continuously.
    MotorHold,
    /// The motor can give static, linear and rotary torque for the duration of the ramp.
    MotorPeak,
    /// Root mean square of the motor's torque over the cycle is below its continuous torque.
    MotorRms,
    /// N times speed is below the motor's largest speed.
    MotorSpeed,
    /// The gear is no wider than the link that the joint carries allows. Checks of fit are listed only if the study asks.
    GearWidth,
    /// The motor goes into the hollow of that link.
    MotorWidth,
    /// Cables go through the gear.
    GearBore,
    /// Cables go through the motor behind the gear.
    MotorBore,
    /// The drive is no longer than the room at the joint.
    DriveLength,
    /// The mass of the drive is known. This check is listed only if it is not.
    Mass,
}

impl CheckKind {
    /// Name in messages, where it follows the name of the part.
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
            CheckKind::DriveLength => "length of the drive",
            CheckKind::Mass => "mass",
        }
    }

    /// Name with the kind of part, for tables.
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
            CheckKind::GearBore => "gear bore",
            CheckKind::MotorBore => "motor bore",
            CheckKind::DriveLength => "drive length",
            CheckKind::Mass => "mass",
        }
    }

    /// Unit of needed and allowed.
    pub fn unit(self) -> &'static str {
        match self {
            CheckKind::GearSpeed | CheckKind::GearMeanSpeed | CheckKind::MotorSpeed => "rpm",
            CheckKind::GearLife | CheckKind::BearingLife => "h",
            CheckKind::BearingRest | CheckKind::BearingStop => "times",
            CheckKind::GearStops => "stops",
            CheckKind::Mass => "kg",
            fit if fit.is_fit() => "mm",
            _ => "N m",
        }
    }

    /// Whether the check is about the output bearing.
    pub fn is_bearing(self) -> bool {
        use CheckKind::{BearingLife, BearingMoment, BearingRest, BearingStop};
        matches!(self, BearingMoment | BearingRest | BearingStop | BearingLife)
    }

    /// Whether the check is about the sizes of the parts, and no torque changes it.
    pub fn is_fit(self) -> bool {
        use CheckKind::{DriveLength, GearBore, GearWidth, MotorBore, MotorWidth};
        matches!(self, GearWidth | MotorWidth | GearBore | MotorBore | DriveLength)
    }

    /// Whether a drive is excluded if a rating that this check needs is blank. An output bearing whose rating is blank and a
    /// part whose size is blank are not checked. Buckling and ratcheting torques are known of few gears and lie above the momentary peak, which is known.
    pub fn needs_its_rating(self) -> bool {
        !self.is_bearing()
            && !self.is_fit()
            && !matches!(self, CheckKind::GearBuckling | CheckKind::GearRatcheting)
    }

    /// Whether the check is about gear and bearing alone, whatever the motor.
    pub fn is_gear(self) -> bool {
        use CheckKind::{
            DriveLength, Mass, MotorBore, MotorHold, MotorPeak, MotorRms, MotorSpeed, MotorWidth,
        };
        !matches!(
            self,
            MotorHold | MotorPeak | MotorRms | MotorSpeed | MotorWidth | MotorBore | DriveLength | Mass
        )
    }
}

/// Outcome of a check.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CheckState {
    /// The limit is kept.
    Holds,
    /// The limit is exceeded.
    Fails,
    /// A rating that the check needs is blank.
    NotChecked(MissingRating),
}

/// One limit of one part against one demand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Check {
    /// Which limit is checked.
    pub kind: CheckKind,
    /// The needed value in [`CheckKind::unit`]; `None` if it cannot be computed.
    pub needed: Option<f64>,
    /// The value that the part allows (or, for life, that it reaches); `None` if it is unknown.
    pub allowed: Option<f64>,
    /// Outcome.
    pub state: CheckState,
}

impl Check {
    /// Allowed over needed; below 1 the check fails. `None` if it could not be checked.
    pub fn margin(&self) -> Option<f64> {
        match (self.needed?, self.allowed?) {
            (0.0, _) => Some(f64::INFINITY),
            (needed, allowed) => Some(allowed / needed),
        }
    }

    /// The margin as a factor on torque, which makes checks comparable. Life goes with the cube of the torque, so its
    /// margin becomes the cube root; that of a bearing with the power 10/3 of its load. The number of stops does not depend
    /// on the torque. A part that fits does so at any torque.
    pub fn torque_margin(&self) -> Option<f64> {
        let margin = self.margin()?;
        Some(match self.kind {
            CheckKind::GearLife => margin.cbrt(),
            CheckKind::BearingLife => margin.powf(0.3),
            fit if fit.is_fit() && self.state == CheckState::Holds => f64::INFINITY,
            _ => margin,
        })
    }

    /// Needed minus allowed; positive if the check fails, `None` if one of the two is unknown.
    pub fn shortfall(&self) -> Option<f64> {
        Some(self.needed? - self.allowed?)
    }

    /// Whether the check holds, or could not be made and excludes nothing.
    pub fn holds(&self) -> bool {
        match self.state {
            CheckState::Holds => true,
            CheckState::Fails => false,
            CheckState::NotChecked(_) => !self.kind.needs_its_rating(),
        }
    }
}

impl fmt::Display for Check {
    /// `peak 568 N m needed, 523 allowed`, or `peak not checked: lacks peak_torque_nm`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.kind.name();
        match (self.state, self.needed, self.allowed) {
            (CheckState::NotChecked(rating), _, _) => write!(f, "{name} not checked: lacks {rating}"),
            (_, Some(needed), Some(allowed)) => {
                let digits = digits_that_differ(needed, allowed);
                let unit = self.kind.unit();
                write!(f, "{name} {needed:.digits$} {unit} needed, {allowed:.digits$} allowed")
            }
            _ => write!(f, "{name}"),
        }
    }
}

/// Number of decimals that shows about three digits of a number.
pub(super) fn digits_of(x: f64) -> usize {
    match x.abs() {
        x if x >= 100.0 => 0,
        x if x >= 10.0 => 1,
        x if x >= 1.0 => 2,
        _ => 3,
    }
}

/// Number of decimals that shows about three digits of the larger number, or more if the two would look equal.
fn digits_that_differ(a: f64, b: f64) -> usize {
    let least = digits_of(a.abs().max(b.abs()));
    (least..12).find(|&n| format!("{a:.n$}") != format!("{b:.n$}")).unwrap_or(least)
}

/// Compares `load` with `threshold`. `needed` and `allowed` say the same thing in the units that people use, but they are
/// not compared: rounding could decide otherwise than the search did.
fn check(kind: CheckKind, needed: Rating, allowed: Rating, load: f64, threshold: Rating) -> Check {
    let state = match threshold {
        Ok(threshold) if load <= threshold => CheckState::Holds,
        Ok(_) => CheckState::Fails,
        Err(rating) => CheckState::NotChecked(rating),
    };
    Check { kind, needed: needed.ok(), allowed: allowed.ok(), state }
}

/// A check that compares the printed numbers themselves.
pub(super) fn plain(kind: CheckKind, needed: f64, allowed: Rating) -> Check {
    check(kind, Ok(needed), allowed, needed, allowed)
}

/// The checks of a gear and of the output bearing, which do not depend on the motor. The bearing is checked if the demand
/// has loads on it.
pub fn gear_checks(
    gear: &Gear,
    bearing: Option<&Bearing>,
    motion: &JointMotion,
    demand: &JointDemand,
) -> Vec<Check> {
    let mut checks = vec![
        plain(CheckKind::GearPeak, demand.peak_torque_nm(), limit::gear_peak_nm(gear)),
        gear_mean(gear, demand),
        plain(CheckKind::GearStop, demand.stop_torque_nm, limit::gear_momentary_nm(gear)),
        plain(CheckKind::GearBuckling, demand.stop_torque_nm, limit::gear_buckling_nm(gear)),
        plain(CheckKind::GearRatcheting, demand.stop_torque_nm, limit::gear_ratcheting_nm(gear)),
        plain(CheckKind::GearSpeed, limit::input_speed_rpm(gear, motion), limit::gear_max_speed_rpm(gear)),
        plain(
            CheckKind::GearMeanSpeed,
            limit::mean_input_speed_rpm(gear, motion),
            limit::gear_average_speed_rpm(gear),
        ),
        gear_life(gear, motion, demand),
    ];
    if let Some(stops) = motion.emergency_stops {
        checks.push(plain(CheckKind::GearStops, stops, Ok(limit::stops_allowed(gear, motion))));
    }
    checks.extend(gear_fits(gear, &motion.fit, &demand.room));
    if let Some(bearing) = bearing.filter(|_| !demand.bearing.is_zero()) {
        checks.extend(bearing_checks(bearing, motion, &demand.bearing));
    }
    checks
}

/// The checks of an output bearing: moment, static safety at rest and in a stop, life.
fn bearing_checks(bearing: &Bearing, motion: &JointMotion, demand: &BearingDemand) -> [Check; 4] {
    let speed_rad_s = motion.mean_speed_rad_s();
    let limits = BearingLimits::of(Some(bearing), speed_rad_s, motion.life_h);
    let ratings = &bearing.ratings;
    let known_pitch = |rating, name| {
        known(ratings.pitch_diameter_m, "bearing_pitch_diameter_m").and_then(|_| known(rating, name))
    };
    let moment_nm = limits.moment_nm(&demand.running);
    let permissible = known(bearing.permissible_moment_nm, "permissible_tilting_moment_nm");
    let safety = |kind, asked, load: &BearingLoad, limit_n: f64| {
        let load_n = limits.static_load_n(load);
        let rating = known_pitch(ratings.static_load_rating_n, "bearing_static_load_rating_n");
        check(kind, Ok(asked), rating.map(|c0_n| c0_n / load_n), load_n, rating.map(|_| limit_n))
    };
    let load_n = limits.dynamic_load_n(&demand.at_rest);
    let rating = known_pitch(ratings.dynamic_load_rating_n, "bearing_dynamic_load_rating_n");
    let life = rating.map(|c_n| bearing::life_h(c_n, load_n, speed_rad_s));
    [
        plain(CheckKind::BearingMoment, moment_nm, permissible),
        safety(CheckKind::BearingRest, bearing::SAFETY_AT_REST, &demand.at_rest, limits.at_rest_n),
        safety(CheckKind::BearingStop, bearing::SAFETY_IN_A_STOP, &demand.in_stop, limits.in_stop_n),
        check(CheckKind::BearingLife, Ok(motion.life_h), life, load_n, rating.map(|_| limits.life_n)),
    ]
}

fn gear_mean(gear: &Gear, demand: &JointDemand) -> Check {
    check(
        CheckKind::GearMean,
        Ok(demand.mean_torque_nm()),
        limit::gear_average_nm(gear),
        demand.mean_torque_cubed_nm3,
        limit::gear_average_cubed_nm3(gear),
    )
}

/// L10 = L_ref (T_rated / T_mean)³ (2000 rpm / n_mean), compared with the required life.
fn gear_life(gear: &Gear, motion: &JointMotion, demand: &JointDemand) -> Check {
    let life_h = limit::life_product(gear, motion).map(|product| product / demand.mean_torque_cubed_nm3);
    check(
        CheckKind::GearLife,
        Ok(motion.life_h),
        life_h,
        demand.mean_torque_cubed_nm3,
        limit::gear_life_cubed_nm3(gear, motion),
    )
}

/// What is asked of the sizes of a gear.
fn gear_fits(gear: &Gear, fit: &FitRequirement, room: &LinkRoom) -> impl Iterator<Item = Check> {
    let width = known(gear.envelope.outer_diameter_m, "gear outer_diameter_mm");
    let bore = known(gear.envelope.hollow_bore_m, "gear hollow_bore_mm");
    let width = at_most(CheckKind::GearWidth, width, room.gear_m);
    [width, fit.least_bore_m().map(|least_m| bore_check(CheckKind::GearBore, least_m, bore))]
        .into_iter()
        .flatten()
}

/// What is asked of the sizes of a motor, and of motor and gear together.
fn motor_fits(drive: &Drive, fit: &FitRequirement, room: &LinkRoom) -> impl Iterator<Item = Check> {
    let (gear, motor) = (&drive.gear.envelope, &drive.motor.envelope);
    let width = known(motor.outer_diameter_m, "motor outer_diameter_mm");
    let blank = if gear.length_m.is_none() { "gear length_mm" } else { "motor length_mm" };
    let length = known(fit.length_m(drive.gear, drive.motor), blank);
    let bore = known(motor.hollow_bore_m, "motor hollow_bore_mm");
    let least_bore_m = fit.least_bore_m().filter(|_| fit.motor == MotorPlace::Behind);
    let checks = [
        at_most(CheckKind::MotorWidth, width, room.motor_m),
        least_bore_m.map(|least_m| bore_check(CheckKind::MotorBore, least_m, bore)),
        at_most(CheckKind::DriveLength, length, fit.most_length_m().unwrap_or(f64::INFINITY)),
    ];
    checks.into_iter().flatten()
}

/// Whether a size is at most what there is room for; `None` if there is no end of room.
fn at_most(kind: CheckKind, size: Rating, room_m: f64) -> Option<Check> {
    let in_mm = |m: f64| m * 1e3;
    let needed =
        || check(kind, size.map(in_mm), Ok(in_mm(room_m)), size.unwrap_or(0.0), size.map(|_| room_m));
    room_m.is_finite().then(needed)
}

/// Whether cables that need a passage of this diameter go through a bore.
fn bore_check(kind: CheckKind, least_m: f64, bore: Rating) -> Check {
    check(kind, Ok(least_m * 1e3), bore.map(|m| m * 1e3), least_m, bore)
}

/// The checks of a motor behind its gear. Its heat is checked unless the study turns that off. An unknown mass of the pair
/// is listed too.
pub fn motor_checks(drive: &Drive, motion: &JointMotion, demand: &JointDemand) -> Vec<Check> {
    let mut checks = vec![motor_hold(drive, motion, demand), motor_peak(drive, motion, demand)];
    if motion.checks_motor_heat {
        checks.push(motor_rms(drive, motion, demand));
    }
    checks.push(plain(
        CheckKind::MotorSpeed,
        limit::input_speed_rpm(drive.gear, motion),
        limit::motor_max_speed_rpm(drive.motor),
    ));
    checks.extend(motor_fits(drive, &motion.fit, &demand.room));
    if let Err(rating) = drive.mass_kg() {
        let state = CheckState::NotChecked(rating);
        checks.push(Check { kind: CheckKind::Mass, needed: None, allowed: None, state });
    }
    checks
}

/// T / (N η), compared with the continuous torque; a brake holds any.
fn motor_hold(drive: &Drive, motion: &JointMotion, demand: &JointDemand) -> Check {
    let rated = known(drive.motor.rated_torque_nm, "motor rated_torque_nm");
    check(
        CheckKind::MotorHold,
        drive.gain().map(|gain| demand.static_torque_nm / gain),
        if motion.has_brake { Ok(f64::INFINITY) } else { rated },
        demand.static_torque_nm,
        limit::motor_hold_nm(drive, motion),
    )
}

/// (T + T_lin) / (N η) + J_in N α, compared with the peak torque.
fn motor_peak(drive: &Drive, motion: &JointMotion, demand: &JointDemand) -> Check {
    let peak_nm = demand.peak_torque_nm();
    check(
        CheckKind::MotorPeak,
        drive.peak_motor_torque_nm(motion, peak_nm),
        known(drive.motor.peak_torque_nm, "peak_torque_nm"),
        peak_nm,
        limit::motor_peak_nm(drive, motion),
    )
}

/// Root mean square of the motor's torque over the cycle, compared with its continuous torque at the cruising speed.
fn motor_rms(drive: &Drive, motion: &JointMotion, demand: &JointDemand) -> Check {
    let input_rpm = limit::input_speed_rpm(drive.gear, motion);
    let continuous_nm = heat::continuous_torque_nm(drive.motor, input_rpm);
    let used = MotorHeat::of(drive, motion).map(|heat| heat.share_squared(demand));
    let needed = used.and_then(|used| Ok(used.sqrt() * continuous_nm?));
    check(CheckKind::MotorRms, needed, continuous_nm, used.unwrap_or(f64::NAN), used.map(|_| 1.0))
}

/// All checks of a drive: first those of the gear, then those of the motor.
pub fn checks(drive: &Drive, motion: &JointMotion, demand: &JointDemand) -> Vec<Check> {
    let mut all = gear_checks(drive.gear, drive.bearing().as_ref(), motion, demand);
    all.extend(motor_checks(drive, motion, demand));
    all
}

/// Whether every check holds. A check that could not be made does not hold.
pub fn all_hold(checks: &[Check]) -> bool {
    checks.iter().all(Check::holds)
}

/// The check that binds: the one with the smallest torque margin among those that could be made.
pub fn binding(checks: &[Check]) -> Option<&Check> {
    let made = checks.iter().filter_map(|c| Some((c.torque_margin()?, c)));
    made.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, check)| check)
}
