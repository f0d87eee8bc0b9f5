//! The stiffness file of an import: what a URDF does not know of its joints, given for all of them at once.
//!
//! ```json
//! {"joints": {"shoulder": {"stiffness_nm_per_rad": 2e4}, "elbow": {"gear": "CSG-20-100", "motor": "ILM70x18"}}}
//! ```
//!
//! Each joint has the keys that it has in an arm file: `stiffness_nm_per_rad` (null is rigid), `windup` or `gear`; `motor`;
//! `bearing`. The masses of named parts and of bearings are not added, because the bodies of a URDF have them.

use crate::arm::bearing::Bearing;
use crate::arm::file::{read_curve, read_joint_bearing};
use crate::arm::joint_law::Curve;
use crate::catalog::Catalogs;
use crate::input::json::{Document, Faults, Node};
use serde_json::{Map, Value, json};

/// What is given of one joint.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct GivenJoint {
    /// Name of the joint.
    pub name: String,
    /// Torsion curve.
    pub curve: Curve,
    /// Output bearing.
    pub bearing: Option<Bearing>,
    /// Name of the gear.
    pub gear: Option<String>,
    /// Name of the motor.
    pub motor: Option<String>,
}

const KEYS: [&str; 6] = ["stiffness_nm_per_rad", "windup", "gear", "gear_mass", "motor", "bearing"];

/// Reads a stiffness file for a robot with these joints.
///
/// # Errors
/// All faults of the file.
pub(crate) fn read_given(
    document: Document,
    joints: &[&str],
    catalogs: &Catalogs,
) -> Result<Vec<GivenJoint>, Faults> {
    let root = document.root();
    let entries = root.object(&["joints"]).and_then(|object| object.required("joints"));
    let given = entries.as_ref().and_then(|node| {
        let read: Vec<_> =
            node.entries()?.iter().map(|(name, n)| read_joint(name, n, joints, catalogs)).collect();
        read.into_iter().collect::<Option<Vec<_>>>()
    });
    document.finish(given)
}

fn read_joint(name: &str, node: &Node, joints: &[&str], catalogs: &Catalogs) -> Option<GivenJoint> {
    if !joints.contains(&name) {
        return node.fault(
            format!("\"{name}\" is no moving joint on the way to the tip"),
            &format!("the joints are: {}", joints.join(", ")),
        );
    }
    let object = node.object(&KEYS)?;
    let text = |key| object.or(key, None, |n| n.string().map(|s| Some(s.to_string())));
    let (gear, motor) = (text("gear"), text("motor"));
    let curve = read_curve(&object, catalogs);
    let bearing = read_joint_bearing(&object, catalogs);
    // the bodies of the file have the bearing's mass in them
    let bearing = bearing?.map(|bearing| Bearing { mass_kg: 0.0, ..bearing });
    Some(GivenJoint { name: name.into(), curve: curve?, bearing, gear: gear?, motor: motor? })
}

/// A stiffness file that leaves all joints rigid, to be filled in.
pub(crate) fn blank(joints: &[&str]) -> Value {
    let entries: Map<String, Value> =
        joints.iter().map(|name| (name.to_string(), json!({"stiffness_nm_per_rad": null}))).collect();
    json!({"joints": entries})
}
