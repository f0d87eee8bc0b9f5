//! Finds joints with a transmission error: an error of the angle that the gear or its sensor causes, once and twice a
//! turn.

use super::analysis::Positions;
use super::fit::likeliest;
use super::fitted::{Fitted, Sample};
use super::kinematics::Number;
use super::search::{FULL_FITS, TIE};
use crate::arm::effect::transmission_error;
use crate::arm::effect::waves::transmission_waves;
use crate::reconcile::readings::campaign::Campaign;
use rayon::prelude::*;

/// Name of the effect of a transmission error.
pub(crate) const EFFECT: &str = transmission_error::KIND.name;

/// The calibrated numbers of the transmission error of the driven joint with index `joint`: amplitudes of sine and
/// cosine, once and twice a turn.
pub(crate) fn numbers(joint: usize) -> impl Iterator<Item = Number> {
    (0..transmission_waves(0.0).len()).map(move |k| Number::Transmission(joint, k))
}

impl Positions {
    /// The driven joint whose transmission error raises the likelihood most, with the gain of the likelihood beyond the
    /// price \[ln of the likelihood\], the index of the joint and the fit. `None` if no rise exceeds its price.
    pub(super) fn best_transmission(&self) -> Option<(f64, (usize, Fitted))> {
        let price = self.transmission_price();
        let tried = self.best_transmissions(price).into_iter();
        let gains = tried.map(|(j, f)| (f.ln_likelihood - self.fitted.ln_likelihood - price, (j, f)));
        gains.filter(|(gain, _)| *gain > 0.0).max_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Adds the transmission error of the driven joint `joint`, if the score and held-out poses confirm it. `fitted` is
    /// the fit with it. Returns whether it was added.
    pub(super) fn take_transmission(&mut self, campaign: &Campaign, joint: usize, fitted: Fitted) -> bool {
        let mut next = Self { fitted, ..self.clone() };
        next.numbers.extend(numbers(joint));
        next.transmissions.push(joint);
        self.take_if_confirmed(campaign, next, format!("{EFFECT}@{}", self.tree.driven[joint]))
    }

    /// Price of the transmission error of one joint \[ln of the likelihood\]: the rise of the logarithm of the
    /// likelihood that it must bring to stay in the model.
    pub(crate) fn transmission_price(&self) -> f64 {
        self.price(numbers(0).count(), self.tree.driven.len())
    }

    /// Fits in which one more joint has a transmission error, each with the index of this joint. All joints are
    /// screened with the linearized model, and the most promising are fitted in full, if they may raise the logarithm of the
    /// likelihood by `asked`. There are none if the campaign leaves this effect out.
    pub(super) fn best_transmissions(&self, asked: f64) -> Vec<(usize, Fitted)> {
        if !self.considers_transmissions {
            return Vec::new();
        }
        let all: Vec<&Sample> = self.samples.iter().collect();
        let open: Vec<usize> =
            (0..self.tree.driven.len()).filter(|j| !self.transmissions.contains(j)).collect();
        let further: Vec<Number> = open.iter().flat_map(|&j| numbers(j)).collect();
        let counts = vec![numbers(0).count(); open.len()];
        let gains = self.linear_gains(&self.fitted, &counts, true, &|sample, placer, columns| {
            placer.slopes(sample.placing(), &further, columns);
        });
        let mut order: Vec<(usize, f64)> = open.into_iter().zip(gains).collect();
        order.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        order.truncate(FULL_FITS);
        order.retain(|(_, gain)| self.may_rise(*gain, asked));
        let with = |(joint, _): (usize, f64)| {
            let all_numbers: Vec<Number> = self.numbers.iter().cloned().chain(numbers(joint)).collect();
            (joint, likeliest(&all, &all_numbers, &self.fitted.effects, &self.fitted))
        };
        order.into_par_iter().map(with).collect()
    }

    /// The model without the transmission error of the driven joint with index `joint`, fitted again.
    pub(super) fn without_transmission(&self, joint: usize) -> Self {
        let mut without = self.without_numbers(|n| matches!(n, Number::Transmission(j, _) if *j == joint));
        without.fitted.geometry.transmissions_rad[joint] = [0.0; 4];
        without.transmissions.retain(|j| *j != joint);
        without.refit();
        without
    }

    /// Indices of other driven joints: a transmission error of one of them, in place of the transmission error of
    /// `joint`, would fit the positions as well.
    pub(crate) fn transmission_competitors(&self, joint: usize) -> Vec<usize> {
        let without = self.without_transmission(joint);
        let tried = without.best_transmissions(self.missing(&without.fitted)).into_iter();
        tried
            .filter(|(j, f)| *j != joint && f.ln_likelihood > self.fitted.ln_likelihood - TIE)
            .map(|(j, _)| j)
            .collect()
    }
}
