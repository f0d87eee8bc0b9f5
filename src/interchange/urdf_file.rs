//! Reading a URDF file as a tree: links, joints, and every fault of the file at once.
//!
//! The text is parsed by the crate `urdf-rs`. What the crate does not check is checked here: duplicate and unknown
//! names, links with two parents, loops, axes without a direction, and masses and inertias that no body can have.

use super::urdf_place::{cut_off_at, line_of_robot, no_numbers};
use super::urdf_shapes::without_shapes;
use crate::input::json::{Fault, Faults};
use crate::input::magnitude::beyond_calculation;
use crate::input::names::unfit_name;
use nalgebra::{Isometry3, Matrix3, SymmetricEigen, Translation3, UnitQuaternion, Vector3};
use std::collections::BTreeMap;
use urdf_rs::{Joint, JointType, Link, Pose, Robot};

/// Largest negative principal moment that counts as rounding, relative to the largest entry of the tensor.
const ROUNDING: f64 = 1e-6;
/// Largest negative principal moment that counts as rounding, relative to mass times squared distance of the centre of
/// gravity. Programs often compute the tensor of a body as the difference of two tensors of about this size.
const ROUNDING_AT_ORIGIN: f64 = 1e-12;

/// A robot as a tree of links.
#[derive(Debug, Clone)]
pub(crate) struct UrdfTree {
    /// Name of the robot.
    pub name: String,
    /// The links, in the order of the file.
    pub links: Vec<Link>,
    /// The joints, in the order of the file.
    pub joints: Vec<Joint>,
}

/// Whether a joint moves: it is not fixed.
pub(crate) fn moves(joint: &Joint) -> bool {
    !matches!(joint.joint_type, JointType::Fixed)
}

/// Whether a joint slides: it is prismatic.
pub(crate) fn slides(joint: &Joint) -> bool {
    matches!(joint.joint_type, JointType::Prismatic)
}

/// Position \[m\] and attitude that an `<origin>` states, as a transformation.
pub(crate) fn isometry(pose: &Pose) -> Isometry3<f64> {
    let [roll, pitch, yaw] = pose.rpy.0;
    let turn = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    Isometry3::from_parts(Translation3::from(Vector3::from(pose.xyz.0)), turn)
}

/// Inertia tensor of a link about its centre of gravity, in axes of its inertial frame \[kg m²\]. A negative principal
/// moment is rounding and becomes zero.
pub(crate) fn tensor(link: &Link) -> Matrix3<f64> {
    let stated = stated_tensor(link);
    let mut eigen = SymmetricEigen::new(stated);
    if eigen.eigenvalues.min() >= 0.0 {
        return stated;
    }
    eigen.eigenvalues.apply(|moment| *moment = moment.max(0.0));
    let tensor = eigen.recompose();
    0.5 * (tensor + tensor.transpose())
}

/// Inertia tensor of a link as the file states it \[kg m²\].
fn stated_tensor(link: &Link) -> Matrix3<f64> {
    let i = &link.inertial.inertia;
    Matrix3::new(i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz)
}

/// Something wrong with a robot.
struct Problem {
    /// Name of the link, the joint or the robot.
    of: String,
    problem: String,
    hint: &'static str,
}

impl Problem {
    fn of(name: &str, problem: impl Into<String>, hint: &'static str) -> Self {
        Self { of: name.into(), problem: problem.into(), hint }
    }
}

impl UrdfTree {
    /// Reads a robot from the text of a URDF file. `file` is the name of the file in messages.
    ///
    /// # Errors
    /// All faults of the file at once.
    pub(crate) fn read(file: &str, text: &str) -> Result<Self, Faults> {
        let fault = |name: &str, problem: String, hint: &str| Fault {
            file: file.into(),
            line: line_of(text, name).or_else(|| line_of_robot(text)),
            field: name.into(),
            problem,
            hint: hint.into(),
        };
        let robot: Robot = urdf_rs::read_from_string(&without_shapes(text)).map_err(|e| {
            if let Some((line, wrong)) = no_numbers(text) {
                let hint = "write numbers with a point, separated by spaces";
                let problem = format!("is no list of numbers: {wrong}");
                return Faults(vec![Fault { line: Some(line), ..fault("", problem, hint) }]);
            }
            if let Some(last) = cut_off_at(text) {
                let hint = "save the whole file again; it ends with </robot>";
                let problem = "is empty or cut off: no </robot> ends it".to_string();
                return Faults(vec![Fault { line: Some(last), ..fault("", problem, hint) }]);
            }
            let hint = match text.contains("xacro:") || text.contains("${") {
                true => "expand its macros first with `xacro FILE.xacro > FILE.urdf`",
                false => {
                    "check the elements and attributes of its links and joints against the format of URDF"
                }
            };
            Faults(vec![Fault { line: None, ..fault("", format!("is no URDF: {e}"), hint) }])
        })?;
        let tree = Self { name: robot.name, links: robot.links, joints: robot.joints };
        let faults: Vec<Fault> =
            tree.problems().into_iter().map(|p| fault(&p.of, p.problem, p.hint)).collect();
        if faults.is_empty() { Ok(tree) } else { Err(Faults(faults)) }
    }

    /// The link with this name; `None` if there is none.
    pub(crate) fn link(&self, name: &str) -> Option<&Link> {
        self.links.iter().find(|link| link.name == name)
    }

    /// The joint whose child is this link; `None` for the root.
    pub(crate) fn parent_joint(&self, link: &str) -> Option<&Joint> {
        self.joints.iter().find(|joint| joint.child.link == link)
    }

    /// The joints whose parent is this link.
    pub(crate) fn child_joints(&self, link: &str) -> impl Iterator<Item = &Joint> {
        self.joints.iter().filter(move |joint| joint.parent.link == link)
    }

    /// The joints on the path from the root to the link `tip`, in the order of the path.
    pub(crate) fn path_to(&self, tip: &str) -> Vec<&Joint> {
        let mut path = Vec::new();
        let mut link = tip;
        while let Some(joint) = self.parent_joint(link) {
            path.push(joint);
            link = &joint.parent.link;
        }
        path.reverse();
        path
    }

    /// The links without child joints. An arm may end at any of them.
    pub(crate) fn ends(&self) -> Vec<&str> {
        let is_end = |link: &&Link| self.child_joints(&link.name).next().is_none();
        self.links.iter().filter(is_end).map(|link| link.name.as_str()).collect()
    }

    /// Whether a link never moves: every joint from the root to it is fixed.
    pub(crate) fn stands_still(&self, link: &str) -> bool {
        self.path_to(link).into_iter().all(|joint| !moves(joint))
    }

    /// Links that never move and have a negative principal moment of inertia. This is no fault, because the inertia of
    /// a link that never moves has no effect on an arm.
    pub(crate) fn impossible_and_still(&self) -> Vec<&str> {
        let links = self.links.iter().filter(|link| self.stands_still(&link.name));
        links.filter(|link| least_moment_beyond_rounding(link).is_some()).map(|l| l.name.as_str()).collect()
    }

    /// All faults of the robot.
    fn problems(&self) -> Vec<Problem> {
        let mut out = Vec::new();
        if self.links.is_empty() {
            out.push(Problem::of(&self.name, "has no link", "give at least one <link>"));
        }
        let names = |kind: &str, names: Vec<&String>, out: &mut Vec<Problem>| {
            for (i, name) in names.iter().enumerate() {
                if names[..i].contains(name) {
                    let problem = format!("the name of the {kind} is taken");
                    out.push(Problem::of(name, problem, "give each a name of its own"));
                }
                if let Some((problem, hint)) = unfit_name(name) {
                    out.push(Problem::of(name, problem, hint));
                }
            }
        };
        names("link", self.links.iter().map(|link| &link.name).collect(), &mut out);
        names("joint", self.joints.iter().map(|joint| &joint.name).collect(), &mut out);
        self.links.iter().for_each(|link| body_problems(link, self.stands_still(&link.name), &mut out));
        self.joints.iter().for_each(|joint| self.joint_problems(joint, &mut out));
        self.tree_problems(&mut out);
        out
    }

    fn joint_problems(&self, joint: &Joint, out: &mut Vec<Problem>) {
        for end in [&joint.parent.link, &joint.child.link] {
            if self.link(end).is_none() {
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
            && !self.joints.iter().any(|other| other.name == mimic.joint)
        {
            let problem = format!("mimics \"{}\", which is no joint of the file", mimic.joint);
            out.push(Problem::of(&joint.name, problem, "name a joint, or remove <mimic>"));
        }
        let circle = self.mimics_from(joint);
        // each circle is reported once, at its joint that comes first in the file
        let first = self.joints.iter().find(|other| circle.contains(&other.name.as_str()));
        if first.is_some_and(|first| first.name == joint.name) {
            let way = [&circle[..], &[joint.name.as_str()]].concat();
            let problem = format!("mimics itself: {}", way.join(" mimics "));
            out.push(Problem::of(&joint.name, problem, "remove the <mimic> of the joint that has a motor"));
        }
    }

    /// The joints from `joint` along `<mimic>` back to itself; none if the joint does not mimic itself.
    fn mimics_from<'t>(&'t self, joint: &'t Joint) -> Vec<&'t str> {
        let mut way = vec![joint.name.as_str()];
        let mut at = joint;
        while let Some(mimic) = &at.mimic
            && way.len() <= self.joints.len()
        {
            if mimic.joint == joint.name {
                return way;
            }
            let Some(next) = self.joints.iter().find(|other| other.name == mimic.joint) else { break };
            way.push(&next.name);
            at = next;
        }
        Vec::new()
    }

    /// Checks that the links form a tree: exactly one link has no parent, all others have one, and every path leads
    /// to the root.
    fn tree_problems(&self, out: &mut Vec<Problem>) {
        let mut parents: BTreeMap<&str, usize> = BTreeMap::new();
        self.joints.iter().for_each(|joint| *parents.entry(&joint.child.link).or_default() += 1);
        for (link, count) in &parents {
            if *count > 1 {
                let problem = format!("is the child of {count} joints");
                out.push(Problem::of(link, problem, "a URDF is a tree: remove the joints that close loops"));
            }
        }
        let roots: Vec<&str> =
            self.links.iter().map(|l| l.name.as_str()).filter(|l| !parents.contains_key(l)).collect();
        if let [_, others @ ..] = roots.as_slice()
            && !others.is_empty()
        {
            let problem = format!("is not the only root: {} have no parent either", others.join(", "));
            out.push(Problem::of(roots[0], problem, "join them to the tree by fixed joints"));
        }
        let circular = |link: &&Link| {
            let mut at = link.name.as_str();
            let mut steps = 0;
            while let Some(joint) = self.parent_joint(at) {
                at = &joint.parent.link;
                steps += 1;
                if steps > self.joints.len() {
                    return true;
                }
            }
            false
        };
        if let Some(link) = self.links.iter().find(circular) {
            out.push(Problem::of(&link.name, "is carried by itself: the joints go in a circle", ""));
        }
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

/// Checks that the mass of a body and, unless it stands still, its principal moments are not negative.
fn body_problems(link: &Link, stands_still: bool, out: &mut Vec<Problem>) {
    pose_problems(&link.name, &link.inertial.origin, out);
    let mass_kg = link.inertial.mass.value;
    if !(mass_kg >= 0.0 && beyond_calculation(mass_kg).is_none()) {
        let problem = format!("has a mass of {mass_kg} kg");
        out.push(Problem::of(&link.name, problem, "give a mass that is not negative"));
    }
    if stated_tensor(link).iter().any(|entry| !entry.is_finite()) {
        out.push(Problem::of(&link.name, "has an inertia that is no number", ""));
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

/// The line of the text in which a link or joint of this name begins; `None` if none is found.
fn line_of(text: &str, name: &str) -> Option<usize> {
    let quoted = [format!("name=\"{name}\""), format!("name='{name}'")];
    let begins = |line: &str| quoted.iter().any(|q| line.contains(q.as_str()));
    text.lines().position(begins).map(|at| at + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_fault_of_a_file_is_found_at_once() {
        let text = r#"<robot name="r">
          <link name="a"><inertial><mass value="-1"/><inertia ixx="1" ixy="2" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
          <link name="b"/><link name="b"/><link name="c"/>
          <joint name="j" type="revolute"><parent link="d"/><child link="a"/><axis xyz="0 0 0"/>
            <limit effort="1" velocity="1"/><mimic joint="k"/></joint>
        </robot>"#;
        let faults = UrdfTree::read("r.urdf", text).expect_err("faults").0;
        let said: Vec<String> = faults.iter().map(ToString::to_string).collect();
        for part in [
            "r.urdf:3: b: the name of the link is taken",
            "r.urdf:2: a: has a mass of -1 kg",
            "principal moment of inertia, -1",
            "r.urdf:4: j: names the link \"d\"",
            "axis without direction",
            "mimics \"k\"",
            "is not the only root",
        ] {
            assert!(said.iter().any(|s| s.contains(part)), "{part} in {said:#?}");
        }
        let refused = |text: &str| UrdfTree::read("r.urdf", text).expect_err("no URDF").to_string();
        let nameless = refused("<robot name=\"r\"><link/></robot>");
        assert!(nameless.contains("is no URDF") && !nameless.contains("xacro"), "{nameless}");
        let xacro = refused("<robot name=\"r\"><xacro:part/><link/></robot>");
        assert!(xacro.contains("is no URDF") && xacro.contains("expand its macros"), "{xacro}");
        for cut in ["", "<robot", "<robot name=\"r\">\n<link name=\"a\"/>"] {
            let said = refused(cut);
            assert!(said.contains("is empty or cut off"), "{cut}: {said}");
        }
        let far = "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/><joint name=\"j\" type=\"fixed\"><parent link=\"a\"/>\
                   <child link=\"b\"/><origin xyz=\"0 0 X\"/></joint></robot>";
        assert!(refused(&far.replace('X', "nan")).contains("j: has an origin that is no number"));
        assert!(refused(&far.replace('X', "1e300")).contains("m away"));
    }

    /// A product of inertia of 1e-20, where all other entries are zero, is a rounding error of a tensor that was moved
    /// from the origin.
    #[test]
    fn a_tensor_within_rounding_has_no_negative_moments_and_a_link_that_stands_still_may_have_any() {
        let inertial = |ixx: &str, ixz: &str| {
            format!(
                "<inertial><origin xyz=\"0.1 0 0.3\"/><mass value=\"0.5\"/>\
                 <inertia ixx=\"{ixx}\" ixy=\"0\" ixz=\"{ixz}\" iyy=\"0\" iyz=\"0\" izz=\"0\"/></inertial>"
            )
        };
        let robot = |kind: &str, of_b: String| {
            let text = format!(
                "<robot name=\"r\"><link name=\"a\"/><link name=\"b\">{of_b}</link><joint name=\"j\" type=\"{kind}\">\
                 <parent link=\"a\"/><child link=\"b\"/><axis xyz=\"0 1 0\"/>\
                 <limit lower=\"-1\" upper=\"1\" effort=\"10\" velocity=\"1\"/></joint></robot>"
            );
            UrdfTree::read("r.urdf", &text)
        };
        let rounded = robot("revolute", inertial("0", "1e-20")).expect("rounding");
        let tensor = tensor(&rounded.links[1]);
        assert!(SymmetricEigen::new(tensor).eigenvalues.min() >= -1e-6 * tensor.amax(), "{tensor}");
        assert!(rounded.impossible_and_still().is_empty());
        assert!(robot("revolute", inertial("-1", "0")).is_err());
        let still = robot("fixed", inertial("-1", "0")).expect("it never moves");
        assert_eq!(still.impossible_and_still(), ["b"]);
    }

    #[test]
    fn what_the_robot_looks_like_does_not_matter() {
        let text = "<robot name=\"r\"><link name=\"a\"><visual><geometry><box size=\"1 1 1\"/></geometry>\
            <material name=\"m\"><texture/></material></visual></link></robot>";
        assert_eq!(UrdfTree::read("r.urdf", text).expect("a robot").links.len(), 1);
    }
}
