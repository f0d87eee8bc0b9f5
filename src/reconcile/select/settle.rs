//! Finds the effects and the quality of the readings together, because each depends on the other.
//!
//! Gross errors, the size of the noise and modes that are missing from a list can be found only with the right effects
//! in the model. The right effects can be found only if wrong rows are left out.

use super::few_rows;
use super::screening::Selection;
use super::search::{Scored, Search};
use crate::reconcile::fit::descent::{Effort, Fit};
use crate::reconcile::fit::noise::{GROSS_ERROR_CHARGE, Noise, gross_lists};
use crate::reconcile::fit::steps::best_fit;
use crate::reconcile::fit::weights::Weights;
use crate::reconcile::forward::coefficients::Coefficients;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::model::calibration::Nuisance;
use crate::reconcile::model::parameters::{Candidate, Model};
use crate::reconcile::readings::campaign::Campaign;

/// Largest tolerable error of a frequency that comes from computing it with fixed trial shapes \[standard deviations
/// of the reading\].
const LARGEST_SHAPE_ERROR: f64 = 0.5;

/// Largest number of times that the trial shapes of the modes are replaced by those of the best model.
const MOST_SHAPE_CHANGES: usize = 2;

/// Largest number of times that the worst readings are left out to see whether calibration alone fits the other
/// readings.
const MOST_TRIMS: usize = 4;

/// The result of the search for effects and of the judgement of the readings' quality.
pub(crate) struct Settled {
    /// The models that were fitted, and the best one.
    pub selection: Selection,
    /// Quality of the readings: gross errors, and factors on the declared standard deviations.
    pub noise: Noise,
    /// Sentences on modes that are missing from lists or numbered out of order.
    pub remarks: Vec<String>,
}

impl Settled {
    /// Analyses a campaign with few readings: the readings are taken as declared, and every small set of effects is
    /// fitted.
    pub(crate) fn of_few(
        campaign: &Campaign,
        forward: &Forward,
        nuisance: &Nuisance,
        candidates: &[Candidate],
    ) -> Self {
        let noise = Noise::default();
        let weights = noise.weights(forward);
        let search = Search { campaign, forward, nuisance, candidates, weights: &weights };
        Self { selection: few_rows::weigh(&search), noise, remarks: Vec::new() }
    }

    /// Analyses a campaign with many readings, in these steps.
    ///
    /// Missing modes are found first. A search follows with the declared standard deviations and without obvious gross
    /// errors. Then further gross errors are removed and the search is repeated. Finally the best model shows whether
    /// the declared standard deviations were right. If not, the models are compared again with the standard deviations
    /// that it suggests.
    pub(crate) fn of_many(
        campaign: &Campaign,
        forward: &mut Forward,
        nuisance: &Nuisance,
        candidates: &[Candidate],
    ) -> Self {
        let mut settling = Settling { campaign, forward, nuisance, candidates };
        let mut remarks = settling.forward.put_modes_in_order();
        let round = settling.count_missed_modes(&mut remarks);
        let round = settling.with_exact_modes(round);
        let round = settling.with_slips(round);
        let round = settling.without_gross_errors(round);
        let round = settling.with_slips(round);
        let Round { selection, noise, .. } = settling.with_scaled_deviations(round);
        let forward = settling.forward;
        remarks.extend(gross_lists(forward, &noise.weights(forward)).into_iter().map(|list| {
            format!(
                "list {} of the frequencies does not agree with the others: check its pose, its payload and how its \
                 modes are numbered",
                list + 1
            )
        }));
        Self { selection, noise, remarks }
    }
}

/// A campaign during the search for its effects and its noise.
struct Settling<'a> {
    campaign: &'a Campaign,
    forward: &'a mut Forward,
    nuisance: &'a Nuisance,
    candidates: &'a [Candidate],
}

/// One search for effects, with the gross errors and standard deviations that it assumed and found.
struct Round {
    /// The gross errors and standard deviations that the search assumed.
    noise: Noise,
    selection: Selection,
    coefficients: Coefficients,
    /// The gross errors and standard deviations that the residuals of the best model show.
    judged: Noise,
    /// Whether the best model fits well enough to be the explanation.
    hopeful: bool,
}

impl Round {
    /// The score of the best model, less [`GROSS_ERROR_CHARGE`] for each reading that was left out of the fit as a
    /// gross error \[ln of the evidence\].
    fn score(&self) -> f64 {
        self.selection.best.score - GROSS_ERROR_CHARGE * self.noise.outliers.len() as f64
    }
}

impl Settling<'_> {
    fn search<'s>(&'s self, weights: &'s Weights) -> Search<'s> {
        let Self { campaign, forward, nuisance, candidates } = self;
        Search { campaign, forward, nuisance, candidates, weights }
    }

    fn run(&self, noise: Noise, before: Before) -> Round {
        let weights = noise.weights(self.forward);
        let search = self.search(&weights);
        let selection = match before {
            Before::Nothing => search.run(None),
            Before::Best(scored) => search.run(Some(scored)),
            Before::Weights(selection) => search.weigh_again(selection),
        };
        let best = search.fit(&selection.best.effects, &selection.best.u, Effort::default());
        let judged = Noise::from_fit(self.forward, &best, &weights);
        let hopeful = search.may_explain(&selection.best) && !selection.given_up;
        Round { noise, selection, coefficients: best.point.coefficients, judged, hopeful }
    }

    /// Fits the calibration alone with the declared standard deviations, and returns the fit with its weights. If the
    /// fit is not close to most readings, the few worst readings are left out and the calibration is fitted again, up
    /// to four times. The new fit is returned if it is close to most of the other readings.
    fn baseline(&self) -> (Fit<'_>, Weights) {
        let calibrated = |noise: Noise| {
            let baseline = Model::baseline(self.nuisance);
            let weights = noise.weights(self.forward);
            let nominal = vec![0.0; baseline.len()];
            (best_fit(self.forward, &baseline, &[nominal], &weights, Effort::default()), weights)
        };
        let (with_all, declared) = calibrated(Noise::default());
        if Noise::is_close(self.forward, &with_all) {
            return (with_all, declared);
        }
        let mut without = Noise::without_worst(self.forward, &with_all, &declared);
        for _ in 0..MOST_TRIMS {
            let (baseline, weights) = calibrated(without);
            if Noise::is_close(self.forward, &baseline) {
                return (baseline, weights);
            }
            without = Noise::without_worst(self.forward, &baseline, &weights);
        }
        (with_all, declared)
    }

    /// Makes the first search, without the gross errors that are visible before any effect is known. A frequency that
    /// was left out may be no error but the only sign of an effect. So the search is repeated with all frequencies, and
    /// this result is taken if it is more probable.
    fn first(&self) -> Round {
        let (baseline, weights) = self.baseline();
        let noise = Noise::first_look(self.forward, &baseline, &weights);
        let frequencies = noise.with_frequencies();
        let without = self.run(noise, Before::Nothing);
        let with = frequencies.map(|noise| self.run(noise, Before::Nothing));
        with.filter(|with| with.hopeful && with.score() > without.score()).unwrap_or(without)
    }

    /// Renumbers the modes of frequency lists from which a mode is missing, and returns the result of the search that
    /// follows. Missing modes are first sought with calibration alone, if it fits most readings. Then they are sought
    /// with the first effects found, and last with effects that were found without suspect lists (more than one of
    /// their frequencies is far off). `remarks` gets a sentence for each list that is renumbered.
    fn count_missed_modes(&mut self, remarks: &mut Vec<String>) -> Round {
        let (baseline, _) = self.baseline();
        if Noise::is_close(self.forward, &baseline) {
            let coefficients = baseline.point.coefficients;
            remarks.extend(self.forward.find_missed_modes(&coefficients));
        }
        let round = self.first();
        let mut missed = self.forward.find_missed_modes(&round.coefficients);
        if let Some(without) = Noise::uncertain_lists(self.forward, &round.coefficients)
            && missed.is_empty()
        {
            // the model must not be fitted to the suspect lists, because they would then seem right
            let coefficients = self.run(without, Before::Nothing).coefficients;
            missed = self.forward.find_missed_modes(&coefficients);
        }
        let round = if missed.is_empty() { round } else { self.first() };
        remarks.extend(missed);
        round
    }

    /// Repeats the comparison of models after the trial shapes of the modes were computed again for the best model.
    /// The shapes of the nominal arm are inexact for a very different arm, and a further effect or a law without a
    /// name would compensate for the error. If the new shapes change the predicted readings noticeably, the whole
    /// search is repeated.
    fn with_exact_modes(&mut self, mut round: Round) -> Round {
        for _ in 0..MOST_SHAPE_CHANGES {
            if round.selection.best.effects.is_empty() {
                break;
            }
            let before = self.forward.predict(&round.coefficients);
            self.forward.refresh(&round.coefficients);
            let after = self.forward.predict(&round.coefficients);
            let pairs = self.forward.data.iter().zip(before.iter().zip(&after));
            let moved =
                pairs.map(|(d, (before, after))| ((after - before) / d.sigma).abs()).fold(0.0, f64::max);
            // the trial shapes were good enough: only the comparison is repeated
            if moved < LARGEST_SHAPE_ERROR {
                if round.hopeful {
                    round = self.run(round.noise, Before::Weights(&round.selection));
                }
                break;
            }
            round = self.run(round.noise, Before::Nothing);
        }
        round
    }

    /// Searches again without one or two rows that are gross errors according to the best model, or according to the
    /// best model with one effect fewer. The new result replaces `round` if such errors are more probable than the
    /// effects that they replace.
    fn with_slips(&self, round: Round) -> Round {
        let best = &round.selection.best;
        if !round.hopeful {
            return round;
        }
        let weights = round.noise.weights(self.forward);
        let search = self.search(&weights);
        // an effect may describe a gross error, so the model without it judges the rows too
        let fewer = (0..best.effects.len()).map(|effect| {
            let (effects, u) = search.without(best, effect);
            search.fit(&effects, &u, Effort::default())
        });
        let fewer = fewer.max_by(|a, b| a.evidence.total_cmp(&b.evidence));
        let same = search.fit(&best.effects, &best.u, Effort::default());
        let again = fewer.iter().chain([&same]).filter_map(|fit| round.noise.with_slips(self.forward, fit));
        let again = again.map(|noise| self.run(noise, Before::Nothing));
        let mut again: Vec<Round> =
            again.filter(|r| r.selection.best.effects.len() <= best.effects.len()).collect();
        again.push(round);
        again.into_iter().max_by(|a, b| a.score().total_cmp(&b.score())).expect("the search before at least")
    }

    /// Searches again without the rows that the best model of `round` shows to be gross errors, if they differ from
    /// those left out so far.
    fn without_gross_errors(&self, mut round: Round) -> Round {
        for again in 0..2 {
            if round.judged.same_rows(&round.noise) || (again > 0 && !round.hopeful) {
                break;
            }
            let noise = Noise { scale: [1.0; 3], outliers: round.judged.outliers.clone() };
            if round.selection.given_up {
                return Round { noise, ..round }; // a law without a name has settled the result
            }
            round = self.run(noise, Before::Best(&round.selection.best));
        }
        round
    }

    /// Searches again with the standard deviations that the residuals of the best model of `round` suggest, if they
    /// differ from those assumed.
    fn with_scaled_deviations(&self, mut round: Round) -> Round {
        for _ in 0..2 {
            // larger standard deviations do not make a model right that is far off
            if round.judged.agrees(&round.noise) || !round.hopeful {
                break;
            }
            let same_rows = round.judged.same_rows(&round.noise);
            let Round { selection, judged, .. } = round;
            let before = if same_rows { Before::Weights(&selection) } else { Before::Best(&selection.best) };
            round = self.run(judged, before);
        }
        round
    }
}

/// An earlier result from which a search can start.
enum Before<'a> {
    Nothing,
    /// The best model so far; used if the set of rows has changed.
    Best(&'a Scored),
    /// All models so far; used if only the standard deviations have changed.
    Weights(&'a Selection),
}
