//! Special conditions of the tests of a campaign: masses at the tip, servos that are compliant, links that warm up.

use super::three;
use serde_json::{Value, json};

/// The conditions under which the tests of a campaign were made.
#[derive(Default)]
pub struct Conditions {
    /// Channel, mass and its centre of gravity from the tip, last frame.
    masses: Vec<(String, f64, [f64; 3])>,
    /// Channel, joint and stiffness.
    servos: Vec<(String, String, f64)>,
    /// Change of all moduli, and the number of rows in which 63 % of it comes.
    warming: Option<(f64, f64)>,
    /// Joint, and size and phase of the waves of its stiffness once and twice a turn.
    waves: Vec<(String, [(f64, f64); 2])>,
}

impl Conditions {
    /// Takes a hidden effect, if it is a condition of tests.
    pub fn takes(&mut self, hidden: &Value) -> bool {
        let p = &hidden["parameters"];
        let at = hidden["at"].as_str().expect("place").to_string();
        match hidden["effect"].as_str().expect("name") {
            "test_mass" => {
                let cg_m = if p["cg_m"].is_array() { three(&p["cg_m"]) } else { [0.0; 3] };
                self.masses.push((at, p["mass_kg"].as_f64().expect("mass"), cg_m));
            }
            "servo_compliance" => {
                let channel = p["channel"].as_str().expect("channel").to_string();
                self.servos.push((channel, at, p["stiffness_nm_per_rad"].as_f64().expect("stiffness")));
            }
            "thermal_modulus" => {
                self.warming =
                    Some((p["change"].as_f64().expect("change"), p["rows"].as_f64().expect("rows")));
            }
            "stiffness_waves" => {
                let size = |key: &str| p[key].as_f64().unwrap_or(0.0);
                let phase = |i: usize| p["phases_rad"][i].as_f64().unwrap_or(0.0);
                self.waves.push((at, [(size("once"), phase(0)), (size("twice"), phase(1))]));
            }
            _ => return false,
        }
        true
    }

    /// The arm as it is in a test of a channel, after so many rows: masses hang on rigid offsets that lead there and back.
    pub fn of(&self, channel: &str, mut arm: Value, row: usize) -> Value {
        if let Some((change, rows)) = self.warming {
            let factor = 1.0 + change * (1.0 - (-(row as f64) / rows).exp());
            for (_, material) in arm["materials"].as_object_mut().expect("materials") {
                for key in ["youngs_modulus_pa", "shear_modulus_pa"] {
                    material[key] = json!(material[key].as_f64().expect("modulus") * factor);
                }
            }
        }
        let chain = arm["chain"].as_array_mut().expect("chain");
        for (_, kg, cg_m) in self.masses.iter().filter(|(at, ..)| at == channel) {
            let offset = |name: &str, factor: f64, kg: f64| json!({"type": "link", "name": name, "vector_m": cg_m.map(|x| factor * x), "mass_kg": kg});
            chain.extend([offset("probe", 2.0, *kg), offset("probe_back", -2.0, 0.0)]);
        }
        arm
    }

    /// Factor on the stiffness of a joint at an angle.
    pub fn stiffness_factor(&self, joint: &str, angle_deg: f64) -> f64 {
        let q = angle_deg.to_radians();
        let own = self.waves.iter().filter(|(at, _)| at == joint);
        let softer = own.map(|(_, [(a, p), (b, r)])| a * (q + p).sin() + b * (2.0 * q + r).sin());
        1.0 / (1.0 + softer.sum::<f64>())
    }

    /// The joints that a servo holds in the tests of a channel, each with the servo's stiffness.
    pub fn servos(&self, channel: &str) -> impl Iterator<Item = (&String, f64)> {
        let own = self.servos.iter().filter(move |(at, ..)| at == channel);
        own.map(|(_, joint, k)| (joint, *k))
    }
}
