//! Adds laws without a name to a model, one after the other. After each addition, all parameters of the model are
//! fitted again.
//!
//! If the zero of an angle is off in a model, the fit needs poses that are prepared with this zero. The poses are
//! prepared again until the zero no longer changes.

use super::search::{Scored, Search};
use super::unnamed::with_columns;
use crate::reconcile::fit::descent::{Effort, Fit, change, fit};
use crate::reconcile::fit::noise::Noise;
use crate::reconcile::fit::normal::Shared;
use crate::reconcile::fit::weights::Weights;
use crate::reconcile::forward::prepared::Forward;
use rayon::prelude::*;
use std::sync::Arc;

/// Largest number of laws without a name in one model.
const MOST_LAWS: usize = 4;
/// A law is accepted if the logarithm of the evidence, less the logarithm of the number of places where a law is
/// tried, rises by more than this.
const LEAST_GAIN: f64 = 2.0;
/// Number of laws that are fitted by a few steps when one is to be added: those that are the best ones if readings are taken
/// as linear.
const ROUGH_FITS: usize = 12;
/// When a law is to be added, this many laws are fitted in full. They are those with the best scores after a few steps
/// of a fit.
const FULL_FITS: usize = 5;
/// Largest number of times that the poses of a model are prepared again.
const MOST_TURNS: usize = 6;
/// Poses need not be prepared again if the arm is turned by less than this from the prepared pose \[deg\]. The readings
/// are linear in so small an angle.
const LARGEST_TURN_DEG: f64 = 1e-3;
/// The effort of a fit that only evaluates a model.
const NO_STEPS: Effort = Effort { steps: 0, tolerance: 0.0 };

/// A model with laws without a name.
#[derive(Clone)]
pub(crate) struct WithLaws {
    /// The fitted model. Its score belongs to the weights `weights`.
    pub scored: Scored,
    /// The campaign prepared in the poses about which the model was fitted; `None` for the stated poses.
    pub forward: Option<Arc<Forward>>,
    /// The weights of the fit: those of the search, with the standard deviations of each channel enlarged to the root mean
    /// square of the residuals that the model leaves there.
    pub weights: Arc<Weights>,
}

impl WithLaws {
    /// The model `scored`, which was fitted about the poses of `forward`, fitted with the weights that belong to it.
    ///
    /// Something is missing in the model, so it leaves more than noise. With the declared standard deviations, the readings
    /// would push the calibration as far out of its tolerance as it takes to imitate what is missing, and the channel with
    /// the smallest standard deviations would decide alone.
    pub(crate) fn new(search: &Search, scored: &Scored, forward: Option<Arc<Forward>>) -> Self {
        let about = Search { forward: forward.as_deref().unwrap_or(search.forward), ..*search };
        let point = about.fit(&scored.effects, &scored.u, NO_STEPS).point;
        let weights = Arc::new(Noise::enlarged(search.weights, about.forward, &point.predicted));
        let weighed = Search { weights: &weights, ..*search };
        Self { weights: Arc::clone(&weights), ..fitted(&weighed, &scored.effects, &scored.u, forward) }
    }

    /// The search `search`, with the campaign prepared in the poses of this model.
    fn about<'s>(&'s self, search: &Search<'s>) -> Search<'s> {
        Search { forward: self.forward.as_deref().unwrap_or(search.forward), ..*search }
    }

    /// The fit of this model.
    pub(crate) fn fit<'a>(&self, search: &Search<'a>) -> Fit<'a> {
        let forward = self.forward.as_deref().unwrap_or(search.forward);
        let model = search.model(&self.scored.effects);
        fit(forward, &model, &self.scored.u, &self.weights, NO_STEPS)
    }
}

/// The model `from` with one law without a name, with two, and so on, as long as each raises the score by more than
/// [`LEAST_GAIN`]; then the last of these models with a law left out or exchanged, if that raises the score. The laws
/// are the candidates of `search` from the index `first` on. Empty if no law raises the score.
pub(crate) fn with_laws(search: &Search, first: usize, from: &WithLaws) -> Vec<WithLaws> {
    let mut out: Vec<WithLaws> = Vec::new();
    let mut here = from.clone();
    for _ in 0..MOST_LAWS {
        let weighed = Search { weights: &here.weights, ..*search };
        let least = here.scored.score + LEAST_GAIN;
        let next = next_law(&weighed, first, &here, None).filter(|next| next.scored.score > least);
        let Some(next) = next else { break };
        let next = WithLaws::new(search, &next.scored, next.forward.clone());
        out.push(next.clone());
        here = next;
    }
    if out.len() > 1 {
        let weighed = Search { weights: &here.weights, ..*search };
        let better = exchanged(&weighed, first, &here);
        out.extend(better.map(|model| WithLaws::new(search, &model.scored, model.forward.clone())));
    }
    out
}

/// The best model with a law of `best` left out, or exchanged for another one; `None` if no such model scores higher
/// than `best`. A law that was found while another law was still missing may describe a part of the missing law.
fn exchanged(search: &Search, first: usize, best: &WithLaws) -> Option<WithLaws> {
    let about = best.about(search);
    let laws = (0..best.scored.effects.len()).filter(|effect| best.scored.effects[*effect] >= first);
    let tried = laws.flat_map(|law| {
        let (effects, u) = about.without(&best.scored, law);
        let without = fitted(search, &effects, &u, best.forward.clone());
        let exchanged = next_law(search, first, &without, Some(best.scored.effects[law]));
        [Some(without), exchanged].into_iter().flatten()
    });
    let better = tried.max_by(|a, b| a.scored.score.total_cmp(&b.scored.score))?;
    (better.scored.score > best.scored.score + 1e-3).then_some(better)
}

/// The model `here` with that law added that gives the best score; `None` if no law is left. The law `left_out` is not tried:
/// with it the model is known.
fn next_law(search: &Search, first: usize, here: &WithLaws, left_out: Option<usize>) -> Option<WithLaws> {
    let (about, from) = (here.about(search), &here.scored);
    let is_new = |law: &usize| Some(*law) != left_out && !from.effects.contains(law);
    let starts = promising_starts(&about, from, (first..search.candidates.len()).filter(is_new));
    let mut tried: Vec<Scored> = starts
        .into_par_iter()
        .map(|(law, start)| {
            let effects = [from.effects.as_slice(), &[law]].concat();
            let u = [from.u.as_slice(), start].concat();
            about.scored(&effects, &about.rough(&effects, &u))
        })
        .collect();
    tried.sort_by(|a, b| b.score.total_cmp(&a.score));
    let mut promising: Vec<Scored> = Vec::new();
    for one in tried {
        if promising.len() < FULL_FITS && promising.iter().all(|other| other.effects != one.effects) {
            promising.push(one);
        }
    }
    let fits: Vec<WithLaws> =
        promising.par_iter().map(|s| fitted(search, &s.effects, &s.u, here.forward.clone())).collect();
    fits.into_iter().max_by(|a, b| a.scored.score.total_cmp(&b.scored.score))
}

/// The laws that lower the objective of the model `from` most if its readings are taken as linear, each with the values from
/// which its fits start. There are [`ROUGH_FITS`] laws at most.
fn promising_starts<'s>(
    about: &Search<'s>,
    from: &Scored,
    laws: impl Iterator<Item = usize>,
) -> Vec<(usize, &'s Vec<f64>)> {
    let fit = about.fit(&from.effects, &from.u, NO_STEPS);
    let shared = Shared::new(about.forward, &fit.point.predicted, fit.jacobian.clone(), about.weights);
    let starts = laws.flat_map(|law| about.candidates[law].starts.iter().map(move |start| (law, start)));
    let starts: Vec<(usize, &Vec<f64>)> = starts.collect();
    let evidence = |(law, start): &(usize, &Vec<f64>)| {
        let columns = columns(about, from, &fit, *law, start);
        with_columns(about.forward, &fit, &shared, &columns, about.weights).1
    };
    let evidences: Vec<f64> = starts.par_iter().map(evidence).collect();
    let mut order: Vec<usize> = (0..starts.len()).collect();
    order.sort_by(|a, b| evidences[*b].total_cmp(&evidences[*a]));
    let mut best: Vec<usize> = Vec::new();
    for law in order.into_iter().map(|i| starts[i].0) {
        if best.len() < ROUGH_FITS && !best.contains(&law) {
            best.push(law);
        }
    }
    starts.into_iter().filter(|(law, _)| best.contains(law)).collect()
}

/// For each number of the law `law` that says how large the law is, the change of every reading per unit of it about the
/// model `from`, whose fit is `fit`. The other numbers of the law stay at `start`.
fn columns(about: &Search, from: &Scored, fit: &Fit, law: usize, start: &[f64]) -> Vec<Vec<f64>> {
    const DERIVATIVE_STEP: f64 = 1e-4;
    let model = about.model(&[from.effects.as_slice(), &[law]].concat());
    let u = [from.u.as_slice(), start].concat();
    let changed = |u: &[f64]| change(about.forward, &model, &fit.point, u);
    let at_start = changed(&u);
    let free = about.candidates[law].free_parameters.iter().enumerate();
    let column = |(k, _)| {
        let mut moved = u.clone();
        moved[from.u.len() + k] += DERIVATIVE_STEP;
        changed(&moved).iter().zip(&at_start).map(|(to, from)| (to - from) / DERIVATIVE_STEP).collect()
    };
    free.filter(|(_, parameter)| parameter.is_size()).map(column).collect()
}

/// The model with the effects `effects`, fitted from the parameters `u` with the poses of `forward`. If the fitted
/// zeros differ from those of these poses, the fit is repeated with poses that are prepared with the fitted zeros.
fn fitted(search: &Search, effects: &[usize], u: &[f64], forward: Option<Arc<Forward>>) -> WithLaws {
    let fit_about = |u: &[f64], forward: &Option<Arc<Forward>>| {
        let about = Search { forward: forward.as_deref().unwrap_or(search.forward), ..*search };
        let fit = about.fit(effects, u, Effort::default());
        (about.scored(effects, &fit), fit.point.coefficients.turned_deg)
    };
    let mut forward = forward;
    let (mut scored, mut turned_deg) = fit_about(u, &forward);
    for _ in 0..MOST_TURNS {
        if turned_deg.iter().all(|turn| turn.abs() < LARGEST_TURN_DEG) {
            break;
        }
        let subject = search.model(effects).subject(search.forward, &scored.u);
        forward = Some(Arc::new(search.forward.turned(search.campaign, &subject)));
        (scored, turned_deg) = fit_about(&scored.u, &forward);
    }
    WithLaws { scored, forward, weights: Arc::new(search.weights.clone()) }
}
