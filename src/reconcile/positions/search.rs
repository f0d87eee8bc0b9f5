//! Finds which candidates are compliant. Each candidate is screened with the linearized model, and the most promising
//! are fitted in full. The price of a candidate is a charge, in ln of the likelihood, for its parameters and for the
//! number of places examined. A candidate whose gain exceeds its price stays if held-out poses confirm it.

use super::analysis::Positions;
use super::fit::{fit, likeliest, ln_likelihood, scale};
use super::fitted::{Fitted, Miss, Sample, readings};
use super::normal::Factor;
use super::rows::{Further, normal};
use super::sessions::telling_part;
use super::shape::Shape;
use super::structure::squares;
use crate::arm::effect::kind::ElasticRotation;
use crate::reconcile::readings::campaign::Campaign;
use nalgebra::DMatrix;
use rayon::prelude::*;

/// Largest number of candidates that are fitted in full when one effect is to be added.
pub(crate) const FULL_FITS: usize = 4;
/// Models whose logarithms of the likelihood differ by less than this cannot be told apart.
pub(crate) const TIE: f64 = 3.0;

/// What may be added to the model: a candidate, or an effect on the nominal deflection, by its index.
enum Added {
    Spring(usize),
    Dependence(usize),
}

impl Positions {
    /// Adds the effect of the class `class` (kind of compliance) that raises the likelihood most, if the rise is
    /// worth the effect's price and held-out poses confirm it. Effects that become unnecessary are dropped. Returns
    /// whether an effect was added.
    pub(crate) fn add(&mut self, campaign: &Campaign, class: ElasticRotation) -> bool {
        let base = &self.fitted;
        let is_of_class = |c: usize| {
            let candidate = &self.candidates[c];
            candidate.rotation == class && candidate.shape.waves().is_none()
        };
        let springs = self.best_additions(base, is_of_class, |c| self.required_rise(base, c)).into_iter();
        let springs = springs.map(|(c, f)| {
            let gain =
                f.ln_likelihood - self.prices(&f.effects) - (base.ln_likelihood - self.prices(&base.effects));
            (gain, Added::Spring(c), f)
        });
        // a change of a mass or a modulus deflects the arm as springs do, so it competes with the first class of
        // springs
        let others = match class {
            ElasticRotation::AboutAxis => self.best_dependences(self.dependence_price()),
            _ => Vec::new(),
        };
        let price = self.dependence_price();
        let others = others
            .into_iter()
            .map(|(k, f)| (f.ln_likelihood - price - base.ln_likelihood, Added::Dependence(k), f));
        let worth = springs.chain(others).filter(|(gain, ..)| *gain > 0.0);
        let Some((_, added, fitted)) = worth.max_by(|a, b| a.0.total_cmp(&b.0)) else { return false };
        let (next, label) = match added {
            Added::Spring(c) => (Self { fitted, ..self.clone() }, self.label(c)),
            Added::Dependence(k) => (self.with_dependence(k, fitted), self.dependence_label(k)),
        };
        self.take_if_confirmed(campaign, next, label)
    }

    /// Replaces the current model of the positions by `next` if `next` has a clearly higher score (ln of the
    /// likelihood, less the prices of effects, transmission errors and undeclared sessions) and predicts held-out poses
    /// better. Effects of `next` that are not worth their price are dropped first. `added` names what `next` adds.
    /// Returns whether the model was replaced.
    pub(crate) fn take_if_confirmed(&mut self, campaign: &Campaign, mut next: Self, added: String) -> bool {
        next.settle(campaign);
        if next.score() - self.score() <= self.untelling_rise(&next) {
            return false;
        }
        next.refine_thresholds();
        // a spring that left the model may have been the mean about which a stiffness varies
        if !next.has_possible_waves(&next.fitted) {
            return false;
        }
        let dropped = |e: &&usize| !next.fitted.effects.contains(e);
        let mut dropped: Vec<String> =
            self.fitted.effects.iter().filter(dropped).map(|e| self.label(*e)).collect();
        let gone = self.named_dependences.iter().filter(|k| !next.named_dependences.contains(k));
        dropped.extend(gone.map(|k| self.dependence_label(*k)));
        next.stage(added, dropped);
        let confirmed = next.held_out_ln_likelihood() > self.held_out_ln_likelihood();
        if confirmed {
            *self = next;
        }
        confirmed
    }

    /// The part of the rise of the logarithm of the likelihood from this model to `next` that is due to chance. With
    /// few readings the likelihood rises with every further number by chance. This part is subtracted for the first
    /// effect only, because the first effect decides whether anything is missing at all; for others it is 0. A mass or a
    /// modulus on which the nominal deflection depends counts as an effect too.
    fn untelling_rise(&self, next: &Self) -> f64 {
        let is_without = self.fitted.effects.is_empty() && self.named_dependences.is_empty();
        if !is_without || !self.transmissions.is_empty() {
            return 0.0;
        }
        let count =
            |model: &Self| model.numbers.len() + model.fitted.compliances.iter().map(Vec::len).sum::<usize>();
        let new = count(next).saturating_sub(count(self));
        let telling = telling_part(&next.fitted, &next.numbers, &next.samples, new);
        (1.0 - telling) * (next.fitted.ln_likelihood - self.fitted.ln_likelihood).max(0.0)
    }

    fn held_out_ln_likelihood(&self) -> f64 {
        let held_out = self.samples.iter().zip(&self.held_out);
        let misses: Vec<Miss> = held_out.map(|(sample, error)| sample.miss(error)).collect();
        ln_likelihood(&misses, scale(&misses, self.fitted.scale_m))
    }

    /// Fits the model, with the deflection under gravity computed again for the geometry of the previous fit, and drops
    /// effects that are not worth their price. This is repeated until no effect is dropped.
    fn settle(&mut self, campaign: &Campaign) {
        loop {
            self.refresh(campaign);
            self.refit();
            let before = self.fitted.effects.len();
            self.drop_needless();
            if self.fitted.effects.len() == before && !self.drop_needless_dependence() {
                return;
            }
        }
    }

    /// Drops effects that are no longer worth their price (a charge in ln of the likelihood), the least useful first.
    /// The model is fitted again after each.
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

    /// Whether effect number `position` of the model may not be worth its price, judged by the ratios of its
    /// compliances to their standard deviations. The test selects too many effects rather than too few, because each
    /// selected one is then examined by a full fit.
    fn is_doubtful(&self, position: usize) -> bool {
        let price = self.price_of(self.fitted.effects[position]);
        let numbers = self.fitted.compliances[position].iter().zip(&self.fitted.deviations[position]);
        // an effect that other effects can replace has large standard deviations, so that it is examined too
        let is_small = |(c, deviation): (&f64, &f64)| 0.5 * (c / deviation).powi(2) < 2.0 * price;
        // if some compliance is fixed at its constraint, the standard deviations of the others are too small
        let is_held = self.fitted.deviations.iter().flatten().any(|d| !d.is_finite());
        is_held || numbers.into_iter().all(is_small)
    }

    pub(super) fn dependence_label(&self, k: usize) -> String {
        self.dependences[k].effect().map_or_else(String::new, |(kind, at)| format!("{}@{at}", kind.name))
    }

    pub(crate) fn label(&self, candidate: usize) -> String {
        format!("{}@{}", self.candidates[candidate].effect, self.candidates[candidate].at)
    }

    /// Score of the model: the logarithm of the likelihood, less the prices of all effects, transmission errors and
    /// undeclared sessions.
    pub(super) fn score(&self) -> f64 {
        let uneven = self.transmissions.len() as f64 * self.transmission_price();
        let dependent = self.named_dependences.len() as f64 * self.dependence_price();
        self.fitted.ln_likelihood
            - self.prices(&self.fitted.effects)
            - dependent
            - uneven
            - if self.drifts() { self.drift_price() } else { 0.0 }
            - self.sessions_price()
    }

    /// Sum of the prices of several candidates \[ln of the likelihood\].
    pub(super) fn prices(&self, effects: &[usize]) -> f64 {
        effects.iter().map(|effect| self.price_of(*effect)).sum()
    }

    /// Price of one candidate \[ln of the likelihood\]: the rise of the logarithm of the likelihood that it must
    /// bring to stay in the model.
    fn price_of(&self, candidate: usize) -> f64 {
        // a torque scale or preload was chosen too
        self.price(self.candidates[candidate].numbers(), self.springs().max(1))
    }

    /// Number of places where a spring may be named.
    pub(super) fn springs(&self) -> usize {
        let springs = self.candidates.iter().zip(&self.considered);
        springs.filter(|(c, considered)| **considered && c.shape == Shape::Spring).count()
    }

    /// Whether the candidates with the indices `a` and `b` are the same effect at the same place. They then differ in
    /// torque scale, preload or waves only.
    fn is_same(&self, a: usize, b: usize) -> bool {
        let [a, b] = [a, b].map(|c| &self.candidates[c]);
        (a.effect, &a.at) == (b.effect, &b.at)
    }

    /// Price of something with `numbers` parameters \[ln of the likelihood\]. It charges for the parameters, and for
    /// having looked at `places` places before one was chosen.
    pub(crate) fn price(&self, numbers: usize, places: usize) -> f64 {
        let readings = readings(&self.samples) as f64;
        0.5 * numbers as f64 * libm::log(readings) + libm::log(places as f64) + 3.0
    }

    /// Fits of the model `base` with one more effect each, for candidates for which `allowed` is true. All of these are
    /// screened with the linearized model, and the most promising are fitted in full: [`FULL_FITS`] of them, and one
    /// base that lifts off. Only candidates that may raise the logarithm of the likelihood by as much as `asked` says
    /// are fitted. Each fit comes with the index of the candidate that was added.
    pub(super) fn best_additions(
        &self,
        base: &Fitted,
        allowed: impl Fn(usize) -> bool,
        asked: impl Fn(usize) -> f64,
    ) -> Vec<(usize, Fitted)> {
        let all: Vec<&Sample> = self.samples.iter().collect();
        let is_in = |c: usize| base.effects.iter().any(|e| self.is_same(*e, c));
        let is_open = |c: &usize| self.considered[*c] && allowed(*c) && !is_in(*c) && self.can_vary(base, *c);
        let open: Vec<usize> = (0..self.candidates.len()).filter(is_open).collect();
        let mut gains = self.gains(base, open);
        gains.retain(|(c, gain)| *gain > 0.0 && self.may_rise(*gain, asked(*c)));
        let worth = |(c, gain): &(usize, f64)| gain - self.price_of(*c);
        gains.sort_by(|a, b| worth(b).total_cmp(&worth(a)).then(a.0.cmp(&b.0)));
        // of all torque scales, preloads or waves of one effect only the best is kept
        let mut seen: Vec<usize> = Vec::new();
        gains.retain(|(c, _)| {
            let is_first = !seen.iter().any(|s| self.is_same(*s, *c));
            seen.push(*c);
            is_first
        });
        // a base that lifts off must not displace other candidates
        let (mut springs, mut others): (Vec<_>, Vec<_>) =
            gains.into_iter().partition(|(c, _)| !matches!(self.candidates[*c].shape, Shape::Lift(_)));
        springs.truncate(FULL_FITS);
        others.truncate(1);
        springs.append(&mut others);
        let gains = springs;
        let models = gains.into_iter().flat_map(|(c, _)| self.with(base, c).into_iter().map(move |m| (c, m)));
        let models: Vec<(usize, Vec<usize>)> = models.collect();
        models
            .into_par_iter()
            .map(|(c, effects)| (c, likeliest(&all, &self.numbers, &effects, base)))
            .collect()
    }

    /// The rise of the logarithm of the likelihood that makes the candidate `added` worth adding to the model `base`.
    /// It is the price of the candidate, less the prices of the effects that it contains and may replace.
    pub(super) fn required_rise(&self, base: &Fitted, added: usize) -> f64 {
        let contained = |e: &&usize| self.tree.contains(&self.candidates[added], &self.candidates[**e]);
        self.price_of(added) - base.effects.iter().filter(contained).map(|e| self.price_of(*e)).sum::<f64>()
    }

    /// The rise of the logarithm of the likelihood that an alternative to an effect must bring to fit as well as the
    /// effect. The rise is counted from `without`, a fit of the model without the effect.
    pub(super) fn missing(&self, without: &Fitted) -> f64 {
        self.fitted.ln_likelihood - TIE - without.ln_likelihood
    }

    /// The sets of effects to fit if the candidate `added` joins the model `base`. The first set contains the model's
    /// effects and the added one. The second leaves out those effects that the added one contains, because in their
    /// presence the added effect would be close to zero.
    fn with(&self, base: &Fitted, added: usize) -> Vec<Vec<usize>> {
        let contains =
            |effect: &usize| self.tree.contains(&self.candidates[added], &self.candidates[*effect]);
        let both = [base.effects.as_slice(), &[added]].concat();
        let instead: Vec<usize> = both.iter().copied().filter(|effect| !contains(effect)).collect();
        if instead.len() < both.len() { vec![both, instead] } else { vec![both] }
    }

    /// For each of the candidates `open`, its index and the rise of the logarithm of the likelihood that the linearized
    /// model `base` expects from it.
    fn gains(&self, base: &Fitted, open: Vec<usize>) -> Vec<(usize, f64)> {
        if open.is_empty() {
            return Vec::new();
        }
        let from_level = base.geometry.level_to_instrument();
        let counts: Vec<usize> = open.iter().map(|c| self.candidates[*c].count()).collect();
        let gains = self.linear_gains(base, &counts, false, &|sample, _, columns| {
            for &candidate in &open {
                sample.deflection.per_compliance(candidate, &base.geometry.gravity, |by| {
                    columns.push(from_level * by);
                });
            }
        });
        open.iter().copied().zip(gains).collect()
    }

    /// Rise of the logarithm of the likelihood for each block of columns that is added to the linearized model `base`.
    /// `columns` computes the columns of all blocks, and `counts` gives the number of columns of each block. A block of
    /// a single column is a compliance, and its rise is 0 if the compliance would be negative. If `either_sign` is
    /// true, the numbers of all blocks may have either sign.
    pub(crate) fn linear_gains(
        &self,
        base: &Fitted,
        counts: &[usize],
        either_sign: bool,
        columns: Further,
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
            if !is_seen || (count == 1 && !either_sign && gradient[0] <= 0.0) {
                0.0
            } else {
                0.5 * squares(&left, &gradient).0
            }
        };
        counts.iter().map(gain).collect()
    }

    /// The fit of the model without its effect number `position`.
    pub(crate) fn without_effect(&self, position: usize) -> Fitted {
        let all: Vec<&Sample> = self.samples.iter().collect();
        let own = self.fitted.effects[position];
        let rest: Vec<usize> = self.fitted.effects.iter().copied().filter(|e| *e != own).collect();
        likeliest(&all, &self.numbers, &rest, &self.fitted)
    }

    /// Candidates that compete with effect number `position` of the model: they have no more parameters and fit as
    /// well in its place. `without` is the fit without this effect. Each competitor comes with its fit.
    pub(crate) fn competitors(&self, position: usize, without: &Fitted) -> Vec<(usize, Fitted)> {
        let own = self.fitted.effects[position];
        let numbers = |c: usize| self.candidates[c].numbers();
        let is_other = |c: usize| !self.is_same(c, own) && numbers(c) <= numbers(own);
        let mut tried = self.best_additions(without, is_other, |_| self.missing(without));
        tried.retain(|(_, f)| f.ln_likelihood > self.fitted.ln_likelihood - TIE);
        tried
    }
}
