//! Factorizes the mass matrix of a mass that a fit adds as `L Lᵀ`, where `L` has few columns. With the factor, the
//! matrix need not be assembled again when the amount of mass changes.

use crate::mechanics::product::Panels;
use nalgebra::DMatrix;

/// The factor `L` of the matrix `L Lᵀ`, which is the mass matrix of one unit of an added mass. It is stored in each
/// arrangement that matrix products need.
pub(super) struct Factor {
    pub(super) l: DMatrix<f64>,
    /// The matrix `L`, arranged in memory as a left factor of products.
    pub(super) down: Panels,
    /// The matrix `Lᵀ`, arranged in memory as a left factor of products.
    pub(super) across: Panels,
}

impl Factor {
    pub(super) fn of(matrix: &DMatrix<f64>) -> Self {
        let l = factor(matrix);
        Self { down: Panels::of_rows(&l), across: Panels::of_columns(l.as_view()), l }
    }
}

/// Number of leading coordinates of a symmetric matrix that matter: all rows and columns after them are zero.
fn leading(matrix: &DMatrix<f64>) -> usize {
    let floor = 1e-14 * matrix.amax();
    (0..matrix.nrows()).rev().find(|&i| matrix.row(i).amax() > floor).map_or(0, |i| i + 1)
}

/// Pivoted Cholesky factor of a positive semidefinite matrix. It has as many columns as the rank of the matrix, and
/// only as many leading rows as are not zero.
fn factor(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let mut rest = matrix.clone();
    // the matrix is semidefinite, so smaller pivots are rounding error
    let floor = 1e-13 * matrix.diagonal().max();
    let mut columns = Vec::new();
    while columns.len() < matrix.nrows() {
        let pivot = rest.diagonal().imax();
        let size = rest[(pivot, pivot)];
        if size <= floor || size <= 0.0 {
            break;
        }
        let column = rest.column(pivot) / size.sqrt();
        rest.ger(-1.0, &column, &column, 1.0);
        columns.push(column);
    }
    match columns.is_empty() {
        true => DMatrix::zeros(0, 0),
        false => DMatrix::from_columns(&columns).rows(0, leading(matrix)).into_owned(),
    }
}
