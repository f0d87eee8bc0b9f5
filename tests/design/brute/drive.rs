//! Which drives hold a joint: Eqs 9-12 and the gears' limits.

use serde_json::{Value, json};
use std::f64::consts::TAU;

use super::bearing::{Bearing, Source};
use super::catalog::{Catalog, Row};
use super::demand::{Demand, Torques};
use super::fit::Sizes;
use super::study::Motion;

/// A gear and a motor with every figure that a check needs.
#[derive(Clone, Debug)]
pub struct Drive {
    pub gear: String,
    pub motor: String,
    pub mass_kg: f64,
    pub windup: Value,
    /// Of a housed gear.
    pub bearing: Option<Bearing>,
    pub sizes: Sizes,
    ratio: f64,
    efficiency: f64,
    inertia_kgm2: f64,
    rated_nm: f64,
    repeated_nm: f64,
    average_nm: f64,
    momentary_nm: f64,
    input_rpm: f64,
    average_input_rpm: f64,
    rated_life_h: f64,
    rated_life_rpm: f64,
    life_exponent: f64,
    motor_rated_nm: f64,
    motor_peak_nm: f64,
    motor_rpm: f64,
    motor_rated_rpm: Option<f64>,
}

/// The drives that a study's `drives` admits, lightest first, then by name.
pub fn candidates(filter: &Value, catalog: &Catalog) -> Vec<Drive> {
    let is_listed =
        |key: &str, name: &str| filter[key].as_array().is_none_or(|l| l.iter().any(|x| x == name));
    let is_ratio = |gear: &Row| {
        let ratio = gear.number("ratio");
        filter["ratios"].as_array().is_none_or(|ratios| ratios.iter().any(|r| r.as_f64() == ratio))
    };
    let mass_column = match filter["gear_mass"].as_str() {
        Some("component_set") => "mass_component_set_kg",
        _ => "mass_housed_unit_kg",
    };
    let mut drives = Vec::new();
    for gear in &catalog.gears {
        // other kinds only if the study names their series
        let is_asked =
            gear.text("kind").is_empty() || filter["gear_series"].is_array() || filter["gears"].is_array();
        if !is_asked
            || !is_listed("gear_series", gear.text("series"))
            || !is_listed("gears", &gear.id)
            || !is_ratio(gear)
        {
            continue;
        }
        for motor in &catalog.motors {
            let is_wanted_kind = match filter["motors"].as_array() {
                Some(kinds) => kinds.iter().any(|kind| is_kind(kind, motor)),
                None => filter["motor_models"].is_array() || motor.text("type") != "stepper",
            };
            if is_wanted_kind && is_listed("motor_models", &motor.id) {
                drives.extend(Drive::complete(gear, motor, mass_column));
            }
        }
    }
    drives.sort_by(|a, b| {
        a.mass_kg.total_cmp(&b.mass_kg).then_with(|| (&a.gear, &a.motor).cmp(&(&b.gear, &b.motor)))
    });
    drives
}

fn is_kind(word: &Value, motor: &Row) -> bool {
    let is_hydraulic = motor.text("type").starts_with("hydraulic");
    match word.as_str() {
        Some("electric") => !is_hydraulic && motor.text("type") != "stepper",
        Some("hydraulic") => is_hydraulic,
        other => panic!("the brute force does not know the motors {other:?}"),
    }
}

impl Drive {
    /// The pair, if nothing that has to be checked is blank.
    fn complete(gear: &Row, motor: &Row, mass_column: &str) -> Option<Self> {
        Some(Self {
            gear: gear.id.clone(),
            motor: motor.id.clone(),
            mass_kg: gear.number(mass_column)? + motor.number("mass_kg")?,
            windup: json!({
                "k1_nm_per_rad": gear.number("k1_nm_per_rad")?,
                "k2_nm_per_rad": gear.number("k2_nm_per_rad")?,
                "k3_nm_per_rad": gear.number("k3_nm_per_rad")?,
                "t1_nm": gear.number("t1_nm")?,
                "t2_nm": gear.number("t2_nm")?,
            }),
            bearing: (mass_column == "mass_housed_unit_kg").then(|| Bearing::of_gear(gear)),
            sizes: Sizes::of(gear, motor),
            ratio: gear.number("ratio")?,
            efficiency: gear.number("efficiency_rated_2000rpm")?,
            inertia_kgm2: gear.number("inertia_input_kgm2")? + motor.number("rotor_inertia_kgm2")?,
            rated_nm: gear.number("rated_torque_nm")?,
            repeated_nm: gear.number("repeated_peak_torque_nm")?,
            average_nm: gear.number("average_torque_limit_nm")?,
            momentary_nm: gear.number("momentary_peak_torque_nm")?,
            input_rpm: gear.number("max_input_speed_rpm")?,
            average_input_rpm: gear.number("average_input_speed_limit_rpm")?,
            rated_life_h: gear.number("rated_life_h")?,
            rated_life_rpm: gear.number("rated_life_speed_rpm")?,
            life_exponent: gear.number("life_exponent")?,
            motor_rated_nm: motor.number("rated_torque_nm")?,
            motor_peak_nm: motor.number("peak_torque_nm")?,
            motor_rpm: motor.number("max_speed_rpm").or(motor.number("rated_speed_rpm"))?,
            motor_rated_rpm: motor.number("rated_speed_rpm"),
        })
    }

    /// Whether the drive, with the bearing that the joint has beside it, holds the worst of all sizing poses.
    pub fn holds(&self, bearing: &Source, demand: &Demand, motion: &Motion) -> bool {
        let bearing = bearing.beside(self.bearing);
        let input_rpm = self.ratio * demand.speed_rad_s * 60.0 / TAU;
        let mean_rpm = 0.4 * input_rpm;
        input_rpm <= self.input_rpm
            && mean_rpm <= self.average_input_rpm
            && input_rpm <= self.motor_rpm
            && self.stays_cool(demand, input_rpm)
            && bearing.is_none_or(|b| b.holds(&demand.bearing, 0.4 * demand.speed_rad_s, motion.life_h))
            && self.holds_torques(demand, mean_rpm, motion)
    }

    /// Whether the root mean square of the motor's torque is within what it gives continuously, whichever way the joint
    /// turns: ramp up, three ramp times at speed, ramp down, five at rest.
    fn stays_cool(&self, demand: &Demand, input_rpm: f64) -> bool {
        let Torques { static_nm, linear_nm } = demand.worst;
        let own_nm = self.inertia_kgm2 * self.ratio * demand.acceleration_rad_s2;
        let through_gear_nm = |joint_nm: f64, moves: f64| match joint_nm * moves < 0.0 {
            true => joint_nm * self.efficiency / self.ratio,
            false => joint_nm / (self.ratio * self.efficiency),
        };
        let continuous_nm = match self.motor_rated_rpm {
            Some(rated_rpm) if input_rpm > rated_rpm => self.motor_rated_nm * rated_rpm / input_rpm,
            _ => self.motor_rated_nm,
        };
        [1.0, -1.0].into_iter().all(|moves| {
            let ramp_nm = |speeds_up: f64| {
                let turns = moves * speeds_up;
                through_gear_nm(static_nm + turns * linear_nm, moves) + turns * own_nm
            };
            let squares = ramp_nm(1.0).powi(2)
                + 3.0 * through_gear_nm(static_nm, moves).powi(2)
                + ramp_nm(-1.0).powi(2)
                + 5.0 * through_gear_nm(static_nm, 0.0).powi(2);
            (squares / 10.0).sqrt() <= continuous_nm
        })
    }

    fn holds_torques(&self, demand: &Demand, mean_rpm: f64, motion: &Motion) -> bool {
        let t = &demand.worst;
        let (slow, fast) = ((t.static_nm - t.linear_nm).abs(), t.static_nm + t.linear_nm);
        // Ramps run at half speed on average: weights 1/2, 3, 1/2 of t_a.
        let mean_nm = ((0.5 * fast.powi(3) + 3.0 * t.static_nm.powi(3) + 0.5 * slow.powi(3)) / 4.0).cbrt();
        let life_h =
            self.rated_life_h * (self.rated_nm / mean_nm).powf(self.life_exponent) * self.rated_life_rpm
                / mean_rpm;
        let gain = self.ratio * self.efficiency;
        let rotary_nm = self.inertia_kgm2 * self.ratio * demand.acceleration_rad_s2;
        fast <= self.repeated_nm
            && mean_nm <= self.average_nm
            && t.static_nm + demand.stop_factor * t.linear_nm <= self.momentary_nm
            && life_h >= motion.life_h
            && t.static_nm / gain <= self.motor_rated_nm
            && fast / gain + rotary_nm <= self.motor_peak_nm
    }
}
