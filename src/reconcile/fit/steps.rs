//! Fits models whose frequencies jump.
//!
//! A joint vibrates with the slope of its gear's torsion curve at the torque of the test. If the torque is close to a
//! break point, a change of masses within their tolerance moves the torque across the break point, and the frequencies
//! jump. A descent cannot pass a jump. So the curve is smoothed at first and then sharpened step by step, and the
//! descent starts from more than one point.

use super::descent::{Effort, Fit, descent, fit};
use super::weights::Weights;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::model::parameters::Model;

/// Width over which the jumps of slope of a gear's curve are smoothed in the first descent \[ln of the torque\]. It is
/// so wide that the descent can pass the jumps of the frequencies.
pub(crate) const WIDE_SMOOTHING: f64 = 0.1;
/// Width over which the jumps of slope of a gear's curve are smoothed in the last descent \[ln of the torque\]. The
/// jumps are then nearly sharp.
pub(crate) const NARROW_SMOOTHING: f64 = 0.01;
/// Widths of the smoothing in three successive descents \[ln of the torque\].
const SMOOTHING_WIDTHS: [f64; 3] = [WIDE_SMOOTHING, 0.03, NARROW_SMOOTHING];

/// A torque is close to a break point if the logarithm of their ratio is at most this in magnitude. The true torque may
/// then lie on either side of the break point. The value corresponds to five standard deviations of masses with a
/// tolerance of 4 %.
const CLOSE_TO_BREAK: f64 = 0.1;

/// Starting parameters for a fit with the exact torsion curve: the end of three descents from `start`, in which the
/// curve is smoothed less and less.
pub(crate) fn smoothed_start(forward: &Forward, model: &Model, start: &[f64], weights: &Weights) -> Vec<f64> {
    let mut model = model.clone();
    let few = Effort { steps: 8, tolerance: 0.05 };
    SMOOTHING_WIDTHS.into_iter().fold(start.to_vec(), |u, width| {
        model.smoothing = width;
        descent(forward, &model, &u, weights, few, f64::INFINITY).u
    })
}

/// Fits a model from each of the `starts` and returns the fit with the lowest objective. If the torque of a test is
/// close to a break point of a gear's curve, each start is also tried with the curve smoothed at first.
pub(crate) fn best_fit<'a>(
    forward: &Forward,
    model: &Model<'a>,
    starts: &[Vec<f64>],
    weights: &Weights,
    effort: Effort,
) -> Fit<'a> {
    let of_start = |start: &Vec<f64>| {
        let steps = forward.is_close_to_a_step(&model.coefficients(forward, start), CLOSE_TO_BREAK);
        let smoothed = steps.then(|| smoothed_start(forward, model, start, weights));
        [Some(start.clone()), smoothed].into_iter().flatten()
    };
    let fits = starts.iter().flat_map(of_start).map(|u| fit(forward, model, &u, weights, effort));
    fits.min_by(|a, b| a.point.objective.total_cmp(&b.point.objective)).expect("at least one start")
}
