//! The numbers of a tube that determine mass, torques, deflection, stress and modes, and their ranges over a set of
//! tubes.

use super::carriers::Carrier;
use super::fit::{ANY_WIDTH, Widths, room};
use super::layout::has_line;
use super::question::{AskedLink, AskedTube, Question};
use super::tree::Tree;
use crate::arm::load::Water;
use crate::arm::section::Section;
use crate::arm::structure::{LinkPiece, Structure};
use crate::arm::{Link, LinkBody, LinkModel};
use crate::mechanics::beam::{line_densities, line_stiffnesses, section_frame};
use nalgebra::Vector3;

/// Number of stiffnesses of a tube: `E I` about y and z, `κ G A`, `G J`, `E A`.
pub(super) const STIFFNESSES: usize = 5;
/// Number of inertias per length: for motion along the link and across it, and for rotation about the link's axis
/// and about the y and z axes of its section.
pub(super) const DENSITIES: usize = 5;
/// Number of stress coefficients: stress per axial force, per moment about y, per moment about z and per torque,
/// each divided by the strength.
pub(super) const STRESSES: usize = 4;

/// The numbers of one tube.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TubeNumbers {
    /// Mass of the tube \[kg\].
    pub mass_kg: f64,
    /// Stiffnesses (see [`STIFFNESSES`]); infinite where the link model has no such strain.
    pub stiffnesses: [f64; STIFFNESSES],
    /// Stress divided by the strength, per unit of each internal load, in the order of [`STRESSES`] \[1/N, 1/(N m)\];
    /// zero if the strength is unknown.
    pub stresses: [f64; STRESSES],
    /// 1 for a round section whose strength is known, 0 for any other.
    pub round: f64,
    /// Half the width of the tube along the axis of the joint next to its root \[m\]; zero if it does not start at
    /// a joint.
    pub half_width_m: f64,
    /// The largest widths of gear and motor for which the tube leaves room, if it is the first tube of a joint.
    pub room: Widths,
    /// Weight and inertias of the tube in each of the study's surroundings.
    pub around: Vec<TubeAround>,
}

/// Numbers of a tube that depend on the medium around it, air or water.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TubeAround {
    /// Weight per length, less buoyancy \[N/m\].
    pub weight_n_per_m: f64,
    /// Inertias per length, in the order of [`DENSITIES`].
    pub densities: [f64; DENSITIES],
}

/// The tubes that a link may have, as a list.
pub(super) struct TubeOptions {
    /// Index of the link's choice among the levels (choices) of the space; `None` if the search does not choose the
    /// tube.
    pub level: Option<usize>,
    /// Each tube with its index in the link's list. Tubes whose walls are too slender are left out.
    pub tubes: Vec<(u32, TubeNumbers)>,
}

/// The tubes that a link may have, as a binary tree. Branching halves its nodes down to single tubes.
pub(super) struct Tubes {
    pub level: Option<usize>,
    pub tree: Tree,
    pub nodes: Vec<TubeRange>,
    /// Index of each tube in the list of the link.
    pub numbers: Vec<u32>,
}

/// Least, greatest and mean value of each number over a set of tubes.
#[derive(Debug, Clone)]
pub(super) struct TubeRange {
    pub least: TubeNumbers,
    pub most: TubeNumbers,
    pub middle: TubeNumbers,
}

impl TubeOptions {
    /// The tubes of a link whose tube the search chooses.
    pub(super) fn of_choice(
        question: &Question,
        carrier: Carrier,
        choice: &AskedLink,
        level: usize,
        waters: &[Option<Water>],
    ) -> Self {
        let tubes = (0u32..).zip(&choice.tubes).filter(|(_, tube)| !is_too_slender(question, &tube.section));
        let numbers = |tube| TubeNumbers::of_choice(question, carrier, choice, tube, waters);
        let tubes = tubes.map(|(i, tube)| (i, numbers(tube)));
        Self { level: Some(level), tubes: tubes.collect() }
    }

    /// The tube of a link that the study gives. Cables along a rigid offset count as a rigid tube. `None` if the
    /// link has no weight along its length.
    pub(super) fn of_link(
        question: &Question,
        carrier: Carrier,
        link: &Link,
        waters: &[Option<Water>],
    ) -> Option<Self> {
        let piece = question.link_piece(link.clone());
        has_line(&piece).then(|| {
            let slender = match &link.body {
                LinkBody::Tube { section, .. } => is_too_slender(question, section),
                LinkBody::Offset { .. } => false,
            };
            // Cables do not count in the mass of a design, so a rigid offset with cables has no mass here.
            let mass_kg = piece.beam.map_or(0.0, |_| piece.tube_kg_per_m() * piece.vector_m.norm());
            let numbers = TubeNumbers::new(question, carrier, &piece, mass_kg, waters);
            let tubes = if slender { Vec::new() } else { vec![(0, numbers)] };
            Self { level: None, tubes }
        })
    }

    /// A list of some of the options of this list. `some` has the indices of these options in ascending order.
    pub(super) fn only(&self, some: &[u32]) -> Self {
        Self { tubes: some.iter().map(|&i| self.tubes[i as usize].clone()).collect(), ..*self }
    }

    /// The binary tree over all tubes of this list.
    pub(super) fn tree(&self) -> Tree {
        let all = (0..self.tubes.len() as u32).collect();
        Tree::new(all, &self.tubes.iter().map(|(_, tube)| keys(tube)).collect::<Vec<_>>())
    }
}

impl Tubes {
    /// Builds the tree over the tubes, and computes the least and greatest numbers of each node's tubes.
    pub(super) fn new(options: &TubeOptions) -> Self {
        let tree = options.tree();
        let range = |node| TubeRange::over(tree.options(node).iter().map(|&i| &options.tubes[i as usize].1));
        let nodes = (0..tree.len() as u32).map(range).collect();
        let numbers = options.tubes.iter().map(|(number, _)| *number).collect();
        Self { level: options.level, tree, nodes, numbers }
    }
}

/// Whether the ratio of a tube's width to its wall is larger than the question allows because of buckling.
pub(super) fn is_too_slender(question: &Question, section: &Section) -> bool {
    let (width_m, height_m) = section.outer_m();
    let wall_m = section.wall_m();
    // Catalog sizes often lie exactly on the limit. The quotient is therefore formed exactly as the study format
    // defines it: flat width over wall thickness.
    let slenderness = match section {
        Section::RectangularTube { .. } => (width_m.max(height_m) - 2.0 * wall_m) / wall_m,
        Section::RoundTube { .. } => width_m / wall_m,
        Section::RectangularBar { .. }
        | Section::RoundBar { .. }
        | Section::IBeam { .. }
        | Section::Stated(_) => return false,
    };
    question.limits.wall_slenderness_max.is_some_and(|most| slenderness > most)
}

/// Half the extent of a link along `direction` \[m\]; zero for an offset. The half widths of both sides of the section
/// are projected on the direction, and the root of the sum of their squares is taken.
fn half_width_m(piece: &LinkPiece, direction: &Vector3<f64>) -> f64 {
    let Some(beam) = piece.beam else { return 0.0 };
    let [y, z] = [1, 2].map(|side| section_frame(&piece.vector_m).column(side).dot(direction));
    let (width_m, height_m) = beam.section.outer_m();
    ((width_m * y).powi(2) + (height_m * z).powi(2)).sqrt() / 2.0
}

/// The coordinates of a tube by which the tree puts similar tubes together: logarithms of its mass, both bending
/// stiffnesses and its torsional stiffness. The logarithms of mass and torsional stiffness are multiplied by the
/// factors 1.5 and 0.3.
fn keys(tube: &TubeNumbers) -> Vec<f64> {
    let [bending_y, bending_z, _, torsion, _] = tube.stiffnesses.map(libm::log);
    vec![1.5 * libm::log(tube.mass_kg), bending_y, bending_z, 0.3 * torsion]
}

/// Stress per axial force, moment about y, moment about z and torque, each divided by the strength. The torsion stress
/// is divided by √3 times the strength in shear, because the bound adds three times its square; in an isotropic
/// material this is the strength itself. In a round tube bending and torsion stress both have their maximum on the
/// outside.
fn stresses(tube: &AskedTube) -> [f64; STRESSES] {
    let Some(strength) = tube.material.strength else { return [0.0; STRESSES] };
    let shear_pa = strength.shear_pa.map_or(strength.along_pa, |pa| 3f64.sqrt() * pa);
    let section = tube.section.properties(tube.material.poisson);
    let (width_m, height_m) = tube.section.outer_m();
    let per_load = [
        1.0 / section.area_m2,
        height_m / (2.0 * section.second_moment_y_m4),
        width_m / (2.0 * section.second_moment_z_m4),
        section.torsion_shear_per_m3,
    ];
    let [axial, about_y, about_z, torsion] = per_load;
    let [axial, about_y, about_z] = [axial, about_y, about_z].map(|per| per / strength.along_pa);
    [axial, about_y, about_z, torsion / shear_pa]
}

/// Stiffnesses of a tube, in the order of [`STIFFNESSES`]; infinite where the link model has no such strain.
fn stiffnesses(piece: &LinkPiece, model: LinkModel) -> [f64; STIFFNESSES] {
    let Some(beam) = piece.beam else { return [f64::INFINITY; STIFFNESSES] };
    let known = match model {
        LinkModel::Rigid => 0,
        LinkModel::Bending => 2,
        LinkModel::Full => STIFFNESSES,
    };
    let bare = line_stiffnesses(&beam);
    std::array::from_fn(|i| if i < known { bare[i] / beam.flexibility } else { f64::INFINITY })
}

fn around(question: &Question, piece: &LinkPiece, water: Option<Water>) -> TubeAround {
    let structure = Structure { water, ..Structure::nominal(question.gravity_m_s2, Vec::new()) };
    let [along, across, _, polar, about_y, about_z] = line_densities(piece, &structure, question.links);
    let outer_m2 = piece.beam.map_or(0.0, |b| b.section.properties(b.material.poisson).outer_area_m2);
    let displaced = water.map_or(0.0, |water| water.density_kg_m3 * outer_m2);
    TubeAround {
        weight_n_per_m: question.gravity_m_s2 * (piece.tube_kg_per_m() + piece.harness_kg_per_m - displaced),
        densities: [along, across, polar, about_y, about_z],
    }
}

impl TubeRange {
    /// The range of a single tube.
    pub(super) fn one(tube: &TubeNumbers) -> Self {
        Self { least: tube.clone(), most: tube.clone(), middle: tube.clone() }
    }

    fn over<'t>(tubes: impl Iterator<Item = &'t TubeNumbers> + Clone) -> Self {
        let fold = |combine: fn(f64, f64) -> f64| {
            tubes.clone().cloned().reduce(|a, b| a.with(&b, combine)).expect("a node has options")
        };
        let count = tubes.clone().count() as f64;
        Self {
            least: fold(f64::min),
            most: fold(f64::max),
            middle: fold(|a, b| a + b).with_each(|sum| sum / count),
        }
    }
}

impl TubeNumbers {
    /// Numbers of a tube that a link may have, with its strength.
    pub(super) fn of_choice(
        question: &Question,
        carrier: Carrier,
        choice: &AskedLink,
        tube: &AskedTube,
        waters: &[Option<Water>],
    ) -> Self {
        let kg_per_m = tube.material.density_kg_m3 * tube.section.properties(tube.material.poisson).area_m2;
        let piece = question.link_piece(choice.with_tube(tube));
        let numbers = Self::new(question, carrier, &piece, kg_per_m * choice.vector_m.norm(), waters);
        let is_round = tube.material.strength.is_some() && tube.section.is_round();
        Self { stresses: stresses(tube), round: f64::from(u8::from(is_round)), ..numbers }
    }

    /// Numbers of a tube whose strength is not checked.
    fn new(
        question: &Question,
        carrier: Carrier,
        piece: &LinkPiece,
        mass_kg: f64,
        waters: &[Option<Water>],
    ) -> Self {
        Self {
            mass_kg,
            stiffnesses: stiffnesses(piece, question.links),
            stresses: [0.0; STRESSES],
            round: 0.0,
            half_width_m: carrier.next.map_or(0.0, |joint| half_width_m(piece, &joint.axis)),
            room: match (carrier.of_first_tube, piece.beam) {
                (Some(joint), Some(beam)) => room(joint, &piece.vector_m, &beam.section),
                _ => ANY_WIDTH,
            },
            around: waters.iter().map(|water| around(question, piece, *water)).collect(),
        }
    }

    fn with(&self, other: &Self, combine: impl Fn(f64, f64) -> f64) -> Self {
        let around = |(a, b): (&TubeAround, &TubeAround)| TubeAround {
            weight_n_per_m: combine(a.weight_n_per_m, b.weight_n_per_m),
            densities: std::array::from_fn(|i| combine(a.densities[i], b.densities[i])),
        };
        Self {
            mass_kg: combine(self.mass_kg, other.mass_kg),
            stiffnesses: std::array::from_fn(|i| combine(self.stiffnesses[i], other.stiffnesses[i])),
            stresses: std::array::from_fn(|i| combine(self.stresses[i], other.stresses[i])),
            round: combine(self.round, other.round),
            half_width_m: combine(self.half_width_m, other.half_width_m),
            room: std::array::from_fn(|i| combine(self.room[i], other.room[i])),
            around: self.around.iter().zip(&other.around).map(around).collect(),
        }
    }

    fn with_each(&self, change: impl Fn(f64) -> f64) -> Self {
        self.with(self, |a, _| change(a))
    }
}
