//! A cover of the space by boxes. It is refined by halving the boxes with the greatest gap first.
//!
//! A box is a set of designs. The boxes contain every design that no design found dominates, and each has a bound: the
//! best mass, deflection and mode that a member could have. The bounds therefore tell how near the designs found come
//! to every design of the space. This distance is the gap ([`gap`](super::gap)). The gap of the cover is the gap of its
//! worst box.

use super::bound::{BoxBound, Verdict};
use super::box_work::BoxWork;
use super::boxes::OpenBox;
use super::budget::Budget;
use super::gap::gap_of;
use super::incumbents::is_better;
use super::problem::Problem;
use crate::pareto::objectives::Objectives;
use rayon::prelude::*;
use std::sync::Arc;

/// Number of boxes that are halved in one step, in parallel.
const AT_ONCE: usize = 32;

/// Boxes that together contain every design except those that a design found before dominates.
pub(super) struct Cover(Vec<Piece>);

/// A box, the level along which it is halved, and its gap. The level is `None` for a box of one design.
struct Piece {
    open: OpenBox,
    level: Option<usize>,
    gap: f64,
}

impl Cover {
    /// Makes a cover of at least `boxes` boxes. `found` are the objectives of the designs found, from which the gap of
    /// each box follows. There are fewer boxes if the remaining boxes cannot be halved or the search is stopped.
    pub(super) fn new(budget: &Budget, problem: &Problem, found: &[Objectives], boxes: usize) -> Self {
        let Some(shapes) = problem.first_shapes(&mut BoxWork::default()) else { return Self(Vec::new()) };
        let root =
            OpenBox { design_box: problem.root(), shapes: Arc::new(shapes), box_bound: BoxBound::OPEN };
        let mut cover = Vec::from_iter(Piece::bounded(problem, root, found));
        while cover.len() < boxes && !budget.stopped() {
            // The boxes with the greatest gap stand last. A box of one design cannot be halved, so such boxes stand
            // first.
            cover.sort_by(|a, b| a.level.is_some().cmp(&b.level.is_some()).then(a.gap.total_cmp(&b.gap)));
            let divisible = cover.iter().filter(|piece| piece.level.is_some()).count();
            if divisible == 0 {
                break;
            }
            let worst = cover.split_off(cover.len() - AT_ONCE.min(divisible));
            let halves: Vec<Vec<Piece>> =
                worst.into_par_iter().map(|piece| piece.halves(problem, found)).collect();
            cover.extend(halves.into_iter().flatten());
        }
        Self(cover)
    }

    /// The bound (ideal point) of each box of the cover.
    pub(super) fn bounds(&self) -> Vec<BoxBound> {
        self.0.iter().map(|piece| piece.open.box_bound).collect()
    }
}

impl Piece {
    /// Bounds a box and computes its gap: by how much the nearest of the designs `found` is worse than the bound.
    /// `None` if no member meets the constraints, or if one of these designs dominates all members.
    fn bounded(problem: &Problem, mut open: OpenBox, found: &[Objectives]) -> Option<Self> {
        let mut work = BoxWork::default();
        let is_dominated = |bound: &BoxBound| {
            let best = Objectives::from(*bound);
            found.iter().any(|design| is_better(design, &best))
        };
        let verdict =
            problem.bound(&mut open.design_box, &mut open.shapes, &mut work, is_dominated, |_| true);
        let Verdict::Open(box_bound) = verdict else { return None };
        open.box_bound = box_bound;
        let level = problem.widest_level(&open.design_box, &open.shapes, &mut work);
        Some(Self { gap: gap_of(&box_bound, found), open, level })
    }

    /// The two halves of this box, each bounded. A half is left out if it is empty or if a design in `found` dominates
    /// all its members.
    fn halves(self, problem: &Problem, found: &[Objectives]) -> Vec<Self> {
        let level = self.level.unwrap_or_default();
        let halves = self.open.halves(problem, level, self.open.box_bound);
        halves.into_iter().filter_map(|half| Self::bounded(problem, half, found)).collect()
    }
}
