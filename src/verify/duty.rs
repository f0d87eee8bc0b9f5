//! What one joint does, and the torques that its drive must hold (Eqs 8, 10; docs/sizing.md).
//!
//! Everything here follows from the question and the geometry alone; torque and inertia come in when a demand is made.

use super::bearing::BearingDemand;
use super::demand::{Demand, QUANTITIES, Quantity};
use super::question::{AskedMotion, AskedPhase, AskedPhaseKind, LinearTorque};

/// The motion of one joint, on the output side of its gear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Duty {
    /// Largest speed \[rad/s\].
    pub speed_rad_s: f64,
    /// Mean speed over the cycle, rests included \[rad/s\].
    pub mean_speed_rad_s: f64,
    /// Acceleration \[rad/s²\].
    pub acceleration_rad_s2: f64,
    /// Required life \[h\].
    pub life_h: f64,
    /// Torque of linear acceleration per inertia \[rad/s²\], and per static torque. One of the two is zero, depending
    /// on how Eq 8 is read.
    linear_per_inertia: f64,
    linear_per_static: f64,
    /// Torque of linear acceleration in an emergency stop, divided by that in a ramp.
    pub stop_factor: f64,
    mean: MeanTorque,
}

/// Weights in the cube of the cubic mean: of static plus linear torque, of static torque, and of static minus linear
/// torque, each cubed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct MeanTorque {
    of_sum: f64,
    of_static: f64,
    of_difference: f64,
}

impl Duty {
    /// The motion of a joint; the tip is at most `reach_m` from its axis.
    pub(super) fn new(motion: &AskedMotion, reach_m: f64, max_speed_rad_s: Option<f64>) -> Self {
        // the tip's speed over its lever; a short lever would ask a roll joint for absurd speeds
        let lever_m = reach_m.max(motion.min_lever_m);
        let speed_rad_s = max_speed_rad_s.unwrap_or(motion.tip_speed_m_s / lever_m);
        let acceleration_rad_s2 = speed_rad_s / motion.ramp_time_s;
        let tip_m_s2 = motion.tip_acceleration_m_s2();
        let (linear_per_inertia, linear_per_static) = match motion.linear_torque {
            LinearTorque::OfInertia => (acceleration_rad_s2, 0.0),
            LinearTorque::OfStaticTorque => (0.0, tip_m_s2 / motion.gravity_m_s2),
        };
        Self {
            speed_rad_s,
            mean_speed_rad_s: speed_rad_s * motion.mean_speed_fraction(),
            acceleration_rad_s2,
            life_h: motion.life_h,
            linear_per_inertia,
            linear_per_static,
            stop_factor: motion.emergency_deceleration_m_s2.map_or(2.0, |stop_m_s2| stop_m_s2 / tip_m_s2),
            mean: motion.mean_torque(),
        }
    }

    /// The torques that a static torque and an inertia outboard ask of the drive, without any load on its bearing. They
    /// grow with both (see [`AskedMotion::grows`]).
    pub(super) fn demand(&self, static_nm: f64, inertia_kgm2: f64) -> Demand {
        let static_nm = static_nm.abs();
        let linear_nm = (self.linear_per_inertia * inertia_kgm2 + self.linear_per_static * static_nm).abs();
        let cube = |nm: f64| nm * nm * nm;
        let mut torques = [0.0; QUANTITIES];
        torques[Quantity::Static as usize] = static_nm;
        torques[Quantity::Peak as usize] = static_nm + linear_nm;
        torques[Quantity::Stop as usize] = static_nm + self.stop_factor * linear_nm;
        torques[Quantity::MeanCubed as usize] = self.mean.of_sum * cube(static_nm + linear_nm)
            + self.mean.of_static * cube(static_nm)
            + self.mean.of_difference * cube((static_nm - linear_nm).abs());
        Demand { torques, bearing: BearingDemand::default() }
    }
}

impl AskedMotion {
    /// Acceleration of the tip \[m/s²\].
    pub(super) fn tip_acceleration_m_s2(&self) -> f64 {
        self.tip_speed_m_s / self.ramp_time_s
    }

    /// Whether no torque of a demand falls when static torque or inertia grows. Only while slowing down is the linear
    /// torque subtracted from the static torque; speeding up outweighs this if it takes at least as long.
    pub fn grows(&self) -> bool {
        let mean = self.mean_torque();
        mean.of_difference <= mean.of_sum
    }

    fn travel_s(&self) -> f64 {
        self.phases.iter().map(AskedPhase::travel_s).sum()
    }

    fn mean_speed_fraction(&self) -> f64 {
        let whole_s: f64 = self.phases.iter().map(|phase| phase.duration_s).sum();
        if whole_s > 0.0 { self.travel_s() / whole_s } else { 0.0 }
    }

    /// Cubic mean weighted by time and speed (Harmonic Drive, engineering data 1019659, Eq 18.2). A joint that never
    /// moves has its static torque as mean.
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
    /// Time that the travel of the phase takes at full speed \[s\]: duration times mean speed over full speed.
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
