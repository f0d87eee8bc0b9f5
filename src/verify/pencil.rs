//! Stiffness matrix K and inertia matrix M of an arm in a pose, and the test whether its lowest mode is below a
//! given frequency.
//!
//! `K - λ M` is positive definite exactly if `λ` is below every eigenvalue `λ_i` of `K x = λ_i M x`, so one
//! Cholesky factorization decides. For a box, `K` has every stiffness at its greatest and `M` every inertia at its
//! least. Compared with any member, `K` is then at least as large and `M` at most as large (in the order of
//! positive semidefinite differences). So no Rayleigh quotient `xᵀKx / xᵀMx` is smaller. By the principle of Courant
//! and Fischer, `λ_1` is no smaller either.

/// The matrix pencil of an arm in a pose: diagonal stiffness matrix `K` and inertia matrix `M` over its
/// coordinates.
pub(super) struct Pencil {
    stiffness: Vec<f64>,
    /// Lower triangle of the inertia matrix, row by row.
    inertia: Vec<f64>,
}

/// The Cholesky factor of `K - λ M`, as a lower triangle row by row.
pub(super) struct Factor {
    size: usize,
    lower: Vec<f64>,
}

/// Number of steps of inverse iteration that lower the Rayleigh quotient of a motion further.
const STEPS: usize = 5;

/// Index of the first entry of row `i` in a lower triangle that is stored row by row.
fn row(i: usize) -> usize {
    i * (i + 1) / 2
}

impl Pencil {
    /// The pencil with the stiffnesses `stiffness` (the diagonal of K) and the inertia matrix `inertia` (a lower
    /// triangle). Coordinates of infinite stiffness cannot move, so their inertia is set to zero.
    pub(super) fn new(mut stiffness: Vec<f64>, mut inertia: Vec<f64>) -> Self {
        let size = stiffness.len();
        for i in 0..size {
            if stiffness[i] == f64::INFINITY {
                stiffness[i] = 1.0;
                inertia[row(i)..row(i + 1)].fill(0.0);
                (i..size).for_each(|j| inertia[row(j) + i] = 0.0);
            }
        }
        Self { stiffness, inertia }
    }

    /// The Cholesky factor of `K - λ M` at `λ` = `eigenvalue`; `None` if an eigenvalue of the pencil is `λ` or less.
    pub(super) fn factor(&self, eigenvalue: f64) -> Option<Factor> {
        self.factor_or_slower(eigenvalue).ok()
    }

    /// The Cholesky factor of `K - λ M` at `λ` = `eigenvalue`. If there is none, a motion `x` with `xᵀ K x <= λ xᵀ M x`
    /// is returned as the error. The motion comes from the first pivot that is not positive. It is one at the
    /// coordinate of the pivot and zero at later coordinates; the earlier coordinates are in equilibrium. The pivot
    /// then equals `xᵀ (K - λ M) x`.
    fn factor_or_slower(&self, eigenvalue: f64) -> Result<Factor, Vec<f64>> {
        let size = self.stiffness.len();
        let mut lower = vec![0.0; self.inertia.len()];
        for i in 0..size {
            let (above, here) = lower.split_at_mut(row(i));
            for j in 0..i {
                let other = &above[row(j)..row(j + 1)];
                let known: f64 = here[..j].iter().zip(other).map(|(a, b)| a * b).sum();
                here[j] = (-eigenvalue * self.inertia[row(i) + j] - known) / other[j];
            }
            let known: f64 = here[..i].iter().map(|a| a * a).sum();
            let pivot = self.stiffness[i] - eigenvalue * self.inertia[row(i) + i] - known;
            if pivot <= 0.0 {
                let mut x: Vec<f64> = here[..i].iter().map(|entry| -entry).collect();
                Factor { size: i, lower }.solve_upper(&mut x);
                x.push(1.0);
                x.resize(size, 0.0);
                return Err(x);
            }
            here[i] = pivot.sqrt();
        }
        Ok(Factor { size, lower })
    }

    /// Approximation of the lowest mode by a few steps of inverse iteration with `factor`, the Cholesky factor of
    /// `K - λ M`. The mode is scaled to `xᵀ M x = 1`.
    pub(super) fn lowest_mode(&self, factor: &Factor) -> Vec<f64> {
        let mut x = vec![1.0; self.stiffness.len()];
        for _ in 0..3 {
            x = factor.solve(self.momentum(&x));
            let scale = 1.0 / self.kinetic(&x).sqrt();
            if !scale.is_finite() {
                break;
            }
            x.iter_mut().for_each(|x| *x *= scale);
        }
        x
    }

    /// A motion whose Rayleigh quotient is at most `eigenvalue`, improved by a few steps of inverse iteration.
    /// `None` if every motion has a larger quotient.
    pub(super) fn slower_motion(&self, eigenvalue: f64) -> Option<Vec<f64>> {
        let mut x = self.factor_or_slower(eigenvalue).err()?;
        for _ in 0..STEPS {
            x = self.momentum(&x);
            x.iter_mut().zip(&self.stiffness).for_each(|(x, k)| *x /= k);
            let scale = 1.0 / self.kinetic(&x).sqrt();
            x.iter_mut().for_each(|x| *x *= scale);
        }
        Some(x)
    }

    fn momentum(&self, x: &[f64]) -> Vec<f64> {
        let entry = |i: usize, j: usize| self.inertia[row(i.max(j)) + i.min(j)];
        (0..x.len()).map(|i| x.iter().enumerate().map(|(j, x)| entry(i, j) * x).sum()).collect()
    }

    fn kinetic(&self, x: &[f64]) -> f64 {
        square(&self.inertia, x)
    }

    /// Twice the strain energy of a motion, `xᵀ K x`.
    pub(super) fn strain(&self, x: &[f64]) -> f64 {
        self.stiffness.iter().zip(x).map(|(k, x)| k * x * x).sum()
    }
}

/// `xᵀ A x` for a symmetric matrix `A`, given by its lower triangle.
pub(super) fn square(triangle: &[f64], x: &[f64]) -> f64 {
    let mut sum = 0.0;
    for (i, a) in x.iter().enumerate() {
        let entries = &triangle[row(i)..row(i + 1)];
        let left: f64 = entries[..i].iter().zip(x).map(|(m, b)| m * b).sum();
        sum += a * (2.0 * left + entries[i] * a);
    }
    sum
}

impl Factor {
    fn solve(&self, mut x: Vec<f64>) -> Vec<f64> {
        let lower = |i: usize, j: usize| self.lower[row(i) + j];
        for i in 0..self.size {
            let known: f64 = (0..i).map(|j| lower(i, j) * x[j]).sum();
            x[i] = (x[i] - known) / lower(i, i);
        }
        self.solve_upper(&mut x);
        x
    }

    /// Solves `Lᵀ x = b` for `x`, where `L` is this Cholesky factor. `x` is `b` at first and the solution at the end.
    fn solve_upper(&self, x: &mut [f64]) {
        let lower = |i: usize, j: usize| self.lower[row(i) + j];
        for i in (0..self.size).rev() {
            let known: f64 = (i + 1..self.size).map(|j| lower(j, i) * x[j]).sum();
            x[i] = (x[i] - known) / lower(i, i);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two masses on two springs in a row: λ of [2 -1; -1 1] in absolute coordinates.
    fn pencil() -> Pencil {
        Pencil::new(vec![1.0, 1.0], vec![2.0, 1.0, 1.0])
    }

    #[test]
    fn the_factor_exists_exactly_below_the_lowest_eigenvalue() {
        let lowest = (3.0 - 5.0f64.sqrt()) / 2.0;
        assert!(pencil().factor(lowest * (1.0 - 1e-12)).is_some());
        assert!(pencil().factor(lowest * (1.0 + 1e-12)).is_none());
    }

    #[test]
    fn a_slower_motion_is_found_exactly_if_there_is_one() {
        let lowest = (3.0 - 5.0f64.sqrt()) / 2.0;
        assert!(pencil().slower_motion(lowest * (1.0 - 1e-12)).is_none());
        for eigenvalue in [lowest * (1.0 + 1e-9), 0.5, 1.0, 7.0] {
            let motion = pencil().slower_motion(eigenvalue).expect("there is one");
            assert!((square(&[2.0, 1.0, 1.0], &motion) - 1.0).abs() < 1e-12);
            assert!(pencil().strain(&motion) <= eigenvalue);
        }
    }

    #[test]
    fn the_mode_has_the_lowest_quotient() {
        let factor = pencil().factor(0.3).expect("below the lowest");
        let mode = pencil().lowest_mode(&factor);
        let lowest = (3.0 - 5.0f64.sqrt()) / 2.0;
        assert!((pencil().strain(&mode) / lowest - 1.0).abs() < 1e-6);
        assert!((square(&[2.0, 1.0, 1.0], &mode) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_rigid_coordinate_stands_still() {
        let one = Pencil::new(vec![f64::INFINITY, 3.0], vec![5.0, 2.0, 1.0]);
        assert!(one.factor(3.0 * (1.0 - 1e-12)).is_some() && one.factor(3.0 * (1.0 + 1e-12)).is_none());
    }
}
