//! Thresholds of torque of a drive under a fixed motion.
//!
//! The study fixes speed, acceleration and duty cycle of a joint, so most checks of a drive compare one torque with
//! one number. [`DriveLimits`] has these numbers. Three checks need more than one torque: the output bearing (see
//! [`BearingLimits`]), motor heat, which compares a mean square with 1, and sizes ([`DriveWidths`]). A search
//! compares these numbers and nothing else. The printed checks ([`checks`](mod@super::checks)) use the same thresholds.

use super::bearing::BearingLimits;
use super::check::{CheckKind, WITH_ROUNDING};
use super::demand::{JointDemand, JointMotion, input_speed_rpm, mean_input_speed_rpm};
use super::drive::{Drive, MissingRating, Rating, if_any, known};
use super::fit::DriveWidths;
use super::heat::MotorHeat;
use super::motor_curve;
use crate::catalog::gear::{Gear, GearKind};
use crate::catalog::motor::Motor;

/// Thresholds of a drive under a fixed motion, on the output side. The drive passes every check of a demand exactly
/// if no threshold is exceeded.
///
/// ```
/// use armwright::catalog::Catalogs;
/// use armwright::arm::{BearingSource, ExtrasSource, Stage};
/// use armwright::catalog::GearMass;
/// use armwright::sizing::{Drive, DriveLimits, MotionRequirement};
///
/// let catalogs = Catalogs::builtin();
/// let (gear, motor) = (catalogs.gear("HFUC-58-100").unwrap(), catalogs.motor("F11-10").unwrap());
/// let drive = Drive {
///     gear,
///     motor,
///     gear_mass: GearMass::ComponentSet,
///     bearing: BearingSource::OfGear,
///     extras: ExtrasSource::NONE,
///     stage: Stage::NONE,
/// };
/// let motion = MotionRequirement::default().joint_motion(1.35, None);
/// let limits = DriveLimits::of(&drive, &motion).expect("nothing excludes this drive");
/// assert!(limits.hold(&motion.demand_of_torques(500.0, 250.0)));
/// assert!(!limits.hold(&motion.demand_of_torques(1200.0, 600.0)), "1800 N m are more than the gear's peak");
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveLimits {
    /// Largest static torque, as given by the motor's continuous torque \[N m\].
    pub static_torque_nm: f64,
    /// Largest static plus linear torque, as given by the gear's limit for repeated peaks and the motor's peak torque
    /// \[N m\].
    pub peak_torque_nm: f64,
    /// Largest torque in an emergency stop, as given by the gear \[N m\].
    pub stop_torque_nm: f64,
    /// Cube of the largest cubic mean torque, as given by the gear's average limit and its life \[(N m)³\].
    pub mean_torque_cubed_nm3: f64,
    /// Limits of the output bearing.
    pub bearing: BearingLimits,
    /// Widths of gear and motor, as far as the study limits them.
    pub widths: DriveWidths,
    /// Numbers from which the motor's heat under a demand is computed.
    pub heat: MotorHeat,
}

/// Why a drive is excluded whatever the torque.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Obstacle {
    /// The joint turns faster than the gear or the motor may.
    TooFast,
    /// The gear does not withstand as many emergency stops as the study asks for.
    TooManyStops,
    /// The drive is too long for its joint, or its bore is too narrow for the cables.
    DoesNotFit,
    /// A rating that a check needs is blank.
    Lacks(MissingRating),
}

impl From<MissingRating> for Obstacle {
    fn from(rating: MissingRating) -> Self {
        Obstacle::Lacks(rating)
    }
}

impl DriveLimits {
    /// The thresholds of a drive under a motion.
    ///
    /// # Errors
    /// [`Obstacle`] if the drive is excluded whatever the torque. A blank rating of the bearing does not exclude the
    /// drive; the bearing is then not checked.
    pub fn of(drive: &Drive, motion: &JointMotion) -> Result<Self, Obstacle> {
        drive.mass_kg()?;
        if !speeds_hold(drive, motion)? {
            return Err(Obstacle::TooFast);
        }
        let gear = drive.gear;
        if motion
            .emergency_stops
            .zip(stops_allowed(gear, motion))
            .is_some_and(|(asked, allowed)| asked > allowed)
        {
            return Err(Obstacle::TooManyStops);
        }
        if !motion.fit.allows(&drive.gear_envelope(), &drive.motor.envelope) {
            return Err(Obstacle::DoesNotFit);
        }
        Ok(Self {
            static_torque_nm: motor_hold_nm(drive, motion)?,
            peak_torque_nm: gear_peak_nm(gear)?.min(motor_peak_nm(drive, motion)?),
            stop_torque_nm: gear_stop_nm(gear)?.min(actuator_stop_nm(drive, motion)?),
            mean_torque_cubed_nm3: gear_average_cubed_nm3(gear)?.min(gear_life_cubed_nm3(gear, motion)?),
            bearing: BearingLimits::of(drive.bearing().as_ref(), motion.mean_speed_rad_s(), motion.life_h),
            widths: DriveWidths::of(&drive.gear_envelope(), drive.motor, &motion.fit),
            heat: MotorHeat::of(drive, motion)?,
        })
    }

    /// Whether the drive passes every check of `demand`: no torque, load or size exceeds its threshold.
    #[inline]
    pub fn hold(&self, demand: &JointDemand) -> bool {
        // `&` instead of `&&`, so that the compiler emits no branches
        (demand.static_torque_nm <= self.static_torque_nm)
            & (demand.peak_torque_nm() <= self.peak_torque_nm)
            & (demand.stop_torque_nm <= self.stop_torque_nm)
            & (demand.mean_torque_cubed_nm3 <= self.mean_torque_cubed_nm3)
            & self.bearing.hold(&demand.bearing)
            & self.widths.fit(&demand.room)
            & (self.heat.share_squared(demand) <= 1.0)
    }

    /// The weaker limits of this drive and of `other`, one by one: the larger value of each limit, but the smaller
    /// value for heat and widths. If one of the two drives meets a demand, the demand is within these limits.
    pub(crate) fn max(&self, other: &Self) -> Self {
        Self {
            static_torque_nm: self.static_torque_nm.max(other.static_torque_nm),
            peak_torque_nm: self.peak_torque_nm.max(other.peak_torque_nm),
            stop_torque_nm: self.stop_torque_nm.max(other.stop_torque_nm),
            mean_torque_cubed_nm3: self.mean_torque_cubed_nm3.max(other.mean_torque_cubed_nm3),
            bearing: self.bearing.max(&other.bearing),
            widths: self.widths.min(&other.widths),
            heat: self.heat.least(&other.heat),
        }
    }

    /// The stricter limits of this drive and of `other`, one by one: the smaller value of each limit, but the larger
    /// value for heat and widths. Both drives meet every demand that is within these limits.
    pub(crate) fn min(&self, other: &Self) -> Self {
        Self {
            static_torque_nm: self.static_torque_nm.min(other.static_torque_nm),
            peak_torque_nm: self.peak_torque_nm.min(other.peak_torque_nm),
            stop_torque_nm: self.stop_torque_nm.min(other.stop_torque_nm),
            mean_torque_cubed_nm3: self.mean_torque_cubed_nm3.min(other.mean_torque_cubed_nm3),
            bearing: self.bearing.min(&other.bearing),
            widths: self.widths.max(&other.widths),
            heat: self.heat.greatest(&other.heat),
        }
    }

    /// The largest factor on the loads of `demand` with which the drive still passes, or slightly more by rounding.
    /// Infinite if the demand is zero. Sizes are not checked, because no factor on the loads changes them.
    pub(crate) fn multiple_of(&self, demand: &JointDemand) -> f64 {
        let times = |limit: f64, asked: f64| if asked > 0.0 { limit / asked } else { f64::INFINITY };
        times(self.static_torque_nm, demand.static_torque_nm)
            .min(times(self.peak_torque_nm, demand.peak_torque_nm()))
            .min(times(self.stop_torque_nm, demand.stop_torque_nm))
            .min(libm::cbrt(times(self.mean_torque_cubed_nm3, demand.mean_torque_cubed_nm3)))
            .min(self.bearing.multiple_of(&demand.bearing))
            .min(self.heat.multiple_of(demand))
    }

    /// Whether no limit of this drive is stricter than the same limit of `other`. This drive then meets every demand
    /// that `other` meets.
    #[inline]
    pub fn cover(&self, other: &Self) -> bool {
        (self.static_torque_nm >= other.static_torque_nm)
            & (self.peak_torque_nm >= other.peak_torque_nm)
            & (self.stop_torque_nm >= other.stop_torque_nm)
            & (self.mean_torque_cubed_nm3 >= other.mean_torque_cubed_nm3)
            & self.bearing.cover(&other.bearing)
            & self.widths.cover(&other.widths)
            & self.heat.covers(&other.heat)
    }
}

fn speeds_hold(drive: &Drive, motion: &JointMotion) -> Result<bool, MissingRating> {
    let speeds_and_limits = [
        (input_speed_rpm(drive.gear, motion), gear_max_speed_rpm(drive.gear)?),
        (mean_input_speed_rpm(drive.gear, motion), gear_average_speed_rpm(drive.gear)?),
        (drive.motor_speed_rpm(motion), motor_max_speed_rpm(drive.motor)?),
    ];
    Ok(speeds_and_limits.iter().all(|(rpm, most_rpm)| *rpm <= most_rpm * WITH_ROUNDING))
}

/// The limit `rating` of a gear. It is infinite if it is blank and gears of this kind have no such limit; otherwise a
/// blank is an error with the name of the rating.
fn limit(gear: &Gear, rating: Option<f64>, name: &'static str) -> Rating {
    if_any(gear, rating, f64::INFINITY, name)
}

pub(super) fn gear_max_speed_rpm(gear: &Gear) -> Rating {
    limit(gear, gear.max_input_speed_rpm, "max_input_speed_rpm")
}

pub(super) fn gear_average_speed_rpm(gear: &Gear) -> Rating {
    limit(gear, gear.average_input_speed_limit_rpm, "average_input_speed_limit_rpm")
}

/// Largest speed of a motor at the end of a ramp \[rpm\]: its stated largest speed, or its rated speed if only that
/// is known. It is never beyond the last point of the motor's torque curve.
pub(super) fn motor_max_speed_rpm(motor: &Motor) -> Rating {
    let of_curve = motor_curve::largest_speed_rpm(motor);
    let stated = motor.max_speed_rpm.or(motor.rated_speed_rpm);
    known(stated.into_iter().chain(of_curve).reduce(f64::min), "motor max_speed_rpm")
}

/// Largest static torque at the joint that the motor may hold permanently \[N m\]. Infinite if a brake holds the
/// joint at rest.
pub(super) fn motor_hold_nm(drive: &Drive, motion: &JointMotion) -> Rating {
    if motion.has_brake { Ok(f64::INFINITY) } else { motor_continuous_nm(drive) }
}

/// Static torque at the joint at which the motor gives its continuous torque at rest: T_rated N η \[N m\].
pub(super) fn motor_continuous_nm(drive: &Drive) -> Rating {
    Ok(motor_curve::standing_torque_nm(drive.motor)? * drive.gain()?)
}

/// Output torque at which the accelerating motor gives its peak torque: (T_peak - J_in N α) N η \[N m\].
pub(super) fn motor_peak_nm(drive: &Drive, motion: &JointMotion) -> Rating {
    let peak = motor_curve::peak_torque_nm(drive.motor, drive.motor_speed_rpm(motion))?;
    Ok((peak - drive.rotary_torque_motor_nm(motion)?) * drive.gain()?)
}

pub(super) fn gear_peak_nm(gear: &Gear) -> Rating {
    limit(gear, gear.repeated_peak_torque_nm, "repeated_peak_torque_nm")
}

pub(super) fn gear_average_nm(gear: &Gear) -> Rating {
    limit(gear, gear.average_torque_limit_nm, "average_torque_limit_nm")
}

pub(super) fn gear_average_cubed_nm3(gear: &Gear) -> Rating {
    Ok(gear_average_nm(gear)?.powi(3))
}

pub(super) fn gear_momentary_nm(gear: &Gear) -> Rating {
    limit(gear, gear.momentary_peak_torque_nm, "momentary_peak_torque_nm")
}

pub(super) fn gear_buckling_nm(gear: &Gear) -> Rating {
    known(gear.buckling_torque_nm, "buckling_torque_nm")
}

pub(super) fn gear_ratcheting_nm(gear: &Gear) -> Rating {
    known(gear.ratcheting_torque_nm, "ratcheting_torque_nm")
}

/// Largest torque in an emergency stop \[N m\]: the smallest of the limit for momentary peaks, buckling torque and
/// ratcheting torque. The last two count only where they are known.
fn gear_stop_nm(gear: &Gear) -> Rating {
    let unknown = f64::INFINITY;
    let jumps_nm = gear_ratcheting_nm(gear).unwrap_or(unknown);
    Ok(gear_momentary_nm(gear)?.min(gear_buckling_nm(gear).unwrap_or(unknown)).min(jumps_nm))
}

/// Largest torque at the joint in an emergency stop that an actuator can brake \[N m\]: T_peak - s J_out α. T_peak is
/// the peak torque of the actuator. The factor s of the stop is the emergency deceleration over the acceleration α of a
/// ramp, but at least 1. J_out is the inertia of the rotor at the output, which the motor must brake too. Infinite for other drives,
/// whose rotor does not load the gear.
pub(super) fn actuator_stop_nm(drive: &Drive, motion: &JointMotion) -> Rating {
    if drive.gear.kind != GearKind::Actuator {
        return Ok(f64::INFINITY);
    }
    Ok(gear_momentary_nm(drive.gear)? - actuator_stop_of_rotor_nm(drive, motion)?)
}

/// Torque that stops the rotor of an actuator in an emergency, at the output \[N m\].
pub(super) fn actuator_stop_of_rotor_nm(drive: &Drive, motion: &JointMotion) -> Rating {
    Ok(motion.stop.factor * drive.rotary_torque_motor_nm(motion)? * drive.gain()?)
}

/// Number of emergency stops (momentary peaks) that a gear may see in its life: 1e4 / (2 n t / 60), but at most 1e4.
/// Here n is the input speed in rpm and t is the duration of a stop in seconds. The factor 2 is there because the wave
/// generator deforms the flexspline twice in each turn. `None` if the gear is no strain-wave gear, for which alone
/// the rule is made.
///
/// Source: Harmonic Drive AG, manual 1019658, glossary (momentary peaks only in an emergency, their number by the
/// selection procedure); the formula as in the public program AimanHaidar/harmonic-drive-selector.
pub(super) fn stops_allowed(gear: &Gear, motion: &JointMotion) -> Option<f64> {
    const LIFE_WAVES: f64 = 1e4;
    // relative tolerance: a study states whole numbers of stops, but the number that is allowed is computed from a
    // speed that was converted to rad/s
    const ROUNDING: f64 = 1e-9;
    if gear.kind != GearKind::StrainWave {
        return None;
    }
    let waves_in_a_stop = 2.0 * input_speed_rpm(gear, motion) / 60.0 * motion.stop_time_s();
    Some(LIFE_WAVES / waves_in_a_stop.max(1.0) * (1.0 + ROUNDING))
}

/// Whether a gear has no limit for the check `kind`, so that the check is left out.
pub(super) fn is_unlimited(gear: &Gear, kind: CheckKind) -> bool {
    let limit = match kind {
        CheckKind::GearPeak => gear_peak_nm(gear),
        CheckKind::GearMean => gear_average_nm(gear),
        CheckKind::GearStop => gear_momentary_nm(gear),
        CheckKind::GearSpeed => gear_max_speed_rpm(gear),
        CheckKind::GearMeanSpeed => gear_average_speed_rpm(gear),
        CheckKind::GearLife => return !has_life(gear),
        // only a flexspline can buckle or ratchet
        CheckKind::GearBuckling => return !has_flexspline(gear) && gear.buckling_torque_nm.is_none(),
        CheckKind::GearRatcheting => return !has_flexspline(gear) && gear.ratcheting_torque_nm.is_none(),
        _ => return false,
    };
    limit == Ok(f64::INFINITY)
}

fn has_flexspline(gear: &Gear) -> bool {
    gear.kind == GearKind::StrainWave
}

/// Whether the life of a gear is checked: gears of its kind wear out, or its catalog row states a life.
pub(super) fn has_life(gear: &Gear) -> bool {
    gear.kind.wears_out() || gear.life.rated_h.is_some()
}

/// Life at a mean torque of 1 N m \[h (N m)^p\]: L_rated T_rated^p (n_rated / n_mean). p is the exponent of the
/// gear's life formula.
fn life_product(gear: &Gear, motion: &JointMotion) -> Rating {
    let rated_h = known(gear.life.rated_h, "rated_life_h")?;
    let rated_rpm = known(gear.life.rated_speed_rpm, "rated_life_speed_rpm")?;
    let rated_nm = known(gear.rated_torque_nm, "gear rated_torque_nm")?;
    let rated_power = match gear.life.exponent {
        3.0 => rated_nm.powi(3),
        exponent => libm::pow(rated_nm, exponent),
    };
    Ok(rated_h * rated_power * (rated_rpm / mean_input_speed_rpm(gear, motion)))
}

/// Life of a gear \[h\] under a mean torque, whose cube is `mean_cubed_nm3` \[(N m)³\].
pub(super) fn gear_life_h(gear: &Gear, motion: &JointMotion, mean_cubed_nm3: f64) -> Rating {
    Ok(life_product(gear, motion)? / power(mean_cubed_nm3, gear.life.exponent / 3.0))
}

/// Cube of the mean torque at which the gear just reaches the required life \[(N m)³\].
pub(super) fn gear_life_cubed_nm3(gear: &Gear, motion: &JointMotion) -> Rating {
    match has_life(gear) {
        true => Ok(power(life_product(gear, motion)? / motion.life_h, 3.0 / gear.life.exponent)),
        false => Ok(f64::INFINITY),
    }
}

/// The number `x` raised to the power `exponent`. The first power returns the number itself, without any rounding.
fn power(x: f64, exponent: f64) -> f64 {
    if exponent == 1.0 { x } else { libm::pow(x, exponent) }
}
