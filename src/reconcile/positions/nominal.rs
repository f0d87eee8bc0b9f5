//! Fits the stiffnesses, moduli and masses on which the deflection of the nominal arm depends.
//!
//! An arm whose file has compliances deflects under gravity in the nominal model too. A stiffness within its tolerance
//! changes this deflection, which is calibration. A mass at a joint, cables along a link or a link with another modulus
//! change it further. Without these in the model, such a change would look like compliances elsewhere. All changes are
//! small, so the deflection is linear in them. Its derivatives are difference quotients: the deflection is computed
//! once with each change.

use super::analysis::Positions;
use super::dependence::{Dependence, dependences};
use super::fit::likeliest;
use super::fitted::{Fitted, Sample};
use super::kinematics::Number;
use super::loads::{CompliantPlace, Loads};
use super::search::{FULL_FITS, TIE};
use crate::arm::effect::subject::Subject;
use crate::reconcile::readings::campaign::Campaign;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Step of a number for the difference quotient of the nominal deflection, in the unit of the number.
const STEP: f64 = 0.05;
/// A deflection, or a derivative of it, below this size is a rounding error \[m\].
const NOTHING_M: f64 = 1e-12;

impl Positions {
    /// Computes how the nominal deflection depends on stiffnesses, moduli and masses, and frees those that calibration
    /// adjusts within tolerance. If the arm is rigid in its file, it does not deflect, and the model stays as it is.
    pub(super) fn free_tolerances(&mut self, campaign: &Campaign) {
        let stated_m = self.deflections_m(campaign, &|_| {});
        if stated_m.iter().all(|by| by.norm() <= NOTHING_M) {
            return;
        }
        let all = dependences(campaign);
        // change of the deflection per unit of the number, in the level frame
        let changes_m = |dependence: &Dependence| -> Vec<Vector3<f64>> {
            let changed_m = self.deflections_m(campaign, &|subject| dependence.change(STEP, subject));
            changed_m.iter().zip(&stated_m).map(|(changed, stated)| (changed - stated) / STEP).collect()
        };
        let columns: Vec<Vec<Vector3<f64>>> = all.iter().map(changes_m).collect();
        let is_seen = |column: &[Vector3<f64>]| column.iter().any(|by| by.norm() > NOTHING_M);
        let (dependences, columns): (Vec<Dependence>, Vec<Vec<Vector3<f64>>>) =
            all.into_iter().zip(columns).filter(|(_, column)| is_seen(column)).unzip();
        for (i, sample) in self.samples.iter_mut().enumerate() {
            sample.nominal_m = columns.iter().map(|column| column[i]).collect();
        }
        self.fitted.geometry.dependences = vec![0.0; dependences.len()];
        let is_free = |k: &usize| matches!(dependences[*k], Dependence::Tolerance(..));
        let numbers: Vec<Number> = (0..dependences.len()).filter(is_free).map(Number::Tolerance).collect();
        self.dependences = dependences;
        if !numbers.is_empty() {
            self.numbers.extend(numbers);
            self.refit();
            self.stage("parts within tolerance".into(), Vec::new());
        }
    }

    /// For each sample, the deflection of the nominal arm after the change `change`, in the level frame \[m\].
    fn deflections_m(&self, campaign: &Campaign, change: &dyn Fn(&mut Subject)) -> Vec<Vector3<f64>> {
        let loads = Loads::changed(campaign, &self.tree, &self.fitted.geometry, &[], change);
        let rows = self.samples.par_iter().zip(&campaign.positions);
        rows.map(|(sample, row)| loads.known_m(row, sample.point)).collect()
    }

    /// Price of an effect on the nominal deflection \[ln of the likelihood\]: the rise of the logarithm of the
    /// likelihood that it must bring to stay in the model.
    pub(super) fn dependence_price(&self) -> f64 {
        let effects = self.dependences.iter().filter(|d| d.effect().is_some()).count();
        self.price(1, effects + self.springs())
    }

    /// Fits of the model with one more effect on the nominal deflection each. Each fit comes with the index of the
    /// effect among the dependences. All are screened with the linearized model, and the most promising are fitted in
    /// full, if they may raise the logarithm of the likelihood by `asked`.
    pub(super) fn best_dependences(&self, asked: f64) -> Vec<(usize, Fitted)> {
        let all: Vec<&Sample> = self.samples.iter().collect();
        let is_open =
            |k: &usize| self.dependences[*k].effect().is_some() && !self.named_dependences.contains(k);
        let open: Vec<usize> = (0..self.dependences.len()).filter(is_open).collect();
        if open.is_empty() {
            return Vec::new();
        }
        let from_level = self.fitted.geometry.level_to_instrument();
        let gains = self.linear_gains(&self.fitted, &vec![1; open.len()], true, &|sample, _, columns| {
            columns.extend(open.iter().map(|k| from_level * sample.nominal_m[*k]));
        });
        let mut order: Vec<(usize, f64)> = open
            .into_iter()
            .zip(gains)
            .filter(|(_, gain)| *gain > 0.0 && self.may_rise(*gain, asked))
            .collect();
        order.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        order.truncate(FULL_FITS);
        let with = |(k, _): (usize, f64)| {
            let numbers: Vec<Number> = self.numbers.iter().cloned().chain([Number::Effect(k)]).collect();
            (k, likeliest(&all, &numbers, &self.fitted.effects, &self.fitted))
        };
        let tried: Vec<(usize, Fitted)> = order.into_par_iter().map(with).collect();
        let is_possible =
            |(k, f): &(usize, Fitted)| self.dependences[*k].is_possible(f.geometry.dependences[*k]);
        tried.into_iter().filter(is_possible).collect()
    }

    /// The model with the dependence with index `k` added as an effect. `fitted` is its fit.
    pub(super) fn with_dependence(&self, k: usize, fitted: Fitted) -> Self {
        let mut next = Self { fitted, ..self.clone() };
        next.numbers.push(Number::Effect(k));
        next.named_dependences.push(k);
        next
    }

    /// The model without the effect that is the dependence with index `k`, fitted again.
    fn without_dependence(&self, k: usize) -> Self {
        let mut out = self.without_numbers(|number| *number == Number::Effect(k));
        out.fitted.geometry.dependences[k] = 0.0;
        out.named_dependences.retain(|named| *named != k);
        out.refit();
        out
    }

    /// Drops that effect on the nominal deflection whose gain is farthest below its price, if there is such an effect.
    /// Returns whether one was dropped.
    pub(super) fn drop_needless_dependence(&mut self) -> bool {
        let without = self.named_dependences.iter().map(|k| self.without_dependence(*k));
        let gain = |next: &Self| next.score() - self.score();
        let needless = without.filter(|next| gain(next) > 0.0);
        let Some(next) = needless.max_by(|a, b| gain(a).total_cmp(&gain(b))) else { return false };
        *self = next;
        true
    }

    /// Names and places of effects on the nominal deflection that would fit as well in the place of an effect of the
    /// model. `without` is the fit without this effect.
    pub(super) fn dependences_instead(&self, without: &Fitted) -> Vec<(String, String)> {
        let missing = self.missing(without);
        let without = Self { fitted: without.clone(), ..self.clone() };
        self.as_good(without.best_dependences(missing))
    }

    /// Names and places of effects that would fit as well in place of the effect that is the dependence with index `k`.
    pub(super) fn instead_of_dependence(&self, k: usize) -> Vec<(String, String)> {
        let without = self.without_dependence(k);
        let missing = self.missing(&without.fitted);
        let has_one = |c: usize| self.candidates[c].count() == 1;
        let springs = without.best_additions(&without.fitted, has_one, |_| missing);
        let as_good = springs.into_iter().filter(|(_, f)| f.ln_likelihood > self.fitted.ln_likelihood - TIE);
        let name = |c: &CompliantPlace| (c.effect.to_string(), c.at.clone());
        let springs: Vec<(String, String)> = as_good.map(|(c, _)| name(&self.candidates[c])).collect();
        let others = without.best_dependences(missing).into_iter().filter(|(other, _)| *other != k).collect();
        [self.as_good(others), springs].concat()
    }

    fn as_good(&self, tried: Vec<(usize, Fitted)>) -> Vec<(String, String)> {
        let good = tried.into_iter().filter(|(_, f)| f.ln_likelihood > self.fitted.ln_likelihood - TIE);
        let named = good.filter_map(|(k, _)| self.dependences[k].effect());
        named.map(|(kind, at)| (kind.name.to_string(), at.to_string())).collect()
    }
}
