//! Offers an effect in series with a part that calibration moved farther than faultless parts deviate.
//!
//! A compliance that the arm file lacks can look like a part that is softer than drawn, and a missing mass like a heavier
//! joint. The prior of the calibrated factor makes up for a part of the difference in the evidence only. So where a factor
//! is rare, the effects at its place are fitted again from the nominal part.

use super::caution;
use super::fitted;
use super::judgement::WEAK_EVIDENCE;
use crate::arm::effect::kind::Place;
use crate::arm::structure::Piece;
use crate::reconcile::fit::descent::Effort;
use crate::reconcile::model::calibration::Calibration;
use crate::reconcile::model::parameters::Candidate;
use crate::reconcile::select::screening::MOST_EFFECTS;
use crate::reconcile::select::search::{Scored, Search};
use rayon::prelude::*;

/// An effect is at the place of a part if it is at most this many elements of the chain away, such as the base below the
/// column of the first joint.
const NEAR: usize = 2;

/// A model in which one more effect takes the place of a rare calibrated factor.
pub(crate) struct InSeries {
    /// The model with the further effect, which comes last.
    pub model: Scored,
    /// Rise of the score by the further effect \[ln of the evidence\].
    pub gain: f64,
    /// The further effect with its place.
    label: String,
    /// The calibrated factors without the further effect, in words.
    without: String,
}

impl InSeries {
    /// The best model with one more effect than `base`, at the place of a rare calibrated factor of `base`, in which no
    /// factor is rare. `None` if no factor is rare, if no effect is such, or if it makes the model clearly less probable.
    pub(crate) fn of_rare_factors(search: &Search, base: &Scored) -> Option<Self> {
        let calibrated = search.nuisance.numbers.len();
        let rare: Vec<usize> = (0..calibrated).filter(|k| caution::is_rare(base.u[*k])).collect();
        if rare.is_empty() || base.effects.len() >= MOST_EFFECTS {
            return None;
        }
        let mut nominal = base.clone();
        rare.iter().for_each(|k| nominal.u[*k] = 0.0);
        let places: Vec<&str> = rare.iter().flat_map(|k| places(&search.nuisance.numbers[*k].0)).collect();
        let screened = search.screen_among(&nominal, |candidate| is_near(search, candidate, &places));
        let fits = screened.into_par_iter().map(|start| {
            let effects = [base.effects.as_slice(), &[start.candidate]].concat();
            search.scored(&effects, &search.fit(&effects, &start.u, Effort::default()))
        });
        let mut fits: Vec<Scored> = fits.collect();
        fits.retain(|model| !caution::has_rare(&model.u[..calibrated]));
        let model = fits.into_iter().max_by(|a, b| a.score.total_cmp(&b.score))?;
        let gain = model.score - base.score;
        let fit = search.fit(&base.effects, &base.u, Effort { steps: 0, tolerance: 0.0 });
        let without = caution::rare_words(fitted::tolerances(&fit), &fitted::calibrated(&fit));
        let label = search.candidates[*model.effects.last()?].label();
        (gain > -WEAK_EVIDENCE).then_some(Self { model, gain, label, without })
    }

    /// Sentence that the further effect is only suspected.
    pub(crate) fn sentence(&self) -> String {
        format!(
            "without {} calibration has {}. {} takes that up, and ln of the evidence changes by {:+.1} with it: it is a \
             suspect. Take the next test before relying on it",
            self.label, self.without, self.label, self.gain
        )
    }
}

/// Names of the elements of the chain to which a calibrated factor belongs.
fn places(calibration: &Calibration) -> Vec<&str> {
    match calibration {
        Calibration::Stiffness(joint) | Calibration::Mass(joint) => vec![joint],
        Calibration::Bearing { joint, .. }
        | Calibration::Drive { joint, .. }
        | Calibration::Guide { joint, .. } => {
            vec![joint]
        }
        Calibration::Modulus(_, links) => links.iter().map(String::as_str).collect(),
    }
}

/// Whether a candidate is at, or next to, one of the elements of the chain named `places`.
fn is_near(search: &Search, candidate: &Candidate, places: &[&str]) -> bool {
    let structure = &search.forward.nominal.structure;
    let index = |name: &str| structure.pieces.iter().position(|piece: &Piece| piece.name() == name);
    // the base is one element before the first
    let own = match structure.place(&candidate.at, candidate.kind.places) {
        Some(Place::Base) => Some(0),
        _ => index(&candidate.at).map(|at| at + 1),
    };
    let is_near = |name: &&str| {
        let (Some(own), Some(at)) = (own, index(name)) else { return false };
        own.abs_diff(at + 1) <= NEAR
    };
    places.iter().any(is_near)
}
