//! Faults of a robot that its parser does not find: duplicate and unknown names, links with two parents, loops, axes
//! without a direction, and masses and inertias that no body can have.

use super::circles::circles;
use super::urdf_tree::{UrdfTree, moves, stated_tensor};
use crate::input::magnitude::beyond_calculation;
use crate::input::names::unfit_name;
use nalgebra::{SymmetricEigen, Vector3};
use std::collections::{BTreeMap, BTreeSet};
use urdf_rs::{Joint, Link, Pose};

/// Largest negative principal moment that counts as rounding, relative to the largest entry of the tensor.
const ROUNDING: f64 = 1e-6;
/// Largest negative principal moment that counts as rounding, relative to mass times squared distance of the centre of
/// gravity. Programs often compute the tensor of a body as the difference of two tensors of about this size.
const ROUNDING_AT_ORIGIN: f64 = 1e-12;

/// Something wrong with a robot.
pub(super) struct Problem {
    /// Name of the link, the joint or the robot.
    pub of: String,
    /// Description of the fault.
    pub problem: String,
    /// What to do.
    pub hint: &'static str,
}

impl Problem {
    fn of(name: &str, problem: impl Into<String>, hint: &'static str) -> Self {
        Self { of: name.into(), problem: problem.into(), hint }
    }
}

/// All faults of a robot.
pub(super) fn problems(tree: &UrdfTree) -> Vec<Problem> {
    let mut out = Vec::new();
    if tree.links.is_empty() {
        out.push(Problem::of(&tree.name, "has no link", "give at least one <link>"));
    }
    name_problems("link", tree.links.iter().map(|link| &link.name), &mut out);
    name_problems("joint", tree.joints.iter().map(|joint| &joint.name), &mut out);
    for (link, stands_still) in tree.links.iter().zip(tree.still()) {
        body_problems(link, stands_still, &mut out);
    }
    tree.joints.iter().for_each(|joint| joint_problems(tree, joint, &mut out));
    mimic_circles(tree, &mut out);
    parent_problems(tree, &mut out);
    loops(tree, &mut out);
    out
}

/// Links that never move and have a negative principal moment of inertia. This is no fault, because the inertia of a
/// link that never moves has no effect on an arm.
pub(crate) fn impossible_and_still(tree: &UrdfTree) -> Vec<&str> {
    let links = tree.links.iter().zip(tree.still()).filter(|(_, stands_still)| *stands_still);
    let odd = links.filter(|(link, _)| least_moment_beyond_rounding(link).is_some());
    odd.map(|(link, _)| link.name.as_str()).collect()
}

/// Checks that every name of a `kind` of element (`link` or `joint`) is there, is fit for tables and is given once.
fn name_problems<'n>(kind: &str, names: impl Iterator<Item = &'n String>, out: &mut Vec<Problem>) {
    let mut taken = BTreeSet::new();
    for name in names {
        if name.is_empty() {
            out.push(Problem::of("", format!("a {kind} has an empty name"), "give each a name of its own"));
        } else if !taken.insert(name) {
            let problem = format!("the name of the {kind} is taken");
            out.push(Problem::of(name, problem, "give each a name of its own"));
        }
        if let Some((problem, hint)) = unfit_name(name) {
            out.push(Problem::of(name, problem, hint));
        }
    }
}

fn joint_problems(tree: &UrdfTree, joint: &Joint, out: &mut Vec<Problem>) {
    for end in [&joint.parent.link, &joint.child.link] {
        if tree.link_index(end).is_none() {
            let problem = format!("names the link \"{end}\", which is not in the file");
            out.push(Problem::of(&joint.name, problem, ""));
        }
    }
    let axis = Vector3::from(joint.axis.xyz.0);
    if moves(joint) && !(axis.norm() > 0.0 && axis.norm().is_finite()) {
        out.push(Problem::of(&joint.name, "has an axis without direction", "give <axis xyz=\"0 0 1\"/>"));
    }
    pose_problems(&joint.name, &joint.origin, out);
    let mimic_numbers = joint.mimic.iter().flat_map(|mimic| [mimic.multiplier, mimic.offset]).flatten();
    if mimic_numbers.into_iter().any(|number| !number.is_finite()) {
        out.push(Problem::of(&joint.name, "has a multiplier or an offset that is no number", ""));
    }
    if let Some(mimic) = &joint.mimic
        && tree.joint_index(&mimic.joint).is_none()
    {
        let problem = format!("mimics \"{}\", which is no joint of the file", mimic.joint);
        out.push(Problem::of(&joint.name, problem, "name a joint, or remove <mimic>"));
    }
}

/// Finds joints that mimic each other in a circle. Each circle is one fault of its joint that comes first in the file.
fn mimic_circles(tree: &UrdfTree, out: &mut Vec<Problem>) {
    let next = |joint: &Joint| joint.mimic.as_ref().and_then(|mimic| tree.joint_index(&mimic.joint));
    for circle in circles(&tree.joints.iter().map(next).collect::<Vec<_>>()) {
        let names: Vec<&str> =
            circle.iter().chain(&circle[..1]).map(|joint| tree.joints[*joint].name.as_str()).collect();
        let problem = format!("mimics itself: {}", names.join(" mimics "));
        out.push(Problem::of(names[0], problem, "remove the <mimic> of the joint that has a motor"));
    }
}

/// Checks that exactly one link has no parent, and that all others have one.
fn parent_problems(tree: &UrdfTree, out: &mut Vec<Problem>) {
    let mut parents: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for joint in &tree.joints {
        parents.entry(&joint.child.link).or_default().push(&joint.name);
    }
    for (link, joints) in parents.iter().filter(|(_, joints)| joints.len() > 1) {
        let problem = format!("is the child of {} joints: {}", joints.len(), joints.join(", "));
        out.push(Problem::of(link, problem, "a URDF is a tree: remove the joints that close loops"));
    }
    let roots: Vec<&str> =
        tree.links.iter().map(|l| l.name.as_str()).filter(|l| !parents.contains_key(l)).collect();
    if let [_, others @ ..] = roots.as_slice()
        && !others.is_empty()
    {
        let problem = format!("is not the only root: {} have no parent either", others.join(", "));
        out.push(Problem::of(roots[0], problem, "join them to the tree by fixed joints"));
    }
}

/// Finds loops of joints. Each is one fault of its joint that comes first in the file.
fn loops(tree: &UrdfTree, out: &mut Vec<Problem>) {
    let parent = |link: usize| tree.link_index(&tree.parent_joint(link)?.parent.link);
    for mut circle in circles(&(0..tree.links.len()).map(parent).collect::<Vec<_>>()) {
        // from the root outward, as joints are written
        circle.reverse();
        let mut joints: Vec<&Joint> = circle.iter().filter_map(|link| tree.parent_joint(*link)).collect();
        let first = joints.iter().enumerate().min_by_key(|(_, joint)| tree.joint_index(&joint.name));
        let first = first.map_or(0, |(place, _)| place);
        joints.rotate_left(first);
        let words =
            |joint: &&Joint| format!("{} ({} to {})", joint.name, joint.parent.link, joint.child.link);
        let problem = format!(
            "is in a closed loop of joints: {}",
            joints.iter().map(words).collect::<Vec<_>>().join(", ")
        );
        let hint = "a URDF is a tree: remove the joint that closes the loop; a joint that a parallel linkage turns follows \
                    another one by <mimic>";
        out.extend(joints.first().map(|joint| Problem::of(&joint.name, problem, hint)));
    }
}

/// Largest distance that an origin may have \[m\]. A larger one is in another unit, or a mistake.
const FARTHEST_M: f64 = 1e4;

/// Checks that an `<origin>` has a position and angles of a size that robots have.
fn pose_problems(name: &str, origin: &Pose, out: &mut Vec<Problem>) {
    let (xyz, rpy) = (origin.xyz.0, origin.rpy.0);
    if xyz.iter().chain(&rpy).any(|number| !number.is_finite()) {
        let problem = format!("has an origin that is no number: xyz {xyz:?}, rpy {rpy:?}");
        out.push(Problem::of(name, problem, "give lengths in metres and angles in radians"));
    } else if let Some(far_m) = xyz.iter().find(|number| number.abs() > FARTHEST_M) {
        let problem = format!("has an origin {far_m} m away; at most {FARTHEST_M} m are read");
        out.push(Problem::of(name, problem, "give lengths in metres"));
    }
}

/// The least principal moment of a body \[kg m²\] if it is negative by more than rounding; otherwise `None`.
fn least_moment_beyond_rounding(link: &Link) -> Option<f64> {
    let tensor = stated_tensor(link);
    let least = SymmetricEigen::new(tensor).eigenvalues.min();
    let at_origin = link.inertial.mass.value * Vector3::from(link.inertial.origin.xyz.0).norm_squared();
    (least < -(ROUNDING * tensor.amax()).max(ROUNDING_AT_ORIGIN * at_origin)).then_some(least)
}

/// Checks that the mass of a body and, unless it stands still, its principal moments are not negative, and that no
/// number is beyond calculation.
fn body_problems(link: &Link, stands_still: bool, out: &mut Vec<Problem>) {
    pose_problems(&link.name, &link.inertial.origin, out);
    let mass_kg = link.inertial.mass.value;
    let i = &link.inertial.inertia;
    let stated = [
        ("<mass value>", mass_kg),
        ("<inertia ixx>", i.ixx),
        ("<inertia ixy>", i.ixy),
        ("<inertia ixz>", i.ixz),
        ("<inertia iyy>", i.iyy),
        ("<inertia iyz>", i.iyz),
        ("<inertia izz>", i.izz),
    ];
    let beyond = stated.iter().filter_map(|(key, number)| Some((key, beyond_calculation(*number)?)));
    let beyond: Vec<Problem> = beyond
        .map(|(key, (problem, hint))| Problem::of(&link.name, format!("{key} {problem}"), hint))
        .collect();
    if mass_kg < 0.0 {
        let problem = format!("has a mass of {mass_kg} kg");
        out.push(Problem::of(&link.name, problem, "give a mass that is not negative"));
    }
    if !beyond.is_empty() {
        out.extend(beyond);
        return;
    }
    if link.inertial.origin.xyz.0.iter().any(|number| !number.is_finite()) {
        return;
    }
    if let Some(least) = least_moment_beyond_rounding(link).filter(|_| !stands_still) {
        let problem = format!("has a negative principal moment of inertia, {least} kg m²");
        let hint = "check the signs of ixy, ixz and iyz: they are entries of the tensor";
        out.push(Problem::of(&link.name, problem, hint));
    }
}
