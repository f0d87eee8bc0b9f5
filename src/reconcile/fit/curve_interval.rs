//! Computes 95 % intervals of the parameters of a gear's torsion curve from their posterior distribution.
//!
//! A break point has no meaning if the slopes on its two sides are equal. Among the many places where it could be,
//! there is always one that fits the noise well. The lowest objective over these places is therefore the best of many
//! chance results. The usual interval ends where the objective has risen by 3.84; here it would contain the true value
//! too rarely.
//!
//! So every place is weighted by its probability. With both break points fixed at a place, the readings are nearly
//! linear in all other parameters. A fit of these then gives the likelihood of the place, and the distribution that the
//! slopes have if the break points are at this place (Laplace's approximation). The places are nodes around the best
//! fit, close together near it. The search visits the neighbours of every node that the readings do not rule out.

use super::descent::data_curvature;
use super::descent::{Effort, Fit, fit_below};
use super::stats::normal_below;
use super::weights::Weights;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::model::estimate::Interval;
use nalgebra::{Cholesky, DMatrix};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Probability that the parameter lies beyond the interval, at each of its two ends.
const TAIL_PROBABILITY: f64 = 0.025;
/// The lower end of the interval is `None` if the probability density at the lower limit of the parameter's range is
/// more than this fraction of its maximum. The same holds for the upper end and the upper limit. The fraction
/// corresponds to a rise of the objective by 3.84: exp(-3.84 / 2).
const OPEN_END_DENSITY: f64 = 0.146;
/// A pair of nodes (one value for each break point) is ruled out if its objective exceeds the smallest objective found
/// by more than this. The probability density of the pair is then below a thousandth of the maximum: exp(-14 / 2).
pub(crate) const RULED_OUT: f64 = 14.0;
/// First step from the best fit to the next node, as a multiple of the standard deviation of the break point.
const FIRST_STEP: f64 = 0.5;
/// Smallest and largest value of the first step from the best fit to the next node \[ln of the torque\].
const STEPS: (f64, f64) = (0.004, 0.08);
/// Ratio of each step between nodes to the step before it, going outwards from the best fit.
const STEP_RATIO: f64 = 1.4;
/// Spacing of a coarse grid of node pairs, counted in nodes from the best fit. All pairs of this grid are fitted, so
/// that no separate peak of the density is missed.
const COARSE_SPACING: usize = 3;
/// Largest number of steps, and tolerance, of a fit in which both break points are fixed.
const HELD: Effort = Effort { steps: 4, tolerance: 0.05 };

/// One axis of the grid over the two break points. Its nodes are the torques at which this break point is fixed while
/// the other parameters are fitted, ascending \[ln of the torque\].
struct Axis {
    parameter: usize,
    nodes: Vec<f64>,
}

/// The result of a fit in which the two break points are fixed at the torques of one pair of nodes.
struct Cell {
    u: Vec<f64>,
    /// Standard deviations of all parameters, in `u`. Those of the two fixed break points are infinite and not used.
    deviations: Vec<f64>,
    objective: f64,
    /// Natural logarithm of the probability density of the two break points at the nodes, up to a common constant.
    ln_density: f64,
}

/// 95 % intervals of the parameters of one gear's curve. `own` is the range of the indices of these parameters, and the
/// result is in its order. `pair` is the indices of the two break points. `deviations` has the standard deviation of
/// every parameter of the model.
pub(crate) fn curve_intervals(
    forward: &Forward,
    best: &Fit,
    weights: &Weights,
    own: std::ops::Range<usize>,
    pair: [usize; 2],
    deviations: &[f64],
) -> Vec<Interval> {
    let axes = pair.map(|p| Axis::new(best, p, deviations[p]));
    let posterior = Posterior { cells: explore(forward, best, weights, &axes), axes };
    own.map(|p| match pair.iter().position(|b| *b == p) {
        Some(axis) => posterior.break_point(axis),
        None => posterior.slope(p, best.model.bounds(p)),
    })
    .collect()
}

impl Axis {
    fn new(best: &Fit, parameter: usize, deviation: f64) -> Self {
        let (low, high) = best.model.bounds(parameter);
        let at = best.point.u[parameter].clamp(low, high);
        let first = (FIRST_STEP * deviation).clamp(STEPS.0, STEPS.1);
        let outward = |side: f64, limit: f64| {
            let offsets =
                (1..).map(move |n| at + side * first * (STEP_RATIO.powi(n) - 1.0) / (STEP_RATIO - 1.0));
            let mut nodes: Vec<f64> = offsets.take_while(|v| (limit - v) * side > 0.0).collect();
            if limit != at {
                nodes.push(limit);
            }
            nodes
        };
        let mut nodes = outward(-1.0, low);
        nodes.reverse();
        nodes.push(at);
        nodes.extend(outward(1.0, high));
        Self { parameter, nodes }
    }

    /// The interval of the axis that a node represents. It reaches halfway to both neighbouring nodes \[ln of the
    /// torque\].
    fn span(&self, node: usize) -> (f64, f64) {
        let middle = |a: usize, b: usize| 0.5 * (self.nodes[a] + self.nodes[b]);
        let last = self.nodes.len() - 1;
        (middle(node.saturating_sub(1), node), middle(node, (node + 1).min(last)))
    }
}

/// Index of the node on each of the two axes, one axis per break point.
type Nodes = [usize; 2];

/// Fits the model at a coarse grid of node pairs, and then at the neighbours of every pair that is not ruled out.
/// Returns one cell for each pair that was fitted.
fn explore(forward: &Forward, best: &Fit, weights: &Weights, axes: &[Axis; 2]) -> BTreeMap<Nodes, Cell> {
    let centre = [0, 1].map(|k| {
        let (axis, at) = (&axes[k], best.point.u[axes[k].parameter]);
        (0..axis.nodes.len())
            .min_by(|a, b| (axis.nodes[*a] - at).abs().total_cmp(&(axis.nodes[*b] - at).abs()))
    });
    let centre = centre.map(|c| c.unwrap_or(0));
    // the second break point is above the first
    let ordered = |n: &Nodes| axes[0].nodes[n[0]] < axes[1].nodes[n[1]];
    let coarse =
        |k: usize| (0..axes[k].nodes.len()).filter(move |n| n.abs_diff(centre[k]) % COARSE_SPACING == 0);
    let all = coarse(0).flat_map(|a| coarse(1).map(move |b| [a, b]));
    let mut frontier: Vec<(Nodes, Vec<f64>)> =
        all.filter(ordered).map(|nodes| (nodes, best.point.u.clone())).collect();
    let mut cells: BTreeMap<Nodes, Cell> = BTreeMap::new();
    while !frontier.is_empty() {
        let fits: Vec<(Nodes, Cell)> = frontier
            .into_par_iter()
            .map(|(nodes, start)| (nodes, Cell::fitted(forward, best, weights, axes, nodes, &start)))
            .collect();
        cells.extend(fits);
        let least = cells.values().map(|c| c.objective).fold(f64::INFINITY, f64::min);
        let mut next: BTreeMap<Nodes, (f64, Vec<f64>)> = BTreeMap::new();
        for (nodes, cell) in cells.iter().filter(|(_, c)| c.objective < least + RULED_OUT) {
            for near in neighbours(*nodes, axes).filter(|n| ordered(n) && !cells.contains_key(n)) {
                let from = next.entry(near).or_insert((f64::INFINITY, Vec::new()));
                if cell.objective < from.0 {
                    *from = (cell.objective, cell.u.clone());
                }
            }
        }
        frontier = next.into_iter().map(|(nodes, (_, start))| (nodes, start)).collect();
    }
    cells
}

fn neighbours(nodes: Nodes, axes: &[Axis; 2]) -> impl Iterator<Item = Nodes> {
    let counts = [axes[0].nodes.len(), axes[1].nodes.len()];
    let moves = [(0, 1), (2, 1), (1, 0), (1, 2)];
    let moved =
        moves.into_iter().map(move |(a, b)| [(nodes[0] + a).wrapping_sub(1), (nodes[1] + b).wrapping_sub(1)]);
    moved.filter(move |n| n[0] < counts[0] && n[1] < counts[1])
}

impl Cell {
    fn fitted(
        forward: &Forward,
        best: &Fit,
        weights: &Weights,
        axes: &[Axis; 2],
        nodes: Nodes,
        start: &[f64],
    ) -> Self {
        let mut model = best.model.clone();
        model.held = [0, 1].map(|k| (axes[k].parameter, axes[k].nodes[nodes[k]])).to_vec();
        let limit = best.point.objective + RULED_OUT;
        let fitted = fit_below(forward, &model, start, weights, HELD, limit);
        let held = axes.each_ref().map(|a| a.parameter);
        let of_rest = without(&fitted.curvature, held);
        // the evidence integrates over all parameters, but two of them are fixed here, so the factor that the integral
        // over these two contributes is removed
        let ln_density =
            fitted.evidence + 0.5 * (ln_determinant(fitted.curvature.clone()) - ln_determinant(of_rest));
        // the two fixed parameters are not part of the covariance
        let covariance = without(&data_curvature(&fitted), held).try_inverse();
        let mut deviations = vec![f64::INFINITY; fitted.point.u.len()];
        let rest = (0..deviations.len()).filter(|p| !held.contains(p)).collect::<Vec<_>>();
        if let Some(covariance) = covariance {
            rest.iter().enumerate().for_each(|(i, p)| deviations[*p] = covariance[(i, i)].abs().sqrt());
        }
        Self { objective: fitted.point.objective, u: fitted.point.u, deviations, ln_density }
    }
}

/// Removes the rows and the columns with the two indices `held` from a matrix.
fn without(matrix: &DMatrix<f64>, mut held: [usize; 2]) -> DMatrix<f64> {
    held.sort_unstable();
    matrix.clone().remove_rows_at(&held).remove_columns_at(&held)
}

fn ln_determinant(matrix: DMatrix<f64>) -> f64 {
    Cholesky::new(matrix)
        .map_or(f64::INFINITY, |c| 2.0 * c.l().diagonal().iter().map(|d| libm::log(*d)).sum::<f64>())
}

/// The posterior distribution of the two break points, as cells over the pairs of nodes.
struct Posterior {
    axes: [Axis; 2],
    cells: BTreeMap<Nodes, Cell>,
}

impl Posterior {
    /// Probability of each cell, up to a common factor: its density times the area that its pair of nodes represents.
    fn masses(&self) -> impl Iterator<Item = (&Nodes, &Cell, f64)> {
        let top = self.cells.values().map(|c| c.ln_density).fold(f64::NEG_INFINITY, f64::max);
        let width = |axis: usize, node: usize| {
            let (from, to) = self.axes[axis].span(node);
            to - from
        };
        self.cells.iter().map(move |(nodes, cell)| {
            // the nodes are not equally spaced, so each pair is weighted by the area that it represents
            let area = width(0, nodes[0]) * width(1, nodes[1]);
            (nodes, cell, libm::exp(cell.ln_density - top) * area)
        })
    }

    fn break_point(&self, axis: usize) -> Interval {
        let nodes = &self.axes[axis];
        let mut masses = vec![0.0; nodes.nodes.len()];
        self.masses().for_each(|(at, _, mass)| masses[at[axis]] += mass);
        let spans: Vec<(f64, f64)> = (0..masses.len()).map(|n| nodes.span(n)).collect();
        let density = |n: usize| masses[n] / (spans[n].1 - spans[n].0).max(1e-12);
        let peak = (0..masses.len()).map(density).fold(0.0, f64::max);
        let all: f64 = masses.iter().sum();
        let quantile = |part: f64| {
            let mut below = 0.0;
            for (mass, (from, to)) in masses.iter().zip(&spans) {
                if below + mass >= part * all {
                    return from + (to - from) * (part * all - below) / mass.max(1e-300);
                }
                below += mass;
            }
            nodes.nodes[masses.len() - 1]
        };
        let open = |n: usize| density(n) > OPEN_END_DENSITY * peak;
        Interval {
            low: (!open(0)).then(|| quantile(TAIL_PROBABILITY)),
            high: (!open(masses.len() - 1)).then(|| quantile(1.0 - TAIL_PROBABILITY)),
        }
    }

    /// The 95 % interval of the slope with parameter index `p`, whose range is `low` to `high`. The distribution of
    /// the slope is a mixture of normal distributions, one per cell, each cut off at the ends of the range.
    fn slope(&self, p: usize, (low, high): (f64, f64)) -> Interval {
        struct Part {
            u: f64,
            sd: f64,
            mass: f64,
        }
        let parts: Vec<Part> = self
            .masses()
            .map(|(_, cell, mass)| {
                let (u, sd) = (cell.u[p], cell.deviations[p].clamp(1e-9, 1e9));
                let inside = normal_below((high - u) / sd) - normal_below((low - u) / sd);
                Part { u, sd, mass: mass / inside.max(1e-12) }
            })
            .collect();
        let below = |v: f64| -> f64 {
            let part = |Part { u, sd, mass }: &Part| {
                mass * (normal_below((v - u) / sd) - normal_below((low - u) / sd))
            };
            parts.iter().map(part).sum()
        };
        let density = |v: f64| -> f64 {
            parts
                .iter()
                .map(|Part { u, sd, mass }| mass / sd * libm::exp(-0.5 * ((v - u) / sd).powi(2)))
                .sum()
        };
        let peak = parts.iter().map(|part| density(part.u)).fold(0.0, f64::max);
        let all = below(high);
        let quantile = |part: f64| {
            let (mut from, mut to) = (low, high);
            // bisection: sixty halvings reach the precision of the numbers
            for _ in 0..60 {
                let middle = 0.5 * (from + to);
                if below(middle) < part * all { from = middle } else { to = middle }
            }
            0.5 * (from + to)
        };
        let open = |limit: f64| density(limit) > OPEN_END_DENSITY * peak;
        Interval {
            low: (!open(low)).then(|| quantile(TAIL_PROBABILITY)),
            high: (!open(high)).then(|| quantile(1.0 - TAIL_PROBABILITY)),
        }
    }
}
