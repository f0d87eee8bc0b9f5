//! The interval of the torque scale of a joint's play.

use super::analysis::Positions;
use super::fit::fit;
use super::fitted::{Fitted, Sample};
use crate::reconcile::model::estimate::Estimate;
use rayon::prelude::*;

/// Fall of the logarithm of the likelihood at the ends of a 95 % interval: half of the 95 % quantile of chi-squared
/// with one degree of freedom.
const FALL: f64 = 1.92;

impl Positions {
    /// Torque scale `scale_nm` of the play that is effect number `position`, with its 95 % interval \[N m\]. An end is
    /// the nearest of the tried scales with which the logarithm of the likelihood is lower by [`FALL`] or more; `None`
    /// if no tried scale on this side lowers it so much.
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
