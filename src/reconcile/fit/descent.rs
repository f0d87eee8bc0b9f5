//! Fits a model: finds its most probable parameters within bounds, with Huber's loss.
//!
//! Residuals `r` are in standard deviations. The objective is `Σ ρ(r) + Σ u²`, where `ρ` is Huber's loss. The first sum
//! is over the data. The second is over the calibrated parameters, where each `u` is the deviation from nominal in
//! standard deviations of its tolerance. The parameters of effects are free within bounds.
//!
//! Steps are Levenberg-Marquardt steps with an active set at the bounds. The derivatives of frequencies are exact,
//! because solving for frequencies takes most of the time. Static and bench readings are cheap to compute and are
//! differentiated numerically.

use super::normal::{Normal, normal};
use super::weights::{Weights, loss};
use crate::reconcile::forward::coefficients::Coefficients;
use crate::reconcile::forward::modal::{ModalTest, Solved};
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::forward::statics::StaticState;
use crate::reconcile::model::parameters::Model;
use nalgebra::{Cholesky, DMatrix, DVector};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Step of a parameter by which numerical derivatives are computed, in the scaled parameters `u`.
const DERIVATIVE_STEP: f64 = 1e-4;

/// The predictions and the objective of a model at one parameter vector `u`.
pub struct Point {
    /// The scaled parameters: the calibrated ones first, then those of the effects.
    pub u: Vec<f64>,
    /// Compliances, joint laws and masses of the arm with these parameters (the coefficients).
    pub coefficients: Coefficients,
    /// Predicted value of each datum before the errors of the measuring channel are added, in the unit of the datum's
    /// file.
    pub truth: Vec<f64>,
    /// Predicted reading of each datum, with the errors of the measuring channel, in the unit of the datum's file.
    pub predicted: Vec<f64>,
    /// Loads on the arm in each static pose, and its deflections.
    pub statics: Vec<StaticState>,
    /// Modes of each modal test; an empty list if they are not needed.
    pub solved: Vec<Arc<Vec<Solved>>>,
    /// Value of the objective: Huber's loss of the residuals plus the squares of the calibrated parameters.
    pub objective: f64,
}

/// A fitted model, with its predictions, derivatives and evidence.
pub struct Fit<'a> {
    /// The model, with its effects and the parameters that are held fixed.
    pub model: Model<'a>,
    /// The point where the objective is smallest, with its predictions.
    pub point: Point,
    /// Derivative of every predicted reading (rows) with respect to every parameter (columns).
    pub jacobian: DMatrix<f64>,
    /// Curvature matrix of half the objective: `JᵀWJ` of the data plus the priors of the parameters.
    pub curvature: DMatrix<f64>,
    /// Natural logarithm of the evidence (Laplace's approximation).
    pub evidence: f64,
}

/// Computes the predictions and the objective of a model at the parameters `u`.
pub fn evaluate(forward: &Forward, model: &Model, u: &[f64], weights: &Weights) -> Point {
    evaluate_near(forward, model, u, weights, None)
}

/// Evaluates a model at the parameters `u`. If a modal test has the same stiffnesses and masses at `u` as at the known
/// point `near`, its modes are copied from `near`, because solving for modes takes most of the time. Most modes can be
/// copied if only a break point of a gear's curve moves.
pub fn evaluate_near(
    forward: &Forward,
    model: &Model,
    u: &[f64],
    weights: &Weights,
    near: Option<&Point>,
) -> Point {
    let coefficients = model.coefficients(forward, u);
    let mut truth = vec![0.0; forward.data.len()];
    let statics = forward.predict_smooth(&coefficients, &mut truth);
    let counts = |test: &ModalTest| test.modes.iter().any(|(datum, _)| weights.inverse[*datum] > 0.0);
    let known = |test: &ModalTest, index: usize| {
        let point = near?;
        let is_same = !point.solved[index].is_empty()
            && test.same_modes(&forward.layout, &point.coefficients, &coefficients);
        is_same.then(|| Arc::clone(&point.solved[index]))
    };
    let solve = |(index, test): (usize, &ModalTest)| match counts(test) || !weights.smooth_only {
        true => known(test, index)
            .unwrap_or_else(|| Arc::new(test.solve(&forward.layout, &coefficients, test.mode_count()))),
        false => Arc::default(),
    };
    let solved: Vec<Arc<Vec<Solved>>> = forward.modal.iter().enumerate().map(solve).collect();
    for (test, modes) in forward.modal.iter().zip(&solved) {
        test.write(modes, &mut truth);
    }
    let mut predicted = truth.clone();
    forward.read(&coefficients, &mut predicted);
    let objective = objective(forward, model, u, &predicted, weights);
    Point { u: u.to_vec(), coefficients, truth, predicted, statics, solved, objective }
}

/// The objective `Σ ρ(r) + Σ u²` for the readings `predicted`: Huber's loss of the residuals, and the squares of the
/// calibrated parameters in `u` (their priors).
pub fn objective(forward: &Forward, model: &Model, u: &[f64], predicted: &[f64], weights: &Weights) -> f64 {
    let data: f64 = forward
        .data
        .iter()
        .zip(predicted)
        .zip(&weights.inverse)
        .map(|((d, p), w)| loss((p - d.value) * w))
        .sum();
    data + u[..model.calibrated()].iter().map(|u| u * u).sum::<f64>()
}

/// Derivatives of all predicted readings at the point `at`: one row per datum, one column per parameter.
pub fn jacobian(forward: &Forward, model: &Model, at: &Point) -> DMatrix<f64> {
    let stepped = |p: usize| {
        let (_, high) = model.bounds(p);
        let step = if at.u[p] + DERIVATIVE_STEP > high { -DERIVATIVE_STEP } else { DERIVATIVE_STEP };
        let mut u = at.u.clone();
        u[p] += step;
        (step, model.coefficients(forward, &u))
    };
    let (steps, moved): (Vec<f64>, Vec<Coefficients>) = (0..model.len()).map(stepped).unzip();
    let mut out = changes_to(forward, at, &moved);
    out.column_iter_mut().zip(steps).for_each(|(mut column, step)| column /= step);
    out
}

/// Change of all predicted readings from the point `at` to the parameters `u`, one entry per datum. The change of
/// frequencies is linearized.
pub fn change(forward: &Forward, model: &Model, at: &Point, u: &[f64]) -> Vec<f64> {
    change_to(forward, at, model.coefficients(forward, u))
}

/// Change of all predicted readings from the point `at` to an arm with the coefficients `moved` (compliances, joint
/// laws, masses), one entry per datum. The change of frequencies is linearized.
pub fn change_to(forward: &Forward, at: &Point, moved: Coefficients) -> Vec<f64> {
    changes_to(forward, at, &[moved]).data.into()
}

/// Changes of the predicted readings (rows) from the point `at` to each of the coefficient sets `moved` (columns).
/// The change of frequencies is linearized.
fn changes_to(forward: &Forward, at: &Point, moved: &[Coefficients]) -> DMatrix<f64> {
    let mut out = DMatrix::zeros(at.truth.len(), moved.len());
    out.column_iter_mut().for_each(|mut column| column.copy_from_slice(&at.truth));
    forward.change_smooth(&at.statics, &at.coefficients, moved, &mut out);
    for (mut column, moved) in out.column_iter_mut().zip(moved) {
        if !forward.modal.is_empty() && !at.coefficients.same_modes(moved) {
            let mut delta = vec![0.0; at.truth.len()];
            for (test, solved) in forward.modal.iter().zip(&at.solved) {
                test.change(&forward.layout, solved, &at.coefficients, moved, &mut delta);
            }
            for i in forward.starts[1]..forward.starts[2] {
                column[i] += delta[i];
            }
        }
        forward.read(moved, column.as_mut_slice());
        column.iter_mut().zip(&at.predicted).for_each(|(value, before)| *value -= before);
    }
    out
}

/// Parameters after one damped step from `u`, kept within the bounds of the model. A larger `damping` makes the step
/// shorter.
pub fn bounded_step(model: &Model, u: &[f64], normal: &Normal, damping: f64) -> Vec<f64> {
    let n = u.len();
    let mut free: Vec<usize> = (0..n).collect();
    loop {
        let step = damped(normal, &free, damping);
        let blocked: Vec<usize> = free
            .iter()
            .zip(step.iter())
            .filter(|(p, s)| {
                let (low, high) = model.bounds(**p);
                let lowest = u[**p] <= low || model.rests(**p, u);
                (lowest && **s < 0.0) || (u[**p] >= high && **s > 0.0)
            })
            .map(|(p, _)| *p)
            .collect();
        if blocked.is_empty() {
            let mut out = u.to_vec();
            for (p, s) in free.iter().zip(step.iter()) {
                let (low, high) = model.bounds(*p);
                out[*p] = (u[*p] + s).clamp(low, high);
            }
            model.put_in_order(&mut out);
            return out;
        }
        // a parameter that would leave its bounds stays there, and the step of the others is computed again
        free.retain(|p| !blocked.contains(p));
    }
}

fn damped(normal: &Normal, free: &[usize], damping: f64) -> DVector<f64> {
    let n = free.len();
    let largest = normal.curvature.diagonal().iter().copied().fold(0.0, f64::max);
    let mut a = DMatrix::from_fn(n, n, |i, j| normal.curvature[(free[i], free[j])]);
    for i in 0..n {
        // the last terms keep the matrix regular where no datum depends on a parameter
        a[(i, i)] += damping * a[(i, i)] + 1e-12 * largest + 1e-30;
    }
    let b = DVector::from_fn(n, |i, _| -normal.gradient[free[i]]);
    match Cholesky::new(a) {
        Some(cholesky) => cholesky.solve(&b),
        None => b / (largest + 1e-30),
    }
}

/// When a fit ends: after a largest number of steps, or earlier when a step hardly lowers the objective.
#[derive(Debug, Clone, Copy)]
pub struct Effort {
    /// Largest number of steps.
    pub steps: usize,
    /// The fit ends if a step lowers the objective by less than this.
    pub tolerance: f64,
}

impl Default for Effort {
    fn default() -> Self {
        Self { steps: 30, tolerance: 1e-3 }
    }
}

/// Fits the parameters of a model by a descent from `start`.
pub fn fit<'a>(
    forward: &Forward,
    model: &Model<'a>,
    start: &[f64],
    weights: &Weights,
    effort: Effort,
) -> Fit<'a> {
    fit_below(forward, model, start, weights, effort, f64::INFINITY)
}

/// Fits the parameters of a model by a descent from `start`. The descent is given up when the objective can no longer
/// be expected to fall below `limit`.
pub fn fit_below<'a>(
    forward: &Forward,
    model: &Model<'a>,
    start: &[f64],
    weights: &Weights,
    effort: Effort,
    limit: f64,
) -> Fit<'a> {
    let (point, slopes) = descended(forward, model, start, weights, effort, limit);
    let slopes = slopes.unwrap_or_else(|| jacobian(forward, model, &point));
    finish(forward, model, point, slopes, weights)
}

/// End point of a descent from `start`, without the derivatives and the evidence of a full fit. The descent is given
/// up when the objective can no longer be expected to fall below `limit`.
pub fn descent(
    forward: &Forward,
    model: &Model,
    start: &[f64],
    weights: &Weights,
    effort: Effort,
    limit: f64,
) -> Point {
    descended(forward, model, start, weights, effort, limit).0
}

/// End point of a descent from `start`, and the derivatives of the predicted readings at this point if the descent has
/// computed them.
fn descended(
    forward: &Forward,
    model: &Model,
    start: &[f64],
    weights: &Weights,
    effort: Effort,
    limit: f64,
) -> (Point, Option<DMatrix<f64>>) {
    let mut start: Vec<f64> = start
        .iter()
        .enumerate()
        .map(|(p, u)| {
            let (low, high) = model.bounds(p);
            u.clamp(low, high)
        })
        .collect();
    model.put_in_order(&mut start);
    let mut here = evaluate(forward, model, &start, weights);
    let mut damping = 1e-4;
    for _ in 0..effort.steps {
        let slopes = jacobian(forward, model, &here);
        let normal = normal(forward, model.calibrated(), &here.u, &here.predicted, &slopes, weights);
        let Some(next) = descend(forward, model, &here, &normal, weights, &mut damping) else {
            return (here, Some(slopes));
        };
        let fall = here.objective - next.objective;
        here = next;
        // each step is expected to lower the objective by less than the step before, so one more fall of this size is
        // the most that can be expected
        let hopeless = here.objective - fall > limit;
        if fall < effort.tolerance || hopeless {
            break;
        }
    }
    (here, None)
}

/// The point after the first damped step from `here` that lowers the objective. `None` if seven steps, each damped
/// more than the one before, do not lower it.
fn descend(
    forward: &Forward,
    model: &Model,
    here: &Point,
    normal: &Normal,
    weights: &Weights,
    damping: &mut f64,
) -> Option<Point> {
    for _ in 0..7 {
        let u = bounded_step(model, &here.u, normal, *damping);
        if u == here.u {
            return None;
        }
        let next = evaluate_near(forward, model, &u, weights, Some(here));
        if next.objective < here.objective {
            // a good step: rely more on the quadratic approximation
            *damping = (*damping * 0.2).max(1e-9);
            return Some(next);
        }
        // a bad step: move closer to steepest descent
        *damping = (*damping * 10.0).max(1e-5);
    }
    None
}

/// Completes a fit at the end point of a descent: computes the curvature of half the objective and the logarithm of
/// the evidence.
pub fn finish<'a>(
    forward: &Forward,
    model: &Model<'a>,
    point: Point,
    mut jacobian: DMatrix<f64>,
    weights: &Weights,
) -> Fit<'a> {
    // the lower limit of a parameter can be another parameter; at this limit, lowering the parameter does not change
    // the readings, so its derivative is taken as zero
    let resting = (0..model.len()).filter(|p| model.rests(*p, &point.u));
    resting.for_each(|p| jacobian.fill_column(p, 0.0));
    let normal = normal(forward, model.calibrated(), &point.u, &point.predicted, &jacobian, weights);
    let mut curvature = normal.curvature;
    let mut evidence = -0.5 * point.objective;
    for (i, parameter) in model.free_parameters().enumerate() {
        let p = model.calibrated() + i;
        let width = parameter.width(point.u[p]);
        // a uniform prior of this width has the variance width² / 12; adding its reciprocal keeps the evidence finite
        // where the data say nothing
        curvature[(p, p)] += 12.0 / (width * width);
        evidence += 0.5 * libm::log(TAU) - libm::log(width);
    }
    let determinant = Cholesky::new(curvature.clone())
        .map_or(f64::INFINITY, |c| 2.0 * c.l().diagonal().iter().map(|d| libm::log(*d)).sum::<f64>());
    evidence -= 0.5 * determinant;
    Fit { model: model.clone(), point, jacobian, curvature, evidence }
}

impl Fit<'_> {
    /// Leverage of each datum: the fraction of its variance that the fitted parameters absorb, `wJᵢC(wJᵢ)ᵀ`, with its
    /// weight `w`, its row `Jᵢ` of the derivatives and the covariance `C` of the parameters. It is 0 for a datum that
    /// is left out.
    pub fn leverages(&self, weights: &Weights) -> Vec<f64> {
        let n = self.curvature.nrows();
        let Some(cholesky) = Cholesky::new(self.curvature.clone()) else {
            return vec![0.0; self.jacobian.nrows()];
        };
        let root =
            cholesky.l().solve_lower_triangular(&DMatrix::identity(n, n)).unwrap_or(DMatrix::zeros(n, n));
        let reach = &self.jacobian * root.transpose();
        let rows = reach.row_iter().zip(&weights.inverse);
        rows.map(|(row, w)| (row.norm_squared() * w * w).min(1.0)).collect()
    }

    /// Residuals, measured minus predicted, in the standard deviations of `weights`; 0 for a datum that is left out.
    pub fn residuals(&self, forward: &Forward, weights: &Weights) -> Vec<f64> {
        forward
            .data
            .iter()
            .zip(&self.point.predicted)
            .zip(&weights.inverse)
            .map(|((d, p), w)| (d.value - p) * w)
            .collect()
    }
}

/// The curvature of half the objective without most of the prior of the effects' parameters. This prior has a finite
/// width for the sake of the evidence only, and it must not narrow the intervals. About a hundredth of it remains, so
/// that the matrix is regular.
pub fn data_curvature(fit: &Fit) -> DMatrix<f64> {
    let mut curvature = fit.curvature.clone();
    for (i, parameter) in fit.model.free_parameters().enumerate() {
        let p = fit.model.calibrated() + i;
        curvature[(p, p)] -= 11.9 / parameter.width(fit.point.u[p]).powi(2);
    }
    curvature
}
