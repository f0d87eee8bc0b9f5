//! The arm of the paper's Table 1, stretched along +x, in the form that the library uses.
//!
//! Joint 2 is at x = 0, joint 3 at 0.8 m, the wrist (joints 4 to 6 at one point) at 1.3 m, and the load 0.05 m
//! beyond the wrist. Only joints 2, 3 and 4 move in the vertical plane; the paper's joint 4 is the wrist pitch.
//! Everything in this file is an input: either a number of the paper or a stated interpretation of it. All results
//! are computed from these inputs.

use crate::arm::joint_law::Curve;
use crate::arm::load::Payload;
use crate::arm::section::{LinkMaterial, Section};
use crate::arm::structure::{Piece, Structure};
use crate::arm::{Arm, Element, Joint, JointModel, Link, LinkBody, LinkModel};
use crate::mechanics::chain::{Chain, Posed};
use crate::mechanics::statics::Statics;
use nalgebra::{Unit, Vector3};

/// Gravitational acceleration that the paper uses \[m/s²\].
pub const GRAVITY_M_S2: f64 = 9.81;
/// Names of the joints that move in the vertical plane, base to tip.
pub const JOINTS: [&str; 3] = ["j2", "j3", "j4"];
/// Names of the links, base to tip.
pub const LINKS: [&str; 2] = ["link1", "link2"];

/// Steel with the properties for which the paper's numbers come out: E = 2.1e11 Pa, 7850 kg/m³, G = E/2.6.
pub const STEEL: LinkMaterial = LinkMaterial {
    youngs_modulus_pa: 2.1e11,
    shear_modulus_pa: 2.1e11 / 2.6,
    density_kg_m3: 7850.0,
    poisson: 0.3,
    strength: None,
    class: None,
};

/// The arm of the paper's Table 1, or a variant that the table may mean.
#[derive(Debug, Clone, PartialEq)]
pub struct PaperArm {
    /// Torsion curves of joints 2, 3 and 4.
    pub curves: [Curve; 3],
    /// Lengths of links 1 and 2 \[m\].
    pub lengths_m: [f64; 2],
    /// Cross-sections of links 1 and 2.
    pub sections: [Section; 2],
    /// Material of both links.
    pub material: LinkMaterial,
    /// Mass of joint 3 \[kg\].
    pub joint_3_kg: f64,
    /// Mass of joints 4, 5 and 6, at the wrist \[kg\].
    pub wrist_kg: f64,
    /// Mass of the load \[kg\].
    pub load_kg: f64,
    /// Distance from the wrist to the load \[m\].
    pub third_link_m: f64,
}

/// Statics and modes of an arm, computed by the library.
#[derive(Debug, Clone, PartialEq)]
pub struct Solved {
    /// Displacements and torques under static load, and the part of the displacement that each element causes.
    pub statics: Statics,
    /// Natural frequencies in the vertical plane, lowest first \[Hz\].
    pub in_plane_hz: Vec<f64>,
}

impl PaperArm {
    /// The arm of Table 1 as printed, with the load 5 cm from the wrist.
    pub fn table_1() -> Self {
        let square =
            |size_m: f64| Section::RectangularTube { width_m: size_m, height_m: size_m, wall_m: 0.01 };
        Self {
            curves: [607e3, 405e3, 108e3].map(Curve::Linear),
            lengths_m: [0.8, 0.5],
            sections: [square(0.16), square(0.12)],
            material: STEEL,
            joint_3_kg: 5.0 + 3.2,
            wrist_kg: (2.0 + 0.9) + (2.0 + 0.9) + (2.0 + 0.98),
            load_kg: 5.0,
            third_link_m: 0.05,
        }
    }

    /// This arm with the stiffness of each of joints 2, 3 and 4 multiplied by its entry in `factors`. A joint with a
    /// torsion curve keeps its curve.
    pub fn with_stiffness_factors(&self, factors: [f64; 3]) -> Self {
        let mut arm = self.clone();
        for (curve, factor) in arm.curves.iter_mut().zip(factors) {
            if let Curve::Linear(stiffness) = curve {
                *stiffness *= factor;
            }
        }
        arm
    }

    /// Mass of a link \[kg\].
    pub fn link_kg(&self, link: usize) -> f64 {
        self.line_kg_per_m(link) * self.lengths_m[link]
    }

    /// Mass per length of a link \[kg/m\]: the weight per length q of Eq 6, divided by g.
    pub fn line_kg_per_m(&self, link: usize) -> f64 {
        self.material.density_kg_m3 * self.sections[link].properties(self.material.poisson).area_m2
    }

    /// Second moment of area of a link \[m⁴\] (Eq 5).
    pub fn second_moment_m4(&self, link: usize) -> f64 {
        self.sections[link].properties(self.material.poisson).second_moment_y_m4
    }

    /// The arm as an arm file would describe it.
    pub fn arm(&self) -> Arm {
        let chain = vec![
            self.joint(0, 0.0),
            self.link(0),
            self.joint(1, self.joint_3_kg),
            self.link(1),
            self.joint(2, self.wrist_kg),
            Element::Link(Link {
                name: "tool".into(),
                vector_m: Vector3::x() * self.third_link_m,
                body: LinkBody::Offset { mass_kg: 0.0 },
                bodies: Vec::new(),
            }),
        ];
        Arm {
            name: "paper-arm".into(),
            gravity_m_s2: GRAVITY_M_S2,
            down: -Vector3::z(),
            chain,
            effects: Vec::new(),
            springs: Vec::new(),
        }
    }

    fn joint(&self, index: usize, mass_kg: f64) -> Element {
        Element::Joint(Joint {
            bearing: None,
            extras: Default::default(),
            bodies: Default::default(),
            name: JOINTS[index].into(),
            axis: Unit::new_unchecked(Vector3::y()),
            curve: self.curves[index],
            mass_kg,
            gear: None,
            motor: None,
            coupled: None,
            stages: Default::default(),
            turns_with: Vec::new(),
        })
    }

    fn link(&self, index: usize) -> Element {
        Element::Link(Link {
            name: LINKS[index].into(),
            vector_m: Vector3::x() * self.lengths_m[index],
            body: LinkBody::Tube {
                material_name: "steel".into(),
                material: self.material,
                section: self.sections[index],
            },
            bodies: Vec::new(),
        })
    }

    /// The load, a point mass at the tip.
    pub fn payload(&self) -> Payload {
        Payload { mass_kg: self.load_kg, ..Payload::default() }
    }

    /// Statics of the stretched arm under its load, and its modes in the vertical plane. `links` is the link model,
    /// which tells which deformations of the links are included.
    pub fn solve(&self, links: LinkModel) -> Solved {
        self.solve_changed(links, |_| {})
    }

    /// Statics and modes in the vertical plane after `change` has altered the structure (the arm as the mechanics sees
    /// it). A change may be a connection in series with a joint, or a stiffer link.
    pub fn solve_changed(&self, links: LinkModel, change: impl FnOnce(&mut Structure)) -> Solved {
        let mut structure = self.arm().structure(JointModel::ThreeSegment);
        change(&mut structure);
        self.with_posed(&structure, links, |posed| {
            let statics = posed.statics();
            let modes = posed.modes(&statics, usize::MAX);
            let in_plane_hz =
                modes.iter().filter(|m| m.plane == Some("xz")).map(|m| m.frequency_hz).collect();
            Solved { statics, in_plane_hz }
        })
    }

    /// Puts the arm `structure` into the stretched pose and calls `use_it` with the posed arm.
    pub fn with_posed<T>(
        &self,
        structure: &Structure,
        links: LinkModel,
        use_it: impl FnOnce(&Posed) -> T,
    ) -> T {
        let chain = Chain::new(structure, links);
        use_it(&chain.pose_rad(&[0.0; 3], &self.payload(), Vector3::zeros()))
    }
}

impl Solved {
    /// Downward displacement of the load \[m\].
    pub fn drop_m(&self) -> f64 {
        -self.statics.tip_displacement_m.z
    }

    /// Part of the load's downward displacement \[m\] that the element with this name (a joint or a link) causes.
    pub fn share_m(&self, name: &str) -> f64 {
        self.statics.shares_m.iter().filter(|(n, _)| n == name).map(|(_, s)| -s.z).sum()
    }

    /// Part of the load's downward displacement that the joints cause \[m\].
    pub fn joints_m(&self) -> f64 {
        JOINTS.iter().map(|name| self.share_m(name)).sum()
    }

    /// Part of the load's downward displacement that the links cause \[m\].
    pub fn links_m(&self) -> f64 {
        LINKS.iter().map(|name| self.share_m(name)).sum()
    }

    /// Static torque on a joint \[N m\] (Eq 7).
    pub fn torque_nm(&self, name: &str) -> f64 {
        self.statics.joint_torques_nm.iter().filter(|(n, _)| n == name).map(|(_, t)| *t).sum()
    }

    /// The lowest frequency in the vertical plane \[Hz\]; infinite if the arm is rigid.
    pub fn lowest_hz(&self) -> f64 {
        self.in_plane_hz.first().copied().unwrap_or(f64::INFINITY)
    }
}

/// Adds a connection in series with the joint of this name. `compliance_rad_per_nm` is the compliance of the
/// connection.
pub fn connect(structure: &mut Structure, joint: &str, compliance_rad_per_nm: f64) {
    for piece in &mut structure.pieces {
        if let Piece::Joint(piece) = piece
            && piece.name == joint
        {
            piece.law.connection_rad_per_nm += compliance_rad_per_nm;
        }
    }
}

/// Multiplies every stiffness of the link with this name by `factor`. The mass of the link stays the same.
pub fn stiffen_link(structure: &mut Structure, link: &str, factor: f64) {
    for piece in &mut structure.pieces {
        if let Piece::Link(piece) = piece
            && piece.name == link
            && let Some(beam) = &mut piece.beam
        {
            beam.flexibility /= factor;
        }
    }
}
