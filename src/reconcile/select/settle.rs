//! The effects and the quality of the readings, which depend on each other: which rows are gross errors, how large
//! the noise is and which modes are missing from a list shows only beside the right effects, and these only
//! without the wrong rows.

use super::few_rows;
use super::screening::Selection;
use super::search::{Scored, Search};
use crate::reconcile::fit::descent::{Effort, Fit, Weights, fit};
use crate::reconcile::fit::noise::{Noise, gross_lists};
use crate::reconcile::forward::coefficients::Coefficients;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::model::parameters::{Candidate, Model, Nuisance};
use crate::reconcile::readings::campaign::Campaign;

/// What a gross error costs, in ln of the evidence, where it stands for an effect: about one row in a thousand is one.
const SLIP: f64 = 7.0;

/// Error of a frequency by its trial shapes that is too much \[standard deviations\].
const INEXACT: f64 = 0.5;

/// How often trial shapes are taken from the best model at most.
const SHAPES: usize = 2;

/// How often the worst readings are left out to see whether calibration alone comes close to the others.
const LOOKS: usize = 4;

/// The effects and the quality of the readings, which depend on each other.
pub struct Settled {
    /// The models.
    pub selection: Selection,
    /// Quality of the readings.
    pub noise: Noise,
    /// Modes missing from lists or numbered out of order, in words.
    pub remarks: Vec<String>,
}

impl Settled {
    /// A handful of readings: taken as declared, every small set of effects weighed.
    pub fn of_few(
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

    /// Counts missed modes and searches with the deviations as declared, without the gross errors that show at once;
    /// takes out further gross errors and searches again; and lets the best model say whether the declaration was
    /// right: if it was not, weighs the models again with what it says.
    pub fn of_many(
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

/// A campaign on the way.
struct Settling<'a> {
    campaign: &'a Campaign,
    forward: &'a mut Forward,
    nuisance: &'a Nuisance,
    candidates: &'a [Candidate],
}

/// One search.
struct Round {
    /// What it took the readings for.
    noise: Noise,
    selection: Selection,
    coefficients: Coefficients,
    /// What its best model says of the readings.
    judged: Noise,
    /// Whether its best model may become the explanation.
    hopeful: bool,
}

impl Round {
    /// The score of the best model, which pays for each row that it leaves out.
    fn score(&self) -> f64 {
        self.selection.best.score - SLIP * self.noise.outliers.len() as f64
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

    /// Calibration alone, with the deviations as declared, and its weights: where it comes close to most readings but
    /// for the few that are worst, without these.
    fn bare(&self) -> (Fit<'_>, Weights) {
        let calibrated = |noise: Noise| {
            let bare = Model::bare(self.nuisance);
            let weights = noise.weights(self.forward);
            (fit(self.forward, &bare, &vec![0.0; bare.len()], &weights, Effort::default()), weights)
        };
        let (with_all, declared) = calibrated(Noise::default());
        if Noise::is_close(self.forward, &with_all) {
            return (with_all, declared);
        }
        let mut without = Noise::without_worst(self.forward, &with_all, &declared);
        for _ in 0..LOOKS {
            let (bare, weights) = calibrated(without);
            if Noise::is_close(self.forward, &bare) {
                return (bare, weights);
            }
            without = Noise::without_worst(self.forward, &bare, &weights);
        }
        (with_all, declared)
    }

    /// A search without the gross errors that show before any effect is looked for. An effect may show in a single
    /// frequency: one with such frequencies stands where it is the more probable.
    fn first(&self) -> Round {
        let (bare, weights) = self.bare();
        let noise = Noise::first_look(self.forward, &bare, &weights);
        let frequencies = noise.with_frequencies();
        let without = self.run(noise, Before::Nothing);
        let with = frequencies.map(|noise| self.run(noise, Before::Nothing));
        with.filter(|with| with.hopeful && with.score() > without.score()).unwrap_or(without)
    }

    /// Counts lists from which a mode is missing one higher: as calibration alone has them where it comes close to
    /// most readings, as the first effects have them, and as effects have them that were found without the lists in
    /// doubt.
    fn count_missed_modes(&mut self, remarks: &mut Vec<String>) -> Round {
        let (bare, _) = self.bare();
        if Noise::is_close(self.forward, &bare) {
            let coefficients = bare.point.coefficients;
            remarks.extend(self.forward.find_missed_modes(&coefficients));
        }
        let round = self.first();
        let mut missed = self.forward.find_missed_modes(&round.coefficients);
        if let Some(without) = Noise::doubtful_lists(self.forward, &round.coefficients)
            && missed.is_empty()
        {
            // what the doubtful lists themselves have made of the model says nothing of them
            let coefficients = self.run(without, Before::Nothing).coefficients;
            missed = self.forward.find_missed_modes(&coefficients);
        }
        let round = if missed.is_empty() { round } else { self.first() };
        remarks.extend(missed);
        round
    }

    /// Weighs again with the trial shapes of the model found: those of the nominal arm are not exact far from it,
    /// and a further effect, or a law without a name, would make that good. Where that can be seen in the readings all is
    /// looked for again.
    fn with_exact_modes(&mut self, mut round: Round) -> Round {
        for _ in 0..SHAPES {
            if round.selection.best.effects.is_empty() {
                break;
            }
            let before = self.forward.predict(&round.coefficients);
            self.forward.refresh(&round.coefficients);
            let after = self.forward.predict(&round.coefficients);
            let pairs = self.forward.data.iter().zip(before.iter().zip(&after));
            let moved =
                pairs.map(|(d, (before, after))| ((after - before) / d.sigma).abs()).fold(0.0, f64::max);
            if moved < INEXACT {
                if round.hopeful {
                    round = self.run(round.noise, Before::Weights(&round.selection));
                }
                break;
            }
            round = self.run(round.noise, Before::Nothing);
        }
        round
    }

    /// A search without one or two rows that the best model, or the best of those without one of its effects, would
    /// call gross errors, if the slips are more probable than what they stand for.
    fn with_slips(&self, round: Round) -> Round {
        let best = &round.selection.best;
        if !round.hopeful {
            return round;
        }
        let weights = round.noise.weights(self.forward);
        let search = self.search(&weights);
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

    /// Searches again without the rows that the best model shows to be gross errors.
    fn without_gross_errors(&self, mut round: Round) -> Round {
        for again in 0..2 {
            if round.judged.same_rows(&round.noise) || (again > 0 && !round.hopeful) {
                break;
            }
            let noise = Noise { scale: [1.0; 3], outliers: round.judged.outliers.clone() };
            if round.selection.given_up {
                return Round { noise, ..round }; // what a law without a name has settled no slips decide
            }
            round = self.run(noise, Before::Best(&round.selection.best));
        }
        round
    }

    /// Searches again with the deviations that the best model leaves.
    fn with_scaled_deviations(&self, mut round: Round) -> Round {
        for _ in 0..2 {
            // no scale of the noise makes a hopeless model right
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

/// What a search can start from.
enum Before<'a> {
    Nothing,
    /// The best model so far; other rows count now.
    Best(&'a Scored),
    /// A selection; only the scale of the deviations is another.
    Weights(&'a Selection),
}
