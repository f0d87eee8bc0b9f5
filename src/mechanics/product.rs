//! Products of dense matrices. Every sum is taken in the order of its terms, so that results are equal on every
//! machine.
//!
//! A library that chooses its kernel by the processor would give different last digits on another machine. A plain
//! loop over columns would read and write every sum once for each term. Here a block of eight rows by four columns
//! stays in registers.

use super::lanes::{Eight, LANES, LaneWork, Lanes, in_lanes};
use nalgebra::{DMatrix, DMatrixView};

/// Number of columns of the right factor that are processed together.
const COLUMNS: usize = 4;

/// The product `AᵀB`.
///
/// # Panics
/// If the factors differ in their number of rows.
pub(crate) fn transposed_product(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let mut out = DMatrix::zeros(a.ncols(), b.ncols());
    add_transposed_product(&mut out, a.as_view(), b.as_view());
    out
}

/// The product `AᵀB` where it is symmetric, as it is if B is a symmetric matrix times A. Only half of it is computed.
///
/// # Panics
/// If the factors differ in size.
pub(crate) fn symmetric_product(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    assert_eq!(a.nrows(), b.nrows(), "as many terms on either side");
    let columns: Vec<_> = b.column_iter().collect();
    let columns: Vec<&[f64]> = columns.iter().map(|column| column.as_slice()).collect();
    let mut out = Panels::of_columns(a.as_view()).lower_square(&columns);
    out.fill_upper_triangle_with_lower_triangle();
    out
}

/// Adds `AᵀB` to the matrix `out`. Tall matrices A and B may be divided into blocks of rows that are added one after
/// the other; the sums are then the same to the last bit.
///
/// # Panics
/// If the sizes of the matrices do not fit.
pub(crate) fn add_transposed_product(out: &mut DMatrix<f64>, a: DMatrixView<f64>, b: DMatrixView<f64>) {
    Panels::of_columns(a).add_times(out, b);
}

/// Adds `AᵀA` to the symmetric matrix `out`: its entries from the diagonal down. Above the diagonal `out` is then incomplete:
/// something is added to some of its entries and nothing to the others. Like in [`add_transposed_product`], A may be divided
/// into blocks of rows.
///
/// # Panics
/// If `out` does not have a row and a column for each column of A.
pub(crate) fn add_lower_square(out: &mut DMatrix<f64>, a: DMatrixView<f64>) {
    let columns: Vec<_> = a.column_iter().collect();
    let columns: Vec<&[f64]> = columns.iter().map(|column| column.as_slice()).collect();
    Panels::of_slices(&columns, a.nrows()).add_lower_square(out, &columns);
}

/// The left factor of a product, stored in panels of eight rows. The last panel is filled up with rows of zeros.
pub(crate) struct Panels {
    /// For each panel, and in it for each column of the left factor (each term of the sums), the eight entries of the
    /// panel's rows.
    eights: Vec<Eight>,
    rows: usize,
    terms: usize,
}

impl Panels {
    /// Stores the matrix A so that it can be the left factor of a product A B.
    pub(crate) fn of_rows(a: &DMatrix<f64>) -> Self {
        let (rows, terms) = a.shape();
        let mut eights = vec![[0.0; LANES]; rows.div_ceil(LANES) * terms];
        for (term, column) in a.column_iter().enumerate() {
            for (panel, part) in column.as_slice().chunks(LANES).enumerate() {
                eights[panel * terms + term][..part.len()].copy_from_slice(part);
            }
        }
        Self { eights, rows, terms }
    }

    /// The product of this left factor with a right factor.
    ///
    /// # Panics
    /// If the right factor does not have as many rows as this left factor has columns.
    pub(crate) fn times(&self, b: DMatrixView<f64>) -> DMatrix<f64> {
        let mut out = DMatrix::zeros(self.rows, b.ncols());
        self.add_times(&mut out, b);
        out
    }

    /// Adds the product with a right factor to a matrix `out`, which may have more rows than the product.
    ///
    /// # Panics
    /// If the sizes of the matrices do not fit.
    pub(crate) fn add_times(&self, out: &mut DMatrix<f64>, b: DMatrixView<f64>) {
        assert_eq!(self.terms, b.nrows(), "as many terms on either side");
        assert!(self.rows <= out.nrows() && out.ncols() == b.ncols(), "a place for every sum");
        if self.terms > 0 && !out.is_empty() {
            let columns: Vec<_> = b.column_iter().collect();
            let columns: Vec<&[f64]> = columns.iter().map(|column| column.as_slice()).collect();
            let stride = out.nrows();
            in_lanes(Sums { out: out.as_mut_slice(), stride, a: self, columns: &columns, is_lower: false });
        }
    }

    /// The lower triangle of the product of this left factor with the matrix of these `columns`, such as its own transpose.
    /// Above the diagonal the result is incomplete: some entries of the product are there, the others are zero.
    ///
    /// # Panics
    /// If `columns` are not as many and as long as the left factor's rows.
    pub(crate) fn lower_square(&self, columns: &[&[f64]]) -> DMatrix<f64> {
        let mut out = DMatrix::zeros(self.rows, self.rows);
        self.add_lower_square(&mut out, columns);
        out
    }

    fn add_lower_square(&self, out: &mut DMatrix<f64>, columns: &[&[f64]]) {
        assert_eq!(self.rows, columns.len(), "a column for each row");
        assert_eq!(out.shape(), (self.rows, self.rows), "a place for every sum");
        if self.terms > 0 && !out.is_empty() {
            in_lanes(Sums { out: out.as_mut_slice(), stride: self.rows, a: self, columns, is_lower: true });
        }
    }

    /// Stores the matrix A so that its transpose can be the left factor of a product AᵀB.
    pub(crate) fn of_columns(a: DMatrixView<f64>) -> Self {
        let columns: Vec<_> = a.column_iter().collect();
        let columns: Vec<&[f64]> = columns.iter().map(|column| column.as_slice()).collect();
        Self::of_slices(&columns, a.nrows())
    }

    /// Stores a matrix A, given by its columns with `terms` entries each, so that its transpose can be the left factor
    /// of a product AᵀB.
    pub(crate) fn of_slices(columns: &[&[f64]], terms: usize) -> Self {
        let rows = columns.len();
        let mut eights = vec![[0.0; LANES]; rows.div_ceil(LANES) * terms];
        for (row, column) in columns.iter().enumerate() {
            let panel = &mut eights[row / LANES * terms..][..terms];
            panel.iter_mut().zip(*column).for_each(|(eight, x)| eight[row % LANES] = *x);
        }
        Self { eights, rows, terms }
    }
}

/// Adds the sums of products of `a` and `columns` to a matrix.
struct Sums<'a> {
    /// Entries of the matrix to which the sums are added, column by column.
    out: &'a mut [f64],
    /// Number of rows of the matrix to which the sums are added.
    stride: usize,
    /// The left factor.
    a: &'a Panels,
    /// The columns of the right factor.
    columns: &'a [&'a [f64]],
    /// Whether only the sums from the diagonal down are asked for.
    is_lower: bool,
}

impl LaneWork for Sums<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes>(self) {
        let stride = self.stride;
        for (panel, terms) in self.a.eights.chunks_exact(self.a.terms).enumerate() {
            let first = panel * LANES;
            let count = LANES.min(self.a.rows - first);
            let end = if self.is_lower { first + count } else { self.columns.len() };
            let mut j = 0;
            while j + COLUMNS <= end {
                let to = &mut self.out[j * stride + first..];
                add_block::<V, COLUMNS>(to, stride, count, terms, &self.columns[j..j + COLUMNS]);
                j += COLUMNS;
            }
            while j < end {
                let to = &mut self.out[j * stride + first..];
                add_block::<V, 1>(to, stride, count, terms, &self.columns[j..j + 1]);
                j += 1;
            }
        }
    }
}

/// Adds the products of up to eight rows of the left factor with `K` columns of the right factor to `to`. In `to`,
/// successive columns start `stride` numbers apart.
#[inline(always)]
fn add_block<V: Lanes, const K: usize>(
    to: &mut [f64],
    stride: usize,
    count: usize,
    terms: &[Eight],
    columns: &[&[f64]],
) {
    let mut sums = [V::zero(); K];
    for k in 0..K {
        let mut own = [0.0; LANES];
        own[..count].copy_from_slice(&to[k * stride..][..count]);
        sums[k] = V::load(&own);
    }
    let mut factors: [&[f64]; K] = [&[]; K];
    for k in 0..K {
        factors[k] = &columns[k][..terms.len()];
    }
    for (term, eight) in terms.iter().enumerate() {
        let x = V::load(eight);
        for k in 0..K {
            sums[k] = sums[k] + x * V::splat(factors[k][term]);
        }
    }
    for k in 0..K {
        to[k * stride..][..count].copy_from_slice(&sums[k].store()[..count]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(rows: usize, columns: usize, seed: usize) -> DMatrix<f64> {
        DMatrix::from_fn(rows, columns, |i, j| ((7 * i + 3 * j + seed) % 11) as f64 / 7.0 - 0.6)
    }

    #[test]
    fn products_are_sums_of_products_for_every_size() {
        for (rows, terms, columns) in
            [(1, 1, 1), (8, 3, 4), (9, 5, 7), (23, 40, 16), (5, 0, 3), (0, 4, 2), (17, 2, 0)]
        {
            let (a, b) = (numbers(rows, terms, 1), numbers(terms, columns, 5));
            let direct = DMatrix::from_fn(rows, columns, |i, j| {
                (0..terms).fold(0.0, |sum, k| sum + a[(i, k)] * b[(k, j)])
            });
            // equal to the last bit, because the terms are added in the same order as in the plain sum
            assert_eq!(Panels::of_rows(&a).times(b.as_view()), direct);
            assert_eq!(transposed_product(&a.transpose(), &b), direct);
            let mut longer = DMatrix::from_element(rows + 3, columns, 2.0);
            Panels::of_rows(&a).add_times(&mut longer, b.as_view());
            assert_eq!(longer.rows(rows, 3), DMatrix::from_element(3, columns, 2.0));
            let within = longer.rows(0, rows) - direct;
            assert!(within.iter().all(|x| (x - 2.0).abs() < 1e-14), "{within}");
        }
    }

    #[test]
    fn the_lower_triangle_of_a_square_is_that_of_the_whole_product() {
        for (terms, count) in [(1, 1), (5, 8), (40, 23), (192, 70)] {
            let a = numbers(terms, count, 4);
            let columns: Vec<&[f64]> = a.as_slice().chunks(terms).collect();
            let own = Panels::of_slices(&columns, terms).lower_square(&columns);
            assert_eq!(own.lower_triangle(), transposed_product(&a, &a).lower_triangle());
        }
    }

    #[test]
    fn squares_of_blocks_of_rows_add_up_to_the_square_of_the_whole() {
        let a = numbers(50, 11, 2);
        let mut parts = DMatrix::zeros(11, 11);
        for (first, count) in [(0, 13), (13, 37)] {
            add_lower_square(&mut parts, a.rows(first, count));
        }
        assert_eq!(parts.lower_triangle(), transposed_product(&a, &a).lower_triangle());
    }

    #[test]
    fn parts_that_are_added_up_give_the_whole() {
        let (a, b) = (numbers(50, 9, 2), numbers(50, 6, 3));
        let mut parts = DMatrix::zeros(9, 6);
        for (first, count) in [(0, 13), (13, 37)] {
            add_transposed_product(&mut parts, a.rows(first, count), b.rows(first, count));
        }
        assert_eq!(parts, transposed_product(&a, &b));
    }
}
