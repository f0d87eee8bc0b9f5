//! The largest torques and forces that the joints of an arm file may have at rest.
//!
//! A file states them: the `import.json` of a robot, or one that the user writes. If there is none, the average torque
//! of the gear and the continuous torque of the motor are the limits, as far as the catalogs have them.

use crate::arm::keys::POSITIVE_OR_NULL;
use crate::arm::pose::Motion;
use crate::arm::{Arm, Element, Joint};
use crate::catalog::Catalogs;
use crate::catalog::gear::GearKind;
use crate::input::json::{Document, Faults, Node, Object, closest};
use crate::input::key::{Kind, Shape, optional, required};
use crate::input::schema::FileKind;

/// The largest torque or force that a joint may have at rest.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LoadLimit {
    /// Name of the joint.
    pub joint: String,
    /// Name of the limit, such as the continuous torque of the motor.
    pub check: &'static str,
    /// Largest permitted torque \[N m\]; of a prismatic joint, largest permitted force along its travel \[N\].
    pub most: f64,
}

const TORQUE: &str = "max_torque_nm";
const FORCE: &str = "max_force_n";

/// The format of a file with limits.
pub(crate) const LIMITS_FILE: FileKind = FileKind {
    name: "limits",
    about: "What `armwright capacity --limits` takes: the largest torques and forces of joints. `import.json` is such a file.",
    root: Kind::Object(&LIMITS),
};

static LIMITS: Shape = Shape {
    name: "limits",
    about: "Limits of joints at rest. An `import.json` has other keys besides, which are not read.",
    keys: &[required("joints", Kind::List(&Kind::Object(&LIMIT)), "-", "The joints with limits.")],
    rules: &[],
    others: Some(&Kind::Anything),
};

static LIMIT: Shape = Shape {
    name: "limit",
    about: "The limit of a joint.",
    keys: &[
        required("name", Kind::Text, "-", "Name of the joint."),
        optional(TORQUE, POSITIVE_OR_NULL, "N m", "none", "Largest torque at rest of a joint that turns."),
        optional(
            FORCE,
            POSITIVE_OR_NULL,
            "N",
            "none",
            "Largest force at rest along the travel of a prismatic joint.",
        ),
    ],
    rules: &[],
    others: Some(&Kind::Anything),
};

/// Checks a file of limits without its arm: every joint has a name, and every limit is above zero.
///
/// # Errors
/// All faults of the file at once.
pub(crate) fn check_limits(document: Document) -> Result<(), Faults> {
    let root = document.root();
    let checked = match root.value().get("joints") {
        Some(_) => check_joints(&root),
        None => {
            root.fault("has no \"joints\"", "write {\"joints\": [{\"name\": \"j1\", \"max_torque_nm\": 87}]}")
        }
    };
    document.finish(checked)
}

fn check_joints(root: &Node) -> Option<()> {
    let all: Vec<Option<()>> = any_object(root)?
        .required("joints")?
        .array()?
        .iter()
        .map(|node| {
            let joint = any_object(node)?;
            joint.required("name")?.string()?;
            let limits = [TORQUE, FORCE].into_iter().filter_map(|key| joint.optional(key));
            let sound: Vec<Option<f64>> =
                limits.filter(|node| !node.is_null()).map(|node| node.positive()).collect();
            sound.into_iter().all(|limit| limit.is_some()).then_some(())
        })
        .collect();
    all.into_iter().collect()
}

/// Reads the limits of joints from a file with `{"joints": [{"name": "j1", "max_torque_nm": 87}]}`, such as
/// `import.json`. A prismatic joint has `max_force_n`. Joints without a number have no limit.
///
/// # Errors
/// All faults of the file at once: keys that are unknown, joints that the arm does not have, limits of the wrong kind.
pub(crate) fn read_limits(document: Document, arm: &Arm) -> Result<Vec<LoadLimit>, Faults> {
    let limits = read_joints(&document.root(), arm);
    document.finish(limits)
}

fn read_joints(root: &Node, arm: &Arm) -> Option<Vec<LoadLimit>> {
    // an import.json also describes the robot, so keys that state no limit are allowed in it
    let of_import = root.value().get("robot").is_some() && root.value().get("tip").is_some();
    let Some(joints) = object(root, &["joints"], of_import)?.optional("joints") else {
        return root.fault("has no \"joints\"", &format!("write {}", example(arm)));
    };
    let mut named: Vec<String> = Vec::new();
    let mut limits = Some(Vec::new());
    for node in joints.array()? {
        let limit = object(&node, &["name", TORQUE, FORCE], of_import).and_then(|joint| {
            let name = joint.required("name")?;
            let text = name.string()?;
            if named.iter().any(|known| known == text) {
                return name.fault(format!("\"{text}\" occurs twice"), "give one limit for each joint");
            }
            named.push(text.to_string());
            read_limit(&joint, &name, text, arm)
        });
        limits = limits.zip(limit).map(|(all, limit)| all.into_iter().chain(limit).collect());
    }
    limits
}

/// Reads a node as an object. Its keys must be among `known`, unless `of_import` is true (the file is an `import.json`,
/// in which other keys are allowed). Returns `None` after recording a fault.
fn object<'a>(node: &Node<'a>, known: &[&str], of_import: bool) -> Option<Object<'a>> {
    if of_import { any_object(node) } else { node.object(known) }
}

/// A node as an object with any keys. Returns `None` after recording a fault.
fn any_object<'a>(node: &Node<'a>) -> Option<Object<'a>> {
    let all: Vec<&str> = node.entries()?.into_iter().map(|(key, _)| key).collect();
    node.object(&all)
}

/// Reads the limit of the joint with the name `text`. Faults of the name are recorded at the node `name`. The outer
/// `None` means a fault, the inner `None` that the file states no limit.
fn read_limit(joint: &Object, name: &Node, text: &str, arm: &Arm) -> Option<Option<LoadLimit>> {
    let Some(motion) = motion_of(arm, text) else {
        let names: Vec<&str> = joint_names(arm).collect();
        let all = format!("joints of {}: {}", arm.name, names.join(", "));
        let hint =
            closest(text, &names).map_or(all.clone(), |near| format!("did you mean \"{near}\"? {all}"));
        return name.fault(format!("the arm has no joint \"{text}\""), &hint);
    };
    let (key, other, check, words) = match motion {
        Motion::Turns => (TORQUE, FORCE, "torque limit", "turns"),
        Motion::Slides => (FORCE, TORQUE, "force limit", "slides"),
    };
    let stated = |key| joint.optional(key).filter(|node: &Node| !node.is_null());
    if let Some(node) = stated(other) {
        return node.fault(format!("the joint \"{text}\" {words}"), &format!("give its {key}"));
    }
    match stated(key) {
        None => Some(None),
        Some(node) => Some(Some(LoadLimit { joint: text.to_string(), check, most: node.positive()? })),
    }
}

fn joint_names(arm: &Arm) -> impl Iterator<Item = &str> {
    arm.chain.iter().filter(|element| !matches!(element, Element::Link(_))).map(Element::name)
}

/// How the joint of this name moves; `None` if the arm has no such joint.
fn motion_of(arm: &Arm, name: &str) -> Option<Motion> {
    let element = arm.chain.iter().find(|element| element.name() == name)?;
    match element {
        Element::Joint(_) => Some(Motion::Turns),
        Element::Prismatic(_) => Some(Motion::Slides),
        Element::Link(_) => None,
    }
}

/// The text of an example file, for messages. It states a limit of the arm's first driven joint that turns, or of its
/// first prismatic joint if no joint turns.
pub(crate) fn example(arm: &Arm) -> String {
    let turning = arm.joints().find(|joint| joint.coupled.is_none()).map(|joint| joint.name.as_str());
    let (name, key) = match (turning, arm.prismatics().next()) {
        (None, Some(slide)) => (slide.name.as_str(), FORCE),
        (name, _) => (name.unwrap_or("j1"), TORQUE),
    };
    format!("{{\"joints\": [{{\"name\": \"{name}\", \"{key}\": 87}}]}}")
}

/// The torque limits of joints at rest that follow from the ratings of the gears and motors that an arm names. An
/// actuator is gear and motor in one part, so that it is enough to name it as the gear.
pub(crate) fn limits_of_parts(arm: &Arm, catalogs: &Catalogs) -> Vec<LoadLimit> {
    let of_joint = |joint: &Joint| {
        let gear = joint.gear.as_ref().and_then(|name| catalogs.gear(name).ok());
        let actuator =
            joint.gear.as_ref().filter(|_| gear.is_some_and(|gear| gear.kind == GearKind::Actuator));
        let motor = joint.motor.as_ref().or(actuator).and_then(|name| catalogs.motor(name).ok());
        let average_nm = gear.and_then(|gear| Some(gear.average_torque_limit_nm? * joint.stages.after.ratio));
        let continuous_nm = gear.zip(motor).and_then(|(gear, motor)| {
            let stages = &joint.stages;
            let efficiency =
                stages.before.efficiency * gear.efficiency.unwrap_or(1.0) * stages.after.efficiency;
            Some(motor.rated_torque_nm? * stages.whole_ratio(gear.ratio) * efficiency)
        });
        let limit =
            |check, most: Option<f64>| most.map(|most| LoadLimit { joint: joint.name.clone(), check, most });
        [
            limit("average torque of the gear", average_nm),
            limit("continuous torque of the motor", continuous_nm),
        ]
    };
    arm.joints().filter(|joint| joint.coupled.is_none()).flat_map(of_joint).flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::file::read_arm_document;

    #[test]
    fn every_fault_of_a_file_of_limits_is_found_with_what_exists() {
        let text = r#"{"name": "gantry", "chain": [{"type": "prismatic", "name": "z", "axis": [0, 0, 1], "stiffness_n_per_m": null},
            {"type": "joint", "name": "wrist", "axis": [0, 1, 0], "stiffness_nm_per_rad": null}]}"#;
        let arm = read_arm_document(Document::parse("a", text).expect("JSON"), &Catalogs::default())
            .expect("an arm");
        let read = |text: &str| read_limits(Document::parse("l.json", text).expect("JSON"), &arm);
        let sound =
            r#"{"joints": [{"name": "z", "max_force_n": 200}, {"name": "wrist", "max_torque_nm": null}]}"#;
        let limits = read(sound).expect("sound");
        assert_eq!(limits, [LoadLimit { joint: "z".into(), check: "force limit", most: 200.0 }]);
        let faults = read(
            r#"{"joints": [{"name": "z", "max_torque_nm": 5}, {"name": "Wrist", "max_torque_nm": 5},
            {"name": "wrist", "max_torque": 5}, {"name": "wrist", "max_torque_nm": -5}, {"max_torque_nm": 5}]}"#,
        );
        let said = faults.expect_err("five faults").to_string();
        for words in [
            "5 faults",
            "joints[0].max_torque_nm: the joint \"z\" slides; give its max_force_n",
            "the arm has no joint \"Wrist\"; did you mean \"wrist\"? joints of gantry: z, wrist",
            "joints[2].max_torque: unknown key; did you mean \"max_torque_nm\"?",
            "\"wrist\" occurs twice",
            "lacks \"name\"",
        ] {
            assert!(said.contains(words), "{words}: {said}");
        }
        assert!(
            read(r#"{"joint": []}"#)
                .expect_err("a fault")
                .to_string()
                .contains("\"wrist\", \"max_torque_nm\": 87")
        );
    }
}
