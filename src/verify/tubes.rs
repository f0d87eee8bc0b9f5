//! What a link's tubes are in numbers, and the least and the most of each over a set of tubes.

use super::tree::Tree;
use crate::arm::load::Water;
use crate::arm::structure::{LinkPiece, Structure};
use crate::arm::{Link, LinkModel};
use crate::mechanics::beam::{line_densities, line_stiffnesses};
use crate::space::attributes::{OptionAttributes, StressCheck};
use crate::space::design_space::{DesignSpace, LinkChoice};
use crate::space::slot::{Slot, choice_slot, link_slot};

/// Stiffnesses of a tube: `E I` about y and z, `κ G A`, `G J`, `E A`.
pub(super) const STIFFNESSES: usize = 5;
/// Inertias per length: along, across, about the link, about its y, about its z.
pub(super) const DENSITIES: usize = 5;
/// Stress per axial force, moment about y, moment about z and torque, over the strength.
pub(super) const STRESSES: usize = 4;

/// A tube in numbers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TubeNumbers {
    /// Mass \[kg\].
    pub mass_kg: f64,
    /// Stiffnesses; infinite where the model knows no compliance.
    pub stiffnesses: [f64; STIFFNESSES],
    /// Stress per load over the strength; zero if no strength is known.
    pub stresses: [f64; STRESSES],
    /// 1 for a round tube, 0 for a rectangular one.
    pub round: f64,
    /// The rest in each of the study's surroundings.
    pub around: Vec<TubeAround>,
}

/// What a tube is in air or in some water.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TubeAround {
    /// Weight less buoyancy per length \[N/m\].
    pub weight_n_per_m: f64,
    /// Inertias per length.
    pub densities: [f64; DENSITIES],
}

/// The tubes that a link may be.
pub(super) struct TubeOptions {
    pub length_m: f64,
    /// Place among the levels of the space, if there is a choice.
    pub level: Option<usize>,
    /// Each with its number; none that is too slender.
    pub tubes: Vec<(u32, TubeNumbers)>,
}

/// Tubes that a link may be, halved again and again.
pub(super) struct Tubes {
    pub level: Option<usize>,
    pub tree: Tree,
    pub nodes: Vec<TubeRange>,
    /// Number of each option.
    pub numbers: Vec<u32>,
}

/// Least, largest and middling numbers of a set of tubes.
#[derive(Debug, Clone)]
pub(super) struct TubeRange {
    pub least: TubeNumbers,
    pub most: TubeNumbers,
    pub middle: TubeNumbers,
}

impl TubeOptions {
    /// The tubes of a link with a choice.
    pub fn of_choice(
        space: &DesignSpace,
        choice: &LinkChoice,
        level: usize,
        waters: &[Option<Water>],
    ) -> Self {
        let figures = figures(choice_slot(space, choice));
        let sound = (0u32..).zip(choice.options.iter().zip(&figures)).filter(|(_, (_, f))| !f.slender);
        let tubes = sound.map(|(i, (option, figures))| {
            let piece = space.link_piece(&choice.link(option));
            (i, numbers(space, &piece, figures.mass_kg, figures.stress.as_ref(), waters))
        });
        Self { length_m: choice.vector_m.norm(), level: Some(level), tubes: tubes.collect() }
    }

    /// The tube of a link without one; cables along a rigid offset count as a tube that does not yield.
    pub fn of_link(space: &DesignSpace, link: &Link, waters: &[Option<Water>]) -> Self {
        let figures = figures(link_slot(space, link));
        let tube = figures.first();
        let mass_kg = tube.map_or(0.0, |tube| tube.mass_kg);
        let stress = tube.and_then(|tube| tube.stress.as_ref());
        let numbers = numbers(space, &space.link_piece(link), mass_kg, stress, waters);
        let slender = tube.is_some_and(|tube| tube.slender);
        let tubes = if slender { Vec::new() } else { vec![(0, numbers)] };
        Self { length_m: link.vector_m.norm(), level: None, tubes }
    }

    /// Some of the options, ascending.
    pub fn only(&self, some: &[u32]) -> Self {
        Self { tubes: some.iter().map(|&i| self.tubes[i as usize].clone()).collect(), ..*self }
    }

    /// The tree of all options.
    pub fn tree(&self) -> Tree {
        let all = (0..self.tubes.len() as u32).collect();
        Tree::new(all, &self.tubes.iter().map(|(_, tube)| keys(tube)).collect::<Vec<_>>())
    }
}

impl Tubes {
    /// Halves the options.
    pub fn new(options: &TubeOptions) -> Self {
        let tree = options.tree();
        let range = |node| TubeRange::over(tree.options(node).iter().map(|&i| &options.tubes[i as usize].1));
        let nodes = (0..tree.len() as u32).map(range).collect();
        let numbers = options.tubes.iter().map(|(number, _)| *number).collect();
        Self { level: options.level, tree, nodes, numbers }
    }
}

fn figures(slot: Slot) -> Vec<OptionAttributes> {
    match slot {
        Slot::Link { options, .. } => options,
        _ => Vec::new(),
    }
}

/// What tubes are told apart by.
fn keys(tube: &TubeNumbers) -> Vec<f64> {
    let [bending_y, bending_z, _, torsion, _] = tube.stiffnesses.map(f64::ln);
    vec![1.5 * tube.mass_kg.ln(), bending_y, bending_z, 0.3 * torsion]
}

fn numbers(
    space: &DesignSpace,
    piece: &LinkPiece,
    mass_kg: f64,
    stress: Option<&StressCheck>,
    waters: &[Option<Water>],
) -> TubeNumbers {
    TubeNumbers {
        mass_kg,
        stiffnesses: stiffnesses(piece, space.links),
        stresses: stress.map_or([0.0; STRESSES], |s| {
            [s.per_axial_n, s.per_moment_y, s.per_moment_z, s.per_torsion].map(|per| per / s.strength_pa)
        }),
        round: f64::from(u8::from(stress.is_some_and(|s| s.round))),
        around: waters.iter().map(|water| around(space, piece, *water)).collect(),
    }
}

/// Stiffnesses that the model knows; the others are infinite.
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

fn around(space: &DesignSpace, piece: &LinkPiece, water: Option<Water>) -> TubeAround {
    let structure = Structure { water, ..Structure::nominal(space.gravity_m_s2, Vec::new()) };
    let [along, across, _, polar, about_y, about_z] = line_densities(piece, &structure, space.links);
    let outer_m2 = piece.beam.map_or(0.0, |b| b.section.properties(b.material.poisson).outer_area_m2);
    let displaced = water.map_or(0.0, |water| water.density_kg_m3 * outer_m2);
    TubeAround {
        weight_n_per_m: space.gravity_m_s2 * (piece.tube_kg_per_m() + piece.harness_kg_per_m - displaced),
        densities: [along, across, polar, about_y, about_z],
    }
}

impl TubeRange {
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
            around: self.around.iter().zip(&other.around).map(around).collect(),
        }
    }

    fn with_each(&self, change: impl Fn(f64) -> f64) -> Self {
        self.with(self, |a, _| change(a))
    }
}
