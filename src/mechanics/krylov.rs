//! The largest eigenvalue of a large symmetric matrix by Lanczos' method, from products of the matrix with vectors.
//!
//! Each step multiplies the matrix by one more vector, orthogonal to all before it. In these vectors the matrix is
//! tridiagonal, and the largest eigenvalue of this small matrix approaches the largest eigenvalue of the whole matrix
//! from below. Its error is at most the residual of its eigenvector, and about the square of the residual over the
//! distance to the next eigenvalue. The start vector has a part in every coordinate. A group of coordinates that does
//! not couple with the others is therefore not missed.

use nalgebra::DVector;

/// Largest residual of an accepted eigenvector, relative to the eigenvalue.
const RESIDUAL: f64 = 1e-12;
/// The golden ratio less 1. The fractional parts of its multiples are spread evenly between 0 and 1.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// The matrix in the vectors of Lanczos' method: symmetric and tridiagonal.
#[derive(Debug, Default)]
struct Tridiagonal {
    diagonal: Vec<f64>,
    /// The numbers next to the diagonal. There is one fewer than on the diagonal, and no number is zero.
    next: Vec<f64>,
}

/// Largest eigenvalue of a symmetric positive semidefinite matrix with `size` rows. `times` multiplies the matrix by a
/// vector. The value is 0 if there are no rows.
pub(crate) fn largest_eigenvalue(size: usize, times: impl Fn(&DVector<f64>) -> DVector<f64>) -> f64 {
    let mut within = Tridiagonal::default();
    let mut basis: Vec<DVector<f64>> = Vec::new();
    let mut vector = start(size);
    let mut value = 0.0;
    while basis.len() < size {
        let mut image = times(&vector);
        within.diagonal.push(image.dot(&vector));
        basis.push(vector);
        remove_parts(&mut image, &basis);
        let length = image.norm();
        value = within.largest();
        if length * within.last_part(value) <= RESIDUAL * value {
            break;
        }
        within.next.push(length);
        vector = image / length;
    }
    value
}

/// The unit vector with which the method starts. Its numbers have different sizes and signs, and none is near zero.
fn start(size: usize) -> DVector<f64> {
    let number = |i: usize| {
        let fraction = ((i + 1) as f64 * GOLDEN).fract();
        if fraction < 0.5 { fraction - 1.0 } else { fraction }
    };
    DVector::from_fn(size, |i, _| number(i)).normalize()
}

/// Makes `vector` orthogonal to all vectors of `basis`, in two passes. The second pass removes what rounding leaves in
/// the first.
fn remove_parts(vector: &mut DVector<f64>, basis: &[DVector<f64>]) {
    for other in basis.iter().chain(basis) {
        let part = other.dot(vector);
        vector.axpy(-part, other, 1.0);
    }
}

impl Tridiagonal {
    /// The largest eigenvalue, to the last digit, by bisection.
    fn largest(&self) -> f64 {
        let mut below = self.diagonal.iter().copied().fold(0.0, f64::max);
        // No eigenvalue exceeds the largest sum of the numbers in a row.
        let next = |i: usize| self.next.get(i).copied().unwrap_or(0.0);
        let row = |i: usize| self.diagonal[i] + next(i) + if i > 0 { next(i - 1) } else { 0.0 };
        let mut above = (0..self.diagonal.len()).map(row).fold(below, f64::max);
        loop {
            let middle = below + 0.5 * (above - below);
            if middle <= below || middle >= above {
                return above;
            }
            match self.is_above_all(middle) {
                true => above = middle,
                false => below = middle,
            }
        }
    }

    /// Whether `value` is above all eigenvalues: then every pivot of `value - matrix` is positive (Sturm).
    fn is_above_all(&self, value: f64) -> bool {
        let mut pivot = f64::INFINITY;
        let before = std::iter::once(0.0).chain(self.next.iter().copied());
        self.diagonal.iter().zip(before).all(|(diagonal, next)| {
            pivot = value - diagonal - next * next / pivot;
            pivot > 0.0
        })
    }

    /// Magnitude of the last component of the unit eigenvector for the eigenvalue `value`. The components are computed
    /// from the last to the first, because in this direction they grow and rounding errors do not.
    fn last_part(&self, value: f64) -> f64 {
        let (mut after, mut here, mut squares) = (0.0, 1.0, 1.0);
        for (i, next) in self.next.iter().enumerate().rev() {
            let coupling = self.next.get(i + 1).copied().unwrap_or(0.0);
            let before = ((value - self.diagonal[i + 1]) * here - coupling * after) / next;
            (after, here) = (here, before);
            squares += here * here;
        }
        1.0 / squares.sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;
    use std::cell::Cell;

    /// A symmetric matrix with these eigenvalues: reflections turn it out of its axes.
    fn with_eigenvalues(values: &[f64]) -> DMatrix<f64> {
        let n = values.len();
        let mut out = DMatrix::from_diagonal(&DVector::from_column_slice(values));
        for seed in 1..4 {
            let normal =
                DVector::from_fn(n, |i, _| (((7 * i + 3) * seed) % 11) as f64 / 11.0 - 0.47).normalize();
            let reflection = DMatrix::identity(n, n) - 2.0 * &normal * normal.transpose();
            out = &reflection * out * &reflection;
        }
        out
    }

    /// Largest eigenvalue of a matrix, and the number of products that it took.
    fn found(matrix: &DMatrix<f64>) -> (f64, usize) {
        let products = Cell::new(0);
        let value = largest_eigenvalue(matrix.nrows(), |vector| {
            products.set(products.get() + 1);
            matrix * vector
        });
        (value, products.get())
    }

    #[test]
    fn equal_and_nearly_equal_eigenvalues_give_the_largest() {
        for gap in [0.0, 1e-15, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2, 0.5] {
            let mut values: Vec<f64> = (0..40).map(|i| 0.5_f64.powi(i)).collect();
            values[1] = 1.0 - gap;
            let diagonal = DMatrix::from_diagonal(&DVector::from_column_slice(&values));
            for matrix in [diagonal, with_eigenvalues(&values)] {
                let (value, _) = found(&matrix);
                assert!((value - 1.0).abs() < 1e-12, "{gap:e}: {value}");
            }
        }
    }

    #[test]
    fn small_and_singular_matrices_end_the_method_early() {
        assert_eq!(found(&DMatrix::zeros(0, 0)), (0.0, 0));
        assert_eq!(found(&DMatrix::zeros(5, 5)), (0.0, 1));
        assert_eq!(found(&DMatrix::from_element(1, 1, 3.0)), (3.0, 1));
        for values in [&[2.0, 2.0, 2.0][..], &[0.0, 0.0, 2.0, 0.0], &[2.0, 1e-30, 0.0], &[2.0, -1e-17]] {
            let (value, products) = found(&with_eigenvalues(values));
            assert!(
                (value - 2.0).abs() < 1e-14 && products <= values.len(),
                "{values:?}: {value} {products}"
            );
        }
    }

    #[test]
    fn few_products_are_enough_for_many_coordinates() {
        // The frequencies are as for a beam: they grow with the squares of whole numbers, in two planes.
        let values: Vec<f64> = (0..240).map(|i| 1.0 / ((i / 2 + 1) as f64).powi(4)).collect();
        let (value, products) = found(&with_eigenvalues(&values));
        assert!((value - 1.0).abs() < 1e-13, "{value}");
        assert!(products < 30, "{products}");
    }
}
