//! What an emergency stop asks of a motor that must make it without a brake.

use super::demand::{JointDemand, JointMotion, stop_torque_nm};
use super::drive::{Drive, MissingRating};
use super::motor_curve;
use crate::catalog::gear::GearKind;

/// The torque that an emergency stop asks of a motor, and what the motor can give, on the motor's side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MotorStop {
    /// Torque that stops load, rotor and gear input \[N m\].
    pub asked_nm: f64,
    /// Largest torque of the motor at every speed from rest to the speed of the cruising joint \[N m\].
    pub peak_nm: f64,
}

impl MotorStop {
    /// The stop that the motor of `drive` must make by itself. `Ok(None)` if it need not: a brake holds the joint, or the
    /// drive is an actuator, whose stop is one of its checks.
    ///
    /// The motor's torque is (T + s T_lin) η / N + s J_in N α. T + s T_lin is the torque of the stop at the output (see
    /// [`stop_torque_nm`]), and s is the emergency deceleration over the acceleration α of a ramp. The load drives the
    /// motor, so the losses of the gear help: its efficiency η multiplies the torque. The rotor is stopped without this
    /// help. No drive is excluded by this: a weaker motor stops the joint more slowly.
    ///
    /// # Errors
    /// The name of a rating that is needed and blank.
    pub(crate) fn of(
        drive: &Drive,
        motion: &JointMotion,
        demand: &JointDemand,
    ) -> Result<Option<Self>, MissingRating> {
        if motion.has_brake || drive.gear.kind == GearKind::Actuator {
            return Ok(None);
        }
        let factor = motion.stop.factor;
        let at_output_nm = stop_torque_nm(demand.static_torque_nm, demand.linear_torque_nm, factor);
        let of_load_nm = at_output_nm * drive.efficiency()? / drive.ratio();
        let of_rotor_nm = factor * drive.rotary_torque_motor_nm(motion)?;
        let peak_nm = motor_curve::peak_torque_nm(drive.motor, drive.motor_speed_rpm(motion))?;
        Ok(Some(Self { asked_nm: of_load_nm + of_rotor_nm, peak_nm }))
    }

    /// Whether the stop asks more than the motor can give.
    pub(crate) fn is_too_much(&self) -> bool {
        self.asked_nm > self.peak_nm
    }
}

#[cfg(test)]
mod tests {
    use super::super::requirement::MotionRequirement;
    use super::super::testing::{ample, component_set};
    use super::*;
    use crate::catalog::motor::Motor;

    /// The closed form, written out, for N = 100, η and J_in of the drive, and a stop at twice the acceleration of a ramp.
    #[test]
    fn losses_help_the_motor_to_stop_the_load_but_not_its_rotor() {
        let (mut gear, mut motor) = ample();
        gear.efficiency = Some(0.8);
        gear.inertia_input_kgm2 = Some(0.001);
        motor.rotor_inertia_kgm2 = Some(0.0005);
        let motion = MotionRequirement::default().joint_motion(1.25, None);
        assert!((motion.acceleration_rad_s2 - 4.0).abs() < 1e-12, "1 m/s in 0.2 s at 1.25 m");
        let demand = motion.demand_of_torques(300.0, 100.0);
        let stop = |motor: &Motor, motion: &JointMotion| {
            MotorStop::of(&component_set(&gear, motor), motion, &demand)
        };
        // (300 + 2 x 100) 0.8 / 100 + 2 x 0.0015 x 100 x 4 = 4.0 + 1.2
        motor.peak_torque_nm = Some(5.3);
        let enough = stop(&motor, &motion).expect("every rating is known").expect("no brake");
        assert!((enough.asked_nm - 5.2).abs() < 1e-12 && enough.peak_nm == 5.3, "{enough:?}");
        assert!(!enough.is_too_much());
        motor.peak_torque_nm = Some(5.1);
        assert!(stop(&motor, &motion).expect("known").expect("no brake").is_too_much());
        assert_eq!(stop(&motor, &motion.of_joint(None, true, None)), Ok(None), "a brake makes the stop");
        motor.rotor_inertia_kgm2 = None;
        assert_eq!(stop(&motor, &motion), Err(MissingRating("rotor_inertia_kgm2")));
    }

    #[test]
    fn the_stop_of_an_actuator_is_one_of_its_checks() {
        let (mut gear, motor) = ample();
        gear.kind = GearKind::Actuator;
        let motion = MotionRequirement::default().joint_motion(1.25, None);
        let demand = motion.demand_of_torques(300.0, 100.0);
        assert_eq!(MotorStop::of(&component_set(&gear, &motor), &motion, &demand), Ok(None));
    }
}
