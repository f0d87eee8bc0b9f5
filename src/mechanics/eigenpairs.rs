//! The largest eigenvalues of a dense symmetric matrix, and their eigenvectors.
//!
//! Reflections (Householder) make the matrix tridiagonal, and rotations (the implicit QR method with Wilkinson's shift) make
//! the tridiagonal matrix diagonal: Golub and Van Loan, Matrix Computations, sections 8.3.1 and 8.3.5. The rotations are not
//! multiplied into a matrix of all eigenvectors, which would be most of the work. They are noted, and applied in reverse to the
//! unit vectors of the eigenvalues that are asked for. Equal eigenvalues get orthogonal eigenvectors, like any others.

use nalgebra::{DMatrix, DVector};

/// Relative to the largest entry of the matrix, a number outside the diagonal that is smaller than this is zero. The square of this
/// number does not underflow.
const NOTHING: f64 = 1e-150;

/// The largest eigenvalues of a symmetric matrix, largest first, each with its eigenvector of length 1.
pub(crate) struct Eigenpairs {
    pub(crate) values: Vec<f64>,
    pub(crate) vectors: Vec<DVector<f64>>,
}

/// The rotation by which a step of the QR method mixes the coordinates `at` and `at + 1`.
struct Rotation {
    at: usize,
    cos: f64,
    sin: f64,
}

impl Eigenpairs {
    /// The `count` largest eigenvalues of the symmetric matrix `a`, or all if there are fewer, with their eigenvectors. Only
    /// the entries of `a` from the diagonal down are read. Equal eigenvalues come in a fixed order.
    pub(crate) fn largest(mut a: DMatrix<f64>, count: usize) -> Self {
        let size = a.nrows();
        // with entries of at most 1, no square of a number that matters underflows
        let below = |j: usize| a.as_slice()[j * size + j..(j + 1) * size].iter();
        let scale = (0..size).flat_map(below).fold(0.0f64, |largest, entry| largest.max(entry.abs()));
        if scale > 0.0 {
            a /= scale;
        }
        let mut next = make_tridiagonal(&mut a);
        let mut diagonal: Vec<f64> = (0..size).map(|i| a[(i, i)]).collect();
        let rotations = make_diagonal(&mut diagonal, &mut next);
        let mut order: Vec<usize> = (0..size).collect();
        order.sort_by(|&i, &j| diagonal[j].total_cmp(&diagonal[i]).then(i.cmp(&j)));
        order.truncate(count);
        let vector = |&own: &usize| {
            let mut vector = DVector::zeros(size);
            vector[own] = 1.0;
            rotations.iter().rev().for_each(|rotation| rotation.turn(vector.as_mut_slice()));
            reflect_back(&a, vector.as_mut_slice());
            vector
        };
        Self {
            vectors: order.iter().map(vector).collect(),
            values: order.iter().map(|&i| diagonal[i] * scale).collect(),
        }
    }
}

impl Rotation {
    fn turn(&self, vector: &mut [f64]) {
        let (here, after) = (vector[self.at], vector[self.at + 1]);
        vector[self.at] = self.cos * here + self.sin * after;
        vector[self.at + 1] = self.cos * after - self.sin * here;
    }
}

/// Makes the symmetric matrix `a` tridiagonal by reflections. Its diagonal then has the diagonal of the tridiagonal matrix, and
/// the returned list has the numbers next to it. Below the diagonal, each column of `a` has its reflection `1 - u uᵀ`, as the
/// vector `u`; a vector of zeros stands for none.
fn make_tridiagonal(a: &mut DMatrix<f64>) -> Vec<f64> {
    let size = a.nrows();
    let mut next = Vec::with_capacity(size.saturating_sub(1));
    let mut image = vec![0.0; size];
    for k in 0..size.saturating_sub(1) {
        let (own, rest) = a.as_mut_slice()[k * size..].split_at_mut(size);
        let u = &mut own[k + 1..];
        next.push(make_reflection(u));
        if u.iter().all(|x| *x == 0.0) {
            continue;
        }
        // (1 - u uᵀ) A (1 - u uᵀ) = A - u wᵀ - w uᵀ with w = A u - u (uᵀA u) / 2
        let w = &mut image[k + 1..];
        multiply_symmetric(rest, size, u, w);
        let half = 0.5 * dot(u, w);
        w.iter_mut().zip(&*u).for_each(|(w, u)| *w -= half * u);
        for (j, column) in rest.chunks_exact_mut(size).enumerate() {
            let (u_j, w_j) = (u[j], w[j]);
            let entries = column[k + 1 + j..].iter_mut().zip(&u[j..]).zip(&w[j..]);
            entries.for_each(|((entry, u), w)| *entry -= u * w_j + w * u_j);
        }
    }
    next
}

/// Replaces `x` by the vector `u` of the reflection `1 - u uᵀ` that leaves only the first component of `x`, and returns this
/// component. Where there is nothing to remove, `u` is zero.
fn make_reflection(x: &mut [f64]) -> f64 {
    let first = x[0];
    let further = dot(&x[1..], &x[1..]);
    if further <= NOTHING * NOTHING {
        x.fill(0.0);
        return first;
    }
    let length = (first * first + further).sqrt();
    // the component keeps the sign that takes no difference of nearly equal numbers
    let left = if first > 0.0 { -length } else { length };
    x[0] -= left;
    // uᵀu = 2
    let to_unit = 1.0 / (length * (length + first.abs())).sqrt();
    x.iter_mut().for_each(|x| *x *= to_unit);
    left
}

/// Writes to `out` the product of a symmetric matrix with `x`. `columns` has its columns, `stride` numbers apart, of which the
/// last rows belong to the matrix; they are read from the diagonal down.
fn multiply_symmetric(columns: &[f64], stride: usize, x: &[f64], out: &mut [f64]) {
    let first = stride - x.len();
    out.fill(0.0);
    for (j, column) in columns.chunks_exact(stride).enumerate() {
        let below = &column[first + j + 1..];
        out[j] += column[first + j] * x[j] + dot(below, &x[j + 1..]);
        let x_j = x[j];
        out[j + 1..].iter_mut().zip(below).for_each(|(out, entry)| *out += entry * x_j);
    }
}

/// Applies the reflections of [`make_tridiagonal`] to a vector, the last one first.
fn reflect_back(a: &DMatrix<f64>, vector: &mut [f64]) {
    let size = vector.len();
    for k in (0..size.saturating_sub(1)).rev() {
        let u = &a.as_slice()[k * size + k + 1..(k + 1) * size];
        let part = dot(u, &vector[k + 1..]);
        vector[k + 1..].iter_mut().zip(u).for_each(|(x, u)| *x -= part * u);
    }
}

/// Makes a tridiagonal matrix diagonal: the numbers `next` to the diagonal become zero. Returns the rotations in their order.
fn make_diagonal(diagonal: &mut [f64], next: &mut [f64]) -> Vec<Rotation> {
    let mut rotations = Vec::new();
    let mut end = next.len();
    while end > 0 {
        // written so that a number that is none ends the method, too
        let counts = |k: &usize| {
            next[*k].abs() > f64::EPSILON * (diagonal[*k].abs() + diagonal[*k + 1].abs()) + NOTHING
        };
        if !counts(&(end - 1)) {
            next[end - 1] = 0.0;
            end -= 1;
            continue;
        }
        let start = (0..end).rev().find(|k| !counts(k)).map_or(0, |k| k + 1);
        if start > 0 {
            next[start - 1] = 0.0;
        }
        step(diagonal, next, start..end, &mut rotations);
    }
    rotations
}

/// A step of the implicit QR method on the rows and columns of `block` and the one after it.
fn step(
    diagonal: &mut [f64],
    next: &mut [f64],
    block: std::ops::Range<usize>,
    rotations: &mut Vec<Rotation>,
) {
    let mut along =
        diagonal[block.start] - shift(diagonal[block.end - 1], next[block.end - 1], diagonal[block.end]);
    let mut across = next[block.start];
    for at in block.clone() {
        let length = (along * along + across * across).sqrt();
        let (cos, sin) = if length > NOTHING { (along / length, -across / length) } else { (1.0, 0.0) };
        if at > block.start {
            next[at - 1] = length;
        }
        let (here, between, after) = (diagonal[at], next[at], diagonal[at + 1]);
        diagonal[at] = cos * cos * here - 2.0 * cos * sin * between + sin * sin * after;
        diagonal[at + 1] = sin * sin * here + 2.0 * cos * sin * between + cos * cos * after;
        next[at] = cos * sin * (here - after) + (cos * cos - sin * sin) * between;
        along = next[at];
        if at + 1 < block.end {
            across = -sin * next[at + 1];
            next[at + 1] *= cos;
        }
        rotations.push(Rotation { at, cos, sin });
    }
}

/// Wilkinson's shift: the eigenvalue of the matrix with the rows (`here`, `between`) and (`between`, `last`) that is nearer to
/// `last`.
fn shift(here: f64, between: f64, last: f64) -> f64 {
    let half = 0.5 * (here - last);
    let root = (half * half + between * between).sqrt();
    last - between * between / (half + if half < 0.0 { -root } else { root })
}

/// The scalar product of two lists of equal length. Eight sums run side by side, always in the same order.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    const SUMS: usize = 8;
    let mut sums = [0.0; SUMS];
    let (a, b) = (a.chunks_exact(SUMS), b.chunks_exact(SUMS));
    let rest: f64 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a.zip(b) {
        for k in 0..SUMS {
            sums[k] += a[k] * b[k];
        }
    }
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::SymmetricEigen;

    /// A symmetric matrix with the given eigenvalues, none of whose entries is zero.
    fn with_eigenvalues(values: &[f64]) -> DMatrix<f64> {
        let size = values.len();
        let mixed = DMatrix::from_fn(size, size, |i, j| {
            ((7 * i + 5 * j + i * j) % 13) as f64 / 6.0 - 1.0 + f64::from(i == j)
        });
        let q = mixed.qr().q();
        &q * DMatrix::from_diagonal(&DVector::from_column_slice(values)) * q.transpose()
    }

    fn check(a: &DMatrix<f64>, count: usize) -> Eigenpairs {
        let pairs = Eigenpairs::largest(a.clone(), count);
        let mut known: Vec<f64> = SymmetricEigen::new(a.clone()).eigenvalues.iter().copied().collect();
        known.sort_by(|a, b| b.total_cmp(a));
        let within = 1e-13 * a.amax().max(f64::MIN_POSITIVE);
        assert_eq!(pairs.values.len(), count.min(a.nrows()));
        assert_eq!(pairs.vectors.len(), pairs.values.len());
        for (value, known) in pairs.values.iter().zip(&known) {
            assert!((value - known).abs() <= within, "{value} {known}");
        }
        for (i, (value, vector)) in pairs.values.iter().zip(&pairs.vectors).enumerate() {
            assert!((a * vector - vector * *value).amax() <= 10.0 * within, "{value}");
            for (j, other) in pairs.vectors.iter().enumerate() {
                assert!((vector.dot(other) - f64::from(i == j)).abs() < 1e-13);
            }
        }
        pairs
    }

    #[test]
    fn a_few_pairs_are_those_of_the_whole_decomposition() {
        for size in [1, 2, 3, 8, 17, 40] {
            let values: Vec<f64> =
                (0..size).map(|i| libm::pow(0.6, i as f64) * if i % 5 == 4 { -1.0 } else { 1.0 }).collect();
            for count in [0, 1, 5, size, size + 3] {
                check(&with_eigenvalues(&values), count);
            }
        }
    }

    #[test]
    fn equal_eigenvalues_have_orthogonal_vectors() {
        let pairs = check(&with_eigenvalues(&[3.0, 3.0, 3.0, 2.0, 2.0, 1e-9, 1e-9, 0.0, 0.0]), 7);
        assert!((pairs.values[2] - 3.0).abs() < 1e-13 && (pairs.values[3] - 2.0).abs() < 1e-13);
        check(&DMatrix::identity(6, 6), 6);
        check(&DMatrix::zeros(4, 4), 2);
    }

    #[test]
    fn sizes_of_entries_do_not_matter() {
        let a = with_eigenvalues(&[5.0, 4.0, 1.0, 0.5]);
        let whole = check(&a, 2).values;
        for factor in [libm::ldexp(1.0, 700), libm::ldexp(1.0, -900)] {
            let scaled = Eigenpairs::largest(&a * factor, 2).values;
            assert!(scaled.iter().zip(&whole).all(|(s, w)| (s / factor - w).abs() < 1e-14 * w), "{scaled:?}");
        }
    }

    #[test]
    fn an_entry_whose_square_underflows_turns_nothing() {
        for tiny in [2e-162, 1e-170, 1e-320] {
            let a = DMatrix::from_row_slice(3, 3, &[1.0, 0.0, tiny, 0.0, 0.5, 0.3, tiny, 0.3, 0.4]);
            check(&a, 3);
        }
    }

    #[test]
    fn only_the_lower_triangle_is_read() {
        let a = with_eigenvalues(&[4.0, 3.0, 1.0, -2.0, 0.1]);
        let lower = Eigenpairs::largest(a.lower_triangle(), 3);
        let whole = Eigenpairs::largest(a, 3);
        assert_eq!((lower.values, lower.vectors), (whole.values, whole.vectors));
    }
}
