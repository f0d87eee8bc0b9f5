//! A robust fit of geometry and compliances to absolute positions.
//!
//! The tracker's deviation is far below what any model of an arm leaves, so the scale of the errors is
//! fitted too: each position's error is a three-dimensional Student variable (4 degrees of freedom), whose
//! weights `(ν+3)/(ν + |r|²/s²)` let gross errors fade. What yields moves the point by `c P ĝ`, `P` its
//! displacement at unit compliance per direction of gravity ([`super::loads`]).

use super::kinematics::{Geometry, Number, Placing};
use super::loads::Sag;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Vector3};

/// Degrees of freedom of the errors.
const NU: f64 = 4.0;
const MOST_STEPS: usize = 40;
/// Largest turn of a frame in one step \[rad\].
const MOST_TURN_RAD: f64 = 0.3;

/// One measured position.
#[derive(Debug, Clone)]
pub struct Sample {
    /// Joint angles \[rad\].
    pub pose_rad: Vec<f64>,
    /// Which arm.
    pub arm: usize,
    /// Point on the tool.
    pub point: usize,
    /// Session of the instrument.
    pub station: usize,
    /// Place among the samples.
    pub index: usize,
    /// Which pose: samples of one pose are kept out together.
    pub group: usize,
    /// Position \[m\].
    pub measured_m: Vector3<f64>,
    /// What gravity does to it.
    pub sag: Sag,
}

impl Sample {
    /// What is asked of the geometry.
    pub fn placing(&self) -> Placing<'_> {
        Placing { arm: self.arm, pose_rad: &self.pose_rad, point: self.point, station: self.station }
    }
}

/// A fitted model.
#[derive(Debug, Clone)]
pub struct Fitted {
    /// Geometry.
    pub geometry: Geometry,
    /// By how much each number has moved from nominal.
    pub moved: Vec<f64>,
    /// Indices of the candidates in it.
    pub effects: Vec<usize>,
    /// Their compliances \[rad/(N m)\].
    pub compliances: Vec<f64>,
    /// Standard deviations of the compliances.
    pub deviations: Vec<f64>,
    /// Scale of the errors \[m\].
    pub scale_m: f64,
    /// ln of the likelihood.
    pub ln_likelihood: f64,
}

impl Fitted {
    /// A geometry without effects.
    pub fn rigid(geometry: Geometry, scale_m: f64) -> Self {
        let (effects, compliances, deviations) = (Vec::new(), Vec::new(), Vec::new());
        Self { geometry, moved: Vec::new(), effects, compliances, deviations, scale_m, ln_likelihood: 0.0 }
    }

    /// Where the model has the point \[m\].
    pub fn predicted_m(&self, sample: &Sample) -> Vector3<f64> {
        let rigid = self.geometry.place(sample.placing(), &[]).at_m;
        rigid + self.geometry.level_to_instrument() * self.displacement(sample)
    }

    /// Error of a sample \[m\].
    pub fn error(&self, sample: &Sample) -> Vector3<f64> {
        sample.measured_m - self.predicted_m(sample)
    }

    fn displacement(&self, sample: &Sample) -> Vector3<f64> {
        let effects = self.effects.iter().zip(&self.compliances);
        let pulled = effects.map(|(&e, c)| sample.sag.per_compliance[e] * self.geometry.gravity * *c);
        let gravity = &self.geometry.gravity;
        let leaning = sample.sag.known_slopes_m[0] * gravity.x + sample.sag.known_slopes_m[1] * gravity.y;
        sample.sag.known_m + leaning + pulled.sum::<Vector3<f64>>()
    }

    /// Weight of a sample with this error \[1/m²\].
    pub fn weight(&self, error: &Vector3<f64>) -> f64 {
        weight(error, self.scale_m) / (self.scale_m * self.scale_m)
    }
}

/// Fits geometry and the named compliances to the samples, from a model.
pub fn fit(samples: &[&Sample], numbers: &[Number], effects: &[usize], start: &Fitted) -> Fitted {
    let mut here = start.clone();
    here.compliances = effects
        .iter()
        .map(|e| start.effects.iter().position(|s| s == e).map_or(0.0, |i| start.compliances[i]))
        .collect();
    here.effects = effects.to_vec();
    here.moved.resize(numbers.len(), 0.0);
    for _ in 0..MOST_STEPS {
        let before = here.scale_m;
        let step = shortened(numbers, step(samples, numbers, &mut here));
        here.geometry.step(numbers, &step);
        here.moved.iter_mut().zip(&step).for_each(|(m, s)| *m += s);
        here.scale_m = scale(samples, &here);
        let largest = step.iter().map(|s| s.abs()).fold(0.0, f64::max);
        if (here.scale_m / before - 1.0).abs() < 1e-6 && largest < 1e-6 {
            break;
        }
    }
    here.ln_likelihood = ln_likelihood(samples, &here);
    here
}

/// A step that turns no frame too far for a straight line.
fn shortened(numbers: &[Number], step: Vec<f64>) -> Vec<f64> {
    let turns = numbers.iter().zip(&step).filter(|(n, _)| n.turns()).map(|(_, s)| s.abs());
    let part = (MOST_TURN_RAD / turns.fold(0.0, f64::max)).min(1.0);
    step.into_iter().map(|s| s * part).collect()
}

fn weight(error: &Vector3<f64>, scale_m: f64) -> f64 {
    (NU + 3.0) / (NU + error.norm_squared() / (scale_m * scale_m))
}

fn scale(samples: &[&Sample], fitted: &Fitted) -> f64 {
    let mut scale_m = fitted.scale_m;
    let errors: Vec<Vector3<f64>> = samples.iter().map(|s| fitted.error(s)).collect();
    for _ in 0..8 {
        let sum: f64 = errors.iter().map(|e| weight(e, scale_m) * e.norm_squared()).sum();
        scale_m = (sum / (3.0 * samples.len() as f64)).sqrt().max(1e-7);
    }
    scale_m
}

fn ln_likelihood(samples: &[&Sample], fitted: &Fitted) -> f64 {
    let s2 = fitted.scale_m * fitted.scale_m;
    samples
        .iter()
        .map(|sample| {
            let r2 = fitted.error(sample).norm_squared();
            -0.5 * (NU + 3.0) * (1.0 + r2 / (NU * s2)).ln() - 3.0 * fitted.scale_m.ln()
        })
        .sum()
}

/// Weighted normal equations of a model: its numbers, its effects, and further columns.
pub struct Normal {
    /// Curvature, priors included.
    pub curvature: DMatrix<f64>,
    /// Gradient towards the readings.
    pub gradient: DVector<f64>,
    /// How many of the columns belong to the model.
    pub own: usize,
}

/// The normal equations at a model; `further` gives a sample's further columns \[m per unit\].
pub fn normal(
    samples: &[&Sample],
    numbers: &[Number],
    here: &Fitted,
    further: &dyn Fn(&Sample) -> Vec<Vector3<f64>>,
) -> Normal {
    let own = numbers.len() + here.effects.len();
    let width = own + samples.first().map_or(0, |s| further(s).len());
    let mut rows = DMatrix::zeros(3 * samples.len(), width);
    let mut right = DVector::zeros(3 * samples.len());
    let from_level = here.geometry.level_to_instrument();
    for (i, sample) in samples.iter().enumerate() {
        let placed = here.geometry.place(sample.placing(), numbers);
        let error = sample.measured_m - placed.at_m - from_level * here.displacement(sample);
        let root = here.weight(&error).sqrt();
        let mut columns = placed.slopes;
        let gravity = numbers.iter().enumerate().filter_map(|(n, number)| match number {
            Number::Gravity(c) => Some((n, *c)),
            _ => None,
        });
        for (n, c) in gravity {
            let effects = here.effects.iter().zip(&here.compliances);
            let pull: Vector3<f64> =
                effects.map(|(&e, amount)| sample.sag.per_compliance[e].column(c) * *amount).sum();
            columns[n] = from_level * (pull + sample.sag.known_slopes_m[c]);
        }
        columns.extend(
            here.effects.iter().map(|&e| from_level * sample.sag.per_compliance[e] * here.geometry.gravity),
        );
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
    Normal { curvature, gradient, own }
}

/// A factorized curvature, scaled to a unit diagonal.
pub struct Factor {
    cholesky: Cholesky<f64, Dyn>,
    diagonal: DVector<f64>,
}

impl Factor {
    /// Of the rows and columns that are free.
    pub fn new(curvature: &DMatrix<f64>, free: &[usize]) -> Option<Self> {
        let sub = DMatrix::from_fn(free.len(), free.len(), |i, j| curvature[(free[i], free[j])]);
        let diagonal = sub.diagonal().map(|d| 1.0 / d.max(1e-300).sqrt());
        let scaled = DMatrix::from_fn(free.len(), free.len(), |i, j| {
            diagonal[i] * sub[(i, j)] * diagonal[j] + if i == j { 1e-12 } else { 0.0 }
        });
        Some(Self { cholesky: Cholesky::new(scaled)?, diagonal })
    }

    /// Solves for one right side.
    pub fn solve(&self, right: &DVector<f64>) -> DVector<f64> {
        self.cholesky.solve(&right.component_mul(&self.diagonal)).component_mul(&self.diagonal)
    }

    /// Standard deviations.
    fn deviations(&self) -> DVector<f64> {
        let inverse = self.cholesky.inverse();
        DVector::from_fn(self.diagonal.len(), |i, _| inverse[(i, i)].sqrt() * self.diagonal[i])
    }
}

/// One weighted Gauss-Newton step of the geometry; the compliances are set to their best, not negative.
fn step(samples: &[&Sample], numbers: &[Number], here: &mut Fitted) -> Vec<f64> {
    let normal = normal(samples, numbers, here, &|_| Vec::new());
    let (n, m) = (numbers.len(), here.effects.len());
    let mut free: Vec<usize> = (0..n + m).collect();
    loop {
        let Some(factor) = Factor::new(&normal.curvature, &free) else { return vec![0.0; n] };
        let x = factor.solve(&DVector::from_fn(free.len(), |i, _| normal.gradient[free[i]]));
        let falls = |(p, x): (&usize, &f64)| *p >= n && here.compliances[*p - n] + *x < 0.0;
        let negative: Vec<usize> =
            free.iter().zip(x.iter()).filter(|(p, x)| falls((p, x))).map(|(p, _)| *p).collect();
        if negative.is_empty() {
            return take(here, &free, &x, &factor.deviations(), n);
        }
        free.retain(|p| !negative.contains(p));
        for p in negative {
            here.compliances[p - n] = 0.0;
        }
    }
}

/// Takes the compliances of a step and returns its geometry.
fn take(
    here: &mut Fitted,
    free: &[usize],
    x: &DVector<f64>,
    deviations: &DVector<f64>,
    n: usize,
) -> Vec<f64> {
    let mut out = vec![0.0; n];
    let m = here.effects.len();
    let old = std::mem::replace(&mut here.compliances, vec![0.0; m]);
    here.deviations = vec![f64::INFINITY; m];
    for (k, &p) in free.iter().enumerate() {
        if p < n {
            out[p] = x[k];
        } else {
            here.compliances[p - n] = old[p - n] + x[k];
            here.deviations[p - n] = deviations[k];
        }
    }
    out
}
