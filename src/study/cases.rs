//! Reads the cases of a study: its poses with their loads, each repeated for every environment.

use super::keys::{ENVIRONMENT, POSE};
use crate::arm::load::{Payload, Water, vector};
use crate::arm::pose::{DrivenJoint, read_pose};
use crate::input::json::{Node, Object};
use crate::space::design_space::Case;
use nalgebra::Vector3;

/// Largest number of cases of a study: its poses times its environments. A search tabulates up to 4 kB for each link
/// option in each case.
const MOST_CASES: usize = 2_000;

/// All cases of a study, with the indices of the judged cases and of the sizing cases.
#[derive(Default)]
pub(super) struct Cases {
    pub cases: Vec<Case>,
    pub judged: Vec<usize>,
    pub sizing: Vec<usize>,
    /// Indices of the cases whose pose states a payload of its own.
    pub own_payloads: Vec<usize>,
}

/// One case as it is read, before it is repeated for every environment.
struct ReadCase {
    case: Case,
    judged: bool,
    sizing: bool,
    own_payload: bool,
}

/// Reads the poses of a study and repeats them for every environment. `joints` are the driven joints of the study.
/// Returns `None` after recording a fault.
pub(super) fn read_cases(root: &Object, joints: &[DrivenJoint]) -> Option<Cases> {
    let payload = root.or("payload", Payload::default(), Payload::read);
    let force = root.or("tip_force_n", Vector3::zeros(), vector);
    let moment = root.or("tip_moment_nm", Vector3::zeros(), vector);
    let environments = root.or("environments", vec![Environment::default()], read_environments);
    let poses = root.required("poses").and_then(|n| n.array());
    // a fault in the study's payload or force must not hide faults of the poses
    let usual = Load {
        payload: payload.unwrap_or_default(),
        tip_force_n: force.unwrap_or_default(),
        tip_moment_nm: moment.unwrap_or_default(),
    };
    let poses: Vec<_> = poses?.iter().map(|n| read_case(n, joints, &usual)).collect();
    let poses = poses.into_iter().collect::<Option<Vec<_>>>()?;
    let (environments, _, _, _) = (environments?, payload?, force?, moment?);
    let cases = poses.len() * environments.len();
    if !(1..=MOST_CASES).contains(&cases) {
        let node = root.required("poses")?;
        return match cases {
            0 => node.fault("is empty", "give at least the pose the arm is judged in"),
            _ => node.fault(
                format!(
                    "with the environments makes {cases} cases, and the limit of a study is {MOST_CASES}"
                ),
                "keep the poses that are farthest out, and each extreme of a joint",
            ),
        };
    }
    let mut out = Cases::default();
    for environment in &environments {
        for ReadCase { case, judged, sizing, own_payload } in &poses {
            let index = out.cases.len();
            out.judged.extend(judged.then_some(index));
            out.sizing.extend(sizing.then_some(index));
            out.own_payloads.extend(own_payload.then_some(index));
            let name = match environment.name.as_str() {
                "" => case.name.clone(),
                around => format!("{}, {around}", case.name),
            };
            out.cases.push(Case { name, water: environment.water, ..case.clone() });
        }
    }
    if out.judged.is_empty() {
        return root
            .required("poses")?
            .fault("has no judged pose", "leave \"judged\" away, or set it true, in one of them");
    }
    if out.sizing.is_empty() {
        return root.required("poses")?.fault(
            "has no pose in which drives are sized and stresses checked",
            "leave \"sizing\" away, or set it true, in one of them",
        );
    }
    Some(out)
}

/// The medium around the arm: air, or water.
#[derive(Debug, Clone, Default)]
struct Environment {
    name: String,
    water: Option<Water>,
}

fn read_environments(node: &Node) -> Option<Vec<Environment>> {
    let items = node.array()?;
    if items.is_empty() {
        return node.fault("is empty", "name what the arm is in, or leave it away for air");
    }
    let read: Vec<_> = items
        .iter()
        .map(|n| {
            let object = n.shaped(&ENVIRONMENT)?;
            let name = object.required("name").and_then(|n| n.string().map(String::from));
            let water = object.or("water", None, |n| Water::read(n).map(Some));
            Some(Environment { name: name?, water: water? })
        })
        .collect();
    read.into_iter().collect()
}

/// The load of a pose that states none.
struct Load {
    payload: Payload,
    tip_force_n: Vector3<f64>,
    tip_moment_nm: Vector3<f64>,
}

fn read_case(node: &Node, joints: &[DrivenJoint], usual: &Load) -> Option<ReadCase> {
    let object = node.shaped(&POSE)?;
    let name = object.or("name", node.path().to_string(), |n| n.string().map(String::from));
    let pose_deg = read_pose(&object, joints);
    let payload = object.or("payload", usual.payload, Payload::read);
    let tip_force_n = object.or("tip_force_n", usual.tip_force_n, vector);
    let tip_moment_nm = object.or("tip_moment_nm", usual.tip_moment_nm, vector);
    let sizing = object.or("sizing", true, Node::boolean);
    let judged = object.or("judged", true, Node::boolean);
    let case = Case {
        name: name?,
        pose_deg: pose_deg?,
        payload: payload?,
        tip_force_n: tip_force_n?,
        tip_moment_nm: tip_moment_nm?,
        water: None,
    };
    Some(ReadCase { case, judged: judged?, sizing: sizing?, own_payload: object.has("payload") })
}
