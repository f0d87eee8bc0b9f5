//! Which effects are missing: every candidate at every place, judged by evidence that pays for each
//! parameter and for having looked in many places.
//!
//! One stage adds one effect: all candidates are screened with the model made linear about the fit so
//! far, the best are fitted in full. From two effects on each is dropped and swapped against all others
//! until nothing improves, which repairs greedy mistakes.

use super::unnamed::{self, Better};
use crate::reconcile::fit::descent::{
    Effort, Fit, Normal, Point, Weights, bounded_step, change, descent, evaluate, fit, jacobian, normal,
    objective,
};
use crate::reconcile::forward::Forward;
use crate::reconcile::model::parameters::{Candidate, Model, Nuisance};
use crate::reconcile::readings::campaign::Campaign;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::cell::OnceCell;

/// Rise of the score that a further effect must bring: two things missing at once are rarer than one.
const WORTH: f64 = 3.0;
/// Rise of the score that the first effect must bring: that something is missing is as likely as not.
const FIRST_WORTH: f64 = 0.0;
/// Part of the probability that an effect and its alternatives must hold together.
const CREDIBLE: f64 = 0.95;
/// Models this far behind after a few steps are not fitted further.
const HOPELESS: f64 = 40.0;
/// Smoothing of a gear's curve, in ln of the torque: so that a descent sees past the frequencies' steps, and so
/// that they are nearly sharp.
const WIDE: f64 = 0.1;
const NARROW: f64 = 0.01;
/// Rise of the objective beyond which a break point is not followed further.
const RULED_OUT: f64 = 14.0;
/// Models within this score of a stage's best are worth a closer look.
const PROMISING: f64 = 12.0;
/// Most effects.
pub const MOST_EFFECTS: usize = 3;
/// Objective per datum above which a model cannot become the explanation, whatever the declared deviations.
const BEYOND_HOPE: f64 = 3.0;
/// Rise of the evidence over the best effects by which a law without a name settles that they are not it.
const SETTLES: f64 = 12.0;
/// Candidates fitted in full at each stage.
const FULL_FITS: usize = 7;

/// All that a search needs.
pub struct Search<'a> {
    /// Campaign.
    pub campaign: &'a Campaign,
    /// Prepared campaign.
    pub forward: &'a Forward,
    /// Calibration.
    pub nuisance: &'a Nuisance,
    /// Candidates.
    pub candidates: &'a [Candidate],
    /// Weights of the data.
    pub weights: &'a Weights,
}

/// A model with its score.
#[derive(Clone)]
pub struct Scored {
    /// Indices of the candidates in it.
    pub effects: Vec<usize>,
    /// Its parameters.
    pub u: Vec<f64>,
    /// Evidence less ln of the number of candidates for each effect.
    pub score: f64,
    /// `Σ ρ(r) + Σ u²`.
    pub objective: f64,
}

/// What a search found.
pub struct Selection {
    /// The best model.
    pub best: Scored,
    /// Calibration only.
    pub bare: Scored,
    /// Every other model that was fitted, best first.
    pub others: Vec<Scored>,
    /// Whether a law without a name is so much better that the search was given up.
    pub given_up: bool,
}

impl<'a> Search<'a> {
    /// A model of the named candidates.
    pub fn model(&self, effects: &[usize]) -> Model<'a> {
        Model::of(self.nuisance, self.candidates, effects)
    }

    /// Fits the model of the named candidates from `u`.
    pub fn fit(&self, effects: &[usize], u: &[f64], effort: Effort) -> Fit<'a> {
        self.fit_model(self.model(effects), u, effort)
    }

    /// Fits a model from `u`; where the last effect is a gear's curve, its break points' steps in the
    /// frequencies are first smoothed, then sharpened.
    fn fit_model(&self, mut model: Model<'a>, u: &[f64], effort: Effort) -> Fit<'a> {
        let mut start = u.to_vec();
        if !self.forward.modal.is_empty()
            && model.effects.last().is_some_and(|e| e.kind.name == "soft_windup")
        {
            for smoothing in [WIDE, 0.03, NARROW] {
                model.smoothing = smoothing;
                let steps = Effort { steps: 8, tolerance: 0.05 };
                start = self.descent(&model, &start, steps).u;
            }
            model.smoothing = 0.0;
        }
        fit(self.forward, &model, &start, self.weights, effort)
    }

    fn descent(&self, model: &Model, u: &[f64], effort: Effort) -> Point {
        descent(self.forward, model, u, self.weights, effort, f64::INFINITY)
    }

    /// A few steps, enough to see whether a model is near; where its last effect is a gear's curve, after a few
    /// with the frequencies' steps smoothed widely.
    fn rough(&self, effects: &[usize], u: &[f64]) -> Fit<'a> {
        let mut model = self.model(effects);
        let mut start = u.to_vec();
        let few = Effort { steps: 4, tolerance: 0.02 };
        if model.effects.last().is_some_and(|e| e.kind.name == "soft_windup") {
            let smoothed = Effort { steps: 6, tolerance: 0.05 };
            model.smoothing = WIDE;
            start = self.descent(&model, &start, smoothed).u;
            model.smoothing = NARROW;
        }
        fit(self.forward, &model, &start, self.weights, few)
    }

    /// Fits a model to the end: the break points of a gear's curve are moved in steps, because the
    /// frequencies' steps at them hide lower ground from a descent.
    pub fn polish(&self, effects: &[usize], u: &[f64]) -> Fit<'a> {
        let model = self.model(effects);
        let breaks = model.break_points();
        if breaks.is_empty() {
            return fit(self.forward, &model, u, self.weights, Effort::default());
        }
        let mut best = self.descent(&model, u, Effort::default());
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

    /// A model that may be the explanation, fitted to the end if it has break points: else a further effect is
    /// found that only makes good what the descent left.
    fn settled(&self, scored: Scored) -> Scored {
        if self.model(&scored.effects).break_points().is_empty() || !self.may_explain(&scored) {
            return scored;
        }
        let polished = self.scored(&scored.effects, &self.polish(&scored.effects, &scored.u));
        if polished.score > scored.score { polished } else { scored }
    }

    /// Moves break points from the brink of a frequency's step into the middle of where the objective is
    /// flat, so that a small change of the torques does not carry a test across.
    fn centre_breaks(&self, model: Model<'a>, best: Point) -> Fit<'a> {
        const STEP: f64 = 0.002;
        let mut u = best.u.clone();
        for p in model.break_points() {
            let flat = |side: f64| {
                let rises = (1..=10).map(|i| {
                    let mut moved = u.clone();
                    moved[p] += side * STEP * i as f64;
                    evaluate(self.forward, &model, &moved, self.weights).objective
                });
                rises.take_while(|o| *o < best.objective + 1.0).count() as f64
            };
            let middle = 0.5 * STEP * (flat(1.0) - flat(-1.0));
            u[p] += middle;
        }
        let mut held = model.clone();
        held.held = model.break_points().into_iter().map(|p| (p, u[p])).collect();
        let centred = self.descent(&held, &u, Effort { steps: 4, tolerance: 0.02 });
        let end = if centred.objective > best.objective + 4.0 { best } else { centred };
        fit(self.forward, &model, &end.u, self.weights, Effort { steps: 0, tolerance: 0.0 })
    }

    /// Descends with a parameter held at a value, then lets it go, unless the readings rule the value out.
    fn held_then_free(&self, model: &Model, from: &Point, parameter: usize, value: f64) -> Option<Point> {
        let effort = Effort { steps: 5, tolerance: 0.02 };
        let mut held = model.clone();
        held.held = vec![(parameter, value)];
        let limit = from.objective + RULED_OUT;
        let end = descent(self.forward, &held, &from.u, self.weights, effort, limit);
        (end.objective <= limit).then(|| self.descent(model, &end.u, effort))
    }

    /// The score of a fit.
    pub fn scored(&self, effects: &[usize], fit: &Fit) -> Scored {
        let penalty = effects.len() as f64 * (self.places() as f64).ln();
        Scored {
            effects: effects.to_vec(),
            u: fit.point.u.clone(),
            score: fit.evidence - penalty,
            objective: fit.point.objective,
        }
    }

    /// Whether a model comes near enough to the readings to be worth refining.
    pub fn may_explain(&self, scored: &Scored) -> bool {
        scored.objective < BEYOND_HOPE * self.forward.data.len() as f64
    }

    /// In how many ways an effect could be named; a unit slip counts once a channel.
    pub fn places(&self) -> usize {
        let mut labels: Vec<String> = self.candidates.iter().map(|c| c.label()).collect();
        labels.dedup();
        labels.len()
    }

    /// Looks for the effects; from two effects on a model found before is a better start than nothing.
    pub fn run(&self, before: Option<&Scored>) -> Selection {
        let bare_model = self.model(&[]);
        let bare_fit =
            fit(self.forward, &bare_model, &vec![0.0; bare_model.len()], self.weights, Effort::default());
        let bare = self.scored(&[], &bare_fit);
        let mut seen: Vec<Scored> = Vec::new();
        let mut best = bare.clone();
        if let Some(known) = before.filter(|b| b.effects.len() > 1) {
            let effort = Effort { steps: 12, tolerance: 0.02 };
            let again = fit(self.forward, &self.model(&known.effects), &known.u, self.weights, effort);
            best = self.repair(self.scored(&known.effects, &again), &mut seen);
            if best.score < bare.score + FIRST_WORTH {
                best = bare.clone();
            }
        }
        let law = OnceCell::new();
        let mut given_up = false;
        while best.effects.len() < MOST_EFFECTS {
            let law = || law.get_or_init(|| unnamed::beside_calibration(self, &bare_fit));
            let tried = self.extend(&best, &seen);
            seen.extend(tried.iter().cloned());
            let worth = if best.effects.is_empty() { FIRST_WORTH } else { WORTH };
            let Some(next) = better(&tried, best.score + worth) else { break };
            best = self.settled(next);
            given_up = self.is_settled_by(law(), &bare, &best);
            if given_up {
                break;
            }
            if best.effects.len() > 1 && (best.effects.len() < MOST_EFFECTS || self.may_explain(&best)) {
                best = self.repair(best, &mut seen);
            }
        }
        seen.sort_by(|a, b| b.score.total_cmp(&a.score));
        Selection { best, bare, others: seen, given_up }
    }

    /// Whether further effects are not worth looking for, because a law without a name is far better than the best
    /// so far: than one effect where the law leaves no more than noise, for two could be better still.
    fn is_settled_by(&self, law: &Option<Better>, bare: &Scored, best: &Scored) -> bool {
        let readings = self.forward.data.len() as f64;
        let noise = readings + 2.0 * (2.0 * readings).sqrt();
        law.as_ref().is_some_and(|law| {
            bare.score + law.gain > best.score + SETTLES && (best.effects.len() > 1 || law.objective < noise)
        })
    }

    /// Fits the promising models of a selection again, with other weights, and chooses among them; those with some of the
    /// best one's effects too, for what the other weights were to blame for may have been named.
    pub fn weigh_again(&self, before: &Selection) -> Selection {
        let mut promising: Vec<Scored> = vec![before.bare.clone()];
        let near = before.others.iter().filter(|s| s.score > before.best.score - PROMISING).cloned();
        let parts = self.parts(&before.best);
        for scored in [before.best.clone()].into_iter().chain(parts).chain(near) {
            if promising.iter().all(|p| !same_set(&p.effects, &scored.effects)) {
                promising.push(scored);
            }
        }
        let effort = Effort { steps: 12, tolerance: 0.02 };
        let again = |s: &Scored| {
            // about the middle of where the objective is flat all are judged alike
            let model = self.model(&s.effects);
            let end = self.descent(&model, &s.u, effort);
            self.scored(&s.effects, &self.centre_breaks(model, end))
        };
        let mut seen: Vec<Scored> = promising.par_iter().map(again).collect();
        let bare = seen.remove(0);
        let worth = |s: &Scored| match s.effects.len() {
            0 => 0.0,
            n => FIRST_WORTH + (n - 1) as f64 * WORTH,
        };
        let net = |s: &&Scored| s.score - worth(s);
        let best = seen.iter().chain([&bare]).max_by(|a, b| net(a).total_cmp(&net(b)));
        let best = best.cloned().unwrap_or_else(|| bare.clone());
        seen.sort_by(|a, b| b.score.total_cmp(&a.score));
        Selection { best, bare, others: seen, given_up: before.given_up }
    }

    /// Drops and swaps effects until nothing improves.
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
                let fewer = (dropped.score + WORTH > best.score).then(|| dropped.clone());
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

    /// The models with some of a model's effects, started from it.
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

    /// A model without one of its effects, and where to start it from.
    pub fn without(&self, scored: &Scored, effect: usize) -> (Vec<usize>, Vec<f64>) {
        let model = self.model(&scored.effects);
        let first = model.first_knob(effect);
        let (mut effects, mut u) = (scored.effects.clone(), scored.u.clone());
        effects.remove(effect);
        u.drain(first..first + model.effects[effect].knobs.len());
        (effects, u)
    }

    /// The best models with one more effect; those that were fitted before are not fitted again.
    fn extend(&self, base: &Scored, seen: &[Scored]) -> Vec<Scored> {
        let screened = self.screen(base);
        let starts = screened.into_iter().map(|(c, u, _)| ([base.effects.as_slice(), &[c]].concat(), u));
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
        let (near, far): (Vec<Scored>, Vec<Scored>) =
            first.into_iter().partition(|s| s.score > top - HOPELESS);
        let effort = Effort { steps: 14, tolerance: 0.02 };
        let in_full = |s: Scored| self.scored(&s.effects, &self.fit(&s.effects, &s.u, effort));
        let mut fits: Vec<Scored> = near.into_par_iter().map(in_full).collect();
        let top = fits.iter().chain(&known).map(|f| f.score).fold(f64::NEG_INFINITY, f64::max);
        self.regrid(&mut fits, top - PROMISING);
        fits.extend(far);
        fits.extend(known);
        fits
    }

    /// Break points of the promising gear curves found over a grid, with the frequencies left out at first: where
    /// the model may be the explanation, for as long as more is missing they are not to be found that closely; in
    /// threes only those of a curve that is new, for the others have been found in pairs.
    fn regrid(&self, fits: &mut [Scored], least: f64) {
        for scored in fits.iter_mut().filter(|s| s.score > least && self.may_explain(s)) {
            let curve = scored.effects.iter().rposition(|&e| self.candidates[e].kind.name == "soft_windup");
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

    /// The best fit from the grid of break points of one effect.
    fn over_breaks(&self, from: &Scored, position: usize) -> Fit<'a> {
        let model = self.model(&from.effects);
        let first = model.first_knob(position);
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

    /// The most promising candidates with a start for each: candidate, parameters, score of the model
    /// made linear about the base.
    fn screen(&self, base: &Scored) -> Vec<(usize, Vec<f64>, f64)> {
        let model = self.model(&base.effects);
        let here = evaluate(self.forward, &model, &base.u, self.weights);
        let slopes = jacobian(self.forward, &model, &here);
        let mut tried: Vec<(usize, Vec<f64>, f64)> = (0..self.candidates.len())
            .into_par_iter()
            .filter(|i| !base.effects.contains(i))
            .filter_map(|i| self.best_start(&model, &here, &slopes, i))
            .collect();
        tried.sort_by(|a, b| b.2.total_cmp(&a.2).then(a.0.cmp(&b.0)));
        tried.truncate(FULL_FITS);
        tried
    }

    fn best_start(
        &self,
        base: &Model<'a>,
        here: &crate::reconcile::fit::descent::Point,
        slopes: &DMatrix<f64>,
        index: usize,
    ) -> Option<(usize, Vec<f64>, f64)> {
        let candidate = &self.candidates[index];
        let mut model = base.with(candidate);
        model.smoothing = 0.1;
        // a straight line knows nothing of the frequencies' steps at them
        model.held =
            model.break_points().into_iter().filter(|p| *p < base.len()).map(|p| (p, here.u[p])).collect();
        candidate
            .starts
            .iter()
            .map(|start| self.linear(&model, here, slopes, start))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(u, score)| (index, u, score))
    }

    /// Best parameters and score of a model made linear about `here` plus the candidate's start.
    fn linear(
        &self,
        model: &Model,
        here: &crate::reconcile::fit::descent::Point,
        slopes: &DMatrix<f64>,
        start: &[f64],
    ) -> (Vec<f64>, f64) {
        let mut u = here.u.clone();
        u.extend_from_slice(start);
        let base = change(self.forward, model, here, &u);
        let mut columns = slopes.clone().resize_horizontally(u.len(), 0.0);
        for p in here.u.len()..u.len() {
            let (_, high) = model.bounds(p);
            let step = if u[p] + 1e-3 > high { -1e-3 } else { 1e-3 };
            let mut moved = u.clone();
            moved[p] += step;
            let ahead = change(self.forward, model, here, &moved);
            for i in 0..base.len() {
                columns[(i, p)] = (ahead[i] - base[i]) / step;
            }
        }
        let origin = DVector::from_vec(u.clone());
        let at = |u: &[f64]| -> Vec<f64> {
            let delta = &columns * (DVector::from_column_slice(u) - &origin);
            here.predicted.iter().zip(&base).zip(delta.iter()).map(|((p, b), d)| p + b + d).collect()
        };
        let mut predicted = at(&u);
        let mut curvature = DMatrix::zeros(0, 0);
        for _ in 0..4 {
            let normal: Normal =
                normal(self.forward, model.calibrated(), &u, &predicted, &columns, self.weights);
            u = bounded_step(model, &u, &normal, 1e-6);
            predicted = at(&u);
            curvature = normal.curvature;
        }
        let objective = objective(self.forward, model, &u, &predicted, self.weights);
        let mut score = -0.5 * objective;
        for (i, knob) in model.knobs().enumerate() {
            let p = model.calibrated() + i;
            let prior = knob.width(u[p]);
            let width = 1.0 / (curvature[(p, p)] + 12.0 / prior.powi(2)).sqrt();
            score += (width / prior).ln() + 0.9;
        }
        (u, score)
    }

    /// Models with as many effects as the best, one of them another, that the data cannot tell from it:
    /// for each effect of the best the candidates that could stand in its place, the likeliest first, as
    /// many as make the right one be among them with 95 %.
    pub fn alternatives(&self, best: &Scored, seen: &[Scored]) -> Vec<Vec<Scored>> {
        (0..best.effects.len())
            .map(|i| {
                let mut rest = best.effects.clone();
                let own = rest.remove(i);
                let in_its_place = |s: &&Scored| {
                    s.effects.len() == best.effects.len()
                        && !s.effects.contains(&own)
                        && rest.iter().all(|e| s.effects.contains(e))
                };
                let mut rivals: Vec<Scored> = Vec::new();
                for rival in seen.iter().filter(in_its_place) {
                    if rivals.iter().all(|r| r.effects != rival.effects) {
                        rivals.push(rival.clone());
                    }
                }
                let odds = |s: &Scored| (s.score - best.score).exp();
                let all = 1.0 + rivals.iter().map(odds).sum::<f64>();
                let mut held = 1.0;
                rivals.retain(|s| {
                    let needed = held < CREDIBLE * all;
                    held += odds(s);
                    needed
                });
                rivals
            })
            .collect()
    }
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
