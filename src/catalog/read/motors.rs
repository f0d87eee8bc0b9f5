//! Rows of `motors.csv`, and the checks within one row.

use super::envelope::envelope;
use super::row::{Order, Row};
use crate::catalog::motor::{Motor, MotorKind};
use std::f64::consts::PI;

/// The motor that a row describes; `None` if its name, type or source is blank or not valid.
pub(crate) fn motor(row: &Row) -> Option<Motor> {
    check(row);
    Some(Motor {
        id: row.filled("model")?.to_string(),
        kind: MotorKind::from_word(row.text("type"))?,
        vendor: row.text("vendor").to_string(),
        rated_torque_nm: row.number("rated_torque_nm"),
        peak_torque_nm: row.number("peak_torque_nm"),
        rated_speed_rpm: row.number("rated_speed_rpm"),
        max_speed_rpm: row.number("max_speed_rpm"),
        rotor_inertia_kgm2: row.number("rotor_inertia_kgm2"),
        mass_kg: row.number("mass_kg"),
        curve: Vec::new(),
        rated_power_w: row.number("rated_power_w"),
        envelope: envelope(row),
        provenance: row.provenance()?,
    })
}

fn check(row: &Row) {
    let pairs = [
        ("rated_torque_nm", "peak_torque_nm", "the peak torque is not below the continuous torque"),
        ("rated_speed_rpm", "max_speed_rpm", "the largest speed is not below the rated speed"),
        (
            "pressure_continuous_bar",
            "pressure_intermittent_bar",
            "the intermittent pressure is not below the continuous",
        ),
    ];
    for (low, high, hint) in pairs {
        row.ascending(&[(low, row.number(low)), (high, row.number(high))], Order::NotFalling, hint);
    }
    power(row);
    inertia(row);
    usual_torque(row);
    usual_speed(row);
}

/// Usual continuous torque of a motor for each kilogram of its mass \[N m/kg\]. Motors of the built-in catalogs have 0.19
/// (a small brushless servo) to 28 (a hydraulic orbital motor).
const TORQUE_NM_PER_KG: [f64; 2] = [0.005, 60.0];
/// Largest usual ratio of the largest speed to the rated speed. Motors of the built-in catalogs have 1 to 2.7.
const MOST_SPEED_RATIO: f64 = 8.0;

/// Warns if the continuous torque is unusual for the motor's mass.
fn usual_torque(row: &Row) {
    if let (Some(torque_nm), Some(mass_kg)) = (row.number("rated_torque_nm"), row.number("mass_kg")) {
        let nm_per_kg = torque_nm / mass_kg;
        let [low, high] = TORQUE_NM_PER_KG;
        if !(low..=high).contains(&nm_per_kg) {
            row.warn(
                "rated_torque_nm",
                format!("= {torque_nm} gives {nm_per_kg:.3e} N m for each kg"),
                &format!(
                    "usual: {low} to {high} N m/kg; a slip of unit? (1 N mm = 0.001 N m, 1 N cm = 0.01 N m)"
                ),
            );
        }
    }
}

/// Warns if the rated speed is unusually far below the largest speed.
fn usual_speed(row: &Row) {
    if let (Some(rated_rpm), Some(most_rpm)) = (row.number("rated_speed_rpm"), row.number("max_speed_rpm")) {
        let ratio = most_rpm / rated_rpm;
        if ratio > MOST_SPEED_RATIO {
            row.warn(
                "rated_speed_rpm",
                format!("= {rated_rpm} is 1/{ratio:.1} of max_speed_rpm = {most_rpm}"),
                &format!("usual: at least 1/{MOST_SPEED_RATIO}; a slip of unit? (1 rad/s = 9.55 rpm)"),
            );
        }
    }
}

/// Checks that the rated power of a row agrees with rated torque times rated speed, P = T ω.
fn power(row: &Row) {
    let figures = (row.number("rated_torque_nm"), row.number("rated_speed_rpm"), row.number("rated_power_w"));
    if let (Some(torque_nm), Some(speed_rpm), Some(power_w)) = figures {
        row.agrees(
            "rated_power_w",
            power_w,
            torque_nm * speed_rpm * PI / 30.0,
            "rated torque and speed",
            0.06,
            0.5,
        );
    }
}

/// Warns if the rotor's inertia is unusual for the motor's mass: the radius of gyration sqrt(J/m) is compared with
/// the usual range.
fn inertia(row: &Row) {
    if let (Some(inertia_kgm2), Some(mass_kg)) = (row.number("rotor_inertia_kgm2"), row.number("mass_kg")) {
        let radius_m = (inertia_kgm2 / mass_kg).sqrt();
        if !(0.001..=0.09).contains(&radius_m) {
            row.warn(
                "rotor_inertia_kgm2",
                format!("= {inertia_kgm2} gives sqrt(J/m) = {radius_m:.4} m"),
                "usual: 0.001 to 0.09 m; a slip of unit? (1 kg cm2 = 1e-4 kg m2)",
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalog::read::log::Log;
    use crate::catalog::read::table::rows;
    use crate::catalog::{CatalogFile, Envelope};

    #[test]
    fn torque_and_speed_in_other_units_are_warned_of() {
        let warned = |figures: &str| -> Vec<String> {
            let log = Log::default();
            let text = format!(
                "type,model,rated_torque_nm,mass_kg,rated_speed_rpm,max_speed_rpm,source,confidence\n\
                ac-servo,A,{figures},a test,verified\n"
            );
            rows(CatalogFile::Motors, "motors.csv", text.as_bytes(), &log)
                .iter()
                .for_each(|row| drop(motor(row)));
            log.warnings.borrow().iter().map(|warning| warning.field.clone()).collect()
        };
        assert_eq!(warned("1.3,1.8,3000,5000"), [""; 0]);
        assert_eq!(warned("1300,1.8,3000,5000"), ["rated_torque_nm"]);
        assert_eq!(warned("1.3,1.8,314,5000"), ["rated_speed_rpm"]);
    }

    #[test]
    fn outer_sizes_of_motors_become_metres_and_blank_ones_stay_unknown() {
        let log = Log::default();
        let text = "type,model,source,confidence,outer_diameter_mm,length_mm,hollow_bore_mm\n\
            frameless-servo,A,a test,verified,69,22.5,42\n\
            ac-servo,B,a test,verified,,,\n";
        let read = rows(CatalogFile::Motors, "motors.csv", text.as_bytes(), &log);
        let sizes: Vec<_> = read.iter().filter_map(motor).map(|m| m.envelope).collect();
        let frameless =
            Envelope { outer_diameter_m: Some(0.069), length_m: Some(0.0225), hollow_bore_m: Some(0.042) };
        assert_eq!(sizes, [frameless, Envelope::default()]);
    }
}
