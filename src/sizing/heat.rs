//! Heat of a motor: the root mean square of its torque over the joint's cycle, against what it gives continuously.
//!
//! With T the static and T_lin the linear torque at the joint, the torque X at the output and that of the motor are
//!
//! | phase | X | motor |
//! |---|---|---|
//! | speeding up | T + T_lin | X / (N η) + J_in N α |
//! | at speed | T | X / (N η) |
//! | slowing down | T - T_lin | X / (N η) - J_in N α, or X η / N - J_in N α if X is negative: the load then drives |
//! | at rest | T | X / (N η); 0 if a brake holds the joint |
//!
//! Losses of the gear add to what the motor gives where it drives the load, and help it where it is driven. The cycle lifts
//! the load. Lowering it heats the motor less as long as the cycle slows down no longer than it speeds up, which
//! [`MotionRequirement::validate`](super::MotionRequirement::validate) demands. With s = T + T_lin, x = |T - T_lin| and
//! q = J_in N α, the squares of both ramps of a lift exceed those of a lowering by
//!
//! (s² ∓ x²)(1/η² - η²) / N² + 2 q (s - x)(1/η - η) / N ≥ 0,
//!
//! with - where T_lin is larger than T.
//!
//! *Every number counts one way.* Let the cycle slow down no longer than it speeds up. The mean square then grows with T,
//! with T_lin, and with each number of a [`MotorHeat`]: the phase of speeding up has the largest torque and rises at least
//! as fast as that of slowing down falls. So the demand of the least T and T_lin of a box of designs, on the least of each
//! number of a box of drives, is a lower bound for every member, and a drive that has no number larger than another holds
//! whatever the other holds. `tests` below hold this against random members, and against a motion simulated step by step.
//!
//! *Continuous torque.* It is that at the motor's speed while the joint cruises; [`motor_curve`] has it.
//!
//! Source of the rule (root mean square within the continuous torque): the selection guides of motor vendors, such as
//! Oriental Motor, "Motor Sizing Basics Part 3: Acceleration Torque (and RMS Torque)".

use super::demand::{JointDemand, JointMotion};
use super::drive::Drive;
use super::motor_curve;

/// What a motor behind its gear uses of its continuous torque T_c. A drive that holds more has smaller numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorHeat {
    /// Per torque at the joint that the motor drives: 1 / (N η T_c) \[1/(N m)\].
    pub driving_per_nm: f64,
    /// Per torque at the joint that drives the motor: η / (N T_c) \[1/(N m)\].
    pub driven_per_nm: f64,
    /// For its own inertia while the joint accelerates: J_in N α / T_c.
    pub own_share: f64,
    /// Mean square over the duty that the study states for the joint.
    pub stated_share_squared: f64,
}

impl MotorHeat {
    /// No torque heats the motor: the check is not made.
    pub const NONE: Self =
        Self { driving_per_nm: 0.0, driven_per_nm: 0.0, own_share: 0.0, stated_share_squared: 0.0 };

    /// The numbers of a drive under a motion.
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

    /// Mean square of the motor's torque over the cycle, as a share of the square of its continuous torque. The motor does
    /// not overheat up to 1.
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

    /// The largest factor on the torques of a demand at which the motor does not overheat; never less than the true one.
    /// The mean square at the factor k is A k² + 2 B k + C.
    pub(crate) fn multiple_of(&self, demand: &JointDemand) -> f64 {
        /// Rounding of the root is on the safe side by this much.
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

    /// The smaller of each number: of two drives, what the better one could have.
    pub(crate) fn least(&self, other: &Self) -> Self {
        self.each(other, f64::min)
    }

    /// The larger of each number.
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

    /// Whether no number is larger than that of another drive.
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
