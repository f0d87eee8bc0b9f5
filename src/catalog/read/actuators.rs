//! Rows of `actuators.csv`: motor, gear and bearing in one part. A row becomes a gear and a motor that go only with
//! each other.
//!
//! The ratings of an actuator hold at its output, with losses included. They become ratings of the motor, converted
//! to its shaft through a gear without losses. The gear itself has only the torsion curve, the bearing, the whole
//! mass and the largest torque, which limits emergency stops.

use super::envelope::envelope;
use super::gears::bearing;
use super::row::{Order, Row};
use super::usual;
use crate::catalog::envelope::Envelope;
use crate::catalog::gear::{Gear, GearKind, LifeLaw};
use crate::catalog::motor::{Motor, MotorKind};

/// The gear of an actuator; `None` if its name or source is blank or not valid.
pub(crate) fn gear(row: &Row) -> Option<Gear> {
    check(row);
    Some(Gear {
        id: model(row)?,
        series: model(row)?,
        kind: GearKind::Actuator,
        size: 1,
        ratio: ratio(row),
        life: LifeLaw::usual(GearKind::Actuator),
        rated_torque_nm: row.number("rated_torque_nm"),
        repeated_peak_torque_nm: None,
        average_torque_limit_nm: None,
        momentary_peak_torque_nm: row.number("peak_torque_nm"),
        max_input_speed_rpm: None,
        average_input_speed_limit_rpm: None,
        inertia_input_kgm2: Some(0.0),
        mass_component_set_kg: row.number("mass_kg"),
        mass_housed_unit_kg: row.number("mass_kg"),
        t1_nm: row.number("t1_nm"),
        t2_nm: row.number("t2_nm"),
        k1_nm_per_rad: row.number("k1_nm_per_rad"),
        k2_nm_per_rad: row.number("k2_nm_per_rad"),
        k3_nm_per_rad: row.number("k3_nm_per_rad"),
        hysteresis_loss_arcmin: None,
        backlash_arcmin: row.number("backlash_arcmin"),
        lost_motion_arcmin: None,
        transmission_accuracy_arcmin: None,
        tilting_stiffness_nm_per_rad: row.number("tilting_stiffness_nm_per_rad"),
        permissible_tilting_moment_nm: row.number("permissible_tilting_moment_nm"),
        bearing: bearing(row),
        buckling_torque_nm: None,
        ratcheting_torque_nm: None,
        envelope: envelope(row),
        efficiency: Some(1.0),
        provenance: row.provenance()?,
    })
}

/// The motor of an actuator, with the ratings converted to the motor's shaft; `None` if its name or source is blank or
/// not valid.
pub(crate) fn motor(row: &Row) -> Option<Motor> {
    let ratio = ratio(row);
    let at_shaft = |column: &str, factor: f64| row.number(column).map(|x| x * factor);
    Some(Motor {
        id: model(row)?,
        kind: MotorKind::OfActuator,
        vendor: row.text("vendor").to_string(),
        rated_torque_nm: at_shaft("rated_torque_nm", 1.0 / ratio),
        peak_torque_nm: at_shaft("peak_torque_nm", 1.0 / ratio),
        rated_speed_rpm: at_shaft("rated_speed_rpm", ratio),
        max_speed_rpm: at_shaft("max_speed_rpm", ratio),
        rotor_inertia_kgm2: at_shaft("inertia_output_kgm2", 1.0 / (ratio * ratio)),
        mass_kg: Some(0.0),
        curve: Vec::new(),
        rated_power_w: None,
        // the gear of the actuator has the size of the whole; its motor adds no length and has the same passage
        envelope: Envelope {
            outer_diameter_m: None,
            length_m: Some(0.0),
            hollow_bore_m: envelope(row).hollow_bore_m,
        },
        provenance: row.provenance()?,
    })
}

fn model(row: &Row) -> Option<String> {
    row.filled("model").map(String::from)
}

/// Reduction ratio of an actuator; 1 if the cell is blank. Only the motor's printed speed depends on it.
fn ratio(row: &Row) -> f64 {
    row.number("ratio").unwrap_or(1.0)
}

fn check(row: &Row) {
    let pairs = [
        ("rated_torque_nm", "peak_torque_nm", "the peak torque is not below the rated torque"),
        (
            "rated_speed_rpm",
            "max_speed_rpm",
            "the largest speed is not below the rated speed; both are the output's",
        ),
        ("k1_nm_per_rad", "k2_nm_per_rad", "a gear stiffens: K1 <= K2 <= K3"),
        ("k2_nm_per_rad", "k3_nm_per_rad", "a gear stiffens: K1 <= K2 <= K3"),
    ];
    for (low, high, hint) in pairs {
        row.ascending(&[(low, row.number(low)), (high, row.number(high))], Order::NotFalling, hint);
    }
    let breaks = [("t1_nm", row.number("t1_nm")), ("t2_nm", row.number("t2_nm"))];
    row.ascending(&breaks, Order::Rising, "the first segment of the torsion curve ends before the second");
    if let Some(speed) = row.number("max_speed_rpm").filter(|&speed| speed > 1000.0) {
        let hint = "speeds are the output's; the motor's are the ratio times as large";
        row.warn("max_speed_rpm", format!("= {speed} is fast for a joint"), hint);
    }
    usual::of_actuator(row);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalog::CatalogFile;
    use crate::catalog::read::log::Log;
    use crate::catalog::read::table::rows;

    #[test]
    fn an_actuator_is_a_gear_and_a_motor_whose_figures_give_those_of_the_whole() {
        let log = Log::default();
        let text = "model,ratio,rated_torque_nm,peak_torque_nm,rated_speed_rpm,max_speed_rpm,inertia_output_kgm2,mass_kg,\
            k1_nm_per_rad,source,confidence\nA-50,50,40,82,20,30,0.5,2.1,16000,a test,verified\n";
        let read = rows(CatalogFile::Actuators, "actuators.csv", text.as_bytes(), &log);
        let (gear, motor) = (gear(&read[0]).expect("sound"), motor(&read[0]).expect("sound"));
        assert!(log.faults.borrow().is_empty());
        assert!(gear.goes_with(&motor) && gear.kind == GearKind::Actuator);
        let back =
            |at_motor: Option<f64>| at_motor.map(|x| x * gear.ratio * gear.efficiency.expect("lossless"));
        assert_eq!([back(motor.rated_torque_nm), back(motor.peak_torque_nm)], [Some(40.0), Some(82.0)]);
        assert_eq!([motor.rated_speed_rpm, motor.max_speed_rpm], [Some(1000.0), Some(1500.0)]);
        assert_eq!(motor.rotor_inertia_kgm2.map(|j| j * 2500.0), Some(0.5));
        assert_eq!(gear.mass_housed_unit_kg.zip(motor.mass_kg), Some((2.1, 0.0)));
        assert_eq!(gear.single_slope_nm_per_rad(), Some(16000.0));
        assert_ne!(motor.id, "A-51");
        assert!(!Gear { id: "B".into(), ..gear }.goes_with(&motor));
    }

    #[test]
    fn the_passage_is_that_of_the_whole_and_the_motor_adds_no_length() {
        let log = Log::default();
        let text = "model,length_mm,hollow_bore_mm,bearing_pitch_diameter_m,bearing_static_load_rating_n,source,confidence\n\
            A,90,27,0.088,45000,a test,verified\n";
        let read = rows(CatalogFile::Actuators, "actuators.csv", text.as_bytes(), &log);
        let (gear, motor) = (gear(&read[0]).expect("sound"), motor(&read[0]).expect("sound"));
        assert_eq!((gear.envelope.length_m, motor.envelope.length_m), (Some(0.09), Some(0.0)));
        assert_eq!((gear.envelope.hollow_bore_m, motor.envelope.hollow_bore_m), (Some(0.027), Some(0.027)));
        assert_eq!(gear.bearing.pitch_diameter_m.zip(gear.bearing.static_load_rating_n), Some((0.088, 45e3)));
    }
}
