//! The normal equations of a step of a fit: gradient and curvature of half the objective, from the derivatives of the
//! readings.
//!
//! A search tries hundreds of models that differ in one or two parameters only. Their other derivatives, which are most of
//! the work, are the same, and so are most of the weights: robust weights differ only in the rows with large residuals. So
//! the curvature of the shared parameters is computed once, and corrected in these rows.

use super::weights::{Weights, robust_factor};
use crate::mechanics::product::{Panels, add_lower_square, transposed_product};
use crate::reconcile::forward::prepared::Forward;
use nalgebra::{DMatrix, DVector};

/// Number of rows (data) whose products are computed together. These rows then stay in the processor's cache.
const ROWS_PER_BLOCK: usize = 256;
/// A curvature is corrected row by row if at most one row in this many has another weight. Otherwise it is computed anew.
const ROWS_PER_CORRECTED: usize = 4;

/// Gradient and curvature of half the objective (the normal equations of a step).
pub struct Normal {
    /// Gradient of half the objective, one entry per parameter.
    pub gradient: DVector<f64>,
    /// Curvature matrix of half the objective (Gauss-Newton).
    pub curvature: DMatrix<f64>,
}

/// Builds the normal equations at the parameters `u`, of which the first `calibrated` have a prior. `slopes` contains
/// the derivatives of the predicted readings (rows) with respect to the parameters (columns). Residuals are predicted minus
/// measured, times the weight of the datum. Large residuals get less weight, as Huber's loss requires.
pub fn normal(
    forward: &Forward,
    calibrated: usize,
    u: &[f64],
    predicted: &[f64],
    slopes: &DMatrix<f64>,
    weights: &Weights,
) -> Normal {
    let (factors, right) = weighted(forward, predicted, weights);
    let gradient = slopes.tr_mul(&right.component_mul(&factors));
    Normal { gradient, curvature: weighted_square(slopes, &factors) }.with_priors(calibrated, u)
}

/// The product `XᵀX`. The rows of `X` are those of `slopes`, each times its entry of `factors`.
fn weighted_square(slopes: &DMatrix<f64>, factors: &DVector<f64>) -> DMatrix<f64> {
    let (rows, columns) = slopes.shape();
    let mut out = DMatrix::zeros(columns, columns);
    let mut scaled = DMatrix::zeros(ROWS_PER_BLOCK.min(rows), columns);
    for first in (0..rows).step_by(ROWS_PER_BLOCK) {
        let count = ROWS_PER_BLOCK.min(rows - first);
        let factors = factors.rows(first, count);
        for (mut to, column) in scaled.column_iter_mut().zip(slopes.column_iter()) {
            to.rows_mut(0, count).cmpy(1.0, &column.rows(first, count), &factors, 0.0);
        }
        add_lower_square(&mut out, scaled.rows(0, count));
    }
    out.fill_upper_triangle_with_lower_triangle();
    out
}

/// For each datum, the factor on its row of the derivatives (its weight and the robust factor), and the residual times the
/// robust factor.
fn weighted(forward: &Forward, predicted: &[f64], weights: &Weights) -> (DVector<f64>, DVector<f64>) {
    let count = forward.data.len();
    let (mut factors, mut right) = (DVector::zeros(count), DVector::zeros(count));
    for (i, ((datum, predicted), weight)) in
        forward.data.iter().zip(predicted).zip(&weights.inverse).enumerate()
    {
        let residual = (predicted - datum.value) * weight;
        let robust = robust_factor(residual);
        (factors[i], right[i]) = (robust * weight, residual * robust);
    }
    (factors, right)
}

impl Normal {
    /// Adds the priors of the first `calibrated` parameters, which have the values `u`.
    fn with_priors(mut self, calibrated: usize, u: &[f64]) -> Self {
        for (p, u) in u[..calibrated].iter().enumerate() {
            self.gradient[p] += u;
            self.curvature[(p, p)] += 1.0;
        }
        self
    }
}

/// The derivatives with respect to parameters that many models share, with their curvature at one point.
pub(crate) struct Shared {
    slopes: DMatrix<f64>,
    panels: Panels,
    /// Factors on the rows at this point.
    factors: DVector<f64>,
    /// `XᵀX` of the derivatives with these factors.
    curvature: DMatrix<f64>,
}

impl Shared {
    /// Prepares the derivatives `slopes` for models whose readings are near `predicted`.
    pub(crate) fn new(forward: &Forward, predicted: &[f64], slopes: DMatrix<f64>, weights: &Weights) -> Self {
        let (factors, _) = weighted(forward, predicted, weights);
        let curvature = weighted_square(&slopes, &factors);
        Self { panels: Panels::of_columns(slopes.as_view()), slopes, factors, curvature }
    }

    /// `XᵀX` of the shared derivatives with other factors on the rows.
    fn curvature_with(&self, factors: &DVector<f64>) -> DMatrix<f64> {
        let count = factors.len();
        let changed: Vec<usize> = (0..count).filter(|i| factors[*i] != self.factors[*i]).collect();
        if changed.len() * ROWS_PER_CORRECTED > count {
            return weighted_square(&self.slopes, factors);
        }
        let rows = self.slopes.select_rows(&changed);
        let of_rows = |factors: &DVector<f64>| weighted_square(&rows, &factors.select_rows(&changed));
        &self.curvature + of_rows(factors) - of_rows(&self.factors)
    }
}

/// The derivatives of one model: those that it shares with others, and those with respect to its own parameters.
pub(crate) struct Extended<'a> {
    /// The derivatives with respect to the first parameters.
    pub(crate) shared: &'a Shared,
    /// The derivatives with respect to the parameters that follow: a row for each datum, a column for each parameter.
    pub(crate) own: DMatrix<f64>,
}

impl Extended<'_> {
    /// Linearized changes of the predicted readings, one per datum, if the parameters change by `step`.
    pub(crate) fn times(&self, step: &DVector<f64>) -> Vec<f64> {
        let (rows, count) = self.shared.slopes.shape();
        let (of_shared, of_own) = (step.rows(0, count), step.rows(count, self.own.ncols()));
        let mut out = DVector::zeros(rows);
        for first in (0..rows).step_by(ROWS_PER_BLOCK) {
            let block = ROWS_PER_BLOCK.min(rows - first);
            let mut out = out.rows_mut(first, block);
            out.gemv(1.0, &self.shared.slopes.rows(first, block), &of_shared, 0.0);
            out.gemv(1.0, &self.own.rows(first, block), &of_own, 1.0);
        }
        out.data.into()
    }

    /// Builds the normal equations, as [`normal`] does.
    pub(crate) fn normal(
        &self,
        forward: &Forward,
        calibrated: usize,
        u: &[f64],
        predicted: &[f64],
        weights: &Weights,
    ) -> Normal {
        let (factors, right) = weighted(forward, predicted, weights);
        let (gradient, curvature) = self.products(&factors, &right);
        Normal { gradient, curvature }.with_priors(calibrated, u)
    }

    /// The products `Xᵀr` and `XᵀX`. The rows of `X` are those of the derivatives, each times its entry of `factors`; `r` is
    /// `right`.
    fn products(&self, factors: &DVector<f64>, right: &DVector<f64>) -> (DVector<f64>, DMatrix<f64>) {
        let (count, own) = (self.shared.slopes.ncols(), self.own.ncols());
        // the own columns and the residuals, so that each product with the shared columns is taken once
        let mut others = self.own.clone().insert_column(own, 0.0);
        others.column_iter_mut().take(own).for_each(|mut column| column.component_mul_assign(factors));
        others.set_column(own, right);
        let with_own = transposed_product(&others, &others);
        others.column_iter_mut().for_each(|mut column| column.component_mul_assign(factors));
        let with_shared = self.shared.panels.times(others.as_view());
        let mut curvature = DMatrix::zeros(count + own, count + own);
        curvature.view_mut((0, 0), (count, count)).copy_from(&self.shared.curvature_with(factors));
        curvature.view_mut((0, count), (count, own)).copy_from(&with_shared.columns(0, own));
        curvature.view_mut((count, 0), (own, count)).tr_copy_from(&with_shared.columns(0, own));
        curvature.view_mut((count, count), (own, own)).copy_from(&with_own.view((0, 0), (own, own)));
        let mut gradient = DVector::zeros(count + own);
        gradient.rows_mut(0, count).copy_from(&with_shared.column(own));
        gradient.rows_mut(count, own).copy_from(&with_own.view((0, own), (own, 1)));
        (gradient, curvature)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // whole numbers, so that the order of the sums does not matter
    fn numbers(rows: usize, columns: usize, seed: usize) -> DMatrix<f64> {
        DMatrix::from_fn(rows, columns, |i, j| ((7 * i + 3 * j + seed) % 11) as f64 - 5.0)
    }

    fn factors(rows: usize) -> DVector<f64> {
        DVector::from_fn(rows, |i, _| (i % 4) as f64)
    }

    /// The derivatives `slopes`, prepared for rows with the factors of [`factors`].
    fn shared(slopes: &DMatrix<f64>) -> Shared {
        let factors = factors(slopes.nrows());
        let panels = Panels::of_columns(slopes.as_view());
        Shared { slopes: slopes.clone(), panels, curvature: square(slopes, &factors), factors }
    }

    fn square(slopes: &DMatrix<f64>, factors: &DVector<f64>) -> DMatrix<f64> {
        let scaled = DMatrix::from_fn(slopes.nrows(), slopes.ncols(), |i, j| factors[i] * slopes[(i, j)]);
        scaled.tr_mul(&scaled)
    }

    #[test]
    fn a_curvature_that_is_corrected_in_some_rows_is_that_of_all_rows() {
        let rows = 2 * ROWS_PER_BLOCK + 11;
        let slopes = numbers(rows, 11, 0);
        assert_eq!(weighted_square(&slopes, &factors(rows)), square(&slopes, &factors(rows)));
        let shared = shared(&slopes);
        assert_eq!(shared.curvature_with(&factors(rows)), shared.curvature);
        // with every row changed, the curvature is computed anew
        for step in [1, 5, 50, rows] {
            let other =
                DVector::from_fn(rows, |i, _| if i % step == 3 % step { 7.0 } else { (i % 4) as f64 });
            assert_eq!(shared.curvature_with(&other), square(&slopes, &other), "one row in {step}");
        }
    }

    #[test]
    fn derivatives_in_two_parts_are_one_matrix() {
        for (rows, count, own) in [(2 * ROWS_PER_BLOCK + 11, 9, 2), (20, 3, 0), (20, 0, 2), (0, 3, 1)] {
            let whole = numbers(rows, count + own, 0);
            let shared = shared(&whole.columns(0, count).into_owned());
            let parts = Extended { shared: &shared, own: whole.columns(count, own).into_owned() };
            let step = DVector::from_fn(count + own, |j, _| j as f64 - 1.0);
            assert_eq!(parts.times(&step), (&whole * &step).as_slice());
            let other = DVector::from_fn(rows, |i, _| ((i + i / 9) % 4) as f64);
            let right = DVector::from_fn(rows, |i, _| (i % 5) as f64 - 2.0);
            let (gradient, curvature) = parts.products(&other, &right);
            assert_eq!(gradient, whole.tr_mul(&right.component_mul(&other)), "{rows} rows, {own} own");
            assert_eq!(curvature, square(&whole, &other), "{rows} rows, {own} own");
        }
    }
}
