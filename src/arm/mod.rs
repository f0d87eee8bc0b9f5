//! Arms: a chain of joints and links from base to tip, its load cases, and its effects beyond the nominal model.
//!
//! World z is up. Gravity points along -z unless the arm states another direction. With all joint angles zero, every
//! frame of the chain is parallel to the world's. The axis of a joint and the vector of a link are written in the
//! *carried frame*, which turns with the joints inboard of the element.
//!
//! - [`Arm`] is an arm as its file describes it ([`read_arm`] reads it).
//! - [`LoadCase`] is a pose with a load and the models to use.
//! - [`Structure`] is the arm as the mechanics needs it: effects are applied, names of catalog parts are left out.
//! - [`effect`] has the effects, one file each.

pub(crate) mod base_lift;
pub(crate) mod bearing;
pub(crate) mod body;
pub(crate) mod case_keys;
pub(crate) mod divided;
pub mod effect;
pub(crate) mod element_keys;
pub(crate) mod element_names;
pub(crate) mod extras;
pub(crate) mod file;
pub(crate) mod file_keys;
pub(crate) mod halton;
pub(crate) mod joint_law;
pub(crate) mod joint_torque;
pub(crate) mod keys;
pub(crate) mod link_file;
pub(crate) mod linkage;
pub(crate) mod load;
pub(crate) mod pieces;
pub(crate) mod pose;
pub(crate) mod prismatic;
pub(crate) mod prismatic_keys;
pub(crate) mod section;
mod section_file;
pub(crate) mod shared_keys;
pub(crate) mod springs;
pub(crate) mod springs_file;
pub(crate) mod structure;
pub(crate) mod torsion;
pub(crate) mod transmission;
pub(crate) mod transmissions;
pub(crate) mod write;

/// The word for the base of an arm in files. Where a file may name the base, the word means the base, even if an
/// element of the chain is called so.
pub(crate) const BASE: &str = "base";

/// The word that means the payload where the name of an element may stand.
pub(crate) const PAYLOAD: &str = "payload";

pub use bearing::{Bearing, BearingSource};
pub use body::{JointBodies, RigidBody};
pub use case_keys::CASES_FILE;
pub use effect::entry::Effect;
pub use extras::{Extras, ExtrasSource};
pub use file::{read_arm, read_arm_document};
pub use file_keys::ARM_FILE;
pub use joint_law::{Curve, FurtherTwist, JointLaw, LostMotion, Windup};
pub use linkage::Linkage;
pub use load::{LoadCase, Payload, Water, read_load_cases};
pub use pose::{DrivenJoint, Motion, any_slides, pose_json, pose_si};
pub use prismatic::{Guide, GuideLimits, Moves, NamedPart, Prismatic, PrismaticPiece};
pub use section::{LinkMaterial, Section, SectionProperties, StatedSection, Strength};
pub use springs::{Drawn, Spring, SpringEnd, SpringKind, SpringLaw, SpringPlace};
pub use structure::{Beam, FrameCompliance, JointAngle, JointPiece, LinkPiece, Piece, Structure};
pub use transmission::{Stage, Stages};

use crate::input::json::Fault;
use nalgebra::{Unit, Vector3};

/// Which deformations of links a calculation takes into account.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LinkModel {
    /// No deformation: links are rigid. Tubes keep their full mass and inertia.
    Rigid,
    /// Euler-Bernoulli bending in both planes only (Eqs 1-6 of docs/model.md).
    Bending,
    /// Bending, shear, torsion, axial stretch and rotary inertia.
    #[default]
    Full,
}

/// Which torsion curve of gears a calculation uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum JointModel {
    /// The slope K2 alone, as in the paper, which has a single stiffness.
    K2,
    /// The three-segment curve, for gears that have one.
    #[default]
    ThreeSegment,
    /// The three-segment curve for deflections, and its first slope K1 for vibrations. The frequencies are then the
    /// lowest that a gear whose slopes rise with the torque can have at any torque.
    ThreeSegmentK1,
}

/// An enumeration that has a word for each of its values, in files and on the command line.
pub trait Words: Sized + Copy + 'static {
    /// All values with their words.
    const WORDS: &'static [(&'static str, Self)];

    /// The value that is written as `word`; `None` if no value of the enumeration is.
    fn from_word(word: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(w, _)| *w == word).map(|(_, v)| *v)
    }

    /// All words, for messages.
    fn words() -> String {
        Self::WORDS.iter().map(|(w, _)| *w).collect::<Vec<_>>().join(", ")
    }
}

impl Words for LinkModel {
    const WORDS: &'static [(&'static str, Self)] =
        &[("rigid", Self::Rigid), ("bending", Self::Bending), ("full", Self::Full)];
}

impl Words for JointModel {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("k2", Self::K2),
        ("three_segment", Self::ThreeSegment),
        ("three_segment_k1", Self::ThreeSegmentK1),
    ];
}

impl LinkModel {
    /// The word for this model in files.
    pub fn word(self) -> &'static str {
        match self {
            LinkModel::Rigid => "rigid",
            LinkModel::Bending => "bending",
            LinkModel::Full => "full",
        }
    }
}

impl JointModel {
    /// The word for this model in files.
    pub fn word(self) -> &'static str {
        match self {
            JointModel::K2 => "k2",
            JointModel::ThreeSegment => "three_segment",
            JointModel::ThreeSegmentK1 => "three_segment_k1",
        }
    }
}

/// An arm as its file describes it.
///
/// ```
/// use armwright::arm::{Arm, Curve, Element, Joint, Link, LinkBody};
/// use nalgebra::Vector3;
///
/// let joint = Joint {
///     bearing: None,
///     extras: Default::default(),
///     bodies: Default::default(),
///     name: "j2".into(),
///     axis: Vector3::y_axis(),
///     curve: Curve::Linear(607e3),
///     mass_kg: 12.2,
///     gear: None,
///     motor: None,
///     coupled: None,
///     stages: Default::default(),
///     turns_with: Vec::new(),
/// };
/// let body = LinkBody::Offset { mass_kg: 5.0 };
/// let link = Link { name: "upper_arm".into(), vector_m: Vector3::new(0.8, 0.0, 0.0), body, bodies: Vec::new() };
/// let chain = vec![Element::Joint(joint), Element::Link(link)];
/// let down = -Vector3::z();
/// let (effects, springs) = (Vec::new(), Vec::new());
/// let arm = Arm { name: "two pieces".into(), gravity_m_s2: 9.81, down, chain, effects, springs };
/// assert_eq!(arm.mass_kg(), 17.2);
/// assert_eq!(arm.reach_m(), 0.8);
/// assert_eq!(arm.to_json()["chain"][0]["stiffness_nm_per_rad"], 607e3);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Arm {
    /// Name of the arm.
    pub name: String,
    /// Gravitational acceleration \[m/s²\].
    pub gravity_m_s2: f64,
    /// Direction of gravity in the world, a unit vector: -z for an arm that stands upright.
    pub down: Vector3<f64>,
    /// Joints and links, base to tip.
    pub chain: Vec<Element>,
    /// Effects beyond the nominal model.
    pub effects: Vec<Effect>,
    /// Springs that balance the arm.
    pub springs: Vec<Spring>,
}

/// One element of the chain.
#[derive(Debug, Clone, PartialEq)]
pub enum Element {
    /// A revolute joint.
    Joint(Joint),
    /// A prismatic joint.
    Prismatic(Prismatic),
    /// A link, elastic or a rigid offset.
    Link(Link),
}

/// A revolute joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Name, unique in the arm.
    pub name: String,
    /// Direction of the axis, in the carried frame.
    pub axis: Unit<Vector3<f64>>,
    /// Torsion curve of the gear about the axis.
    pub curve: Curve,
    /// Mass of gear and motor \[kg\]. It is a point on the axis, inboard of the torsion spring.
    pub mass_kg: f64,
    /// Output bearing. `None`: the joint does not tilt and has no separate bearing mass.
    pub bearing: Option<Bearing>,
    /// Masses of the joint other than gear, motor and bearing.
    pub extras: Extras,
    /// Rigid bodies on the joint, in addition to gear, motor, bearing and extras.
    pub bodies: JointBodies,
    /// Name of the gear, for information only; `None` if the file names none. The calculation uses the numbers of the
    /// other fields.
    pub gear: Option<String>,
    /// Name of the motor, for information only; `None` if the file names none.
    pub motor: Option<String>,
    /// Driving joints of a passive joint, each with its factor: the angle is the sum of factors times the angles of
    /// these joints. `None` for a driven joint.
    pub coupled: Option<Vec<(String, f64)>>,
    /// Stages between motor, gear and joint, for information only. The curve includes their compliance, and their
    /// masses are among the bodies of the elements.
    pub stages: Stages,
    /// The joints inboard of this driven joint that turn it while its own motor stands still, because this motor sits
    /// inboard of them. Each has a factor: the turns of this joint per turn of that joint. A pose states the actual
    /// angle of this joint, whatever the others do.
    pub turns_with: Vec<(String, f64)>,
}

/// A link: a tube or bar, or a rigid offset.
#[derive(Debug, Clone, PartialEq)]
pub struct Link {
    /// Name, unique in the arm.
    pub name: String,
    /// Vector from the root of the link to its end \[m\], in the carried frame.
    pub vector_m: Vector3<f64>,
    /// Whether the link is a tube or a rigid offset, with its properties.
    pub body: LinkBody,
    /// Rigid bodies on the link.
    pub bodies: Vec<RigidBody>,
}

/// What a link consists of: a tube or bar of constant section, or a rigid offset.
#[derive(Debug, Clone, PartialEq)]
pub enum LinkBody {
    /// A straight tube or bar of constant section.
    Tube {
        /// Name of the material.
        material_name: String,
        /// Elastic properties and density of the material.
        material: LinkMaterial,
        /// Cross-section.
        section: Section,
    },
    /// A rigid connection without a section.
    Offset {
        /// Point mass at mid-length \[kg\].
        mass_kg: f64,
    },
}

impl Element {
    /// Name of the element.
    pub fn name(&self) -> &str {
        match self {
            Element::Joint(joint) => &joint.name,
            Element::Prismatic(joint) => &joint.name,
            Element::Link(link) => &link.name,
        }
    }
}

/// Gravity of an arm, a study or an imported robot that states none \[m/s²\].
pub(crate) const GRAVITY_M_S2: f64 = 9.81;

/// Largest number of joints and links of an arm. The time for modes grows with the third power of this number; an arm
/// of 2000 elements takes seconds.
pub(crate) const MOST_ELEMENTS: usize = 2_000;

impl Arm {
    /// The rotary joints from base to tip.
    pub fn joints(&self) -> impl Iterator<Item = &Joint> {
        self.chain.iter().filter_map(|e| match e {
            Element::Joint(joint) => Some(joint),
            _ => None,
        })
    }

    /// The links and offsets from base to tip.
    pub fn links(&self) -> impl Iterator<Item = &Link> {
        self.chain.iter().filter_map(|e| match e {
            Element::Link(link) => Some(link),
            _ => None,
        })
    }

    /// The prismatic joints from base to tip.
    pub fn prismatics(&self) -> impl Iterator<Item = &Prismatic> {
        self.chain.iter().filter_map(|e| match e {
            Element::Prismatic(joint) => Some(joint),
            _ => None,
        })
    }

    /// Names of the driven joints, base to tip. A pose has one entry for each of them; passive joints have none.
    pub fn driven_joint_names(&self) -> Vec<&str> {
        let is_driven = |e: &&Element| match e {
            Element::Joint(joint) => joint.coupled.is_none(),
            Element::Prismatic(_) => true,
            Element::Link(_) => false,
        };
        self.chain.iter().filter(is_driven).map(Element::name).collect()
    }

    /// The driven joints, base to tip, with the kind of motion of each.
    pub fn driven_joints(&self) -> Vec<DrivenJoint> {
        let driven = |e: &Element| match e {
            Element::Joint(joint) if joint.coupled.is_none() => Some(DrivenJoint::turning(&joint.name)),
            Element::Prismatic(joint) => {
                Some(DrivenJoint { name: joint.name.clone(), motion: Motion::Slides })
            }
            _ => None,
        };
        self.chain.iter().filter_map(driven).collect()
    }

    /// Mass of all elements \[kg\], without the masses that effects add.
    pub fn mass_kg(&self) -> f64 {
        self.chain.iter().map(Element::mass_kg).sum()
    }

    /// Names of the elements with a body whose inertia no solid can have: its largest principal moment exceeds the
    /// sum of the other two.
    pub fn impossible_bodies(&self) -> Vec<&str> {
        let is_impossible = |element: &&Element| match element {
            Element::Joint(joint) => joint.bodies.iter().any(RigidBody::is_impossible),
            Element::Prismatic(joint) => joint.bodies.iter().any(RigidBody::is_impossible),
            Element::Link(link) => link.bodies.iter().any(RigidBody::is_impossible),
        };
        self.chain.iter().filter(is_impossible).map(Element::name).collect()
    }

    /// A fault if gravity does not act along world -z, else `None`. Comparison with measurements supports upright
    /// arms only. `file` is the name of the arm's file.
    pub(crate) fn tilt_fault(&self, file: &str) -> Option<Fault> {
        (self.down != -Vector3::z()).then(|| Fault {
            file: file.into(),
            line: None,
            field: "gravity_m_s2".into(),
            problem: "is a vector, and readings are compared with arms that stand upright alone".into(),
            hint: "write the arm in a world whose z axis is up, with a number for gravity; `analyze` and studies take vectors"
                .into(),
        })
    }

    /// A fault if the arm has springs, else `None`. The model of absolute positions does not include springs. `file`
    /// is the name of the arm's file.
    pub(crate) fn springs_fault(&self, file: &str) -> Option<Fault> {
        (!self.springs.is_empty()).then(|| Fault {
            file: file.into(),
            line: None,
            field: "springs".into(),
            problem: "stand in an arm whose absolute positions are measured, and the model of positions has no springs".into(),
            hint: "campaigns of static, modal and windup readings take springs; for positions state what the springs leave \
                   over as the effect joint_torque"
                .into(),
        })
    }

    /// A fault if the motor of some joint sits inboard of other joints, else `None`. The model of absolute positions
    /// does not include how such a joint turns with the others. `file` is the name of the arm's file.
    pub(crate) fn turns_with_fault(&self, file: &str) -> Option<Fault> {
        let joint = self.joints().find(|joint| !joint.turns_with.is_empty())?;
        Some(Fault {
            file: file.into(),
            line: None,
            field: "chain".into(),
            problem: format!(
                "has a motor beyond other joints, that of \"{}\", in an arm whose absolute positions are measured, and the model \
                 of positions does not know how the joint turns with them",
                joint.name
            ),
            hint: "campaigns of static, modal and windup readings take such motors".into(),
        })
    }

    /// The first property of the arm that the model of absolute positions does not include, in words; `None` if the
    /// model includes all of them.
    pub(crate) fn beyond_positions(&self) -> Option<&'static str> {
        if self.prismatics().next().is_some() {
            return Some("prismatic joints");
        }
        if !self.springs.is_empty() {
            return Some("springs");
        }
        self.joints().any(|joint| !joint.turns_with.is_empty()).then_some("joints that turn with others")
    }

    /// Reach \[m\]: the sum of the lengths of the links outboard of the first joint whose axis is not vertical. The
    /// links inboard of this joint form a column and are left out. If all joints of an arm are vertical or prismatic,
    /// the reach is the length outboard of the first joint. Travels of prismatic joints are left out.
    pub fn reach_m(&self) -> f64 {
        let is_joint = |element: &Element| !matches!(element, Element::Link(_));
        let leans = |element: &Element| matches!(element, Element::Joint(j) if j.axis.xy().norm() > 1e-9);
        let first = self.chain.iter().position(leans).or_else(|| self.chain.iter().position(is_joint));
        let length = |element: &Element| match element {
            Element::Link(link) => link.vector_m.norm(),
            Element::Joint(_) | Element::Prismatic(_) => 0.0,
        };
        self.chain.iter().skip(first.unwrap_or(0)).map(length).sum()
    }
}

impl Joint {
    /// Mass of gear, motor, bearing and extras \[kg\]. It is a point mass on the axis.
    pub fn total_mass_kg(&self) -> f64 {
        self.mass_kg + self.bearing.map_or(0.0, |bearing| bearing.mass_kg) + self.extras.total_kg()
    }
}

impl Element {
    /// Mass of the element with its bodies \[kg\].
    pub fn mass_kg(&self) -> f64 {
        match self {
            Element::Joint(joint) => joint.total_mass_kg() + joint.bodies.mass_kg(),
            Element::Prismatic(joint) => joint.total_mass_kg(),
            Element::Link(link) => {
                body::total_kg(&link.bodies)
                    + match &link.body {
                        LinkBody::Tube { material, section, .. } => {
                            material.density_kg_m3
                                * section.properties(material.poisson).area_m2
                                * link.vector_m.norm()
                        }
                        LinkBody::Offset { mass_kg } => *mass_kg,
                    }
            }
        }
    }
}
