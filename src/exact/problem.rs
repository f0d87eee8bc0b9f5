//! A design space compiled for the bound: a tree of boxes for every level, rows of numbers for every
//! case.

use super::force_bound::ForceBound;
use super::joint_play::JointPlay;
use super::kinds::Kinds;
use super::lowest_eigenvalue::CaseInertia;
use super::parts::{DriveBox, LinkBox, Rays};
use super::pose::Pose;
use super::torsion::CurveBox;
use super::tree::{Bounds, Tree};
use crate::space::design_space::DesignSpace;
use crate::space::slot::SizedJoint;
use std::sync::Arc;

/// A design space as branch and bound sees it. Pieces count from the tip.
#[derive(Clone)]
pub(super) struct Problem<'c> {
    pub space: &'c DesignSpace,
    pub parts: Vec<Part<'c>>,
    /// The piece of each level, tip first.
    pub level_pieces: Vec<usize>,
    /// Options of each level.
    pub level_sizes: Vec<u32>,
    pub poses: Arc<Vec<Pose>>,
    /// Inertia matrices of the judged cases.
    pub inertias: Arc<Vec<CaseInertia>>,
    /// Peak over static stress in sizing cases.
    pub peak_factor: f64,
    /// Whether a lighter arm that is no softer is no worse.
    pub lighter_is_better: bool,
    /// Play of each piece.
    pub joint_plays: Vec<Option<JointPlay>>,
    /// Forces between bounds that a member must keep.
    pub force_bounds: Arc<[ForceBound]>,
}

/// What may stand at a place of the chain.
#[derive(Clone)]
pub(super) enum Part<'c> {
    /// A given joint.
    Given { mass_kg: f64, curve: Option<CurveBox> },
    /// A joint whose drive is a choice; an option of the tree is the first drive of a kind.
    Drives { sized: Arc<SizedJoint<'c>>, kinds: Arc<Kinds>, tree: Arc<Tree<DriveBox>>, rays: Arc<Rays> },
    /// A joint that takes the lightest drive that holds.
    FirstFit { sized: Arc<SizedJoint<'c>>, ladder: Arc<Ladder> },
    /// A link to choose.
    Links { length_m: f64, tree: Arc<Tree<LinkBox>> },
    /// A given tube.
    Tube { length_m: f64, tube: Box<LinkBox> },
    /// A rigid offset.
    Offset { mass_kg: f64 },
}

/// The drives that can be a first fit, and the box around any run of them.
pub(super) struct Ladder {
    /// `runs[k][i]`: the box of the drives `i..i + 2^k`.
    runs: Vec<Vec<DriveBox>>,
}

impl Ladder {
    pub fn new(steps: Vec<DriveBox>) -> Self {
        let mut runs = vec![steps];
        let mut width = 1;
        while 2 * width <= runs[0].len() {
            let last = &runs[runs.len() - 1];
            let next = (0..=runs[0].len() - 2 * width).map(|i| last[i].join(&last[i + width])).collect();
            runs.push(next);
            width *= 2;
        }
        Self { runs }
    }

    /// Number of steps.
    pub fn len(&self) -> usize {
        self.runs[0].len()
    }

    /// The box around the steps `first..=last`.
    pub fn run(&self, first: usize, last: usize) -> DriveBox {
        let k = (last - first + 1).ilog2() as usize;
        let run = &self.runs[k];
        run[first].join(&run[last + 1 - (1 << k)])
    }
}

impl<'c> Problem<'c> {
    /// The problem with some of the options only: those below nodes of each level's whole tree.
    pub fn restricted_to(&self, kept: &[Vec<u32>]) -> Option<Self> {
        let mut narrower = self.clone();
        for (&piece, nodes) in self.level_pieces.iter().zip(kept) {
            match &mut narrower.parts[piece] {
                Part::Drives { tree, .. } => *tree = Tree::over(tree, nodes)?,
                Part::Links { tree, .. } => *tree = Tree::over(tree, nodes)?,
                _ => {}
            }
        }
        Some(narrower)
    }

    /// Designs in a box, drives of a kind as one.
    pub fn members(&self, design_box: &[u32]) -> f64 {
        let of = |(&piece, &node): (&usize, &u32)| match &self.parts[piece] {
            Part::Drives { tree, .. } => f64::from(tree.node(node).members),
            Part::Links { tree, .. } => f64::from(tree.node(node).members),
            _ => 1.0,
        };
        self.level_pieces.iter().zip(design_box).map(of).product()
    }

    /// Numbers of each level's options below nodes of its whole tree, all drives of a kind.
    pub fn options_below(&self, kept: &[Vec<u32>]) -> Vec<Vec<u32>> {
        let of = |(&piece, nodes): (&usize, &Vec<u32>)| match &self.parts[piece] {
            Part::Drives { tree, kinds, .. } => kinds.drives_of(&tree.options_of(nodes)),
            Part::Links { tree, .. } => tree.options_of(nodes),
            _ => vec![0],
        };
        self.level_pieces.iter().zip(kept).map(of).collect()
    }

    /// Designs below nodes of each level's whole tree, drives of a kind as one.
    pub fn designs_below(&self, kept: &[Vec<u32>]) -> f64 {
        let of = |(&piece, nodes): (&usize, &Vec<u32>)| match &self.parts[piece] {
            Part::Drives { tree, .. } => tree.members_of(nodes),
            Part::Links { tree, .. } => tree.members_of(nodes),
            _ => 1.0,
        };
        self.level_pieces.iter().zip(kept).map(of).product()
    }

    /// Designs in the space.
    pub fn designs(&self) -> u128 {
        self.level_sizes.iter().map(|&s| u128::from(s)).product()
    }
}
