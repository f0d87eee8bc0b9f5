//! Heating of a motor: the root mean square of its torque over the joint's cycle must not exceed its continuous
//! torque.
//!
//! With T the static and T_lin the linear torque at the joint, the torque X at the output and the torque of the motor
//! are
//!
//! | phase | X | motor |
//! |---|---|---|
//! | speeding up | T + T_lin | X / (N η) + J_in N α |
//! | at speed | T | X / (N η) |
//! | slowing down | T - T_lin | X / (N η) - J_in N α; if X < 0 (the load drives the motor), X η / N - J_in N α |
//! | at rest | T | X / (N η); 0 if a brake holds the joint |
//!
//! Losses of the gear add to the torque of the motor where the motor drives the load, and reduce it where the load
//! drives the motor. The cycle is taken as a lift of the load. Lowering heats the motor less, provided that the cycle
//! slows down no longer than it speeds up; [`MotionRequirement::validate`](super::MotionRequirement::validate)
//! demands this. With s = T + T_lin, x = |T - T_lin| and q = J_in N α, the sum of the squared motor torques of the two
//! ramps is larger in a lift than in a lowering by
//!
//! (s² ∓ x²)(1/η² - η²) / N² + 2 q (s - x)(1/η - η) / N ≥ 0.
//!
//! The first sign is - where T_lin is larger than T, else +.
//!
//! *Monotonicity.* If the cycle slows down no longer than it speeds up, the mean square grows with T, with T_lin, and
//! with each number of a [`MotorHeat`]. The reason: speeding up takes the largest torque, and its square rises at least
//! as fast as the square of the torque of slowing down falls. Two things follow. The least T and T_lin of a box of
//! designs, together with the least numbers of a box of drives, give a lower bound for every member. And a drive that
//! has no number larger than another drive passes wherever the other passes. The `tests` check this against random
//! members, and against a motion simulated step by step.
//!
//! *Continuous torque.* It is taken at the motor's speed while the joint cruises, see [`motor_curve`].
//!
//! Source of the rule (root mean square within the continuous torque): the selection guides of motor vendors, such as
//! Oriental Motor, "Motor Sizing Basics Part 3: Acceleration Torque (and RMS Torque)".

use super::demand::{JointDemand, JointMotion};
use super::drive::Drive;
use super::motor_curve;

/// Numbers of a drive from which the ratio of the motor's torque to its continuous torque T_c follows for any demand.
/// The smaller the numbers, the larger the demand that the drive meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorHeat {
    /// Where the motor drives the load: ratio of motor torque to T_c for each newton metre at the joint, 1 / (N η T_c)
    /// \[1/(N m)\].
    pub driving_per_nm: f64,
    /// Where the load drives the motor: ratio of motor torque to T_c for each newton metre at the joint, η / (N T_c)
    /// \[1/(N m)\].
    pub driven_per_nm: f64,
    /// Ratio to T_c of the torque that accelerates rotor and gear input while the joint accelerates: J_in N α / T_c.
    pub own_share: f64,
    /// Mean square of the ratio of motor torque to T_c over the duty that the study states for the joint; 0 without
    /// such a duty.
    pub stated_share_squared: f64,
}

impl MotorHeat {
    /// All numbers are zero, for a study that does not check heating of motors.
    pub const NONE: Self =
        Self { driving_per_nm: 0.0, driven_per_nm: 0.0, own_share: 0.0, stated_share_squared: 0.0 };

    /// The numbers of `drive` in a joint with the motion `motion`. The error is the name of a rating that is needed and
    /// blank.
    pub(super) fn of(drive: &Drive, motion: &JointMotion) -> Result<Self, super::MissingRating> {
        if !motion.checks_motor_heat {
            return Ok(Self::NONE);
        }
        let continuous_nm = motor_curve::continuous_torque_nm(drive.motor, drive.motor_speed_rpm(motion))?;
        let (ratio, efficiency) = (drive.ratio(), drive.efficiency()?);
        let heat = Self {
            driving_per_nm: 1.0 / (ratio * efficiency * continuous_nm),
            driven_per_nm: efficiency / (ratio * continuous_nm),
            own_share: drive.rotary_torque_motor_nm(motion)? / continuous_nm,
            stated_share_squared: 0.0,
        };
        let inertia_s2 = drive.input_inertia_kgm2()? * ratio / continuous_nm;
        let stated = motion.stated.map_or(0.0, |stated| {
            stated.heat.share_squared([heat.driving_per_nm, heat.driven_per_nm], inertia_s2)
        });
        Ok(Self { stated_share_squared: stated, ..heat })
    }

    /// Mean square of the motor's torque over the cycle under `demand`, divided by the square of its continuous torque.
    /// The motor passes if it is at most 1.
    #[inline]
    pub fn share_squared(&self, demand: &JointDemand) -> f64 {
        let (statically, linear, weights) =
            (demand.static_torque_nm, demand.linear_torque_nm, &demand.heat_weights);
        let up = (statically + linear) * self.driving_per_nm + self.own_share;
        let steady = statically * self.driving_per_nm;
        let down = (statically - linear).max(0.0) * self.driving_per_nm
            - (linear - statically).max(0.0) * self.driven_per_nm
            - self.own_share;
        self.stated_share_squared
            + weights.sum * (up * up)
            + (weights.steady + weights.standing) * (steady * steady)
            + weights.difference * (down * down)
    }

    /// The largest factor on the torques of `demand` with which the motor passes. The result may be too large by
    /// rounding, but never too small. With the factor k, the mean square of the torque ratio is A k² + 2 B k + C.
    pub(crate) fn multiple_of(&self, demand: &JointDemand) -> f64 {
        /// Relative allowance for rounding of the root.
        const ALLOWANCE: f64 = 1e-12;
        let (statically, linear, weights) =
            (demand.static_torque_nm, demand.linear_torque_nm, &demand.heat_weights);
        let up = (statically + linear) * self.driving_per_nm;
        let steady = statically * self.driving_per_nm;
        let down = (statically - linear).max(0.0) * self.driving_per_nm
            - (linear - statically).max(0.0) * self.driven_per_nm;
        let a = weights.sum * up * up
            + (weights.steady + weights.standing) * steady * steady
            + weights.difference * down * down;
        let b = self.own_share * (weights.sum * up - weights.difference * down);
        let own = (weights.sum + weights.difference) * self.own_share * self.own_share;
        let left = 1.0 + ALLOWANCE - own - self.stated_share_squared;
        match (left < 0.0, a > 0.0) {
            (true, _) => 0.0,
            (false, false) => f64::INFINITY,
            (false, true) => left / (b + (b * b + a * left).sqrt()),
        }
    }

    /// The smaller of the numbers of this drive and of `other`, one by one. If one of the two drives passes under a
    /// demand, a drive with these numbers passes too.
    pub(crate) fn least(&self, other: &Self) -> Self {
        self.each(other, f64::min)
    }

    /// The larger of the numbers of this drive and of `other`, one by one. A drive with these numbers passes only where
    /// both drives pass.
    pub(crate) fn greatest(&self, other: &Self) -> Self {
        self.each(other, f64::max)
    }

    fn each(&self, other: &Self, pick: fn(f64, f64) -> f64) -> Self {
        Self {
            driving_per_nm: pick(self.driving_per_nm, other.driving_per_nm),
            driven_per_nm: pick(self.driven_per_nm, other.driven_per_nm),
            own_share: pick(self.own_share, other.own_share),
            stated_share_squared: pick(self.stated_share_squared, other.stated_share_squared),
        }
    }

    /// Whether no number of this drive is larger than the same number of `other`. This drive then passes wherever
    /// `other` does.
    #[inline]
    pub(crate) fn covers(&self, other: &Self) -> bool {
        (self.driving_per_nm <= other.driving_per_nm)
            & (self.driven_per_nm <= other.driven_per_nm)
            & (self.own_share <= other.own_share)
            & (self.stated_share_squared <= other.stated_share_squared)
    }
}

#[cfg(test)]
#[path = "heat_tests.rs"]
mod tests;
