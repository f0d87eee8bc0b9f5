//! Values of a model of positions with their 95 % intervals. An interval may reach further on one side of the value
//! than on the other, because compliances outside the model cannot be negative.

use super::deflection::FRAME_ENTRIES;
use super::springs::frame_matrix;
use crate::reconcile::model::estimate::{Estimate, Z_95};

/// The value with its 95 % interval. `reach` is the distance of the lower and of the upper end from the value, each
/// divided by [`Z_95`]. An end is `None` if its distance is infinite.
pub(super) fn within(value: f64, reach: [f64; 2]) -> Estimate {
    let [below, above] = reach.map(|reach| Z_95 * reach);
    let end = |end: f64| Some(end).filter(|e| e.is_finite());
    Estimate { value, low: end(value - below), high: end(value + above) }
}

/// Stiffness with its 95 % interval \[N m/rad\], as the reciprocal of a compliance. `reach` is the distance of each end
/// of the compliance's interval from its value, divided by [`Z_95`] \[rad/(N m)\]. An end is `None` where the
/// compliance may be zero.
pub(super) fn stiffness(compliance: f64, reach: [f64; 2]) -> Estimate {
    let [below, above] = reach.map(|reach| Z_95 * reach);
    reciprocal(Estimate { value: compliance, low: Some(compliance - below), high: Some(compliance + above) })
}

/// Stiffness with its interval \[N m/rad\], as the reciprocal of a compliance. An end is `None` where the compliance may be
/// zero.
pub(super) fn reciprocal(compliance: Estimate) -> Estimate {
    let end = |c: f64| (c > 0.0).then(|| 1.0 / c);
    Estimate {
        value: end(compliance.value).unwrap_or(1e15),
        low: compliance.high.and_then(end),
        high: compliance.low.and_then(end),
    }
}

/// The compliances of a frame as parameters of its effect, with 95 % intervals \[rad/(N m)\]. A compliance that is not
/// fitted, because no weight loads it, has an interval without ends.
pub(super) fn frame_parameters(compliances: &[f64], reaches: &[[f64; 2]]) -> Vec<(String, Vec<Estimate>)> {
    let matrix = frame_matrix(compliances);
    let entry = |at: (usize, usize)| {
        let known = FRAME_ENTRIES[..compliances.len()].iter().position(|e| *e == at);
        within(matrix[at], known.map_or([f64::INFINITY; 2], |k| reaches[k]))
    };
    // no element turns against its load, so the diagonal has no negative entry
    let turning = |at: (usize, usize)| {
        let found = entry(at);
        Estimate { low: found.low.map(|low| low.max(0.0)), ..found }
    };
    vec![
        ("diagonal_rad_per_nm".into(), [(0, 0), (1, 1), (2, 2)].map(turning).to_vec()),
        ("coupling_rad_per_nm".into(), [(0, 1), (0, 2), (1, 2)].map(entry).to_vec()),
    ]
}
