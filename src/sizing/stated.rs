//! A duty that the study states for a joint: torques, times and speeds at its output, as a vendor's worked example has them.

use super::RAD_S_PER_RPM;

/// One phase of a stated duty.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatedPhase {
    /// Torque at the joint \[N m\]; negative where the load drives the motor.
    pub torque_nm: f64,
    /// Duration \[s\].
    pub time_s: f64,
    /// Mean speed of the joint \[rpm\]; 0 at rest.
    pub speed_rpm: f64,
}

/// The duty of a joint, which repeats for its whole life. It takes the place of the study's cycle in the mean torque, the
/// mean speed and the heat of the motor. Poses and masses still ask for their static torque, peak and emergency stop.
///
/// A phase at half the speed of the next one is its ramp up, a phase at half the speed of the one before its ramp down.
/// There rotor and wave generator are accelerated too.
///
/// ```
/// use armwright::sizing::{StatedDuty, StatedPhase};
///
/// // the worked example of Harmonic Drive, engineering data 1019659, chapter 3.4.2
/// let phase = |torque_nm, time_s, speed_rpm| StatedPhase { torque_nm, time_s, speed_rpm };
/// let duty = StatedDuty {
///     phases: vec![phase(400.0, 0.3, 7.0), phase(320.0, 3.0, 14.0), phase(200.0, 0.4, 7.0), phase(0.0, 0.2, 0.0)],
/// };
/// assert!((duty.mean_torque_cubed_nm3().cbrt() - 319.7).abs() < 0.05);
/// assert!((120.0 * duty.mean_speed_rpm() - 1443.0).abs() < 0.5);
/// assert_eq!(duty.ramp_time_s(), Some(0.3));
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StatedDuty {
    /// The phases in order.
    pub phases: Vec<StatedPhase>,
}

/// What a stated duty asks of a drive, whatever the arm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatedDemand {
    /// Largest torque \[N m\].
    pub peak_torque_nm: f64,
    /// Cube of the cubic mean torque \[(N m)³\].
    pub mean_torque_cubed_nm3: f64,
    /// What the motor's heat follows from.
    pub heat: StatedHeat,
}

/// Relative difference up to which one speed is half of another.
const SAME_SPEED: f64 = 1e-6;

impl StatedDuty {
    /// Duration of the cycle \[s\].
    pub fn duration_s(&self) -> f64 {
        self.phases.iter().map(|phase| phase.time_s).sum()
    }

    /// Largest speed \[rpm\].
    pub fn fastest_rpm(&self) -> f64 {
        self.phases.iter().map(|phase| phase.speed_rpm.abs()).fold(0.0, f64::max)
    }

    /// Mean speed, rests included \[rpm\] (Eq 18.5 of the vendor).
    pub fn mean_speed_rpm(&self) -> f64 {
        self.phases.iter().map(StatedPhase::travel).sum::<f64>() / self.duration_s()
    }

    /// Cube of the cubic mean torque, weighted by time and speed \[(N m)³\] (Eq 18.2 of the vendor).
    pub fn mean_torque_cubed_nm3(&self) -> f64 {
        let travel: f64 = self.phases.iter().map(StatedPhase::travel).sum();
        let cubes = self.phases.iter().map(|phase| phase.travel() * phase.torque_nm.abs().powi(3));
        if travel > 0.0 { cubes.sum::<f64>() / travel } else { self.peak_torque_nm().powi(3) }
    }

    /// Largest torque \[N m\].
    pub fn peak_torque_nm(&self) -> f64 {
        self.phases.iter().map(|phase| phase.torque_nm.abs()).fold(0.0, f64::max)
    }

    /// Duration of the first ramp up \[s\]; `None` if no phase is one.
    pub fn ramp_time_s(&self) -> Option<f64> {
        let ramps = self.phases.iter().zip(self.accelerations_rad_s2());
        ramps.filter(|(_, acceleration)| *acceleration > 0.0).map(|(phase, _)| phase.time_s).next()
    }

    /// Acceleration in each phase, negative where the joint slows down \[rad/s²\].
    fn accelerations_rad_s2(&self) -> Vec<f64> {
        let count = self.phases.len();
        let is_half = |phase: &StatedPhase, of: &StatedPhase| {
            let full = of.speed_rpm.abs();
            full > 0.0 && phase.time_s > 0.0 && (2.0 * phase.speed_rpm.abs() / full - 1.0).abs() < SAME_SPEED
        };
        let ramp = |phase: &StatedPhase, of: &StatedPhase| of.speed_rpm.abs() * RAD_S_PER_RPM / phase.time_s;
        let of_phase = |(i, phase): (usize, &StatedPhase)| {
            let (before, after) = (&self.phases[(i + count - 1) % count], &self.phases[(i + 1) % count]);
            match (is_half(phase, after), is_half(phase, before)) {
                (true, _) => ramp(phase, after),
                (false, true) => -ramp(phase, before),
                (false, false) => 0.0,
            }
        };
        self.phases.iter().enumerate().map(of_phase).collect()
    }

    /// What it asks of a drive. A brake carries the torque of a phase at rest.
    pub(super) fn demand(&self, has_brake: bool) -> StatedDemand {
        let mut heat = StatedHeat::default();
        for (phase, acceleration) in self.phases.iter().zip(self.accelerations_rad_s2()) {
            if phase.speed_rpm == 0.0 && has_brake {
                continue;
            }
            let share = phase.time_s / self.duration_s();
            let driven = usize::from(phase.torque_nm < 0.0);
            heat.torque_nm2[driven] += share * phase.torque_nm * phase.torque_nm;
            heat.mixed_nm_rad_s2[driven] += share * phase.torque_nm * acceleration;
            heat.acceleration_rad2_s4 += share * acceleration * acceleration;
        }
        StatedDemand {
            peak_torque_nm: self.peak_torque_nm(),
            mean_torque_cubed_nm3: self.mean_torque_cubed_nm3(),
            heat,
        }
    }
}

impl StatedPhase {
    /// Speed times time \[rpm s\].
    fn travel(&self) -> f64 {
        self.speed_rpm.abs() * self.time_s
    }
}

impl StatedDemand {
    /// The same duty with every acceleration times a factor.
    pub(super) fn slowed(self, factor: f64) -> Self {
        Self { heat: self.heat.slowed(factor), ..self }
    }
}

/// The motor's torque over a stated duty: sums from which the mean square of any drive follows. A phase of time share w
/// with torque T and acceleration α counts as w (T p + α c)², p being the share for each newton metre and c that for each
/// rad/s² of the joint.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StatedHeat {
    /// Sum of w T² where the motor drives, and where it is driven \[(N m)²\].
    torque_nm2: [f64; 2],
    /// Sum of w T α, in the same order \[N m rad/s²\].
    mixed_nm_rad_s2: [f64; 2],
    /// Sum of w α² \[rad²/s⁴\].
    acceleration_rad2_s4: f64,
}

impl StatedHeat {
    /// Mean square as a share of the square of the continuous torque, of a drive with these shares per torque that the motor
    /// drives and per torque that drives it \[1/(N m)\], and for each rad/s² of the joint \[s²\].
    pub(super) fn share_squared(&self, per_nm: [f64; 2], inertia_s2: f64) -> f64 {
        let torque: f64 = (0..2).map(|i| self.torque_nm2[i] * per_nm[i] * per_nm[i]).sum();
        let mixed: f64 = (0..2).map(|i| self.mixed_nm_rad_s2[i] * per_nm[i]).sum();
        torque + 2.0 * inertia_s2 * mixed + inertia_s2 * inertia_s2 * self.acceleration_rad2_s4
    }

    /// The same duty with every acceleration times a factor.
    fn slowed(self, factor: f64) -> Self {
        Self {
            mixed_nm_rad_s2: self.mixed_nm_rad_s2.map(|x| x * factor),
            acceleration_rad2_s4: self.acceleration_rad2_s4 * factor * factor,
            ..self
        }
    }
}
