//! Closed forms of beam and spring statics and vibration, each with its source.
//!
//! SI units throughout; `bending_nm2` is EI, `shear_n` is k G A, `line_kg_per_m` is rho A.
//!
//! Sources: Roark's Formulas for Stress and Strain, straight beams (cantilevers); R. D. Blevins, Formulas for Natural
//! Frequency and Mode Shape (1979), chapter 8 (beams, tip mass, shafts).

use nalgebra::Matrix4;
use std::f64::consts::TAU;

/// Roots of cos(b) cosh(b) = -1 (Blevins, fixed-free).
pub const CANTILEVER_ROOTS: [f64; 3] = [1.875_104_068_711_961, 4.694_091_132_974_175, 7.854_757_438_237_613];

/// Tip deflection under a tip force: F L^3 / 3 EI.
pub fn tip_deflection_of_force_m(force_n: f64, length_m: f64, bending_nm2: f64) -> f64 {
    force_n * length_m.powi(3) / (3.0 * bending_nm2)
}

/// Tip deflection under a uniform load: q L^4 / 8 EI.
pub fn tip_deflection_of_line_load_m(load_n_per_m: f64, length_m: f64, bending_nm2: f64) -> f64 {
    load_n_per_m * length_m.powi(4) / (8.0 * bending_nm2)
}

/// Tip deflection under a tip moment: T L^2 / 2 EI.
pub fn tip_deflection_of_moment_m(moment_nm: f64, length_m: f64, bending_nm2: f64) -> f64 {
    moment_nm * length_m.powi(2) / (2.0 * bending_nm2)
}

/// What shear adds under a tip force: F L / k G A (Timoshenko 1921).
pub fn shear_deflection_of_force_m(force_n: f64, length_m: f64, shear_n: f64) -> f64 {
    force_n * length_m / shear_n
}

/// What shear adds under a uniform load: q L^2 / 2 k G A.
pub fn shear_deflection_of_line_load_m(load_n_per_m: f64, length_m: f64, shear_n: f64) -> f64 {
    load_n_per_m * length_m.powi(2) / (2.0 * shear_n)
}

/// Bending frequencies of a slender cantilever: b^2 / (2 pi L^2) sqrt(EI / rho A).
pub fn cantilever_frequencies_hz(length_m: f64, bending_nm2: f64, line_kg_per_m: f64) -> [f64; 3] {
    CANTILEVER_ROOTS.map(|root| bending_frequency_hz(root, length_m, bending_nm2, line_kg_per_m))
}

/// Lowest bending frequency of a slender cantilever with a point mass at the tip.
///
/// The root of `1 + cos b cosh b + (M / rho A L) b (cos b sinh b - sin b cosh b) = 0` (Blevins) between 0 and
/// the bare cantilever's, found by bisection.
pub fn tip_mass_frequency_hz(tip_kg: f64, length_m: f64, bending_nm2: f64, line_kg_per_m: f64) -> f64 {
    let ratio = tip_kg / (line_kg_per_m * length_m);
    let characteristic =
        |b: f64| 1.0 + b.cos() * b.cosh() + ratio * b * (b.cos() * b.sinh() - b.sin() * b.cosh());
    let root = bisected(characteristic, 1e-6, CANTILEVER_ROOTS[0]);
    bending_frequency_hz(root, length_m, bending_nm2, line_kg_per_m)
}

/// A stout cantilever: bending, shear and rotary inertia.
#[derive(Clone, Copy, Debug)]
pub struct StoutBeam {
    pub length_m: f64,
    pub bending_nm2: f64,
    pub shear_n: f64,
    pub line_kg_per_m: f64,
    /// rho I.
    pub rotary_kgm: f64,
}

impl StoutBeam {
    /// The lowest `count` frequencies, from Timoshenko's equations (Phil. Mag. 41 (1921) 744) without discretization.
    ///
    /// Deflection v, section rotation t, shear force Q and moment M obey `v' = t + Q / kGA`, `t' = M / EI`,
    /// `Q' = -w^2 rho A v`, `M' = -Q - w^2 rho I t`; clamped at 0 and free at L, the block of the transfer matrix that
    /// maps (Q, M) at the clamp to (Q, M) at the end is singular at a frequency.
    pub fn cantilever_frequencies_hz(&self, count: usize) -> Vec<f64> {
        let slender_hz = cantilever_frequencies_hz(self.length_m, self.bending_nm2, self.line_kg_per_m)[0];
        let (step_hz, mut low_hz) = (slender_hz / 20.0, slender_hz / 20.0);
        let mut roots_hz = Vec::new();
        while roots_hz.len() < count {
            let high_hz = low_hz + step_hz;
            if self.end_determinant(low_hz) * self.end_determinant(high_hz) < 0.0 {
                roots_hz.push(bisected(|f_hz| self.end_determinant(f_hz), low_hz, high_hz));
            }
            low_hz = high_hz;
        }
        roots_hz
    }

    /// State (v / L, t, Q L^2 / EI, M L / EI) along x / L, so that all entries are of one size.
    fn end_determinant(&self, frequency_hz: f64) -> f64 {
        let omega2 = (frequency_hz * TAU).powi(2);
        let shear = self.bending_nm2 / (self.shear_n * self.length_m.powi(2));
        let line = omega2 * self.line_kg_per_m * self.length_m.powi(4) / self.bending_nm2;
        let rotary = omega2 * self.rotary_kgm * self.length_m.powi(2) / self.bending_nm2;
        #[rustfmt::skip]
        let change = Matrix4::new(
            0.0,   1.0,     shear, 0.0,
            0.0,   0.0,     0.0,   1.0,
            -line, 0.0,     0.0,   0.0,
            0.0,   -rotary, -1.0,  0.0,
        );
        exponential(&change).fixed_view::<2, 2>(2, 2).determinant()
    }
}

/// Exponential of a matrix: the series of the matrix divided by a power of two, squared as often. With 20 terms of a matrix of
/// norm below 1/2 what is left out is below 1e-24.
fn exponential(matrix: &Matrix4<f64>) -> Matrix4<f64> {
    let halvings = (matrix.norm().log2().ceil() + 1.0).max(0.0) as i32;
    let small = matrix * 0.5_f64.powi(halvings);
    let mut term = Matrix4::identity();
    let mut sum = term;
    for n in 1..=20 {
        term *= small / f64::from(n);
        sum += term;
    }
    (0..halvings).fold(sum, |square, _| square * square)
}

fn bending_frequency_hz(root: f64, length_m: f64, bending_nm2: f64, line_kg_per_m: f64) -> f64 {
    root.powi(2) / (TAU * length_m.powi(2)) * (bending_nm2 / line_kg_per_m).sqrt()
}

/// Torsional frequency number `order` (from 1) of a fixed-free rod: (2n - 1) / (4 L) sqrt(GJ / rho Ip).
///
/// A tube that is not round twists with `torsion_nm2 = G J`, J below the polar moment Ip of its mass.
pub fn torsion_frequency_hz(order: usize, length_m: f64, torsion_nm2: f64, polar_kgm: f64) -> f64 {
    (2 * order - 1) as f64 / (4.0 * length_m) * (torsion_nm2 / polar_kgm).sqrt()
}

/// Axial frequency number `order` (from 1) of a fixed-free rod: (2n - 1) / (4 L) sqrt(EA / rho A).
pub fn axial_frequency_hz(order: usize, length_m: f64, axial_n: f64, line_kg_per_m: f64) -> f64 {
    torsion_frequency_hz(order, length_m, axial_n, line_kg_per_m)
}

/// A point mass on a rigid weightless lever on a spring.
pub fn pendulum_frequency_hz(stiffness_nm_per_rad: f64, mass_kg: f64, lever_m: f64) -> f64 {
    (stiffness_nm_per_rad / (mass_kg * lever_m.powi(2))).sqrt() / TAU
}

/// Two point masses on rigid weightless levers in a line, with a spring before each lever.
///
/// In absolute angles M = [[(m1 + m2) l1^2, m2 l1 l2], [m2 l1 l2, m2 l2^2]], K = [[k1 + k2, -k2], [-k2, k2]]; the
/// determinant of K - w^2 M is a quadratic in w^2.
pub fn double_pendulum_frequencies_hz(
    stiffness_nm_per_rad: [f64; 2],
    mass_kg: [f64; 2],
    lever_m: [f64; 2],
) -> [f64; 2] {
    let ([k1, k2], [m1, m2], [l1, l2]) = (stiffness_nm_per_rad, mass_kg, lever_m);
    let square = m1 * m2 * (l1 * l2).powi(2);
    let linear = (k1 + k2) * m2 * l2.powi(2) + k2 * (m1 + m2) * l1.powi(2) + 2.0 * k2 * m2 * l1 * l2;
    let constant = k1 * k2;
    let upper = (linear + (linear.powi(2) - 4.0 * square * constant).sqrt()) / (2.0 * square);
    // The lower root from the product of both: subtraction would cancel.
    let lower = constant / (square * upper);
    [lower, upper].map(|omega2| omega2.sqrt() / TAU)
}

/// The zero of a function that changes sign once in an interval.
pub fn bisected(function: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    let (mut low, mut high) = (low, high);
    let sign_at_low = function(low).signum();
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if function(middle).signum() == sign_at_low {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Real roots of x^3 + a x^2 + b x + c with three real roots, ascending (Viete).
pub fn cubic_roots(a: f64, b: f64, c: f64) -> [f64; 3] {
    let p = (a * a - 3.0 * b) / 9.0;
    let q = (2.0 * a.powi(3) - 9.0 * a * b + 27.0 * c) / 54.0;
    let angle = (q / p.powf(1.5)).clamp(-1.0, 1.0).acos() / 3.0;
    let root = |turn: f64| -2.0 * p.sqrt() * (angle + turn * TAU / 3.0).cos() - a / 3.0;
    let mut roots = [root(0.0), root(1.0), root(-1.0)];
    roots.sort_by(f64::total_cmp);
    roots
}
