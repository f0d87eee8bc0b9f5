//! A design space as branch and bound sees it: a tree of boxes for every level, and rows of numbers for every
//! case.

// {} => Given parts and first fits have no options of their own.
use super::force_bound::ForceBound;
use super::joint_play::JointPlay;
use super::kinds::Kinds;
use super::lowest_eigenvalue::CaseInertia;
use super::parts::{DriveBox, LinkBox, Rays};
use super::pose::Pose;
use super::torsion::CurveBox;
use super::tree::{Bounds, Tree};
use crate::sizing::fit::LinkRoom;
use crate::space::design_space::DesignSpace;
use crate::space::slot::SizedJoint;
use std::sync::Arc;

/// A compiled design space. Pieces are counted from the tip.
#[derive(Clone)]
pub(super) struct Problem<'c> {
    pub space: &'c DesignSpace,
    pub parts: Vec<Part<'c>>,
    /// The piece of each level, tip first.
    pub level_pieces: Vec<usize>,
    /// Number of options of each level.
    pub level_sizes: Vec<u32>,
    pub poses: Arc<Vec<Pose>>,
    /// Inertia matrices of the judged cases.
    pub inertias: Arc<Vec<CaseInertia>>,
    /// Ratio of peak stress to static stress in sizing cases.
    pub peak_factor: f64,
    /// Whether a lighter arm of the same stiffness is never worse. Dominated drives can be pruned only then.
    pub lighter_is_better: bool,
    /// Play of each piece; `None` if it has none.
    pub joint_plays: Vec<Option<JointPlay>>,
    /// Lever of each joint whose bearing is checked; `None` for any other piece.
    pub levers: Vec<Option<Lever>>,
    /// The room at each joint that asks for room; `None` for any other piece.
    pub rooms: Vec<Option<Room>>,
    /// Intervals to which a region restricts single forces.
    pub force_bounds: Arc<[ForceBound]>,
}

/// The part, or the choice of parts, at one place of the chain.
#[derive(Clone)]
pub(super) enum Part<'c> {
    /// A given joint.
    Given { mass_kg: f64, curve: Option<CurveBox> },
    /// A joint whose drive is a level of the search. An option of the tree is the first drive of a kind.
    Drives { sized: Arc<SizedJoint<'c>>, kinds: Arc<Kinds>, tree: Arc<Tree<DriveBox>>, rays: Arc<Rays> },
    /// A joint that takes the lightest drive that carries its demand.
    FirstFit { sized: Arc<SizedJoint<'c>>, ladder: Arc<Ladder> },
    /// A link whose section and material are a level of the search.
    Links { length_m: f64, tree: Arc<Tree<LinkBox>> },
    /// A given tube.
    Tube { length_m: f64, tube: Box<LinkBox> },
    /// A rigid offset.
    Offset { mass_kg: f64 },
}

/// Lever along the axis of a joint from its bearing to where the link attaches.
#[derive(Debug, Clone, Copy)]
pub(super) enum Lever {
    /// A lever that no choice changes \[m\].
    Given(f64),
    /// That of the link with this piece number.
    OfLink(usize),
}

/// The room that a link leaves to the parts of the joint that carries it.
#[derive(Debug, Clone, Copy)]
pub(super) enum Room {
    /// That of a given link.
    Given(LinkRoom),
    /// That of the link with this piece number.
    OfLink(usize),
}

impl Part<'_> {
    /// Whether it is a joint or a spring, and no body or tube.
    pub(super) fn is_joint(&self) -> bool {
        matches!(self, Part::Given { .. } | Part::Drives { .. } | Part::FirstFit { .. })
    }
}

/// The drives that can be a first fit, by rising mass, with the box around any run of them.
pub(super) struct Ladder {
    /// `runs[k][i]` is the box around the `2^k` drives from `i` on. The box around any run is the union of two such
    /// boxes.
    runs: Vec<Vec<DriveBox>>,
}

impl Ladder {
    pub(super) fn new(steps: Vec<DriveBox>) -> Self {
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

    /// Number of drives.
    pub(super) fn len(&self) -> usize {
        self.runs[0].len()
    }

    /// The box around the drives `first..=last`.
    pub(super) fn run(&self, first: usize, last: usize) -> DriveBox {
        let k = (last - first + 1).ilog2() as usize;
        let run = &self.runs[k];
        run[first].join(&run[last + 1 - (1 << k)])
    }
}

impl<'c> Problem<'c> {
    /// The problem restricted to the options below some nodes of each level's base tree. `None` if a level has no
    /// option left.
    pub(super) fn restricted_to(&self, kept: &[Vec<u32>]) -> Option<Self> {
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

    /// Whether nodes are those of a box of this problem, one for each level.
    pub(super) fn has_box(&self, design_box: &[u32]) -> bool {
        let has = |(&piece, &node): (&usize, &u32)| match &self.parts[piece] {
            Part::Drives { tree, .. } => tree.has(node),
            Part::Links { tree, .. } => tree.has(node),
            _ => true,
        };
        design_box.len() == self.level_pieces.len() && self.level_pieces.iter().zip(design_box).all(has)
    }

    /// Number of designs in a box, if all drives of a kind are counted as one.
    pub(super) fn members(&self, design_box: &[u32]) -> f64 {
        (0..design_box.len()).map(|level| f64::from(self.members_at(design_box, level))).product()
    }

    /// Number of options of a box at a level, if all drives of a kind are counted as one.
    pub(super) fn members_at(&self, design_box: &[u32], level: usize) -> u32 {
        match &self.parts[self.level_pieces[level]] {
            Part::Drives { tree, .. } => tree.node(design_box[level]).members,
            Part::Links { tree, .. } => tree.node(design_box[level]).members,
            _ => 1,
        }
    }

    /// For each level, the options below some nodes of its base tree. All drives of a kind are included.
    pub(super) fn options_below(&self, kept: &[Vec<u32>]) -> Vec<Vec<u32>> {
        let of = |(&piece, nodes): (&usize, &Vec<u32>)| match &self.parts[piece] {
            Part::Drives { tree, kinds, .. } => kinds.drives_of(&tree.options_of(nodes)),
            Part::Links { tree, .. } => tree.options_of(nodes),
            _ => vec![0],
        };
        self.level_pieces.iter().zip(kept).map(of).collect()
    }

    /// Number of designs below some nodes of each level's base tree, if all drives of a kind are counted as one.
    pub(super) fn designs_below(&self, kept: &[Vec<u32>]) -> f64 {
        let of = |(&piece, nodes): (&usize, &Vec<u32>)| match &self.parts[piece] {
            Part::Drives { tree, .. } => tree.members_of(nodes),
            Part::Links { tree, .. } => tree.members_of(nodes),
            _ => 1.0,
        };
        self.level_pieces.iter().zip(kept).map(of).product()
    }

    /// Number of designs in the space.
    pub(super) fn designs(&self) -> u128 {
        self.level_sizes.iter().map(|&s| u128::from(s)).product()
    }
}
