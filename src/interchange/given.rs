//! The stiffness file of an import. It states, for all joints at once, the elastic properties that a URDF does not
//! have.
//!
//! ```json
//! {"joints": {"shoulder": {"stiffness_nm_per_rad": 2e4}, "elbow": {"gear": "CSG-20-100", "motor": "ILM70x18"}}}
//! ```
//!
//! Each joint has the keys that it has in an arm file: one of `stiffness_nm_per_rad` (null means rigid), `windup` and
//! `gear`, and in addition `motor` and `bearing`. A prismatic joint has `stiffness_n_per_m`, `guide` and `moves`. The
//! masses of the named parts and of bearings are not added, because the bodies of a URDF include them.

use super::keys::{ALL_JOINTS, HINGE, SLIDE};
use crate::arm::bearing::Bearing;
use crate::arm::file::{read_curve, read_joint_bearing};
use crate::arm::joint_law::Curve;
use crate::arm::prismatic::{Elastic, Guide, Moves, Prismatic};
use crate::catalog::Catalogs;
use crate::input::json::{Document, Faults, Node};
use serde_json::{Map, Value, json};

/// The elastic properties that the stiffness file states for one joint.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct GivenJoint {
    /// Name of the joint.
    pub name: String,
    /// Elastic properties of the joint.
    pub springs: GivenSprings,
}

/// Elastic properties of a joint.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum GivenSprings {
    /// A joint that turns.
    Hinge {
        /// Torsion curve of the joint.
        curve: Curve,
        /// Output bearing; `None` if the joint does not tilt.
        bearing: Option<Bearing>,
        /// Name of the gear; `None` if none is stated.
        gear: Option<String>,
        /// Name of the motor; `None` if none is stated.
        motor: Option<String>,
    },
    /// A joint that slides.
    Slide {
        /// Stiffness of the drive along the travel \[N/m\]; `None` means rigid.
        stiffness_n_per_m: Option<f64>,
        /// Rotational stiffnesses of the guide.
        guide: Guide,
        /// Whether a carriage or a ram travels.
        moves: Moves,
    },
}

impl GivenSprings {
    /// Whether the stiffness file states that the joint is rigid about its axis or along its travel.
    pub(crate) fn is_rigid(&self) -> bool {
        match self {
            Self::Hinge { curve, .. } => *curve == Curve::Rigid,
            Self::Slide { stiffness_n_per_m, .. } => stiffness_n_per_m.is_none(),
        }
    }
}

/// A joint for which the stiffness file may state elastic properties.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MovingJoint<'a> {
    /// Name of the joint.
    pub name: &'a str,
    /// Whether the joint slides; else it turns.
    pub slides: bool,
}

/// Reads a stiffness file for a robot with these joints.
///
/// # Errors
/// All faults of the file at once.
pub(crate) fn read_given(
    document: Document,
    joints: &[MovingJoint],
    catalogs: &Catalogs,
) -> Result<Vec<GivenJoint>, Faults> {
    let root = document.root();
    let entries = root.shaped(&ALL_JOINTS).and_then(|object| object.required("joints"));
    let given = entries.as_ref().and_then(|node| {
        let read: Vec<_> =
            node.entries()?.iter().map(|(name, n)| read_joint(name, n, joints, catalogs)).collect();
        read.into_iter().collect::<Option<Vec<_>>>()
    });
    document.finish(given)
}

fn read_joint(name: &str, node: &Node, joints: &[MovingJoint], catalogs: &Catalogs) -> Option<GivenJoint> {
    let Some(joint) = joints.iter().find(|joint| joint.name == name) else {
        let names: Vec<&str> = joints.iter().map(|joint| joint.name).collect();
        return node.fault(
            format!("\"{name}\" is no moving joint on the way to the tip"),
            &format!("the joints are: {}", names.join(", ")),
        );
    };
    let springs = match joint.slides {
        true => {
            let Elastic { stiffness_n_per_m, guide, moves } = Prismatic::read_springs(&node.shaped(&SLIDE)?)?;
            GivenSprings::Slide { stiffness_n_per_m, guide, moves }
        }
        false => read_hinge(node, catalogs)?,
    };
    Some(GivenJoint { name: name.into(), springs })
}

fn read_hinge(node: &Node, catalogs: &Catalogs) -> Option<GivenSprings> {
    let object = node.shaped(&HINGE)?;
    let text = |key| object.or(key, None, |n| n.string().map(|s| Some(s.to_string())));
    let (gear, motor) = (text("gear"), text("motor"));
    let curve = read_curve(&object, catalogs);
    let bearing = read_joint_bearing(&object, catalogs);
    // the bodies of the URDF include the mass of the bearing
    let bearing = bearing?.map(|bearing| Bearing { mass_kg: 0.0, ..bearing });
    Some(GivenSprings::Hinge { curve: curve?, bearing, gear: gear?, motor: motor? })
}

/// A stiffness file for these joints to fill in, in which all joints are rigid.
pub(crate) fn blank(joints: &[MovingJoint]) -> Value {
    let rigid = |joint: &MovingJoint| match joint.slides {
        true => json!({"stiffness_n_per_m": null, "guide": {}}),
        false => json!({"stiffness_nm_per_rad": null}),
    };
    let entries: Map<String, Value> =
        joints.iter().map(|joint| (joint.name.to_string(), rigid(joint))).collect();
    json!({"joints": entries})
}
