//! Rows of `motor_curves.csv`: points of torque against speed.

use super::log::Log;
use super::row::Row;
use crate::catalog::Catalogs;
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
            false,
            "the peak torque is not below the continuous torque",
        );
        let point = MotorCurvePoint { speed_rpm, continuous_torque_nm, peak_torque_nm };
        curves.entry(model).or_default().push((row, point));
    }
    for (model, mut points) in curves {
        points.sort_by(|a, b| a.1.speed_rpm.total_cmp(&b.1.speed_rpm));
        let curve = points.iter().map(|(_, point)| *point).collect();
        match catalogs.motors.iter_mut().find(|motor| motor.id == model) {
            Some(motor) => motor.curve = curve,
            None => no_motor(catalogs, model, points[0].0),
        }
    }
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
