//! Chooses the model of the corrected arm if no known effect explains the readings. The models are the arm as it was
//! given, the calibrated arm, the arm with the best known effects, and arms with laws without a name. The model with
//! the smallest error on held-out readings is taken, and the simplest one if errors are about equal. The readings of
//! whole poses are held out, or bench readings if there are no others.
//!
//! The verdict stays `unexplained`: a model that predicts better is no explanation.

use super::fitted;
use super::outcome::Row;
use crate::arm::effect::empirical::KIND;
use crate::reconcile::fit::descent::Fit;
use crate::reconcile::fit::held_out::{self, rms};
use crate::reconcile::fit::interval::intervals;
use crate::reconcile::fit::noise::Noise;
use crate::reconcile::fit::weights::Weights;
use crate::reconcile::forward::datum::Datum;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::model::estimate::Finding;
use crate::reconcile::model::parameters::{Candidate, Model};
use crate::reconcile::select::added_laws::{WithLaws, with_laws};
use crate::reconcile::select::empirical;
use crate::reconcile::select::search::{Scored, Search};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A model with more parameters is taken only if it predicts held-out readings better by more than this number of standard
/// errors of the difference: chance alone does so in one case of twenty.
const STANDARD_ERRORS: f64 = 1.645;

/// The models that the corrected arm could have, as a table, and the one that was chosen.
pub(crate) struct Choice<'a> {
    /// All models that were compared, the simplest first.
    pub rows: Vec<Row>,
    /// The fit of the chosen model; `None` if the arm as it was given was chosen.
    pub fit: Option<Fit<'a>>,
    /// The campaign prepared in the poses about which this model was fitted; `None` for the stated poses.
    pub forward: Option<Arc<Forward>>,
    /// The weights with which this model was fitted; `None` if the arm as it was given was chosen.
    pub weights: Option<Arc<Weights>>,
}

impl Choice<'_> {
    /// The effects and laws of `fit`, the chosen model, with 95 % intervals. `stated` is the campaign prepared in the
    /// stated poses.
    pub(crate) fn findings(&self, fit: &Fit, stated: &Forward, weights: &Weights) -> Vec<Finding> {
        let forward = self.forward.as_deref().unwrap_or(stated);
        fitted::effects(fit, &intervals(forward, fit, self.weights.as_deref().unwrap_or(weights)), &[])
    }
}

/// A model that is weighed for the corrected arm.
struct Weighed {
    /// The fitted model; `None` for the arm as it was given.
    model: Option<WithLaws>,
    /// Number of parameters of its effects.
    parameters: usize,
    /// Residual of every reading, predicted with its pose held out \[standard deviations, scaled by the noise\]; `None` for
    /// readings that are never held out.
    errors: Vec<Option<f64>>,
}

/// Chooses the model of the corrected arm. `baseline` is the calibrated model, and `named` the model with the best
/// known effects, `named_effects`. The laws without a name are the candidates of `search` from the index `first_law`
/// on. `noise` scales the declared standard deviations of the held-out errors.
pub(crate) fn choose<'a>(
    search: &Search<'a>,
    first_law: usize,
    noise: &Noise,
    baseline: &Fit<'a>,
    named: &Fit<'a>,
    named_effects: &[usize],
) -> Choice<'a> {
    // the laws of angles whose zero is off need these slopes
    search.forward.turn_slopes(search.campaign);
    let start = |effects: &[usize], fit: &Fit| WithLaws::new(search, &search.scored(effects, fit), None);
    let mut starts = vec![start(&[], baseline)];
    if !named_effects.is_empty() {
        starts.push(start(named_effects, named));
    }
    let mut models = starts.clone();
    models.extend(starts.iter().flat_map(|start| with_laws(search, first_law, start)));
    let mut weighed = vec![Weighed { model: None, parameters: 0, errors: given_errors(search, noise) }];
    let mut sets: Vec<Vec<usize>> = Vec::new();
    for model in models {
        let mut set = model.scored.effects.clone();
        set.sort_unstable();
        if !sets.contains(&set) {
            sets.push(set);
            weighed.push(weighed_with(search, noise, model));
        }
    }
    let chosen = simplest_of_the_best(search.forward, &weighed);
    let words = |w: &Weighed| match &w.model {
        Some(model) => in_words(&search.model(&model.scored.effects)),
        None => "the arm as it was given".into(),
    };
    let row = |(i, w): (usize, &Weighed)| Row {
        model: words(w),
        kept_out_rms_sigma: rms(w.errors.iter().flatten().copied()),
        is_written: i == chosen,
    };
    let rows = weighed.iter().enumerate().map(row).collect();
    let model = weighed.swap_remove(chosen).model;
    Choice {
        rows,
        fit: model.as_ref().map(|model| model.fit(search)),
        weights: model.as_ref().map(|model| Arc::clone(&model.weights)),
        forward: model.and_then(|model| model.forward),
    }
}

fn weighed_with(search: &Search, noise: &Noise, model: WithLaws) -> Weighed {
    let forward = model.forward.as_deref().unwrap_or(search.forward);
    let Scored { effects, u, .. } = &model.scored;
    let of_effects = search.model(effects);
    let errors = held_out::residuals(forward, &of_effects, u, &model.weights);
    let scaled = |(r, d): (Option<f64>, &Datum)| Some(r? / noise.scale[d.channel as usize]);
    let errors = errors.into_iter().zip(&forward.data).map(scaled).collect();
    Weighed { parameters: of_effects.free_parameters().count(), errors, model: Some(model) }
}

/// Index of the chosen model: the simplest one that predicts held-out readings as well as the best one does, within
/// [`STANDARD_ERRORS`]. Of equally simple ones, which are the arm as it was given and the calibrated one, it is the one that
/// predicts better: a calibration stays within what parts can be, and a law does not.
fn simplest_of_the_best(forward: &Forward, weighed: &[Weighed]) -> usize {
    let losses: Vec<f64> = weighed.iter().map(|w| loss(forward, &w.errors)).collect();
    let best = (0..weighed.len()).min_by(|a, b| losses[*a].total_cmp(&losses[*b])).unwrap_or(0);
    let is_as_good = |i: &usize| {
        let (lead, error) = lead(forward, &weighed[*i].errors, &weighed[best].errors);
        lead <= STANDARD_ERRORS * error
    };
    let as_good = (0..weighed.len()).filter(|i| *i == best || is_as_good(i));
    let order = |a: &usize, b: &usize| {
        weighed[*a].parameters.cmp(&weighed[*b].parameters).then(losses[*a].total_cmp(&losses[*b]))
    };
    as_good.min_by(order).unwrap_or(best)
}

/// Mean square of the errors of each channel with held-out readings, and their number.
fn mean_squares(forward: &Forward, errors: &[Option<f64>]) -> [(f64, f64); 4] {
    let mut out = [(0.0, 0.0); 4];
    for (error, datum) in errors.iter().zip(&forward.data) {
        let Some(error) = error else { continue };
        let (sum, count) = &mut out[datum.channel as usize];
        (*sum, *count) = (*sum + error * error, *count + 1.0);
    }
    out.map(|(sum, count)| (if count > 0.0 { sum / count } else { 0.0 }, count))
}

/// Minus the logarithm of the likelihood of held-out readings whose errors have an unknown standard deviation in each
/// channel. A channel whose standard deviations are declared too small does not decide alone.
fn loss(forward: &Forward, errors: &[Option<f64>]) -> f64 {
    let each = mean_squares(forward, errors).into_iter().filter(|(square, _)| *square > 0.0);
    each.map(|(square, count)| 0.5 * count * libm::log(square)).sum()
}

/// By how much the errors `best` have a smaller loss than the errors `other`, and the standard error of this difference.
/// Both follow from the differences pose by pose, because errors of one pose have causes in common.
fn lead(forward: &Forward, other: &[Option<f64>], best: &[Option<f64>]) -> (f64, f64) {
    let [of_other, of_best] = [other, best].map(|errors| mean_squares(forward, errors));
    let mut of_poses = BTreeMap::<usize, f64>::new();
    for (i, datum) in forward.data.iter().enumerate() {
        let (Some(other), Some(best)) = (other[i], best[i]) else { continue };
        let channel = datum.channel as usize;
        let mean = of_other[channel].0 + of_best[channel].0;
        // a bench alone has no poses
        let pose = if forward.groups.is_empty() { i } else { datum.group };
        *of_poses.entry(pose).or_default() += (other * other - best * best) / mean.max(f64::MIN_POSITIVE);
    }
    let count = of_poses.len() as f64;
    let sum: f64 = of_poses.values().sum();
    let square: f64 = of_poses.values().map(|own| (own - sum / count).powi(2)).sum();
    (sum, if count > 1.0 { f64::sqrt(square * count / (count - 1.0)) } else { f64::INFINITY })
}

/// A model in words: calibration, and the effects and laws in it.
fn in_words(model: &Model) -> String {
    let effect = |candidate: &&Candidate| match candidate.kind.name {
        name if name == KIND.name => empirical::in_words(candidate),
        _ => candidate.label(),
    };
    let effects: Vec<String> = model.effects.iter().map(effect).collect();
    match effects.is_empty() {
        true => "calibrated within tolerance".into(),
        false => format!("calibrated, with {}", effects.join(" and ")),
    }
}

/// Residuals of the arm as it was given \[standard deviations, scaled by `noise`\], of the same readings as the held-out
/// errors of the fits.
fn given_errors(search: &Search, noise: &Noise) -> Vec<Option<f64>> {
    let forward = search.forward;
    let predicted = forward.predict(&forward.coefficients(&forward.nominal));
    let error = |(i, datum): (usize, &Datum)| {
        held_out::fold_of(forward, i).filter(|_| search.weights.inverse[i] > 0.0)?;
        Some((datum.value - predicted[i]) / datum.sigma / noise.scale[datum.channel as usize])
    };
    forward.data.iter().enumerate().map(error).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalog::Catalogs;
    use crate::reconcile::readings::campaign::Campaign;
    use std::path::Path;

    #[test]
    fn of_models_that_predict_as_well_as_the_best_one_the_simplest_is_written() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/campaigns/plain-0251e");
        let forward = Forward::new(&Campaign::read(&folder, &Catalogs::default()).expect("sound"));
        // errors of this size in every pose, or in every second one only
        let weighed = |parameters: usize, even: f64, odd: f64| Weighed {
            model: None,
            parameters,
            errors: (forward.data.iter().enumerate())
                .map(|(i, d)| {
                    held_out::fold_of(&forward, i).map(|_| if d.group % 2 == 0 { even } else { odd })
                })
                .collect(),
        };
        let chosen = |models: &[Weighed]| simplest_of_the_best(&forward, models);
        // better in every pose
        assert_eq!(chosen(&[weighed(0, 4.0, 4.0), weighed(2, 3.9, 3.9)]), 1);
        // better in one half of the poses, worse by almost as much in the other
        assert_eq!(chosen(&[weighed(0, 4.0, 4.0), weighed(2, 3.0, 4.75)]), 0);
        // the best model is not the simplest of those that predict as well
        assert_eq!(chosen(&[weighed(0, 9.0, 9.0), weighed(4, 1.0, 1.01), weighed(2, 1.02, 0.995)]), 2);
        // a model that predicts worse than the arm as it was given is not written
        assert_eq!(chosen(&[weighed(0, 1.0, 1.0), weighed(2, 3.0, 3.0), weighed(4, 1.03, 0.96)]), 0);
        // a calibration is no law: it need only be better
        assert_eq!(chosen(&[weighed(0, 4.0, 4.0), weighed(0, 3.9, 4.08)]), 1);
    }
}
