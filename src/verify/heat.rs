//! Whether a motor overheats over the cycle of its joint (docs/sizing.md, "Motor heat").
//!
//! Each phase is computed separately, once for a joint that lifts its load and once for one that lowers it. The
//! torque at the joint in the direction of motion comes first, then the torque of the motor. The losses of the gear
//! act against whichever side drives. The worse of the two directions counts. The search itself uses a formula for
//! lifting alone.

use super::courses::courses;
use super::question::{AskedDutyPhase, AskedStage};
use crate::catalog::gear::{Gear, GearKind};
use crate::catalog::motor::Motor;
use std::f64::consts::PI;

/// Numbers of a drive from which the heat of its motor follows. They are torques of the motor divided by its continuous
/// torque. Smaller numbers are better.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct MotorHeat {
    /// Motor torque for each newton metre at the joint, where the motor drives the joint \[1/(N m)\].
    driving: f64,
    /// Motor torque for each newton metre at the joint, where the joint drives the motor \[1/(N m)\].
    driven: f64,
    /// Motor torque that accelerates rotor and wave generator, as a fraction of the continuous torque.
    own: f64,
    /// Mean square of the motor torque over a duty that the study states in numbers; 0 without one.
    stated: f64,
}

/// The load that a joint puts on its motor over the cycle: torques at the joint \[N m\], and fractions of the cycle's
/// time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct HeatDemand {
    pub static_nm: f64,
    pub linear_nm: f64,
    pub shares: CycleShares,
    /// Factor by which the mean square is multiplied: a margin for rounding.
    pub room: f64,
}

/// Fraction of the cycle's time in each kind of phase.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct CycleShares {
    pub ramp_up: f64,
    /// Travel at constant speed. A phase with a stated fraction of the static torque is weighted with the square of
    /// this fraction.
    pub travel: f64,
    pub ramp_down: f64,
    /// Rest. A phase with a stated fraction of the static torque is weighted with the square of this fraction. 0 if a
    /// brake holds the joint.
    pub rest: f64,
}

impl MotorHeat {
    /// A motor that is never too hot: all torques are zero.
    pub(super) const NONE: Self = Self { driving: 0.0, driven: 0.0, own: 0.0, stated: 0.0 };

    /// The numbers of a drive with this gear and motor. The joint cruises at `speed_rad_s`, which it reaches with
    /// `acceleration_rad_s2`, or has the stated duty `stated`. `None` if the catalog leaves a needed number blank.
    pub(super) fn of(
        gear: &Gear,
        motor: &Motor,
        stage: &AskedStage,
        speed_rad_s: f64,
        acceleration_rad_s2: f64,
        stated: &[StatedPhase],
    ) -> Option<Self> {
        let (ratio, efficiency) = (gear.ratio * stage.ratio, efficiency(gear)? * stage.efficiency);
        let cruising_rpm = ratio * speed_rad_s * 30.0 / PI;
        let continuous_nm = continuous_nm(motor, cruising_rpm)?;
        let own_s2 = input_inertia_kgm2(gear, motor, stage)? * ratio / continuous_nm;
        let heat = Self {
            driving: 1.0 / (ratio * efficiency) / continuous_nm,
            driven: efficiency / ratio / continuous_nm,
            own: own_s2 * acceleration_rad_s2,
            stated: 0.0,
        };
        let stated = stated.iter().map(|phase| {
            let torque = heat.at_motor(phase.torque_nm) + own_s2 * phase.acceleration_rad_s2;
            phase.share * torque * torque
        });
        Some(Self { stated: stated.sum(), ..heat })
    }

    /// Whether the root mean square of the motor's torque over the cycle is within its continuous torque.
    pub(super) fn holds(&self, asked: &HeatDemand) -> bool {
        let worse = self.mean_square(asked, 1.0).max(self.mean_square(asked, -1.0));
        (worse + self.stated) * asked.room <= 1.0
    }

    /// Mean square over the cycle of the motor's torque, as a fraction of the continuous torque, if the joint lifts
    /// its load (`against` is 1) or lowers it (-1).
    fn mean_square(&self, asked: &HeatDemand, against: f64) -> f64 {
        let (static_nm, linear_nm) = (against * asked.static_nm, asked.linear_nm);
        let square = |share: f64, joint_nm: f64, own: f64| {
            let motor = self.at_motor(joint_nm) + own;
            share * motor * motor
        };
        let standing = self.driving * asked.static_nm;
        square(asked.shares.ramp_up, static_nm + linear_nm, self.own)
            + square(asked.shares.travel, static_nm, 0.0)
            + square(asked.shares.ramp_down, static_nm - linear_nm, -self.own)
            + asked.shares.rest * standing * standing
    }

    /// Torque of the motor, as a fraction of its continuous torque, for the torque `joint_nm` at the joint in the
    /// direction of motion. If that torque is negative, the joint drives the motor.
    fn at_motor(&self, joint_nm: f64) -> f64 {
        joint_nm * if joint_nm < 0.0 { self.driven } else { self.driving }
    }

    /// For each number, the smaller number of these and of `other`. The result is at least as good as both.
    pub(super) fn min(&self, other: &Self) -> Self {
        Self {
            driving: self.driving.min(other.driving),
            driven: self.driven.min(other.driven),
            own: self.own.min(other.own),
            stated: self.stated.min(other.stated),
        }
    }

    /// Whether each number is at most the same number of `other`, so that this motor passes whenever the other motor
    /// does.
    pub(super) fn covers(&self, other: &Self) -> bool {
        self.driving <= other.driving
            && self.driven <= other.driven
            && self.own <= other.own
            && self.stated <= other.stated
    }
}

/// Efficiency of a gear (1 is no loss). A direct drive has 1. `None` if the catalog leaves it blank.
pub(super) fn efficiency(gear: &Gear) -> Option<f64> {
    gear.efficiency.or((gear.kind == GearKind::Direct).then_some(1.0))
}

/// Inertia of the rotor, the stage and the gear's input, all referred to the motor's shaft \[kg m²\]. `None` if the
/// catalog leaves an inertia blank.
pub(super) fn input_inertia_kgm2(gear: &Gear, motor: &Motor, stage: &AskedStage) -> Option<f64> {
    let none = (gear.kind == GearKind::Direct).then_some(0.0);
    let at_gear_kgm2 = gear.inertia_input_kgm2.or(none)?;
    Some(motor.rotor_inertia_kgm2? + stage.inertia_kgm2 + at_gear_kgm2 / stage.ratio.powi(2))
}

/// The largest torque that a motor can give at every speed from rest up to `speed_rpm` \[N m\]. `None` if the catalog
/// states no peak torque.
pub(super) fn peak_nm(motor: &Motor, speed_rpm: f64) -> Option<f64> {
    let points: Vec<(f64, f64)> =
        motor.curve.iter().filter_map(|p| Some((p.speed_rpm, p.peak_torque_nm?))).collect();
    let passed = points.iter().filter(|(rpm, _)| *rpm <= speed_rpm).map(|(_, torque_nm)| *torque_nm);
    let least = on_curve(&points, speed_rpm).into_iter().chain(passed).reduce(f64::min);
    least.or(motor.peak_torque_nm)
}

/// Torque at `speed_rpm`, interpolated linearly between the points (speed \[rpm\], torque \[N m\]) of a curve. Beyond
/// the ends it is constant. `None` without points.
fn on_curve(points: &[(f64, f64)], speed_rpm: f64) -> Option<f64> {
    let (first, last) = (points.first()?, points.last()?);
    let between = points.windows(2).find(|pair| (pair[0].0..=pair[1].0).contains(&speed_rpm));
    Some(match between {
        Some(pair) => {
            let share = (speed_rpm - pair[0].0) / (pair[1].0 - pair[0].0);
            (1.0 - share) * pair[0].1 + share * pair[1].1
        }
        None if speed_rpm < first.0 => first.1,
        None => last.1,
    })
}

/// Torque that a motor gives continuously at a speed \[N m\]: from its torque curve, or else its rated torque. Beyond
/// the rated speed the rated torque is reduced so that the rated power is not exceeded. `None` if the catalog states
/// neither a curve nor a rated torque.
pub(super) fn continuous_nm(motor: &Motor, speed_rpm: f64) -> Option<f64> {
    let points: Vec<(f64, f64)> =
        motor.curve.iter().filter_map(|p| Some((p.speed_rpm, p.continuous_torque_nm?))).collect();
    if let Some(torque_nm) = on_curve(&points, speed_rpm) {
        return Some(torque_nm);
    }
    let beyond = motor.rated_speed_rpm.map_or(1.0, |rated_rpm| (speed_rpm / rated_rpm).max(1.0));
    Some(motor.rated_torque_nm? / beyond)
}

/// One phase of a stated duty: torque and acceleration at the joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StatedPhase {
    /// Duration of the phase, as a fraction of the duration of the whole duty.
    share: f64,
    torque_nm: f64,
    acceleration_rad_s2: f64,
}

/// The phases of a stated duty. With a brake, phases at rest need no motor torque and are left out.
pub(super) fn stated_phases(duty: &[AskedDutyPhase], has_brake: bool) -> Vec<StatedPhase> {
    let whole_s: f64 = duty.iter().map(|phase| phase.time_s).sum();
    let courses = courses(duty);
    let of_phase = |(place, phase): (usize, &AskedDutyPhase)| StatedPhase {
        share: phase.time_s / whole_s,
        torque_nm: phase.torque_nm,
        acceleration_rad_s2: courses[place].rpm_per_s() * PI / 30.0,
    };
    let moves = |(_, phase): &(usize, &AskedDutyPhase)| !has_brake || phase.speed_rpm != 0.0;
    duty.iter().enumerate().filter(moves).map(of_phase).collect()
}
