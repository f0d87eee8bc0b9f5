//! Export to URDF: the rigid arm, and a separate file with the stiffness of its joints, which a URDF cannot state.
//!
//! The separate file is the stiffness file that an import reads. An exported arm that is imported again has the same
//! torques and, since its links are rigid, the same modes.

use super::free_name::FreeNames;
use super::snapshot::Snapshot;
use super::tree::{Node, TreeOptions, mass_properties, tree};
use super::xml::{Xml, numbers, triple};
use crate::arm::body::RigidBody;
use crate::arm::structure::JointAngle;
use crate::arm::{Arm, Joint};
use nalgebra::Vector3;
use serde_json::{Map, Value, json};

/// Mass of a link that has inertia and no mass, relative to the mass of the arm.
const LEAST_MASS: f64 = 1e-9;

/// A URDF file.
pub(crate) struct Urdf {
    /// The text of the file.
    pub text: String,
    /// Name of the link at the tip.
    pub tip: String,
}

/// Writes an arm as URDF. The payload of the case is not included.
pub(crate) fn urdf(arm: &Arm, snapshot: &Snapshot) -> Urdf {
    let nodes = tree(snapshot, &TreeOptions::default());
    // some readers of URDF refuse a link and a joint of the same name
    let joints = arm.joints().map(|joint| joint.name.clone());
    let mut free = FreeNames::all_but(joints.chain(arm.prismatics().map(|joint| joint.name.clone())));
    let names: Vec<String> =
        nodes.iter().enumerate().map(|(i, node)| link_name(i, node, &mut free)).collect();
    let (tip, tip_joint) = (free.take("tip", "_link"), free.take("tip_frame", "_joint"));
    let least_kg = LEAST_MASS * nodes.iter().map(|node| node.inertia[(0, 0)]).sum::<f64>().max(LEAST_MASS);
    let comment = format!(
        "{}: rigid links and joints; frames are parallel at zero angles; stiffness.json has the stiffness of the joints",
        arm.name
    );
    let mut xml = Xml::new(&comment);
    xml.open("robot", &[("name", arm.name.clone())]);
    for (name, node) in names.iter().zip(&nodes) {
        link(&mut xml, name, node, least_kg);
    }
    for (i, pair) in nodes.windows(2).enumerate() {
        joint(&mut xml, snapshot, (&names[i], &pair[0]), (&names[i + 1], &pair[1]));
    }
    if let (Some(last), Some(name)) = (nodes.last(), names.last()) {
        let tip_m = snapshot.at_zero().tip_m - last.origin_m;
        xml.leaf("link", &[("name", tip.clone())]);
        xml.open("joint", &[("name", tip_joint), ("type", "fixed".into())]);
        ends(&mut xml, name, &tip, &tip_m);
        xml.close();
    }
    Urdf { text: xml.finish(), tip }
}

/// Name of the URDF link for a body, which must differ from the names of joints. `number` counts the bodies from the
/// base.
fn link_name(number: usize, node: &Node, free: &mut FreeNames) -> String {
    let name = if number == 0 { "base".into() } else { format!("{}_link", node.name) };
    free.take(&name, "_link")
}

/// Writes a link. One that has inertia and no mass gets the mass `least_kg` \[kg\], because a body has both.
fn link(xml: &mut Xml, name: &str, node: &Node, least_kg: f64) {
    let name = [("name", name.to_string())];
    let RigidBody { mass_kg, cg_m, inertia_kgm2: inertia } = mass_properties(&node.inertia);
    if mass_kg == 0.0 && inertia.amax() == 0.0 {
        return xml.leaf("link", &name);
    }
    let (mass_kg, cg_m) = if mass_kg > 0.0 { (mass_kg, cg_m) } else { (least_kg, node.origin_m) };
    xml.open("link", &name);
    xml.open("inertial", &[]);
    xml.leaf("origin", &[("xyz", triple(&(cg_m - node.origin_m))), ("rpy", "0 0 0".into())]);
    xml.leaf("mass", &[("value", numbers(&[mass_kg]))]);
    let entries = [("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2), ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2)];
    xml.leaf("inertia", &entries.map(|(key, i, j)| (key, numbers(&[inertia[(i, j)]]))));
    xml.close();
    xml.close();
}

fn ends(xml: &mut Xml, parent: &str, child: &str, xyz_m: &Vector3<f64>) {
    xml.leaf("parent", &[("link", parent.into())]);
    xml.leaf("child", &[("link", child.into())]);
    xml.leaf("origin", &[("xyz", triple(xyz_m)), ("rpy", "0 0 0".into())]);
}

/// Travel to either side that is written as the range of a prismatic joint \[m\]. A URDF must state a range, and an arm
/// has none.
pub(crate) const TRAVEL_M: f64 = 1e3;

/// Writes a joint. An arm states no ranges, so a joint that turns is written as `continuous`.
fn joint(xml: &mut Xml, snapshot: &Snapshot, (from, parent): (&str, &Node), (to, node): (&str, &Node)) {
    let slides = node.hinges.first().is_some_and(|hinge| hinge.slides);
    let kind = if slides { "prismatic" } else { "continuous" };
    xml.open("joint", &[("name", node.name.clone()), ("type", kind.into())]);
    ends(xml, from, to, &(node.origin_m - parent.origin_m));
    if let Some(hinge) = node.hinges.first() {
        xml.leaf("axis", &[("xyz", triple(&hinge.axis))]);
    }
    if slides {
        let limits = [("lower", -TRAVEL_M), ("upper", TRAVEL_M), ("effort", 1e9), ("velocity", 1e3)];
        xml.leaf("limit", &limits.map(|(key, value)| (key, numbers(&[value]))));
    }
    let piece = snapshot.structure.joints().find(|piece| piece.name == node.name);
    if let Some(JointAngle::Coupled(terms)) = piece.map(|piece| &piece.angle)
        && let [(driver, factor)] = terms.as_slice()
    {
        let driver = snapshot.case_joints()[*driver].clone();
        xml.leaf("mimic", &[("joint", driver), ("multiplier", numbers(&[*factor])), ("offset", "0".into())]);
    }
    xml.close();
}

/// Passive joints with several driving joints. A URDF cannot express them, because `<mimic>` follows a single joint.
pub(crate) fn with_several_drivers(arm: &Arm) -> Vec<&Joint> {
    arm.joints().filter(|joint| joint.coupled.as_ref().is_some_and(|terms| terms.len() != 1)).collect()
}

/// The stiffness file of an arm, for a later import.
pub(crate) fn stiffness_file(arm: &Arm) -> Value {
    let turning = arm.joints().map(|joint| {
        let (key, curve) = joint.curve.to_json();
        let mut of_joint = json!({key: curve, "bearing": joint.bearing.map(|bearing| bearing.to_json())});
        for (key, part) in [("gear", &joint.gear), ("motor", &joint.motor)] {
            if let Some(part) = part {
                of_joint[key] = json!(part);
            }
        }
        (joint.name.clone(), of_joint)
    });
    let sliding = arm.prismatics().map(|joint| (joint.name.clone(), joint.springs_to_json()));
    let joints: Map<String, Value> = turning.chain(sliding).collect();
    json!({"joints": joints})
}
