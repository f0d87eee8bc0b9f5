//! A robot of a URDF file as a tree: links by name, the joint that holds each link, and the joints that hang on it.
//!
//! All of it is found once, when the tree is made, in a time that grows with the number of links and joints. Files with
//! faults are made trees too, so that all of their faults can be found: links that nothing holds up, or that hold each
//! other in a loop.

use nalgebra::{Isometry3, Matrix3, SymmetricEigen, Translation3, UnitQuaternion, Vector3};
use std::collections::BTreeMap;
use urdf_rs::{Joint, JointType, Link, Pose, Robot};

/// A robot as a tree of links.
#[derive(Debug, Clone)]
pub(crate) struct UrdfTree {
    /// Name of the robot.
    pub name: String,
    /// The links, in the order of the file.
    pub links: Vec<Link>,
    /// The joints, in the order of the file.
    pub joints: Vec<Joint>,
    /// Index of each link by its name. If several links have one name, it is the first of them.
    link_at: BTreeMap<String, usize>,
    /// Index of each joint by its name. If several joints have one name, it is the first of them.
    joint_at: BTreeMap<String, usize>,
    /// For each link, the index of the joint whose child it is; `None` for a root.
    held_by: Vec<Option<usize>>,
    /// For each link, the indices of the joints whose parent it is.
    holds: Vec<Vec<usize>>,
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
pub(super) fn stated_tensor(link: &Link) -> Matrix3<f64> {
    let i = &link.inertial.inertia;
    Matrix3::new(i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz)
}

/// Index of each name in a list; the first one if a name occurs several times.
fn first_places<'n>(names: impl Iterator<Item = &'n String>) -> BTreeMap<String, usize> {
    let mut out = BTreeMap::new();
    for (place, name) in names.enumerate() {
        out.entry(name.clone()).or_insert(place);
    }
    out
}

impl UrdfTree {
    /// The tree of a robot.
    pub(super) fn new(Robot { name, links, joints, .. }: Robot) -> Self {
        let link_at = first_places(links.iter().map(|link| &link.name));
        let joint_at = first_places(joints.iter().map(|joint| &joint.name));
        let (mut held_by, mut holds) = (vec![None; links.len()], vec![Vec::new(); links.len()]);
        for (index, joint) in joints.iter().enumerate() {
            if let Some(child) = link_at.get(&joint.child.link) {
                held_by[*child].get_or_insert(index);
            }
            if let Some(parent) = link_at.get(&joint.parent.link) {
                holds[*parent].push(index);
            }
        }
        Self { name, links, joints, link_at, joint_at, held_by, holds }
    }

    /// The index of the link with this name; `None` if there is none.
    pub(super) fn link_index(&self, name: &str) -> Option<usize> {
        self.link_at.get(name).copied()
    }

    /// The index of the joint with this name; `None` if there is none.
    pub(super) fn joint_index(&self, name: &str) -> Option<usize> {
        self.joint_at.get(name).copied()
    }

    /// The link with this name; `None` if there is none.
    pub(crate) fn link(&self, name: &str) -> Option<&Link> {
        self.link_index(name).map(|index| &self.links[index])
    }

    /// The joint whose child is the link with this index; `None` for a root.
    pub(super) fn parent_joint(&self, link: usize) -> Option<&Joint> {
        self.held_by.get(link).copied().flatten().map(|joint| &self.joints[joint])
    }

    /// The joints whose parent is this link.
    pub(crate) fn child_joints(&self, link: &str) -> impl DoubleEndedIterator<Item = &Joint> {
        let joints = self.link_index(link).map_or(&[][..], |index| &self.holds[index]);
        joints.iter().map(|joint| &self.joints[*joint])
    }

    /// The joints on the path from the root to the link `tip`, in the order of the path.
    pub(crate) fn path_to(&self, tip: &str) -> Vec<&Joint> {
        let mut path = Vec::new();
        let mut link = self.link_index(tip);
        // in a loop of joints the path would have no end
        while let Some(joint) = link.and_then(|link| self.parent_joint(link))
            && path.len() < self.joints.len()
        {
            path.push(joint);
            link = self.link_index(&joint.parent.link);
        }
        path.reverse();
        path
    }

    /// The links without child joints. An arm may end at any of them.
    pub(crate) fn ends(&self) -> Vec<&str> {
        let links = self.links.iter().zip(&self.holds);
        links.filter(|(_, joints)| joints.is_empty()).map(|(link, _)| link.name.as_str()).collect()
    }

    /// For each link, whether it never moves: every joint from the root to it is fixed.
    pub(super) fn still(&self) -> Vec<bool> {
        let mut still: Vec<bool> = self.held_by.iter().map(Option::is_none).collect();
        let mut open: Vec<usize> = (0..still.len()).filter(|link| still[*link]).collect();
        while let Some(link) = open.pop() {
            for joint in &self.holds[link] {
                let child = self.link_index(&self.joints[*joint].child.link);
                let fixed =
                    |child: &usize| self.held_by[*child] == Some(*joint) && !moves(&self.joints[*joint]);
                if let Some(child) = child.filter(fixed) {
                    still[child] = true;
                    open.push(child);
                }
            }
        }
        still
    }
}
