//! A robust fit of geometry and compliances to absolute positions.
//!
//! The tracker's deviation is far below what any model of an arm leaves, so the scale of the errors is
//! fitted too: each position's error is a three-dimensional Student variable (4 degrees of freedom), whose
//! weights `(ν+3)/(ν + |r|²/s²)` let gross errors fade. What yields moves the point by `c a(pose)`, `a`
//! the displacement at unit compliance, from mechanics.

use super::kinematics::{Geometry, Number};
use nalgebra::{Cholesky, DMatrix, DVector, Vector3};

/// Degrees of freedom of the errors.
const NU: f64 = 4.0;
const MOST_STEPS: usize = 40;

/// One measured position.
pub struct Sample {
    /// Joint angles \[rad\].
    pub pose_rad: Vec<f64>,
    /// Point on the tool.
    pub point: usize,
    /// Position \[m\].
    pub measured_m: Vector3<f64>,
    /// Displacement that the model already has, arm's frame \[m\].
    pub known_m: Vector3<f64>,
    /// Displacement at unit compliance of each candidate, arm's frame \[m\].
    pub signatures: Vec<Vector3<f64>>,
}

/// A fitted model.
#[derive(Clone)]
pub struct Fitted {
    /// Geometry.
    pub geometry: Geometry,
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
    /// Error of a sample \[m\].
    pub fn error(&self, sample: &Sample) -> Vector3<f64> {
        let rigid = self.geometry.place(&sample.pose_rad, sample.point, &[]).at_m;
        sample.measured_m - rigid - self.geometry.base * self.displacement(sample)
    }

    fn displacement(&self, sample: &Sample) -> Vector3<f64> {
        let effects = self.effects.iter().zip(&self.compliances);
        sample.known_m + effects.map(|(&e, c)| sample.signatures[e] * *c).sum::<Vector3<f64>>()
    }
}

/// Fits geometry and the named compliances to the samples, from a geometry.
pub fn fit(samples: &[&Sample], numbers: &[Number], effects: &[usize], start: &Fitted) -> Fitted {
    let mut here = start.clone();
    here.compliances = effects
        .iter()
        .map(|e| start.effects.iter().position(|s| s == e).map_or(0.0, |i| start.compliances[i]))
        .collect();
    here.effects = effects.to_vec();
    let mut moved = vec![0.0; numbers.len()];
    for _ in 0..MOST_STEPS {
        let before = here.scale_m;
        let step = step(samples, numbers, &mut here, &moved);
        here.geometry.step(numbers, &step);
        moved.iter_mut().zip(&step).for_each(|(m, s)| *m += s);
        here.scale_m = scale(samples, &here);
        let largest = step.iter().map(|s| s.abs()).fold(0.0, f64::max);
        if (here.scale_m / before - 1.0).abs() < 1e-6 && largest < 1e-7 {
            break;
        }
    }
    here.ln_likelihood = ln_likelihood(samples, &here);
    here
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

/// One weighted Gauss-Newton step of the geometry; the compliances are set to their best, not negative.
fn step(samples: &[&Sample], numbers: &[Number], here: &mut Fitted, moved: &[f64]) -> Vec<f64> {
    let (n, m) = (numbers.len(), here.effects.len());
    let mut a = DMatrix::zeros(n + m, n + m);
    let mut b = DVector::zeros(n + m);
    for sample in samples {
        let placed = here.geometry.place(&sample.pose_rad, sample.point, numbers);
        let error = here.error(sample);
        let w = weight(&error, here.scale_m) / (here.scale_m * here.scale_m);
        let effects = here.effects.iter().map(|&e| here.geometry.base * sample.signatures[e]);
        let columns: Vec<Vector3<f64>> = placed.slopes.into_iter().chain(effects).collect();
        for (i, ci) in columns.iter().enumerate() {
            b[i] += w * ci.dot(&error);
            for (j, cj) in columns[..=i].iter().enumerate() {
                a[(i, j)] += w * ci.dot(cj);
            }
        }
    }
    a.fill_upper_triangle_with_lower_triangle();
    for (i, number) in numbers.iter().enumerate() {
        let precision = number.prior().powi(-2);
        a[(i, i)] += precision;
        b[i] -= precision * moved[i];
    }
    solve_bounded(&a, &b, here, n)
}

/// Solves with the compliances kept from falling below zero.
fn solve_bounded(a: &DMatrix<f64>, b: &DVector<f64>, here: &mut Fitted, n: usize) -> Vec<f64> {
    let m = here.effects.len();
    let mut free: Vec<usize> = (0..n + m).collect();
    loop {
        let sub = DMatrix::from_fn(free.len(), free.len(), |i, j| a[(free[i], free[j])]);
        let diagonal = sub.diagonal().map(|d| 1.0 / d.max(1e-300).sqrt());
        let scaled = DMatrix::from_diagonal(&diagonal) * &sub * DMatrix::from_diagonal(&diagonal)
            + DMatrix::identity(free.len(), free.len()) * 1e-12;
        let right = DVector::from_fn(free.len(), |i, _| b[free[i]] * diagonal[i]);
        let Some(cholesky) = Cholesky::new(scaled) else { return vec![0.0; n] };
        let x = cholesky.solve(&right).component_mul(&diagonal);
        let negative: Vec<usize> = free
            .iter()
            .zip(x.iter())
            .filter(|(p, x)| **p >= n && here.compliances[**p - n] + **x < 0.0)
            .map(|(p, _)| *p)
            .collect();
        if negative.is_empty() {
            let inverse = cholesky.inverse();
            let mut out = vec![0.0; n];
            let old = std::mem::replace(&mut here.compliances, vec![0.0; m]);
            here.deviations = vec![f64::INFINITY; m];
            for (k, &p) in free.iter().enumerate() {
                if p < n {
                    out[p] = x[k];
                } else {
                    here.compliances[p - n] = old[p - n] + x[k];
                    here.deviations[p - n] = inverse[(k, k)].sqrt() * diagonal[k];
                }
            }
            return out;
        }
        free.retain(|p| !negative.contains(p));
        for p in negative {
            here.compliances[p - n] = 0.0;
        }
    }
}

/// The rotation and origin that carry nominal points onto measured ones (Kabsch), refined on the nearest
/// 90 %.
pub fn align(samples: &[&Sample], geometry: &mut Geometry) {
    let nominal: Vec<Vector3<f64>> =
        samples.iter().map(|s| geometry.place(&s.pose_rad, s.point, &[]).at_m).collect();
    let mut kept: Vec<usize> = (0..samples.len()).collect();
    for _ in 0..4 {
        let count = kept.len() as f64;
        let from = kept.iter().map(|&i| nominal[i]).sum::<Vector3<f64>>() / count;
        let to = kept.iter().map(|&i| samples[i].measured_m).sum::<Vector3<f64>>() / count;
        let h: nalgebra::Matrix3<f64> =
            kept.iter().map(|&i| (nominal[i] - from) * (samples[i].measured_m - to).transpose()).sum();
        let svd = h.svd(true, true);
        let (Some(u), Some(vt)) = (svd.u, svd.v_t) else { return };
        let mut flip = nalgebra::Matrix3::identity();
        flip[(2, 2)] = (vt.transpose() * u.transpose()).determinant().signum();
        let rotation = nalgebra::Rotation3::from_matrix_unchecked(vt.transpose() * flip * u.transpose());
        let origin = to - rotation * from;
        geometry.base = rotation;
        geometry.origin_m = origin;
        let error = |i: usize| (samples[i].measured_m - origin - rotation * nominal[i]).norm();
        let mut order: Vec<usize> = (0..samples.len()).collect();
        order.sort_by(|&i, &j| error(i).total_cmp(&error(j)));
        order.truncate((samples.len() * 9).div_ceil(10).max(4));
        kept = order;
    }
}
