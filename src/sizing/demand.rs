//! The demand on one joint: its motion, which the study fixes, and its torques, which follow from the masses outboard
//! (Eqs 8 and 12 of docs/model.md, cubic mean over the duty cycle). *The paper* is the source of these equations, named
//! in docs/model.md.

use super::bearing::BearingDemand;
use super::duty::{HeatWeights, MeanTorqueWeights};
use super::fit::{FitRequirement, LinkRoom};
use super::rpm_from_rad_s;
use super::stated::{StatedDemand, StatedDuty};
use crate::arm::transmission::Stage;
use crate::catalog::gear::Gear;

/// Two interpretations of Eq 8, the torque of linear acceleration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LinearReading {
    /// The sum of m a ρ² / r over the outboard bodies, which is the inertia about the axis times a / r.
    Exact,
    /// The paper's (a / g) T. It is zero for a vertical axis, because such an axis has no static torque.
    Paper,
}

/// The emergency stop of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// Deceleration of the joint that follows from the stop of the tip which the study states \[rad/s²\]; `None` if the
    /// study states none, and the deceleration is then twice that of the ramps.
    pub stated_rad_s2: Option<f64>,
    /// Factor on the linear torque in the checks of an emergency stop: emergency deceleration divided by the
    /// acceleration of a ramp, but at least 1. So a drive that passes these checks also passes every ramp of the cycle,
    /// even where a gentle stop is stated.
    pub factor: f64,
    /// Duration of the stop divided by the ramp time.
    pub ramps: f64,
}

impl Stop {
    /// The stop of a joint whose ramps have the acceleration `acceleration_rad_s2`.
    pub(super) fn new(stated_rad_s2: Option<f64>, acceleration_rad_s2: f64) -> Self {
        let ratio = match stated_rad_s2 {
            // a joint that never moves needs no stop
            Some(stated_rad_s2) if acceleration_rad_s2 > 0.0 => stated_rad_s2 / acceleration_rad_s2,
            _ => 2.0,
        };
        Self { stated_rad_s2, factor: ratio.max(1.0), ramps: 1.0 / ratio }
    }

    /// This stop with all decelerations and accelerations multiplied by `factor`.
    fn times(self, factor: f64) -> Self {
        Self { stated_rad_s2: self.stated_rad_s2.map(|stated| stated * factor), ..self }
    }
}

/// The motion of one joint. It follows from the study and the geometry; masses do not change it.
///
/// [`MotionRequirement::joint_motion`](super::MotionRequirement::joint_motion) is the usual source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointMotion {
    /// Largest speed ω, output side \[rad/s\].
    pub speed_rad_s: f64,
    /// Acceleration α, output side \[rad/s²\].
    pub acceleration_rad_s2: f64,
    /// Ramp time t_a \[s\].
    pub ramp_time_s: f64,
    /// Ratio of tip acceleration to gravity, a / g. Only the paper's reading of Eq 8 uses it.
    pub acceleration_over_gravity: f64,
    /// Which interpretation of Eq 8 is used.
    pub linear_reading: LinearReading,
    /// The emergency stop of the joint.
    pub stop: Stop,
    /// Ratio of the mean speed over the duty cycle to the largest speed ω.
    pub mean_speed_fraction: f64,
    /// Weights of the terms of the cubic mean torque.
    pub mean_torque: MeanTorqueWeights,
    /// Required life, L10 \[h\].
    pub life_h: f64,
    /// Weights of the squared torques in the root mean square of the motor's torque.
    pub heat: HeatWeights,
    /// Whether heating of the motor is checked.
    pub checks_motor_heat: bool,
    /// Whether a brake holds the joint at rest.
    pub has_brake: bool,
    /// Torques of a duty that the study states for this joint; `None` if it states none.
    pub stated: Option<StatedDemand>,
    /// Number of emergency stops that the gear must withstand in its life; `None` if the study states none.
    pub emergency_stops: Option<f64>,
    /// Limits that the study sets to the sizes of the parts.
    pub fit: FitRequirement,
}

impl JointMotion {
    /// This motion, adapted to a joint that has a brake or a duty of its own.
    ///
    /// A stated duty replaces the duty cycle of the study: mean torque, mean speed and motor heat follow from its
    /// phases. Its steepest ramp sets the acceleration. The speed of the joint is the largest speed of the duty, or
    /// `max_speed_rad_s` \[rad/s\] if that is larger; without a duty this number has no effect here. With a brake the motor
    /// needs no torque at rest. An emergency stop that the study states keeps its deceleration.
    pub fn of_joint(self, max_speed_rad_s: Option<f64>, has_brake: bool, duty: Option<&StatedDuty>) -> Self {
        let mut motion = Self { has_brake, ..self };
        if has_brake {
            motion.heat.standing = 0.0;
        }
        let Some(duty) = duty else { return motion };
        let speed_rad_s = max_speed_rad_s.unwrap_or(0.0).max(duty.fastest_rad_s());
        let ramp_time_s = duty.ramp_time_s(self.ramp_time_s);
        let acceleration_rad_s2 = speed_rad_s / ramp_time_s;
        Self {
            speed_rad_s,
            acceleration_rad_s2,
            ramp_time_s,
            stop: Stop::new(self.stop.stated_rad_s2, acceleration_rad_s2),
            mean_speed_fraction: duty.mean_speed_rpm() / rpm_from_rad_s(speed_rad_s),
            mean_torque: MeanTorqueWeights::NONE,
            heat: HeatWeights::default(),
            stated: Some(duty.demand(has_brake)),
            ..motion
        }
    }

    /// This motion without the duty that the study states in numbers, whose torques are the same for every arm. The
    /// demand that remains is proportional to static torque and inertia.
    pub(crate) fn without_stated(self) -> Self {
        Self { stated: None, ..self }
    }

    /// Duration of an emergency stop from the largest speed of the joint to rest \[s\].
    pub fn stop_time_s(&self) -> f64 {
        self.ramp_time_s * self.stop.ramps
    }

    /// Mean speed of the joint over the duty cycle, on the output side of the gear \[rad/s\].
    pub fn mean_speed_rad_s(&self) -> f64 {
        self.speed_rad_s * self.mean_speed_fraction
    }

    /// This motion with `linear_reading` as the reading of Eq 8. A joint with a vertical axis needs the exact reading,
    /// because it has no static torque.
    pub fn with_linear_reading(self, linear_reading: LinearReading) -> Self {
        Self { linear_reading, ..self }
    }

    /// This motion with speed, acceleration and emergency deceleration multiplied by `factor`. The ramp time stays.
    pub fn slowed(self, factor: f64) -> Self {
        Self {
            speed_rad_s: self.speed_rad_s * factor,
            acceleration_rad_s2: self.acceleration_rad_s2 * factor,
            acceleration_over_gravity: self.acceleration_over_gravity * factor,
            stop: self.stop.times(factor),
            stated: self.stated.map(|stated| stated.slowed(factor)),
            ..self
        }
    }

    /// This motion with every torque of the duty that the study states for the joint multiplied by `factor`.
    pub(super) fn with_torques_times(self, factor: f64) -> Self {
        Self { stated: self.stated.map(|stated| stated.with_torques_times(factor)), ..self }
    }

    /// The motion at the input of `stage`, whose output turns with this motion.
    pub(crate) fn before(self, stage: &Stage) -> Self {
        Self {
            speed_rad_s: self.speed_rad_s * stage.ratio,
            acceleration_rad_s2: self.acceleration_rad_s2 * stage.ratio,
            stop: self.stop.times(stage.ratio),
            stated: self.stated.map(|stated| stated.before(stage)),
            ..self
        }
    }

    /// The demand on a joint with this motion (Eq 8).
    ///
    /// `static_torque_nm` is the static torque of Eq 7 \[N m\]; its sign does not matter. `outboard_inertia_kgm2` is
    /// the inertia of everything outboard about the axis \[kg m²\].
    ///
    /// ```
    /// use armwright::sizing::MotionRequirement;
    ///
    /// // a joint whose tip is 1.35 m away, under the default motion: 1 m/s within 0.20 s
    /// let motion = MotionRequirement::default().joint_motion(1.35, None);
    /// let demand = motion.demand(100.0, 12.0);
    /// assert!((demand.linear_torque_nm - 12.0 * 5.0 / 1.35).abs() < 1e-9, "inertia times acceleration");
    /// assert!((demand.peak_torque_nm() - (100.0 + demand.linear_torque_nm)).abs() < 1e-9);
    /// assert!((demand.stop_torque_nm - (100.0 + 2.0 * demand.linear_torque_nm)).abs() < 1e-9);
    /// ```
    #[inline]
    pub fn demand(&self, static_torque_nm: f64, outboard_inertia_kgm2: f64) -> JointDemand {
        let linear_torque_nm = linear_torque_nm(self, static_torque_nm, outboard_inertia_kgm2);
        self.demand_of_torques(static_torque_nm, linear_torque_nm)
    }

    /// Largest torque \[N m\] and cube of the mean torque \[(N m)³\] of the duty that the study states for the joint.
    /// Both are 0 if it states none.
    #[inline]
    pub(super) fn stated_torques(&self) -> [f64; 2] {
        self.stated.map_or([0.0; 2], |stated| [stated.peak_torque_nm, stated.mean_torque_cubed_nm3])
    }

    /// The demand on a joint with this motion, whose static and linear torque \[N m\] are known. The signs of the
    /// torques do not matter.
    #[inline]
    pub fn demand_of_torques(&self, static_torque_nm: f64, linear_torque_nm: f64) -> JointDemand {
        let static_torque_nm = static_torque_nm.abs();
        let linear_torque_nm = linear_torque_nm.abs();
        let stop_nm = stop_torque_nm(static_torque_nm, linear_torque_nm, self.stop.factor);
        let cubed_nm3 = cubic_mean_cubed_nm3(self.mean_torque, static_torque_nm, linear_torque_nm);
        let [stated_peak_nm, stated_cubed_nm3] = self.stated_torques();
        JointDemand {
            static_torque_nm,
            linear_torque_nm,
            stop_torque_nm: stop_nm.max(stated_peak_nm),
            mean_torque_cubed_nm3: cubed_nm3 + stated_cubed_nm3,
            bearing: BearingDemand::default(),
            room: LinkRoom::ANY,
            stated_peak_nm,
            heat_weights: self.heat,
        }
    }
}

/// The torques on one joint, on the output side of the gear. None of them is negative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointDemand {
    /// Largest static torque over the sizing cases (in which drives and stresses are checked), Eq 7 \[N m\].
    pub static_torque_nm: f64,
    /// Torque of linear acceleration, Eq 8 \[N m\].
    pub linear_torque_nm: f64,
    /// Static torque plus the torque of the emergency stop \[N m\].
    pub stop_torque_nm: f64,
    /// Cube of the cubic mean torque over the duty cycle \[(N m)³\]. The cube is stored because a search then needs
    /// no cube root.
    pub mean_torque_cubed_nm3: f64,
    /// Loads on the output bearing; all zero if the bearing is not to be checked.
    pub bearing: BearingDemand,
    /// Largest widths of gear and motor for which the link outboard of this joint leaves room.
    pub room: LinkRoom,
    /// Largest torque of a duty that the study states for the joint \[N m\]; 0 without one.
    pub stated_peak_nm: f64,
    /// Weights of the squared torques in the root mean square of the motor's torque.
    pub heat_weights: HeatWeights,
}

impl JointDemand {
    /// Largest torque that the gear transmits in the cycle \[N m\]: T + T_lin while the joint accelerates, or the
    /// largest torque of a stated duty if that is larger.
    #[inline]
    pub fn peak_torque_nm(&self) -> f64 {
        (self.static_torque_nm + self.linear_torque_nm).max(self.stated_peak_nm)
    }

    /// The demand at the input of `stage`, whose output meets this demand. `motion` is the motion at the input. A stage
    /// divides torques by its ratio and its efficiency, and its own inertia takes torque too.
    pub(crate) fn before(self, stage: &Stage, motion: &JointMotion) -> Self {
        let gain = stage.ratio * stage.efficiency;
        let own_nm = stage.inertia_kgm2 * motion.acceleration_rad_s2;
        let at_input =
            motion.demand_of_torques(self.static_torque_nm / gain, self.linear_torque_nm / gain + own_nm);
        at_input.with_bearing(self.bearing).with_room(self.room)
    }

    /// This demand with the weights of the motor's heat multiplied by `factor`. Callers use a factor near 1, so that a
    /// comparison does not depend on rounding.
    pub(crate) fn with_heat_times(self, factor: f64) -> Self {
        Self { heat_weights: self.heat_weights.times(factor), ..self }
    }

    /// Cubic mean torque over the duty cycle \[N m\].
    pub fn mean_torque_nm(&self) -> f64 {
        libm::cbrt(self.mean_torque_cubed_nm3)
    }

    /// This demand with `bearing` as the loads on the output bearing.
    pub fn with_bearing(self, bearing: BearingDemand) -> Self {
        Self { bearing, ..self }
    }

    /// This demand with `room` as the largest widths of gear and motor.
    pub fn with_room(self, room: LinkRoom) -> Self {
        Self { room, ..self }
    }

    /// This demand with every torque, force and moment multiplied by `factor`.
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            static_torque_nm: self.static_torque_nm * factor,
            linear_torque_nm: self.linear_torque_nm * factor,
            stop_torque_nm: self.stop_torque_nm * factor,
            mean_torque_cubed_nm3: self.mean_torque_cubed_nm3 * factor.powi(3),
            bearing: self.bearing.scaled(factor),
            stated_peak_nm: self.stated_peak_nm * factor,
            ..self
        }
    }
}

/// Torque of linear acceleration at the joint \[N m\] (Eq 8).
///
/// - Exact reading: T_lin = Σ m a ρ² / r = I α, where I is the inertia of everything outboard about the axis.
/// - The paper's reading: T_lin = (a / g) T, as if every mass accelerated like the tip. It is 0.5097 T, printed as
///   T / 2.
#[inline]
pub fn linear_torque_nm(motion: &JointMotion, static_torque_nm: f64, outboard_inertia_kgm2: f64) -> f64 {
    match motion.linear_reading {
        LinearReading::Exact => outboard_inertia_kgm2 * motion.acceleration_rad_s2,
        LinearReading::Paper => motion.acceleration_over_gravity * static_torque_nm.abs(),
    }
}

/// Torque in an emergency stop \[N m\]: T + (a_stop / a) T_lin. `stop_factor` is a_stop / a, the ratio of emergency
/// deceleration to normal acceleration.
#[inline]
pub fn stop_torque_nm(static_torque_nm: f64, linear_torque_nm: f64, stop_factor: f64) -> f64 {
    static_torque_nm + stop_factor * linear_torque_nm
}

/// Cube of the cubic mean torque over a duty cycle \[(N m)³\]: T_mean³ = Σ |T_i|³ n_i t_i / Σ n_i t_i (Eq 18.2 of the
/// vendor). `weights` are the weights of the cycle's terms.
#[inline]
pub fn cubic_mean_cubed_nm3(weights: MeanTorqueWeights, static_torque_nm: f64, linear_torque_nm: f64) -> f64 {
    let cube = |x: f64| x * x * x;
    weights.sum * cube(static_torque_nm + linear_torque_nm)
        + weights.steady * cube(static_torque_nm)
        + weights.difference * cube((static_torque_nm - linear_torque_nm).abs())
}

/// Largest input speed of the gear, N ω \[rpm\].
pub(super) fn input_speed_rpm(gear: &Gear, motion: &JointMotion) -> f64 {
    gear.ratio * rpm_from_rad_s(motion.speed_rad_s)
}

/// Mean input speed of the gear over the duty cycle, N times the mean speed of the joint \[rpm\].
pub(super) fn mean_input_speed_rpm(gear: &Gear, motion: &JointMotion) -> f64 {
    gear.ratio * rpm_from_rad_s(motion.mean_speed_rad_s())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sizing::requirement::MotionRequirement;

    fn paper() -> MotionRequirement {
        MotionRequirement { linear_reading: LinearReading::Paper, ..Default::default() }
    }

    #[test]
    fn paper_reading_of_equation_8_is_0_5097_of_the_static_torque() {
        let demand = paper().joint_motion(1.35, None).demand(568.3, 0.0);
        assert!((demand.linear_torque_nm / 568.3 - 0.5097).abs() < 1e-4 / 2.0);
        assert!((demand.peak_torque_nm() - 568.3 * 1.509684).abs() < 1e-3);
    }

    #[test]
    fn both_readings_agree_for_a_point_mass_at_the_tip_held_out_level() {
        let (mass_kg, reach_m) = (5.0, 1.35);
        let static_nm = mass_kg * 9.81 * reach_m;
        let exact = MotionRequirement::default().joint_motion(reach_m, None);
        let a = exact.demand(static_nm, mass_kg * reach_m * reach_m);
        let b = exact.with_linear_reading(LinearReading::Paper).demand(static_nm, f64::NAN);
        assert!((a.linear_torque_nm - b.linear_torque_nm).abs() < 1e-12 * a.linear_torque_nm);
    }

    #[test]
    fn a_vertical_axis_has_linear_torque_only_in_the_exact_reading() {
        let motion = paper().joint_motion(1.35, None);
        assert_eq!(motion.demand(0.0, 10.0).linear_torque_nm, 0.0);
        let exact = motion.with_linear_reading(LinearReading::Exact).demand(0.0, 10.0);
        assert!((exact.linear_torque_nm - 10.0 * 5.0 / 1.35).abs() < 1e-12);
        assert_eq!(exact.stop_torque_nm, 2.0 * exact.linear_torque_nm);
    }

    #[test]
    fn the_mean_torque_is_the_vendors_cubic_mean_written_out() {
        let motion = MotionRequirement::default().joint_motion(1.0, None);
        let demand = motion.demand_of_torques(100.0, 40.0);
        // Σ |T|³ n t / Σ n t in units of t_a: ramps at half speed, 3 t_a at full speed.
        let sum = 140f64.powi(3) * 0.5 + 100f64.powi(3) * 3.0 + 60f64.powi(3) * 0.5;
        assert!((demand.mean_torque_nm() - libm::cbrt(sum / 4.0)).abs() < 1e-10);
    }

    #[test]
    fn the_sign_of_the_static_torque_does_not_matter() {
        let motion = MotionRequirement::default().joint_motion(1.0, None);
        assert_eq!(motion.demand(-50.0, 3.0), motion.demand(50.0, 3.0));
    }

    #[test]
    fn scaling_a_demand_is_the_same_as_scaling_its_inputs() {
        let motion = MotionRequirement::default().joint_motion(1.0, None);
        let a = motion.demand_of_torques(100.0, 40.0).scaled(0.5);
        let b = motion.demand_of_torques(50.0, 20.0);
        assert!((a.mean_torque_nm() - b.mean_torque_nm()).abs() < 1e-12);
        assert_eq!(a.stop_torque_nm, b.stop_torque_nm);
    }
}
