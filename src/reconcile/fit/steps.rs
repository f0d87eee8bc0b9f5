//! Fits models whose frequencies step.
//!
//! A joint swings with the slope of its gear's curve at the torque of the test. Where the torque is close to a break
//! point, the masses within their tolerance decide on which side it lies, and the frequencies step when it crosses. No
//! descent sees past a step. So the steps are smoothed at first and then sharpened, and the descent begins from more
//! than one point.

use super::descent::{Effort, Fit, Weights, descent, fit};
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::model::parameters::Model;

/// Widths of smoothing of a gear's curve \[ln of the torque\], in the order of the descents. The wide one lets a descent
/// see past the steps of the frequencies. The narrow one leaves the steps nearly sharp.
pub(crate) const WIDE: f64 = 0.1;
pub(crate) const NARROW: f64 = 0.01;
const WIDTHS: [f64; 3] = [WIDE, 0.03, NARROW];

/// A torque this close to a break point may lie on either side \[ln of the torque\]: five standard deviations of masses
/// with a tolerance of 4 %.
const CLOSE: f64 = 0.1;

/// The point from which a sharp descent starts, after descents with the steps smoothed.
pub(crate) fn smoothed_start(forward: &Forward, model: &Model, start: &[f64], weights: &Weights) -> Vec<f64> {
    let mut model = model.clone();
    let few = Effort { steps: 8, tolerance: 0.05 };
    WIDTHS.into_iter().fold(start.to_vec(), |u, width| {
        model.smoothing = width;
        descent(forward, &model, &u, weights, few, f64::INFINITY).u
    })
}

/// Fits a model from each of the starts, and returns the best fit. Where a test is close to a break point of a gear's
/// curve, the steps are also smoothed at first.
pub(crate) fn best_fit<'a>(
    forward: &Forward,
    model: &Model<'a>,
    starts: &[Vec<f64>],
    weights: &Weights,
    effort: Effort,
) -> Fit<'a> {
    let of_start = |start: &Vec<f64>| {
        let steps = forward.is_close_to_a_step(&model.coefficients(forward, start), CLOSE);
        let smoothed = steps.then(|| smoothed_start(forward, model, start, weights));
        [Some(start.clone()), smoothed].into_iter().flatten()
    };
    let fits = starts.iter().flat_map(of_start).map(|u| fit(forward, model, &u, weights, effort));
    fits.min_by(|a, b| a.point.objective.total_cmp(&b.point.objective)).expect("at least one start")
}
