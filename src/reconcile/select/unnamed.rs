//! Smooth laws that no effect of the library has, as rivals of the effects that were named.
//!
//! An effect of the library can imitate physics that the library lacks: a joint that stiffens as it is
//! loaded looks like lost motion, a sensor that is not straight like a gain. So every named effect must stand
//! against general [`laws`](super::laws), fitted jointly with the calibration, beside the named effects or
//! instead of them.

use super::laws::{Law, laws};
use super::search::{Scored, Search};
use super::structure::Structure;
use crate::reconcile::fit::descent::{Effort, Fit, Weights, normal, objective};
use crate::reconcile::fit::stats::ln_chi_squared_tail;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::readings::campaign::Campaign;
use nalgebra::{Cholesky, DMatrix, DVector};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Part of a law's full size, at which a stiffness or a reading changes by all of itself, below which
/// sizes are equally likely.
const SMALL: f64 = 0.02;
/// Most reweighted steps of the linear fit.
const STEPS: usize = 6;
/// Fall of the objective at which the linear fit is at its end.
const SETTLED: f64 = 0.01;
/// Rise of the evidence from which a law without a name is believed rather than effects with one, and
/// from which it is mentioned where no effect is named.
const BETTER: f64 = 2.0;

/// A model with a law in it.
struct Rival {
    what: String,
    numbers: usize,
    objective: f64,
    /// ln of the evidence.
    evidence: f64,
}

/// A law that explains the readings better than what it stands for.
pub struct Better {
    /// What it says, in words.
    pub what: String,
    /// How many numbers it has.
    pub numbers: usize,
    /// `Σ ρ(r) + Σ u²` with it.
    pub objective: f64,
    /// By how much the evidence rises.
    pub gain: f64,
}

/// What each law would take from the residuals of a model, as questions put to them.
pub fn beside(campaign: &Campaign, forward: &Forward, fit: &Fit, weights: &Weights) -> Vec<Structure> {
    let rivals = rivals(forward, fit, &laws(campaign, forward, fit), weights);
    let asked = (rivals.len() as f64).max(1.0).ln();
    rivals
        .into_iter()
        .map(|rival| {
            let (statistic, dof) = (fit.point.objective - rival.objective, rival.numbers as f64);
            let ln_p = (ln_chi_squared_tail(statistic, dof) + asked).min(0.0);
            Structure { channel: None, follows: rival.what, statistic, dof, ln_p }
        })
        .collect()
}

/// The law that explains the readings better, beside calibration alone, than calibration does.
pub fn beside_calibration(search: &Search, bare: &Fit) -> Option<Better> {
    let places = search.places() as f64;
    let laws = laws(search.campaign, search.forward, bare);
    best_of(rivals(search.forward, bare, &laws, search.weights), bare.evidence, places)
}

/// The law that explains the readings better, in place of one of the named effects or of all of them, than
/// they do.
pub fn instead(search: &Search, best: &Scored, bare: &Fit) -> Option<Better> {
    let (named, places) = (best.effects.len(), search.places() as f64);
    let single = (0..named).filter(|_| named > 1).map(|i| {
        let (effects, u) = search.without(best, i);
        search.fit(&effects, &u, Effort::default())
    });
    let fits: Vec<Fit> = single.collect();
    let better = |fit: &Fit| {
        let laws = laws(search.campaign, search.forward, fit);
        let evidence = best.score + fit.model.effects.len() as f64 * places.ln();
        best_of(rivals(search.forward, fit, &laws, search.weights), evidence, places)
    };
    fits.iter().chain([bare]).filter_map(better).max_by(|a, b| a.gain.total_cmp(&b.gain))
}

/// The best of the rivals if it is better than an evidence that does not pay for the places of effects
/// that stay.
fn best_of(rivals: Vec<Rival>, evidence: f64, places: f64) -> Option<Better> {
    let gain = |r: &Rival| r.evidence - places.ln() - evidence;
    let best = rivals.into_iter().max_by(|a, b| a.evidence.total_cmp(&b.evidence))?;
    let better =
        Better { gain: gain(&best), what: best.what, numbers: best.numbers, objective: best.objective };
    (better.gain > BETTER).then_some(better)
}

/// Fits each law together with the parameters of a fit.
fn rivals(forward: &Forward, fit: &Fit, laws: &[Law], weights: &Weights) -> Vec<Rival> {
    laws.par_iter().map(|law| rival(forward, fit, law, weights)).collect()
}

/// The linear fit of a model and a law.
fn rival(forward: &Forward, fit: &Fit, law: &Law, weights: &Weights) -> Rival {
    let own = fit.point.u.len();
    let n = own + law.columns.len();
    let mut columns = fit.jacobian.clone().resize_horizontally(n, 0.0);
    for (k, column) in law.columns.iter().enumerate() {
        columns.column_mut(own + k).copy_from_slice(column);
    }
    let mut origin = fit.point.u.clone();
    origin.resize(n, 0.0);
    let origin = DVector::from_vec(origin);
    let at = |u: &DVector<f64>| -> Vec<f64> {
        let delta = &columns * (u - &origin);
        fit.point.predicted.iter().zip(delta.iter()).map(|(p, d)| p + d).collect()
    };
    let (mut u, mut predicted) = (origin.clone(), fit.point.predicted.clone());
    let mut curvature = DMatrix::zeros(n, n);
    let mut here = fit.point.objective;
    for _ in 0..STEPS {
        let equations = normal(forward, fit.model.calibrated(), u.as_slice(), &predicted, &columns, weights);
        curvature = equations.curvature;
        let mut damped = curvature.clone();
        for p in fit.model.calibrated()..n {
            damped[(p, p)] += 12.0 / width(fit, own, p, u[p]).powi(2);
        }
        let Some(cholesky) = Cholesky::new(damped) else { break };
        u -= cholesky.solve(&equations.gradient);
        predicted = at(&u);
        let before = here;
        here = objective(forward, &fit.model, u.as_slice(), &predicted, weights);
        if (before - here).abs() < SETTLED {
            break;
        }
    }
    let objective = here;
    let mut evidence = -0.5 * objective;
    for p in fit.model.calibrated()..n {
        let width = width(fit, own, p, u[p]);
        curvature[(p, p)] += 12.0 / width.powi(2);
        evidence += 0.5 * TAU.ln() - width.ln();
    }
    let determinant = Cholesky::new(curvature)
        .map_or(f64::INFINITY, |c| 2.0 * c.l().diagonal().iter().map(|d| d.ln()).sum::<f64>());
    evidence -= 0.5 * determinant;
    Rival { what: law.what.clone(), numbers: law.columns.len(), objective, evidence }
}

/// Width of the prior of a parameter: that of an effect's knob, or of a law's number, whose size may be of
/// any order of magnitude.
fn width(fit: &Fit, own: usize, p: usize, u: f64) -> f64 {
    match p < own {
        true => fit.model.knobs().nth(p - fit.model.calibrated()).map_or(1.0, |k| k.width(u)),
        false => 2.0 * (1.0 / SMALL).ln_1p() * (u.abs() + SMALL),
    }
}
