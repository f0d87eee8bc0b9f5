//! Conversion of a URDF to an arm. Frames are accumulated, fixed joints and side branches are merged into links, and
//! inertials become bodies.
//!
//! A URDF gives every link a frame of its own, rotated against the frame of its parent. In an arm all frames are
//! parallel to the world's when all joint angles are zero. So every position, axis and inertia is converted to the
//! root frame of the URDF at zero angles. The path from the root to the tip is the arm. Each moving joint on this
//! path becomes a joint. Everything between two of them becomes one rigid link, which takes over the bodies of its URDF
//! links. The joints of side branches are held at one position each. The bodies of a side branch are added to the link
//! on which it hangs.
//!
//! A URDF has no stiffness. A joint that the stiffness file does not name is rigid.

use super::free_name::FreeNames;
use super::given::{GivenJoint, GivenSprings, MovingJoint};
use super::report::{Held, ImportReport};
use super::urdf_faults::impossible_and_still;
use super::urdf_file::read_urdf;
use super::urdf_tree::{UrdfTree, isometry, moves, slides, tensor};
use crate::arm::body::RigidBody;
use crate::arm::extras::Extras;
use crate::arm::joint_law::Curve;
use crate::arm::{Arm, Element, GRAVITY_M_S2, Joint, JointBodies, Link, LinkBody, MOST_ELEMENTS, Prismatic};
use crate::input::json::{Fault, Faults};
use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};
use std::collections::{BTreeMap, BTreeSet};
use urdf_rs::JointType;

/// A robot of a URDF file, with the tip link that determines the arm.
pub(crate) struct Robot<'a> {
    file: &'a str,
    tree: UrdfTree,
    tip: &'a str,
    /// How each joint moves, in the order of the file.
    motions: Vec<Moves>,
}

/// How a joint moves.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Moves {
    /// The joint does not move. It is held at this angle \[rad\] or travel \[m\].
    Not(f64),
    /// The joint is driven, with an angle or travel of its own.
    Driven,
    /// The joint follows a joint on the path to the tip: its angle is a factor times the angle of this driven joint, plus
    /// a constant \[rad\]. The fields are the index of the driven joint, the factor and the constant.
    With(usize, f64, f64),
}

/// How each joint of a robot moves, in the order of the file. If a joint mimics one that itself mimics another one, it
/// follows the joint at the end of this sequence. `tip` is the link where the arm ends.
fn motions(tree: &UrdfTree, tip: &str) -> Vec<Moves> {
    let on_way: BTreeSet<&str> = tree.path_to(tip).iter().map(|joint| joint.name.as_str()).collect();
    let followed = |joint: usize| tree.joint_index(&tree.joints[joint].mimic.as_ref()?.joint);
    let mut found: Vec<Option<Moves>> = vec![None; tree.joints.len()];
    for start in 0..found.len() {
        // from this joint to the first one whose motion is known, and back; no joints of a file mimic each other in a circle
        let mut way = Vec::new();
        let mut at = Some(start);
        while let Some(joint) = at.filter(|joint| found[*joint].is_none() && way.len() < found.len()) {
            way.push(joint);
            at = followed(joint);
        }
        for index in way.into_iter().rev() {
            let joint = &tree.joints[index];
            let ahead = followed(index).and_then(|other| Some((other, found[other]?)));
            found[index] = Some(match (&joint.mimic, ahead) {
                _ if !moves(joint) => Moves::Not(0.0),
                (Some(mimic), Some((other, ahead))) => {
                    let (factor, offset) = (mimic.multiplier.unwrap_or(1.0), mimic.offset.unwrap_or(0.0));
                    match ahead {
                        Moves::Not(at) => Moves::Not(offset + factor * at),
                        Moves::With(driver, further, at) => {
                            Moves::With(driver, factor * further, offset + factor * at)
                        }
                        Moves::Driven if on_way.contains(tree.joints[other].name.as_str()) => {
                            Moves::With(other, factor, offset)
                        }
                        // the joint that it follows is not on the path and is held, so this joint is held too
                        Moves::Driven => Moves::Not(offset),
                    }
                }
                _ => Moves::Driven,
            });
        }
    }
    found.into_iter().map(|motion| motion.unwrap_or(Moves::Driven)).collect()
}

impl<'a> Robot<'a> {
    /// Reads a URDF file. `tip` is the link where the arm ends.
    ///
    /// # Errors
    /// All faults of the file; or that the tip is no link of the robot, or that a joint on the path is of a kind that
    /// no arm has.
    pub(crate) fn read(file: &'a str, text: &str, tip: &'a str) -> Result<Self, Faults> {
        let tree = read_urdf(file, text)?;
        let motions = motions(&tree, tip);
        let robot = Self { file, tree, tip, motions };
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

    /// Faults for the joints on the path to the tip that are of a kind that no arm has.
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

    /// The joints of the arm, base to tip, including passive ones.
    pub(crate) fn joints(&self) -> Vec<MovingJoint<'_>> {
        let path = self.tree.path_to(self.tip).into_iter();
        let moving = path.filter(|joint| !matches!(self.motion_of(joint), Moves::Not(_)));
        moving.map(|joint| MovingJoint { name: &joint.name, slides: slides(joint) }).collect()
    }

    /// Whether the angle of a joint follows another joint (`<mimic>`).
    fn follows(&self, joint: &urdf_rs::Joint) -> bool {
        matches!(self.motion_of(joint), Moves::With(..))
    }

    /// Whether the angle of a joint follows the travel of a joint that slides.
    fn follows_a_slide(&self, joint: &urdf_rs::Joint) -> bool {
        matches!(self.motion_of(joint), Moves::With(driver, ..) if slides(&self.tree.joints[driver]))
    }

    /// How a joint moves.
    fn motion_of(&self, joint: &urdf_rs::Joint) -> Moves {
        self.tree.joint_index(&joint.name).map_or(Moves::Driven, |index| self.motions[index])
    }

    /// Where the joints that follow another joint are held if they are on side branches, by name. Other joints of side
    /// branches are held at zero.
    fn held_beside_way(&self) -> BTreeMap<&str, Held> {
        let mimicking = self.tree.joints.iter().filter(|joint| moves(joint) && joint.mimic.is_some());
        let held = |joint: &'_ urdf_rs::Joint| match self.motion_of(joint) {
            Moves::Not(at) => Held { at, follows: None },
            Moves::Driven => Held::default(),
            Moves::With(driver, factor, at) => {
                Held { at, follows: Some((self.tree.joints[driver].name.clone(), factor)) }
            }
        };
        mimicking.map(|joint| (joint.name.as_str(), held(joint))).collect()
    }

    /// Converts the robot to an arm whose joints have the elastic properties `given`. Returns the arm, and the report
    /// of the import.
    ///
    /// # Errors
    /// The arm has more joints and links than an arm file may have.
    pub(crate) fn arm(&self, given: &[GivenJoint]) -> Result<(Arm, ImportReport), Faults> {
        let mut walk = Walk {
            tree: &self.tree,
            on_way: self.tree.path_to(self.tip).iter().map(|joint| joint.child.link.as_str()).collect(),
            at: Isometry3::identity(),
            start_m: Vector3::zeros(),
            name: String::new(),
            bodies: Vec::new(),
            held: self.held_beside_way(),
            names: FreeNames::all_but(self.joints().into_iter().map(|joint| joint.name.to_string())),
            chain: Vec::new(),
            report: ImportReport::new(self.file, &self.tree.name, self.tip),
        };
        let root = self.tree.path_to(self.tip).first().map_or(self.tip, |joint| joint.parent.link.as_str());
        walk.begin(root);
        for joint in self.tree.path_to(self.tip) {
            walk.at *= isometry(&joint.origin);
            walk.pass(joint, self.motion_of(joint), given);
        }
        walk.end_link();
        if walk.chain.len() > MOST_ELEMENTS {
            let elements = walk.chain.len();
            let problem =
                format!("the arm has {elements} joints and links, and the limit is {MOST_ELEMENTS}");
            let hint = "choose a link nearer to the root, or make joints on the way to it fixed";
            return Err(Faults(vec![self.fault("--tip", problem, hint.into())]));
        }
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
        let still = impossible_and_still(&self.tree);
        report.impossible = arm.impossible_bodies().into_iter().chain(still).map(String::from).collect();
        report.impossible.dedup();
        report.mass_kg = arm.mass_kg();
        Ok((arm, report))
    }
}

/// The walk along the path from the root to the tip.
struct Walk<'t> {
    tree: &'t UrdfTree,
    /// Joints of side branches that do not stand at zero, by name.
    held: BTreeMap<&'t str, Held>,
    /// Names of the URDF links on the path, without the root.
    on_way: BTreeSet<&'t str>,
    /// Frame in the world, at zero joint angles, of the URDF link that the walk has reached.
    at: Isometry3<f64>,
    /// Position in the world at which the link of the arm that is being built begins \[m\].
    start_m: Vector3<f64>,
    /// Name of the link of the arm that is being built.
    name: String,
    /// Bodies of the link of the arm that is being built. Their positions are measured from where the link begins.
    bodies: Vec<RigidBody>,
    /// Names that no element of the arm has yet.
    names: FreeNames,
    chain: Vec<Element>,
    report: ImportReport,
}

impl<'t> Walk<'t> {
    /// Begins a link of the arm at the URDF link `link`. The bodies of this link and of the side branches that hang on
    /// it are added to it.
    fn begin(&mut self, link: &'t str) {
        self.start_m = self.at.translation.vector;
        // in a URDF a link and a joint may have the same name; in an arm no two elements may
        self.name = self.names.take(link, "_link");
        self.lump(link, self.at);
    }

    /// Goes past a joint on the path to the tip, to the URDF link that is its child. `motion` says how the joint moves.
    /// A joint that moves is added to the arm, with the elastic properties that `given` states for it.
    fn pass(&mut self, joint: &'t urdf_rs::Joint, motion: Moves, given: &[GivenJoint]) {
        let axis = Unit::new_normalize(Vector3::from(joint.axis.xyz.0));
        let child = joint.child.link.as_str();
        let (coupled, offset_rad) = match motion {
            Moves::Not(held_at) => {
                self.at *= moved(joint, held_at);
                self.report.joined(joint, &self.name, held_at);
                return self.lump(child, self.at);
            }
            Moves::Driven => (None, 0.0),
            Moves::With(driver, factor, offset_rad) => {
                (Some(vec![(self.tree.joints[driver].name.clone(), factor)]), offset_rad)
            }
        };
        self.end_link();
        let springs = given.iter().find(|given| given.name == joint.name).map(|given| &given.springs);
        self.report.joint(joint, springs, coupled.as_deref(), offset_rad);
        let in_world = Unit::new_normalize(self.at.rotation * axis.into_inner());
        self.chain.push(match slides(joint) {
            true => Element::Prismatic(slide(&joint.name, in_world, springs)),
            false => Element::Joint(hinge(&joint.name, in_world, springs, coupled)),
        });
        self.at *= UnitQuaternion::from_axis_angle(&axis, offset_rad);
        self.begin(child);
    }

    /// Ends the link of the arm that was begun, at the position that the walk has reached. A link without length and
    /// without bodies is left out.
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

    /// Adds bodies to the link of the arm that is being built: the body of the URDF link `link`, whose frame is `at`,
    /// and the bodies of all side branches that hang on it.
    fn lump(&mut self, link: &'t str, at: Isometry3<f64>) {
        let tree = self.tree;
        // links of side branches, each with its frame and the joint by which it hangs; a branch may be very long
        let mut open: Vec<(&'t str, Isometry3<f64>, Option<&'t urdf_rs::Joint>)> = vec![(link, at, None)];
        while let Some((link, at, by)) = open.pop() {
            let Some(found) = tree.link(link) else { continue };
            if let Some(joint) = by {
                let held = self.held.get(joint.name.as_str()).cloned().unwrap_or_default();
                self.report.lumped(found, &self.name, joint, &held);
            }
            self.bodies.extend(body_at(found, &at, &self.start_m));
            // the last one that is pushed is the first one that is taken
            for joint in tree.child_joints(link).rev() {
                let child = joint.child.link.as_str();
                if !self.on_way.contains(child) {
                    let held_at = self.held.get(joint.name.as_str()).map_or(0.0, |held| held.at);
                    open.push((child, at * isometry(&joint.origin) * moved(joint, held_at), Some(joint)));
                }
            }
        }
    }
}

/// The displacement that a joint makes when it is held at `at` \[rad or m\]: a rotation or a translation. A fixed joint
/// makes none.
fn moved(joint: &urdf_rs::Joint, at: f64) -> Isometry3<f64> {
    if !moves(joint) {
        return Isometry3::identity();
    }
    let axis = Unit::new_normalize(Vector3::from(joint.axis.xyz.0));
    match slides(joint) {
        true => Translation3::from(axis.into_inner() * at).into(),
        false => Isometry3::from_parts(Translation3::identity(), UnitQuaternion::from_axis_angle(&axis, at)),
    }
}

/// A joint that turns. Its drive adds no mass, because the bodies of the URDF include it.
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

/// A joint that slides. Its drive adds no mass, because the bodies of the URDF include it.
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
        gear: None,
        motor: None,
    }
}

/// The body of a URDF link whose frame is `at` in the world, with its position measured from the start `start_m` of a
/// link of the arm. `None` if the link has neither mass nor inertia.
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
