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
/// Speeds are means over the phases. A phase whose speed is the mean of the speeds before and after it is a ramp between
/// them (within 5 %), and in ramps rotor and wave generator are accelerated too.
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
/// assert_eq!(duty.ramps(), [1, 3]);
/// assert!((duty.ramp_time_s(0.2) - 0.3).abs() < 1e-12, "the steeper of the two");
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

/// Tolerance within which the mean speed of a ramp is the mean of the speeds at its ends, as a fraction of that mean.
/// Data sheets and worked examples print speeds with two or three digits.
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

    /// Largest speed of a phase \[rad/s\].
    pub(crate) fn fastest_rad_s(&self) -> f64 {
        self.fastest_rpm() * RAD_S_PER_RPM
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

    /// Duration of a ramp from rest to the largest speed at the largest acceleration or deceleration \[s\]. A jump between
    /// the speeds of two phases takes `jump_s` \[s\]; without a movement this is the result too.
    pub fn ramp_time_s(&self, jump_s: f64) -> f64 {
        let ends_rpm = self.ends_rpm();
        let jumps = (0..ends_rpm.len()).map(|i| {
            let [before, after] = [ends_rpm[i][1], ends_rpm[(i + 1) % ends_rpm.len()][0]];
            if is_about(before, after) { 0.0 } else { (after - before).abs() / jump_s }
        });
        // a ramp that takes no time is a jump too
        let duration_s = |phase: &StatedPhase| if phase.time_s > 0.0 { phase.time_s } else { jump_s };
        let ramps = self.phases.iter().zip(&ends_rpm);
        let ramps = ramps.map(|(phase, [start, end])| (end - start).abs() / duration_s(phase));
        let steepest_rpm_s = jumps.chain(ramps).fold(0.0, f64::max);
        if steepest_rpm_s > 0.0 { self.fastest_rpm() / steepest_rpm_s } else { jump_s }
    }

    /// The numbers of the phases that count as ramps, from 1.
    pub fn ramps(&self) -> Vec<usize> {
        let accelerations = self.accelerations_rad_s2();
        (1..=accelerations.len()).filter(|number| accelerations[number - 1] != 0.0).collect()
    }

    /// Whether the joint moves and no phase is a ramp, so that nothing says how hard rotor and wave generator are
    /// accelerated.
    pub fn moves_without_ramps(&self) -> bool {
        self.fastest_rpm() > 0.0
            && self.accelerations_rad_s2().iter().all(|acceleration| *acceleration == 0.0)
    }

    /// Speeds at the start and at the end of every phase \[rpm\]; they are equal unless the phase is a ramp.
    ///
    /// If speeds that follow each other without a jump have the stated means, they decide. Otherwise each phase is
    /// compared with its neighbours: it is a ramp if its speed is the mean of theirs, where a neighbour that is itself a
    /// ramp from or to rest counts as rest.
    fn ends_rpm(&self) -> Vec<[f64; 2]> {
        self.ends_without_jumps().unwrap_or_else(|| self.ends_by_neighbours())
    }

    /// Acceleration of the joint in each phase \[rad/s²\]: positive in a ramp up, negative in a ramp down, else 0.
    fn accelerations_rad_s2(&self) -> Vec<f64> {
        let ends_rpm = self.ends_rpm();
        let acceleration = |(phase, [start, end]): (&StatedPhase, [f64; 2])| match phase.time_s > 0.0 {
            true => (end - start) * RAD_S_PER_RPM / phase.time_s,
            false => 0.0,
        };
        self.phases.iter().zip(ends_rpm).map(acceleration).collect()
    }

    /// Speeds at the start and at the end of every phase \[rpm\] if the joint never jumps from one speed to another and
    /// every phase is a ramp or has constant speed. `None` if no such speeds have the stated means. The largest of these
    /// speeds must be stated, and a ramp up must not be followed at once by a ramp down: two phases of equal speed after a
    /// rest are no ramps to and from twice their speed.
    ///
    /// The speeds are followed from a phase of constant speed through the whole cycle, back to it: at rest, or else the
    /// fastest one.
    fn ends_without_jumps(&self) -> Option<Vec<[f64; 2]>> {
        let speeds_rpm: Vec<f64> = self.phases.iter().map(|phase| phase.speed_rpm.abs()).collect();
        let fastest_rpm = self.fastest_rpm();
        let first = speeds_rpm.iter().position(|rpm| *rpm == 0.0);
        let first = first.or_else(|| speeds_rpm.iter().position(|rpm| *rpm == fastest_rpm))?;
        let mut ends_rpm = vec![[0.0; 2]; speeds_rpm.len()];
        let (mut now_rpm, mut was_ramp_up) = (speeds_rpm[first], false);
        for place in (first..first + speeds_rpm.len()).map(|place| place % speeds_rpm.len()) {
            let (start_rpm, mean_rpm) = (now_rpm, speeds_rpm[place]);
            let next_rpm = speeds_rpm[(place + 1) % speeds_rpm.len()];
            now_rpm = match is_about(mean_rpm, start_rpm) {
                true => start_rpm,
                // the ramp ends at the constant speed of the next phase or at rest, up to rounding
                false => [next_rpm, 0.0]
                    .into_iter()
                    .find(|end_rpm| is_about(mean_rpm, 0.5 * (start_rpm + end_rpm)))
                    .unwrap_or(2.0 * mean_rpm - start_rpm),
            };
            let is_stated = now_rpm <= fastest_rpm || is_about(now_rpm, fastest_rpm);
            let is_peak = was_ramp_up && now_rpm < start_rpm;
            if now_rpm < 0.0 || !is_stated || is_peak {
                return None;
            }
            was_ramp_up = now_rpm > start_rpm;
            ends_rpm[place] = [start_rpm, now_rpm];
        }
        is_about(now_rpm, speeds_rpm[first]).then_some(ends_rpm)
    }

    /// Speeds at the start and at the end of every phase \[rpm\], each phase compared with its neighbours alone. The two
    /// are equal if the phase is no ramp.
    fn ends_by_neighbours(&self) -> Vec<[f64; 2]> {
        let count = self.phases.len();
        let speed_rpm = |place: usize| self.phases[place % count].speed_rpm.abs();
        let of_phase = |place: usize| {
            let [earlier, before, mean, after, later] =
                [count - 2 % count, count - 1, 0, 1, 2].map(|step| speed_rpm(place + step));
            // a neighbour that is itself a ramp down to rest, or up from it
            let starts_at_rest = is_about(before, 0.5 * earlier);
            let ends_at_rest = is_about(after, 0.5 * later);
            let ends = [
                Some([before, after]),
                starts_at_rest.then_some([0.0, after]),
                ends_at_rest.then_some([before, 0.0]),
            ];
            let is_ramp =
                |[start, end]: &[f64; 2]| !is_about(*start, *end) && is_about(mean, 0.5 * (start + end));
            ends.into_iter().flatten().find(is_ramp).unwrap_or([mean; 2])
        };
        (0..count).map(of_phase).collect()
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

/// Whether two speeds are the same up to the rounding of what is printed.
fn is_about(rpm: f64, other_rpm: f64) -> bool {
    (rpm - other_rpm).abs() <= SPEED_TOLERANCE * rpm.max(other_rpm)
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

    /// What this duty asks of a drive if every torque is multiplied by `factor`.
    pub(super) fn with_torques_times(self, factor: f64) -> Self {
        Self {
            peak_torque_nm: self.peak_torque_nm * factor,
            mean_torque_cubed_nm3: self.mean_torque_cubed_nm3 * factor.powi(3),
            heat: self.heat.with_torques_times(factor),
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

    /// The sums of this duty if every torque of it is multiplied by `factor`.
    fn with_torques_times(self, factor: f64) -> Self {
        Self {
            torque_nm2: self.torque_nm2.map(|x| x * factor * factor),
            mixed_nm_rad_s2: self.mixed_nm_rad_s2.map(|x| x * factor),
            ..self
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

    fn of_speeds(phases: &[(f64, f64)]) -> StatedDuty {
        let phase = |&(speed_rpm, time_s): &(f64, f64)| StatedPhase { torque_nm: 10.0, time_s, speed_rpm };
        StatedDuty { phases: phases.iter().map(phase).collect() }
    }

    /// Largest acceleration of a duty \[rpm/s\], where a jump takes 0.1 s.
    fn steepest_rpm_s(duty: &StatedDuty) -> f64 {
        duty.fastest_rpm() / duty.ramp_time_s(0.1)
    }

    #[test]
    fn ramps_are_those_of_a_speed_that_does_not_jump() {
        // from rest to 10 rpm, on to 20 rpm, and back to rest
        let steps = of_speeds(&[(5.0, 0.2), (10.0, 1.0), (15.0, 0.2), (20.0, 1.0), (10.0, 0.4), (0.0, 1.0)]);
        assert_eq!(steps.ramps(), [1, 3, 5]);
        assert!((steepest_rpm_s(&steps) - 50.0).abs() < 1e-9);
        // two ramps after each other, and no rest between a move and the next
        assert_eq!(of_speeds(&[(5.0, 0.2), (15.0, 0.1), (20.0, 1.0), (10.0, 0.3)]).ramps(), [1, 2, 4]);
        assert_eq!(of_speeds(&[(7.0, 0.3), (14.0, 3.0), (7.0, 0.4)]).ramps(), [1, 3]);
        // the steepest ramp is the one down
        let gentle = of_speeds(&[(10.0, 2.0), (20.0, 1.0), (10.0, 0.5), (0.0, 1.0)]);
        assert!((steepest_rpm_s(&gentle) - 40.0).abs() < 1e-9);
    }

    #[test]
    fn what_jumps_is_as_steep_as_the_ramps_of_the_study() {
        // 10 rpm may be a ramp to 20 rpm or a speed; the way back to rest is a jump
        let two = of_speeds(&[(10.0, 5.0), (20.0, 5.0), (0.0, 5.0)]);
        assert!((steepest_rpm_s(&two) - 200.0).abs() < 1e-9);
        // never at rest: two speeds, and jumps of 10 rpm
        let never = of_speeds(&[(10.0, 5.0), (20.0, 5.0)]);
        assert_eq!((never.ramps().len(), steepest_rpm_s(&never).round()), (0, 100.0));
        // two phases of one speed are not a triangle up to twice the speed
        let same = of_speeds(&[(14.0, 1.0), (14.0, 1.0), (0.0, 1.0)]);
        assert_eq!((same.ramps().len(), steepest_rpm_s(&same).round()), (0, 140.0));
        // however a constant speed is cut into phases
        let cut = of_speeds(&[(10.0, 5.0), (10.0, 5.0), (10.0, 5.0), (20.0, 5.0), (10.0, 5.0), (0.0, 5.0)]);
        assert_eq!((cut.ramps(), steepest_rpm_s(&cut).round()), (vec![5], 100.0));
        // a ramp in no time
        let at_once = of_speeds(&[(10.0, 0.0), (20.0, 1.0), (10.0, 0.4), (0.0, 0.2)]);
        assert!((steepest_rpm_s(&at_once) - 200.0).abs() < 1e-9);
        // a move to and fro
        let reverses = of_speeds(&[
            (7.0, 0.3),
            (14.0, 1.0),
            (7.0, 0.3),
            (7.0, 0.3),
            (14.0, 1.0),
            (7.0, 0.3),
            (0.0, 1.0),
        ]);
        assert_eq!(reverses.ramps(), [1, 3, 4, 6]);
        // a move and a creeping speed that begins at once
        let creeps = of_speeds(&[(7.0, 0.3), (14.0, 1.0), (7.0, 0.3), (3.0, 1.0), (0.0, 1.0)]);
        assert_eq!(creeps.ramps(), [1]);
    }

    #[test]
    fn a_duty_whose_phases_are_all_at_one_speed_has_no_ramps() {
        assert!(duty([14.0, 14.0, 14.0, 0.0]).moves_without_ramps());
        assert!(!duty([7.0, 14.0, 7.0, 0.0]).moves_without_ramps());
        assert!(!duty([0.0; 4]).moves_without_ramps(), "a joint at rest needs no ramps");
    }
}
