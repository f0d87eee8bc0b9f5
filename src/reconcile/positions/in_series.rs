//! Offers a compliance in series with a part that calibration moved farther than faultless parts deviate.
//!
//! The calibrated factors are free within wide bounds, so a compliance that looks like a soft part raises the likelihood
//! by nothing. It makes the rare factor unnecessary all the same.

use super::analysis::Positions;
use super::fitted::Fitted;
use super::search::TIE;
use crate::arm::BASE;
use crate::reconcile::model::estimate::Finding;
use crate::reconcile::verdict::caution;

/// A compliance is at the place of a part if it is at most this many pieces of the arm away.
const NEAR: usize = 2;

impl Positions {
    /// The compliance that best takes the place of the calibrated factors that are rare, with a sentence on it; `None` if
    /// no factor is rare, or if every compliance near such a part leaves it rare or makes the model clearly less
    /// probable.
    pub(super) fn in_series(&self) -> Option<(Finding, String)> {
        let rare = self.rare_words(&self.fitted);
        if rare.is_empty() {
            return None;
        }
        // the name of a factor begins with the name of its part
        let places: Vec<usize> = (0..self.tree.pieces.len())
            .filter(|i| rare.starts_with(&format!("{}.", self.tree.pieces[*i].name())))
            .collect();
        let is_near = |c: usize| {
            let at = &self.candidates[c].at;
            // the base is one piece before the first
            let own = match at.as_str() {
                BASE => Some(0),
                name => self.tree.pieces.iter().position(|p| p.name() == name).map(|i| i + 1),
            };
            own.is_some_and(|own| places.iter().any(|place| own.abs_diff(place + 1) <= NEAR))
        };
        let probable = |f: &Fitted| f.ln_likelihood - f.improbability(&self.numbers);
        let from = probable(&self.fitted);
        let fits = self.best_additions(&self.fitted, is_near, |_| f64::NEG_INFINITY).into_iter();
        let gain = |c: usize, f: &Fitted| probable(f) - from - self.prices(&[c]);
        let fits = fits.map(|(c, f)| (gain(c, &f), c, f));
        let mut fits: Vec<(f64, usize, Fitted)> =
            fits.filter(|(gain, _, f)| *gain > -TIE && self.rare_words(f).is_empty()).collect();
        fits.sort_by(|a, b| b.0.total_cmp(&a.0));
        let (gain, added, fitted) = fits.first()?;
        let position = fitted.effects.iter().position(|e| e == added)?;
        let next = Self { fitted: fitted.clone(), ..self.clone() };
        let mut finding = next.finding(position, &self.fitted, &[]);
        let others = fits[1..].iter().filter(|(other, ..)| *other > gain - TIE);
        finding.indistinguishable_from = others
            .map(|(_, c, _)| (self.candidates[*c].effect.to_string(), self.candidates[*c].at.clone()))
            .collect();
        let text = format!(
            "without {} calibration has {rare}. {} takes that up, and is a suspect. Take the next test before relying on it",
            finding.label(),
            finding.label()
        );
        Some((finding, text))
    }

    /// The calibrated factors of the fit `fitted` that are rare, in words; empty if there are none.
    fn rare_words(&self, fitted: &Fitted) -> String {
        caution::rare_words(self.tolerances(), &self.adjusted(fitted))
    }
}
