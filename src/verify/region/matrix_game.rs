//! Maximin weights of a matrix: the weights for which the smallest weighted row sum is greatest.
//!
//! `max t : A w >= t, Σ w = 1, w >= 0` is a matrix game. It is solved by an interior-point method: Newton steps on
//! `t + μ (Σ log(A w - t) + Σ log w)` while `μ` is reduced. The fractions `μ / (A w - t)` of the rows are the dual
//! solution.
//!
//! The simplex method is not used, for three reasons. Weights near the optimum give bounds that are as good. Weights
//! from the centre exclude more options than weights at a vertex. And the verifier should use another method than the
//! search, which uses the simplex method.

use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Barrier parameter `μ` before the first stage; the first stage already uses [`BARRIER_FACTOR`] times this value.
/// `t` starts below the least row sum by the same number.
const FIRST_BARRIER: f64 = 0.3;
/// Factor by which `μ` is reduced from stage to stage.
const BARRIER_FACTOR: f64 = 0.2;
/// The stages end at `μ` = this divided by the number of rows and columns together.
const LAST_BARRIER: f64 = 3e-4;
/// Largest number of Newton steps at each stage.
const STEPS: usize = 4;
/// Upper limit of the weight of a condition (a column of a pair of opposite sign). It is needed because the sum of the
/// weights does not limit these weights.
const LARGEST_WEIGHT: f64 = 3.0;
/// Largest fraction of the distance to the nearest limit that a step may take, so that weights and slacks stay
/// positive.
const SHORT_OF: f64 = 0.95;

/// Weights of the columns, and fractions of the rows in a mixture (the dual solution). The fractions add up to one.
/// The weights of the columns that are not conditions add up to one, too.
pub(super) struct Minimax {
    pub weights: Vec<f64>,
    pub shares: Vec<f64>,
    /// Upper limit, over all weights, of the smallest weighted row sum.
    pub most: f64,
}

/// The weights of the columns for which the smallest weighted row sum is greatest.
///
/// The sum of the weights, which is one, does not include the weights of conditions. Each of these is at most
/// [`LARGEST_WEIGHT`] instead. Conditions come in pairs of opposite sign (a torque is at least a value, and at most
/// another). If the sum included them, equal weights on both columns of a pair would use up a part of it without any
/// effect.
pub(super) fn solve(rows: &[Vec<f64>], conditions: Range<usize>) -> Minimax {
    let (count, width) = (rows.len(), rows[0].len());
    let is_counted = |column: &usize| !conditions.contains(column);
    let counted = (0..width).filter(is_counted).count() as f64;
    let mut w: Vec<f64> = vec![1.0 / counted; width];
    let counts: Vec<f64> = (0..width).map(|column| if is_counted(&column) { 1.0 } else { 0.0 }).collect();
    let sums = |w: &[f64]| -> Vec<f64> { rows.iter().map(|row| dot(row, w)).collect() };
    let least = |sums: &[f64]| sums.iter().copied().fold(f64::INFINITY, f64::min);
    let last = LAST_BARRIER / (count + width) as f64;
    let mut mu = FIRST_BARRIER;
    let mut t = least(&sums(&w)) - FIRST_BARRIER;
    let mut shares = vec![1.0 / count as f64; count];
    while mu > last {
        mu = (mu * BARRIER_FACTOR).max(last);
        for _ in 0..STEPS {
            let slack: Vec<f64> = sums(&w).iter().map(|sum| sum - t).collect();
            let Some(step) = newton(rows, &w, &counts, &slack, mu) else { break };
            let (dw, dt) = (&step.as_slice()[..width], step[width]);
            let falls = rows.iter().map(|row| dot(row, dw) - dt).zip(&slack);
            let falls = falls.map(|(fall, left)| (fall, *left));
            let down = dw.iter().copied().zip(w.iter().copied());
            let conditions = conditions.clone().map(|k| (-dw[k], LARGEST_WEIGHT - w[k]));
            let bounds = falls.chain(down).chain(conditions).filter(|(fall, _)| *fall < 0.0);
            let room = bounds.map(|(fall, left)| -left / fall).fold(f64::INFINITY, f64::min);
            let length = (SHORT_OF * room).min(1.0);
            w.iter_mut().zip(dw).for_each(|(w, d)| *w += length * d);
            t += length * dt;
            if length == 1.0 {
                break;
            }
        }
        let inverse: Vec<f64> = sums(&w).iter().map(|sum| 1.0 / (sum - t)).collect();
        let total: f64 = inverse.iter().sum();
        shares = inverse.iter().map(|x| x / total).collect();
    }
    let mixed = |column: usize| rows.iter().zip(&shares).map(|(row, share)| row[column] * share).sum::<f64>();
    let of_counted = (0..width).filter(is_counted).map(mixed).fold(f64::NEG_INFINITY, f64::max);
    let most =
        of_counted + conditions.clone().map(|column| LARGEST_WEIGHT * mixed(column).max(0.0)).sum::<f64>();
    Minimax { weights: w, shares, most }
}

/// The Newton step: the change of every weight, then the change of `t`. `None` if the equations are singular.
fn newton(rows: &[Vec<f64>], w: &[f64], counts: &[f64], slack: &[f64], mu: f64) -> Option<DVector<f64>> {
    let width = w.len();
    let mut curvature = DMatrix::<f64>::zeros(width + 1, width + 1);
    let mut sides = DMatrix::<f64>::zeros(width + 1, 2);
    for (k, w) in w.iter().enumerate() {
        curvature[(k, k)] = 1.0 / (w * w);
        (sides[(k, 0)], sides[(k, 1)]) = (1.0 / w, counts[k]);
        if counts[k] == 0.0 {
            let left = LARGEST_WEIGHT - w;
            curvature[(k, k)] += 1.0 / (left * left);
            sides[(k, 0)] -= 1.0 / left;
        }
    }
    sides[(width, 0)] = 1.0 / mu;
    for (row, slack) in rows.iter().zip(slack) {
        let inverse = 1.0 / slack;
        let entry = |k: usize| if k < width { row[k] * inverse } else { -inverse };
        for k in 0..=width {
            sides[(k, 0)] += entry(k);
            (0..=k).for_each(|i| curvature[(k, i)] += entry(k) * entry(i));
        }
    }
    let steps = curvature.cholesky()?.solve(&sides);
    let sum = |column: usize| {
        steps.column(column).iter().zip(counts).map(|(step, count)| step * count).sum::<f64>()
    };
    Some(steps.column(0) - steps.column(1) * (sum(0) / sum(1)))
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// No weights make the smallest weighted row sum greater than `most`, and the weights found come close to
        /// it. The comparison is with fictitious play, another method for matrix games.
        #[test]
        fn no_weights_are_better_by_much_and_none_than_what_is_said(
            rows in prop::collection::vec(prop::collection::vec(-1.0f64..1.0, 4), 1..9),
        ) {
            let Minimax { weights, shares, most } = solve(&rows, 0..0);
            prop_assert!(weights.iter().chain(&shares).all(|x| *x >= 0.0));
            prop_assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-9);
            prop_assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-9);
            let least = rows.iter().map(|row| dot(row, &weights)).fold(f64::INFINITY, f64::min);
            prop_assert!(least <= most + 1e-9, "{least} {most}");
            let (mut sums, mut counts) = ([0.0f64; 4], vec![0.0f64; rows.len()]);
            for _ in 0..4000 {
                let best = (0..4).max_by(|&a, &b| sums[a].total_cmp(&sums[b])).unwrap();
                counts.iter_mut().zip(&rows).for_each(|(count, row)| *count += row[best]);
                let worst = (0..rows.len()).min_by(|&a, &b| counts[a].total_cmp(&counts[b])).unwrap();
                sums.iter_mut().zip(&rows[worst]).for_each(|(sum, a)| *sum += a);
            }
            let ideal = sums.iter().fold(f64::NEG_INFINITY, |most, sum| most.max(sum / 4000.0));
            prop_assert!(least <= ideal + 1e-9 && least >= ideal - 0.15, "{least} {ideal}");
        }
    }
}
