//! Which effects are missing: every candidate at every place, judged by evidence that pays for each
//! parameter and for having looked in many places.
//!
//! One stage adds one effect: all candidates are screened with the model made linear about the fit so
//! far, the best are fitted in full. From two effects on each is dropped and swapped against all others
//! until nothing improves, which repairs greedy mistakes.

use super::search::{Scored, Search};
use super::unnamed::{self, Better};
use crate::reconcile::fit::descent::{
    Effort, Fit, Normal, Point, bounded_step, change, descent, evaluate, fit, jacobian, normal, objective,
};
use crate::reconcile::model::parameters::Model;
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
/// Models within this score of a stage's best are worth a closer look.
const PROMISING: f64 = 12.0;
/// Most effects.
pub const MOST_EFFECTS: usize = 3;
/// Rise of the evidence over the best effects by which a law without a name settles that they are not it.
const SETTLES: f64 = 12.0;
/// Candidates fitted in full at each stage.
const FULL_FITS: usize = 7;

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
        here: &Point,
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
    fn linear(&self, model: &Model, here: &Point, slopes: &DMatrix<f64>, start: &[f64]) -> (Vec<f64>, f64) {
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
