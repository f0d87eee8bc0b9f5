//! Finds which effects are missing. Every candidate at every place is judged by its evidence, with a charge for each
//! parameter and for having examined many places.
//!
//! Each stage adds one effect. All candidates are screened with the model linearized about the fit so far, and the best
//! are fitted in full. From two effects on, each effect is dropped and exchanged for all others until nothing improves.
//! This corrects mistakes of the greedy search.

use super::search::{Scored, Search};
use super::unnamed::{self, Better};
use crate::arm::joint_law::{Curve, JointLaw};
use crate::reconcile::fit::descent::{
    Effort, Fit, Point, bounded_step, change, descent, evaluate, evaluate_near, fit, jacobian, objective,
};
use crate::reconcile::fit::normal::{Extended, Shared};
use crate::reconcile::fit::steps::WIDE_SMOOTHING;
use crate::reconcile::fit::weights::Weights;
use crate::reconcile::model::parameters::{Candidate, Model};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::cell::OnceCell;

/// Smallest rise of the score \[ln of the evidence\] for which a second or third effect is accepted. It is above zero,
/// because two missing effects are less probable than one. For a first effect any rise is enough, because a missing
/// effect is taken to be as probable as none.
const LEAST_GAIN: f64 = 3.0;
/// As many alternatives to an effect are listed as are needed for the effect or one of them to be right with this
/// probability.
const CREDIBLE_PROBABILITY: f64 = 0.95;
/// A model whose score after a few steps of a fit is below the best score by more than this is not fitted further \[ln
/// of the evidence\].
const HOPELESS_DEFICIT: f64 = 40.0;
/// A model whose score is below the best of its stage by less than this may still be the best one, and is refined or
/// fitted again \[ln of the evidence\].
const PROMISING_DEFICIT: f64 = 12.0;
/// Largest number of effects in a model.
pub(crate) const MOST_EFFECTS: usize = 3;
/// If a law without a name raises the logarithm of the evidence by this much more than the best effects do, these
/// effects are not the cause. The search then ends.
const SETTLING_GAIN: f64 = 12.0;
/// Largest number of variants of one effect (the same effect with different parameters free) among the candidates
/// that are fitted in full.
const MOST_VARIANTS: usize = 2;
/// If the objectives of two fits of the same model differ by more than this, the fit with the larger one had not
/// converged.
const CONVERGED_WITHIN: f64 = 0.5;
/// Models whose objective after a few steps exceeds the lowest by less than this fraction are fitted further. Where
/// no model is near an explanation, a few steps do not show how good a model is.
const UNDECIDED_FRACTION: f64 = 0.1;
/// Sizes of effects at which candidates are tried if much is missing, as fractions of the sizes at which their fits
/// start.
const TRIED_SIZES: [f64; 3] = [0.1, 0.3, 1.0];
/// A calibrated factor is far from nominal beyond this \[standard deviations of its tolerance\]. One faultless part in
/// sixteen thousand deviates so far.
const FAR_CALIBRATED: f64 = 4.0;
/// If chi-squared of a model is below this fraction of its expectation, the residuals are far below the declared
/// noise.
const FAR_BELOW_NOISE: f64 = 0.5;
/// Number of candidates that are fitted in full when one effect is to be added.
const FULL_FITS: usize = 7;

/// The result of a search for effects.
pub(crate) struct Selection {
    /// The model with the best score that the search accepted.
    pub best: Scored,
    /// The baseline: calibration and no effect.
    pub baseline: Scored,
    /// All models that were fitted, the best first.
    pub others: Vec<Scored>,
    /// Whether the search was given up, because a law without a name is far better.
    pub given_up: bool,
}

/// A candidate that was added to a model without a full fit.
pub(crate) struct Screened {
    /// Index of the candidate.
    pub(crate) candidate: usize,
    /// The parameters from which a full fit starts.
    pub(crate) u: Vec<f64>,
    score: f64,
}

impl Screened {
    fn best_first(a: &Self, b: &Self) -> std::cmp::Ordering {
        b.score.total_cmp(&a.score).then(a.candidate.cmp(&b.candidate))
    }
}

/// The predictions of a model at one point, and their derivatives at this point.
struct Linearized {
    here: Point,
    slopes: Shared,
}

impl<'a> Search<'a> {
    /// Searches for the missing effects. `before` is the best model of an earlier search. If it has two effects or
    /// more, the search starts from it.
    pub(crate) fn run(&self, before: Option<&Scored>) -> Selection {
        let baseline_model = self.model(&[]);
        let mut baseline_fit = self.fit(&[], &vec![0.0; baseline_model.len()], Effort::default());
        let mut baseline = self.scored(&[], &baseline_fit);
        let mut seen: Vec<Scored> = Vec::new();
        let mut best = baseline.clone();
        if let Some(known) = before.filter(|b| b.effects.len() > 1) {
            let effort = Effort { steps: 12, tolerance: 0.02 };
            let again = fit(self.forward, &self.model(&known.effects), &known.u, self.weights, effort);
            best = self.repair(self.scored(&known.effects, &again), &mut seen);
            if best.score < baseline.score {
                best = baseline.clone();
            }
        }
        // the law without a name is computed only if a first effect is found
        let mut law = OnceCell::new();
        let mut given_up = false;
        while best.effects.len() < MOST_EFFECTS {
            if self.is_below_noise(&best) {
                break;
            }
            let tried = self.extend(&best, &seen);
            seen.extend(tried.iter().cloned());
            // several missing effects are less probable than one
            let worth = if best.effects.is_empty() { 0.0 } else { LEAST_GAIN };
            let Some(next) = better(&tried, best.score + worth) else { break };
            best = self.settled(next);
            if let Some(lower) = self.lower_baseline(&best, &baseline) {
                baseline = self.scored(&[], &lower);
                (baseline_fit, law) = (lower, OnceCell::new());
                seen.clear(); // these fits started from a calibration that had not converged
                if best.score < baseline.score {
                    best = baseline.clone();
                    continue;
                }
            }
            let law = law.get_or_init(|| unnamed::better_than_calibration(self, &baseline_fit));
            given_up = self.is_settled_by(law, &baseline, &best);
            if given_up {
                break;
            }
            if best.effects.len() > 1 && (best.effects.len() < MOST_EFFECTS || self.may_explain(&best)) {
                best = self.repair(best, &mut seen);
            }
        }
        seen.sort_by(|a, b| b.score.total_cmp(&a.score));
        Selection { best, baseline, others: seen, given_up }
    }

    /// Fits the calibration alone once more, from the calibrated parameters of `best`, the model with its first
    /// effect. Returns this fit if its objective is lower than that of `baseline` by more than [`CONVERGED_WITHIN`],
    /// otherwise `None`. A lower objective shows that `baseline` had not converged, and that the effect may only
    /// compensate for this.
    fn lower_baseline(&self, best: &Scored, baseline: &Scored) -> Option<Fit<'a>> {
        if best.effects.len() != 1 {
            return None;
        }
        let (effects, u) = self.without(best, 0);
        let again = self.fit(&effects, &u, Effort::default());
        (again.point.objective < baseline.objective - CONVERGED_WITHIN).then_some(again)
    }

    /// Whether the search ends because the law without a name `law` raises the logarithm of the evidence above `best`
    /// by more than [`SETTLING_GAIN`]. If `best` has one effect so far, the law must also leave no more than noise,
    /// because two effects could still be better.
    fn is_settled_by(&self, law: &Option<Better>, baseline: &Scored, best: &Scored) -> bool {
        let readings = self.forward.data.len() as f64;
        let noise = readings + 2.0 * (2.0 * readings).sqrt();
        law.as_ref().is_some_and(|law| {
            baseline.score + law.gain > best.score + SETTLING_GAIN
                && (best.effects.len() > 1 || law.objective < noise)
        })
    }

    /// Fits the promising models of the selection `before` again, with the weights of this search, and chooses among
    /// them. Models with only some of the best model's effects are included, because the other effects may have been
    /// named only because of the earlier weights.
    pub(crate) fn weigh_again(&self, before: &Selection) -> Selection {
        let mut promising: Vec<Scored> = vec![before.baseline.clone()];
        let near = before.others.iter().filter(|s| s.score > before.best.score - PROMISING_DEFICIT).cloned();
        let parts = self.parts(&before.best);
        for scored in [before.best.clone()].into_iter().chain(parts).chain(near) {
            if promising.iter().all(|p| !same_set(&p.effects, &scored.effects)) {
                promising.push(scored);
            }
        }
        let effort = Effort { steps: 12, tolerance: 0.02 };
        let again = |s: &Scored| {
            // break points are moved to the middle of the range in which the objective is flat, so that all models are
            // compared in the same way
            let model = self.model(&s.effects);
            let end = self.descent(&model, &s.u, effort);
            self.scored(&s.effects, &self.centre_breaks(model, end))
        };
        let mut seen: Vec<Scored> = promising.par_iter().map(again).collect();
        let baseline = seen.remove(0);
        let net = |s: &&Scored| s.score - s.effects.len().saturating_sub(1) as f64 * LEAST_GAIN;
        let is_more = |s: &&Scored| {
            let is_part = |part: &Scored| {
                part.effects.len() < s.effects.len() && part.effects.iter().all(|e| s.effects.contains(e))
            };
            !seen.iter().any(|part| is_part(part) && self.is_below_noise(part))
        };
        let open = seen.iter().filter(is_more);
        let best = open.chain([&baseline]).max_by(|a, b| net(a).total_cmp(&net(b)));
        let best = best.cloned().unwrap_or_else(|| baseline.clone());
        seen.sort_by(|a, b| b.score.total_cmp(&a.score));
        Selection { best, baseline, others: seen, given_up: before.given_up }
    }

    /// Whether the residuals of a model with effects are far below the declared noise: chi-squared is less than half
    /// of its expectation, and lower than chance explains. A further effect would then describe errors that are
    /// smaller than the declared ones.
    fn is_below_noise(&self, scored: &Scored) -> bool {
        let counted = self.weights.inverse.iter().filter(|w| **w > 0.0).count() as f64;
        let fitted = self.model(&scored.effects).free_parameters().count() as f64;
        let expected = (counted - fitted).max(1.0);
        !scored.effects.is_empty()
            && scored.objective < FAR_BELOW_NOISE * expected
            && scored.objective < expected - 3.0 * (2.0 * expected).sqrt()
    }

    /// Drops each effect of `best` in turn, or exchanges it for another candidate, until nothing improves, at most four
    /// times. An effect is dropped unless it raises the score by at least [`LEAST_GAIN`]. All models that are fitted
    /// are added to `seen`.
    fn repair(&self, mut best: Scored, seen: &mut Vec<Scored>) -> Scored {
        for _ in 0..4 {
            let mut improved = false;
            for i in 0..best.effects.len() {
                let (effects, start) = self.without(&best, i);
                let dropped = self.scored(&effects, &self.fit(&effects, &start, Effort::default()));
                let dropped = self.settled(dropped);
                let swapped = self.extend(&dropped, seen);
                seen.push(dropped.clone());
                seen.extend(swapped.iter().cloned());
                let fewer = (dropped.score + LEAST_GAIN > best.score).then(|| dropped.clone());
                if let Some(next) = fewer.or_else(|| better(&swapped, best.score + 1e-3)) {
                    best = next;
                    improved = true;
                    break;
                }
            }
            if !improved {
                break;
            }
        }
        best
    }

    /// The models with some, but not all, effects of the model `scored`. Their parameters are those of `scored`, and
    /// they are not fitted.
    fn parts(&self, scored: &Scored) -> Vec<Scored> {
        let mut parts: Vec<Scored> = Vec::new();
        let mut open = vec![scored.clone()];
        while let Some(whole) = open.pop() {
            for effect in 0..whole.effects.len() {
                let (effects, u) = self.without(&whole, effect);
                if !effects.is_empty() && parts.iter().all(|part| !same_set(&part.effects, &effects)) {
                    parts.push(Scored { effects, u, ..whole });
                    open.push(parts[parts.len() - 1].clone());
                }
            }
        }
        parts
    }

    /// Fits of the model `base` with one more effect, for the candidates that the screening finds most promising.
    /// Models that are in `seen` were fitted before and are copied from there.
    fn extend(&self, base: &Scored, seen: &[Scored]) -> Vec<Scored> {
        let mut screened = self.screen(base);
        if !self.may_explain(base) || self.is_far_calibrated(base) {
            // a calibration that compensates for missing physics is far from its value with the right effect
            let nominal = self.uncalibrated(base);
            screened.extend(self.screen(&nominal));
            screened.extend(self.by_size(&nominal));
        }
        let starts = screened.into_iter().map(|s| ([base.effects.as_slice(), &[s.candidate]].concat(), s.u));
        let mut known: Vec<Scored> = Vec::new();
        let mut fresh: Vec<(Vec<usize>, Vec<f64>)> = Vec::new();
        for (effects, u) in starts {
            match seen.iter().filter(|s| same_set(&s.effects, &effects)).max_by(by_score) {
                Some(before) => known.push(before.clone()),
                None => fresh.push((effects, u)),
            }
        }
        let rough = |(effects, u): (Vec<usize>, Vec<f64>)| self.scored(&effects, &self.rough(&effects, &u));
        let first: Vec<Scored> = fresh.into_par_iter().map(rough).collect();
        let top = first.iter().chain(&known).map(|f| f.score).fold(f64::NEG_INFINITY, f64::max);
        // a few steps show which models are poor; the others are fitted in full
        let lowest = first.iter().map(|f| f.objective).fold(f64::INFINITY, f64::min);
        let (near, far): (Vec<Scored>, Vec<Scored>) = first
            .into_iter()
            .partition(|s| s.score > top - HOPELESS_DEFICIT.max(UNDECIDED_FRACTION * lowest / 2.0));
        let effort = Effort { steps: 14, tolerance: 0.02 };
        let in_full = |s: Scored| self.scored(&s.effects, &self.fit(&s.effects, &s.u, effort));
        let mut fits: Vec<Scored> = near.into_par_iter().map(in_full).collect();
        let top = fits.iter().chain(&known).map(|f| f.score).fold(f64::NEG_INFINITY, f64::max);
        self.regrid(&mut fits, top - PROMISING_DEFICIT);
        fits.extend(far);
        fits.extend(known);
        fits
    }

    /// Whether a calibrated factor of the model is so far from its nominal value that something else is probably
    /// missing.
    fn is_far_calibrated(&self, scored: &Scored) -> bool {
        scored.u[..self.model(&[]).len()].iter().any(|deviation| deviation.abs() > FAR_CALIBRATED)
    }

    /// The model `scored` with all calibrated parameters at their nominal values.
    fn uncalibrated(&self, scored: &Scored) -> Scored {
        let mut out = scored.clone();
        out.u[..self.model(&[]).len()].fill(0.0);
        out
    }

    /// Searches the break points of the gear curves in the models `fits` over a grid, at first without the
    /// frequencies. This is done only for models whose score is above `least` and that may be the explanation,
    /// because a model that still lacks an effect does not need such exact break points. If there are three effects,
    /// only a curve that was added last is searched, because the others were searched in models with two effects.
    fn regrid(&self, fits: &mut [Scored], least: f64) {
        for scored in fits.iter_mut().filter(|s| s.score > least && self.may_explain(s)) {
            let curve = scored.effects.iter().rposition(|&e| self.candidates[e].kind.traits.is_gear_curve);
            let Some(position) = curve else { continue };
            if position + 1 < scored.effects.len() && scored.effects.len() > 2 {
                continue;
            }
            let fit = self.over_breaks(scored, position);
            let again = self.scored(&scored.effects, &fit);
            if again.score > scored.score {
                *scored = again;
            }
        }
    }

    /// The best fit of the model `from` over the grid of break points of its effect number `position`, a gear's
    /// curve.
    fn over_breaks(&self, from: &Scored, position: usize) -> Fit<'a> {
        let model = self.model(&from.effects);
        let first = model.first_parameter(position);
        let smooth = self.weights.without_modes(self.forward);
        let effort = Effort { steps: 8, tolerance: 0.05 };
        let starts = &model.effects[position].starts;
        let mut tried: Vec<(f64, Vec<f64>)> = starts
            .par_iter()
            .map(|start| {
                let mut u = from.u.clone();
                u[first..first + start.len()].copy_from_slice(start);
                let end = descent(self.forward, &model, &u, &smooth, effort, f64::INFINITY);
                (end.objective, end.u)
            })
            .collect();
        tried.sort_by(|a, b| a.0.total_cmp(&b.0));
        tried.truncate(2);
        let effort = Effort { steps: 12, tolerance: 0.02 };
        let fits: Vec<Fit<'a>> =
            tried.into_par_iter().map(|(_, u)| self.fit(&from.effects, &u, effort)).collect();
        fits.into_iter()
            .min_by(|a, b| a.point.objective.total_cmp(&b.point.objective))
            .expect("at least one start")
    }

    /// The candidates that, according to the linearized model, raise the score of the model `base` most, the best
    /// first.
    fn screen(&self, base: &Scored) -> Vec<Screened> {
        self.screen_among(base, |_| true)
    }

    /// The same as [`Self::screen`], but among the candidates for which `is_open` is true.
    pub(crate) fn screen_among(
        &self,
        base: &Scored,
        is_open: impl Fn(&Candidate) -> bool + Sync,
    ) -> Vec<Screened> {
        let model = self.model(&base.effects);
        let sharp = self.linearized(&model, &base.u);
        // the smoothing must be the same before and after a change, because the nominal curves of other joints have
        // jumps too
        let is_curved = |law: &JointLaw| matches!(law.curve, Curve::Windup(_));
        let smooth = sharp.here.coefficients.laws.iter().any(is_curved).then(|| {
            let model = Model { smoothing: WIDE_SMOOTHING, ..model.clone() };
            self.linearized(&model, &base.u)
        });
        // a further effect can move torques across the fitted break points, and the linearized model does not contain
        // the jumps there
        let about = |candidate: usize| match self.is_smoothed(&model, candidate) {
            true => smooth.as_ref().unwrap_or(&sharp),
            false => &sharp,
        };
        let mut tried: Vec<Screened> = (0..self.candidates.len())
            .into_par_iter()
            .filter(|i| self.is_new(base, *i) && is_open(&self.candidates[*i]))
            .filter_map(|i| self.best_start(&model, about(i), i))
            .map(|s| Screened { score: s.score - self.price(&[s.candidate]), ..s })
            .collect();
        tried.sort_by(Screened::best_first);
        // variants of one effect must not displace other effects from the list
        let mut variants: Vec<usize> = Vec::new();
        tried.retain(|&Screened { candidate: i, .. }| {
            let own = variants.iter().filter(|v| self.candidates[**v].is_variant_of(&self.candidates[i]));
            let is_kept = own.count() < MOST_VARIANTS;
            variants.push(i);
            is_kept
        });
        tried.truncate(FULL_FITS);
        tried
    }

    /// Whether the model `base` has no variant of the candidate with the index `candidate`.
    fn is_new(&self, base: &Scored, candidate: usize) -> bool {
        base.effects.iter().all(|e| !self.candidates[*e].is_variant_of(&self.candidates[candidate]))
    }

    /// The candidates that come closest to the readings when they are added to the model `base` at one of a few
    /// sizes, the closest first. Their score is minus half of the objective. They are needed if much is missing: a model
    /// that is linearized about `base` then does not predict the effect of a candidate on the frequencies well enough.
    fn by_size(&self, base: &Scored) -> Vec<Screened> {
        let model = self.model(&base.effects);
        let here = evaluate(self.forward, &model, &base.u, self.weights);
        // frequencies take long to solve for: displacements choose the start, frequencies choose the size
        let smooth = self.weights.without_modes(self.forward);
        let best_size = |index: usize| {
            let candidate = &self.candidates[index];
            let with = model.with(candidate);
            let sized = |start: &Vec<f64>, part: f64| -> Vec<f64> {
                let own = candidate.free_parameters.iter().zip(start);
                let own = own.map(|(parameter, u)| parameter.scaled(*u, part));
                base.u.iter().copied().chain(own).collect()
            };
            let misfit = |u: &[f64], weights: &Weights| {
                evaluate_near(self.forward, &with, u, weights, Some(&here)).objective
            };
            let best_start = |part: f64| {
                let starts = candidate.starts.iter().map(|start| sized(start, part));
                match candidate.starts.len() {
                    0 | 1 => starts.into_iter().next(),
                    _ => least(starts.map(|u| (misfit(&u, &smooth), u))).map(|(_, u)| u),
                }
            };
            let tried = TRIED_SIZES.into_iter().filter_map(best_start);
            let (objective, u) = least(tried.map(|u| (misfit(&u, self.weights), u)))?;
            Some(Screened { candidate: index, u, score: -0.5 * objective })
        };
        let open = (0..self.candidates.len()).into_par_iter().filter(|i| self.is_new(base, *i));
        let mut tried: Vec<Screened> = open.filter_map(best_size).collect();
        tried.sort_by(Screened::best_first);
        tried.truncate(FULL_FITS);
        tried
    }

    fn linearized(&self, model: &Model, u: &[f64]) -> Linearized {
        let here = evaluate(self.forward, model, u, self.weights);
        let slopes = jacobian(self.forward, model, &here);
        let slopes = Shared::new(self.forward, &here.predicted, slopes, self.weights);
        Linearized { here, slopes }
    }

    /// Whether a candidate is screened with the jumps of the frequencies smoothed. This is so if the candidate causes
    /// jumps itself, or if the model `base` already has fitted break points.
    fn is_smoothed(&self, base: &Model, candidate: usize) -> bool {
        self.candidates[candidate].kind.traits.steps_frequencies() || !base.break_points().is_empty()
    }

    fn best_start(&self, base: &Model<'a>, about: &Linearized, index: usize) -> Option<Screened> {
        let Linearized { here, slopes } = about;
        let candidate = &self.candidates[index];
        let mut model = base.with(candidate);
        model.smoothing = if self.is_smoothed(base, index) { WIDE_SMOOTHING } else { 0.0 };
        // break points are held fixed, because the linearized model does not contain the jumps of the frequencies there
        model.held =
            model.break_points().into_iter().filter(|p| *p < base.len()).map(|p| (p, here.u[p])).collect();
        let held = model.held.clone();
        let mut at_start = |start: &[f64]| {
            model.held = held.clone();
            if candidate.kind.traits.screens_at_starts {
                let numbers = candidate.free_parameters.iter().zip(start).enumerate();
                let kept = numbers.filter(|(_, (parameter, _))| !parameter.is_size());
                model.held.extend(kept.map(|(i, (_, u))| (base.len() + i, *u)));
            }
            self.linear(&model, here, slopes, start)
        };
        candidate
            .starts
            .iter()
            .map(|start| at_start(start))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(u, score)| Screened { candidate: index, u, score })
    }

    /// Best parameters and score of the model `model` (the model at `here` and one candidate). The model is linearized
    /// about the parameters of `here` and the candidate's start `start`; `slopes` are the derivatives at `here`.
    fn linear(&self, model: &Model, here: &Point, slopes: &Shared, start: &[f64]) -> (Vec<f64>, f64) {
        let mut u = here.u.clone();
        u.extend_from_slice(start);
        let base = change(self.forward, model, here, &u);
        let mut own = DMatrix::zeros(base.len(), start.len());
        for (p, mut column) in (here.u.len()..u.len()).zip(own.column_iter_mut()) {
            let (_, high) = model.bounds(p);
            // the changed value must stay within the bounds
            let step = if u[p] + 1e-3 > high { -1e-3 } else { 1e-3 };
            let mut moved = u.clone();
            moved[p] += step;
            let ahead = change(self.forward, model, here, &moved);
            let changes = ahead.iter().zip(&base);
            column.iter_mut().zip(changes).for_each(|(slope, (ahead, base))| *slope = (ahead - base) / step);
        }
        let columns = Extended { shared: slopes, own };
        let origin = DVector::from_vec(u.clone());
        let at = |u: &[f64]| -> Vec<f64> {
            let delta = columns.times(&(DVector::from_column_slice(u) - &origin));
            here.predicted.iter().zip(&base).zip(delta.iter()).map(|((p, b), d)| p + b + d).collect()
        };
        let mut predicted = at(&u);
        let mut curvature = DMatrix::zeros(0, 0);
        for _ in 0..4 {
            let normal = columns.normal(self.forward, model.calibrated(), &u, &predicted, self.weights);
            u = bounded_step(model, &u, &normal, 1e-6);
            predicted = at(&u);
            curvature = normal.curvature;
        }
        let objective = objective(self.forward, model, &u, &predicted, self.weights);
        let mut score = -0.5 * objective;
        for (i, parameter) in model.free_parameters().enumerate() {
            let p = model.calibrated() + i;
            let prior = parameter.width(u[p]);
            let width = 1.0 / (curvature[(p, p)] + 12.0 / prior.powi(2)).sqrt();
            // a free parameter multiplies the evidence by the width of its posterior divided by the width of its prior;
            // 0.9 is ln of the root of 2 pi
            score += libm::log(width / prior) + 0.9;
        }
        (u, score)
    }

    /// For each effect of the model `best`, the models of `seen` that have another effect in place of this one and that
    /// the data cannot tell from `best`.
    ///
    /// The most probable model comes first. There are as many as are needed so that they and `best` together contain
    /// the right model with a probability of 95 %.
    pub(crate) fn alternatives(&self, best: &Scored, seen: &[Scored]) -> Vec<Vec<Scored>> {
        (0..best.effects.len())
            .map(|i| {
                let mut rest = best.effects.clone();
                let own = rest.remove(i);
                let in_its_place = |s: &&Scored| {
                    s.effects.len() == best.effects.len()
                        && s.effects.iter().all(|e| !self.candidates[*e].is_variant_of(&self.candidates[own]))
                        && rest.iter().all(|e| s.effects.contains(e))
                };
                let mut competitors: Vec<Scored> = Vec::new();
                for competitor in seen.iter().filter(in_its_place) {
                    if competitors.iter().all(|r| r.effects != competitor.effects) {
                        competitors.push(competitor.clone());
                    }
                }
                // the score is a logarithm of probability, so its difference gives the odds
                let odds = |s: &Scored| libm::exp(s.score - best.score);
                let all = 1.0 + competitors.iter().map(odds).sum::<f64>();
                let mut held = 1.0;
                competitors.retain(|s| {
                    let needed = held < CREDIBLE_PROBABILITY * all;
                    held += odds(s);
                    needed
                });
                competitors
            })
            .collect()
    }
}

/// The entry of `tried` with the smallest misfit (objective): this misfit, and the parameters; `None` if there are no
/// entries.
fn least(tried: impl Iterator<Item = (f64, Vec<f64>)>) -> Option<(f64, Vec<f64>)> {
    tried.min_by(|a, b| a.0.total_cmp(&b.0))
}

fn by_score(a: &&Scored, b: &&Scored) -> std::cmp::Ordering {
    a.score.total_cmp(&b.score)
}

fn same_set(a: &[usize], b: &[usize]) -> bool {
    a.len() == b.len() && a.iter().all(|e| b.contains(e))
}

fn better(tried: &[Scored], than: f64) -> Option<Scored> {
    tried.iter().filter(|s| s.score > than).max_by(|a, b| a.score.total_cmp(&b.score)).cloned()
}
