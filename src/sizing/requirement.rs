//! The motion that a study asks of the tip: speed, ramp, emergency stop, duty cycle, life.

use super::demand::{JointMotion, LinearReading, Stop};
use super::duty::{DutyCycle, Phase, PhaseKind};
use super::fit::FitRequirement;
use crate::arm::GRAVITY_M_S2;

/// The motion that a study asks of the tip, and the life it asks of every gear.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionRequirement {
    /// Speed v of the tip \[m/s\].
    pub tip_speed_m_s: f64,
    /// Time t_a in which the tip reaches its speed from rest \[s\].
    pub ramp_time_s: f64,
    /// Deceleration of the tip in an emergency stop \[m/s²\]; `None` means twice the normal acceleration v / t_a.
    pub emergency_deceleration_m_s2: Option<f64>,
    /// Smallest distance from axis to tip that is used to convert tip speed to joint speed \[m\]. Without it a roll
    /// joint would have to turn infinitely fast; with 0.05 m it needs 191 rpm for a
    /// tip speed of 1 m/s.
    pub min_lever_m: f64,
    /// The duty cycle over which mean torque, mean speed and motor heat are taken.
    pub duty_cycle: DutyCycle,
    /// Required life of the gear, L10 \[h\].
    pub life_h: f64,
    /// Which interpretation of Eq 8 of docs/model.md, the torque of linear acceleration, is used.
    pub linear_reading: LinearReading,
    /// Gravity \[m/s²\], used by the interpretation [`LinearReading::Paper`] of Eq 8.
    pub gravity_m_s2: f64,
    /// Whether heating of the motors is checked: the root mean square of their torque over the cycle.
    pub checks_motor_heat: bool,
    /// Number of emergency stops that every gear must withstand in its life; `None` means that this is not checked.
    pub emergency_stops: Option<f64>,
}

impl Default for MotionRequirement {
    /// The paper's 1 m/s reached in 0.20 s, a smallest lever of 0.3 m (joint speeds up to 191 degrees per second) and
    /// 10 000 h of life.
    fn default() -> Self {
        Self {
            tip_speed_m_s: 1.0,
            ramp_time_s: 0.20,
            emergency_deceleration_m_s2: None,
            min_lever_m: 0.3,
            duty_cycle: DutyCycle::move_and_rest(0.20),
            life_h: 10_000.0,
            linear_reading: LinearReading::Exact,
            gravity_m_s2: GRAVITY_M_S2,
            checks_motor_heat: true,
            emergency_stops: None,
        }
    }
}

impl MotionRequirement {
    /// Tip acceleration a = v / t_a \[m/s²\].
    pub fn tip_acceleration_m_s2(&self) -> f64 {
        self.tip_speed_m_s / self.ramp_time_s
    }

    /// The motion of a joint whose axis is at most `reach_m` \[m\] away from the tip.
    ///
    /// The speed ω is `max_speed_rad_s` \[rad/s\] if the study states one, else v / r with r the larger of `reach_m`
    /// and the smallest lever. The acceleration is α = ω / t_a, which equals a / r (Eq 10, output side). The
    /// deceleration in an emergency stop is that of the tip over r, where the study states one.
    ///
    /// ```
    /// use armwright::sizing::MotionRequirement;
    ///
    /// let motion = MotionRequirement::default().joint_motion(1.35, None);
    /// assert!((motion.speed_rad_s - 1.0 / 1.35).abs() < 1e-12);
    /// assert!((motion.acceleration_rad_s2 - 5.0 / 1.35).abs() < 1e-12);
    /// // a roll joint with the tip on its axis gets the smallest lever, 0.3 m
    /// let roll = MotionRequirement::default().joint_motion(0.0, None);
    /// assert!((roll.speed_rad_s - 1.0 / 0.3).abs() < 1e-12);
    /// ```
    pub fn joint_motion(&self, reach_m: f64, max_speed_rad_s: Option<f64>) -> JointMotion {
        let lever_m = reach_m.max(self.min_lever_m);
        let speed_rad_s = max_speed_rad_s.unwrap_or(self.tip_speed_m_s / lever_m);
        let acceleration_rad_s2 = speed_rad_s / self.ramp_time_s;
        let stop = Stop::new(self.emergency_deceleration_m_s2.map(|a| a / lever_m), acceleration_rad_s2);
        JointMotion {
            speed_rad_s,
            acceleration_rad_s2,
            ramp_time_s: self.ramp_time_s,
            acceleration_over_gravity: self.tip_acceleration_m_s2() / self.gravity_m_s2,
            linear_reading: self.linear_reading,
            stop,
            mean_speed_fraction: self.duty_cycle.mean_speed_fraction(),
            mean_torque: self.duty_cycle.mean_torque_weights(),
            life_h: self.life_h,
            heat: self.duty_cycle.heat_weights(),
            checks_motor_heat: self.checks_motor_heat,
            has_brake: false,
            stated: None,
            emergency_stops: self.emergency_stops,
            fit: FitRequirement::default(),
        }
    }

    /// Checks that every number is usable.
    ///
    /// # Errors
    /// [`RequirementError`] for the first number that cannot be used.
    pub fn validate(&self) -> Result<(), RequirementError> {
        positive("tip_speed_m_s", self.tip_speed_m_s)?;
        positive("ramp_time_s", self.ramp_time_s)?;
        positive("min_lever_m", self.min_lever_m)?;
        positive("life_h", self.life_h)?;
        positive("gravity_m_s2", self.gravity_m_s2)?;
        if let Some(deceleration) = self.emergency_deceleration_m_s2 {
            positive("emergency_deceleration_m_s2", deceleration)?;
        }
        if let Some(stops) = self.emergency_stops {
            positive("emergency_stops", stops)?;
        }
        self.duty_cycle.phases.iter().try_for_each(Phase::validate)?;
        if let Some([up_s, down_s]) = self.duty_cycle.unequal_ramps_s() {
            return Err(RequirementError::UnequalRamps { up_s, down_s });
        }
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

/// Why a motion requirement cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RequirementError {
    /// A number that must be greater than zero is not.
    #[error("{field} = {value} must be a finite number greater than 0")]
    NotPositive {
        /// Name of the number.
        field: &'static str,
        /// Value of the number.
        value: f64,
    },
    /// A number that must not be negative is negative.
    #[error("{field} = {value} must be a finite number, not negative")]
    Negative {
        /// Name of the number.
        field: &'static str,
        /// Value of the number.
        value: f64,
    },
    /// The ramps up and the ramps down of a cycle take different total times. The joint has one acceleration, so it
    /// would not come back to rest.
    #[error(
        "duty_cycle speeds up for {up_s} s and slows down for {down_s} s; both happen at one acceleration, so they take \
         equally long"
    )]
    UnequalRamps {
        /// Total time of speeding up \[s\].
        up_s: f64,
        /// Total time of slowing down \[s\].
        down_s: f64,
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
    use super::super::RAD_S_PER_RPM;
    use super::super::stated::{StatedDuty, StatedPhase};
    use super::*;

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
        assert_eq!(study.joint_motion(1.35, None).stop.factor, 2.0);
        let hard = MotionRequirement { emergency_deceleration_m_s2: Some(20.0), ..study };
        assert!((hard.joint_motion(1.35, None).stop.factor - 4.0).abs() < 1e-15);
    }

    /// The tip is stopped as hard as stated, however fast the joint turns and however gently it ramps otherwise.
    #[test]
    fn a_stated_stop_is_that_of_the_tip_whatever_the_ramps_of_the_joint() {
        let study = MotionRequirement { emergency_deceleration_m_s2: Some(20.0), ..Default::default() };
        let phase = |time_s, speed_rpm| StatedPhase { torque_nm: 5.0, time_s, speed_rpm };
        let phases = vec![phase(1.0, 10.0), phase(3.0, 20.0), phase(1.0, 10.0), phase(2.0, 0.0)];
        let duty = StatedDuty { phases };
        let slow = study.joint_motion(1.25, Some(0.5));
        let gentle = study.joint_motion(1.25, None).of_joint(None, false, Some(&duty));
        assert!((gentle.acceleration_rad_s2 - 20.0 * RAD_S_PER_RPM).abs() < 1e-12, "0 to 20 rpm in a second");
        for motion in [slow, gentle] {
            let stop_rad_s2 = motion.acceleration_rad_s2 * motion.stop.factor;
            assert!((stop_rad_s2 - 20.0 / 1.25).abs() < 1e-12, "{motion:?}");
            assert!((motion.stop_time_s() - motion.speed_rad_s / stop_rad_s2).abs() < 1e-12, "{motion:?}");
        }
    }

    #[test]
    fn a_requirement_that_cannot_be_used_names_the_number() {
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
        let ramp = |kind, duration_s| Phase { duration_s, kind };
        let phases = vec![ramp(PhaseKind::Accelerate, 0.2), ramp(PhaseKind::Decelerate, 0.3)];
        let lame = MotionRequirement { duty_cycle: DutyCycle { phases }, ..Default::default() };
        assert_eq!(
            lame.validate().unwrap_err().to_string(),
            "duty_cycle speeds up for 0.2 s and slows down for 0.3 s; both happen at one acceleration, so they take \
             equally long"
        );
    }
}
