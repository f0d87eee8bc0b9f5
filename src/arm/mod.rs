//! What an arm is: an ordered chain of joints and links from base to tip, the loads it carries, and
//! the effects it has beyond its nominal model.
//!
//! World z is up and gravity points along -z. With all joint angles zero every frame on the chain is
//! parallel to the world's; a joint's axis and a link's vector are written in the frame carried by
//! the joints before it.

pub mod effect;
pub(crate) mod file;
pub(crate) mod joint_law;
pub(crate) mod linkage;
pub(crate) mod load;
pub(crate) mod section;
pub(crate) mod structure;
pub(crate) mod write;

pub use effect::entry::Effect;
pub use file::{read_arm, read_arm_document};
pub use joint_law::{Curve, JointLaw, LostMotion, Windup};
pub use linkage::Linkage;
pub use load::{LoadCase, Payload, Water, read_load_cases};
pub use section::{LinkMaterial, Section, SectionProperties};
pub use structure::{Beam, FrameCompliance, JointAngle, JointPiece, LinkPiece, Piece, Structure};

use nalgebra::{Unit, Vector3};

/// Which physics of the links a calculation uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LinkModel {
    /// No compliance; the tube's full mass and inertia.
    Rigid,
    /// Euler-Bernoulli bending in both planes and nothing else (Eqs 1-6).
    Bending,
    /// Bending, shear, torsion, axial stretch and rotary inertia.
    #[default]
    Full,
}

/// Which torsion curve of a gear a calculation uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum JointModel {
    /// The middle slope K2 alone: the paper's single number.
    K2,
    /// The catalog's three-segment curve, where there is one.
    #[default]
    ThreeSegment,
    /// The three-segment curve for what a load bends, its first slope K1 for what vibrates: the lowest
    /// frequencies that a gear with rising slopes can have, whatever its torque.
    ThreeSegmentK1,
}

/// The words of a two-way choice in files and on the command line.
pub trait Words: Sized + Copy + 'static {
    /// Every value with its word.
    const WORDS: &'static [(&'static str, Self)];

    /// The value of a word.
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
#[derive(Debug, Clone, PartialEq)]
pub struct Arm {
    /// Name.
    pub name: String,
    /// Gravitational acceleration \[m/s²\], along world -z.
    pub gravity_m_s2: f64,
    /// Joints and links from base to tip.
    pub chain: Vec<Element>,
    /// Physics beyond the nominal model.
    pub effects: Vec<Effect>,
}

/// One element of the chain.
#[derive(Debug, Clone, PartialEq)]
pub enum Element {
    /// A rotary joint.
    Joint(Joint),
    /// A link or a rigid offset.
    Link(Link),
}

/// A rotary joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Name, unique in the arm.
    pub name: String,
    /// Axis in the carried frame.
    pub axis: Unit<Vector3<f64>>,
    /// Torsion curve about the axis.
    pub curve: Curve,
    /// Mass of the drive \[kg\]: a point on the axis, inboard.
    pub mass_kg: f64,
    /// Gear, as a part name kept beside the numbers.
    pub gear: Option<String>,
    /// Motor, as a part name kept beside the numbers.
    pub motor: Option<String>,
    /// For a passive joint: its angle as a sum of factors times other joints' angles.
    pub coupled: Option<Vec<(String, f64)>>,
}

/// A link: a hollow tube, or a rigid offset.
#[derive(Debug, Clone, PartialEq)]
pub struct Link {
    /// Name, unique in the arm.
    pub name: String,
    /// From the link's root to its end \[m\], in the carried frame.
    pub vector_m: Vector3<f64>,
    /// What the link is made of.
    pub body: LinkBody,
}

/// What a link is made of.
#[derive(Debug, Clone, PartialEq)]
pub enum LinkBody {
    /// A straight tube of constant section.
    Tube {
        /// Name of the material.
        material_name: String,
        /// Its elastic properties.
        material: LinkMaterial,
        /// Its cross-section.
        section: Section,
    },
    /// A rigid connection.
    Offset {
        /// Point mass at mid-length \[kg\].
        mass_kg: f64,
    },
}

impl Element {
    /// The element's name.
    pub fn name(&self) -> &str {
        match self {
            Element::Joint(joint) => &joint.name,
            Element::Link(link) => &link.name,
        }
    }
}

impl Arm {
    /// The joints from base to tip.
    pub fn joints(&self) -> impl Iterator<Item = &Joint> {
        self.chain.iter().filter_map(|e| match e {
            Element::Joint(joint) => Some(joint),
            Element::Link(_) => None,
        })
    }

    /// The links and offsets from base to tip.
    pub fn links(&self) -> impl Iterator<Item = &Link> {
        self.chain.iter().filter_map(|e| match e {
            Element::Link(link) => Some(link),
            Element::Joint(_) => None,
        })
    }

    /// Names of the joints that have an angle of their own (passive joints have none), base to tip.
    pub fn driven_joint_names(&self) -> Vec<&str> {
        self.joints().filter(|j| j.coupled.is_none()).map(|j| j.name.as_str()).collect()
    }

    /// Mass of all links and drives \[kg\].
    pub fn mass_kg(&self) -> f64 {
        self.chain.iter().map(Element::mass_kg).sum()
    }

    /// Length of all links \[m\].
    pub fn length_m(&self) -> f64 {
        let length = |element: &Element| match element {
            Element::Link(link) => link.vector_m.norm(),
            Element::Joint(_) => 0.0,
        };
        self.chain.iter().map(length).sum()
    }
}

impl Element {
    /// Mass of the element \[kg\].
    pub fn mass_kg(&self) -> f64 {
        match self {
            Element::Joint(joint) => joint.mass_kg,
            Element::Link(link) => match &link.body {
                LinkBody::Tube { material, section, .. } => {
                    material.density_kg_m3
                        * section.properties(material.poisson).area_m2
                        * link.vector_m.norm()
                }
                LinkBody::Offset { mass_kg } => *mass_kg,
            },
        }
    }
}
