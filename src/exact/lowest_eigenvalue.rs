//! The exact lowest eigenvalue of one arm, independent of any trial shape (a motion that bounds the lowest
//! mode).
//!
//! Let `K` be the stiffness matrix, `C` its inverse, `M` the mass matrix and `A = C^½ M C^½`. All eigenvalues of
//! `K φ = λ M φ` lie above a number `λ` exactly if `1/λ - A` is positive definite (Sylvester's law of inertia). One
//! Cholesky factorization decides whether it is.

use super::parts::INERTIAS;
use super::pose::{COORDINATES, Pose};
use super::shape::{BoxWork, Ideal, inertia_forces};
use crate::mechanics::Twist;
use crate::mechanics::lanes::{LaneWork, Lanes, in_lanes, subtract_multiple};

/// Relative tolerance of the lowest eigenvalue.
const TOLERANCE: f64 = 1e-9;

/// The inertia matrix of a case as a linear function of the line inertias of the pieces.
pub(super) struct CaseInertia {
    /// For each row of the matrix, the index of the piece and of its strain coordinate. A strain coordinate is a way in
    /// which a piece deforms, such as the torsion of a joint.
    coordinates: Vec<(usize, usize)>,
    /// Inertia matrix of the payload and of the bodies that the study gives, row by row.
    fixed: Vec<f64>,
    /// For each line inertia of a piece: index of the piece, index of the inertia, and the matrix per unit of it.
    forms: Vec<(usize, usize, Vec<f64>)>,
}

impl CaseInertia {
    /// Computes the inertia matrices of a case over the coordinates that deflect elastically in `some_arm`, an
    /// arbitrary arm of the space.
    pub(super) fn new(pose: &Pose, some_arm: &Ideal) -> Self {
        let mut coordinates = Vec::new();
        for (piece, posed) in pose.pieces.iter().enumerate() {
            for c in 0..posed.coordinates() {
                if posed.coordinate_stiffness(c, &some_arm.stiffness[piece]) > 0.0 {
                    coordinates.push((piece, c));
                }
            }
        }
        let nothing = vec![[0.0; INERTIAS]; pose.pieces.len()];
        let fixed = matrix(pose, &coordinates, &nothing);
        let mut forms = Vec::new();
        for piece in 0..pose.pieces.len() {
            for k in 0..INERTIAS {
                let mut unit = nothing.clone();
                unit[piece][k] = 1.0;
                let mut form = matrix(pose, &coordinates, &unit);
                form.iter_mut().zip(&fixed).for_each(|(a, b)| *a -= b);
                if form.iter().any(|x| x.abs() > 0.0) {
                    forms.push((piece, k, form));
                }
            }
        }
        Self { coordinates, fixed, forms }
    }

    /// The lowest eigenvalue of an arm \[1/s²\]. `quotient` is the Rayleigh quotient of a trial shape, which is an
    /// upper bound of the eigenvalue. Mostly the eigenvalue equals this bound, so the function first tests whether no
    /// eigenvalue lies below it by more than the tolerance.
    pub(super) fn lowest(&self, pose: &Pose, arm: &Ideal, quotient: f64) -> f64 {
        let scaled = self.scaled(pose, arm);
        let (mut low, mut high) = (quotient * (1.0 - TOLERANCE), quotient);
        if self.all_above(&scaled, low) {
            return quotient;
        }
        // Bisection: the trial shapes missed the lowest mode, which is rare.
        low = 0.0;
        while high - low > TOLERANCE * high {
            let middle = 0.5 * (low + high);
            if self.all_above(&scaled, middle) { low = middle } else { high = middle }
        }
        low
    }

    /// The matrix `A = C^½ M C^½` of an arm, row by row, with the compliance matrix `C` and the inertia matrix `M`.
    fn scaled(&self, pose: &Pose, arm: &Ideal) -> Vec<f64> {
        let n = self.coordinates.len();
        let mut m = self.fixed.clone();
        in_lanes(Inertia { m: &mut m, forms: &self.forms, of_arm: arm.inertia });
        let root: Vec<f64> = self
            .coordinates
            .iter()
            .map(|&(piece, c)| {
                pose.pieces[piece].coordinate_stiffness(c, &arm.stiffness[piece]).sqrt().recip()
            })
            .collect();
        for i in 0..n {
            for j in 0..n {
                m[i * n + j] *= root[i] * root[j];
            }
        }
        m
    }

    /// Whether all eigenvalues of `K φ = λ M φ` are above `lambda` \[1/s²\]. `scaled` is the matrix `A`. A Cholesky
    /// factorization tests whether `1/λ - A` is positive definite.
    fn all_above(&self, scaled: &[f64], lambda: f64) -> bool {
        let n = self.coordinates.len();
        let mut matrix: Vec<f64> = scaled.iter().map(|a| -a).collect();
        for i in 0..n {
            matrix[i * n + i] += 1.0 / lambda;
        }
        in_lanes(Cholesky { matrix: &mut matrix, n })
    }
}

/// Adds the matrices of an arm's line inertias to the inertia matrix of the payload and the given bodies.
struct Inertia<'a> {
    m: &'a mut [f64],
    forms: &'a [(usize, usize, Vec<f64>)],
    of_arm: &'a [[f64; INERTIAS]],
}

impl LaneWork for Inertia<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes>(self) {
        for (piece, k, form) in self.forms {
            subtract_multiple::<V>(self.m, -self.of_arm[*piece][*k], form);
        }
    }
}

/// Decides by a Cholesky factorization whether a symmetric matrix of `n` rows is positive definite.
struct Cholesky<'a> {
    matrix: &'a mut [f64],
    n: usize,
}

impl LaneWork for Cholesky<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<V: Lanes>(self) -> bool {
        let Self { matrix, n } = self;
        for j in 0..n {
            let pivot = matrix[j * n + j];
            // A pivot that is not positive proves an eigenvalue at or below `lambda`.
            if pivot <= 0.0 {
                return false;
            }
            let (done, below) = matrix.split_at_mut((j + 1) * n);
            let row = &done[j * n..];
            for i in j + 1..n {
                let target = &mut below[(i - j - 1) * n..(i - j) * n];
                let factor = target[j] / pivot;
                if factor != 0.0 {
                    subtract_multiple::<V>(&mut target[j + 1..], factor, &row[j + 1..]);
                }
            }
        }
        true
    }
}

/// The inertia matrix `M` of an arm over the given coordinates (index of the piece, index of its strain coordinate).
/// `inertia` has the line inertias of each piece. Each column of `M` consists of the inertia forces of a unit motion of
/// one coordinate.
fn matrix(pose: &Pose, coordinates: &[(usize, usize)], inertia: &[[f64; INERTIAS]]) -> Vec<f64> {
    let n = coordinates.len();
    let mut work = BoxWork::default();
    let mut out = vec![0.0; n * n];
    let mut x = vec![0.0; pose.pieces.len() * COORDINATES];
    for (j, &(piece, c)) in coordinates.iter().enumerate() {
        x[piece * COORDINATES + c] = 1.0;
        inertia_forces(pose, inertia, &Twist::zeros(), &x, &mut work);
        x[piece * COORDINATES + c] = 0.0;
        for (i, &(piece, c)) in coordinates.iter().enumerate() {
            out[i * n + j] = work.forces[piece * COORDINATES + c];
        }
    }
    out
}
