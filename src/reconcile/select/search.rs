//! Fits and scores single models of the candidates. Every search for effects uses these functions.
//!
//! At the break points of a gear's torsion curve the frequencies jump, and a descent stops at a jump. Fits of such a
//! model therefore start with a smoothed curve, and end with a direct search over the break points.

use crate::reconcile::fit::curve_interval::RULED_OUT;
use crate::reconcile::fit::descent::{Effort, Fit, Point, descent, evaluate_near, fit};
use crate::reconcile::fit::steps::{self, NARROW_SMOOTHING, WIDE_SMOOTHING};
use crate::reconcile::fit::weights::Weights;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::model::calibration::Nuisance;
use crate::reconcile::model::parameters::{Candidate, Model};
use crate::reconcile::readings::campaign::Campaign;
use rayon::prelude::*;

/// A model whose objective per datum is larger than this cannot be the explanation, even if the declared standard
/// deviations are too small.
const BEYOND_HOPE: f64 = 3.0;

/// The inputs of a search for effects: campaign, candidates and weights.
pub(crate) struct Search<'a> {
    /// The campaign with its readings.
    pub campaign: &'a Campaign,
    /// The campaign, prepared for fitting.
    pub forward: &'a Forward,
    /// The calibrated parameters.
    pub nuisance: &'a Nuisance,
    /// All candidates.
    pub candidates: &'a [Candidate],
    /// Weights of the data in the fits.
    pub weights: &'a Weights,
}

/// A model that was fitted, with its score.
#[derive(Clone)]
pub(crate) struct Scored {
    /// Indices of the candidates that are effects of the model.
    pub effects: Vec<usize>,
    /// Fitted parameters of the model.
    pub u: Vec<f64>,
    /// Score: the logarithm of the evidence less the price of the effects. The price of an effect is the logarithm of
    /// the number of places where an effect could be named, each weighted by its prior odds, divided by the prior odds
    /// of this effect.
    pub score: f64,
    /// Value of the objective `Σ ρ(r) + Σ u²` (Huber's loss and priors) at the fit.
    pub objective: f64,
}

impl<'a> Search<'a> {
    /// The model whose effects are the candidates with the indices `effects`.
    pub(crate) fn model(&self, effects: &[usize]) -> Model<'a> {
        Model::of(self.nuisance, self.candidates, effects)
    }

    /// Fits the model whose effects are the candidates with the indices `effects`, from the parameters `u`.
    pub(crate) fn fit(&self, effects: &[usize], u: &[f64], effort: Effort) -> Fit<'a> {
        self.fit_model(self.model(effects), u, effort)
    }

    /// Fits a model from the parameters `u`. If the frequencies jump at a break point of a gear's curve, the curve is
    /// smoothed at first and then sharpened. A curve that was just added is always fitted in this way, because its
    /// break points are not yet known.
    fn fit_model(&self, model: Model<'a>, u: &[f64], effort: Effort) -> Fit<'a> {
        let is_new_curve = model.effects.last().is_some_and(|e| e.kind.traits.steps_frequencies());
        if is_new_curve && !self.forward.modal.is_empty() {
            let start = steps::smoothed_start(self.forward, &model, u, self.weights);
            return fit(self.forward, &model, &start, self.weights, effort);
        }
        steps::best_fit(self.forward, &model, &[u.to_vec()], self.weights, effort)
    }

    pub(super) fn descent(&self, model: &Model, u: &[f64], effort: Effort) -> Point {
        descent(self.forward, model, u, self.weights, effort, f64::INFINITY)
    }

    /// Fits the model with the effects `effects` from the parameters `u` in a few steps, enough to see whether it
    /// comes close to the readings. If the effect that was added last is a gear's curve, the curve is strongly
    /// smoothed at first.
    pub(super) fn rough(&self, effects: &[usize], u: &[f64]) -> Fit<'a> {
        let mut model = self.model(effects);
        let mut start = u.to_vec();
        let few = Effort { steps: 4, tolerance: 0.02 };
        if model.effects.last().is_some_and(|e| e.kind.traits.steps_frequencies()) {
            let smoothed = Effort { steps: 6, tolerance: 0.05 };
            model.smoothing = WIDE_SMOOTHING;
            start = self.descent(&model, &start, smoothed).u;
            model.smoothing = NARROW_SMOOTHING;
        }
        fit(self.forward, &model, &start, self.weights, few)
    }

    /// Fits the model with the effects `effects` from the parameters `u` until it has converged. Break points of a
    /// gear's curve are varied by a direct search, because a descent does not find lower values of the objective
    /// beyond a jump of the frequencies.
    pub(crate) fn polish(&self, effects: &[usize], u: &[f64]) -> Fit<'a> {
        let model = self.model(effects);
        let breaks = model.break_points();
        if breaks.is_empty() {
            return fit(self.forward, &model, u, self.weights, Effort::default());
        }
        let mut best = self.descent(&model, u, Effort::default());
        // large changes first, then smaller ones about the best value
        for reach in [0.3, 0.12, 0.04] {
            for &p in &breaks {
                let moves = [-1.0, -0.5, 0.5, 1.0].map(|m| best.u[p] + m * reach);
                let tried: Vec<Point> =
                    moves.into_par_iter().filter_map(|v| self.held_then_free(&model, &best, p, v)).collect();
                for point in tried {
                    if point.objective < best.objective - 1e-6 {
                        best = point;
                    }
                }
            }
        }
        self.centre_breaks(model, best)
    }

    /// Fits the model `scored` until it has converged, if it has break points and may be the explanation. Otherwise the
    /// model is returned as it is. If a descent had stopped too early, a further effect would seem necessary.
    pub(super) fn settled(&self, scored: Scored) -> Scored {
        if self.model(&scored.effects).break_points().is_empty() || !self.may_explain(&scored) {
            return scored;
        }
        let polished = self.scored(&scored.effects, &self.polish(&scored.effects, &scored.u));
        if polished.score > scored.score { polished } else { scored }
    }

    /// Moves the break points of `best` from the edge of a jump of a frequency to the middle of the interval in which
    /// the objective is nearly constant, and fits the other parameters again. A small change of the torques then does
    /// not move a test across the jump.
    pub(super) fn centre_breaks(&self, model: Model<'a>, best: Point) -> Fit<'a> {
        const DERIVATIVE_STEP: f64 = 0.002;
        let mut u = best.u.clone();
        for p in model.break_points() {
            let flat = |side: f64| {
                let rises = (1..=10).map(|i| {
                    let mut moved = u.clone();
                    moved[p] += side * DERIVATIVE_STEP * i as f64;
                    evaluate_near(self.forward, &model, &moved, self.weights, Some(&best)).objective
                });
                rises.take_while(|o| *o < best.objective + 1.0).count() as f64
            };
            let middle = 0.5 * DERIVATIVE_STEP * (flat(1.0) - flat(-1.0));
            u[p] += middle;
        }
        let mut held = model.clone();
        // the other parameters adapt to the moved break points
        held.held = model.break_points().into_iter().map(|p| (p, u[p])).collect();
        let centred = self.descent(&held, &u, Effort { steps: 4, tolerance: 0.02 });
        let end = if centred.objective > best.objective + 4.0 { best } else { centred };
        fit(self.forward, &model, &end.u, self.weights, Effort { steps: 0, tolerance: 0.0 })
    }

    /// Fits the model with the parameter number `parameter` fixed at `value`, and then fits it with this parameter
    /// free. `from` is the point from which the fit starts. `None` if the readings rule the value out.
    fn held_then_free(&self, model: &Model, from: &Point, parameter: usize, value: f64) -> Option<Point> {
        let effort = Effort { steps: 5, tolerance: 0.02 };
        let mut held = model.clone();
        held.held = vec![(parameter, value)];
        let limit = from.objective + RULED_OUT;
        let end = descent(self.forward, &held, &from.u, self.weights, effort, limit);
        (end.objective <= limit).then(|| self.descent(model, &end.u, effort))
    }

    /// The fitted model `fit`, whose effects have the indices `effects`, with its score.
    pub(crate) fn scored(&self, effects: &[usize], fit: &Fit) -> Scored {
        Scored {
            effects: effects.to_vec(),
            u: fit.point.u.clone(),
            score: fit.evidence - self.price(effects),
            objective: fit.point.objective,
        }
    }

    /// Whether the model `scored` fits the readings well enough to be worth refining, by its objective per datum.
    pub(crate) fn may_explain(&self, scored: &Scored) -> bool {
        scored.objective < BEYOND_HOPE * self.forward.data.len() as f64
    }

    /// Price of the effects with the indices `effects` \[ln of the evidence\]: minus the logarithm of their prior
    /// probability. It accounts for the other effects and places that could have been named instead.
    pub(crate) fn price(&self, effects: &[usize]) -> f64 {
        let odds = |effect: &usize| self.candidates[*effect].kind.traits.odds;
        effects.iter().map(|effect| libm::log(self.places() / odds(effect))).sum()
    }

    /// Number of places where an effect could be named, each weighted by the prior odds of its effect. All wrong units
    /// of a channel count once, and so do all variants of an effect.
    pub(crate) fn places(&self) -> f64 {
        let mut labels: Vec<(String, f64)> =
            self.candidates.iter().map(|c| (c.label(), c.kind.traits.odds)).collect();
        labels.dedup();
        labels.iter().map(|(_, odds)| odds).sum()
    }

    /// The model `scored` without its effect number `effect`: the indices of the other effects, and the parameters
    /// from which its fit starts.
    pub(crate) fn without(&self, scored: &Scored, effect: usize) -> (Vec<usize>, Vec<f64>) {
        let model = self.model(&scored.effects);
        let first = model.first_parameter(effect);
        let (mut effects, mut u) = (scored.effects.clone(), scored.u.clone());
        effects.remove(effect);
        u.drain(first..first + model.effects[effect].free_parameters.len());
        (effects, u)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::effect::soft_windup;
    use crate::catalog::Catalogs;
    use crate::reconcile::fit::descent::evaluate;
    use crate::reconcile::fit::noise::Noise;
    use crate::reconcile::model::candidates::candidates;
    use std::path::Path;

    #[test]
    fn modes_taken_from_a_neighbour_are_those_solved_anew_wherever_a_break_point_is() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/campaigns/plain-0251e");
        let campaign = Campaign::read(&folder, &Catalogs::default()).expect("sound");
        let forward = Forward::new(&campaign);
        let nuisance = Nuisance::new(&campaign.arm, &campaign.statement.tolerance);
        let candidates = candidates(&forward);
        let curve = candidates
            .iter()
            .find(|c| c.kind.name == soft_windup::KIND.name && c.at == "j2")
            .expect("a gear");
        let model = Model::baseline(&nuisance).with(curve);
        let weights = Noise::default().weights(&forward);
        let mut u = vec![0.0; model.calibrated()];
        u.extend(&curve.starts[0]);
        let near = evaluate(&forward, &model, &u, &weights);
        let mut kept = 0;
        for p in model.break_points() {
            for step in 1..=10 {
                let mut moved = u.clone();
                moved[p] += 0.05 * step as f64;
                let taken = evaluate_near(&forward, &model, &moved, &weights, Some(&near));
                let solved = evaluate(&forward, &model, &moved, &weights);
                assert_eq!(taken.predicted, solved.predicted, "break point {p}, step {step}");
                let same = taken.solved.iter().zip(&near.solved);
                kept += same.filter(|(a, b)| std::sync::Arc::ptr_eq(a, b)).count();
            }
        }
        assert!(kept > 0, "no modes were kept");
    }
}
