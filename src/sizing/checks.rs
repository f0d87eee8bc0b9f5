//! All checks of a drive, one by one: the checks of its gear, of its output bearing and of its motor.

use super::bearing_checks::bearing_checks;
use super::check::{Check, CheckKind, check, of_speed, plain};
use super::demand::{JointDemand, JointMotion, input_speed_rpm, mean_input_speed_rpm};
use super::drive::{Drive, MissingRating};
use super::fit_checks::{gear_fits, motor_fits};
use super::heat::MotorHeat;
use super::limits as limit;
use super::motor_curve;
use crate::arm::bearing::Bearing;
use crate::catalog::gear::{Gear, GearKind, GearMass};

/// The checks of a gear and of the output bearing, which do not depend on the motor.
pub fn gear_checks(
    gear: &Gear,
    which: GearMass,
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
        of_speed(CheckKind::GearSpeed, input_speed_rpm(gear, motion), limit::gear_max_speed_rpm(gear)),
        of_speed(
            CheckKind::GearMeanSpeed,
            mean_input_speed_rpm(gear, motion),
            limit::gear_average_speed_rpm(gear),
        ),
        gear_life(gear, motion, demand),
    ];
    if let Some(stops) = motion.emergency_stops {
        let allowed = limit::stops_allowed(gear, motion);
        let rule = MissingRating("a rule for the stops of its kind");
        checks.push(plain(CheckKind::GearStops, stops, allowed.ok_or(rule)));
    }
    checks.retain(|check| !limit::is_unlimited(gear, check.kind));
    if gear.kind == GearKind::Actuator {
        // an actuator in an emergency stop must brake its own rotor too; its stop is therefore one of `motor_checks`
        checks.retain(|check| check.kind != CheckKind::GearStop);
    }
    checks.extend(gear_fits(gear, which, &motion.fit, &demand.room));
    if let Some(bearing) = bearing {
        checks.extend(bearing_checks(bearing, motion, &demand.bearing));
    }
    checks.iter_mut().for_each(|check| check.slides = gear.kind.slides());
    checks
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

/// Check of the L10 life of the gear: L_rated (T_rated / T_mean)^p (n_rated / n_mean), compared with the required life.
fn gear_life(gear: &Gear, motion: &JointMotion, demand: &JointDemand) -> Check {
    let life_h = limit::gear_life_h(gear, motion, demand.mean_torque_cubed_nm3);
    let check = check(
        CheckKind::GearLife,
        Ok(motion.life_h),
        life_h,
        demand.mean_torque_cubed_nm3,
        limit::gear_life_cubed_nm3(gear, motion),
    );
    Check { torque_exponent: gear.life.exponent, ..check }
}

/// One check that could not be made for each blank rating of the torsion curve. Without the curve the deflection of
/// the joint is unknown.
pub(super) fn torsion_checks(gear: &Gear) -> Vec<Check> {
    let missing = gear.missing_of_torsion().into_iter().map(MissingRating);
    missing.map(|rating| Check::not_made(CheckKind::Torsion, rating)).collect()
}

/// The checks of the motor of a drive. Heating of the motor is checked unless the study turns that off. If the mass of
/// gear and motor is unknown, this is listed as a check that could not be made.
pub fn motor_checks(drive: &Drive, motion: &JointMotion, demand: &JointDemand) -> Vec<Check> {
    let mut checks = vec![motor_hold(drive, motion, demand), motor_peak(drive, motion, demand)];
    let is_limited = !limit::is_unlimited(drive.gear, CheckKind::GearStop);
    if drive.gear.kind == GearKind::Actuator && is_limited {
        checks.push(actuator_stop(drive, motion, demand));
    }
    if motion.checks_motor_heat {
        checks.push(motor_rms(drive, motion, demand));
    }
    checks.push(of_speed(
        CheckKind::MotorSpeed,
        drive.motor_speed_rpm(motion),
        limit::motor_max_speed_rpm(drive.motor),
    ));
    checks.extend(motor_fits(drive, &motion.fit, &demand.room));
    if let Err(rating) = drive.mass_kg() {
        checks.push(Check::not_made(CheckKind::Mass, rating));
    }
    checks
}

/// Check of the motor at rest: static torque T / (N η) at the motor, compared with its continuous torque at rest. If a
/// brake holds the joint, any torque is allowed.
fn motor_hold(drive: &Drive, motion: &JointMotion, demand: &JointDemand) -> Check {
    let rated = motor_curve::standing_torque_nm(drive.motor);
    check(
        CheckKind::MotorHold,
        drive.gain().map(|gain| demand.static_torque_nm / gain),
        if motion.has_brake { Ok(f64::INFINITY) } else { rated },
        demand.static_torque_nm,
        limit::motor_hold_nm(drive, motion),
    )
}

/// Check of the motor in a ramp: its peak torque (T + T_lin) / (N η) + J_in N α, compared with what the motor allows
/// for a short time.
fn motor_peak(drive: &Drive, motion: &JointMotion, demand: &JointDemand) -> Check {
    let peak_nm = demand.peak_torque_nm();
    check(
        CheckKind::MotorPeak,
        drive.peak_motor_torque_nm(motion, peak_nm),
        motor_curve::peak_torque_nm(drive.motor, drive.motor_speed_rpm(motion)),
        peak_nm,
        limit::motor_peak_nm(drive, motion),
    )
}

/// Check of an actuator in an emergency stop: the torque that stops the load and its own rotor, compared with its peak
/// torque.
fn actuator_stop(drive: &Drive, motion: &JointMotion, demand: &JointDemand) -> Check {
    check(
        CheckKind::GearStop,
        limit::actuator_stop_of_rotor_nm(drive, motion).map(|rotor_nm| demand.stop_torque_nm + rotor_nm),
        limit::gear_momentary_nm(drive.gear),
        demand.stop_torque_nm,
        limit::actuator_stop_nm(drive, motion),
    )
}

/// Check of the motor's heat: root mean square of its torque over the cycle, compared with its continuous torque at the
/// cruising speed.
fn motor_rms(drive: &Drive, motion: &JointMotion, demand: &JointDemand) -> Check {
    let motor_rpm = drive.motor_speed_rpm(motion);
    let continuous_nm = motor_curve::continuous_torque_nm(drive.motor, motor_rpm);
    let used = MotorHeat::of(drive, motion).map(|heat| heat.share_squared(demand));
    let needed = used.and_then(|used| Ok(used.sqrt() * continuous_nm?));
    check(CheckKind::MotorRms, needed, continuous_nm, used.unwrap_or(f64::NAN), used.map(|_| 1.0))
}

/// All checks of a drive: first the checks of gear and output bearing, then the checks of the motor.
pub fn checks(drive: &Drive, motion: &JointMotion, demand: &JointDemand) -> Vec<Check> {
    let mut all = gear_checks(drive.gear, drive.gear_mass, drive.bearing().as_ref(), motion, demand);
    all.extend(motor_checks(drive, motion, demand));
    all
}

/// The checks of a drive that stands still and holds the reaction to the motion of another joint: `ramp_nm` while the
/// other joint ramps, `stop_nm` while it makes an emergency stop \[N m\]. Only checks that compare a single torque are
/// made. Mean values over the cycle are left out, because these short torques hardly change them.
pub(crate) fn reaction_checks(drive: &Drive, motion: &JointMotion, ramp_nm: f64, stop_nm: f64) -> Vec<Check> {
    use CheckKind::{GearBuckling, GearPeak, GearRatcheting, GearStop, MotorPeak};
    let still = JointMotion { speed_rad_s: 0.0, acceleration_rad_s2: 0.0, stated: None, ..*motion };
    let demand =
        JointDemand { stated_peak_nm: ramp_nm, stop_torque_nm: stop_nm, ..still.demand_of_torques(0.0, 0.0) };
    let mut all = checks(drive, &still, &demand);
    all.retain(|check| matches!(check.kind, GearBuckling | GearPeak | GearRatcheting | GearStop | MotorPeak));
    all
}

/// Whether all `checks` let the drive pass, see [`Check::holds`].
pub fn all_hold(checks: &[Check]) -> bool {
    checks.iter().all(Check::holds)
}

/// The binding check: the check with the smallest torque margin ([`Check::torque_margin`]) among the checks that
/// could be made. `None` if no check could be made.
pub fn binding(checks: &[Check]) -> Option<&Check> {
    let made = checks.iter().filter_map(|c| Some((c.torque_margin()?, c)));
    made.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, check)| check)
}

#[cfg(test)]
#[path = "checks_tests.rs"]
mod tests;
