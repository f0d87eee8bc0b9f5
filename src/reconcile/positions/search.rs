//! Which candidates yield: each is screened by the model made linear, the most promising are fitted in full,
//! and what is worth its price stays if poses kept out of the fit confirm it.

use super::analysis::Positions;
use super::fit::{Fitted, Sample, fit, ln_likelihood, normal, scale};
use super::normal::Factor;
use super::structure::squares;
use crate::arm::effect::kind::Yields;
use crate::reconcile::readings::campaign::Campaign;
use nalgebra::{DMatrix, Vector3};
use rayon::prelude::*;

/// Candidates that are fitted in full at each stage.
pub const FULL_FITS: usize = 4;
/// Models within this ln of the likelihood cannot be told apart.
pub const TIE: f64 = 3.0;

impl Positions {
    /// Adds the effect of a class that raises the likelihood most, if it is worth its price and poses kept
    /// out confirm it; drops what it makes needless.
    pub(crate) fn add(&mut self, campaign: &Campaign, class: Yields) -> bool {
        let base = &self.fitted;
        let tried = self.best_additions(base, |c| self.candidates[c].yields == class);
        let gain = |(_, f): &(usize, Fitted)| {
            f.ln_likelihood - self.prices(&f.effects) - (base.ln_likelihood - self.prices(&base.effects))
        };
        let worth = tried.into_iter().filter(|t| gain(t) > 0.0);
        let Some((added, fitted)) = worth.max_by(|a, b| gain(a).total_cmp(&gain(b))) else { return false };
        let next = Self { fitted, ..self.clone() };
        self.take_if_confirmed(campaign, next, self.label(added))
    }

    /// Becomes the next model, without what it makes needless, if that is worth its price and predicts poses kept out better.
    pub(crate) fn take_if_confirmed(&mut self, campaign: &Campaign, mut next: Self, added: String) -> bool {
        next.settle(campaign);
        if next.score() <= self.score() {
            return false;
        }
        let dropped = |e: &&usize| !next.fitted.effects.contains(e);
        let dropped: Vec<String> =
            self.fitted.effects.iter().filter(dropped).map(|e| self.label(*e)).collect();
        next.stage(added, dropped);
        let confirmed = next.kept_out_ln_likelihood() > self.kept_out_ln_likelihood();
        if confirmed {
            *self = next;
        }
        confirmed
    }

    fn kept_out_ln_likelihood(&self) -> f64 {
        ln_likelihood(&self.kept_out, scale(&self.kept_out, self.fitted.scale_m))
    }

    /// Fits anew, with what gravity does to the geometry as fitted, until nothing is needless.
    fn settle(&mut self, campaign: &Campaign) {
        loop {
            self.refresh(campaign);
            self.refit();
            let before = self.fitted.effects.len();
            self.drop_needless();
            if self.fitted.effects.len() == before {
                return;
            }
        }
    }

    /// Drops effects, the most needless first, that are no longer worth their price.
    fn drop_needless(&mut self) {
        let all: Vec<&Sample> = self.samples.iter().collect();
        loop {
            let without = |position: usize| {
                let mut rest = self.fitted.effects.clone();
                let own = rest.remove(position);
                let fitted = fit(&all, &self.numbers, &rest, &self.fitted);
                (fitted.ln_likelihood + self.price_of(own) - self.fitted.ln_likelihood, fitted)
            };
            let doubtful: Vec<usize> =
                (0..self.fitted.effects.len()).filter(|&i| self.is_doubtful(i)).collect();
            let tried: Vec<_> = doubtful.into_par_iter().map(without).collect();
            let needless = tried.into_iter().filter(|(gain, _)| *gain > 0.0);
            let Some((_, fitted)) = needless.max_by(|a, b| a.0.total_cmp(&b.0)) else { return };
            self.fitted = fitted;
        }
    }

    /// Whether an effect may not be worth its price: by its compliances over their deviations, generously.
    fn is_doubtful(&self, position: usize) -> bool {
        let price = self.price_of(self.fitted.effects[position]);
        let numbers = self.fitted.compliances[position].iter().zip(&self.fitted.deviations[position]);
        // an effect that can stand for another has large deviations
        let is_small = |(c, deviation): (&f64, &f64)| 0.5 * (c / deviation).powi(2) < 2.0 * price;
        // beside what is held at the edge of being a spring the deviations are too small
        let is_held = self.fitted.deviations.iter().flatten().any(|d| !d.is_finite());
        is_held || numbers.into_iter().all(is_small)
    }

    pub(crate) fn label(&self, candidate: usize) -> String {
        format!("{}@{}", self.candidates[candidate].effect, self.candidates[candidate].at)
    }

    /// ln of the likelihood less the price of all that yields or turns unevenly.
    fn score(&self) -> f64 {
        let uneven = self.transmissions.len() as f64 * self.transmission_price();
        self.fitted.ln_likelihood - self.prices(&self.fitted.effects) - uneven
    }

    /// What effects must bring together.
    fn prices(&self, effects: &[usize]) -> f64 {
        effects.iter().map(|effect| self.price_of(*effect)).sum()
    }

    /// What a candidate must bring.
    fn price_of(&self, candidate: usize) -> f64 {
        let places = self.considered.iter().filter(|considered| **considered).count();
        self.price(self.candidates[candidate].count(), places)
    }

    /// What so many numbers must bring in ln of the likelihood: for themselves, and for having looked at so
    /// many places.
    pub(crate) fn price(&self, numbers: usize, places: usize) -> f64 {
        let readings = 3.0 * self.samples.len() as f64;
        0.5 * numbers as f64 * readings.ln() + (places as f64).ln() + 3.0
    }

    /// Models with one more effect: all allowed ones screened by the model made linear, the most promising
    /// fitted in full.
    fn best_additions(&self, base: &Fitted, allowed: impl Fn(usize) -> bool) -> Vec<(usize, Fitted)> {
        let all: Vec<&Sample> = self.samples.iter().collect();
        let mut gains = self.gains(base);
        let is_open = |c: usize| self.considered[c] && allowed(c) && !base.effects.contains(&c);
        gains.retain(|(c, gain)| is_open(*c) && *gain > 0.0);
        gains.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        gains.truncate(FULL_FITS);
        let models = gains.into_iter().flat_map(|(c, _)| self.with(base, c).into_iter().map(move |m| (c, m)));
        let models: Vec<(usize, Vec<usize>)> = models.collect();
        models.into_par_iter().map(|(c, effects)| (c, fit(&all, &self.numbers, &effects, base))).collect()
    }

    /// The effects of a model and one more; and the same without those that it can do alone, beside which it has hardly a
    /// size.
    fn with(&self, base: &Fitted, added: usize) -> Vec<Vec<usize>> {
        let contains =
            |effect: &usize| self.tree.contains(&self.candidates[added], &self.candidates[*effect]);
        let beside = [base.effects.as_slice(), &[added]].concat();
        let instead: Vec<usize> = beside.iter().copied().filter(|effect| !contains(effect)).collect();
        if instead.len() < beside.len() { vec![beside, instead] } else { vec![beside] }
    }

    /// By how much the model made linear says each candidate would raise the ln of the likelihood.
    fn gains(&self, base: &Fitted) -> Vec<(usize, f64)> {
        let from_level = base.geometry.level_to_instrument();
        let columns = |s: &Sample| -> Vec<Vector3<f64>> {
            s.sag.per_compliance.iter().flatten().map(|p| from_level * p * base.geometry.gravity).collect()
        };
        let counts: Vec<usize> = self.candidates.iter().map(|c| c.count()).collect();
        self.linear_gains(base, &columns, &counts).into_iter().enumerate().collect()
    }

    /// Gain in ln of the likelihood of each block of `counts` further columns. A single number is a
    /// compliance: it does not gain where it would be negative.
    pub(crate) fn linear_gains(
        &self,
        base: &Fitted,
        columns: &dyn Fn(&Sample) -> Vec<Vector3<f64>>,
        counts: &[usize],
    ) -> Vec<f64> {
        let all: Vec<&Sample> = self.samples.iter().collect();
        let normal = normal(&all, &self.numbers, base, columns);
        let own: Vec<usize> = (0..normal.own).collect();
        let Some(factor) = Factor::new(&normal.curvature, &own) else { return vec![0.0; counts.len()] };
        let answer = factor.solve(&normal.gradient.rows(0, normal.own).into_owned());
        let mut first = normal.own;
        let gain = |&count: &usize| {
            let at = first;
            first += count;
            let cross = normal.curvature.view((0, at), (normal.own, count)).into_owned();
            let answered: Vec<_> = (0..count).map(|k| factor.solve(&cross.column(k).into_owned())).collect();
            let whole = normal.curvature.view((at, at), (count, count)).into_owned();
            let left = &whole - cross.transpose() * DMatrix::from_columns(&answered);
            let gradient = normal.gradient.rows(at, count) - cross.transpose() * &answer;
            let is_seen = left.diagonal().max() > 1e-9 * whole.diagonal().max();
            if !is_seen || (count == 1 && gradient[0] <= 0.0) {
                0.0
            } else {
                0.5 * squares(&left, &gradient).0
            }
        };
        counts.iter().map(gain).collect()
    }

    /// Candidates of as many numbers that could stand in the place of one of the effects and fit as well.
    pub(crate) fn rivals(&self, position: usize) -> Vec<(usize, Fitted)> {
        let all: Vec<&Sample> = self.samples.iter().collect();
        let own = self.fitted.effects[position];
        let count = self.candidates[own].count();
        let rest: Vec<usize> = self.fitted.effects.iter().copied().filter(|e| *e != own).collect();
        let without = fit(&all, &self.numbers, &rest, &self.fitted);
        let mut tried = self.best_additions(&without, |c| c != own && self.candidates[c].count() <= count);
        tried.retain(|(_, f)| f.ln_likelihood > self.fitted.ln_likelihood - TIE);
        tried
    }
}
