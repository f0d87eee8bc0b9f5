//! A robust fit of geometry and compliances to absolute positions.
//!
//! The tracker's deviation is far below what any model of an arm leaves, so the scale of the errors is
//! fitted too: each position's error is a three-dimensional Student variable (4 degrees of freedom), whose
//! weights `(ν+3)/(ν + |r|²/s²)` let gross errors fade. What yields moves the point by `c P ĝ`, `P` its
//! displacement at unit compliance per direction of gravity ([`super::loads`]).

use super::kinematics::{Geometry, Number, Placing};
use super::loads::{FRAME_ENTRIES, Sag};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Matrix2, Matrix3, Vector2, Vector3};
use std::ops::Range;

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
    /// Standard deviations of the numbers.
    pub number_deviations: Vec<f64>,
    /// Indices of the candidates in it.
    pub effects: Vec<usize>,
    /// The compliances of each \[rad/(N m)\].
    pub compliances: Vec<Vec<f64>>,
    /// Their standard deviations.
    pub deviations: Vec<Vec<f64>>,
    /// Scale of the errors \[m\].
    pub scale_m: f64,
    /// ln of the likelihood.
    pub ln_likelihood: f64,
}

impl Fitted {
    /// A geometry without effects.
    pub fn rigid(geometry: Geometry, scale_m: f64) -> Self {
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

    /// Where the model has the point \[m\].
    pub fn predicted_m(&self, sample: &Sample) -> Vector3<f64> {
        let rigid = self.geometry.place(sample.placing(), &[]).at_m;
        rigid + self.geometry.level_to_instrument() * self.displacement(sample)
    }

    /// Error of a sample \[m\].
    pub fn error(&self, sample: &Sample) -> Vector3<f64> {
        sample.measured_m - self.predicted_m(sample)
    }

    /// By how much a sample's point is moved by all that yields, level frame \[m\].
    pub fn displacement(&self, sample: &Sample) -> Vector3<f64> {
        let effects = self.effects.iter().zip(&self.compliances);
        let gravity = &self.geometry.gravity;
        let pulled = effects.map(|(&e, c)| pull(sample, e, c) * gravity);
        let leaning = sample.sag.known_slopes_m[0] * gravity.x + sample.sag.known_slopes_m[1] * gravity.y;
        sample.sag.known_m + leaning + pulled.sum::<Vector3<f64>>()
    }

    /// Weight of a sample with this error \[1/m²\].
    pub fn weight(&self, error: &Vector3<f64>) -> f64 {
        weight(error, self.scale_m) / (self.scale_m * self.scale_m)
    }
}

/// What the compliances of an effect move the point by, per direction of gravity.
fn pull(sample: &Sample, effect: usize, compliances: &[f64]) -> Matrix3<f64> {
    sample.sag.per_compliance[effect].iter().zip(compliances).map(|(p, c)| p * *c).sum()
}

/// Fits geometry and the named compliances to the samples, from a model.
pub fn fit(samples: &[&Sample], numbers: &[Number], effects: &[usize], start: &Fitted) -> Fitted {
    let mut here = start.clone();
    here.compliances = effects
        .iter()
        .map(|&e| {
            let known = start.effects.iter().position(|s| *s == e);
            let none = || vec![0.0; samples.first().map_or(1, |s| s.sag.per_compliance[e].len())];
            known.map_or_else(none, |i| start.compliances[i].clone())
        })
        .collect();
    here.effects = effects.to_vec();
    here.moved.resize(numbers.len(), 0.0);
    for _ in 0..MOST_STEPS {
        let before = here.scale_m;
        let step = shortened(numbers, step(samples, numbers, &mut here));
        here.geometry.step(numbers, &step);
        here.moved.iter_mut().zip(&step).for_each(|(m, s)| *m += s);
        here.scale_m = scale(&errors(samples, &here), here.scale_m);
        let largest = step.iter().map(|s| s.abs()).fold(0.0, f64::max);
        if (here.scale_m / before - 1.0).abs() < 1e-6 && largest < 1e-6 {
            break;
        }
    }
    here.ln_likelihood = ln_likelihood(&errors(samples, &here), here.scale_m);
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

fn errors(samples: &[&Sample], fitted: &Fitted) -> Vec<Vector3<f64>> {
    samples.iter().map(|s| fitted.error(s)).collect()
}

/// The scale of errors, from one nearby.
pub fn scale(errors: &[Vector3<f64>], near_m: f64) -> f64 {
    let mut scale_m = near_m;
    for _ in 0..8 {
        let sum: f64 = errors.iter().map(|e| weight(e, scale_m) * e.norm_squared()).sum();
        scale_m = (sum / (3.0 * errors.len() as f64)).sqrt().max(1e-7);
    }
    scale_m
}

/// ln of the likelihood of errors of a scale.
pub fn ln_likelihood(errors: &[Vector3<f64>], scale_m: f64) -> f64 {
    let s2 = scale_m * scale_m;
    let one =
        |e: &Vector3<f64>| -0.5 * (NU + 3.0) * (1.0 + e.norm_squared() / (NU * s2)).ln() - 3.0 * scale_m.ln();
    errors.iter().map(one).sum()
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
    let own = numbers.len() + here.compliances.iter().map(Vec::len).sum::<usize>();
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
            let pulled: Vector3<f64> =
                effects.map(|(&e, own)| pull(sample, e, own).column(c).into_owned()).sum();
            columns[n] = from_level * (pulled + sample.sag.known_slopes_m[c]);
        }
        let pulls = here.effects.iter().flat_map(|&e| &sample.sag.per_compliance[e]);
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

/// One weighted Gauss-Newton step of the geometry; the compliances are set to their best that is a spring.
fn step(samples: &[&Sample], numbers: &[Number], here: &mut Fitted) -> Vec<f64> {
    let normal = normal(samples, numbers, here, &|_| Vec::new());
    let n = numbers.len();
    let mut first = n;
    let blocks: Vec<Range<usize>> = (here.compliances.iter())
        .map(|own| {
            let block = first..first + own.len();
            first = block.end;
            block
        })
        .collect();
    let mut held = vec![false; blocks.len()];
    here.deviations = blocks.iter().map(|b| vec![f64::INFINITY; b.len()]).collect();
    loop {
        let is_held = |p: &usize| blocks.iter().zip(&held).any(|(b, held)| *held && b.contains(p));
        let free: Vec<usize> = (0..first).filter(|p| !is_held(p)).collect();
        let Some(factor) = Factor::new(&normal.curvature, &free) else { return vec![0.0; n] };
        let x = factor.solve(&DVector::from_fn(free.len(), |i, _| normal.gradient[free[i]]));
        let mut step = vec![0.0; first];
        let mut deviations = vec![f64::INFINITY; first];
        let own_deviations = factor.deviations();
        let answers = free.iter().zip(x.iter().zip(own_deviations.iter()));
        answers.for_each(|(&p, (x, deviation))| (step[p], deviations[p]) = (*x, *deviation));
        let moved = here.compliances.iter().zip(&blocks);
        let wanted: Vec<Vec<f64>> =
            moved.map(|(own, b)| own.iter().zip(&step[b.clone()]).map(|(c, s)| c + s).collect()).collect();
        let springs: Vec<Vec<f64>> = wanted.iter().map(|c| nearest_spring(c)).collect();
        let no_spring: Vec<usize> =
            (0..blocks.len()).filter(|&k| !held[k] && springs[k] != wanted[k]).collect();
        if no_spring.is_empty() {
            here.compliances = wanted;
            here.deviations = blocks.into_iter().map(|b| deviations[b].to_vec()).collect();
            here.number_deviations = deviations[..n].to_vec();
            step.truncate(n);
            return step;
        }
        for k in no_spring {
            here.compliances[k].clone_from(&springs[k]);
            held[k] = true;
        }
    }
}

/// The compliances themselves if they are a spring, else the nearest that are: none is negative, and no
/// moment turns a frame against itself.
fn nearest_spring(compliances: &[f64]) -> Vec<f64> {
    match compliances.len() {
        1 => vec![compliances[0].max(0.0)],
        5 => nearest_base(compliances),
        _ => nearest_frame(compliances),
    }
}

/// Of a base: zz is nowhere seen and as large as the couplings need, which there are none without tilts.
fn nearest_base(compliances: &[f64]) -> Vec<f64> {
    let level: Matrix2<f64> = frame_matrix(compliances).fixed_view::<2, 2>(0, 0).into_owned();
    let mut eigen = level.symmetric_eigen();
    if eigen.eigenvalues.min() > 0.0 {
        return compliances.to_vec();
    }
    eigen.eigenvalues.apply(|e| *e = e.max(0.0));
    let c = eigen.recompose();
    vec![c[(0, 0)], c[(1, 1)], c[(0, 1)], 0.0, 0.0]
}

fn nearest_frame(compliances: &[f64]) -> Vec<f64> {
    let mut eigen = frame_matrix(compliances).symmetric_eigen();
    if eigen.eigenvalues.min() >= 0.0 {
        return compliances.to_vec();
    }
    // above zero, so that rounding does not take it below
    let least = 1e-9 * eigen.eigenvalues.max().max(0.0);
    eigen.eigenvalues.apply(|e| *e = e.max(least));
    let c = eigen.recompose();
    FRAME_ENTRIES.iter().map(|&at| c[at]).collect()
}

/// The compliance matrix of a frame: zz, where it is not among the numbers, as large as the couplings need.
pub fn frame_matrix(compliances: &[f64]) -> Matrix3<f64> {
    let mut out = Matrix3::zeros();
    for (&(i, j), c) in FRAME_ENTRIES.iter().zip(compliances) {
        (out[(i, j)], out[(j, i)]) = (*c, *c);
    }
    if compliances.len() == 5 {
        let coupling = Vector2::new(out[(0, 2)], out[(1, 2)]);
        let level: Matrix2<f64> = out.fixed_view::<2, 2>(0, 0).into_owned();
        out[(2, 2)] = level.try_inverse().map_or(0.0, |inverse| coupling.dot(&(inverse * coupling)));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_a_spring_stays_and_what_is_none_becomes_the_nearest() {
        let spring = [4e-6, 5e-6, 1e-6, 2e-6, -1e-6, 6e-6];
        assert_eq!(nearest_spring(&spring), spring);
        assert_eq!(nearest_spring(&[-1e-6]), [0.0]);
        // eigenvalues 3 and -1 about the diagonals of xy, 2 about z
        let made = nearest_spring(&[1.0, 1.0, 2.0, 0.0, 0.0, 2.0]);
        let nearest = [1.5, 1.5, 1.5, 0.0, 0.0, 2.0];
        assert!(made.iter().zip(nearest).all(|(a, b)| (a - b).abs() < 1e-6), "{made:?}");
        assert_eq!(nearest_spring(&[1.0, -1.0, 0.0, 0.5, 0.5]), [1.0, 0.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn a_base_turns_about_the_vertical_no_more_than_its_couplings_need() {
        let matrix = frame_matrix(&[4e-6, 5e-6, 1e-6, 2e-6, -1e-6]);
        let eigenvalues = matrix.symmetric_eigenvalues();
        assert!(eigenvalues.min().abs() < 1e-9 * eigenvalues.max(), "just a spring: {eigenvalues}");
        assert_eq!((matrix[(0, 1)], matrix[(2, 0)]), (1e-6, 2e-6));
    }
}
