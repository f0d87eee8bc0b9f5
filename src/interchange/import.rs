//! From a URDF to an arm: frames accumulated, fixed joints and side branches lumped, inertials as bodies.
//!
//! A URDF gives every link a frame of its own, turned against that of its parent. In an arm all frames are parallel to the world's
//! while all joint angles are zero. So every place, axis and inertia is written in the root frame of the URDF at zero angles.
//! The way from the root to the tip is the arm. Each of its moving joints becomes a joint. What lies between two of them becomes
//! one rigid link, and the bodies of its URDF links go with it, together with everything that hangs on it beside the way: side
//! branches stand still at their zero.
//!
//! A URDF says nothing of stiffness. A joint that the stiffness file does not give stays rigid.

use super::given::{GivenJoint, GivenSprings, MovingJoint};
use super::report::ImportReport;
use super::urdf_file::{UrdfTree, isometry, moves, slides, tensor};
use crate::arm::body::RigidBody;
use crate::arm::extras::Extras;
use crate::arm::joint_law::Curve;
use crate::arm::{Arm, Element, Joint, JointBodies, Link, LinkBody, Prismatic};
use crate::input::json::{Fault, Faults};
use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};
use std::collections::BTreeSet;
use urdf_rs::JointType;

const GRAVITY_M_S2: f64 = 9.81;

/// A robot of a URDF file, and the tip that makes an arm of it.
pub(crate) struct Robot<'a> {
    file: &'a str,
    tree: UrdfTree,
    tip: &'a str,
}

/// How a joint on the way to the tip moves.
enum Moves<'t> {
    /// It does not, and stands at this angle \[rad\] or travel \[m\].
    Not(f64),
    /// By an angle or a travel of its own.
    Driven,
    /// With other joints: its angle is a factor times the angle of a driven joint, plus a constant \[rad\].
    With(&'t str, f64, f64),
}

impl<'a> Robot<'a> {
    /// Reads a URDF file. `tip` is the link where the arm ends.
    ///
    /// # Errors
    /// All faults of the file; a tip that is no link; a joint on the way that no arm has.
    pub(crate) fn read(file: &'a str, text: &str, tip: &'a str) -> Result<Self, Faults> {
        let robot = Self { file, tree: UrdfTree::read(file, text)?, tip };
        if robot.tree.link(tip).is_none() {
            let names: Vec<&str> = robot.tree.links.iter().map(|link| link.name.as_str()).collect();
            let hint = format!(
                "the links are: {}; links that carry nothing further: {}",
                names.join(", "),
                robot.tree.ends().join(", ")
            );
            return Err(Faults(vec![robot.fault(
                "--tip",
                format!("\"{tip}\" is no link of the robot"),
                hint,
            )]));
        }
        let faults = robot.unfit_joints();
        if faults.is_empty() { Ok(robot) } else { Err(Faults(faults)) }
    }

    fn fault(&self, field: &str, problem: String, hint: String) -> Fault {
        Fault { file: self.file.into(), line: None, field: field.into(), problem, hint }
    }

    /// Joints on the way to the tip that an arm cannot have.
    fn unfit_joints(&self) -> Vec<Fault> {
        let path = self.tree.path_to(self.tip);
        let unfit = path.iter().filter_map(|joint| {
            let word = match joint.joint_type {
                JointType::Prismatic if self.follows(joint) => "mimicking prismatic",
                JointType::Revolute | JointType::Continuous if self.follows_a_slide(joint) => {
                    "joint that mimics a prismatic"
                }
                JointType::Fixed | JointType::Revolute | JointType::Continuous | JointType::Prismatic => {
                    return None;
                }
                JointType::Floating => "floating",
                JointType::Planar => "planar",
                JointType::Spherical => "spherical",
            };
            let hint = "the joints of an arm are revolute, continuous, prismatic or fixed, and only those that turn mimic one \
                        another; choose a --tip before this joint, or make it fixed in the position that you want to look at";
            Some(self.fault(&joint.name, format!("is a {word} joint on the way to the tip"), hint.into()))
        });
        let mut out: Vec<Fault> = unfit.collect();
        if out.is_empty() && self.joints().is_empty() {
            let hint = format!("links that carry nothing further: {}", self.tree.ends().join(", "));
            let problem = format!("no joint moves between the root and \"{}\"", self.tip);
            out.push(self.fault("--tip", problem, hint));
        }
        out
    }

    /// The joints of the arm, base to tip, passive ones included.
    pub(crate) fn joints(&self) -> Vec<MovingJoint<'_>> {
        let path = self.tree.path_to(self.tip).into_iter();
        let moving = path.filter(|joint| !matches!(self.motion_of(&joint.name), Moves::Not(_)));
        moving.map(|joint| MovingJoint { name: &joint.name, slides: slides(joint) }).collect()
    }

    /// Whether a joint moves with another one.
    fn follows(&self, joint: &urdf_rs::Joint) -> bool {
        matches!(self.motion_of(&joint.name), Moves::With(..))
    }

    /// Whether a joint moves with one that slides.
    fn follows_a_slide(&self, joint: &urdf_rs::Joint) -> bool {
        let Moves::With(driver, ..) = self.motion_of(&joint.name) else { return false };
        self.tree.joints.iter().any(|other| other.name == driver && slides(other))
    }

    /// How a joint moves. A mimic of a mimic follows the joint that both follow in the end.
    fn motion_of(&self, name: &str) -> Moves<'_> {
        let (mut factor, mut offset_rad) = (1.0, 0.0);
        let on_way: BTreeSet<&str> = self.tree.path_to(self.tip).iter().map(|j| j.name.as_str()).collect();
        let mut at = name;
        for _ in 0..=self.tree.joints.len() {
            let Some(joint) = self.tree.joints.iter().find(|j| j.name == at) else { break };
            if !moves(joint) {
                return Moves::Not(offset_rad);
            }
            let Some(mimic) = &joint.mimic else {
                return match (joint.name == name, on_way.contains(joint.name.as_str())) {
                    (true, _) => Moves::Driven,
                    (false, true) => Moves::With(&joint.name, factor, offset_rad),
                    // what drives it stands still
                    (false, false) => Moves::Not(offset_rad),
                };
            };
            offset_rad += factor * mimic.offset.unwrap_or(0.0);
            factor *= mimic.multiplier.unwrap_or(1.0);
            at = &mimic.joint;
        }
        Moves::Not(offset_rad)
    }

    /// The arm and what is to be said of it.
    pub(crate) fn arm(&self, given: &[GivenJoint]) -> (Arm, ImportReport) {
        let mut walk = Walk {
            tree: &self.tree,
            on_way: self.tree.path_to(self.tip).iter().map(|joint| joint.child.link.as_str()).collect(),
            at: Isometry3::identity(),
            start_m: Vector3::zeros(),
            name: String::new(),
            bodies: Vec::new(),
            taken: self.joints().into_iter().map(|joint| joint.name.to_string()).collect(),
            chain: Vec::new(),
            report: ImportReport::new(self.file, &self.tree.name, self.tip),
        };
        let root = self.tree.path_to(self.tip).first().map_or(self.tip, |joint| joint.parent.link.as_str());
        walk.begin(root);
        for joint in self.tree.path_to(self.tip) {
            walk.at *= isometry(&joint.origin);
            walk.pass(joint, self.motion_of(&joint.name), given);
        }
        walk.end_link();
        let mut report = walk.report;
        report.finish(&self.tree, &walk.at, self.tip);
        let arm = Arm {
            name: self.tree.name.clone(),
            gravity_m_s2: GRAVITY_M_S2,
            down: -Vector3::z(),
            chain: walk.chain,
            effects: Vec::new(),
            springs: Vec::new(),
        };
        report.impossible = arm.impossible_bodies().into_iter().map(String::from).collect();
        report.mass_kg = arm.mass_kg();
        (arm, report)
    }
}

/// The walk from the root to the tip.
struct Walk<'t> {
    tree: &'t UrdfTree,
    /// Links on the way but the root.
    on_way: BTreeSet<&'t str>,
    /// Frame of the present URDF link in the world, all angles zero.
    at: Isometry3<f64>,
    /// Where the present link of the arm begins \[m\].
    start_m: Vector3<f64>,
    /// Its name.
    name: String,
    /// Its bodies, from where it begins.
    bodies: Vec<RigidBody>,
    /// Names that are taken.
    taken: BTreeSet<String>,
    chain: Vec<Element>,
    report: ImportReport,
}

impl<'t> Walk<'t> {
    /// Begins a link of the arm with a URDF link and what hangs on it.
    fn begin(&mut self, link: &str) {
        self.start_m = self.at.translation.vector;
        self.name = self.free_name(link);
        self.lump(link, self.at, None);
    }

    /// Links and joints of a URDF may have the same names, elements of an arm may not.
    fn free_name(&mut self, name: &str) -> String {
        let mut free = name.to_string();
        while !self.taken.insert(free.clone()) {
            free.push_str("_link");
        }
        free
    }

    /// Passes a joint of the way to the URDF link behind it.
    fn pass(&mut self, joint: &'t urdf_rs::Joint, motion: Moves, given: &[GivenJoint]) {
        let axis = Unit::new_normalize(Vector3::from(joint.axis.xyz.0));
        let child = joint.child.link.as_str();
        let (coupled, offset_rad) = match motion {
            Moves::Not(held_at) => {
                match slides(joint) {
                    true => self.at *= Translation3::from(axis.into_inner() * held_at),
                    false => self.at *= UnitQuaternion::from_axis_angle(&axis, held_at),
                }
                self.report.joined(joint, &self.name, held_at);
                return self.lump(child, self.at, None);
            }
            Moves::Driven => (None, 0.0),
            Moves::With(driver, factor, offset_rad) => (Some(vec![(driver.to_string(), factor)]), offset_rad),
        };
        self.end_link();
        let springs = given.iter().find(|given| given.name == joint.name).map(|given| &given.springs);
        self.report.joint(joint, springs, coupled.as_deref());
        let in_world = Unit::new_normalize(self.at.rotation * axis.into_inner());
        self.chain.push(match slides(joint) {
            true => Element::Prismatic(slide(&joint.name, in_world, springs)),
            false => Element::Joint(hinge(&joint.name, in_world, springs, coupled)),
        });
        self.at *= UnitQuaternion::from_axis_angle(&axis, offset_rad);
        self.begin(child);
    }

    /// Ends the present link of the arm at the present place. A link without length and bodies is left away.
    fn end_link(&mut self) {
        let vector_m = self.at.translation.vector - self.start_m;
        let bodies = std::mem::take(&mut self.bodies);
        if vector_m.norm() == 0.0 && bodies.is_empty() {
            return;
        }
        self.chain.push(Element::Link(Link {
            name: self.name.clone(),
            vector_m,
            body: LinkBody::Offset { mass_kg: 0.0 },
            bodies,
        }));
    }

    /// Adds a URDF link at a place, and all that it carries beside the way. `by` is the joint that holds it if it is not on
    /// the way.
    fn lump(&mut self, link: &str, at: Isometry3<f64>, by: Option<&urdf_rs::Joint>) {
        let tree = self.tree;
        let Some(found) = tree.link(link) else { return };
        let body = body_at(found, &at, &self.start_m);
        if let Some(joint) = by {
            self.report.lumped(found, &self.name, joint);
        }
        self.bodies.extend(body);
        for joint in tree.child_joints(link) {
            if !self.on_way.contains(joint.child.link.as_str()) {
                self.lump(&joint.child.link, at * isometry(&joint.origin), Some(joint));
            }
        }
    }
}

/// A joint that turns. The bodies of the file have its drive in them.
fn hinge(
    name: &str,
    axis: Unit<Vector3<f64>>,
    springs: Option<&GivenSprings>,
    coupled: Option<Vec<(String, f64)>>,
) -> Joint {
    let (curve, bearing, gear, motor) = match springs {
        Some(GivenSprings::Hinge { curve, bearing, gear, motor }) => {
            (*curve, *bearing, gear.clone(), motor.clone())
        }
        _ => (Curve::Rigid, None, None, None),
    };
    let (extras, bodies) = (Extras::default(), JointBodies::default());
    Joint {
        name: name.into(),
        axis,
        curve,
        mass_kg: 0.0,
        bearing,
        extras,
        bodies,
        gear,
        motor,
        coupled,
        stages: Default::default(),
        turns_with: Vec::new(),
    }
}

/// A joint that slides. The bodies of the file have its drive in them.
fn slide(name: &str, axis: Unit<Vector3<f64>>, springs: Option<&GivenSprings>) -> Prismatic {
    let (stiffness_n_per_m, guide, moves) = match springs {
        Some(GivenSprings::Slide { stiffness_n_per_m, guide, moves }) => (*stiffness_n_per_m, *guide, *moves),
        _ => Default::default(),
    };
    Prismatic {
        name: name.into(),
        axis,
        stiffness_n_per_m,
        guide,
        moves,
        mass_kg: 0.0,
        fixed_mass_kg: 0.0,
        bodies: JointBodies::default(),
    }
}

/// The body of a URDF link whose frame stands at a place, measured from the start of a link of the arm.
fn body_at(link: &urdf_rs::Link, at: &Isometry3<f64>, start_m: &Vector3<f64>) -> Option<RigidBody> {
    let inertial = at * isometry(&link.inertial.origin);
    let turn = inertial.rotation.to_rotation_matrix().into_inner();
    let inertia_kgm2 = turn * tensor(link) * turn.transpose();
    let mass_kg = link.inertial.mass.value;
    (mass_kg > 0.0 || inertia_kgm2.amax() > 0.0).then(|| RigidBody {
        mass_kg,
        cg_m: inertial.translation.vector - start_m,
        inertia_kgm2: 0.5 * (inertia_kgm2 + inertia_kgm2.transpose()),
    })
}
