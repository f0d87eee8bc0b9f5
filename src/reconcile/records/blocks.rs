//! Linear least squares with standard errors from blocks of time instead of single rows. Errors of neighbouring rows
//! are correlated, so rows are not independent readings.
//!
//! The rows of a record are cut into stretches of time, the blocks. Each block stores the sums of products of every two
//! columns. With them, a model with any of the columns can be fitted to any of the blocks without reading the rows
//! again. Two results come from fits with one block left out:
//!
//! - the error of the predicted rows of this block (error on held-out blocks);
//! - the delete-a-block jackknife (Tukey 1958; for autocorrelated errors Künsch 1989). Its intervals need no model of
//!   the autocorrelation.

use crate::reconcile::model::estimate::{Estimate, Z_95};
use nalgebra::{DMatrix, DVector};

/// This number is added to the diagonal of the normal equations, whose columns are scaled to unit length. A column that
/// is a combination of other columns then gets a coefficient near zero instead of a large one.
const LEAST: f64 = 1e-10;

/// Sums, over the rows of a record, of the products of every two columns: one matrix per block of time. A fit explains
/// one column (the target) by others.
pub(crate) struct Blocks {
    /// Sums of products of each block, divided by the scales of both columns.
    sums: Vec<DMatrix<f64>>,
    /// Sum of the matrices of all blocks.
    total: DMatrix<f64>,
    /// Number of rows of each block.
    rows: Vec<usize>,
    /// Root of the sum of squares of each column over all rows (scale), in the unit of the column; 1 for a column of
    /// zeros.
    scale: Vec<f64>,
}

/// A linear model (coefficients of columns) fitted to all blocks of time, and fitted again with each block left out.
#[derive(Debug, Clone)]
pub(crate) struct Fitted {
    /// Indices of the columns that the model contains, in the order of `values`.
    pub columns: Vec<usize>,
    /// Coefficient of each column, fitted to all blocks, in the unit of the target per unit of the column.
    pub values: Vec<f64>,
    /// Coefficients of the model fitted with one block of time left out: one list for each block, in the order of
    /// `columns`.
    without: Vec<Vec<f64>>,
    /// Sum of squared errors of each block, in squared units of the target. The block is predicted by the model that
    /// was fitted without it.
    pub held_out: Vec<f64>,
    /// Sum of squared errors of all rows, in squared units of the target, with the model that was fitted to all of
    /// them.
    pub squares: f64,
    /// Number of rows in all blocks.
    pub rows: usize,
}

impl Blocks {
    /// Sums the products of every two of `width` columns, block by block. `fill` writes the columns of the row with the
    /// given index, and returns whether the row is used. `block_of` gives the index of the block of a row.
    pub(crate) fn new(
        rows: usize,
        width: usize,
        block_of: impl Fn(usize) -> usize,
        fill: impl Fn(usize, &mut [f64]) -> bool,
    ) -> Self {
        let count = (0..rows).map(&block_of).max().map_or(0, |b| b + 1);
        let mut sums = vec![DMatrix::zeros(width, width); count];
        let mut numbers = vec![0usize; count];
        let mut row = vec![0.0; width];
        for i in 0..rows {
            row.fill(0.0);
            if !fill(i, &mut row) {
                continue;
            }
            let block = block_of(i);
            numbers[block] += 1;
            add(&mut sums[block], &row);
        }
        for sum in &mut sums {
            sum.fill_upper_triangle_with_lower_triangle();
        }
        let mut total = sums.iter().fold(DMatrix::zeros(width, width), |total, sum| total + sum);
        let size = |square: f64| if square > 0.0 { square.sqrt() } else { 1.0 };
        let scale: Vec<f64> = (0..width).map(|i| size(total[(i, i)])).collect();
        for matrix in sums.iter_mut().chain([&mut total]) {
            for i in 0..width {
                for j in 0..width {
                    matrix[(i, j)] /= scale[i] * scale[j];
                }
            }
        }
        Self { sums, total, rows: numbers, scale }
    }

    /// Fits the column `target` by the columns `columns`, once to all blocks and once with each block left out. `prior`
    /// gives the prior standard deviation of the coefficient of a column, as a multiple of the standard deviation of
    /// the error of an independent row. It is `None` for a coefficient without a prior. The result is `None` if the
    /// normal equations are singular.
    pub(crate) fn fit(
        &self,
        columns: &[usize],
        target: usize,
        prior: impl Fn(usize) -> Option<f64>,
    ) -> Option<Fitted> {
        let p = columns.len();
        let pick = |m: &DMatrix<f64>| DMatrix::from_fn(p, p, |i, j| m[(columns[i], columns[j])]);
        let side = |m: &DMatrix<f64>| DVector::from_fn(p, |i, _| m[(columns[i], target)]);
        let ridge = DVector::from_fn(p, |i, _| {
            LEAST + prior(columns[i]).map_or(0.0, |sd| (1.0 / (sd * self.scale[columns[i]])).powi(2))
        });
        let (normal, right) = (pick(&self.total), side(&self.total));
        let solve = |mut normal: DMatrix<f64>, right: &DVector<f64>| {
            normal.set_diagonal(&(normal.diagonal() + &ridge));
            normal.cholesky().map(|c| c.solve(right))
        };
        let squares = |m: &DMatrix<f64>, b: &DVector<f64>| {
            (m[(target, target)] - 2.0 * b.dot(&side(m)) + b.dot(&(pick(m) * b))).max(0.0)
                * self.scale[target].powi(2)
        };
        let best = solve(normal.clone(), &right)?;
        let mut without = Vec::with_capacity(self.sums.len());
        let mut held_out = Vec::with_capacity(self.sums.len());
        for block in &self.sums {
            let other = solve(&normal - pick(block), &(&right - side(block)))?;
            held_out.push(squares(block, &other));
            without.push(self.unscaled(columns, target, &other));
        }
        Some(Fitted {
            squares: squares(&self.total, &best),
            values: self.unscaled(columns, target, &best),
            columns: columns.to_vec(),
            without,
            held_out,
            rows: self.rows.iter().sum::<usize>().max(1),
        })
    }

    /// Coefficients in the units of the columns, from the coefficients `b` of the scaled columns.
    fn unscaled(&self, columns: &[usize], target: usize, b: &DVector<f64>) -> Vec<f64> {
        columns.iter().zip(b.iter()).map(|(c, b)| b * self.scale[target] / self.scale[*c]).collect()
    }

    /// Fraction of the variance of the column `column`, from 0 to 1, that the columns `others` do not explain. The
    /// variance is the sum of squares that remains after a fit by the columns `constants` (the offsets of the records).
    /// 0 if this sum is zero.
    pub(crate) fn own_share(&self, column: usize, constants: &[usize], others: &[usize]) -> f64 {
        let left = |of: &[usize]| self.fit(of, column, |_| None).map_or(0.0, |f| f.squares);
        let about_mean = left(constants);
        if about_mean > 0.0 { left(&[constants, others].concat()) / about_mean } else { 0.0 }
    }
}

/// Adds the products of every two columns of a row to `sum`, in its lower triangle only.
fn add(sum: &mut DMatrix<f64>, row: &[f64]) {
    for (j, right) in row.iter().enumerate().filter(|(_, x)| **x != 0.0) {
        let mut column = sum.column_mut(j);
        for (i, left) in row.iter().enumerate().skip(j) {
            column[i] += left * right;
        }
    }
}

impl Fitted {
    /// Position of the column with the index `column` among the coefficients of the model; `None` if the model lacks
    /// this column.
    fn place(&self, column: usize) -> Option<usize> {
        self.columns.iter().position(|c| *c == column)
    }

    /// Coefficient of the column `column`, in the unit of the target per unit of the column; 0 if the model lacks the
    /// column.
    pub(crate) fn value(&self, column: usize) -> f64 {
        self.place(column).map_or(0.0, |i| self.values[i])
    }

    /// Value of a function `of` of the coefficients with its 95 % interval. `of` gets a function that gives the
    /// coefficient of a column, 0 if the model lacks it. The interval comes from the jackknife: the scatter of the
    /// value when each block is left out in turn.
    pub(crate) fn estimate(&self, of: impl Fn(&dyn Fn(usize) -> f64) -> f64) -> Estimate {
        let with = |list: &[f64]| of(&|column| self.place(column).map_or(0.0, |i| list[i]));
        let value = with(&self.values);
        let others: Vec<f64> = self.without.iter().map(|w| with(w)).collect();
        let count = others.len() as f64;
        let mean = others.iter().sum::<f64>() / count;
        let variance = (count - 1.0) / count * others.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
        let half = student_quantile(count - 1.0) * variance.sqrt();
        Estimate { value, low: Some(value - half), high: Some(value + half) }
    }

    /// Coefficient of the column `column` with its 95 % interval, in the unit of the target per unit of the column.
    pub(crate) fn coefficient(&self, column: usize) -> Estimate {
        self.estimate(|c| c(column))
    }

    /// Root mean square error over all rows, in the unit of the target. Each row is predicted by the model that was
    /// fitted without the block of this row.
    pub(crate) fn held_out_rms(&self) -> f64 {
        (self.held_out.iter().sum::<f64>() / self.rows as f64).sqrt()
    }

    /// Whether this model predicts at least 90 % of the held-out blocks no worse than the model `other`, and has less
    /// than half of its root mean square error on held-out blocks. [`Fitted::better_than`] can be small in such a case,
    /// if one block has most of the error.
    pub(crate) fn halves(&self, other: &Fitted) -> bool {
        const NEARLY_ALL: f64 = 0.9;
        let better = other.held_out.iter().zip(&self.held_out).filter(|(a, b)| a >= b).count();
        self.held_out_rms() < 0.5 * other.held_out_rms()
            && better as f64 >= NEARLY_ALL * self.held_out.len() as f64
    }

    /// How clearly this model predicts held-out blocks better than the model `other`, in standard errors. The reduction
    /// of the sum of squared errors is averaged over the blocks, and this mean is divided by its standard error.
    /// Negative if this model predicts worse; 0 if all blocks have the same reduction.
    pub(crate) fn better_than(&self, other: &Fitted) -> f64 {
        let saved: Vec<f64> = other.held_out.iter().zip(&self.held_out).map(|(a, b)| a - b).collect();
        let count = saved.len() as f64;
        let mean = saved.iter().sum::<f64>() / count;
        let variance = saved.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
        if variance > 0.0 { mean / (variance / count).sqrt() } else { 0.0 }
    }
}

/// The 97.5 % quantile of Student's t distribution with `dof` degrees of freedom (Abramowitz and Stegun 26.7.5;
/// within 0.3 % from 4 degrees of freedom on).
pub(crate) fn student_quantile(dof: f64) -> f64 {
    const Z: f64 = Z_95;
    let terms = [
        (Z.powi(3) + Z) / 4.0,
        (5.0 * Z.powi(5) + 16.0 * Z.powi(3) + 3.0 * Z) / 96.0,
        (3.0 * Z.powi(7) + 19.0 * Z.powi(5) + 17.0 * Z.powi(3) - 15.0 * Z) / 384.0,
    ];
    Z + terms.iter().enumerate().map(|(i, term)| term / dof.powi(i as i32 + 1)).sum::<f64>()
}

/// Number of rows that together have as much information as one independent reading. It is more than 1 if the errors
/// are autocorrelated: `1 + 2 sum_k rho_k`, where `rho_k` is the autocorrelation of `errors` at a lag of `k` rows. The
/// sum ends before the first pair of neighbouring lags whose sum is not positive (Geyer 1992).
pub(crate) fn rows_per_reading(errors: &[f64]) -> f64 {
    const MOST_LAGS: usize = 4000;
    let n = errors.len();
    let mean = errors.iter().sum::<f64>() / n.max(1) as f64;
    let product =
        |lag: usize| -> f64 { errors.iter().zip(&errors[lag..]).map(|(a, b)| (a - mean) * (b - mean)).sum() };
    let variance = product(0);
    if variance <= 0.0 {
        return 1.0;
    }
    let mut sum = -1.0;
    for lag in (0..(n / 4).min(MOST_LAGS)).step_by(2) {
        let pair = (product(lag) + product(lag + 1)) / variance;
        if pair <= 0.0 {
            break;
        }
        sum += 2.0 * pair;
    }
    sum.max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_student_are_those_of_tables() {
        for (dof, expected) in [(5.0, 2.5706), (10.0, 2.2281), (30.0, 2.0423)] {
            assert!((student_quantile(dof) / expected - 1.0).abs() < 3e-3, "{dof}");
        }
    }

    #[test]
    fn a_line_is_found_and_a_block_left_out_is_predicted_by_the_others() {
        // y = 2 + 3 x, and the last of four blocks is off by 1
        let x = |i: usize| i as f64 / 40.0;
        let y = |i: usize| 2.0 + 3.0 * x(i) + if i >= 30 { 1.0 } else { 0.0 };
        let fill = |i: usize, row: &mut [f64]| {
            row.copy_from_slice(&[1.0, x(i), y(i)]);
            true
        };
        let blocks = Blocks::new(40, 3, |i| i / 10, fill);
        let fit = blocks.fit(&[0, 1], 2, |_| None).expect("a fit");
        assert!((fit.held_out[3] - 10.0).abs() < 1e-6, "{:?}", fit.held_out);
        let slope = fit.coefficient(1);
        assert!(slope.low.expect("an end") < 3.0 && slope.high.expect("an end") > 3.0);
    }

    #[test]
    fn errors_that_follow_each_other_count_less() {
        let mut state = 7u64;
        let mut error = 0.0;
        let errors: Vec<f64> = (0..40_000)
            .map(|_| {
                state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                error = 0.8 * error + (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
                error
            })
            .collect();
        // (1 + 0.8) / (1 - 0.8) = 9
        assert!((rows_per_reading(&errors) - 9.0).abs() < 1.0, "{}", rows_per_reading(&errors));
    }
}
