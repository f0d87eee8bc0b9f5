//! Torque that a motor can give at a speed: from its torque curve if the catalog has one, else from its rated and
//! peak torque.
//!
//! *Continuous torque.* It is interpolated linearly between the points of the curve and constant below the first
//! point. Without a curve the motor gives its rated torque up to the rated speed. Beyond it constant power is
//! assumed, T_rated n_rated / n. If the rated speed is blank, the rated torque is taken at every speed.
//!
//! *Peak torque.* A ramp passes through every speed up to the cruising speed, so the smallest peak torque of the curve
//! up to this speed is taken.

use super::drive::{Rating, known};
use crate::catalog::motor::{Motor, MotorCurvePoint};

/// Torque that the motor gives permanently at a speed \[N m\].
pub(super) fn continuous_torque_nm(motor: &Motor, speed_rpm: f64) -> Rating {
    if let Some(torque_nm) = at(motor, |point| point.continuous_torque_nm, speed_rpm) {
        return Ok(torque_nm);
    }
    let rated_nm = known(motor.rated_torque_nm, "motor rated_torque_nm")?;
    Ok(match motor.rated_speed_rpm {
        Some(rated_rpm) if speed_rpm > rated_rpm => rated_nm * rated_rpm / speed_rpm,
        _ => rated_nm,
    })
}

/// Torque that the motor holds permanently at rest \[N m\].
pub(super) fn standing_torque_nm(motor: &Motor) -> Rating {
    continuous_torque_nm(motor, 0.0)
}

/// Torque that the motor gives for a short time at every speed from rest up to `speed_rpm` \[N m\].
pub(super) fn peak_torque_nm(motor: &Motor, speed_rpm: f64) -> Rating {
    let peak = |point: &MotorCurvePoint| point.peak_torque_nm;
    match at(motor, peak, speed_rpm) {
        Some(at_speed_nm) => {
            let slower = motor.curve.iter().filter(|point| point.speed_rpm <= speed_rpm).filter_map(peak);
            Ok(slower.fold(at_speed_nm, f64::min))
        }
        None => known(motor.peak_torque_nm, "motor peak_torque_nm"),
    }
}

/// Speed of the last point of the torque curve \[rpm\]; `None` without a curve.
pub(super) fn largest_speed_rpm(motor: &Motor) -> Option<f64> {
    motor.curve.last().map(|point| point.speed_rpm)
}

/// The torque of the motor's curve at a speed \[N m\]. The function `torque_nm` returns the torque of a point. The
/// result is interpolated linearly between the points that state a torque, and is constant outside of them. `None` if
/// no point states a torque.
fn at(motor: &Motor, torque_nm: impl Fn(&MotorCurvePoint) -> Option<f64>, speed_rpm: f64) -> Option<f64> {
    let points: Vec<[f64; 2]> =
        motor.curve.iter().filter_map(|point| Some([point.speed_rpm, torque_nm(point)?])).collect();
    let (first, last) = (points.first()?, points.last()?);
    let speed_rpm = speed_rpm.clamp(first[0], last[0]);
    let after = points.iter().position(|point| point[0] >= speed_rpm)?;
    let [x1, y1] = points[after];
    match after.checked_sub(1).map(|before| points[before]) {
        Some([x0, y0]) => Some(y0 + (y1 - y0) * (speed_rpm - x0) / (x1 - x0)),
        None => Some(y1),
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::motor;
    use super::*;

    fn stepper() -> Motor {
        let point = |speed_rpm, continuous: f64, peak: f64| MotorCurvePoint {
            speed_rpm,
            continuous_torque_nm: Some(continuous),
            peak_torque_nm: Some(peak),
        };
        let mut stepper = motor("NEMA23", [1.9, 1.9], [300.0, 1500.0], 3e-5, 1.0);
        stepper.curve = vec![point(0.0, 1.8, 1.9), point(300.0, 1.0, 1.5), point(900.0, 0.4, 0.6)];
        stepper
    }

    #[test]
    fn torque_is_linear_between_the_points_and_the_least_up_to_the_speed_is_the_peak() {
        let stepper = stepper();
        let continuous = |rpm| continuous_torque_nm(&stepper, rpm).unwrap();
        assert_eq!([continuous(0.0), continuous(300.0), continuous(900.0)], [1.8, 1.0, 0.4]);
        assert!((continuous(150.0) - 1.4).abs() < 1e-12 && (continuous(600.0) - 0.7).abs() < 1e-12);
        assert!((peak_torque_nm(&stepper, 600.0).unwrap() - 1.05).abs() < 1e-12);
        assert_eq!(largest_speed_rpm(&stepper), Some(900.0));
        let mut dented = stepper.clone();
        dented.curve[1].peak_torque_nm = Some(0.2);
        assert_eq!(peak_torque_nm(&dented, 900.0), Ok(0.2), "it must pass 300 rpm on the way");
    }

    #[test]
    fn without_a_curve_the_power_is_constant_beyond_the_rated_speed() {
        let servo = motor("S", [2.0, 6.0], [3000.0, 6000.0], 3e-5, 1.0);
        assert_eq!(continuous_torque_nm(&servo, 3000.0), Ok(2.0));
        assert_eq!(continuous_torque_nm(&servo, 6000.0), Ok(1.0));
        assert_eq!(peak_torque_nm(&servo, 6000.0), Ok(6.0));
    }
}
