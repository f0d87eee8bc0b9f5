//! Physics for which the library has no effect. Campaigns with it must get the verdict that they are not explained.

use super::specimen::stiffness_nm_per_rad;
use super::{Dice, Specimen, three};
use nalgebra::{Rotation3, Unit, Vector3};
use serde_json::{Value, json};

/// Every kind at every place, to draw from.
pub fn everything() -> Vec<(&'static str, &'static str)> {
    vec![
        ("cubic_stiffness", "j2"),
        ("warming", "j2"),
        ("pose_dependent_stiffness", "j3"),
        ("base_slip", "base"),
        ("crooked_sensor", "static"),
        ("one_sided_stiffness", "j3"),
        ("cubic_stiffness", "j3"),
        ("warming", "j3"),
        ("pose_dependent_stiffness", "j2"),
        ("one_sided_stiffness", "j2"),
    ]
}

/// One of them, of a random size.
pub fn effect(dice: &mut Dice, name: &str, at: &str, size: f64) -> Value {
    let amount = match name {
        "cubic_stiffness" => 0.5,
        "warming" => 0.3,
        "pose_dependent_stiffness" => 0.25,
        "base_slip" => 1.5e-4,
        "crooked_sensor" => 0.25,
        "one_sided_stiffness" => 0.3,
        other => panic!("no size for {other}"),
    };
    json!({"effect": name, "at": at, "amount": amount * size * dice.between(0.8, 1.3)})
}

/// Kinds that came later than those of [`everything`], whose order seeds depend on: typical amount, and what it is at.
const FURTHER: [(&str, f64, &str); 10] = [
    // part of the wall that a link lacks; part of the shear modulus that a slit link lacks
    ("thin_wall", 0.25, "link"),
    ("slit", 0.5, "link"),
    // angle by which a joint's zero is off, by which the arm is out of level; part by which a link is longer
    ("zero_off", 0.03, "joint"),
    ("out_of_level", 0.03, "base"),
    ("length_off", 0.03, "link"),
    // friction as a part of the torque; compliance of a bearing about one axis of its housing, as a part of the joint's
    ("friction_of_load", 0.08, "joint"),
    ("bearing_about_one_axis", 0.5, "joint"),
    // parts by which tip forces are larger than stated, by which a reading grows a load, or from half of the tests on
    ("force_gauge", 0.08, "static"),
    ("creep", 0.03, "static"),
    ("late_gain", 0.06, "static"),
];

/// One of the kinds that came later, by its number, at a random place and of a random size.
pub fn further(dice: &mut Dice, specimen: &Specimen, number: usize, size: f64) -> Value {
    let (name, amount, place) = FURTHER[number % FURTHER.len()];
    let at = match place {
        "joint" | "link" => dice.pick(&specimen.named(place)).clone(),
        other => other.to_string(),
    };
    let sign = if dice.uniform() < 0.5 && ["zero_off", "length_off"].contains(&name) { -1.0 } else { 1.0 };
    json!({"effect": name, "at": at, "amount": sign * amount * size * dice.between(0.8, 1.3)})
}

/// The unknown physics of one campaign.
#[derive(Clone, Default)]
pub struct Unknown {
    name: String,
    at: String,
    amount: f64,
}

impl Unknown {
    /// Reads a hidden effect; `None` if it is not one of these.
    pub fn from_json(hidden: &Value) -> Option<Self> {
        let text = |key: &str| hidden[key].as_str().expect("text").to_string();
        let first = everything().into_iter().map(|(name, _)| name);
        let known = first.chain(FURTHER.map(|(name, ..)| name)).any(|name| hidden["effect"] == name);
        known.then(|| Self {
            name: text("effect"),
            at: text("at"),
            amount: hidden["amount"].as_f64().expect("amount"),
        })
    }

    fn is(&self, name: &str, joint: &str) -> bool {
        self.name == name && self.at == joint
    }

    /// Changes the arm as it is built.
    pub fn build(&self, arm: &mut Value) {
        let chain = arm["chain"].as_array_mut().expect("chain");
        let place = chain.iter().position(|part| part["name"] == self.at.as_str()).unwrap_or_default();
        let part = &mut chain[place];
        match self.name.as_str() {
            "thin_wall" => part["section"]["wall_m"] = scaled(&part["section"]["wall_m"], 1.0 - self.amount),
            "length_off" => {
                part["vector_m"] = json!(three(&part["vector_m"]).map(|x| (1.0 + self.amount) * x))
            }
            "bearing_about_one_axis" => {
                let k = stiffness_nm_per_rad(part).expect("stiffness");
                part["lean_nm_per_rad"] = json!(k / self.amount);
            }
            "zero_off" => turn(&mut chain[place..], self.amount),
            "out_of_level" => {
                let tilt = Rotation3::from_axis_angle(
                    &Unit::new_normalize(Vector3::new(0.8, 0.6, 0.0)),
                    self.amount,
                );
                chain.iter_mut().for_each(|part| turned(part, &tilt));
            }
            "slit" => {
                let material = part["material"].as_str().expect("material").to_string();
                part["material"] = json!("slit");
                let mut slit = arm["materials"][&material].clone();
                slit["shear_modulus_pa"] = scaled(&slit["shear_modulus_pa"], 1.0 - self.amount);
                arm["materials"]["slit"] = slit;
            }
            _ => {}
        }
    }

    /// Friction of a joint as a part of its torque.
    pub fn friction(&self, joint: &str) -> f64 {
        if self.is("friction_of_load", joint) { self.amount } else { 0.0 }
    }

    /// Factor on tip forces that the force gauge does not show.
    pub fn force_factor(&self) -> f64 {
        if self.name == "force_gauge" { 1.0 + self.amount } else { 1.0 }
    }

    /// Factor on a joint's stiffness when its angle is `angle_deg` and `part` of the tests are done.
    pub fn stiffness_factor(&self, joint: &str, angle_deg: f64, part: f64) -> f64 {
        if self.is("warming", joint) {
            // a gear that warms up softens, quickly at first
            return 1.0 / (1.0 + self.amount * (1.0 - (-3.0 * part).exp()));
        }
        if self.is("pose_dependent_stiffness", joint) {
            return 1.0 / (1.0 + self.amount * (2.0 * angle_deg.to_radians()).sin());
        }
        1.0
    }

    /// Twist of a joint beyond torque over stiffness, and the slope of that: \[rad\], \[rad/N m\].
    pub fn further_twist(&self, joint: &str, torque_nm: f64, k: f64) -> (f64, f64) {
        if self.is("cubic_stiffness", joint) {
            // hardening: the twist falls behind with the cube of the torque, at last in proportion
            let square = (torque_nm / (9e-4 * k)).powi(2);
            let behind = self.amount / k * square / (1.0 + square);
            return (-behind * torque_nm, -behind * (3.0 + square) / (1.0 + square));
        }
        if self.is("one_sided_stiffness", joint) && torque_nm > 0.0 {
            return (self.amount * torque_nm / k, self.amount / k);
        }
        (0.0, 0.0)
    }

    /// What a sensor shows for a true displacement of a tip at `tip_m` under load number `load` of a pose, `part` of the
    /// tests done \[mm\].
    pub fn reading_mm(
        &self,
        truth_mm: Vector3<f64>,
        tip_m: Vector3<f64>,
        load: usize,
        part: f64,
    ) -> Vector3<f64> {
        match self.name.as_str() {
            "crooked_sensor" => truth_mm.map(|d| d + self.amount * d * d.abs()),
            // the base slips on its bolts once, after two fifths of the tests
            "base_slip" if part > 0.4 => {
                truth_mm + 1e3 * self.amount * Vector3::new(0.6, 0.8, 0.0).cross(&tip_m)
            }
            "creep" => truth_mm * (1.0 + self.amount * load as f64),
            "late_gain" if part > 0.5 => truth_mm * (1.0 + self.amount),
            _ => truth_mm,
        }
    }
}

fn scaled(number: &Value, factor: f64) -> Value {
    json!(number.as_f64().expect("number") * factor)
}

/// Turns what is outboard of a joint, the first of the parts, about its axis.
fn turn(parts: &mut [Value], angle_rad: f64) {
    let axis = Unit::new_normalize(Vector3::from(three(&parts[0]["axis"])));
    let rotation = Rotation3::from_axis_angle(&axis, angle_rad);
    parts[1..].iter_mut().for_each(|part| turned(part, &rotation));
}

fn turned(part: &mut Value, rotation: &Rotation3<f64>) {
    for key in ["axis", "vector_m"] {
        if part[key].is_array() {
            let turned: [f64; 3] = (rotation * Vector3::from(three(&part[key]))).into();
            part[key] = json!(turned);
        }
    }
}
