//! The bound of a region. Its result is either a proof that the region is empty, or the surviving options, ways to
//! branch and promising designs.

use super::bound::{BoxBound, DesignBox};
use super::branching::Branching;
use super::local_upper_bounds::LocalUpperBound;
use super::problem::Problem;
use super::rows::{DualPoint, ROUNDING, RelaxedDesign, Rows, WarmStart};
use super::work::Work;

/// Greatest number of dual points (sets of multipliers) for one box, in addition to those that use a single row.
const MOST_POINTS: usize = 24;
/// Greatest number of rounds in which new trial shapes are added for one box.
const MOST_SHAPES: usize = 3;
/// Greatest number of dual points that are added once it is clear that the multipliers cannot prove the region empty.
/// Further points still exclude more options by their reduced costs.
const MOST_TO_REDUCE: usize = 8;
/// The search for multipliers stops if the value of the matrix game, which limits what any multipliers can prove,
/// exceeds the value of the best dual point so far by at most this much (in the scale of the rows).
const SETTLED: f64 = 1e-4;
/// Least weight of a relaxed design in the mixture. A smaller weight is due to rounding.
const SHARE: f64 = 1e-9;

/// The options, branchings and candidates that remain of a region after it was bounded.
pub(super) struct Survivors {
    /// For each level, nodes of its base tree (the tree over all options) that contain every option which a member of
    /// the region may have.
    pub options: Vec<Vec<u32>>,
    /// Ways to divide the region, the most promising first.
    pub branchings: Vec<Branching>,
    /// Relaxed designs of the mixture. If one of them is a single design, it is evaluated as a possible incumbent.
    pub candidates: Vec<DesignBox>,
}

impl Problem<'_> {
    /// Tests whether a box has designs below the local upper bound `upper`. The intervals of the box are in `work`, and
    /// the multipliers of the parent box are in `warm_start`. `None` if the bound proves that there are none; otherwise
    /// the options and designs that remain possible.
    pub(super) fn bound_below(
        &self,
        design_box: &[u32],
        box_bound: &BoxBound,
        warm_start: &mut WarmStart,
        work: &Work,
        upper: &LocalUpperBound,
    ) -> Option<Survivors> {
        let mut rows = Rows::new(self, design_box, box_bound, upper, warm_start, work);
        let (mut points, mut members) = (Vec::<DualPoint>::new(), Vec::<RelaxedDesign>::new());
        let mut starts = rows.single_row_multipliers(upper);
        let most = starts.len() + MOST_POINTS;
        starts.push(rows.starting_multipliers(&warm_start.multipliers));
        let (mut new_shapes, mut to_reduce, mut nearest) = (0, 0, f64::NEG_INFINITY);
        let game = loop {
            let multipliers = match starts.pop() {
                Some(multipliers) => multipliers,
                None => {
                    let game = rows.best_multipliers(&members, upper);
                    // The present rows cannot prove the region empty. New trial shapes may.
                    if game.value <= ROUNDING && new_shapes < MOST_SHAPES {
                        new_shapes += 1;
                        if rows.add_violated_modes(&mut members, &game.mix, upper) {
                            continue;
                        }
                    }
                    // From here on the multipliers serve only to exclude options.
                    to_reduce += usize::from(game.value <= ROUNDING);
                    if points.len() >= most || to_reduce > MOST_TO_REDUCE || game.value <= nearest + SETTLED {
                        break game;
                    }
                    game.weights
                }
            };
            let (point, member) = rows.minimize(design_box, multipliers);
            let above = point.least - rows.allowed_sum(&point.multipliers, upper);
            // The value of the dual function exceeds the limits. The multipliers are a certificate that the region is
            // empty.
            if above > ROUNDING {
                return None;
            }
            nearest = nearest.max(above);
            points.push(point);
            members.push(member);
        };
        let mixed: Vec<(&RelaxedDesign, f64)> =
            members.iter().zip(game.mix.iter().copied()).filter(|(_, share)| *share > SHARE).collect();
        let survivors = Survivors {
            options: rows.affordable_options(design_box, &points, upper)?,
            branchings: rows.branchings(&mixed, &game.weights),
            candidates: mixed.iter().map(|(member, _)| member.design_box.clone()).collect(),
        };
        rows.save_warm_start(&game.weights, warm_start);
        Some(survivors)
    }
}
