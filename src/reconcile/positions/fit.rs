//! Fits geometry and compliances to absolute positions, robustly.
//!
//! The standard deviation of a laser tracker is far below the errors of any model of an arm, so the scale `s` of the
//! errors is fitted too. The error `r` of each position follows a Student distribution with ν = 4 degrees of freedom,
//! in as many dimensions `d` as coordinates were measured. Its weight `(ν+d)/(ν + |r|²/s²)` reduces the influence of
//! gross errors. A compliance `c` moves the point by `c P ĝ`. Here `ĝ` is the direction of gravity, and the columns of
//! the 3x3 matrix `P` are the displacements of the point at unit compliance under gravity along each axis
//! ([`loads`](super::loads)).

use super::fitted::{Fitted, Miss, NU, Sample, misses, weight};
use super::kinematics::Number;
use super::rows::normal_of_fit;
use super::springs::{ConstrainedStep, best_springs};

const MOST_STEPS: usize = 40;
/// Number of Gauss-Newton steps of a fit without one fold of the rows of a long campaign. It starts from the fit to all
/// rows. The two fits differ by less than the standard deviations, and each step leaves a small part of the difference.
pub(super) const STEPS_TO_FOLD: usize = 3;
/// Largest number of lengths that are tried for a step. Each is half of the length before it, at which the fit was
/// worse.
const MOST_HALVINGS: i32 = 10;
/// Largest rotation of a frame (base or mounting) in one step of a fit \[rad\].
const MOST_TURN_RAD: f64 = 0.3;

impl Fitted {
    /// The model after the fraction `part` of a step from this model to `goal`: the geometry's `numbers` change by this
    /// fraction of `step`, and the compliances go this fraction of the way to the compliances of `goal`. Also returns
    /// the errors of the samples with the new model.
    fn towards(
        &self,
        goal: &Self,
        part: f64,
        numbers: &[Number],
        step: &[f64],
        samples: &[&Sample],
    ) -> (Self, Vec<Miss>) {
        let mut out = goal.clone();
        let step: Vec<f64> = step.iter().map(|s| part * s).collect();
        out.geometry.step(numbers, &step);
        out.moved.iter_mut().zip(&step).for_each(|(m, s)| *m += s);
        let own = out.compliances.iter_mut().flatten();
        own.zip(self.compliances.iter().flatten()).for_each(|(c, from)| *c = from + part * (*c - from));
        out.judged(samples)
    }

    /// This model with the scale of its position errors and its likelihood computed for the samples, and these errors.
    fn judged(mut self, samples: &[&Sample]) -> (Self, Vec<Miss>) {
        let misses = misses(samples, &self);
        self.scale_m = scale(&misses, self.scale_m);
        self.ln_likelihood = ln_likelihood(&misses, self.scale_m);
        (self, misses)
    }

    /// Stores the standard deviations `deviations` in this model. The first `numbers` of them belong to the numbers of
    /// the geometry, all others to the compliances.
    fn set_deviations(&mut self, numbers: usize, deviations: &[f64]) {
        self.number_deviations = deviations[..numbers].to_vec();
        let own = self.deviations.iter_mut().flatten();
        own.zip(&deviations[numbers..]).for_each(|(own, deviation)| *own = *deviation);
    }

    /// Natural logarithm of the likelihood of the model times the prior probability of the geometry's `numbers`.
    fn merit(&self, numbers: &[Number]) -> f64 {
        self.ln_likelihood - self.improbability(numbers)
    }

    /// Natural logarithm of the prior probability of the nominal geometry, less that of the geometry's present
    /// `numbers`.
    pub(super) fn improbability(&self, numbers: &[Number]) -> f64 {
        numbers.iter().zip(&self.moved).map(|(n, moved)| 0.5 * (moved / n.prior()).powi(2)).sum()
    }
}

/// Fits the geometry's `numbers` and the compliances of the candidates with the indices `effects` to the samples
/// (measured positions). The fit starts from the model `start`.
pub(crate) fn fit(samples: &[&Sample], numbers: &[Number], effects: &[usize], start: &Fitted) -> Fitted {
    fit_within(MOST_STEPS, samples, numbers, effects, start)
}

/// Fits the model as [`fit`] does, with at most `steps` Gauss-Newton steps.
pub(super) fn fit_within(
    steps: usize,
    samples: &[&Sample],
    numbers: &[Number],
    effects: &[usize],
    start: &Fitted,
) -> Fitted {
    let mut here = start.clone();
    here.compliances = effects
        .iter()
        .map(|&e| {
            let known = start.effects.iter().position(|s| *s == e);
            let none = || vec![0.0; samples.first().map_or(1, |s| s.deflection.count(e))];
            known.map_or_else(none, |i| start.compliances[i].clone())
        })
        .collect();
    here.deviations = here.compliances.iter().map(|own| vec![f64::INFINITY; own.len()]).collect();
    here.effects = effects.to_vec();
    here.moved.resize(numbers.len(), 0.0);
    // kept for comparison: the start can be better than the model to which a bad first step leads
    let (begin, first_misses) = here.clone().judged(samples);
    // the errors of the samples with the present model
    let mut misses = first_misses.clone();
    // The first step is taken even if it makes the fit worse, because the quadratic approximation is poor far from the
    // best fit.
    let mut merit = f64::NEG_INFINITY;
    let mut last: Option<ConstrainedStep> = None;
    for _ in 0..steps {
        let before = here.clone();
        let best = step(samples, &misses, numbers, &mut here);
        let step = best.as_ref().map_or(vec![0.0; numbers.len()], |b| b.step[..numbers.len()].to_vec());
        last = best.or(last);
        let step = shortened(numbers, step);
        let goal = here;
        let parts = (0..MOST_HALVINGS).map(|n| 0.5f64.powi(n));
        let mut tried = parts.map(|part| before.towards(&goal, part, numbers, &step, samples));
        let Some(better) = tried.find(|(t, _)| t.merit(numbers) >= merit - 1e-9 * merit.abs()) else {
            here = before;
            break;
        };
        (here, misses) = better;
        merit = here.merit(numbers);
        let largest = step.iter().map(|s| s.abs()).fold(0.0, f64::max);
        if (here.scale_m / before.scale_m - 1.0).abs() < 1e-6 && largest < 1e-6 {
            break;
        }
    }
    if here.merit(numbers) < begin.merit(numbers) {
        (here, misses) = (begin, first_misses);
    }
    if let Some(best) = last {
        here.set_deviations(numbers.len(), &best.deviations());
    }
    let free = numbers.len() + here.compliances.iter().map(Vec::len).sum::<usize>();
    let factor = sandwich_factor(&misses, here.scale_m, free);
    here.deviations.iter_mut().flatten().chain(&mut here.number_deviations).for_each(|d| *d *= factor);
    here.robust_factor = factor;
    here
}

/// Sandwich factor: square root of the variance factor of the M-estimator (Huber, Robust Statistics, ch. 7). Standard
/// deviations from the weighted curvature take the weights as known and are too small by this factor. It is the root of
/// the mean weight times the mean square of the weighted errors `misses`, divided by the mean slope of the weighted
/// error. The mean square is corrected for `free`, the number of free parameters.
fn sandwich_factor(misses: &[Miss], scale_m: f64, free: usize) -> f64 {
    let count: f64 = misses.iter().map(|miss| miss.readings).sum();
    let (mut weights, mut squares, mut slopes) = (0.0, 0.0, 0.0);
    for miss in misses {
        let (w, size) = (weight(miss, scale_m), miss.scaled_m.norm_squared() / (scale_m * scale_m));
        let part = miss.readings / count;
        weights += w * part;
        squares += w * w * size / count;
        slopes += (w - 2.0 / miss.readings.max(1.0) * w * size / (NU + size)) * part;
    }
    let left = (count - free as f64).max(1.0);
    (weights * squares * count / left).sqrt() / slopes
}

/// Shortens the step of the geometry's `numbers` if it would turn a frame by more than [`MOST_TURN_RAD`]. The
/// linearization does not hold for a larger rotation.
fn shortened(numbers: &[Number], step: Vec<f64>) -> Vec<f64> {
    let turns = numbers.iter().zip(&step).filter(|(n, _)| n.turns()).map(|(_, s)| s.abs());
    let part = (MOST_TURN_RAD / turns.fold(0.0, f64::max)).min(1.0);
    step.into_iter().map(|s| s * part).collect()
}

/// Scale `s` of the Student distribution of the errors `misses` \[m\], by fixed-point iteration that starts at
/// `near_m`.
pub(crate) fn scale(misses: &[Miss], near_m: f64) -> f64 {
    let count: f64 = misses.iter().map(|miss| miss.readings).sum();
    let mut scale_m = near_m;
    for _ in 0..8 {
        let sum: f64 = misses.iter().map(|m| weight(m, scale_m) * m.scaled_m.norm_squared()).sum();
        scale_m = (sum / count).sqrt().max(1e-7);
    }
    scale_m
}

/// Natural logarithm of the likelihood of the errors `misses` if they follow a Student distribution with the scale
/// `scale_m`.
pub(crate) fn ln_likelihood(misses: &[Miss], scale_m: f64) -> f64 {
    let s2 = scale_m * scale_m;
    let one = |m: &Miss| {
        let size = m.scaled_m.norm_squared() / (NU * s2);
        -0.5 * (NU + m.readings) * libm::log(1.0 + size) - m.readings * libm::log(scale_m)
    };
    misses.iter().map(one).sum()
}

/// Takes one weighted Gauss-Newton step from the model `here`, with which the samples have the errors `misses`. Sets its
/// compliances to the best values that are physically possible, and returns the step of all numbers and compliances;
/// `None` if the equations are singular.
fn step(
    samples: &[&Sample],
    misses: &[Miss],
    numbers: &[Number],
    here: &mut Fitted,
) -> Option<ConstrainedStep> {
    let normal = normal_of_fit(samples, misses, numbers, here);
    let best = best_springs(&normal, numbers.len(), &here.compliances)?;
    let compliances = here.compliances.iter_mut().flatten();
    compliances.zip(&best.step[numbers.len()..]).for_each(|(c, by)| *c += by);
    Some(best)
}
