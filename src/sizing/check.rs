//! The checks of a drive, one by one, for people: needed, allowed, margin, and whether a check could be made at all.

use super::bearing::{self, BearingDemand, BearingLimits, BearingLoad};
use super::demand::{JointDemand, JointMotion};
use super::drive::{Drive, MissingRating, Rating, known};
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
    /// The motor can hold the static torque continuously.
    MotorHold,
    /// The motor can give static, linear and rotary torque for the duration of the ramp.
    MotorPeak,
    /// N times speed is below the motor's largest speed.
    MotorSpeed,
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
            CheckKind::MotorHold => "hold",
            CheckKind::MotorSpeed => "speed",
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
            CheckKind::MotorPeak => "motor peak",
            CheckKind::MotorSpeed => "motor speed",
            CheckKind::Mass => "mass",
        }
    }

    /// Unit of needed and allowed.
    pub fn unit(self) -> &'static str {
        match self {
            CheckKind::GearSpeed | CheckKind::GearMeanSpeed | CheckKind::MotorSpeed => "rpm",
            CheckKind::GearLife | CheckKind::BearingLife => "h",
            CheckKind::BearingRest | CheckKind::BearingStop => "times",
            CheckKind::Mass => "kg",
            _ => "N m",
        }
    }

    /// Whether the check is about the output bearing. A bearing whose rating is blank is not checked, and not excluded.
    pub fn is_bearing(self) -> bool {
        use CheckKind::{BearingLife, BearingMoment, BearingRest, BearingStop};
        matches!(self, BearingMoment | BearingRest | BearingStop | BearingLife)
    }

    /// Whether the check is about gear and bearing alone, whatever the motor.
    pub fn is_gear(self) -> bool {
        !matches!(self, CheckKind::MotorHold | CheckKind::MotorPeak | CheckKind::MotorSpeed | CheckKind::Mass)
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
    /// margin becomes the cube root; that of a bearing with the power 10/3 of its load.
    pub fn torque_margin(&self) -> Option<f64> {
        let margin = self.margin()?;
        Some(match self.kind {
            CheckKind::GearLife => margin.cbrt(),
            CheckKind::BearingLife => margin.powf(0.3),
            _ => margin,
        })
    }

    /// Needed minus allowed; positive if the check fails, `None` if one of the two is unknown.
    pub fn shortfall(&self) -> Option<f64> {
        Some(self.needed? - self.allowed?)
    }

    /// Whether the check holds. A check of a bearing that could not be made excludes nothing.
    pub fn holds(&self) -> bool {
        match self.state {
            CheckState::Holds => true,
            CheckState::Fails => false,
            CheckState::NotChecked(_) => self.kind.is_bearing(),
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
fn plain(kind: CheckKind, needed: f64, allowed: Rating) -> Check {
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
        plain(CheckKind::GearSpeed, limit::input_speed_rpm(gear, motion), limit::gear_max_speed_rpm(gear)),
        plain(
            CheckKind::GearMeanSpeed,
            limit::mean_input_speed_rpm(gear, motion),
            limit::gear_average_speed_rpm(gear),
        ),
        gear_life(gear, motion, demand),
    ];
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

/// The checks of a motor behind its gear. An unknown mass of the pair is listed too.
pub fn motor_checks(drive: &Drive, motion: &JointMotion, demand: &JointDemand) -> Vec<Check> {
    let mut checks = vec![
        motor_hold(drive, demand),
        motor_peak(drive, motion, demand),
        plain(
            CheckKind::MotorSpeed,
            limit::input_speed_rpm(drive.gear, motion),
            limit::motor_max_speed_rpm(drive.motor),
        ),
    ];
    if let Err(rating) = drive.mass_kg() {
        let state = CheckState::NotChecked(rating);
        checks.push(Check { kind: CheckKind::Mass, needed: None, allowed: None, state });
    }
    checks
}

/// T / (N η), compared with the continuous torque.
fn motor_hold(drive: &Drive, demand: &JointDemand) -> Check {
    check(
        CheckKind::MotorHold,
        drive.gain().map(|gain| demand.static_torque_nm / gain),
        known(drive.motor.rated_torque_nm, "motor rated_torque_nm"),
        demand.static_torque_nm,
        limit::motor_continuous_nm(drive),
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

#[cfg(test)]
mod tests {
    use super::super::testing::{
        any_gear, any_motion, any_motor, any_torques, bearing_loads, char_lynn_j_8_2, f11_10, gear,
        hfuc_40_100, motor,
    };
    use super::*;
    use crate::arm::bearing::BearingSource;
    use crate::arm::extras::ExtrasSource;
    use crate::catalog::gear::{BearingRatings, GearMass};
    use crate::catalog::motor::Motor;
    use crate::sizing::limits::{DriveLimits, Obstacle};
    use crate::sizing::requirement::MotionRequirement;
    use proptest::prelude::*;

    /// A joint at 1.35 m with 300 N m static and 100 N m linear torque.
    fn motion() -> JointMotion {
        MotionRequirement::default().joint_motion(1.35, None)
    }

    fn demand() -> JointDemand {
        motion().demand_of_torques(300.0, 100.0)
    }

    /// A gear and a motor that hold `demand()` in every respect.
    fn ample() -> (Gear, Motor) {
        let mut gear =
            gear("CSG-50-100", [600.0, 900.0, 700.0, 2000.0], [3500.0, 2500.0], 0.00125, [3.2, 8.9]);
        gear.permissible_tilting_moment_nm = Some(700.0);
        gear.bearing = BearingRatings {
            pitch_diameter_m: Some(0.1),
            offset_m: Some(0.02),
            static_load_rating_n: Some(80e3),
            dynamic_load_rating_n: Some(40e3),
        };
        (gear, motor("M", [10.0, 20.0], [2000.0, 3000.0], 0.0003, 4.0))
    }

    /// Kinds that do not hold after one thing was changed.
    fn failing(
        change: impl FnOnce(&mut Gear, &mut Motor, &mut JointMotion, &mut JointDemand),
    ) -> Vec<CheckKind> {
        let (mut gear, mut motor) = ample();
        let (mut motion, mut demand) = (motion(), demand());
        change(&mut gear, &mut motor, &mut motion, &mut demand);
        let drive = Drive {
            gear: &gear,
            motor: &motor,
            gear_mass: GearMass::HousedUnit,
            bearing: BearingSource::OfGear,
            extras: ExtrasSource::NONE,
        };
        let checks = checks(&drive, &motion, &demand);
        assert!(checks.iter().all(|c| c.state != CheckState::Holds || c.margin().unwrap() >= 1.0));
        assert!(checks.iter().all(|c| c.state != CheckState::Fails || c.margin().unwrap() < 1.0));
        checks.iter().filter(|c| !c.holds()).map(|c| c.kind).collect()
    }

    #[test]
    fn the_ample_drive_holds_everything() {
        assert_eq!(failing(|_, _, _, d| d.bearing = bearing_loads(500.0)), []);
    }

    #[test]
    fn each_check_fails_alone_when_its_own_limit_is_lowered() {
        assert_eq!(failing(|g, _, _, _| g.repeated_peak_torque_nm = Some(399.0)), [CheckKind::GearPeak]);
        assert_eq!(failing(|g, _, _, _| g.average_torque_limit_nm = Some(300.0)), [CheckKind::GearMean]);
        assert_eq!(failing(|g, _, _, _| g.momentary_peak_torque_nm = Some(499.0)), [CheckKind::GearStop]);
        assert_eq!(failing(|g, _, _, _| g.max_input_speed_rpm = Some(707.0)), [CheckKind::GearSpeed]);
        assert_eq!(
            failing(|g, _, _, _| g.average_input_speed_limit_rpm = Some(282.0)),
            [CheckKind::GearMeanSpeed]
        );
        assert_eq!(failing(|_, m, _, _| m.rated_torque_nm = Some(3.84)), [CheckKind::MotorHold]);
        assert_eq!(failing(|_, m, _, _| m.peak_torque_nm = Some(5.70)), [CheckKind::MotorPeak]);
        assert_eq!(failing(|_, m, _, _| m.max_speed_rpm = Some(707.0)), [CheckKind::MotorSpeed]);
    }

    #[test]
    fn life_fails_alone_when_more_is_required_than_the_bearing_gives() {
        assert_eq!(failing(|_, _, motion, _| motion.life_h = 1.0e6), [CheckKind::GearLife]);
        assert_eq!(failing(|g, _, _, _| g.rated_torque_nm = Some(100.0)), [CheckKind::GearLife]);
    }

    #[test]
    fn the_bearing_is_checked_if_something_loads_it_and_its_ratings_are_known() {
        // 661 N m and the offset of 0.02 m times 1983 N of radial force are 701 N m
        let loaded = |d: &mut JointDemand| d.bearing = bearing_loads(661.0);
        assert_eq!(failing(|_, _, _, d| loaded(d)), [CheckKind::BearingMoment]);
        let blank = |g: &mut Gear, d: &mut JointDemand| {
            loaded(d);
            g.permissible_tilting_moment_nm = None;
        };
        assert_eq!(failing(|g, _, _, d| blank(g, d)), [], "a blank rating excludes nothing");
        assert_eq!(failing(|g, _, _, _| g.permissible_tilting_moment_nm = None), []);
    }

    #[test]
    fn each_check_of_the_bearing_fails_alone_when_its_own_rating_is_lowered() {
        let with = |change: fn(&mut BearingRatings, &mut JointMotion)| {
            failing(|g, _, motion, d| {
                d.bearing = bearing_loads(500.0);
                change(&mut g.bearing, motion);
            })
        };
        // a stop of 700 N m: P0 = 2100 + 20 (700 + 0.02 2100) + 0.44 1400 = 17556 N, twice that is 35.1 kN; at rest
        // 300 N m: 900 + 20 (300 + 0.02 900) + 0.44 600 = 7524 N, three times that is 22.6 kN
        assert_eq!(with(|b, _| b.static_load_rating_n = Some(35.0e3)), [CheckKind::BearingStop]);
        assert_eq!(
            with(|b, _| b.static_load_rating_n = Some(22.0e3)),
            [CheckKind::BearingRest, CheckKind::BearingStop]
        );
        // Pc = 900 + 20 318 + 0.45 600 = 7530 N; at 0.4 / 1.35 rad/s, 10000 h are 1.70e6 turns: C = 1.3 7530 1.70^0.3
        let turns: f64 = 0.4 / 1.35 / std::f64::consts::TAU * 3600.0 * 1e4;
        let least_n = 1.3 * 7530.0 * (turns / 1e6).powf(0.3);
        assert!((least_n / 11_472.0 - 1.0).abs() < 0.01, "{least_n}");
        assert_eq!(with(|b, _| b.dynamic_load_rating_n = Some(11_300.0)), [CheckKind::BearingLife]);
        assert_eq!(with(|b, _| b.dynamic_load_rating_n = Some(11_700.0)), []);
    }

    #[test]
    fn a_component_set_has_no_bearing_to_tilt() {
        let (gear, _) = ample();
        let demand = demand().with_bearing(bearing_loads(9999.0));
        assert!(all_hold(&gear_checks(
            &gear,
            Bearing::of_gear(&gear, GearMass::ComponentSet).as_ref(),
            &motion(),
            &demand
        )));
        assert!(!all_hold(&gear_checks(
            &gear,
            Bearing::of_gear(&gear, GearMass::HousedUnit).as_ref(),
            &motion(),
            &demand
        )));
    }

    #[test]
    fn the_life_is_the_vendors_formula() {
        let (gear, _) = ample();
        let checks =
            gear_checks(&gear, Bearing::of_gear(&gear, GearMass::HousedUnit).as_ref(), &motion(), &demand());
        let life = checks.iter().find(|c| c.kind == CheckKind::GearLife).unwrap();
        let mean_rpm = 100.0 * 0.4 / 1.35 * 30.0 / std::f64::consts::PI;
        let by_hand = 10_000.0 * (600.0 / demand().mean_torque_nm()).powi(3) * (2000.0 / mean_rpm);
        assert!((life.allowed.unwrap() / by_hand - 1.0).abs() < 1e-12);
        assert_eq!(life.needed, Some(10_000.0));
    }

    #[test]
    fn a_check_reads_as_needed_and_allowed() {
        let mut gear = hfuc_40_100();
        gear.repeated_peak_torque_nm = Some(523.0);
        let demand = motion().demand_of_torques(376.0, 192.3);
        let checks =
            gear_checks(&gear, Bearing::of_gear(&gear, GearMass::HousedUnit).as_ref(), &motion(), &demand);
        assert_eq!(checks[0].to_string(), "peak 568 N m needed, 523 allowed");
    }

    #[test]
    fn numbers_that_round_to_the_same_are_printed_until_they_differ() {
        let near = plain(CheckKind::GearPeak, 523.04, Ok(522.96));
        assert_eq!(near.to_string(), "peak 523.04 N m needed, 522.96 allowed");
    }

    #[test]
    fn a_blank_rating_is_named_and_nothing_else_is_left_unchecked() {
        let (gear, _) = ample();
        let motor = char_lynn_j_8_2();
        let drive = Drive {
            gear: &gear,
            motor: &motor,
            gear_mass: GearMass::HousedUnit,
            bearing: BearingSource::OfGear,
            extras: ExtrasSource::NONE,
        };
        let checks = checks(&drive, &motion(), &demand());
        let blank: Vec<_> = checks.iter().filter(|c| !c.holds()).map(Check::to_string).collect();
        assert_eq!(blank, ["peak not checked: lacks rotor_inertia_kgm2"]);
        assert_eq!(
            DriveLimits::of(&drive, &motion()),
            Err(Obstacle::Lacks(MissingRating("rotor_inertia_kgm2")))
        );
    }

    #[test]
    fn a_blank_mass_is_listed_as_a_check_that_could_not_be_made() {
        assert_eq!(failing(|_, m, _, _| m.mass_kg = None), [CheckKind::Mass]);
    }

    #[test]
    fn a_rated_speed_stands_in_for_a_blank_largest_speed() {
        assert_eq!(failing(|_, m, _, _| m.max_speed_rpm = None), []);
        let slow = |_: &mut Gear, m: &mut Motor, _: &mut JointMotion, _: &mut JointDemand| {
            (m.max_speed_rpm, m.rated_speed_rpm) = (None, Some(700.0));
        };
        assert_eq!(failing(slow), [CheckKind::MotorSpeed]);
    }

    #[test]
    fn what_binds_is_the_smallest_margin() {
        let (gear, motor) = ample();
        let drive = Drive {
            gear: &gear,
            motor: &motor,
            gear_mass: GearMass::HousedUnit,
            bearing: BearingSource::OfGear,
            extras: ExtrasSource::NONE,
        };
        let mut checks = checks(&drive, &motion(), &demand());
        assert_eq!(binding(&checks).unwrap().kind, CheckKind::GearPeak);
        checks.remove(0);
        assert_eq!(binding(&checks).unwrap().kind, CheckKind::GearMean);
        assert!(binding(&[]).is_none());
    }

    #[test]
    fn a_joint_that_carries_nothing_has_no_end_of_life() {
        let (gear, motor) = (hfuc_40_100(), f11_10());
        let drive = Drive {
            gear: &gear,
            motor: &motor,
            gear_mass: GearMass::HousedUnit,
            bearing: BearingSource::OfGear,
            extras: ExtrasSource::NONE,
        };
        let checks = checks(&drive, &motion(), &motion().demand_of_torques(0.0, 0.0));
        assert!(all_hold(&checks));
        let life = checks.iter().find(|c| c.kind == CheckKind::GearLife).unwrap();
        assert_eq!(life.allowed, Some(f64::INFINITY));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4000))]

        #[test]
        fn thresholds_hold_exactly_when_all_checks_do(
            gear in any_gear(), motor in any_motor(), motion in any_motion(), torques in any_torques(), housed: bool,
        ) {
            let gear_mass = if housed { GearMass::HousedUnit } else { GearMass::ComponentSet };
            let drive = Drive { gear: &gear, motor: &motor, gear_mass, bearing: BearingSource::OfGear, extras: ExtrasSource::NONE };
            let demand = motion.demand_of_torques(torques[0], torques[1]).with_bearing(bearing_loads(torques[2]));
            let checks = checks(&drive, &motion, &demand);
            let by_thresholds = DriveLimits::of(&drive, &motion).is_ok_and(|l| l.hold(&demand));
            prop_assert_eq!(by_thresholds, all_hold(&checks));
            for c in &checks {
                let Some(margin) = c.margin() else {
                    prop_assert!(matches!(c.state, CheckState::NotChecked(_)), "{:?}", c);
                    continue;
                };
                // The printed numbers decide alike, but for rounding at the limit itself.
                if (margin - 1.0).abs() > 1e-12 {
                    prop_assert_eq!(c.holds(), margin > 1.0, "{:?}", c);
                }
            }
        }
    }
}
