//! The sizing of a joint as JSON. The row of a joint that slides has forces and a speed along the travel in the place
//! of torques and a speed of turning.

use super::RAD_S_PER_RPM;
use super::sheet::JointSizingRow;
use serde::ser::Error;
use serde::{Serialize, Serializer};
use serde_json::{Map, Value, json};

/// Torque keys of a joint that turns, each with the force key of a joint that slides. Only the key is replaced: for a
/// joint that slides, the value is a force \[N\] already.
const OF_SLIDES: [(&str, &str); 6] = [
    ("static_torque_nm", "static_force_n"),
    ("linear_torque_nm", "linear_force_n"),
    ("rotary_torque_output_nm", "rotary_force_output_n"),
    ("total_torque_nm", "total_force_n"),
    ("stop_torque_nm", "stop_force_n"),
    ("mean_torque_nm", "mean_force_n"),
];

impl Serialize for JointSizingRow {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if !self.slides {
            return Self::serialize(self, serializer);
        }
        let turning = Self::serialize(self, serde_json::value::Serializer).map_err(S::Error::custom)?;
        let Value::Object(turning) = turning else { return turning.serialize(serializer) };
        turning.into_iter().map(of_slide).collect::<Map<String, Value>>().serialize(serializer)
    }
}

/// The entry of the JSON for a joint that slides, made from the entry `(key, value)` that a joint that turns has.
fn of_slide((key, value): (String, Value)) -> (String, Value) {
    match (OF_SLIDES.iter().find(|(turning, _)| *turning == key), key.as_str()) {
        (Some((_, sliding)), _) => (sliding.to_string(), value),
        (None, "joint_speed_rpm") => {
            let speed_m_s = value.as_f64().map(|rpm| rpm * RAD_S_PER_RPM);
            ("joint_speed_m_s".into(), json!(speed_m_s))
        }
        (None, _) => (key, value),
    }
}
