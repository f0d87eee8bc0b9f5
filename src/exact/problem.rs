//! A design space as branch and bound uses it: a tree of boxes for every level, and rows of numbers for every case.

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

/// A compiled design space. A piece is a joint, a link, or a spring or mass between them. Pieces are counted from the
/// tip, and most lists have one entry for each piece.
#[derive(Clone)]
pub(super) struct Problem<'c> {
    pub space: &'c DesignSpace,
    pub parts: Vec<Part<'c>>,
    /// Index of the piece that each level chooses, tip first.
    pub level_pieces: Vec<usize>,
    /// Number of options of each level.
    pub level_sizes: Vec<u32>,
    pub poses: Arc<Vec<Pose>>,
    /// Inertia matrix of each judged case (a case that counts for deflection and lowest mode), as a function of the
    /// line inertias of the pieces.
    pub inertias: Arc<Vec<CaseInertia>>,
    /// Ratio of peak stress to static stress in sizing cases, in which the arm also accelerates.
    pub peak_factor: f64,
    /// Whether a lighter arm of the same stiffness is never worse in any objective or limit. Dominated drives may be
    /// pruned only then.
    pub lighter_is_better: bool,
    /// Lost motion and friction of each joint; `None` for a joint without play and for any other piece.
    pub joint_plays: Vec<Option<JointPlay>>,
    /// Lever of the loads on each output bearing that is checked; `None` for any other joint and for any other piece.
    pub levers: Vec<Option<Lever>>,
    /// The space for gear and motor at each joint whose drives must fit into a link; `None` for any other piece.
    pub rooms: Vec<Option<Room>>,
    /// Intervals to which the present region restricts single forces; empty for a whole space.
    pub force_bounds: Arc<[ForceBound]>,
}

/// The part at one place of the chain, or the options from which a search chooses it.
#[derive(Clone)]
pub(super) enum Part<'c> {
    /// A joint or an elastic element whose stiffness is given. `curve` is `None` if it is rigid.
    Given { mass_kg: f64, curve: Option<CurveBox> },
    /// A joint whose drive the search chooses. An option of the tree is the first drive of a kind (drives of equal
    /// mass, curve and bearing stiffness).
    Drives { sized: Arc<SizedJoint<'c>>, kinds: Arc<Kinds>, tree: Arc<Tree<DriveBox>>, rays: Arc<Rays> },
    /// A joint that takes the lightest drive which carries its demand. The search makes no choice here.
    FirstFit { sized: Arc<SizedJoint<'c>>, ladder: Arc<Ladder> },
    /// A link whose section and material the search chooses.
    Links { length_m: f64, tree: Arc<Tree<LinkBox>> },
    /// A tube whose section and material are given.
    Tube { length_m: f64, tube: Box<LinkBox> },
    /// A rigid offset or another body without elastic coordinates. `mass_kg` is the amount that it adds to the mass of
    /// a design \[kg\]; it may be zero or negative.
    Offset { mass_kg: f64 },
}

/// Lever of the loads on a joint's output bearing: the distance along the axis from the face of the joint's flange to
/// the point where the link attaches. If the study states the lever, it is measured from the centre of the bearing
/// instead.
#[derive(Debug, Clone, Copy)]
pub(super) enum Lever {
    /// The lever is the same for all options \[m\].
    Given(f64),
    /// The lever depends on the option of the link with this piece number.
    OfLink(usize),
}

/// Where the space for gear and motor of a joint is stored. It is the space that the link outboard of the joint leaves.
#[derive(Debug, Clone, Copy)]
pub(super) enum Room {
    /// The space is the same for all options.
    Given(LinkRoom),
    /// The space depends on the option of the link with this piece number.
    OfLink(usize),
}

impl Part<'_> {
    /// Whether the part is a joint or another spring, and neither a body nor a tube.
    pub(super) fn is_joint(&self) -> bool {
        matches!(self, Part::Given { .. } | Part::Drives { .. } | Part::FirstFit { .. })
    }
}

/// The drives that a first-fit joint (one that takes the lightest drive which carries its demand) can get, by rising
/// mass. The ladder returns the box around any contiguous run of these drives: the least and the greatest value of each
/// number over them.
pub(super) struct Ladder {
    /// `runs[k][i]` is the box around the `2^k` drives from index `i` on. The box around any run of drives is the union
    /// of two of these boxes.
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

    /// Number of drives that can be a first fit.
    pub(super) fn len(&self) -> usize {
        self.runs[0].len()
    }

    /// The box around the drives with indices from `first` to `last`, both included.
    pub(super) fn run(&self, first: usize, last: usize) -> DriveBox {
        let k = (last - first + 1).ilog2() as usize;
        let run = &self.runs[k];
        run[first].join(&run[last + 1 - (1 << k)])
    }
}

impl<'c> Problem<'c> {
    /// The problem restricted to some of its options. `kept` has, for each level (choice), the nodes of its base tree
    /// whose options remain. `None` if a level has no option left.
    pub(super) fn restricted_to(&self, kept: &[Vec<u32>]) -> Option<Self> {
        let mut narrower = self.clone();
        for (&piece, nodes) in self.level_pieces.iter().zip(kept) {
            match &mut narrower.parts[piece] {
                Part::Drives { tree, .. } => *tree = Tree::over(tree, nodes)?,
                Part::Links { tree, .. } => *tree = Tree::over(tree, nodes)?,
                // Parts whose drive or section is given have no options, and neither have first fits.
                _ => {}
            }
        }
        Some(narrower)
    }

    /// Whether `design_box` has one node for each level and every node exists. This is tested for each box in a state
    /// that an earlier process saved.
    pub(super) fn has_box(&self, design_box: &[u32]) -> bool {
        let has = |(&piece, &node): (&usize, &u32)| match &self.parts[piece] {
            Part::Drives { tree, .. } => tree.has(node),
            Part::Links { tree, .. } => tree.has(node),
            _ => true,
        };
        design_box.len() == self.level_pieces.len() && self.level_pieces.iter().zip(design_box).all(has)
    }

    /// Number of designs in a box. All drives of a kind are counted as one option.
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

    /// The options that remain in each level, ascending. `kept` has, for each level, the nodes of its base tree that
    /// remain. All drives of a kind are included.
    pub(super) fn options_below(&self, kept: &[Vec<u32>]) -> Vec<Vec<u32>> {
        let of = |(&piece, nodes): (&usize, &Vec<u32>)| match &self.parts[piece] {
            Part::Drives { tree, kinds, .. } => kinds.drives_of(&tree.options_of(nodes)),
            Part::Links { tree, .. } => tree.options_of(nodes),
            _ => vec![0],
        };
        self.level_pieces.iter().zip(kept).map(of).collect()
    }

    /// Number of designs that remain. `kept` has, for each level, the nodes of its base tree that remain. All drives of
    /// a kind are counted as one option.
    pub(super) fn designs_below(&self, kept: &[Vec<u32>]) -> f64 {
        let of = |(&piece, nodes): (&usize, &Vec<u32>)| match &self.parts[piece] {
            Part::Drives { tree, .. } => tree.members_of(nodes),
            Part::Links { tree, .. } => tree.members_of(nodes),
            _ => 1.0,
        };
        self.level_pieces.iter().zip(kept).map(of).product()
    }

    /// Number of designs in the space. Every drive is counted, tied or not.
    pub(super) fn designs(&self) -> u128 {
        self.level_sizes.iter().map(|&s| u128::from(s)).product()
    }
}
