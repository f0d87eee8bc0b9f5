//! Structures: the arm as the mechanics needs it. Effects are applied to its pieces, and names of catalog parts are
//! left out.

use super::base_lift::BaseLift;
use super::body::{JointBodies, RigidBody, total_kg};
use super::joint_law::JointLaw;
use super::joint_torque::JointTorque;
use super::load::{LoadCase, Water};
use super::pose::{DrivenJoint, Motion};
use super::prismatic::PrismaticPiece;
use super::section::{LinkMaterial, Section};
use super::springs::Spring;
use super::{Arm, Element, Joint, JointModel, Link, LinkBody};
use nalgebra::{Matrix3, SymmetricEigen, Unit, Vector3};

/// Everything that the mechanics needs to know about an arm.
#[derive(Debug, Clone, PartialEq)]
pub struct Structure {
    /// Gravitational acceleration \[m/s²\].
    pub gravity_m_s2: f64,
    /// Direction of gravity in the world, a unit vector.
    pub down: Vector3<f64>,
    /// Compliance of the base: tilt about world x and world y per moment \[rad/(N m)\]; 0 means rigid.
    pub base_tilt_rad_per_nm: f64,
    /// Feet of the base that can lift off; `None` if they cannot.
    pub base_lift: Option<BaseLift>,
    /// Further rotational compliance of the ground on which the arm stands, about the origin of the chain.
    pub base_frame: FrameCompliance,
    /// The water in which the arm is; `None` in air.
    pub water: Option<Water>,
    /// Joints and links from base to tip.
    pub pieces: Vec<Piece>,
    /// Springs that balance the arm. They refer to elements by the index of the piece.
    pub springs: Vec<Spring>,
}

/// Rotational compliance of a frame \[rad/(N m)\]: rotation per moment, as a symmetric matrix over three axes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FrameCompliance(pub Matrix3<f64>);

impl FrameCompliance {
    /// This compliance as rotational springs in series about its principal axes. Each item is an axis in the frame and
    /// the compliance about it \[rad/(N m)\]. Axes without compliance are left out.
    pub fn springs(&self) -> Vec<(Vector3<f64>, f64)> {
        if self.0 == Matrix3::zeros() {
            return Vec::new();
        }
        let eigen = SymmetricEigen::new(self.0);
        let least = 1e-12 * eigen.eigenvalues.max();
        let springs = eigen.eigenvectors.column_iter().zip(eigen.eigenvalues.iter());
        springs.filter(|(_, c)| **c > least).map(|(axis, c)| (axis.into_owned(), *c)).collect()
    }
}

/// One piece of the chain.
#[derive(Debug, Clone, PartialEq)]
pub enum Piece {
    /// A revolute joint.
    Joint(JointPiece),
    /// A prismatic joint.
    Prismatic(PrismaticPiece),
    /// A link or a rigid offset.
    Link(LinkPiece),
}

impl Piece {
    /// Name of the piece.
    pub fn name(&self) -> &str {
        match self {
            Piece::Joint(joint) => &joint.name,
            Piece::Prismatic(joint) => &joint.name,
            Piece::Link(link) => &link.name,
        }
    }
}

/// A revolute joint as the mechanics needs it.
#[derive(Debug, Clone, PartialEq)]
pub struct JointPiece {
    /// Name of the joint.
    pub name: String,
    /// Axis in the carried frame, which turns with the joints inboard.
    pub axis: Unit<Vector3<f64>>,
    /// Angle of torsion about the axis as a function of torque.
    pub law: JointLaw,
    /// Torque on the joint in addition to weight and load.
    pub torque: JointTorque,
    /// Tilting compliance about each axis perpendicular to the joint's axis \[rad/(N m)\]: the nominal bearing in
    /// series with the springs that effects add.
    pub tilt_rad_per_nm: f64,
    /// Further tilting compliance about each of two axes \[rad/(N m)\]. Both axes are perpendicular to the joint's axis
    /// and stand still in the housing. The first axis is the cross product of the joint's axis and the coordinate axis
    /// that is least parallel to it. The second axis is the cross product of the joint's axis and the first axis.
    pub lean_rad_per_nm: [f64; 2],
    /// Point mass on the axis, inboard of the springs \[kg\].
    pub mass_kg: f64,
    /// Rigid bodies on the joint.
    pub bodies: JointBodies,
    /// How the angle of the joint follows from the pose.
    pub angle: JointAngle,
    /// The joints inboard of this joint that turn it while its own motor stands still. Each has a factor: the turns of
    /// this joint per turn of that joint.
    pub turns_with: Vec<(String, f64)>,
}

impl JointPiece {
    /// Whether the angle of the joint is an entry of the pose.
    pub fn is_driven(&self) -> bool {
        matches!(self.angle, JointAngle::Driven(_))
    }

    /// Whether the joint tilts about an axis perpendicular to its own.
    pub fn tilts(&self) -> bool {
        self.tilt_rad_per_nm > 0.0 || self.lean_rad_per_nm.iter().any(|c| *c > 0.0)
    }
}

/// How the angle of a joint follows from the pose.
#[derive(Debug, Clone, PartialEq)]
pub enum JointAngle {
    /// The angle is the entry of the pose with this index.
    Driven(usize),
    /// The angle is a sum of factors times entries of the pose. Each item is the index of the entry and its factor.
    Coupled(Vec<(usize, f64)>),
}

impl JointAngle {
    /// The angle of the joint in a pose, in the unit of the pose.
    pub fn of(&self, pose: &[f64]) -> f64 {
        match self {
            JointAngle::Driven(index) => pose[*index],
            JointAngle::Coupled(terms) => terms.iter().map(|(index, factor)| factor * pose[*index]).sum(),
        }
    }
}

/// A link or a rigid offset as the mechanics needs it.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkPiece {
    /// Name of the link.
    pub name: String,
    /// Vector from root to end in the carried frame \[m\].
    pub vector_m: Vector3<f64>,
    /// The tube, or `None` for a rigid offset.
    pub beam: Option<Beam>,
    /// Point mass at mid-length \[kg\].
    pub point_mass_kg: f64,
    /// Rigid bodies on the link.
    pub bodies: Vec<RigidBody>,
    /// Mass of cables and hoses along the link, per length \[kg/m\].
    pub harness_kg_per_m: f64,
    /// Rotational compliance of the structure between the link and the joint inboard of it. It acts at the root of the
    /// link, in axes of the carried frame.
    pub root_frame: FrameCompliance,
}

impl LinkPiece {
    /// Mass of the tube per length \[kg/m\]; zero if there is no tube.
    pub fn tube_kg_per_m(&self) -> f64 {
        self.beam.map_or(0.0, |beam| {
            beam.material.density_kg_m3 * beam.section.properties(beam.material.poisson).area_m2
        })
    }

    /// Mass of tube, cables, point mass and bodies \[kg\].
    pub fn mass_kg(&self) -> f64 {
        self.point_mass_kg
            + total_kg(&self.bodies)
            + self.vector_m.norm() * (self.tube_kg_per_m() + self.harness_kg_per_m)
    }
}

/// A straight tube of constant section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beam {
    /// Elastic properties and density of the material.
    pub material: LinkMaterial,
    /// Cross-section.
    pub section: Section,
    /// Factor on every compliance of the tube: 1 for the tube as it is, 0 for a rigid link.
    pub flexibility: f64,
}

impl Arm {
    /// The structure of the arm, with the effects of the product applied, for a calculation with the joint model
    /// `joints`. Effects that describe a test are left out ([`Arm::ignored_effects`] lists them).
    pub fn structure(&self, joints: JointModel) -> Structure {
        self.subject(joints).structure
    }

    /// The structure of the arm in a load case; the case states the joint model. If the case states water, it replaces
    /// the water of an effect.
    pub fn structure_in(&self, case: &LoadCase) -> Structure {
        let mut structure = self.structure(case.joints);
        structure.water = case.water.or(structure.water);
        structure
    }

    /// The structure of the arm without any effect, for a calculation with the joint model `joints`.
    pub fn nominal_structure(&self, joints: JointModel) -> Structure {
        let driven = self.driven_joint_names();
        let entry = |name: &str| driven.iter().position(|d| *d == name).unwrap_or_default();
        let pieces = self
            .chain
            .iter()
            .map(|element| match element {
                Element::Joint(joint) => Piece::Joint(joint_piece(joint, &driven, joints)),
                Element::Prismatic(joint) => Piece::Prismatic(joint.piece(entry(&joint.name))),
                Element::Link(link) => Piece::Link(link_piece(link)),
            })
            .collect();
        Structure {
            down: self.down,
            springs: self.springs.clone(),
            ..Structure::nominal(self.gravity_m_s2, pieces)
        }
    }
}

impl Structure {
    /// Mass of all pieces \[kg\], including the masses that effects add.
    pub fn mass_kg(&self) -> f64 {
        let mass_kg = |piece: &Piece| match piece {
            Piece::Joint(joint) => joint.mass_kg + joint.bodies.mass_kg(),
            Piece::Prismatic(joint) => joint.total_mass_kg(),
            Piece::Link(link) => link.mass_kg(),
        };
        self.pieces.iter().map(mass_kg).sum()
    }

    /// The driven joints in the order of their entries in a pose, with the kind of motion of each.
    pub fn driven_joints(&self) -> Vec<DrivenJoint> {
        let driven = |piece: &Piece| match piece {
            Piece::Joint(JointPiece { angle: JointAngle::Driven(entry), name, .. }) => {
                Some((*entry, DrivenJoint::turning(name)))
            }
            Piece::Prismatic(joint) => {
                Some((joint.entry, DrivenJoint { name: joint.name.clone(), motion: Motion::Slides }))
            }
            _ => None,
        };
        let mut joints: Vec<(usize, DrivenJoint)> = self.pieces.iter().filter_map(driven).collect();
        joints.sort_by_key(|(entry, _)| *entry);
        joints.into_iter().map(|(_, joint)| joint).collect()
    }

    /// A structure that consists of `pieces`, on a rigid base, upright and in air.
    pub(crate) fn nominal(gravity_m_s2: f64, pieces: Vec<Piece>) -> Self {
        Self {
            gravity_m_s2,
            down: -Vector3::z(),
            base_tilt_rad_per_nm: 0.0,
            base_lift: None,
            base_frame: FrameCompliance::default(),
            water: None,
            pieces,
            springs: Vec::new(),
        }
    }
}

/// A joint of the arm file in the form that the mechanics uses, without any effect. `driven` are the names of the
/// driven joints, base to tip; `model` is the joint model.
fn joint_piece(joint: &Joint, driven: &[&str], model: JointModel) -> JointPiece {
    let index = |name: &str| driven.iter().position(|d| *d == name);
    let angle = match &joint.coupled {
        None => JointAngle::Driven(index(&joint.name).unwrap_or_default()),
        Some(terms) => {
            JointAngle::Coupled(terms.iter().filter_map(|(name, f)| Some((index(name)?, *f))).collect())
        }
    };
    JointPiece {
        name: joint.name.clone(),
        axis: joint.axis,
        law: JointLaw::from(joint.curve.reduced(model)),
        torque: JointTorque::default(),
        tilt_rad_per_nm: joint.bearing.map_or(0.0, |bearing| bearing.tilt_rad_per_nm()),
        lean_rad_per_nm: [0.0; 2],
        mass_kg: joint.total_mass_kg(),
        bodies: joint.bodies.clone(),
        angle,
        turns_with: joint.turns_with.clone(),
    }
}

/// A link of the arm file in the form that the mechanics uses, without any effect.
pub(crate) fn link_piece(link: &Link) -> LinkPiece {
    let (beam, point_mass_kg) = match &link.body {
        LinkBody::Tube { material, section, .. } => {
            (Some(Beam { material: *material, section: *section, flexibility: 1.0 }), 0.0)
        }
        LinkBody::Offset { mass_kg } => (None, *mass_kg),
    };
    LinkPiece {
        name: link.name.clone(),
        vector_m: link.vector_m,
        beam,
        point_mass_kg,
        bodies: link.bodies.clone(),
        harness_kg_per_m: 0.0,
        root_frame: FrameCompliance::default(),
    }
}
