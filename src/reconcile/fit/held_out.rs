//! Confirms a model on whole poses that are held out of the fit (cross-validation).
//!
//! The poses are divided into four folds. Each fold in turn is held out, the model is refitted to the rest, and the
//! fold is predicted. The effects stay the same. Their sizes and the calibration are fitted again. Only the break
//! points of gear curves keep their values. All rows of a pose belong to the same fold, because they share a history
//! and a reference reading. Bench rows belong to no pose and stay in every fit, unless there is nothing else: then
//! every fourth row of the bench is a fold.

use super::descent::{Effort, Weights, descent};
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::model::parameters::Model;
use rayon::prelude::*;

/// Number of folds into which the poses are divided. One fold is held out at a time.
const FOLDS: usize = 4;

/// Root mean squares of held-out residuals, in standard deviations. These are the declared standard deviations times
/// the factor by which the readings scatter more than declared, unless a field says otherwise.
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

/// Residual of every datum, predicted with its pose held out, measured minus predicted \[declared standard
/// deviations\]. `u` are the parameters of the full fit, from which each refit starts. `None` for data that are never
/// held out.
pub(crate) fn residuals(forward: &Forward, model: &Model, u: &[f64], weights: &Weights) -> Vec<Option<f64>> {
    // A frequency jumps where a torque passes a break point. If the break points were free, a held-out test close to a
    // break point would be predicted from either side by chance.
    let mut model = model.clone();
    model.held = model.break_points().into_iter().map(|p| (p, u[p])).collect();
    let model = &model;
    let hands: Vec<Vec<(usize, f64)>> = (0..FOLDS)
        .into_par_iter()
        .map(|hand| {
            let out = |i: usize| fold_of(forward, i) == Some(hand);
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
    for (i, r) in hands.into_iter().flatten() {
        all[i] = Some(r);
    }
    all
}

/// Root mean square of the residuals, in their unit; 0 for an empty list.
pub(crate) fn rms(residuals: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = residuals.fold((0.0, 0.0), |(s, n), r| (s + r * r, n + 1.0));
    if count == 0.0 { 0.0 } else { f64::sqrt(sum / count) }
}
