//! Chooses the model of the corrected arm if no known effect explains the readings. The models are the arm as it was
//! given, the calibrated arm, the arm with the best known effects, and arms with laws without a name. The model with
//! the smallest error on held-out readings is taken, and the simplest one if errors are about equal. The readings of
//! whole poses are held out, or bench readings if there are no others.
//!
//! The verdict stays `unexplained`: a model that predicts better is no explanation.

use super::fitted;
use super::outcome::Row;
use crate::arm::effect::empirical::KIND;
use crate::reconcile::fit::descent::{Fit, Weights};
use crate::reconcile::fit::held_out::{self, rms};
use crate::reconcile::fit::interval::intervals;
use crate::reconcile::fit::noise::Noise;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::model::estimate::Finding;
use crate::reconcile::model::parameters::Candidate;
use crate::reconcile::select::added_laws::with_laws;
use crate::reconcile::select::empirical;
use crate::reconcile::select::search::Search;
use std::sync::Arc;

/// A model with more parameters is taken only if it lowers the error on held-out readings by more than this fraction
/// compared with the simpler one.
const LEAST_IMPROVEMENT: f64 = 0.02;

/// The models that the corrected arm could have, as a table, and the one that was chosen.
pub(crate) struct Choice<'a> {
    /// All models that were compared, the simplest first.
    pub rows: Vec<Row>,
    /// The fit of the chosen model; `None` if the arm as it was given was chosen.
    pub fit: Option<Fit<'a>>,
    /// The campaign prepared in the poses about which this model was fitted; `None` for the stated poses.
    pub forward: Option<Arc<Forward>>,
}

impl Choice<'_> {
    /// The effects and laws of `fit`, the chosen model, with 95 % intervals. `stated` is the campaign prepared in the
    /// stated poses.
    pub(crate) fn findings(&self, fit: &Fit, stated: &Forward, weights: &Weights) -> Vec<Finding> {
        let forward = self.forward.as_deref().unwrap_or(stated);
        fitted::effects(fit, &intervals(forward, fit, weights), &[])
    }
}

/// Chooses the model of the corrected arm. `baseline` is the calibrated model, and `named` the model with the best
/// known effects, `named_effects`. The laws without a name are the candidates of `search` from the index `first_law`
/// on. `noise` scales the declared standard deviations of the held-out errors.
pub(crate) fn choose<'a>(
    search: &Search<'a>,
    first_law: usize,
    noise: &Noise,
    baseline: Fit<'a>,
    named: Fit<'a>,
    named_effects: &[usize],
) -> Choice<'a> {
    // the laws of angles whose zero is off need these slopes
    search.forward.turn_slopes(search.campaign);
    let mut rows = vec![row("the arm as it was given".into(), nominal_rms(search, noise))];
    let mut fits = vec![(None, None)];
    let mut add = |fit: Fit<'a>, forward: Option<Arc<Forward>>| {
        let about = forward.as_deref().unwrap_or(search.forward);
        rows.push(row(in_words(&fit), fit_rms(about, search.weights, noise, &fit)));
        fits.push((Some(fit), forward));
    };
    let starts = [search.scored(&[], &baseline), search.scored(named_effects, &named)];
    add(baseline, None);
    let has_names = !named_effects.is_empty();
    if has_names {
        add(named, None);
    }
    for start in starts.iter().take(if has_names { 2 } else { 1 }) {
        for with in with_laws(search, first_law, start) {
            add(with.fit(search), with.forward);
        }
    }
    let chosen = simplest_of_the_best(&rows);
    rows[chosen].is_written = true;
    let (fit, forward) = fits.swap_remove(chosen);
    Choice { rows, fit, forward }
}

fn row(model: String, kept_out_rms_sigma: f64) -> Row {
    Row { model, kept_out_rms_sigma, is_written: false }
}

/// Index of the chosen row: starting with the simplest model, a later row is taken whenever its error is lower than the
/// error of the row taken so far by more than [`LEAST_IMPROVEMENT`].
fn simplest_of_the_best(rows: &[Row]) -> usize {
    let mut chosen = 0;
    for (i, row) in rows.iter().enumerate() {
        if row.kept_out_rms_sigma < (1.0 - LEAST_IMPROVEMENT) * rows[chosen].kept_out_rms_sigma {
            chosen = i;
        }
    }
    chosen
}

/// The model of `fit` in words: calibration, and the effects and laws in it.
fn in_words(fit: &Fit) -> String {
    let effect = |candidate: &&Candidate| match candidate.kind.name {
        name if name == KIND.name => empirical::in_words(candidate),
        _ => candidate.label(),
    };
    let effects: Vec<String> = fit.model.effects.iter().map(effect).collect();
    match effects.is_empty() {
        true => "calibrated within tolerance".into(),
        false => format!("calibrated, with {}", effects.join(" and ")),
    }
}

/// Root mean square of the residuals of the arm as it was given \[standard deviations, scaled by `noise`\]. It is
/// taken over the same readings as the held-out errors of the fits.
fn nominal_rms(search: &Search, noise: &Noise) -> f64 {
    let forward = search.forward;
    let predicted = forward.predict(&forward.coefficients(&forward.nominal));
    let counted = (0..forward.data.len())
        .filter(|&i| held_out::fold_of(forward, i).is_some() && search.weights.inverse[i] > 0.0);
    rms(counted.map(|i| {
        let datum = &forward.data[i];
        (datum.value - predicted[i]) / datum.sigma / noise.scale[datum.channel as usize]
    }))
}

/// Root mean square of the residuals of the model `fit`, predicted with their folds held out \[standard deviations,
/// scaled by `noise`\]. `forward` has the poses about which the model was fitted.
fn fit_rms(forward: &Forward, weights: &Weights, noise: &Noise, fit: &Fit) -> f64 {
    let residuals = held_out::residuals(forward, &fit.model, &fit.point.u, weights);
    let each = residuals.iter().zip(&forward.data);
    rms(each.filter_map(|(r, d)| Some((*r)? / noise.scale[d.channel as usize])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_models_that_predict_alike_the_simplest_is_written() {
        let rows = |rms: &[f64]| rms.iter().map(|r| row(String::new(), *r)).collect::<Vec<_>>();
        assert_eq!(simplest_of_the_best(&rows(&[5.0, 4.0, 3.95, 1.2, 1.19])), 3);
        // a model that predicts worse than the arm as it was given is not written
        assert_eq!(simplest_of_the_best(&rows(&[1.0, 3.0, 0.99])), 0);
    }
}
