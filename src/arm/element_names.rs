//! Names of the elements of an arm: each is unique, and none is the name of a part of another element.

use super::pieces::elements_of;
use super::pose::Motion;
use super::{Arm, Element, Joint};
use crate::input::json::{Node, Object};

/// Checks the names in an arm: the names of its elements, and the names of the joints to which coupled joints refer.
/// Returns `None` after recording a fault.
pub(super) fn check_names(arm: &Arm, root: &Object) -> Option<()> {
    let mut sound = true;
    let names: Vec<&str> = arm.chain.iter().map(Element::name).collect();
    let items = root.required("chain")?.array()?;
    let chain: Vec<&Node> = items.iter().flat_map(|n| std::iter::repeat_n(n, elements_of(n))).collect();
    for (i, name) in names.iter().enumerate() {
        if names[..i].contains(name) {
            chain[i]
                .fault::<()>(format!("the name \"{name}\" is taken"), "give every element a name of its own");
            sound = false;
        }
    }
    let joints: Vec<(&str, Motion)> = arm.chain.iter().filter_map(joint_of).collect();
    for (name, node) in names.iter().zip(&chain) {
        if let Some(joint) = part_of(name, joints.iter().copied()) {
            node.fault::<()>(part_problem(name, joint), PART_HINT);
            sound = false;
        }
    }
    let driven: Vec<String> = arm
        .driven_joints()
        .into_iter()
        .filter(|joint| joint.motion == Motion::Turns)
        .map(|joint| joint.name)
        .collect();
    for (element, node) in arm.chain.iter().zip(&chain) {
        let Element::Joint(Joint { coupled: Some(terms), .. }) = element else { continue };
        for (name, _) in terms.iter().filter(|(name, _)| !driven.contains(name)) {
            node.fault::<()>(
                format!("is coupled to \"{name}\", which is no driven joint that turns"),
                &format!("driven joints: {}", driven.join(", ")),
            );
            sound = false;
        }
    }
    sound.then_some(())
}

/// Name and motion of a joint; `None` for a link.
fn joint_of(element: &Element) -> Option<(&str, Motion)> {
    match element {
        Element::Joint(joint) => Some((&joint.name, Motion::Turns)),
        Element::Prismatic(joint) => Some((&joint.name, Motion::Slides)),
        Element::Link(_) => None,
    }
}

/// The joint among `joints` whose output bearing or guide has the name `name` in every result: `NAME.bearing` of a
/// joint that turns, `NAME.guide` of a prismatic joint. `None` if `name` is not the name of a bearing or a guide.
pub(crate) fn part_of<'n>(
    name: &str,
    mut joints: impl Iterator<Item = (&'n str, Motion)>,
) -> Option<&'n str> {
    let part = |motion| match motion {
        Motion::Turns => ".bearing",
        Motion::Slides => ".guide",
    };
    let found = joints.find(|(joint, motion)| name.strip_suffix(part(*motion)) == Some(joint));
    found.map(|(joint, _)| joint)
}

/// The problem in words, if results already use the name `name` of an element for the bearing or the guide of the joint
/// `joint`.
pub(crate) fn part_problem(name: &str, joint: &str) -> String {
    format!("the name \"{name}\" is taken: results have it for a part of the joint \"{joint}\"")
}

/// Advice for an element whose name results use for the bearing or the guide of a joint.
pub(crate) const PART_HINT: &str = "give the element another name";

#[cfg(test)]
mod tests {
    use crate::arm::{Element, read_arm_document};
    use crate::catalog::Catalogs;
    use crate::input::Document;
    use serde_json::json;

    fn arm(value: serde_json::Value) -> crate::arm::Arm {
        let document = Document::parse("arm.json", &value.to_string()).expect("JSON");
        read_arm_document(document, &Catalogs::builtin()).expect("a sound arm")
    }

    #[test]
    fn base_and_world_mean_base_and_world_even_if_elements_have_these_names() {
        let sprung = |from: &str, joint: &str| {
            let chain = json!([{"type": "joint", "name": joint, "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e4},
                {"type": "link", "name": "lever", "vector_m": [0.5, 0, 0], "mass_kg": 1}]);
            let spring =
                json!({"from": {"at": from, "point_m": [0, 0, 0.3]}, "to": {"at": "lever"}, "force_n": 5});
            arm(json!({"name": "arm", "chain": chain, "springs": [spring]})).springs
        };
        for word in ["base", "world"] {
            assert_eq!(sprung(word, word), sprung(word, "j1"), "{word}");
        }
        let driven = |first: &str| {
            let chain = json!([{"type": "joint", "name": first, "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e4},
                {"type": "link", "name": "upper", "vector_m": [0.5, 0, 0], "mass_kg": 1},
                {"type": "joint", "name": "j2", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e4, "motor_at": "base",
                 "motor_mass_kg": 3, "motor_point_m": [0.1, 0, 0], "gear_ratio": 50,
                 "transmission": [{"ratio": 2, "efficiency": 0.95, "stiffness_nm_per_rad": 400, "mass_kg": 0.5}]},
                {"type": "link", "name": "lower", "vector_m": [0.3, 0, 0], "mass_kg": 1}]);
            match arm(json!({"name": "arm", "chain": chain})).chain.swap_remove(0) {
                Element::Joint(joint) => joint.bodies,
                _ => panic!("the first element is a joint"),
            }
        };
        assert_eq!(driven("base"), driven("j1"));
    }

    #[test]
    fn no_element_has_the_name_of_a_part_of_a_joint() {
        let faults = |name: &str, of: serde_json::Value| {
            let arm = json!({"name": "arm", "chain": [of,
                {"type": "link", "name": name, "vector_m": [0.5, 0, 0], "mass_kg": 1}]});
            let document = Document::parse("arm.json", &arm.to_string()).expect("JSON");
            read_arm_document(document, &Catalogs::builtin()).err().map(|faults| faults.to_string())
        };
        let joint = json!({"type": "joint", "name": "j1", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e4});
        let fault = faults("j1.bearing", joint.clone()).expect("a fault");
        assert!(fault.contains("\"j1.bearing\" is taken") && fault.contains("\"j1\""), "{fault}");
        assert_eq!(faults("j2.bearing", joint), None, "no joint has this name");
    }
}
