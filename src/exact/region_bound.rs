//! The bound of a region. Its result is either a proof that the region is empty, or the surviving options, ways to
//! branch and promising designs.
//!
//! A region is the set of designs below a local upper bound: with less than its mass, less than its deflection and a
//! higher mode. The proof is a weighted sum of inequalities ([`rows`](super::rows)) that no design satisfies. The
//! weights are the multipliers. A relaxed design is the cheapest choice of parts in such a sum, and a mixture is a
//! weighted mean of several relaxed designs. The multipliers are found as the solution of a *matrix game*: the weights
//! that make the least sum over the known relaxed designs as large as possible.

use super::bound::{BoxBound, DesignBox};
use super::box_work::BoxWork;
use super::branching::Branching;
use super::local_upper_bounds::{LocalUpperBound, LocalUpperBounds};
use super::matrix_game::Game;
use super::problem::Problem;
use super::rows::{DualPoint, ROUNDING, RelaxedDesign, Rows, WarmStart};

/// Greatest number of dual points (sets of multipliers) for one box, in addition to the points that use a single row.
const MOST_POINTS: usize = 24;
/// Greatest number of rounds in which new trial shapes (motions that bound the lowest mode) are added for one box.
const MOST_SHAPES: usize = 3;
/// Greatest number of dual points that are added once it is clear that the multipliers cannot prove the region empty.
/// Further points still exclude more options by their reduced costs: the increase of the weighted sum with the option.
const MOST_TO_REDUCE: usize = 8;
/// The search for multipliers stops if the value of the matrix game exceeds the value of the best dual point so far by
/// at most this much (in the scale of the rows). The value of the matrix game limits what any multipliers can prove.
const VALUE_TOLERANCE: f64 = 1e-4;
/// Least weight of a relaxed design in the mixture. A smaller weight is due to rounding.
const LEAST_MIXTURE_WEIGHT: f64 = 1e-9;

/// The options, branchings and candidates that remain of a region after it was bounded.
pub(super) struct Survivors {
    /// For each level, nodes of its base tree (the tree over all options) that contain every option which a member of
    /// the region may have.
    pub options: Vec<Vec<u32>>,
    /// Ways to divide the region, the most promising first.
    pub branchings: Vec<Branching>,
    /// Relaxed designs of the mixture. If one of them is a single design, it is evaluated: it may join the
    /// designs found so far.
    pub candidates: Vec<DesignBox>,
}

/// For each set of multipliers that was tried for a box: its dual point, and the relaxed design that minimizes the
/// weighted sum.
#[derive(Default)]
struct Proofs {
    points: Vec<DualPoint>,
    members: Vec<RelaxedDesign>,
}

impl Proofs {
    /// Minimizes the weighted sum of the rows under `multipliers` and keeps the result. Returns the dual
    /// point.
    fn add(&mut self, rows: &Rows, design_box: &[u32], multipliers: Vec<f64>) -> &DualPoint {
        let (point, member) = rows.minimize(design_box, multipliers);
        self.members.push(member);
        self.points.push(point);
        &self.points[self.points.len() - 1]
    }
}

impl Problem<'_> {
    /// Tests whether a box has designs below the local upper bounds of a group. `work` has the intervals of the box,
    /// and `warm_start` the multipliers of the parent box. Bounds below which the box is proved to have no design are
    /// removed from `below`. `None` if none is left; otherwise the options and designs that remain possible.
    pub(super) fn bound_below(
        &self,
        design_box: &[u32],
        box_bound: &BoxBound,
        warm_start: &mut WarmStart,
        work: &BoxWork,
        below: &mut LocalUpperBounds,
    ) -> Option<Survivors> {
        let joined = below.join()?;
        let mut rows = Rows::new(self, design_box, box_bound, &joined, warm_start, work);
        let mut proofs = Proofs::default();
        let game = rows.refute(design_box, &joined, warm_start, &mut proofs)?;
        rows.refute_one_by_one(design_box, below, &mut proofs);
        let joined = below.join()?;
        let Proofs { points, members } = proofs;
        let mixed: Vec<(&RelaxedDesign, f64)> = members
            .iter()
            .zip(game.mix.iter().copied())
            .filter(|(_, share)| *share > LEAST_MIXTURE_WEIGHT)
            .collect();
        let survivors = Survivors {
            options: rows.affordable_options(design_box, &points, &joined)?,
            branchings: rows.branchings(&mixed, &game.weights),
            candidates: mixed.iter().map(|(member, _)| member.design_box.clone()).collect(),
        };
        rows.save_warm_start(&game.weights, warm_start);
        Some(survivors)
    }
}

impl Rows<'_> {
    /// Looks for multipliers that prove a box to have no design below the local upper bound `upper`. `None` if such
    /// multipliers are found. Otherwise the result is the game between the rows and the relaxed designs with which the
    /// attempt ended.
    fn refute(
        &mut self,
        design_box: &[u32],
        upper: &LocalUpperBound,
        warm_start: &WarmStart,
        proofs: &mut Proofs,
    ) -> Option<Game> {
        let mut starts = self.single_row_multipliers(upper);
        let most = starts.len() + MOST_POINTS;
        starts.push(self.starting_multipliers(&warm_start.multipliers));
        let (mut new_shapes, mut to_reduce, mut nearest) = (0, 0, f64::NEG_INFINITY);
        loop {
            let multipliers = match starts.pop() {
                Some(multipliers) => multipliers,
                None => {
                    let game = self.best_multipliers(&proofs.members, upper);
                    // The present rows cannot prove the region empty. New trial shapes may.
                    if game.value <= ROUNDING && new_shapes < MOST_SHAPES {
                        new_shapes += 1;
                        if self.add_violated_modes(&mut proofs.members, &game.mix, upper) {
                            continue;
                        }
                    }
                    // With a value of at most zero, the multipliers cannot prove the region empty. They then serve only
                    // to exclude options.
                    to_reduce += usize::from(game.value <= ROUNDING);
                    if proofs.points.len() >= most
                        || to_reduce > MOST_TO_REDUCE
                        || game.value <= nearest + VALUE_TOLERANCE
                    {
                        return Some(game);
                    }
                    game.weights
                }
            };
            let point = proofs.add(self, design_box, multipliers);
            let above = point.least - self.allowed_sum(point, upper);
            // The value of the dual function exceeds the limits. The multipliers are a certificate that the region is
            // empty.
            if above > ROUNDING {
                return None;
            }
            nearest = nearest.max(above);
        }
    }

    /// Removes from the group `below` the local upper bounds below which a box is proved to have no design. First,
    /// every set of multipliers found so far is tried on all bounds. Then new multipliers are sought for the bound that
    /// is nearest to a refutation, until they refute no bound. The bounds that remain are searched better in two halves
    /// of the group, with fewer options.
    fn refute_one_by_one(&mut self, design_box: &[u32], below: &mut LocalUpperBounds, proofs: &mut Proofs) {
        let mut open: Vec<(f64, LocalUpperBound)> = Vec::new();
        let first: Vec<Plane> = proofs.points.iter().map(|point| self.plane(point)).collect();
        for upper in below.all() {
            let above = first.iter().map(|plane| plane.above(upper)).fold(f64::NEG_INFINITY, f64::max);
            if above <= ROUNDING {
                open.push((above, *upper));
            }
        }
        let alone = below.all().len() == 1;
        let joined_lambda = self.lambda;
        while !alone && let Some(&(nearest, next)) = open.iter().max_by(|a, b| a.0.total_cmp(&b.0)) {
            self.set_lambda(next.lambda().max(joined_lambda), &mut proofs.members);
            let game = self.best_multipliers(&proofs.members, &next);
            if game.value <= nearest + VALUE_TOLERANCE || game.value <= ROUNDING {
                break;
            }
            let point = proofs.add(self, design_box, game.weights);
            let plane = self.plane(point);
            let before = open.len();
            open.retain_mut(|(nearest, upper)| {
                *nearest = nearest.max(plane.above(upper));
                *nearest <= ROUNDING
            });
            // The new multipliers refute no bound, not even the bound for which they were made.
            if open.len() == before {
                break;
            }
        }
        *below = open.into_iter().map(|(_, upper)| upper).collect();
    }

    /// The dual point as a plane in the space of objectives, which is quick to test on any local upper bound.
    fn plane(&self, point: &DualPoint) -> Plane {
        let weights: Vec<f64> =
            point.multipliers.iter().zip(&self.scale).map(|(w, scale)| w / scale).collect();
        let mut moves = [0.0; 2];
        for (w, mode) in weights[self.first_mode..].iter().zip(&self.modes) {
            moves.iter_mut().zip(mode.kinetic).for_each(|(sum, kinetic)| *sum += w * kinetic);
        }
        Plane {
            least: point.least,
            mass: weights[0],
            tip: weights[1..=self.tips.len()].iter().sum(),
            moves,
            lambda: point.lambda,
        }
    }
}

/// A dual point (set of multipliers), written as an inequality in the numbers of a local upper bound. If
/// [`above`](Self::above) is positive for a bound, the box has no design below that bound.
struct Plane {
    /// The least weighted sum of the rows.
    least: f64,
    /// Weights of the mass and of the deflection of a local upper bound.
    mass: f64,
    tip: f64,
    /// Weight of the difference between `lambda` and the eigenvalue of a local upper bound, once with the lightest and
    /// once with the heaviest parts of the box.
    moves: [f64; 2],
    lambda: f64,
}

impl Plane {
    /// By how much the least weighted sum of the rows exceeds the sum that the local upper bound `upper` allows.
    fn above(&self, upper: &LocalUpperBound) -> f64 {
        // A limit may be infinite. Its product with a weight of zero would be NaN.
        let term = |weight: f64, limit: f64| if weight > 0.0 { weight * limit } else { 0.0 };
        let below = self.lambda - upper.lambda();
        let moves = self.moves[usize::from(below > 0.0)];
        self.least - term(self.mass, upper.mass_kg) - term(self.tip, upper.tip_m) - below * moves
    }
}
