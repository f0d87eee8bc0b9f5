//! Physics that no effect of the library has, for campaigns that must end as unexplained.

use super::Dice;
use nalgebra::Vector3;
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
        let known = everything().iter().any(|(name, _)| hidden["effect"] == *name);
        known.then(|| Self {
            name: text("effect"),
            at: text("at"),
            amount: hidden["amount"].as_f64().expect("amount"),
        })
    }

    fn is(&self, name: &str, joint: &str) -> bool {
        self.name == name && self.at == joint
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

    /// What a sensor shows for a true displacement of a tip at `tip_m`, `part` of the tests done \[mm\].
    pub fn reading_mm(&self, truth_mm: Vector3<f64>, tip_m: Vector3<f64>, part: f64) -> Vector3<f64> {
        match self.name.as_str() {
            "crooked_sensor" => truth_mm.map(|d| d + self.amount * d * d.abs()),
            // the base slips on its bolts once, after two fifths of the tests
            "base_slip" if part > 0.4 => {
                truth_mm + 1e3 * self.amount * Vector3::new(0.6, 0.8, 0.0).cross(&tip_m)
            }
            _ => truth_mm,
        }
    }
}
