//! Makes absolute positions of the tip of an arm that stands at an angle and whose lengths differ from its arm file.

use super::{Built, Dice, LoadCase, Payload, Plan, list, three, torque, witness};
use nalgebra::{Rotation3, Vector3};
use serde_json::{Value, json};

/// What `campaign.json` leaves free.
pub fn free() -> Value {
    json!({"file": "positions.csv", "base_placement": true, "joint_offsets": true, "geometry": true})
}

/// Changes every component of every link's vector.
pub fn with_lengths_off(dice: &mut Dice, arm: &mut Value, lengths_m: f64) {
    for part in arm["chain"].as_array_mut().expect("chain").iter_mut().filter(|p| p["type"] == "link") {
        let vector = three(&part["vector_m"]).map(|x| x + lengths_m * dice.normal());
        part["vector_m"] = json!(vector);
    }
}

impl Built {
    /// Positions in the frame of an instrument, with and without payload.
    pub fn positions(&self, dice: &mut Dice, plan: &Plan) -> String {
        let sigma_mm = 0.02;
        let askew = Rotation3::from_euler_angles(0.02, -0.01, 0.7);
        let mut out = format!(
            "test,{},payload_kg,payload_cg_x_m,payload_cg_y_m,payload_cg_z_m,x_mm,y_mm,z_mm,sigma_mm\n",
            self.angles(),
        );
        for test in 1..=plan.positions {
            let pose = self.pose(dice);
            let kg = [0.0, 5.0][test % 2];
            let case = LoadCase::unloaded(&pose).with_payload(Payload::point(kg, [0.05, 0.0, 0.0]));
            let answer = witness::analyze(&self.arm, &case, &self.options(0));
            let (tip_m, levers) = self.levers(&pose);
            let further = self.joints().into_iter().zip(&levers).map(|((name, _, k), lever)| {
                lever * self.beyond.unknown.further_twist(&name, torque(&answer, &name), k).0
            });
            let sag_m = answer.tip_displacement_m + further.sum::<Vector3<f64>>();
            let at = askew * (tip_m + sag_m) + Vector3::new(2.0, -1.0, 0.4);
            let read =
                [0, 1, 2].map(|c| format!("{:.4}", 1e3 * at[c] + sigma_mm * plan.noise * dice.normal()));
            out.push_str(&format!("{test},{},{kg},0.05,0,0,{},{sigma_mm}\n", list(&pose), read.join(",")));
        }
        out
    }
}
