//! Duty cycles: the cycle that a joint repeats, its mean speed, and the weights of its cubic mean torque.

/// What a joint does during one phase of the duty cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PhaseKind {
    /// Speeding up: static plus linear torque, half the speed on average.
    Accelerate,
    /// Constant speed: static torque.
    Constant,
    /// Slowing down: the difference of static and linear torque, half the speed on average.
    Decelerate,
    /// Standing still. A rest counts in the mean speed. It does not count in the mean torque, because the wave-generator
    /// bearing does not turn.
    Rest,
    /// Stated fractions of static torque and speed.
    Fraction {
        /// Fraction of the static torque.
        of_static_torque: f64,
        /// Fraction of the joint's speed.
        of_speed: f64,
    },
}

/// One phase of a duty cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phase {
    /// Duration of the phase \[s\].
    pub duration_s: f64,
    /// What the joint does.
    pub kind: PhaseKind,
}

/// A cycle that the joint repeats for its whole life.
///
/// The mean values follow the vendor (Harmonic Drive, engineering data 1019659, Eqs 18.2 and 18.5). The mean torque is the
/// cubic mean weighted by time *and* speed; the mean speed counts pauses. When a lift is followed by a lowering, the
/// torques of the two ramps change places, and the mean of the pair stays the same.
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

    /// Ratio of mean speed to full speed, pauses included.
    pub fn mean_speed_fraction(&self) -> f64 {
        let total: f64 = self.phases.iter().map(|p| p.duration_s).sum();
        if total > 0.0 { self.travel_s() / total } else { 0.0 }
    }

    /// Weights of the cubic mean torque. The mean of a cycle that never moves is its static torque.
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

    /// Travel of the whole cycle divided by the full speed \[s\].
    fn travel_s(&self) -> f64 {
        self.phases.iter().map(Phase::travel_s).sum()
    }
}

impl Phase {
    /// Travel of the phase divided by the full speed \[s\].
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
/// T_mean³ = sum (T + T_lin)³ + steady T³ + difference |T - T_lin|³. They add up to 1 for a cycle of ramps and travel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeanTorqueWeights {
    /// Weight of (T + T_lin)³.
    pub sum: f64,
    /// Weight of T³.
    pub steady: f64,
    /// Weight of |T - T_lin|³.
    pub difference: f64,
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
