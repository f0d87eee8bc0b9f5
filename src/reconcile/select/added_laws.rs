//! Adds laws without a name to a model, one after the other. After each addition, all parameters of the model are
//! fitted again.
//!
//! If the zero of an angle is off in a model, the fit needs poses that are prepared with this zero. The poses are
//! prepared again until the zero no longer changes.

use super::search::{Scored, Search};
use crate::reconcile::fit::descent::{Effort, Fit, fit};
use crate::reconcile::forward::prepared::Forward;
use rayon::prelude::*;
use std::sync::Arc;

/// Largest number of laws without a name in one model.
const MOST_LAWS: usize = 3;
/// A law is accepted if the logarithm of the evidence, less the logarithm of the number of places where a law is
/// tried, rises by more than this.
const LEAST_GAIN: f64 = 2.0;
/// When a law is to be added, this many laws are fitted in full. They are those with the best scores after a few steps
/// of a fit.
const FULL_FITS: usize = 5;
/// Largest number of times that the poses of a model are prepared again.
const MOST_TURNS: usize = 6;
/// Poses need not be prepared again if the arm is turned by less than this from the prepared pose \[deg\]. The readings
/// are linear in so small an angle.
const LARGEST_TURN_DEG: f64 = 1e-3;

/// A model with laws without a name.
#[derive(Clone)]
pub(crate) struct WithLaws {
    /// The fitted model.
    pub scored: Scored,
    /// The campaign prepared in the poses about which the model was fitted; `None` for the stated poses.
    pub forward: Option<Arc<Forward>>,
}

impl WithLaws {
    /// The search `search`, with the campaign prepared in the poses of this model.
    fn about<'s>(&'s self, search: &Search<'s>) -> Search<'s> {
        Search { forward: self.forward.as_deref().unwrap_or(search.forward), ..*search }
    }

    /// The fit of this model.
    pub(crate) fn fit<'a>(&self, search: &Search<'a>) -> Fit<'a> {
        let forward = self.forward.as_deref().unwrap_or(search.forward);
        let model = search.model(&self.scored.effects);
        fit(forward, &model, &self.scored.u, search.weights, Effort { steps: 0, tolerance: 0.0 })
    }
}

/// The model `from` with one law without a name, with two, and so on, as long as each raises the score by more than
/// [`LEAST_GAIN`]; then the last of these models with a law left out or exchanged, if that raises the score. The laws
/// are the candidates of `search` from the index `first` on. Empty if no law raises the score.
pub(crate) fn with_laws(search: &Search, first: usize, from: &Scored) -> Vec<WithLaws> {
    let mut out: Vec<WithLaws> = Vec::new();
    let mut here = WithLaws { scored: from.clone(), forward: None };
    for _ in 0..MOST_LAWS {
        let least = here.scored.score + LEAST_GAIN;
        let Some(next) = next_law(search, first, &here).filter(|next| next.scored.score > least) else {
            break;
        };
        out.push(next.clone());
        here = next;
    }
    if out.len() > 1 {
        out.extend(exchanged(search, first, &here));
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
        let exchanged = next_law(search, first, &without);
        [Some(without), exchanged].into_iter().flatten()
    });
    let better = tried.max_by(|a, b| a.scored.score.total_cmp(&b.scored.score))?;
    (better.scored.score > best.scored.score + 1e-3).then_some(better)
}

/// The model `here` with that law added that gives the best score; `None` if no law is left.
fn next_law(search: &Search, first: usize, here: &WithLaws) -> Option<WithLaws> {
    let (about, from) = (here.about(search), &here.scored);
    let laws = (first..search.candidates.len()).filter(|law| !from.effects.contains(law));
    let starts: Vec<(usize, &Vec<f64>)> =
        laws.flat_map(|law| search.candidates[law].starts.iter().map(move |start| (law, start))).collect();
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
    WithLaws { scored, forward }
}
