//! A duty cycle that the study states for one joint: torques, times and speeds at its output, as in a vendor's worked
//! example.

use super::RAD_S_PER_RPM;
use crate::arm::transmission::Stage;

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

/// The duty of a joint, which repeats for its whole life. In the mean torque, the mean speed and the motor's heat it
/// takes the place of the study's cycle. The static torque, peak and emergency stop that follow from poses and masses
/// are still checked.
///
/// A phase at half the speed of the next phase (within 5 %) is a ramp up to the speed of the next phase. A phase at
/// half the speed of the phase before is a ramp down from that speed. In ramps rotor and wave generator are accelerated
/// too.
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

/// What a stated duty asks of a drive; it is the same for every arm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatedDemand {
    /// Largest torque of a phase, without its sign \[N m\].
    pub peak_torque_nm: f64,
    /// Cube of the cubic mean torque \[(N m)³\].
    pub mean_torque_cubed_nm3: f64,
    /// Sums from which the motor's heat is computed for any drive.
    pub heat: StatedHeat,
}

/// Relative tolerance within which the speed of a phase counts as half the speed of a neighbouring phase. Data sheets
/// and worked examples print speeds with two or three digits.
const SPEED_TOLERANCE: f64 = 0.05;

impl StatedDuty {
    /// Duration of the cycle \[s\].
    pub fn duration_s(&self) -> f64 {
        self.phases.iter().map(|phase| phase.time_s).sum()
    }

    /// Largest speed of a phase \[rpm\].
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

    /// Largest torque of a phase, without its sign \[N m\].
    pub fn peak_torque_nm(&self) -> f64 {
        self.phases.iter().map(|phase| phase.torque_nm.abs()).fold(0.0, f64::max)
    }

    /// Duration of the first ramp up \[s\]; `None` if no phase is a ramp up.
    pub fn ramp_time_s(&self) -> Option<f64> {
        let ramps = self.phases.iter().zip(self.accelerations_rad_s2());
        ramps.filter(|(_, acceleration)| *acceleration > 0.0).map(|(phase, _)| phase.time_s).next()
    }

    /// Whether the joint moves and no phase is a ramp, so that nothing says how hard rotor and wave generator are
    /// accelerated.
    pub fn moves_without_ramps(&self) -> bool {
        self.fastest_rpm() > 0.0
            && self.accelerations_rad_s2().iter().all(|acceleration| *acceleration == 0.0)
    }

    /// Acceleration of the joint in each phase \[rad/s²\]: positive in a ramp up, negative in a ramp down, else 0.
    fn accelerations_rad_s2(&self) -> Vec<f64> {
        let count = self.phases.len();
        let is_half = |phase: &StatedPhase, of: &StatedPhase| {
            let full = of.speed_rpm.abs();
            full > 0.0
                && phase.time_s > 0.0
                && (2.0 * phase.speed_rpm.abs() / full - 1.0).abs() < SPEED_TOLERANCE
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

    /// What this duty asks of any drive. If the joint has a brake, phases at rest do not heat the motor.
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
    /// Speed multiplied by time \[rpm s\]. It is the weight of the phase in the mean torque.
    fn travel(&self) -> f64 {
        self.speed_rpm.abs() * self.time_s
    }
}

impl StatedDemand {
    /// What this duty of a joint asks at the input of `stage`, which drives the joint, without the stage's own inertia.
    pub(super) fn before(self, stage: &Stage) -> Self {
        let gain = stage.ratio * stage.efficiency;
        Self {
            peak_torque_nm: self.peak_torque_nm / gain,
            mean_torque_cubed_nm3: self.mean_torque_cubed_nm3 / gain.powi(3),
            heat: self.heat.before(stage),
        }
    }

    /// What this duty asks of a drive if every acceleration is multiplied by `factor`.
    pub(super) fn slowed(self, factor: f64) -> Self {
        Self { heat: self.heat.slowed(factor), ..self }
    }
}

/// The motor's torque over a stated duty, as sums from which the mean square of any drive follows. A phase that takes
/// the fraction w of the time, with torque T and acceleration α, adds w (T p + α c)². Here p is the ratio of motor
/// torque to continuous torque for each newton metre at the joint, and c is this ratio for each rad/s² of the joint.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StatedHeat {
    /// Two sums of w T² (w: fraction of the time; T: torque) \[(N m)²\]. The first is over the phases in which the
    /// motor drives the load, the second over the phases in which the load drives the motor.
    torque_nm2: [f64; 2],
    /// Two sums of w T α (α: acceleration of the joint) \[N m rad/s²\], over the same two groups of phases.
    mixed_nm_rad_s2: [f64; 2],
    /// Sum of w α² over all phases \[rad²/s⁴\].
    acceleration_rad2_s4: f64,
}

impl StatedHeat {
    /// Mean square of the motor's torque, divided by the square of its continuous torque. `per_nm` has the ratio p
    /// where the motor drives and where the load drives it \[1/(N m)\]; `inertia_s2` is the ratio c for each rad/s²
    /// of the joint \[s²\].
    pub(super) fn share_squared(&self, per_nm: [f64; 2], inertia_s2: f64) -> f64 {
        let torque: f64 = (0..2).map(|i| self.torque_nm2[i] * per_nm[i] * per_nm[i]).sum();
        let mixed: f64 = (0..2).map(|i| self.mixed_nm_rad_s2[i] * per_nm[i]).sum();
        torque + 2.0 * inertia_s2 * mixed + inertia_s2 * inertia_s2 * self.acceleration_rad2_s4
    }

    /// The sums of this duty at the input of `stage`. The inertia of the stage is left out, because a duty in numbers
    /// states torques and not what accelerates the stage. Where the load drives, the stage's losses help the motor.
    fn before(self, stage: &Stage) -> Self {
        let per_nm = [1.0 / (stage.ratio * stage.efficiency), stage.efficiency / stage.ratio];
        Self {
            torque_nm2: [0, 1].map(|i| self.torque_nm2[i] * per_nm[i] * per_nm[i]),
            mixed_nm_rad_s2: [0, 1].map(|i| self.mixed_nm_rad_s2[i] * per_nm[i] * stage.ratio),
            acceleration_rad2_s4: self.acceleration_rad2_s4 * stage.ratio * stage.ratio,
        }
    }

    /// The sums of this duty if every acceleration of the joint is multiplied by `factor`.
    fn slowed(self, factor: f64) -> Self {
        Self {
            mixed_nm_rad_s2: self.mixed_nm_rad_s2.map(|x| x * factor),
            acceleration_rad2_s4: self.acceleration_rad2_s4 * factor * factor,
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn duty(speeds_rpm: [f64; 4]) -> StatedDuty {
        let phase = |(torque_nm, time_s): (f64, f64), speed_rpm| StatedPhase { torque_nm, time_s, speed_rpm };
        let torques = [(30.0, 0.15), (5.0, 0.5), (-20.0, 0.15), (0.0, 0.2)];
        StatedDuty { phases: torques.into_iter().zip(speeds_rpm).map(|(t, rpm)| phase(t, rpm)).collect() }
    }

    /// A data sheet prints half of 14.3 rpm as 7.2 rpm.
    #[test]
    fn a_ramp_whose_mean_speed_is_rounded_is_a_ramp() {
        let accelerations = |speeds_rpm| duty(speeds_rpm).accelerations_rad_s2();
        let exact = accelerations([7.15, 14.3, 7.15, 0.0]);
        assert!((exact[0] - 14.3 * RAD_S_PER_RPM / 0.15).abs() < 1e-12 && exact[2] == -exact[0], "{exact:?}");
        assert_eq!(accelerations([7.2, 14.3, 7.1, 0.0]), exact);
        assert_eq!(accelerations([7.0, 14.3, 7.0, 0.0]), exact);
        assert_eq!(accelerations([8.0, 14.3, 8.0, 0.0]), [0.0; 4]);
    }

    #[test]
    fn a_duty_whose_phases_are_all_at_one_speed_has_no_ramps() {
        assert!(duty([14.0, 14.0, 14.0, 0.0]).moves_without_ramps());
        assert!(!duty([7.0, 14.0, 7.0, 0.0]).moves_without_ramps());
        assert!(!duty([0.0; 4]).moves_without_ramps(), "a joint at rest needs no ramps");
    }
}
