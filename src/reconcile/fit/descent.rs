//! Fits a model: finds its most probable parameters within bounds, with Huber's loss.
//!
//! Residuals `r` are in standard deviations. The objective is `Σ ρ(r) + Σ u²`, where `ρ` is Huber's loss. The first sum
//! is over the data. The second is over the calibrated parameters, where each `u` is the deviation from nominal in
//! standard deviations of its tolerance. The parameters of effects are free within bounds.
//!
//! Steps are Levenberg-Marquardt steps with an active set at the bounds. The derivatives of frequencies are exact,
//! because solving for frequencies takes most of the time. Static and bench readings are cheap to compute and are
//! differentiated numerically.

use crate::mechanics::product::add_transposed_product;
use crate::reconcile::forward::coefficients::Coefficients;
use crate::reconcile::forward::modal::{ModalTest, Solved};
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::forward::statics::StaticState;
use crate::reconcile::model::parameters::Model;
use nalgebra::{Cholesky, DMatrix, DVector};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Residual beyond which Huber's loss grows linearly \[standard deviations\].
const HUBER_SIGMAS: f64 = 4.0;
/// Step of a parameter by which numerical derivatives are computed, in the scaled parameters `u`.
const DERIVATIVE_STEP: f64 = 1e-4;

/// Weights of the data in a fit: which data are used, and how much their declared standard deviations are enlarged.
#[derive(Debug, Clone)]
pub struct Weights {
    /// Reciprocal of each datum's standard deviation, which is the declared one times the factor of its channel; 0
    /// where the datum is left out.
    pub inverse: Vec<f64>,
    /// Whether only static and bench readings are used. Natural frequencies are then not computed.
    pub smooth_only: bool,
}

impl Weights {
    /// These weights with all frequencies left out, so that no modes are computed.
    pub fn without_modes(&self, forward: &Forward) -> Self {
        let mut out = self.clone();
        out.inverse[forward.starts[1]..forward.starts[2]].fill(0.0);
        out.smooth_only = true;
        out
    }
}

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

/// Factor on a residual \[standard deviations\] and on its row in iteratively reweighted least squares. It is 1 up to
/// [`HUBER_SIGMAS`]. A larger residual has the weight `HUBER_SIGMAS / |r|`, and the factor is the root of this weight.
pub(crate) fn robust_factor(residual: f64) -> f64 {
    if residual.abs() <= HUBER_SIGMAS { 1.0 } else { (HUBER_SIGMAS / residual.abs()).sqrt() }
}

fn loss(r: f64) -> f64 {
    let size = r.abs();
    if size <= HUBER_SIGMAS { r * r } else { 2.0 * HUBER_SIGMAS * size - HUBER_SIGMAS * HUBER_SIGMAS }
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

/// Gradient and curvature of half the objective (the normal equations of a step).
pub struct Normal {
    /// Gradient of half the objective, one entry per parameter.
    pub gradient: DVector<f64>,
    /// Curvature matrix of half the objective (Gauss-Newton).
    pub curvature: DMatrix<f64>,
}

/// Builds the normal equations at the parameters `u`, of which the first `calibrated` have a prior. `slopes` contains
/// the derivatives of the predicted readings. Residuals are predicted minus measured, times the weight of the datum.
/// Large residuals get less weight, as Huber's loss requires.
pub fn normal(
    forward: &Forward,
    calibrated: usize,
    u: &[f64],
    predicted: &[f64],
    slopes: &Slopes,
    weights: &Weights,
) -> Normal {
    let count = forward.data.len();
    let (mut factors, mut right) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for ((datum, predicted), weight) in forward.data.iter().zip(predicted).zip(&weights.inverse) {
        let residual = (predicted - datum.value) * weight;
        let robust = robust_factor(residual);
        factors.push(robust * weight);
        right.push(residual * robust);
    }
    let (mut gradient, mut curvature) =
        slopes.products(&DVector::from_vec(factors), &DVector::from_vec(right));
    for p in 0..calibrated {
        gradient[p] += u[p];
        curvature[(p, p)] += 1.0;
    }
    Normal { gradient, curvature }
}

/// Number of rows (data) whose products are computed together. These rows then stay in the processor's cache.
const ROWS_PER_BLOCK: usize = 256;

/// Derivatives of the predicted readings (rows) with respect to parameters (columns), as several matrices whose columns
/// follow one another. In this way, columns that many models have in common are not copied for each model.
pub struct Slopes<'a>(pub &'a [&'a DMatrix<f64>]);

impl Slopes<'_> {
    fn columns(&self) -> usize {
        self.0.iter().map(|part| part.ncols()).sum()
    }

    fn rows(&self) -> usize {
        self.0.first().map_or(0, |part| part.nrows())
    }

    /// Linearized changes of the predicted readings, one per datum, if the parameters change by `step`.
    pub fn times(&self, step: &DVector<f64>) -> Vec<f64> {
        let mut out = DVector::zeros(self.rows());
        for first in (0..self.rows()).step_by(ROWS_PER_BLOCK) {
            let count = ROWS_PER_BLOCK.min(self.rows() - first);
            let mut at = 0;
            for part in self.0 {
                let own = step.rows(at, part.ncols());
                out.rows_mut(first, count).gemv(1.0, &part.rows(first, count), &own, 1.0);
                at += part.ncols();
            }
        }
        out.data.into()
    }

    /// The products `Xᵀr` and `XᵀX`. The rows of `X` are the rows of these derivatives, each times its entry of
    /// `row_factors`; `r` is `right`.
    fn products(&self, row_factors: &DVector<f64>, right: &DVector<f64>) -> (DVector<f64>, DMatrix<f64>) {
        let width = self.columns();
        let (mut gradient, mut curvature) = (DMatrix::zeros(width, 1), DMatrix::zeros(width, width));
        let block = ROWS_PER_BLOCK.min(self.rows());
        let mut scaled = DMatrix::zeros(block, width);
        for first in (0..self.rows()).step_by(ROWS_PER_BLOCK) {
            let count = block.min(self.rows() - first);
            let factors = row_factors.rows(first, count);
            let own = self.0.iter().flat_map(|part| part.column_iter());
            for (mut to, column) in scaled.column_iter_mut().zip(own) {
                to.rows_mut(0, count).cmpy(1.0, &column.rows(first, count), &factors, 0.0);
            }
            let scaled = scaled.rows(0, count);
            add_transposed_product(&mut gradient, scaled, right.view((first, 0), (count, 1)));
            add_transposed_product(&mut curvature, scaled, scaled);
        }
        (gradient.column(0).into_owned(), curvature)
    }
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
        let normal =
            normal(forward, model.calibrated(), &here.u, &here.predicted, &Slopes(&[&slopes]), weights);
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
    let slopes = Slopes(&[&jacobian]);
    let normal = normal(forward, model.calibrated(), &point.u, &point.predicted, &slopes, weights);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_side_by_side_are_one_matrix() {
        let rows = 2 * ROWS_PER_BLOCK + 11;
        let whole = DMatrix::from_fn(rows, 5, |i, j| ((7 * i + 3 * j) % 11) as f64 - 5.0);
        let (left, right) = (whole.columns(0, 3).into_owned(), whole.columns(3, 2).into_owned());
        let parts = [&left, &right];
        let slopes = Slopes(&parts);
        let step = DVector::from_fn(5, |j, _| j as f64 - 1.0);
        assert_eq!(slopes.times(&step), (&whole * &step).as_slice());
        let factors = DVector::from_fn(rows, |i, _| (i % 4) as f64);
        let residual = DVector::from_fn(rows, |i, _| (i % 5) as f64 - 2.0);
        let scaled = DMatrix::from_fn(rows, 5, |i, j| factors[i] * whole[(i, j)]);
        let (gradient, curvature) = slopes.products(&factors, &residual);
        // whole numbers, so the order of the sums does not matter
        assert_eq!(gradient, scaled.tr_mul(&residual));
        assert_eq!(curvature, scaled.tr_mul(&scaled));
    }
}
