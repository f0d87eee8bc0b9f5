//! Play in joints, as absolute positions show it: a joint lags by its half width in the sense of its torque, and by less
//! where the torque is small, `h tanh(T/T_c)`.
//!
//! For a given torque scale `T_c` the half width enters like a compliance. So the scale is chosen out of a few, and the
//! half width is fitted.

use super::analysis::Positions;
use super::fit::fit;
use super::fitted::{Fitted, Sample};
use super::loads::Yielding;
use crate::arm::effect::kind::Yields;
use crate::arm::effect::lost_motion;
use crate::reconcile::model::estimate::Estimate;
use rayon::prelude::*;

/// Torque scales that are tried, as parts of the largest torque on the joint.
const PARTS: [f64; 5] = [0.01, 0.03, 0.08, 0.2, 0.5];
/// Fall of ln of the likelihood at the ends of a 95 % interval.
const FALL: f64 = 1.92;

/// The candidates, and play in each joint that yields about its axis.
pub(crate) fn with_play(mut candidates: Vec<Yielding>, samples: &[Sample]) -> Vec<Yielding> {
    let is_joint = |c: &usize| candidates[*c].yields == Yields::AboutAxis;
    let largest_nm = |c: usize| samples.iter().map(|s| s.deflection.lever(c).1.abs()).fold(0.0, f64::max);
    let joints: Vec<(String, f64)> =
        (0..candidates.len()).filter(is_joint).map(|c| (candidates[c].at.clone(), largest_nm(c))).collect();
    // a torque of rounding errors has no scale
    for (at, largest_nm) in joints.into_iter().filter(|(_, largest_nm)| *largest_nm > 1e-6) {
        candidates.extend(PARTS.map(|part| Yielding {
            effect: lost_motion::KIND.name,
            yields: Yields::AboutAxis,
            at: at.clone(),
            play_nm: Some(part * largest_nm),
        }));
    }
    candidates
}

impl Positions {
    /// The torque scale of the play that is one of the effects: its ends are the nearest scales with which the readings are
    /// much less likely.
    pub(crate) fn play_scale(&self, position: usize, scale_nm: f64) -> Estimate {
        let own = &self.candidates[self.fitted.effects[position]];
        let is_variant = |c: &usize| {
            let other = &self.candidates[*c];
            other.play_nm.is_some() && other.at == own.at
        };
        let variants: Vec<usize> = (0..self.candidates.len()).filter(is_variant).collect();
        let all: Vec<&Sample> = self.samples.iter().collect();
        let unlikely = |c: &usize| {
            let mut effects = self.fitted.effects.clone();
            effects[position] = *c;
            let fitted: Fitted = fit(&all, &self.numbers, &effects, &self.fitted);
            fitted.ln_likelihood < self.fitted.ln_likelihood - FALL
        };
        let scales: Vec<f64> =
            variants.into_par_iter().filter(unlikely).filter_map(|c| self.candidates[c].play_nm).collect();
        Estimate {
            value: scale_nm,
            low: scales.iter().copied().filter(|nm| *nm < scale_nm).reduce(f64::max),
            high: scales.iter().copied().filter(|nm| *nm > scale_nm).reduce(f64::min),
        }
    }
}
