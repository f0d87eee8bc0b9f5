//! Confirms a model on whole poses that are held out of the fit (cross-validation).
//!
//! The poses are divided into four folds. Each fold in turn is held out, the model is refitted to the rest, and the
//! fold is predicted. The effects stay the same. Their sizes and the calibration are fitted again. Only the break
//! points of gear curves keep their values. All rows of a pose belong to the same fold, because they share a history
//! and a reference reading. Bench rows belong to no pose and stay in every fit. If there are only bench rows, every
//! fourth row belongs to the same fold.

use super::descent::{Effort, Fit, descent};
use super::weights::{Weights, robust_factor};
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::model::parameters::Model;
use nalgebra::{Cholesky, DMatrix};
use rayon::prelude::*;

/// Number of folds into which the poses are divided. One fold is held out at a time.
const FOLDS: usize = 4;

/// Root mean squares of held-out residuals. Unless a field says otherwise, their unit is the declared standard
/// deviation times the factor by which the readings scatter more than declared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldOut {
    /// Root mean square of the held-out residuals without any effect, with the calibration refitted.
    pub rms_before: f64,
    /// Root mean square of the held-out residuals with the effects.
    pub rms_after: f64,
    /// Root mean square of the held-out residuals with the effects, in declared standard deviations.
    pub rms_declared_after: f64,
    /// Number of measured values that were held out and predicted.
    pub count: usize,
}

/// The fold to which a datum belongs; `None` if it stays in every fit.
pub(crate) fn fold_of(forward: &Forward, datum: usize) -> Option<usize> {
    let group = match forward.groups.is_empty() {
        true => datum,
        false => Some(forward.data[datum].group).filter(|group| *group != usize::MAX)?,
    };
    Some(group % FOLDS)
}

/// Residual of every datum: the measured value minus the prediction by a fit without the fold of the datum \[declared
/// standard deviations\]. Each of these fits starts from the parameters `u` of the full fit. Break points of gear
/// curves keep their values. `None` for data that are in no fold, and for data that `weights` leaves out.
pub(crate) fn residuals(forward: &Forward, model: &Model, u: &[f64], weights: &Weights) -> Vec<Option<f64>> {
    // A frequency jumps where a torque passes a break point. If the break points were free, a held-out test close to a
    // break point would be predicted from either side by chance.
    let mut model = model.clone();
    model.held = model.break_points().into_iter().map(|p| (p, u[p])).collect();
    let model = &model;
    let folds: Vec<Vec<(usize, f64)>> = (0..FOLDS)
        .into_par_iter()
        .map(|fold| {
            let out = |i: usize| fold_of(forward, i) == Some(fold);
            let mut kept = weights.clone();
            (0..forward.data.len()).filter(|&i| out(i)).for_each(|i| kept.inverse[i] = 0.0);
            // the start is close to the minimum, so a few steps are enough
            let effort = Effort { steps: 6, tolerance: 0.05 };
            let end = descent(forward, model, u, &kept, effort, f64::INFINITY);
            (0..forward.data.len())
                .filter(|&i| out(i) && weights.inverse[i] > 0.0)
                .map(|i| {
                    let datum = &forward.data[i];
                    (i, (datum.value - end.predicted[i]) / datum.sigma)
                })
                .collect()
        })
        .collect();
    let mut all = vec![None; forward.data.len()];
    for (i, r) in folds.into_iter().flatten() {
        all[i] = Some(r);
    }
    all
}

/// Root mean square that the residuals of held-out poses are expected to have if the model of `fit` is right \[standard
/// deviations of `weights`\]. It is 1 if the other poses determine every parameter as well as all poses do. It is much
/// larger if the poses of one fold alone show something, because a fit without them knows nothing of it. Break points
/// keep their values, as in [`residuals`]. If the curvature is singular, the result is 1 too.
///
/// The computation is exact to first order. `w` are the weights (reduced for large residuals), `J` the derivatives of
/// the predicted readings, `L` the Cholesky factor of the curvature, and `r` the residuals of the full fit. The data of
/// a fold have the block `H = M Mᵀ` of the hat matrix, with the rows `M = w J L⁻ᵀ`. A fit without them leaves the
/// residuals `(I - H)⁻¹ r` on them, whose covariance is `(I - H)⁻¹`. By Woodbury's formula its diagonal is that of
/// `I + M (I - Mᵀ M)⁻¹ Mᵀ`.
pub(crate) fn expected_rms(forward: &Forward, fit: &Fit, weights: &Weights) -> f64 {
    // a parameter that only this fold determines makes I - MᵀM singular; with this addition it has a large finite
    // variance
    const RIDGE: f64 = 1e-9;
    let held = fit.model.break_points();
    let free: Vec<usize> = (0..fit.curvature.nrows()).filter(|p| !held.contains(p)).collect();
    let identity = DMatrix::<f64>::identity(free.len(), free.len());
    let curvature = fit.curvature.select_rows(&free).select_columns(&free);
    let Some(root) = Cholesky::new(curvature).and_then(|factor| factor.l().solve_lower_triangular(&identity))
    else {
        return 1.0;
    };
    let reach = fit.jacobian.select_columns(&free) * root.transpose();
    // the curvature gives large residuals less weight, so the rows of M must have the same weights
    let factors: Vec<f64> = fit.residuals(forward, weights).iter().map(|r| robust_factor(*r)).collect();
    let mut variances = Vec::new();
    for fold in 0..FOLDS {
        let is_own = |i: &usize| fold_of(forward, *i) == Some(fold) && weights.inverse[*i] > 0.0;
        let own: Vec<usize> = (0..forward.data.len()).filter(is_own).collect();
        let block = DMatrix::from_fn(own.len(), free.len(), |row, p| {
            factors[own[row]] * weights.inverse[own[row]] * reach[(own[row], p)]
        });
        let left = &identity * (1.0 + RIDGE) - block.tr_mul(&block);
        let Some(inverse) = Cholesky::new(left).map(|factor| factor.inverse()) else { return 1.0 };
        let spread = &block * inverse;
        variances.extend((0..own.len()).map(|row| 1.0 + spread.row(row).dot(&block.row(row))));
    }
    rms(variances.into_iter().map(f64::sqrt))
}

/// Root mean square of the residuals, in their unit; 0 for an empty list.
pub(crate) fn rms(residuals: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = residuals.fold((0.0, 0.0), |(s, n), r| (s + r * r, n + 1.0));
    if count == 0.0 { 0.0 } else { f64::sqrt(sum / count) }
}
