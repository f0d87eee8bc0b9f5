//! Confirmation on whole poses kept out of the fit.
//!
//! The poses are dealt into four hands. Each hand in turn is kept out, the model refitted to the rest
//! (its effects as selected, their values and the calibration anew, only break points held), and the hand predicted. Rows
//! of one pose are never split: they share a history and a reference reading. Bench rows belong to no
//! pose and stay in every fit.

use super::descent::{Effort, Weights, descent};
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::model::parameters::Model;
use rayon::prelude::*;

/// Hands the poses are dealt into.
const HANDS: usize = 4;

/// Root mean square of kept-out residuals, in standard deviations: the declared ones times the scale
/// that the readings showed (1 unless the report says otherwise).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KeptOut {
    /// Without any effect, calibration refitted.
    pub rms_before: f64,
    /// With the effects.
    pub rms_after: f64,
    /// With the effects, in the standard deviations as declared.
    pub rms_declared_after: f64,
    /// Numbers that were predicted.
    pub count: usize,
}

/// Residuals of every datum when its pose is kept out \[declared standard deviations\]; `None` for data
/// that never are.
pub fn residuals(forward: &Forward, model: &Model, u: &[f64], weights: &Weights) -> Vec<Option<f64>> {
    // a frequency steps where a torque passes a break point: held, else a kept-out test on the step
    // would be predicted from either side by chance
    let mut model = model.clone();
    model.held = model.break_points().into_iter().map(|p| (p, u[p])).collect();
    let model = &model;
    let hands: Vec<Vec<(usize, f64)>> = (0..HANDS)
        .into_par_iter()
        .map(|hand| {
            let out = |i: usize| forward.data[i].group != usize::MAX && forward.data[i].group % HANDS == hand;
            let mut kept = weights.clone();
            (0..forward.data.len()).filter(|&i| out(i)).for_each(|i| kept.inverse[i] = 0.0);
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

/// Root mean square of those that are there.
pub fn rms(residuals: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = residuals.fold((0.0, 0.0), |(s, n), r| (s + r * r, n + 1.0));
    if count == 0.0 { 0.0 } else { f64::sqrt(sum / count) }
}
