//! Tests competing models: smooth laws that are not effects of the library.
//!
//! An effect of the library can imitate physics that the library lacks. A joint that stiffens under load looks like
//! lost motion, and a nonlinear sensor looks like a gain. So every named effect must compete with general
//! [`laws`](super::laws), which are fitted together with the calibration. In these fits, a law is added to the named
//! effects or replaces them.

use super::laws::{Law, of_every_law};
use super::search::{Scored, Search};
use super::structure::Structure;
use crate::arm::effect::kind::Place;
use crate::reconcile::fit::descent::{Effort, Fit, objective};
use crate::reconcile::fit::noise::{GROSS_ERROR_CHARGE, Noise};
use crate::reconcile::fit::normal::{Extended, Shared};
use crate::reconcile::fit::stats::ln_chi_squared_tail;
use crate::reconcile::fit::weights::Weights;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::readings::campaign::Campaign;
use nalgebra::{Cholesky, DMatrix, DVector};
use std::cmp::Ordering;
use std::f64::consts::TAU;

/// All sizes of a law below this fraction of its full size have equal prior probability. At full size a stiffness or
/// a reading changes by 100 %.
const SMALL_SIZE: f64 = 0.02;
/// Largest number of steps of the linearized fit. The weights of the readings are computed again at each step.
const STEPS: usize = 6;
/// The linearized fit ends when a step changes the objective by less than this.
const CONVERGED_WITHIN: f64 = 0.01;
/// A law without a name is clearly better than named effects if the logarithm of its evidence, less the charge for its
/// place, is higher by more than this. If no effect is named, a law is mentioned if it is better than calibration by
/// as much.
const LEAST_GAIN: f64 = 2.0;

/// A competing model: a fitted model to which a law without a name was added.
struct Competitor {
    what: String,
    /// The place of the law, if it has one.
    at: Option<String>,
    /// The seldom effect that the law describes more closely.
    refines: Option<&'static str>,
    numbers: usize,
    objective: f64,
    /// Natural logarithm of the evidence of the model with the law.
    evidence: f64,
}

/// A law without a name that explains the readings better than the model with which it competes, or as well.
#[derive(Debug)]
pub(crate) struct Better {
    /// Description of the law in words.
    pub what: String,
    /// Number of parameters of the law.
    pub numbers: usize,
    /// The objective `Σ ρ(r) + Σ u²` of the model with the law.
    pub objective: f64,
    /// Rise of the logarithm of the evidence, less the charge for the place, over the model with which the law
    /// competes.
    pub gain: f64,
    /// Number of rows that are gross errors with the named effects and that the law explains: they are among its readings.
    pub put_back: usize,
}

impl Better {
    /// Whether the law is clearly better, and not only as good.
    pub(crate) fn is_clear(&self) -> bool {
        self.gain > LEAST_GAIN
    }
}

/// For each law without a name, a test for lack of fit: the statistic is the fall of the objective of `fit` when the
/// law is added.
pub(crate) fn law_questions(
    campaign: &Campaign,
    forward: &Forward,
    fit: &Fit,
    weights: &Weights,
) -> Vec<Structure> {
    let shared = Shared::new(forward, &fit.point.predicted, fit.jacobian.clone(), weights);
    let competitors =
        of_every_law(campaign, forward, fit, |law| competitor(forward, fit, &shared, law, weights));
    // Bonferroni correction: one of many laws fits better by chance
    let asked = libm::log((competitors.len() as f64).max(1.0));
    competitors
        .into_iter()
        .map(|competitor| {
            let (statistic, dof) = (fit.point.objective - competitor.objective, competitor.numbers as f64);
            let ln_p = (ln_chi_squared_tail(statistic, dof) + asked).min(0.0);
            Structure { channel: None, follows: competitor.what, statistic, dof, ln_p }
        })
        .collect()
}

/// The law without a name that, added to calibration alone (`baseline`), explains the readings clearly better than
/// calibration does; `None` if there is none.
pub(crate) fn better_than_calibration(search: &Search, baseline: &Fit) -> Option<Better> {
    let places = search.places();
    best_of(competitors(search, baseline), baseline.evidence, places, |_| LEAST_GAIN)
}

/// The law without a name that keeps the effects of the model `best` from being named; `None` if there is none. It takes
/// the place of one named effect, or of all of them.
///
/// A usual effect is likelier than any law without a name before a reading is taken, so the law must be clearly better. An
/// effect that is seldom met is not: a servo that is soft in one kind of tests, and a joint that creeps while a pose is kept,
/// are equally strange. A law that explains the readings as well keeps it from being named. Only a law that describes
/// the effect more closely at its place, such as a stiffness that varies five times a turn, must be clearly better too.
///
/// `noise` says which rows are gross errors with the named effects. A law may explain these rows. So the laws are also
/// tried with all rows, and what the assumption of gross errors costs is then to their credit.
pub(crate) fn instead(search: &Search, best: &Scored, baseline: &Fit, noise: &Noise) -> Option<Better> {
    let mut found = instead_with(search, best, baseline, 0.0);
    if !noise.outliers.is_empty() {
        let all = Noise { outliers: Vec::new(), ..noise.clone() }.weights(search.forward);
        let whole = Search { weights: &all, ..*search };
        let baseline = whole.fit(&[], &baseline.point.u, Effort::default());
        let credit = GROSS_ERROR_CHARGE * noise.outliers.len() as f64;
        let with_all = instead_with(&whole, best, &baseline, credit);
        let with_all = with_all.map(|law| Better { put_back: noise.outliers.len(), ..law });
        found = found.into_iter().chain(with_all).max_by(by_gain);
    }
    found
}

fn by_gain(a: &Better, b: &Better) -> Ordering {
    a.gain.total_cmp(&b.gain)
}

/// The same as [`instead`], with the rows that `search` weighs. `credit` is added to the evidence of each law.
fn instead_with(search: &Search, best: &Scored, baseline: &Fit, credit: f64) -> Option<Better> {
    let (named, places) = (best.effects.len(), search.places());
    // with one effect, the model without it is the baseline, which is tried anyway
    let single = (0..named).filter(|_| named > 1).map(|i| {
        let (effects, u) = search.without(best, i);
        (vec![best.effects[i]], search.price(&effects), search.fit(&effects, &u, Effort::default()))
    });
    let fits: Vec<(Vec<usize>, f64, Fit)> = single.collect();
    let keeping = |(replaced, price, fit): (&[usize], f64, &Fit)| {
        let least = |law: &Competitor| {
            let asked = replaced.iter().map(|effect| asked(search, *effect, law));
            asked.fold(f64::NEG_INFINITY, f64::max)
        };
        best_of(competitors(search, fit), best.score + price - credit, places, least)
    };
    let fits = fits.iter().map(|(replaced, price, fit)| (replaced.as_slice(), *price, fit));
    fits.chain([(best.effects.as_slice(), 0.0, baseline)]).filter_map(keeping).max_by(by_gain)
}

/// By how much the logarithm of the evidence of a law must exceed that of the candidate with the index `effect`, if the
/// law is to keep this effect from being named.
fn asked(search: &Search, effect: usize, law: &Competitor) -> f64 {
    let candidate = &search.candidates[effect];
    let is_at = |place: &str| match candidate.kind.places.contains(&Place::Arm) {
        // what the whole arm has, each of its links has
        true => search.forward.layout.links.iter().any(|link| link.name == place),
        false => candidate.at == place || candidate.twins.iter().any(|(_, twin)| twin == place),
    };
    let is_there = law.at.as_deref().is_some_and(is_at);
    let is_close = law.refines == Some(candidate.kind.name) || candidate.kind.places.contains(&Place::Arm);
    match candidate.kind.traits.odds < 1.0 {
        true if is_there && is_close => LEAST_GAIN,
        true => 0.0,
        false => LEAST_GAIN,
    }
}

/// The best law of those `competitors` that are as good as is asked of them. What is asked is that the logarithm of the
/// law's evidence, less a charge for having tried `places` places, is higher than `evidence` by more than `least` says;
/// `None` if no law does that. `evidence` is the logarithm of the evidence of the model with which they compete, less the charges
/// for effects that only this model has. Effects that are in both models are not charged for their places.
fn best_of(
    competitors: Vec<Competitor>,
    evidence: f64,
    places: f64,
    least: impl Fn(&Competitor) -> f64,
) -> Option<Better> {
    let gain = |law: &Competitor| law.evidence - libm::log(places) - evidence;
    let good = competitors.into_iter().filter(|law| gain(law) > least(law));
    let best = good.max_by(|a, b| gain(a).total_cmp(&gain(b)))?;
    let gain = gain(&best);
    let Competitor { what, numbers, objective, .. } = best;
    Some(Better { what, numbers, objective, gain, put_back: 0 })
}

/// Fits each law without a name together with the parameters of the model `fit`. Laws that are the same as an effect
/// among the candidates of the search are left out.
fn competitors(search: &Search, fit: &Fit) -> Vec<Competitor> {
    let is_sought = |effect: &str| search.candidates.iter().any(|c| c.kind.name == effect);
    let Search { campaign, forward, weights, .. } = *search;
    let shared = Shared::new(forward, &fit.point.predicted, fit.jacobian.clone(), weights);
    let fitted = of_every_law(campaign, forward, fit, |law| {
        // the effect of the library competes itself, under its name
        let has_no_name = !law.effect.is_some_and(is_sought);
        has_no_name.then(|| competitor(forward, fit, &shared, law, weights))
    });
    fitted.into_iter().flatten().collect()
}

/// Fits the model of `fit` together with the law `law`. The predictions are linearized about `fit`, whose derivatives are
/// those of `shared`.
fn competitor(forward: &Forward, fit: &Fit, shared: &Shared, law: &Law, weights: &Weights) -> Competitor {
    let (objective, evidence) = with_columns(forward, fit, shared, &law.columns, weights);
    Competitor {
        what: law.what.clone(),
        at: law.at.clone(),
        refines: law.refines,
        numbers: law.columns.len(),
        objective,
        evidence,
    }
}

/// The objective and the logarithm of the evidence of the model of `fit` together with a law. `columns` has, for each parameter of
/// the law, the change of every reading per unit of the parameter. The predictions are linearized about `fit`, whose
/// derivatives are those of `shared`.
pub(super) fn with_columns(
    forward: &Forward,
    fit: &Fit,
    shared: &Shared,
    columns: &[Vec<f64>],
    weights: &Weights,
) -> (f64, f64) {
    let own = fit.point.u.len();
    let n = own + columns.len();
    let further =
        DMatrix::from_iterator(fit.jacobian.nrows(), columns.len(), columns.iter().flatten().copied());
    let columns = Extended { shared, own: further };
    let mut origin = fit.point.u.clone();
    origin.resize(n, 0.0);
    let origin = DVector::from_vec(origin);
    let at = |u: &DVector<f64>| -> Vec<f64> {
        let delta = columns.times(&(u - &origin));
        fit.point.predicted.iter().zip(delta.iter()).map(|(p, d)| p + d).collect()
    };
    let (mut u, mut predicted) = (origin.clone(), fit.point.predicted.clone());
    let mut curvature = DMatrix::zeros(n, n);
    let mut here = fit.point.objective;
    for _ in 0..STEPS {
        let equations = columns.normal(forward, fit.model.calibrated(), u.as_slice(), &predicted, weights);
        curvature = equations.curvature;
        let mut damped = curvature.clone();
        for p in fit.model.calibrated()..n {
            // the prior of an effect or a law: variance of a uniform distribution of this width
            damped[(p, p)] += 12.0 / width(fit, own, p, u[p]).powi(2);
        }
        let Some(cholesky) = Cholesky::new(damped) else { break };
        u -= cholesky.solve(&equations.gradient);
        predicted = at(&u);
        let before = here;
        here = objective(forward, &fit.model, u.as_slice(), &predicted, weights);
        if (before - here).abs() < CONVERGED_WITHIN {
            break;
        }
    }
    let objective = here;
    let mut evidence = -0.5 * objective;
    for p in fit.model.calibrated()..n {
        let width = width(fit, own, p, u[p]);
        curvature[(p, p)] += 12.0 / width.powi(2);
        evidence += 0.5 * libm::log(TAU) - libm::log(width);
    }
    let determinant = Cholesky::new(curvature)
        .map_or(f64::INFINITY, |c| 2.0 * c.l().diagonal().iter().map(|d| libm::log(*d)).sum::<f64>());
    evidence -= 0.5 * determinant;
    (objective, evidence)
}

/// Width of the prior of the parameter with index `p` at the value `u`. The first `own` parameters belong to the
/// model. For the parameters of a law, which follow, the width grows with the size of `u`, because the size of a law
/// may be of any order of magnitude.
fn width(fit: &Fit, own: usize, p: usize, u: f64) -> f64 {
    match p < own {
        true => fit.model.free_parameters().nth(p - fit.model.calibrated()).map_or(1.0, |k| k.width(u)),
        false => 2.0 * libm::log1p(1.0 / SMALL_SIZE) * (u.abs() + SMALL_SIZE),
    }
}
