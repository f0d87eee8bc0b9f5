//! Duty cycles: the phases that a joint repeats. They give the mean speed, the weights of the cubic mean torque and
//! the weights of the motor's heat.

/// Relative difference up to which two ramp times count as equal.
const SAME_TIME: f64 = 1e-9;

/// What a joint does during one phase of the duty cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PhaseKind {
    /// Speeding up: static plus linear torque, at half the largest speed on average.
    Accelerate,
    /// Constant largest speed: static torque.
    Constant,
    /// Slowing down: static minus linear torque, at half the largest speed on average.
    Decelerate,
    /// Standing still. A rest counts in the mean speed, but not in the mean torque, because the wave-generator
    /// bearing does not turn.
    Rest,
    /// A phase with stated fractions of the static torque and of the largest speed.
    Fraction {
        /// Fraction of the joint's static torque.
        of_static_torque: f64,
        /// Fraction of the joint's largest speed.
        of_speed: f64,
    },
}

/// One phase of a duty cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phase {
    /// Duration of the phase \[s\].
    pub duration_s: f64,
    /// What the joint does in this phase.
    pub kind: PhaseKind,
}

/// A cycle that the joint repeats for its whole life.
///
/// The mean values follow the vendor (Harmonic Drive, engineering data 1019659, Eqs 18.2 and 18.5). The mean torque is
/// the cubic mean weighted by time *and* speed. The mean speed includes pauses. A cycle lifts the load. If it lowers
/// the load instead, the torques of its two ramps change places. The mean is then the same, because the ramps up and
/// down take equally long.
#[derive(Debug, Clone, PartialEq)]
pub struct DutyCycle {
    /// The phases in order.
    pub phases: Vec<Phase>,
}

impl DutyCycle {
    /// The default cycle: ramp up in t_a, move for 3 t_a, ramp down in t_a, rest for 5 t_a. The joint moves for half of
    /// the time and has 40 % of its full speed on average.
    pub fn move_and_rest(ramp_time_s: f64) -> Self {
        let phase = |ramps: f64, kind| Phase { duration_s: ramps * ramp_time_s, kind };
        Self {
            phases: vec![
                phase(1.0, PhaseKind::Accelerate),
                phase(3.0, PhaseKind::Constant),
                phase(1.0, PhaseKind::Decelerate),
                phase(5.0, PhaseKind::Rest),
            ],
        }
    }

    /// Ratio of the mean speed over the cycle, pauses included, to the largest speed.
    pub fn mean_speed_fraction(&self) -> f64 {
        let total: f64 = self.phases.iter().map(|p| p.duration_s).sum();
        if total > 0.0 { self.travel_s() / total } else { 0.0 }
    }

    /// Weights of the cubic mean torque over this cycle. A cycle without motion gets the static torque as its mean.
    pub fn mean_torque_weights(&self) -> MeanTorqueWeights {
        let travel_s = self.travel_s();
        if travel_s <= 0.0 {
            return MeanTorqueWeights { sum: 0.0, steady: 1.0, difference: 0.0 };
        }
        let mut weights = MeanTorqueWeights { sum: 0.0, steady: 0.0, difference: 0.0 };
        for phase in &self.phases {
            let share = phase.travel_s() / travel_s;
            match phase.kind {
                PhaseKind::Accelerate => weights.sum += share,
                PhaseKind::Decelerate => weights.difference += share,
                PhaseKind::Constant | PhaseKind::Rest => weights.steady += share,
                PhaseKind::Fraction { of_static_torque, .. } => {
                    weights.steady += share * of_static_torque.abs().powi(3)
                }
            }
        }
        weights
    }

    /// Weights of the squared torques in the mean square of the motor's torque: the fraction of the cycle's time that
    /// each kind of phase takes. A cycle of zero duration counts as standing still.
    pub fn heat_weights(&self) -> HeatWeights {
        let total_s: f64 = self.phases.iter().map(|p| p.duration_s).sum();
        if total_s <= 0.0 {
            return HeatWeights { standing: 1.0, ..HeatWeights::default() };
        }
        let mut weights = HeatWeights::default();
        for phase in &self.phases {
            let share = phase.duration_s / total_s;
            match phase.kind {
                PhaseKind::Accelerate => weights.sum += share,
                PhaseKind::Constant => weights.steady += share,
                PhaseKind::Decelerate => weights.difference += share,
                PhaseKind::Rest => weights.standing += share,
                PhaseKind::Fraction { of_static_torque, of_speed } => {
                    let square = share * of_static_torque * of_static_torque;
                    let weight = if of_speed == 0.0 { &mut weights.standing } else { &mut weights.steady };
                    *weight += square;
                }
            }
        }
        weights
    }

    /// Total time of speeding up and total time of slowing down \[s\]. Both happen at the same acceleration, so the
    /// two are equal in a cycle that comes back to rest.
    pub fn ramps_s(&self) -> [f64; 2] {
        [PhaseKind::Accelerate, PhaseKind::Decelerate]
            .map(|kind| self.phases.iter().filter(|p| p.kind == kind).map(|p| p.duration_s).sum())
    }

    /// The total times of speeding up and of slowing down \[s\], if they differ; `None` if they are equal, as they must
    /// be.
    pub(crate) fn unequal_ramps_s(&self) -> Option<[f64; 2]> {
        let [up_s, down_s] = self.ramps_s();
        ((up_s - down_s).abs() > SAME_TIME * (up_s + down_s)).then_some([up_s, down_s])
    }

    /// The duration \[s\] of the first ramp that does not take `ramp_time_s` \[s\], the time in which the joint reaches
    /// its speed; `None` if all ramps do. Phases of one kind that follow one another are one ramp.
    pub(crate) fn other_ramp_s(&self, ramp_time_s: f64) -> Option<f64> {
        let is_ramp = |kind| matches!(kind, PhaseKind::Accelerate | PhaseKind::Decelerate);
        let runs = self.phases.chunk_by(|a, b| a.kind == b.kind).filter(|run| is_ramp(run[0].kind));
        let mut ramps_s = runs.map(|run| run.iter().map(|phase| phase.duration_s).sum::<f64>());
        ramps_s.find(|&ramp_s| ramp_s > 0.0 && (ramp_s - ramp_time_s).abs() > SAME_TIME * ramp_time_s)
    }

    /// Angle through which the joint turns in the whole cycle, divided by its largest speed \[s\].
    fn travel_s(&self) -> f64 {
        self.phases.iter().map(Phase::travel_s).sum()
    }
}

impl Phase {
    /// Angle through which the joint turns in this phase, divided by its largest speed \[s\].
    fn travel_s(&self) -> f64 {
        let speed = match self.kind {
            PhaseKind::Accelerate | PhaseKind::Decelerate => 0.5,
            PhaseKind::Constant => 1.0,
            PhaseKind::Rest => 0.0,
            PhaseKind::Fraction { of_speed, .. } => of_speed.abs(),
        };
        speed * self.duration_s
    }
}

/// Weights of the cubic mean torque of a duty cycle:
/// T_mean³ = sum (T + T_lin)³ + steady T³ + difference |T - T_lin|³. The weights add up to 1 for a cycle of ramps and
/// travel at full speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeanTorqueWeights {
    /// Weight of (T + T_lin)³.
    pub sum: f64,
    /// Weight of T³.
    pub steady: f64,
    /// Weight of |T - T_lin|³.
    pub difference: f64,
}

impl MeanTorqueWeights {
    /// All weights are zero: torques of the arm do not count, because the mean torque comes from a stated duty.
    pub(super) const NONE: Self = Self { sum: 0.0, steady: 0.0, difference: 0.0 };
}

/// Weights of the squared torques in the mean square of the motor's torque: the fraction of the cycle's time that
/// each kind of phase takes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct HeatWeights {
    /// Fraction of the time in which the joint speeds up, with the sum of static and linear torque.
    pub sum: f64,
    /// Fraction of the time in which the joint moves under the static torque.
    pub steady: f64,
    /// Fraction of the time in which the joint slows down, with the difference of static and linear torque.
    pub difference: f64,
    /// Fraction of the time in which the motor holds the static torque at rest; 0 if a brake holds the joint.
    pub standing: f64,
}

impl HeatWeights {
    /// These weights, all multiplied by `factor`.
    pub(crate) fn times(self, factor: f64) -> Self {
        Self {
            sum: self.sum * factor,
            steady: self.steady * factor,
            difference: self.difference * factor,
            standing: self.standing * factor,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_cycle_moves_at_40_percent_on_average() {
        let cycle = DutyCycle::move_and_rest(0.20);
        assert!((cycle.mean_speed_fraction() - 0.4).abs() < 1e-15);
        let w = cycle.mean_torque_weights();
        assert!((w.sum - 0.125).abs() < 1e-15, "half a ramp of four: {w:?}");
        assert!((w.steady - 0.75).abs() < 1e-15);
        assert!((w.difference - 0.125).abs() < 1e-15);
    }

    #[test]
    fn heat_counts_every_phase_by_its_time_and_rests_too() {
        let HeatWeights { sum, steady, difference, standing } = DutyCycle::move_and_rest(0.20).heat_weights();
        for (weight, by_hand) in [(sum, 0.1), (steady, 0.3), (difference, 0.1), (standing, 0.5)] {
            assert!((weight - by_hand).abs() < 1e-15, "{weight}, by hand {by_hand}");
        }
    }

    #[test]
    fn a_fraction_phase_heats_by_the_square_of_its_torque_and_stands_if_it_has_no_speed() {
        let phase = |of_speed| Phase {
            duration_s: 1.0,
            kind: PhaseKind::Fraction { of_static_torque: 0.5, of_speed },
        };
        let cycle = DutyCycle { phases: vec![phase(0.0), phase(1.0)] };
        let weights = cycle.heat_weights();
        assert_eq!((weights.steady, weights.standing), (0.125, 0.125));
    }

    #[test]
    fn a_fraction_phase_counts_by_the_cube_of_its_torque() {
        let kind = PhaseKind::Fraction { of_static_torque: 0.5, of_speed: 0.25 };
        let cycle = DutyCycle { phases: vec![Phase { duration_s: 2.0, kind }] };
        assert_eq!(cycle.mean_speed_fraction(), 0.25);
        assert_eq!(cycle.mean_torque_weights().steady, 0.125);
    }

    #[test]
    fn a_cycle_without_motion_has_the_static_torque_as_mean() {
        let cycle = DutyCycle { phases: vec![Phase { duration_s: 1.0, kind: PhaseKind::Rest }] };
        assert_eq!(cycle.mean_speed_fraction(), 0.0);
        assert_eq!(cycle.mean_torque_weights().steady, 1.0);
    }
}
