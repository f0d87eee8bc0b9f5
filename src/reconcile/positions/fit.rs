//! Fits geometry and compliances to absolute positions, robustly.
//!
//! The standard deviation of a laser tracker is far below the errors that any model of an arm leaves. So the
//! scale of the errors is fitted too. The error of each position is a three-dimensional Student variable with
//! ν = 4 degrees of freedom. Its weight `(ν+3)/(ν + |r|²/s²)` lets gross errors fade. A compliance `c` moves
//! the point by `c P ĝ`, where `P` is its displacement at unit compliance per direction of gravity
//! ([`loads`](super::loads)).

use super::kinematics::{Geometry, Number, Placing};
use super::loads::Deflection;
use super::normal::Normal;
use super::springs::{Best, best_springs};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

/// Degrees of freedom of the Student distribution.
const NU: f64 = 4.0;
const MOST_STEPS: usize = 40;
/// Largest number of times that a step is halved because the fit is worse after it.
const MOST_HALVINGS: i32 = 10;
/// Prior standard deviation of a compliance \[rad/(N m)\]. It is far above that of any part. Without it, a
/// compliance that no weight loads could take any value.
const PRIOR_RAD_PER_NM: f64 = 0.1;
/// Largest turn of a frame in one step \[rad\].
const MOST_TURN_RAD: f64 = 0.3;

/// One measured position.
#[derive(Debug, Clone)]
pub(crate) struct Sample {
    /// Joint angles \[rad\].
    pub pose_rad: Vec<f64>,
    /// Index of the arm that carries the point.
    pub arm: usize,
    /// Index of its point on the tool.
    pub point: usize,
    /// Index of the instrument's session.
    pub station: usize,
    /// Index of this sample among the samples.
    pub index: usize,
    /// Index of its pose. Samples of one pose are held out together.
    pub group: usize,
    /// Measured position in the instrument's frame \[m\].
    pub measured_m: Vector3<f64>,
    /// The effect of gravity on this position.
    pub deflection: Deflection,
}

impl Sample {
    /// The arguments that the geometry needs.
    pub(crate) fn placing(&self) -> Placing<'_> {
        Placing { arm: self.arm, pose_rad: &self.pose_rad, point: self.point, station: self.station }
    }
}

/// A fitted model.
#[derive(Debug, Clone)]
pub(crate) struct Fitted {
    /// Geometry.
    pub geometry: Geometry,
    /// Change of each number of the geometry from its nominal value.
    pub moved: Vec<f64>,
    /// Standard deviations of the numbers of the geometry.
    pub number_deviations: Vec<f64>,
    /// Indices of the candidates that the model contains as effects.
    pub effects: Vec<usize>,
    /// The compliances of each effect \[rad/(N m)\].
    pub compliances: Vec<Vec<f64>>,
    /// Standard deviations of the compliances \[rad/(N m)\].
    pub deviations: Vec<Vec<f64>>,
    /// Scale of the errors \[m\].
    pub scale_m: f64,
    /// ln of the likelihood.
    pub ln_likelihood: f64,
}

impl Fitted {
    /// A model of a geometry without effects.
    pub(crate) fn rigid(geometry: Geometry, scale_m: f64) -> Self {
        Self {
            geometry,
            moved: Vec::new(),
            number_deviations: Vec::new(),
            effects: Vec::new(),
            compliances: Vec::new(),
            deviations: Vec::new(),
            scale_m,
            ln_likelihood: 0.0,
        }
    }

    /// Predicted position \[m\].
    pub(crate) fn predicted_m(&self, sample: &Sample) -> Vector3<f64> {
        let rigid = self.geometry.place(sample.placing(), &[]).at_m;
        rigid + self.geometry.level_to_instrument() * self.displacement(sample)
    }

    /// Error of a sample, measured minus predicted \[m\].
    pub(crate) fn error(&self, sample: &Sample) -> Vector3<f64> {
        sample.measured_m - self.predicted_m(sample)
    }

    /// Displacement of a sample's point by gravity: known deflection, and the effects of the model, in the level
    /// frame \[m\].
    pub(crate) fn displacement(&self, sample: &Sample) -> Vector3<f64> {
        let effects = self.effects.iter().zip(&self.compliances);
        let gravity = &self.geometry.gravity;
        let pulled = effects.map(|(&e, c)| pull(sample, e, c) * gravity);
        let leaning =
            sample.deflection.known_slopes_m[0] * gravity.x + sample.deflection.known_slopes_m[1] * gravity.y;
        sample.deflection.known_m + leaning + pulled.sum::<Vector3<f64>>()
    }

    /// The model after a part of a step: the geometry changes by this part of `step`, the compliances go this part of
    /// the way to those of `goal`.
    fn towards(&self, goal: &Self, part: f64, numbers: &[Number], step: &[f64], samples: &[&Sample]) -> Self {
        let mut out = goal.clone();
        let step: Vec<f64> = step.iter().map(|s| part * s).collect();
        out.geometry.step(numbers, &step);
        out.moved.iter_mut().zip(&step).for_each(|(m, s)| *m += s);
        let own = out.compliances.iter_mut().flatten();
        own.zip(self.compliances.iter().flatten()).for_each(|(c, from)| *c = from + part * (*c - from));
        out.judged(samples)
    }

    /// The same model with the scale of its errors and its likelihood computed.
    fn judged(mut self, samples: &[&Sample]) -> Self {
        let errors = errors(samples, &self);
        self.scale_m = scale(&errors, self.scale_m);
        self.ln_likelihood = ln_likelihood(&errors, self.scale_m);
        self
    }

    /// ln of the likelihood and of the prior of the numbers together.
    fn merit(&self, numbers: &[Number]) -> f64 {
        let prior = numbers.iter().zip(&self.moved).map(|(n, moved)| 0.5 * (moved / n.prior()).powi(2));
        self.ln_likelihood - prior.sum::<f64>()
    }

    /// Weight of a sample with this error \[1/m²\].
    pub(crate) fn weight(&self, error: &Vector3<f64>) -> f64 {
        weight(error, self.scale_m) / (self.scale_m * self.scale_m)
    }
}

/// The displacement of the point by the compliances of one effect, per unit vector of gravity's direction.
fn pull(sample: &Sample, effect: usize, compliances: &[f64]) -> Matrix3<f64> {
    sample.deflection.per_compliance[effect].iter().zip(compliances).map(|(p, c)| p * *c).sum()
}

/// Fits geometry and the named compliances to the samples, starting from a model.
pub(crate) fn fit(samples: &[&Sample], numbers: &[Number], effects: &[usize], start: &Fitted) -> Fitted {
    let mut here = start.clone();
    here.compliances = effects
        .iter()
        .map(|&e| {
            let known = start.effects.iter().position(|s| *s == e);
            let none = || vec![0.0; samples.first().map_or(1, |s| s.deflection.per_compliance[e].len())];
            known.map_or_else(none, |i| start.compliances[i].clone())
        })
        .collect();
    here.deviations = here.compliances.iter().map(|own| vec![f64::INFINITY; own.len()]).collect();
    here.effects = effects.to_vec();
    here.moved.resize(numbers.len(), 0.0);
    // kept for comparison: the start can be better than where a first bad step leads
    let begin = here.clone().judged(samples);
    // The first step may make the fit worse, because the parabola is a poor model far from the best fit.
    let mut merit = f64::NEG_INFINITY;
    for _ in 0..MOST_STEPS {
        let before = here.clone();
        let step = shortened(numbers, step(samples, numbers, &mut here));
        let goal = here;
        let parts = (0..MOST_HALVINGS).map(|n| 0.5f64.powi(n));
        let mut tried = parts.map(|part| before.towards(&goal, part, numbers, &step, samples));
        let Some(better) = tried.find(|t| t.merit(numbers) >= merit - 1e-9 * merit.abs()) else {
            here =
                Fitted { deviations: goal.deviations, number_deviations: goal.number_deviations, ..before };
            break;
        };
        here = better;
        merit = here.merit(numbers);
        let largest = step.iter().map(|s| s.abs()).fold(0.0, f64::max);
        if (here.scale_m / before.scale_m - 1.0).abs() < 1e-6 && largest < 1e-6 {
            break;
        }
    }
    if here.merit(numbers) < begin.merit(numbers) {
        here = Fitted { deviations: here.deviations, number_deviations: here.number_deviations, ..begin };
    }
    let errors = errors(samples, &here);
    let free = numbers.len() + here.compliances.iter().map(Vec::len).sum::<usize>();
    let sandwich_factor = sandwich_factor(&errors, here.scale_m, free);
    here.deviations
        .iter_mut()
        .flatten()
        .chain(&mut here.number_deviations)
        .for_each(|d| *d *= sandwich_factor);
    here
}

/// Variance factor of the M-estimator (sandwich; Huber, Robust Statistics, ch. 7). Standard deviations from
/// the weighted curvature take the weights as known and are too small by its root, which is returned. It is
/// the root mean square of the weighted errors over their mean slope, corrected for the number of free
/// parameters.
fn sandwich_factor(errors: &[Vector3<f64>], scale_m: f64, free: usize) -> f64 {
    let count = errors.len() as f64;
    let (mut weights, mut squares, mut slopes) = (0.0, 0.0, 0.0);
    for error in errors {
        let (w, size) = (weight(error, scale_m), error.norm_squared() / (scale_m * scale_m));
        weights += w / count;
        squares += w * w * size / 3.0 / count;
        slopes += (w - 2.0 / 3.0 * w * size / (NU + size)) / count;
    }
    let left = (3.0 * count - free as f64).max(1.0);
    (weights * squares * 3.0 * count / left).sqrt() / slopes
}

/// Shortens a step that would turn a frame too far for a linearization.
fn shortened(numbers: &[Number], step: Vec<f64>) -> Vec<f64> {
    let turns = numbers.iter().zip(&step).filter(|(n, _)| n.turns()).map(|(_, s)| s.abs());
    let part = (MOST_TURN_RAD / turns.fold(0.0, f64::max)).min(1.0);
    step.into_iter().map(|s| s * part).collect()
}

fn weight(error: &Vector3<f64>, scale_m: f64) -> f64 {
    (NU + 3.0) / (NU + error.norm_squared() / (scale_m * scale_m))
}

fn errors(samples: &[&Sample], fitted: &Fitted) -> Vec<Vector3<f64>> {
    samples.iter().map(|s| fitted.error(s)).collect()
}

/// The scale of errors, by fixed-point iteration from a value nearby \[m\].
pub(crate) fn scale(errors: &[Vector3<f64>], near_m: f64) -> f64 {
    let mut scale_m = near_m;
    for _ in 0..8 {
        let sum: f64 = errors.iter().map(|e| weight(e, scale_m) * e.norm_squared()).sum();
        scale_m = (sum / (3.0 * errors.len() as f64)).sqrt().max(1e-7);
    }
    scale_m
}

/// ln of the likelihood of errors with this scale.
pub(crate) fn ln_likelihood(errors: &[Vector3<f64>], scale_m: f64) -> f64 {
    let s2 = scale_m * scale_m;
    let one =
        |e: &Vector3<f64>| -0.5 * (NU + 3.0) * (1.0 + e.norm_squared() / (NU * s2)).ln() - 3.0 * scale_m.ln();
    errors.iter().map(one).sum()
}

/// Builds the normal equations at a model. `further` gives additional columns, which belong to no parameter of the
/// model: the derivatives of a sample's position \[m per unit\].
pub(crate) fn normal(
    samples: &[&Sample],
    numbers: &[Number],
    here: &Fitted,
    further: &dyn Fn(&Sample) -> Vec<Vector3<f64>>,
) -> Normal {
    let own = numbers.len() + here.compliances.iter().map(Vec::len).sum::<usize>();
    let width = own + samples.first().map_or(0, |s| further(s).len());
    let mut rows = DMatrix::zeros(3 * samples.len(), width);
    let mut right = DVector::zeros(3 * samples.len());
    let from_level = here.geometry.level_to_instrument();
    for (i, sample) in samples.iter().enumerate() {
        let placed = here.geometry.place(sample.placing(), numbers);
        let error = sample.measured_m - placed.at_m - from_level * here.displacement(sample);
        // rows are scaled by the root of the weight, so their product has the weight
        let root = here.weight(&error).sqrt();
        let mut columns = placed.slopes;
        let gravity = numbers.iter().enumerate().filter_map(|(n, number)| match number {
            Number::Gravity(c) => Some((n, *c)),
            _ => None,
        });
        for (n, c) in gravity {
            let effects = here.effects.iter().zip(&here.compliances);
            let pulled: Vector3<f64> =
                effects.map(|(&e, own)| pull(sample, e, own).column(c).into_owned()).sum();
            columns[n] = from_level * (pulled + sample.deflection.known_slopes_m[c]);
        }
        let pulls = here.effects.iter().flat_map(|&e| &sample.deflection.per_compliance[e]);
        columns.extend(pulls.map(|p| from_level * p * here.geometry.gravity));
        columns.extend(further(sample));
        for (j, column) in columns.iter().enumerate() {
            rows.fixed_view_mut::<3, 1>(3 * i, j).copy_from(&(column * root));
        }
        right.fixed_rows_mut::<3>(3 * i).copy_from(&(error * root));
    }
    let transposed = rows.transpose();
    let mut curvature = &transposed * &rows;
    let mut gradient = &transposed * right;
    for (i, (number, moved)) in numbers.iter().zip(&here.moved).enumerate() {
        let precision = number.prior().powi(-2);
        curvature[(i, i)] += precision;
        gradient[i] -= precision * moved;
    }
    let compliances = here.compliances.iter().flatten();
    for (i, compliance) in (numbers.len()..).zip(compliances) {
        // a weak prior keeps the equations regular for a compliance that no weight loads
        let precision = PRIOR_RAD_PER_NM.powi(-2);
        curvature[(i, i)] += precision;
        gradient[i] -= precision * compliance;
    }
    Normal { curvature, gradient, own }
}

/// Takes one weighted Gauss-Newton step. It returns the step of the geometry, and sets the compliances to the best
/// values that springs can have.
fn step(samples: &[&Sample], numbers: &[Number], here: &mut Fitted) -> Vec<f64> {
    let normal = normal(samples, numbers, here, &|_| Vec::new());
    let n = numbers.len();
    let Some(best) = best_springs(&normal, n, &here.compliances) else { return vec![0.0; n] };
    let Best { mut step, deviations } = best;
    let (mut at, mut own) = (n, here.compliances.iter_mut().zip(&mut here.deviations));
    own.by_ref().for_each(|(compliances, own_deviations)| {
        let block = at..at + compliances.len();
        at = block.end;
        compliances.iter_mut().zip(&step[block.clone()]).for_each(|(c, by)| *c += by);
        *own_deviations = deviations[block].to_vec();
    });
    here.number_deviations = deviations[..n].to_vec();
    step.truncate(n);
    step
}
