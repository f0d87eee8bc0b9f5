//! Weighted normal equations and their factorization.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Weighted normal equations of a model of positions. There is one column for each number of the geometry, then one
/// for each compliance, then one for each column that the caller adds. The added columns belong to no parameter of
/// the model.
pub(crate) struct Normal {
    /// Curvature matrix of half of chi-squared, with the priors included.
    pub curvature: DMatrix<f64>,
    /// Negative gradient of half of chi-squared. The Gauss-Newton step is the inverse of the curvature times this
    /// vector.
    pub gradient: DVector<f64>,
    /// Number of columns that belong to the numbers and compliances of the model.
    pub own: usize,
}

/// The Cholesky factor of a curvature matrix that was scaled to a unit diagonal. Without scaling, the different units
/// of the numbers would make the matrix ill-conditioned.
pub(crate) struct Factor {
    cholesky: Cholesky<f64, Dyn>,
    diagonal: DVector<f64>,
}

impl Factor {
    /// Factorizes the part of the curvature matrix with the row and column indices `free`; `None` if it is singular.
    pub(crate) fn new(curvature: &DMatrix<f64>, free: &[usize]) -> Option<Self> {
        let sub = DMatrix::from_fn(free.len(), free.len(), |i, j| curvature[(free[i], free[j])]);
        let diagonal = sub.diagonal().map(|d| 1.0 / d.max(1e-300).sqrt());
        let scaled = DMatrix::from_fn(free.len(), free.len(), |i, j| {
            diagonal[i] * sub[(i, j)] * diagonal[j] + if i == j { 1e-12 } else { 0.0 }
        });
        Some(Self { cholesky: Cholesky::new(scaled)?, diagonal })
    }

    /// Solves the equations with the factorized curvature for the right-hand side `right`.
    pub(crate) fn solve(&self, right: &DVector<f64>) -> DVector<f64> {
        self.cholesky.solve(&right.component_mul(&self.diagonal)).component_mul(&self.diagonal)
    }

    /// Multiplies `columns` by the whitening factor `W`, for which `A⁻¹ = WᵀW` with the factorized curvature `A`.
    pub(crate) fn whiten(&self, columns: &mut DMatrix<f64>) {
        columns.column_iter_mut().for_each(|mut column| column.component_mul_assign(&self.diagonal));
        // a Cholesky factor has no zero on its diagonal
        self.cholesky.l_dirty().solve_lower_triangular_mut(columns);
    }
}
