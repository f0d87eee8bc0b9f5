//! A steady drift of the instrument in the course of the rows. A drift looks like a few sessions, but has fewer
//! numbers.

use super::analysis::{Positions, last_row};
use super::fit::fit;
use super::fitted::Sample;
use super::intervals::within;
use super::kinematics::Number;
use super::sessions::telling_part;
use crate::arm::effect::channel::Channel;
use crate::arm::effect::drift;
use crate::reconcile::model::estimate::{Estimate, Finding};
use crate::reconcile::readings::campaign::Campaign;
use nalgebra::Vector3;

/// Name of the effect.
pub(super) const EFFECT: &str = drift::KIND.name;
/// A drift is named only if its gain exceeds its price by at least this much \[ln of the likelihood\]. The evidence for
/// a session is called strong at the same excess.
const STRONG: f64 = 10.0;

/// The calibrated numbers of a drift.
fn numbers() -> impl Iterator<Item = Number> {
    (0..3).map(Number::Drift)
}

impl Positions {
    /// Replaces the sessions that were found since the model `before` by a drift, if that explains the positions better and no
    /// session is needed in addition to it. Returns whether there is a drift now.
    pub(super) fn take_drift_instead(&mut self, campaign: &Campaign, before: &Self) -> bool {
        let spec = &campaign.statement.positions;
        if before.drifts() || !campaign.statement.considers(EFFECT) {
            return false;
        }
        let mut next = before.with_drift();
        let telling = telling_part(&next.fitted, &next.numbers, &next.samples, numbers().count());
        let rise = next.fitted.ln_likelihood - before.fitted.ln_likelihood;
        if telling * rise < self.drift_price() + STRONG {
            return false;
        }
        if next.score() <= self.score() {
            return false;
        }
        // if the points jump between sessions in addition to the drift, the drift is not steady and is not used
        let is_better = next.find_sessions(spec.tool_offset, spec.base_placement) == 0;
        if is_better {
            next.stage(format!("{EFFECT}@{}", Channel::Positions.word()), Vec::new());
            *self = next;
        }
        is_better
    }

    /// Whether the model has a drift.
    pub(super) fn drifts(&self) -> bool {
        self.numbers.iter().any(|number| matches!(number, Number::Drift(_)))
    }

    /// The model with a drift, fitted again.
    pub(super) fn with_drift(&self) -> Self {
        let mut out = self.clone();
        out.numbers.extend(numbers());
        let all: Vec<&Sample> = out.samples.iter().collect();
        out.fitted = fit(&all, &out.numbers, &out.fitted.effects, &out.fitted);
        out
    }

    /// Drops the drift if it is no longer worth its price once effects are in the model. Returns whether it was
    /// dropped.
    pub(super) fn drop_needless_drift(&mut self) -> bool {
        if !self.drifts() {
            return false;
        }
        let mut without = self.without_numbers(|number| matches!(number, Number::Drift(_)));
        without.fitted.geometry.drift_m = Vector3::zeros();
        without.refit();
        let is_needless = without.score() > self.score();
        if is_needless {
            *self = without;
        }
        is_needless
    }

    /// Sentence that a drift must not be named, because sessions are needed in addition to it. `None` if there is no
    /// drift, or if no session was found.
    pub(super) fn unsteady_drift(&self) -> Option<String> {
        let jumps = self.sessions.iter().any(|boundary| !boundary.declared);
        (self.drifts() && jumps)
            .then(|| "the measured points move in the order of the readings, but not steadily".into())
    }

    /// Price of a drift \[ln of the likelihood\], whether or not the model has one.
    pub(super) fn drift_price(&self) -> f64 {
        self.price(numbers().count(), 1)
    }

    /// The finding of the drift of the model; `None` if there is none.
    pub(super) fn drift_finding(&self, campaign: &Campaign) -> Option<Finding> {
        let per_row = 1e3 / last_row(campaign);
        let fitted = self.numbers.iter().zip(&self.fitted.moved).enumerate();
        let own = fitted.filter(|(_, (number, _))| matches!(number, Number::Drift(_)));
        let rate = |(at, (_, value)): (usize, (&Number, &f64))| {
            within(per_row * value, self.reach(&[(at, 1.0)]).map(|reach| per_row * reach))
        };
        let rates: Vec<Estimate> = own.map(rate).collect();
        (!rates.is_empty()).then(|| Finding {
            effect: EFFECT.into(),
            at: Channel::Positions.word().into(),
            parameters: vec![("rate_mm_per_row".into(), rates)],
            indistinguishable_from: Vec::new(),
        })
    }
}
