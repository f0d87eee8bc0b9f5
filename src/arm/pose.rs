//! Poses: the meaning of each entry of a pose, and how files and the command line write it.
//!
//! A pose has one entry for each driven joint, base to tip: the angle of a joint that turns \[deg\], or the travel of
//! a prismatic joint \[mm\]. If every joint turns, files may give the angles as a list, `"pose_deg": [0, 30]`. An
//! object with a unit in every key, `"pose": {"rail_mm": 250, "j2_deg": 30}`, is always allowed. It is required if a
//! joint slides, because a number in a list does not show its unit.

use crate::input::json::{Node, Object, closest};
use serde_json::{Map, Value, json};

/// How a driven joint moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// The joint turns about its axis; poses have its angle \[deg\].
    Turns,
    /// The joint slides along its axis; poses have its travel \[mm\].
    Slides,
}

impl Motion {
    /// Unit of an entry of a pose, as written in keys.
    pub fn unit(self) -> &'static str {
        match self {
            Motion::Turns => "deg",
            Motion::Slides => "mm",
        }
    }

    /// Converts an entry of a pose from degrees to radians, or from millimetres to metres.
    pub fn si(self, entry: f64) -> f64 {
        match self {
            Motion::Turns => entry.to_radians(),
            Motion::Slides => entry / 1e3,
        }
    }
}

/// A driven joint: it has an entry in every pose.
///
/// ```
/// use armwright::arm::{DrivenJoint, Motion};
///
/// let rail = DrivenJoint { name: "rail".into(), motion: Motion::Slides };
/// assert_eq!(rail.key(), "rail_mm");
/// assert_eq!(rail.motion.si(250.0), 0.25);
/// assert_eq!(DrivenJoint::turning("j2").key(), "j2_deg");
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DrivenJoint {
    /// Name of the joint.
    pub name: String,
    /// Whether the joint turns or slides.
    pub motion: Motion,
}

impl DrivenJoint {
    /// A joint that turns.
    pub fn turning(name: &str) -> Self {
        Self { name: name.into(), motion: Motion::Turns }
    }

    /// The key of this joint in a pose, such as `j2_deg` or `rail_mm`.
    pub fn key(&self) -> String {
        format!("{}_{}", self.name, self.motion.unit())
    }
}

/// Converts a pose from the units of files (degrees, millimetres) to radians and metres.
pub fn pose_si(driven: &[DrivenJoint], pose: &[f64]) -> Vec<f64> {
    driven.iter().zip(pose).map(|(joint, entry)| joint.motion.si(*entry)).collect()
}

/// A pose as files write it: the key (`pose_deg` or `pose`) and the value.
pub fn pose_json(driven: &[DrivenJoint], pose: &[f64]) -> (&'static str, Value) {
    if !any_slides(driven) {
        return ("pose_deg", json!(pose));
    }
    let entries: Map<String, Value> =
        driven.iter().zip(pose).map(|(joint, entry)| (joint.key(), json!(entry))).collect();
    ("pose", Value::Object(entries))
}

/// Whether some joint slides.
pub fn any_slides(driven: &[DrivenJoint]) -> bool {
    driven.iter().any(|joint| joint.motion == Motion::Slides)
}

/// An example of a pose for messages.
pub(crate) fn pose_example(driven: &[DrivenJoint]) -> String {
    let entries: Vec<String> = driven.iter().map(|joint| format!("\"{}\": 0", joint.key())).collect();
    format!("\"pose\": {{{}}}", entries.join(", "))
}

/// The pose that is given by keys such as `j2_deg` and their values. Joints that are not named stay at 0.
///
/// # Errors
/// The key that belongs to no joint, with advice what to write.
pub(crate) fn pose_of_keys<'a>(
    driven: &[DrivenJoint],
    entries: impl Iterator<Item = (&'a str, f64)>,
) -> Result<Vec<f64>, (String, String)> {
    let keys: Vec<String> = driven.iter().map(DrivenJoint::key).collect();
    let mut pose = vec![0.0; driven.len()];
    for (key, entry) in entries {
        match keys.iter().position(|k| k == key) {
            Some(place) => pose[place] = entry,
            None => return Err((key.to_string(), unknown_key(key, driven, &keys))),
        }
    }
    Ok(pose)
}

/// Advice what to write instead of `key`, a key in a pose that belongs to no joint.
fn unknown_key(key: &str, driven: &[DrivenJoint], keys: &[String]) -> String {
    // the name of a joint with a wrong unit, or without any unit
    let stem = key.rsplit_once('_').filter(|(_, unit)| matches!(*unit, "deg" | "mm" | "m" | "rad"));
    let stem = stem.map_or(key, |(stem, _)| stem);
    if let Some(joint) = driven.iter().find(|joint| joint.name == stem) {
        let moves = match joint.motion {
            Motion::Turns => "turns",
            Motion::Slides => "slides",
        };
        return format!("{stem} {moves}: write {}", joint.key());
    }
    let known: Vec<&str> = keys.iter().map(String::as_str).collect();
    match closest(key, &known) {
        Some(meant) => format!("did you mean {meant}? the entries are {}", known.join(", ")),
        None => format!("the entries are {}", known.join(", ")),
    }
}

/// Reads the pose of a case, from `pose_deg` or `pose`. An arm without driven joints needs neither. Returns `None`
/// after recording a fault.
pub(crate) fn read_pose(object: &Object, driven: &[DrivenJoint]) -> Option<Vec<f64>> {
    match (object.optional("pose_deg"), object.optional("pose")) {
        (Some(_), Some(pose)) => pose.fault("and \"pose_deg\" are both given", "keep the one that holds"),
        (Some(angles), None) => read_angles(&angles, driven),
        (None, Some(pose)) => read_entries(&pose, driven),
        (None, None) if any_slides(driven) => {
            object.node().fault("lacks \"pose\"", &format!("add {}", pose_example(driven)))
        }
        (None, None) => read_angles(&object.required("pose_deg")?, driven),
    }
}

/// Reads a pose that is one angle \[deg\] for each driven joint. Returns `None` after recording a fault.
fn read_angles(node: &Node, driven: &[DrivenJoint]) -> Option<Vec<f64>> {
    if any_slides(driven) {
        let slides = driven.iter().filter(|joint| joint.motion == Motion::Slides);
        let names: Vec<&str> = slides.map(|joint| joint.name.as_str()).collect();
        return node.fault(
            format!("has angles in degrees, and {} is a prismatic joint", names.join(", ")),
            &format!("write {} instead, with your numbers", pose_example(driven)),
        );
    }
    let items = node.array()?;
    if items.len() != driven.len() {
        let names: Vec<&str> = driven.iter().map(|joint| joint.name.as_str()).collect();
        return node.fault(
            format!("has {} angles, the arm has {} driven joints", items.len(), driven.len()),
            &format!("give one angle in degrees for each of {}", names.join(", ")),
        );
    }
    let angles: Vec<_> = items.iter().map(Node::number).collect();
    angles.into_iter().collect()
}

/// Reads a pose given as an object, with a joint and a unit in each key. Returns `None` after recording a fault.
fn read_entries(node: &Node, driven: &[DrivenJoint]) -> Option<Vec<f64>> {
    let entries = node.entries()?;
    let read: Vec<_> = entries.iter().map(|(key, n)| n.number().map(|entry| (*key, entry))).collect();
    let read: Vec<(&str, f64)> = read.into_iter().collect::<Option<_>>()?;
    match pose_of_keys(driven, read.into_iter()) {
        Ok(pose) => Some(pose),
        Err((key, hint)) => node.fault_below(&key, "is no entry of a pose of this arm", &hint),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::json::Document;

    fn read(text: &str) -> Result<Vec<f64>, String> {
        let rail = DrivenJoint { name: "rail".into(), motion: Motion::Slides };
        let driven = [rail, DrivenJoint::turning("j2")];
        let document = Document::parse("c.json", text).map_err(|faults| faults.to_string())?;
        let object = document.root().object(&["pose", "pose_deg"]);
        let pose = object.and_then(|object| read_pose(&object, &driven));
        document.finish(pose).map_err(|faults| faults.to_string())
    }

    #[test]
    fn a_pose_names_its_units_and_joints_left_away_stay_at_zero() {
        assert_eq!(read(r#"{"pose": {"j2_deg": 30, "rail_mm": 250}}"#), Ok(vec![250.0, 30.0]));
        assert_eq!(read(r#"{"pose": {"j2_deg": 30}}"#), Ok(vec![0.0, 30.0]));
    }

    #[test]
    fn a_pose_that_leaves_a_unit_open_is_a_fault_that_says_what_to_write() {
        for (text, says) in [
            (r#"{"pose_deg": [250, 30]}"#, r#"write "pose": {"rail_mm": 0, "j2_deg": 0}"#),
            (r#"{}"#, r#"add "pose": {"rail_mm": 0, "j2_deg": 0}"#),
            (r#"{"pose": {"rail_deg": 250}}"#, "rail slides: write rail_mm"),
            (r#"{"pose": {"rail": 250}}"#, "rail slides: write rail_mm"),
            (r#"{"pose": {"j2_mm": 250}}"#, "j2 turns: write j2_deg"),
            (r#"{"pose": {"rial_mm": 250}}"#, "did you mean rail_mm?"),
            (r#"{"pose": {"rail_mm": 1}, "pose_deg": [1]}"#, "both given"),
        ] {
            let fault = read(text).expect_err(text);
            assert!(fault.contains(says), "{text}: {fault}");
        }
    }
}
