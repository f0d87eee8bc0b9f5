//! Fits geometry and compliances to absolute positions, robustly.
//!
//! The standard deviation of a laser tracker is far below the errors of any model of an arm, so the scale `s` of the
//! errors is fitted too. The error `r` of each position follows a Student distribution with ν = 4 degrees of freedom,
//! in as many dimensions `d` as coordinates were measured. Its weight `(ν+d)/(ν + |r|²/s²)` reduces the influence of
//! gross errors. A compliance `c` moves the point by `c P ĝ`. Here `ĝ` is the direction of gravity, and the columns of
//! the 3x3 matrix `P` are the displacements of the point at unit compliance under gravity along each axis
//! ([`deflection`](super::deflection)).

use super::fitted::{Fitted, Miss, NU, Sample, misses, weight};
use super::kinematics::Number;
use super::normal::Normal;
use super::rows::{normal_of_fit, normals_without, with_part};
use super::springs::best_springs;

const MOST_STEPS: usize = 40;
/// The fit ends after a step that lowers half of chi-squared by less than this. Before this step, no number was off by more
/// than 0.0014 of its standard deviation, and each step leaves a small part of this.
const SETTLED: f64 = 1e-6;
/// Smallest part of the weighted curvature with which a Newton step is taken. Normal errors have 0.8 of it.
const LEAST_PART: f64 = 0.5;
/// Largest number of times that a step is halved because the fit is worse after it.
const MOST_HALVINGS: i32 = 10;
/// Largest rotation of a frame (base or mounting) in one step of a fit \[rad\].
const MOST_TURN_RAD: f64 = 0.3;

impl Fitted {
    /// This model with the effects `effects`; those that it does not have yet get compliances of zero.
    fn with_effects(&self, numbers: &[Number], effects: &[usize], samples: &[&Sample]) -> Self {
        let mut out = self.clone();
        let compliances = effects.iter().map(|&e| {
            let known = self.effects.iter().position(|s| *s == e);
            let none = || vec![0.0; samples.first().map_or(1, |s| s.deflection.count(e))];
            known.map_or_else(none, |i| self.compliances[i].clone())
        });
        out.compliances = compliances.collect();
        out.deviations = out.compliances.iter().map(|own| vec![f64::INFINITY; own.len()]).collect();
        out.effects = effects.to_vec();
        out.moved.resize(numbers.len(), 0.0);
        out
    }

    /// The model after the fraction `part` of a step, and the errors of the samples with it.
    fn after(&self, step: &Step, part: f64, numbers: &[Number], samples: &[&Sample]) -> (Self, Vec<Miss>) {
        let mut out = self.clone();
        out.take(step, part, numbers);
        out.judged(samples)
    }

    /// Takes the fraction `part` of a step of the geometry's `numbers` and of the compliances.
    fn take(&mut self, step: &Step, part: f64, numbers: &[Number]) {
        let of_numbers: Vec<f64> = step.numbers.iter().map(|by| part * by).collect();
        self.geometry.step(numbers, &of_numbers);
        self.moved.iter_mut().zip(&of_numbers).for_each(|(moved, by)| *moved += by);
        self.compliances.iter_mut().flatten().zip(&step.compliances).for_each(|(c, by)| *c += part * by);
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
/// (measured positions), with standard deviations. The fit starts from the model `start`.
pub(crate) fn fit(samples: &[&Sample], numbers: &[Number], effects: &[usize], start: &Fitted) -> Fitted {
    let (mut here, misses) = most_likely(samples, numbers, effects, start);
    let normal = normal_of_fit(samples, &misses, numbers, &here);
    if let Some(best) = best_springs(&normal, numbers.len(), &here.compliances) {
        here.set_deviations(numbers.len(), &best.deviations());
    }
    let free = numbers.len() + here.compliances.iter().map(Vec::len).sum::<usize>();
    let factor = sandwich_factor(&misses, here.scale_m, free);
    here.deviations.iter_mut().flatten().chain(&mut here.number_deviations).for_each(|d| *d *= factor);
    here.robust_factor = factor;
    here
}

/// The model of [`fit`] without its standard deviations, which take about as long as a further step.
pub(crate) fn likeliest(
    samples: &[&Sample],
    numbers: &[Number],
    effects: &[usize],
    start: &Fitted,
) -> Fitted {
    most_likely(samples, numbers, effects, start).0
}

/// The most likely values of the `numbers` and compliances, and the errors of the samples with them.
fn most_likely(
    samples: &[&Sample],
    numbers: &[Number],
    effects: &[usize],
    start: &Fitted,
) -> (Fitted, Vec<Miss>) {
    let mut here = start.with_effects(numbers, effects, samples);
    // kept for comparison: the start can be better than the model to which a bad first step leads
    let begin = here.clone().judged(samples);
    // the errors of the samples with the present model
    let mut misses = begin.1.clone();
    // The first step is taken even if it makes the fit worse, because the quadratic approximation is poor far from the
    // best fit.
    let mut merit = f64::NEG_INFINITY;
    for _ in 0..MOST_STEPS {
        let normal = normal_of_fit(samples, &misses, numbers, &here);
        let Some(step) = Step::new(&normal, numbers, &here) else { break };
        // the last step is taken whole or not at all
        let halvings = if step.fall < SETTLED { 1 } else { MOST_HALVINGS };
        let mut tried =
            (0..halvings).map(|halving| here.after(&step, 0.5f64.powi(halving), numbers, samples));
        let Some(better) = tried.find(|(t, _)| t.merit(numbers) >= merit - 1e-9 * merit.abs()) else { break };
        (here, misses) = better;
        merit = here.merit(numbers);
        if step.fall < SETTLED {
            break;
        }
    }
    // no step was taken if the merit is still without a value
    if merit.is_finite() && merit >= begin.0.merit(numbers) { (here, misses) } else { begin }
}

/// For each of the `folds` of all rows of a long campaign, the fit without this fold, by one Newton step from the fit `here` to
/// all rows. The two fits differ by less than the standard deviations, and Newton's step leaves a part of the difference that
/// falls with the number of rows.
pub(super) fn fits_without(folds: &[Vec<&Sample>], numbers: &[Number], here: &Fitted) -> Vec<Fitted> {
    let all: Vec<&Sample> = folds.iter().flatten().copied().collect();
    let part = Means::new(&misses(&all, here), here.scale_m).newton_part();
    let without = |normal: Normal| {
        let mut out = here.clone();
        let step = Step::new(&with_part(&normal, part, numbers, here), numbers, here);
        step.iter().for_each(|step| out.take(step, 1.0, numbers));
        out
    };
    normals_without(folds, numbers, here).into_iter().map(without).collect()
}

/// A step of a fit.
struct Step {
    /// Change of each number of the geometry.
    numbers: Vec<f64>,
    /// Change of each compliance. It leads to a compliance that is physically possible.
    compliances: Vec<f64>,
    /// By how much half of chi-squared falls, as far as it is a quadratic function.
    fall: f64,
}

impl Step {
    /// The step from the model `here` by the equations `normal`; `None` if they are singular.
    fn new(normal: &Normal, numbers: &[Number], here: &Fitted) -> Option<Self> {
        let best = best_springs(normal, numbers.len(), &here.compliances)?;
        let (of_numbers, compliances) = best.step.split_at(numbers.len());
        Some(Self {
            numbers: shortened(numbers, of_numbers.to_vec()),
            compliances: compliances.to_vec(),
            fall: best.fall,
        })
    }
}

/// Means over the readings of the errors of an M-estimator.
struct Means {
    /// The weight.
    weight: f64,
    /// The square of the weighted error, over the scale.
    square: f64,
    /// How fast the weighted error grows with the error.
    slope: f64,
}

impl Means {
    fn new(misses: &[Miss], scale_m: f64) -> Self {
        let count: f64 = misses.iter().map(|miss| miss.readings).sum();
        let mut out = Self { weight: 0.0, square: 0.0, slope: 0.0 };
        for miss in misses {
            let (w, size) = (weight(miss, scale_m), miss.scaled_m.norm_squared() / (scale_m * scale_m));
            let part = miss.readings / count;
            out.weight += w * part;
            out.square += w * w * size / count;
            out.slope += (w - 2.0 / miss.readings.max(1.0) * w * size / (NU + size)) * part;
        }
        out
    }

    /// The part of the weighted curvature that half of chi-squared has, since the weights fall as the errors grow. A step with
    /// this part of the curvature is Newton's; one with all of it is that of Gauss and Newton.
    fn newton_part(&self) -> f64 {
        (self.slope / self.weight).clamp(LEAST_PART, 1.0)
    }
}

/// Sandwich factor: square root of the variance factor of the M-estimator (Huber, Robust Statistics, ch. 7). Standard
/// deviations from the weighted curvature take the weights as known and are too small by this factor. It is the root of
/// the mean weight times the mean square of the weighted errors `misses`, divided by the mean slope of the weighted
/// error. The mean square is corrected for `free`, the number of free parameters.
fn sandwich_factor(misses: &[Miss], scale_m: f64, free: usize) -> f64 {
    let count: f64 = misses.iter().map(|miss| miss.readings).sum();
    let Means { weight, square, slope } = Means::new(misses, scale_m);
    let left = (count - free as f64).max(1.0);
    (weight * square * count / left).sqrt() / slope
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
