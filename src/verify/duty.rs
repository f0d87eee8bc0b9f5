//! The motion of one joint, and the torques that its drive must provide (Eqs 8 and 10 of docs/model.md).
//!
//! A `Duty` follows from the question and the geometry alone. Torque and inertia enter when a demand is computed
//! from it.

use super::bearing::BearingDemand;
use super::courses::{courses, is_same_speed};
use super::demand::{Demand, QUANTITIES, Quantity};
use super::fit::ANY_WIDTH;
use super::heat::{CycleShares, HeatDemand, StatedPhase, stated_phases};
use super::question::{
    AskedDutyPhase, AskedFit, AskedJoint, AskedMotion, AskedPhase, AskedPhaseKind, AskedStage, LinearTorque,
};
use std::f64::consts::PI;

/// What the study asks of the drive of one joint: the motion on the output side of the gear, the life, the emergency
/// stops, the brake and the limits on sizes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Duty {
    /// Largest speed of the joint \[rad/s\].
    pub speed_rad_s: f64,
    /// Mean speed of the joint over the cycle, rests included \[rad/s\].
    pub mean_speed_rad_s: f64,
    /// Acceleration of the joint in a ramp \[rad/s²\].
    pub acceleration_rad_s2: f64,
    /// Required life of the gear \[h\].
    pub life_h: f64,
    /// Torque of linear acceleration for each kg m² of inertia \[rad/s²\]. It is zero if the study computes this torque
    /// from the static torque: Eq 8 can be read in either way.
    linear_per_inertia: f64,
    /// Torque of linear acceleration for each N m of static torque. It is zero if the study computes this torque from
    /// the inertia.
    linear_per_static: f64,
    /// Torque of linear acceleration in an emergency stop, divided by the torque of linear acceleration in a ramp.
    pub stop_factor: f64,
    mean: MeanTorque,
    /// Duration of an emergency stop \[s\].
    pub stop_s: f64,
    /// Number of emergency stops that the gear must survive; `None` if the study asks for none.
    pub emergency_stops: Option<f64>,
    /// Whether a brake holds the joint at rest.
    pub has_brake: bool,
    /// The stage between motor and gear.
    pub stage: AskedStage,
    /// Limits on the sizes of gear and motor.
    pub fit: AskedFit,
    /// Whether the motor's heat is checked.
    pub checks_heat: bool,
    shares: CycleShares,
    /// The part of the duty that the study states in numbers. It does not depend on the arm.
    pub stated: Stated,
}

/// The part of a joint's torques that follows from a duty stated in numbers. All zero and without phases if none is
/// stated.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Stated {
    /// Largest torque of the stated phases \[N m\].
    peak_nm: f64,
    /// Cube of the cubic mean torque \[(N m)³\].
    cubed_nm3: f64,
    pub phases: Vec<StatedPhase>,
}

/// Weights of three terms in the cube of the cubic mean torque. The terms are the cubes of static plus linear
/// torque, of static torque, and of static minus linear torque.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct MeanTorque {
    of_sum: f64,
    of_static: f64,
    of_difference: f64,
}

/// Ratio of the deceleration in an emergency stop to the acceleration in a ramp. `at_tip_m_s2` is the acceleration of
/// the tip in a ramp of the joint or rail \[m/s²\].
pub(super) fn stop_ratio(motion: &AskedMotion, at_tip_m_s2: f64) -> f64 {
    match motion.emergency_deceleration_m_s2 {
        Some(stop_m_s2) if at_tip_m_s2 > 0.0 => stop_m_s2 / at_tip_m_s2,
        _ => 2.0,
    }
}

impl Duty {
    /// The motion of `joint` that follows from the motion of the tip. `reach_m` is the largest distance of the tip from
    /// the joint's axis \[m\].
    pub(super) fn new(motion: &AskedMotion, reach_m: f64, joint: &AskedJoint) -> Self {
        let speed_rad_s = speed_rad_s(motion, reach_m, joint);
        let ramp_s = ramp_s(&joint.duty, motion.ramp_time_s);
        let acceleration_rad_s2 = speed_rad_s / ramp_s;
        let tip_m_s2 = motion.tip_acceleration_m_s2();
        let lever_m = reach_m.max(motion.min_lever_m);
        let stop_ratio = stop_ratio(motion, lever_m * acceleration_rad_s2);
        let (linear_per_inertia, linear_per_static) = match motion.linear_torque {
            LinearTorque::OfInertia => (acceleration_rad_s2, 0.0),
            LinearTorque::OfStaticTorque => (0.0, tip_m_s2 / motion.gravity_m_s2),
        };
        let duty = Self {
            speed_rad_s,
            mean_speed_rad_s: speed_rad_s * motion.mean_speed_fraction(),
            acceleration_rad_s2,
            life_h: motion.life_h,
            linear_per_inertia,
            linear_per_static,
            // The factor is at least 1, so that the demand in a stop is never less than the demand in a ramp.
            stop_factor: stop_ratio.max(1.0),
            mean: motion.mean_torque(),
            stop_s: ramp_s / stop_ratio,
            emergency_stops: motion.emergency_stops,
            has_brake: joint.has_brake,
            stage: joint.stage,
            fit: joint.fit,
            checks_heat: motion.checks_motor_heat,
            shares: motion.shares(joint.has_brake),
            stated: Stated::default(),
        };
        if joint.duty.is_empty() { duty } else { duty.with_stated(&joint.duty) }
    }

    /// This motion with the duty `duty`, which the study states in numbers, in place of the study's cycle.
    fn with_stated(self, duty: &[AskedDutyPhase]) -> Self {
        let travel = |phase: &AskedDutyPhase| phase.speed_rpm * phase.time_s;
        let whole_s: f64 = duty.iter().map(|phase| phase.time_s).sum();
        let travelled: f64 = duty.iter().map(travel).sum();
        let cubes = duty.iter().map(|phase| travel(phase) * phase.torque_nm.abs().powi(3));
        let stated = Stated {
            peak_nm: duty.iter().map(|phase| phase.torque_nm.abs()).fold(0.0, f64::max),
            cubed_nm3: cubes.sum::<f64>() / travelled,
            phases: stated_phases(duty, self.has_brake),
        };
        Self {
            mean_speed_rad_s: travelled / whole_s * PI / 30.0,
            mean: MeanTorque::default(),
            shares: CycleShares::default(),
            stated,
            ..self
        }
    }

    /// The demand on a drive that follows from a static torque \[N m\] and an inertia outboard \[kg m²\]: torques and
    /// motor heat, without any load on the bearing. Both grow with the torque and the inertia (see
    /// [`AskedMotion::grows`]). `heat_room` multiplies the heat and is a margin for rounding.
    pub(super) fn demand(&self, static_nm: f64, inertia_kgm2: f64, heat_room: f64) -> Demand {
        let static_nm = static_nm.abs();
        let linear_nm = (self.linear_per_inertia * inertia_kgm2 + self.linear_per_static * static_nm).abs();
        let cube = |nm: f64| nm * nm * nm;
        let mut torques = [0.0; QUANTITIES];
        torques[Quantity::Static as usize] = static_nm;
        torques[Quantity::Peak as usize] = (static_nm + linear_nm).max(self.stated.peak_nm);
        torques[Quantity::Stop as usize] =
            (static_nm + self.stop_factor * linear_nm).max(self.stated.peak_nm);
        torques[Quantity::MeanCubed as usize] = self.stated.cubed_nm3
            + self.mean.of_sum * cube(static_nm + linear_nm)
            + self.mean.of_static * cube(static_nm)
            + self.mean.of_difference * cube((static_nm - linear_nm).abs());
        let heat = HeatDemand { static_nm, linear_nm, shares: self.shares, room: heat_room };
        Demand { torques, bearing: BearingDemand::default(), heat, room: ANY_WIDTH }
    }
}

/// Largest speed of a joint \[rad/s\]. It is the maximum that the study states for the joint, or else the speed of the
/// tip divided by the lever `reach_m`. The lever is taken as at least `min_lever_m`, because a short lever would give a
/// roll joint an absurd speed. If the study states a duty of the joint in numbers, the speed of the tip is not used.
/// The result is then at least the largest speed of this duty.
fn speed_rad_s(motion: &AskedMotion, reach_m: f64, joint: &AskedJoint) -> f64 {
    let fastest_rpm = joint.duty.iter().map(|phase| phase.speed_rpm).fold(0.0, f64::max);
    match (joint.max_speed_rad_s, joint.duty.is_empty()) {
        (None, true) => motion.tip_speed_m_s / reach_m.max(motion.min_lever_m),
        (stated, _) => stated.unwrap_or(0.0).max(fastest_rpm * PI / 30.0),
    }
}

/// Time in which a joint with a duty stated in numbers would reach its largest speed, if its speed always changed as
/// fast as in the steepest ramp of the duty \[s\]. A jump from one speed to another counts as a ramp that takes
/// `jump_s` \[s\]. If the speed never changes, the result is `jump_s`.
fn ramp_s(duty: &[AskedDutyPhase], jump_s: f64) -> f64 {
    let courses = courses(duty);
    let next = courses.iter().cycle().skip(1);
    let jumps = courses.iter().zip(next).map(|(now, next)| match is_same_speed(now.to_rpm, next.from_rpm) {
        true => 0.0,
        false => (next.from_rpm - now.to_rpm).abs() / jump_s,
    });
    let rates =
        courses.iter().map(|course| course.rpm_per_s().abs().max(course.change_at_once_rpm() / jump_s));
    let steepest_rpm_s = rates.chain(jumps).fold(0.0, f64::max);
    let fastest_rpm = duty.iter().map(|phase| phase.speed_rpm).fold(0.0, f64::max);
    if steepest_rpm_s > 0.0 { fastest_rpm / steepest_rpm_s } else { jump_s }
}

impl AskedMotion {
    /// Acceleration of the tip in a ramp \[m/s²\].
    pub(super) fn tip_acceleration_m_s2(&self) -> f64 {
        self.tip_speed_m_s / self.ramp_time_s
    }

    /// Whether every torque of a demand and the motor's heat grow, or stay the same, if static torque or inertia grows.
    /// The linear torque (due to linear acceleration) is subtracted from the static torque only while the joint slows
    /// down. If the joint speeds up for at least as long as it slows down, speeding up outweighs this decrease. The
    /// motor then has its largest torque of the cycle while the joint speeds up. That torque grows at least as fast as
    /// any other torque decreases.
    pub fn grows(&self) -> bool {
        let mean = self.mean_torque();
        mean.of_difference <= mean.of_sum
    }

    fn travel_s(&self) -> f64 {
        self.phases.iter().map(AskedPhase::travel_s).sum()
    }

    /// Fractions of the cycle's time that its kinds of phases take. A phase with a stated fraction of the static torque
    /// is weighted with the square of this fraction.
    fn shares(&self, has_brake: bool) -> CycleShares {
        let whole_s: f64 = self.phases.iter().map(|phase| phase.duration_s).sum();
        let mut shares = CycleShares::default();
        for phase in &self.phases {
            let (share, square) = match phase.kind {
                AskedPhaseKind::Accelerate => (&mut shares.ramp_up, 1.0),
                AskedPhaseKind::Constant => (&mut shares.travel, 1.0),
                AskedPhaseKind::Decelerate => (&mut shares.ramp_down, 1.0),
                AskedPhaseKind::Rest => (&mut shares.rest, 1.0),
                AskedPhaseKind::Fraction { of_static_torque, of_speed } => {
                    let moves = of_speed != 0.0;
                    (if moves { &mut shares.travel } else { &mut shares.rest }, of_static_torque.powi(2))
                }
            };
            *share += square * phase.duration_s / whole_s;
        }
        if has_brake {
            shares.rest = 0.0;
        }
        shares
    }

    fn mean_speed_fraction(&self) -> f64 {
        let whole_s: f64 = self.phases.iter().map(|phase| phase.duration_s).sum();
        if whole_s > 0.0 { self.travel_s() / whole_s } else { 0.0 }
    }

    /// Weights of the three terms of the cubic mean torque. The mean is weighted by time and speed (Harmonic Drive,
    /// engineering data 1019659, Eq 18.2). The mean torque of a joint that never moves is its static torque.
    fn mean_torque(&self) -> MeanTorque {
        let travel_s = self.travel_s();
        if travel_s <= 0.0 {
            return MeanTorque { of_static: 1.0, ..MeanTorque::default() };
        }
        let mut mean = MeanTorque::default();
        for phase in &self.phases {
            let share = phase.travel_s() / travel_s;
            match phase.kind {
                AskedPhaseKind::Accelerate => mean.of_sum += share,
                AskedPhaseKind::Decelerate => mean.of_difference += share,
                AskedPhaseKind::Constant | AskedPhaseKind::Rest => mean.of_static += share,
                AskedPhaseKind::Fraction { of_static_torque, .. } => {
                    mean.of_static += share * of_static_torque.abs().powi(3);
                }
            }
        }
        mean
    }
}

impl AskedPhase {
    /// Time in which the travel of the phase would be covered at full speed \[s\]: duration times mean speed over
    /// full speed.
    fn travel_s(&self) -> f64 {
        self.duration_s
            * match self.kind {
                AskedPhaseKind::Accelerate | AskedPhaseKind::Decelerate => 0.5,
                AskedPhaseKind::Constant => 1.0,
                AskedPhaseKind::Rest => 0.0,
                AskedPhaseKind::Fraction { of_speed, .. } => of_speed.abs(),
            }
    }
}
