//! Rows of `motor_curves.csv`: points of torque against speed, of a motor at its shaft and of an actuator at its
//! output.

use super::log::Log;
use super::row::{Order, Row};
use crate::catalog::Catalogs;
use crate::catalog::gear::{Gear, GearKind};
use crate::catalog::motor::MotorCurvePoint;
use crate::input::json::closest;
use std::collections::BTreeMap;

/// Adds the torque curves of a file to the motors of `catalogs`. The points that the file has for a model replace all
/// points that an earlier file had for it.
pub(crate) fn attach(catalogs: &mut Catalogs, rows: &[Row]) {
    let mut curves: BTreeMap<&str, Vec<(&Row, MotorCurvePoint)>> = BTreeMap::new();
    for row in rows {
        let (Some(model), Some(speed_rpm)) = (row.filled("model"), row.number("speed_rpm")) else { continue };
        let [continuous_torque_nm, peak_torque_nm] =
            ["continuous_torque_nm", "peak_torque_nm"].map(|column| row.number(column));
        if continuous_torque_nm.is_none() && peak_torque_nm.is_none() {
            row.fault(
                "peak_torque_nm",
                "and continuous_torque_nm are both blank",
                "a point states at least one",
            );
        }
        row.ascending(
            &[("continuous_torque_nm", continuous_torque_nm), ("peak_torque_nm", peak_torque_nm)],
            Order::NotFalling,
            "the peak torque is not below the continuous torque",
        );
        let point = MotorCurvePoint { speed_rpm, continuous_torque_nm, peak_torque_nm };
        curves.entry(model).or_default().push((row, point));
    }
    for (model, mut points) in curves {
        points.sort_by(|a, b| a.1.speed_rpm.total_cmp(&b.1.speed_rpm));
        let curve: Vec<MotorCurvePoint> = points.iter().map(|(_, point)| *point).collect();
        let ratio = actuator_ratio(catalogs, model);
        match catalogs.motors.iter_mut().find(|motor| motor.id == model) {
            Some(motor) => motor.curve = at_shaft(curve, ratio),
            None => no_motor(catalogs, model, points[0].0),
        }
    }
}

/// Ratio of the actuator with this model; 1 if the model is a motor.
fn actuator_ratio(catalogs: &Catalogs, model: &str) -> f64 {
    let is_own = |gear: &&Gear| gear.kind == GearKind::Actuator && gear.id == model;
    catalogs.gears.iter().find(is_own).map_or(1.0, |gear| gear.ratio)
}

/// The points of a curve converted from the output of an actuator to its motor's shaft, without losses. The
/// ratings of `actuators.csv` are converted in the same way.
fn at_shaft(curve: Vec<MotorCurvePoint>, ratio: f64) -> Vec<MotorCurvePoint> {
    let converted = |point: MotorCurvePoint| MotorCurvePoint {
        speed_rpm: point.speed_rpm * ratio,
        continuous_torque_nm: point.continuous_torque_nm.map(|nm| nm / ratio),
        peak_torque_nm: point.peak_torque_nm.map(|nm| nm / ratio),
    };
    curve.into_iter().map(converted).collect()
}

fn no_motor(catalogs: &Catalogs, model: &str, row: &Row) {
    let known: Vec<&str> = catalogs.motors.iter().map(|motor| motor.id.as_str()).collect();
    let near = closest(model, &known).map(|near| format!("did you mean \"{near}\"? ")).unwrap_or_default();
    row.fault("model", format!("\"{model}\" is no motor"), &format!("{near}motors.csv names the motors"));
}

/// Warns of a curve with a single point. Its torque is then taken at every speed.
pub(crate) fn check(catalogs: &Catalogs, log: &Log) {
    for motor in catalogs.motors.iter().filter(|motor| motor.curve.len() == 1) {
        log.warn(
            &motor.provenance.file,
            Some(motor.provenance.line),
            "model",
            format!("{} has a torque curve of one point", motor.id),
            "give two speeds or more in motor_curves.csv".into(),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalog::CatalogFile;
    use crate::catalog::read::table::rows;

    /// The torques and speeds in the curve of an actuator hold at its output, as the ratings in its row do.
    #[test]
    fn the_curve_of_an_actuator_is_that_of_its_output() {
        let (log, mut catalogs) = (Log::default(), Catalogs::builtin());
        let text = "model,speed_rpm,continuous_torque_nm,peak_torque_nm,source,confidence\n\
            CHA-25A-100,0,60,150,a test,verified\nCHA-25A-100,50,40,,a test,verified\n";
        attach(&mut catalogs, &rows(CatalogFile::MotorCurves, "motor_curves.csv", text.as_bytes(), &log));
        assert!(log.faults.borrow().is_empty());
        let curve = &catalogs.motor("CHA-25A-100").expect("built in").curve;
        let numbers = curve.iter().map(|p| (p.speed_rpm, p.continuous_torque_nm, p.peak_torque_nm));
        assert_eq!(numbers.collect::<Vec<_>>(), [(0.0, Some(0.6), Some(1.5)), (5000.0, Some(0.4), None)]);
    }
}
