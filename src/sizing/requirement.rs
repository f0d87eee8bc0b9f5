//! What a study asks of the tip: speed, ramp, emergency stop, duty cycle, life.

use super::demand::JointMotion;

/// Which reading of Eq 8 gives the torque of linear acceleration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LinearReading {
    /// Sum over the outboard bodies of m a ρ² / r, that is inertia about the axis times a / r.
    Exact,
    /// The paper's (a / g) T; zero for a vertical axis, which has no static torque.
    Paper,
}

/// What a joint does during one phase of the duty cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PhaseKind {
    /// Speeding up: static plus linear torque, half the speed on average.
    Accelerate,
    /// Constant speed: static torque.
    Constant,
    /// Slowing down: the difference of static and linear torque, half the speed on average.
    Decelerate,
    /// Standing still. Counts in the mean speed; turns no wave-generator bearing, so not in the mean torque.
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
    /// How long it lasts \[s\].
    pub duration_s: f64,
    /// What happens.
    pub kind: PhaseKind,
}

/// A cycle that the joint repeats for its whole life.
///
/// Mean values are the vendor's (Harmonic Drive, engineering data 1019659, Eqs 18.2 and 18.5): the mean
/// torque is the cubic mean weighted by time *and* speed, the mean speed counts pauses. A lift followed by
/// a lowering swaps the torques of the two ramps, which leaves the mean of the pair as it is.
#[derive(Debug, Clone, PartialEq)]
pub struct DutyCycle {
    /// The phases in order.
    pub phases: Vec<Phase>,
}

impl DutyCycle {
    /// The default: ramp up in t_a, move for 3 t_a, ramp down in t_a, rest for 5 t_a; half of the time in
    /// motion, 40 % of the full speed on average.
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

    /// Mean speed over full speed, pauses included.
    pub fn mean_speed_fraction(&self) -> f64 {
        let total: f64 = self.phases.iter().map(|p| p.duration_s).sum();
        if total > 0.0 { self.travel_s() / total } else { 0.0 }
    }

    /// The weights of the cubic mean torque. A cycle that never moves has its static torque as mean.
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

    /// Travel over full speed \[s\].
    fn travel_s(&self) -> f64 {
        self.phases.iter().map(Phase::travel_s).sum()
    }
}

impl Phase {
    /// Duration times mean speed over full speed \[s\].
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

/// Weights of the cubed torques in the cubic mean of a duty cycle:
/// T_mean³ = sum (T + T_lin)³ + steady T³ + difference |T - T_lin|³.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeanTorqueWeights {
    /// Weight of (T + T_lin)³.
    pub sum: f64,
    /// Weight of T³.
    pub steady: f64,
    /// Weight of |T - T_lin|³.
    pub difference: f64,
}

/// What a study asks of every joint.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionRequirement {
    /// Speed v of the tip \[m/s\].
    pub tip_speed_m_s: f64,
    /// Time t_a in which it is reached \[s\].
    pub ramp_time_s: f64,
    /// Deceleration of the tip in an emergency stop \[m/s²\]; `None` is twice v / t_a.
    pub emergency_deceleration_m_s2: Option<f64>,
    /// Smallest lever that turns tip speed into joint speed \[m\]: at 0.05 m a roll joint would be asked
    /// for 191 rpm.
    pub min_lever_m: f64,
    /// The cycle behind mean torque and mean speed.
    pub duty_cycle: DutyCycle,
    /// Required life of the gear, L10 \[h\].
    pub life_h: f64,
    /// Reading of Eq 8.
    pub linear_reading: LinearReading,
    /// Gravity \[m/s²\], used by the paper's reading of Eq 8.
    pub gravity_m_s2: f64,
}

impl Default for MotionRequirement {
    /// The paper's 1 m/s in 0.20 s; lever 0.3 m (191 degrees a second at most), 10 000 h.
    fn default() -> Self {
        Self {
            tip_speed_m_s: 1.0,
            ramp_time_s: 0.20,
            emergency_deceleration_m_s2: None,
            min_lever_m: 0.3,
            duty_cycle: DutyCycle::move_and_rest(0.20),
            life_h: 10_000.0,
            linear_reading: LinearReading::Exact,
            gravity_m_s2: 9.81,
        }
    }
}

impl MotionRequirement {
    /// Tip acceleration a = v / t_a \[m/s²\].
    pub fn tip_acceleration_m_s2(&self) -> f64 {
        self.tip_speed_m_s / self.ramp_time_s
    }

    /// Emergency deceleration over acceleration.
    pub fn stop_factor(&self) -> f64 {
        match self.emergency_deceleration_m_s2 {
            Some(deceleration) => deceleration / self.tip_acceleration_m_s2(),
            None => 2.0,
        }
    }

    /// What this asks of a joint whose axis the tip is at most `reach_m` away from.
    ///
    /// ω = `max_speed_rad_s` if the study gives one, else v / r with r = max(reach, least lever);
    /// α = ω / t_a, which is a / r (Eq 10, output side).
    pub fn joint_motion(&self, reach_m: f64, max_speed_rad_s: Option<f64>) -> JointMotion {
        let lever_m = reach_m.max(self.min_lever_m);
        let speed_rad_s = max_speed_rad_s.unwrap_or(self.tip_speed_m_s / lever_m);
        JointMotion {
            speed_rad_s,
            acceleration_rad_s2: speed_rad_s / self.ramp_time_s,
            ramp_time_s: self.ramp_time_s,
            acceleration_over_gravity: self.tip_acceleration_m_s2() / self.gravity_m_s2,
            linear_reading: self.linear_reading,
            stop_factor: self.stop_factor(),
            mean_speed_fraction: self.duty_cycle.mean_speed_fraction(),
            mean_torque: self.duty_cycle.mean_torque_weights(),
            life_h: self.life_h,
        }
    }

    /// Checks that every figure is usable.
    ///
    /// # Errors
    /// The first figure that is not: [`RequirementError`].
    pub fn validate(&self) -> Result<(), RequirementError> {
        positive("tip_speed_m_s", self.tip_speed_m_s)?;
        positive("ramp_time_s", self.ramp_time_s)?;
        positive("min_lever_m", self.min_lever_m)?;
        positive("life_h", self.life_h)?;
        positive("gravity_m_s2", self.gravity_m_s2)?;
        if let Some(deceleration) = self.emergency_deceleration_m_s2 {
            positive("emergency_deceleration_m_s2", deceleration)?;
        }
        self.duty_cycle.phases.iter().try_for_each(Phase::validate)?;
        positive("duty_cycle total duration_s", self.duty_cycle.phases.iter().map(|p| p.duration_s).sum())
    }
}

impl Phase {
    fn validate(&self) -> Result<(), RequirementError> {
        not_negative("duty_cycle duration_s", self.duration_s)?;
        if let PhaseKind::Fraction { of_static_torque, of_speed } = self.kind {
            not_negative("duty_cycle of_static_torque", of_static_torque)?;
            not_negative("duty_cycle of_speed", of_speed)?;
        }
        Ok(())
    }
}

/// Why a requirement cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RequirementError {
    /// A figure that must be greater than zero is not.
    #[error("{field} = {value} must be a finite number greater than 0")]
    NotPositive {
        /// Name of the figure.
        field: &'static str,
        /// Its value.
        value: f64,
    },
    /// A figure that must not be negative is.
    #[error("{field} = {value} must be a finite number, not negative")]
    Negative {
        /// Name of the figure.
        field: &'static str,
        /// Its value.
        value: f64,
    },
}

fn positive(field: &'static str, value: f64) -> Result<(), RequirementError> {
    let usable = value.is_finite() && value > 0.0;
    if usable { Ok(()) } else { Err(RequirementError::NotPositive { field, value }) }
}

fn not_negative(field: &'static str, value: f64) -> Result<(), RequirementError> {
    let usable = value.is_finite() && value >= 0.0;
    if usable { Ok(()) } else { Err(RequirementError::Negative { field, value }) }
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

    #[test]
    fn joint_speed_is_tip_speed_over_reach_and_the_lever_bounds_it() {
        let study = MotionRequirement { min_lever_m: 0.05, ..Default::default() };
        let j2 = study.joint_motion(1.35, None);
        assert!((j2.speed_rad_s - 1.0 / 1.35).abs() < 1e-15);
        assert!((j2.acceleration_rad_s2 - 5.0 / 1.35).abs() < 1e-14);
        let roll = study.joint_motion(0.0, None);
        assert!((super::super::rpm_from_rad_s(roll.speed_rad_s) - 190.986).abs() < 1e-3);
    }

    #[test]
    fn a_stated_joint_speed_overrides_the_lever_and_sets_the_acceleration() {
        let motion = MotionRequirement::default().joint_motion(1.35, Some(2.0));
        assert_eq!(motion.speed_rad_s, 2.0);
        assert!((motion.acceleration_rad_s2 - 10.0).abs() < 1e-12);
    }

    #[test]
    fn the_emergency_stop_is_twice_the_ramp_unless_stated() {
        let study = MotionRequirement::default();
        assert_eq!(study.stop_factor(), 2.0);
        let hard = MotionRequirement { emergency_deceleration_m_s2: Some(20.0), ..study };
        assert!((hard.stop_factor() - 4.0).abs() < 1e-15);
    }

    #[test]
    fn a_requirement_that_cannot_be_used_names_the_figure() {
        assert!(MotionRequirement::default().validate().is_ok());
        let still = MotionRequirement { ramp_time_s: 0.0, ..Default::default() };
        assert_eq!(
            still.validate().unwrap_err().to_string(),
            "ramp_time_s = 0 must be a finite number greater than 0"
        );
        let empty = MotionRequirement { duty_cycle: DutyCycle { phases: vec![] }, ..Default::default() };
        assert!(empty.validate().unwrap_err().to_string().contains("duty_cycle"));
        let back = Phase { duration_s: -1.0, kind: PhaseKind::Rest };
        let backward =
            MotionRequirement { duty_cycle: DutyCycle { phases: vec![back] }, ..Default::default() };
        assert!(matches!(backward.validate(), Err(RequirementError::Negative { .. })));
    }
}
