//! The stiffness file of an import: what a URDF does not know of its joints, given for all of them at once.
//!
//! ```json
//! {"joints": {"shoulder": {"stiffness_nm_per_rad": 2e4}, "elbow": {"gear": "CSG-20-100", "motor": "ILM70x18"}}}
//! ```
//!
//! Each joint has the keys that it has in an arm file: `stiffness_nm_per_rad` (null is rigid), `windup` or `gear`; `motor`;
//! `bearing`. A prismatic joint has `stiffness_n_per_m`, `guide` and `moves`. The masses of named parts and of bearings are not
//! added, because the bodies of a URDF have them.

use crate::arm::bearing::Bearing;
use crate::arm::file::{read_curve, read_joint_bearing};
use crate::arm::joint_law::Curve;
use crate::arm::prismatic::{Guide, Moves, Prismatic};
use crate::catalog::Catalogs;
use crate::input::json::{Document, Faults, Node};
use serde_json::{Map, Value, json};

/// What is given of one joint.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct GivenJoint {
    /// Name of the joint.
    pub name: String,
    /// How it yields.
    pub springs: GivenSprings,
}

/// How a joint yields.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum GivenSprings {
    /// One that turns.
    Hinge {
        /// Torsion curve.
        curve: Curve,
        /// Output bearing.
        bearing: Option<Bearing>,
        /// Name of the gear.
        gear: Option<String>,
        /// Name of the motor.
        motor: Option<String>,
    },
    /// One that slides.
    Slide {
        /// Stiffness along the travel \[N/m\]; `None` is rigid.
        stiffness_n_per_m: Option<f64>,
        /// Guide.
        guide: Guide,
        /// What travels.
        moves: Moves,
    },
}

impl GivenSprings {
    /// Whether the drive is given as rigid.
    pub(crate) fn is_rigid(&self) -> bool {
        match self {
            Self::Hinge { curve, .. } => *curve == Curve::Rigid,
            Self::Slide { stiffness_n_per_m, .. } => stiffness_n_per_m.is_none(),
        }
    }
}

/// A joint of which a stiffness may be given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MovingJoint<'a> {
    /// Name.
    pub name: &'a str,
    /// Whether it slides and does not turn.
    pub slides: bool,
}

const HINGE_KEYS: [&str; 6] = ["stiffness_nm_per_rad", "windup", "gear", "gear_mass", "motor", "bearing"];
const SLIDE_KEYS: [&str; 3] = ["stiffness_n_per_m", "guide", "moves"];

/// Reads a stiffness file for a robot with these joints.
///
/// # Errors
/// All faults of the file.
pub(crate) fn read_given(
    document: Document,
    joints: &[MovingJoint],
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
            let (stiffness_n_per_m, guide, moves) = Prismatic::read_springs(&node.object(&SLIDE_KEYS)?)?;
            GivenSprings::Slide { stiffness_n_per_m, guide, moves }
        }
        false => read_hinge(node, catalogs)?,
    };
    Some(GivenJoint { name: name.into(), springs })
}

fn read_hinge(node: &Node, catalogs: &Catalogs) -> Option<GivenSprings> {
    let object = node.object(&HINGE_KEYS)?;
    let text = |key| object.or(key, None, |n| n.string().map(|s| Some(s.to_string())));
    let (gear, motor) = (text("gear"), text("motor"));
    let curve = read_curve(&object, catalogs);
    let bearing = read_joint_bearing(&object, catalogs);
    // the bodies of the file have the bearing's mass in them
    let bearing = bearing?.map(|bearing| Bearing { mass_kg: 0.0, ..bearing });
    Some(GivenSprings::Hinge { curve: curve?, bearing, gear: gear?, motor: motor? })
}

/// A stiffness file that leaves all joints rigid, to be filled in.
pub(crate) fn blank(joints: &[MovingJoint]) -> Value {
    let rigid = |joint: &MovingJoint| match joint.slides {
        true => json!({"stiffness_n_per_m": null, "guide": {}}),
        false => json!({"stiffness_nm_per_rad": null}),
    };
    let entries: Map<String, Value> =
        joints.iter().map(|joint| (joint.name.to_string(), rigid(joint))).collect();
    json!({"joints": entries})
}
