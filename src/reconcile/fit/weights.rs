//! Weights of the data in a fit, and Huber's loss of a residual.

use crate::reconcile::forward::prepared::Forward;

/// Residual beyond which Huber's loss grows linearly \[standard deviations\].
const HUBER_SIGMAS: f64 = 4.0;

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

/// Factor on a residual \[standard deviations\] and on its row in iteratively reweighted least squares. It is 1 up to
/// [`HUBER_SIGMAS`]. A larger residual has the weight `HUBER_SIGMAS / |r|`, and the factor is the root of this weight.
pub(crate) fn robust_factor(residual: f64) -> f64 {
    if residual.abs() <= HUBER_SIGMAS { 1.0 } else { (HUBER_SIGMAS / residual.abs()).sqrt() }
}

/// Huber's loss of a residual \[standard deviations\].
pub(super) fn loss(r: f64) -> f64 {
    let size = r.abs();
    if size <= HUBER_SIGMAS { r * r } else { 2.0 * HUBER_SIGMAS * size - HUBER_SIGMAS * HUBER_SIGMAS }
}
