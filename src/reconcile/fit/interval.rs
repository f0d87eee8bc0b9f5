//! Computes 95 % intervals of fitted parameters.
//!
//! Where the objective is quadratic, its curvature gives the interval. The parameters of a gear's torsion curve get
//! their intervals from a posterior distribution ([`curve_interval`](super::curve_interval)). For some other parameters
//! the objective is not quadratic, for example for a torque scale or for a value near the end of its range. The
//! interval then follows the profile likelihood: the parameter is fixed at a value, and all others are refitted. An end
//! of the interval is the value at which the objective has risen by 3.84.

use super::curve_interval::curve_intervals;
use super::descent::{Effort, Fit, data_curvature, descent};
use super::weights::Weights;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::model::calibration::Calibration;
use crate::reconcile::model::estimate::{Interval, RISE_AT_95, Z_95};
use crate::reconcile::model::parameters::Model;
use nalgebra::DMatrix;
use rayon::prelude::*;

/// Standard deviation of every parameter of the fit, in `u`, from the curvature of the objective; infinite if the
/// curvature is singular.
pub(crate) fn deviations(fit: &Fit) -> Vec<f64> {
    let n = fit.curvature.nrows();
    let covariance =
        data_curvature(fit).try_inverse().unwrap_or_else(|| DMatrix::from_element(n, n, f64::INFINITY));
    (0..n).map(|p| covariance[(p, p)].abs().sqrt()).collect()
}

/// 95 % intervals of the parameters of all effects of the fit `best`, in the order of the parameters.
pub(crate) fn intervals(forward: &Forward, best: &Fit, weights: &Weights) -> Vec<Interval> {
    let deviations = deviations(best);
    let breaks = best.model.break_points();
    let of_effect = |effect: usize| -> Vec<Interval> {
        let first = best.model.first_parameter(effect);
        let own = first..first + best.model.effects[effect].free_parameters.len();
        let pair: Vec<usize> = breaks.iter().copied().filter(|p| own.contains(p)).collect();
        match pair.as_slice() {
            [a, b] => {
                let ends = curve_intervals(forward, best, weights, own.clone(), [*a, *b], &deviations);
                // the posterior distribution does not include the uncertainty of the torques that the tolerance of
                // masses causes
                let slack = |p| if pair.contains(&p) { Z_95 * torque_deviation(best) } else { 0.0 };
                let widened = |(p, ends): (usize, Interval)| {
                    ends.with(best.point.u[p]).wider(slack(p), best.model.bounds(p))
                };
                own.zip(ends).map(widened).collect()
            }
            _ => own.map(|p| interval(forward, best, weights, effect, p, deviations[p])).collect(),
        }
    };
    let closed = |effect: usize| -> Vec<Interval> {
        let own = best.model.effects[effect].free_parameters.iter().zip(of_effect(effect));
        own.map(|(parameter, ends)| parameter.closed(ends)).collect()
    };
    (0..best.model.effects.len()).into_par_iter().flat_map_iter(closed).collect()
}

/// The 95 % interval of the parameter with index `p`, which belongs to the effect with index `effect` and has the
/// standard deviation `sd`.
fn interval(forward: &Forward, best: &Fit, weights: &Weights, effect: usize, p: usize, sd: f64) -> Interval {
    let crooked = best.model.effects[effect].kind.traits.is_nonlinear;
    let (low, high) = best.model.bounds(p);
    let end = |side: f64| {
        let straight = best.point.u[p] + side * Z_95 * sd;
        let value = match crooked || !(low..=high).contains(&straight) {
            true => profile(forward, best, weights, p, side, sd),
            false => Some(straight),
        };
        value.filter(|v| *v > low && *v < high)
    };
    Interval { low: end(-1.0), high: end(1.0) }
}

/// Relative standard deviation of a joint's torque that the tolerance of masses causes. At a break point of a gear's
/// curve the frequencies jump, and the torque of the jump is not known better than this. A refit does not show this
/// uncertainty, because it cannot move a test across the jump.
fn torque_deviation(best: &Fit) -> f64 {
    let numbers = best.model.nuisance.numbers.iter();
    let masses = numbers.filter(|(calibration, _)| matches!(calibration, Calibration::Mass(_)));
    masses.map(|(_, sd)| *sd).fold(0.0, f64::max)
}

/// The lowest objective that a descent from the parameters `u` finds. Break points of a gear's curve make the
/// frequencies jump, and a descent stops at a jump. Unless the first descent ends below `enough`, a second one starts
/// where a descent with a smoothed curve ends.
fn refit(forward: &Forward, mut model: Model, u: &[f64], weights: &Weights, enough: f64) -> f64 {
    let effort = Effort { steps: 5, tolerance: 0.02 };
    let end = |model: &Model, u: &[f64], effort| descent(forward, model, u, weights, effort, f64::INFINITY);
    let straight = end(&model, u, effort).objective;
    // without frequencies there are no jumps at which a descent stops
    if straight < enough || model.break_points().is_empty() || forward.modal.is_empty() {
        return straight;
    }
    model.smoothing = 0.03;
    let start = end(&model, u, Effort { steps: 4, tolerance: 0.1 }).u;
    model.smoothing = 0.0;
    straight.min(end(&model, &start, effort).objective)
}

/// One end of the 95 % interval of the parameter with index `p`: the value at which the objective, with all other
/// parameters refitted, has risen by [`RISE_AT_95`]. `side` is -1 for the lower end and 1 for the upper end; `sd` is
/// the standard deviation from which the first guess comes. `None` if the objective does not rise so much within the
/// range of the parameter.
fn profile(forward: &Forward, best: &Fit, weights: &Weights, p: usize, side: f64, sd: f64) -> Option<f64> {
    let (low, high) = best.model.bounds(p);
    let u = best.point.u[p];
    let limit = if side < 0.0 { low } else { high };
    let rise = |value: f64| {
        let mut model = best.model.clone();
        model.held = vec![(p, value)];
        let objective = best.point.objective;
        refit(forward, model, &best.point.u, weights, objective + RISE_AT_95) - objective
    };
    let clamp = |value: f64| value.clamp(low, high);
    // the profile starts at the best value, where the rise is zero
    let mut near = (u, 0.0);
    let mut value = clamp(u + side * Z_95 * sd.clamp(1e-6, 10.0));
    for _ in 0..6 {
        let here = rise(value);
        if (here - RISE_AT_95).abs() < 0.4 {
            return Some(value);
        }
        if here < RISE_AT_95 && value == limit {
            return None;
        }
        // secant method on the square root of the rise, which is nearly linear
        let (a, b) = (near.1, here.max(1e-3).sqrt());
        let slope = (value - near.0) / (b - a);
        if here < RISE_AT_95 {
            near = (value, b);
        }
        let next = if slope.is_finite() && slope * side > 0.0 {
            value + (RISE_AT_95.sqrt() - b) * slope
        } else {
            u + (value - u) * 1.7
        };
        value = clamp(next.clamp(u.min(u + (value - u) * 4.0), u.max(u + (value - u) * 4.0)));
    }
    Some(value)
}
