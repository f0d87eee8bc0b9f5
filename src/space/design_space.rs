//! What there is to choose: the arm with its open links and drives, and what it is asked to do.

use super::constraint::Constraints;
use crate::arm::effect::entry::Effect;
use crate::arm::joint_law::Curve;
use crate::arm::load::Payload;
use crate::arm::load::Water;
use crate::arm::section::{LinkMaterial, Section};
use crate::arm::structure::Beam;
use crate::arm::{JointModel, Link, LinkModel};
use crate::sizing::requirement::MotionRequirement;
use crate::sizing::select::DriveFilter;
use nalgebra::{Unit, Vector3};

/// An arm with choices, and the cases it is judged in.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignSpace {
    /// Name of the arm.
    pub name: String,
    /// Gravity \[m/s²\].
    pub gravity_m_s2: f64,
    /// Joints and links from base to tip.
    pub pieces: Vec<SpacePiece>,
    /// Every case in which the arm is judged or sized.
    pub cases: Vec<Case>,
    /// Indices of the cases that objectives are taken over, the worst of them.
    pub judged_cases: Vec<usize>,
    /// Indices of the cases in which joints are sized and stress is checked.
    pub sizing_cases: Vec<usize>,
    /// What the tip must do.
    pub motion: MotionRequirement,
    /// Physics of the links.
    pub links: LinkModel,
    /// Physics of the joints.
    pub joints: JointModel,
    /// What every design must meet.
    pub constraints: Constraints,
    /// Physics beyond the nominal model; effects that describe a test are left out of every calculation.
    pub effects: Vec<Effect>,
}

/// One case of a study: a pose, a load, and what is around the arm.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Name.
    pub name: String,
    /// One angle per joint, base to tip \[deg\].
    pub pose_deg: Vec<f64>,
    /// What the arm holds.
    pub payload: Payload,
    /// Force at the tip, world \[N\].
    pub tip_force_n: Vector3<f64>,
    /// The water the arm is in.
    pub water: Option<Water>,
}

/// One piece of the chain.
#[derive(Debug, Clone, PartialEq)]
pub enum SpacePiece {
    /// A joint.
    Joint(SpaceJoint),
    /// A link or offset without a choice.
    Link(Link),
    /// A link whose material and section are chosen.
    Choice(LinkChoice),
}

/// A joint and how its drive is found.
#[derive(Debug, Clone, PartialEq)]
pub struct SpaceJoint {
    /// Name.
    pub name: String,
    /// Axis in the carried frame.
    pub axis: Unit<Vector3<f64>>,
    /// How its drive is found.
    pub drive: DriveChoice,
    /// Largest speed asked for, if the study gives one \[rad/s\].
    pub max_speed_rad_s: Option<f64>,
}

/// How a joint's drive is found.
#[derive(Debug, Clone, PartialEq)]
pub enum DriveChoice {
    /// Given: numbers, with the part names if they are a catalog's.
    Given {
        /// Torsion curve.
        curve: Curve,
        /// Mass \[kg\].
        mass_kg: f64,
        /// Gear by name.
        gear: Option<String>,
        /// Motor by name.
        motor: Option<String>,
    },
    /// The lightest drive of the catalogs that holds (the paper's way).
    FirstFit(DriveFilter),
    /// Every drive of the catalogs that holds.
    AllFits(DriveFilter),
}

/// A link whose material and section are chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkChoice {
    /// Name.
    pub name: String,
    /// From root to end \[m\].
    pub vector_m: Vector3<f64>,
    /// What it can be made of.
    pub options: Vec<LinkOption>,
    /// Where the options stand in the whole list, if this is only a part of it.
    pub excerpt: Option<Excerpt>,
}

/// Part of a list of options.
#[derive(Debug, Clone, PartialEq)]
pub struct Excerpt {
    /// Place of each option in the whole list, ascending.
    pub places: Vec<u32>,
    /// Options in the whole list.
    pub of: u32,
}

/// One material and section.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkOption {
    /// Number of the material in the study: the same on every link.
    pub material_index: usize,
    /// Name of the material.
    pub material_name: String,
    /// Its elastic properties.
    pub material: LinkMaterial,
    /// Cross-section.
    pub section: Section,
    /// Designation, if the section is a catalog profile.
    pub profile: Option<String>,
    /// Strength of the material \[Pa\].
    pub strength_pa: Option<f64>,
    /// Cost of the material \[EUR/kg\].
    pub cost_eur_per_kg: Option<f64>,
}

impl DriveChoice {
    /// Whether the drive is a choice of the search.
    pub fn is_open(&self) -> bool {
        matches!(self, DriveChoice::AllFits(_))
    }
}

impl LinkOption {
    /// The tube as mechanics sees it, as it is built.
    pub fn beam(&self) -> Beam {
        Beam { material: self.material, section: self.section, flexibility: 1.0 }
    }

    /// A tube that is given: no choice, no strength, no cost.
    pub(crate) fn given(material: LinkMaterial, section: Section) -> Self {
        Self {
            material_index: 0,
            material_name: String::new(),
            material,
            section,
            profile: None,
            strength_pa: None,
            cost_eur_per_kg: None,
        }
    }

    /// Mass per length \[kg/m\].
    pub fn mass_kg_per_m(&self) -> f64 {
        self.material.density_kg_m3 * self.section.properties(self.material.poisson).area_m2
    }

    /// Flat width (or diameter) over wall thickness.
    pub fn wall_slenderness(&self) -> f64 {
        let (width, height) = self.section.outer_m();
        let wall = self.section.wall_m();
        match self.section {
            Section::RectangularTube { .. } => (width.max(height) - 2.0 * wall) / wall,
            Section::RoundTube { .. } => width / wall,
        }
    }
}

impl DesignSpace {
    /// Options of all links, together.
    pub fn link_options(&self) -> usize {
        let options = |piece: &SpacePiece| match piece {
            SpacePiece::Choice(choice) => choice.options.len(),
            _ => 0,
        };
        self.pieces.iter().map(options).sum()
    }

    /// Names of the materials that links can be made of, in the study's order.
    pub fn material_names(&self) -> Vec<String> {
        let mut names: Vec<(usize, &str)> = self
            .pieces
            .iter()
            .filter_map(|p| match p {
                SpacePiece::Choice(choice) => Some(&choice.options),
                _ => None,
            })
            .flatten()
            .map(|o| (o.material_index, o.material_name.as_str()))
            .collect();
        names.sort_unstable();
        names.dedup();
        names.into_iter().map(|(_, name)| name.to_string()).collect()
    }
}
