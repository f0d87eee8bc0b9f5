//! Finds the effects of a campaign: prepares it for fitting, lists the candidates, and settles effects and noise.

use super::fit::units;
use super::fit::weights::Weights;
use super::forward::prepared::Forward;
use super::model::calibration::Nuisance;
use super::model::candidates::candidates;
use super::model::parameters::{Candidate, Model};
use super::readings::campaign::Campaign;
use super::select::few_rows;
use super::select::search::{Scored, Search};
use super::select::seen::seen;
use super::select::settle::Settled;
use super::verdict::too_little::rows;

/// A campaign, prepared for fitting, and what is sought in it.
pub(super) struct Sought<'c> {
    pub(super) campaign: &'c Campaign,
    /// The campaign, prepared for fitting.
    pub(super) forward: Forward,
    /// The calibrated parameters.
    pub(super) nuisance: Nuisance,
    /// The effects at places that are tried.
    pub(super) candidates: Vec<Candidate>,
}

impl Sought<'_> {
    /// The search with these weights of the data.
    pub(super) fn search<'s>(&'s self, weights: &'s Weights) -> Search<'s> {
        let Self { campaign, forward, nuisance, candidates } = self;
        Search { campaign, forward, nuisance, candidates, weights }
    }

    /// Computes the trial shapes of the modes for the model `scored`.
    pub(super) fn refresh(&mut self, scored: &Scored) {
        let model = Model::of(&self.nuisance, &self.candidates, &scored.effects);
        let coefficients = model.coefficients(&self.forward, &scored.u);
        self.forward.refresh(&coefficients);
    }
}

/// A campaign with the effects that were found in its readings.
pub(super) struct Found<'c> {
    pub(super) sought: Sought<'c>,
    /// Whether the campaign has only a handful of rows.
    pub(super) few: bool,
    pub(super) settled: Settled,
    /// Whether the readings have the standard deviations that the campaign states.
    pub(super) as_declared: bool,
    /// Whether these effects already stood against the laws without a name, in a part of the rows.
    pub(super) stood: bool,
}

impl<'c> Found<'c> {
    /// Finds the effects in all rows of a campaign.
    pub(super) fn of(campaign: &'c Campaign) -> Self {
        let mut forward = Forward::new(campaign);
        let nuisance = Nuisance::new(&campaign.arm, &campaign.statement.tolerance);
        let few = rows(campaign) < few_rows::FEWEST_ROWS;
        let candidates = sought(campaign, &forward, &nuisance, few);
        let declared: Vec<f64> = forward.data.iter().map(|datum| datum.sigma).collect();
        let settled = settled(campaign, &mut forward, &nuisance, &candidates, few);
        let as_declared = forward.data.iter().map(|datum| datum.sigma).eq(declared);
        let sought = Sought { campaign, forward, nuisance, candidates };
        Self { sought, few, settled, as_declared, stood: false }
    }
}

/// The candidates (effects at places) that the search tries: every effect that the campaign admits and the readings
/// could show. If `few`, the campaign has only a handful of rows. Rare effects are then left out, and fits begin from
/// more starting points.
fn sought(campaign: &Campaign, forward: &Forward, nuisance: &Nuisance, few: bool) -> Vec<Candidate> {
    let mut candidates = candidates(forward);
    candidates.retain(|c| campaign.statement.considers(c.kind.name));
    let mut candidates = seen(forward, nuisance, candidates);
    if few {
        // rare effects are left out, because a handful of readings cannot show them convincingly
        candidates.retain(|c| c.kind.traits.odds >= 1.0);
        candidates = candidates.into_iter().map(Candidate::from_corners).collect();
    }
    candidates
}

/// Finds the effects and the noise. If a channel is so noisy that its readings may be in another unit than stated, the
/// search is repeated with larger standard deviations of this channel. The repetition counts only if it finds the wrong
/// unit as an effect. In that case `forward` gets the larger standard deviations too.
fn settled(
    campaign: &Campaign,
    forward: &mut Forward,
    nuisance: &Nuisance,
    candidates: &[Candidate],
    few: bool,
) -> Settled {
    if few {
        return Settled::of_few(campaign, forward, nuisance, candidates);
    }
    let found = Settled::of_many(campaign, forward, nuisance, candidates);
    let best = &found.selection.best;
    let coefficients = Model::of(nuisance, candidates, &best.effects).coefficients(forward, &best.u);
    let stretches = units::stretches(forward, &coefficients);
    if stretches.is_empty() {
        return found;
    }
    let mut stretched = Forward::new(campaign);
    units::stretch(&mut stretched, &stretches);
    let mut again = Settled::of_many(campaign, &mut stretched, nuisance, candidates);
    let named: Vec<&Candidate> = again.selection.best.effects.iter().map(|&i| &candidates[i]).collect();
    // unless the wrong unit is found as an effect, larger standard deviations would only hide other physics
    if !stretches.iter().all(|stretch| stretch.is_among(&named)) {
        return found;
    }
    *forward = stretched;
    again.remarks.extend(stretches.iter().map(units::Stretch::sentence));
    again
}
