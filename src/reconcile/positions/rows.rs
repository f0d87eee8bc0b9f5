//! The model of positions, linearized: for each sample its weighted error and the derivatives of its position with
//! respect to every number, and the normal equations of all samples.
//!
//! The computing time grows in proportion to the number of samples. The memory is fixed: the rows of the equations are
//! computed in blocks, and only their products are kept.

use super::fitted::{Fitted, Sample};
use super::kinematics::{Number, Placer};
use super::normal::Normal;
use nalgebra::{DMatrix, DVector, Rotation3, Vector3};

/// Prior standard deviation of a compliance \[rad/(N m)\]. It is far larger than the compliance of any real part.
/// Without a prior, a compliance that no weight loads could take any value.
const PRIOR_RAD_PER_NM: f64 = 0.1;
/// Number of samples (measured positions) whose rows of the equations are computed together. The rows then stay in
/// the processor's cache until their products are taken.
const BLOCK: usize = 64;

/// Number of columns of the product matrix that are computed together.
const STRIPE: usize = 32;

/// A function that appends further columns to the equations: derivatives of a sample's position with respect to
/// whatever the caller tests \[m per unit\]. These columns belong to no number of the model.
pub(crate) type Further<'a> = &'a mut dyn FnMut(&Sample, &Placer, &mut Vec<Vector3<f64>>);

/// A model of positions, linearized about the values of its numbers.
pub(crate) struct Linearized<'a> {
    here: &'a Fitted,
    numbers: &'a [Number],
    placer: Placer<'a>,
    from_level: Rotation3<f64>,
    /// Derivatives of the position of the sample that was computed last, scaled by the root of its weight: first with
    /// respect to the numbers of the geometry, then to the compliances, then the columns that the caller adds.
    pub columns: Vec<Vector3<f64>>,
}

impl<'a> Linearized<'a> {
    pub(crate) fn new(here: &'a Fitted, numbers: &'a [Number]) -> Self {
        let placer = here.geometry.placer();
        let from_level = here.geometry.level_to_instrument();
        Self { here, numbers, placer, from_level, columns: Vec::new() }
    }

    /// Computes the columns of a sample (the derivatives of its position), and returns its error. Both are multiplied
    /// by the root of the sample's weight, so that their products contain the weight. `further` adds columns.
    pub(crate) fn at(&mut self, sample: &Sample, further: Further) -> Vector3<f64> {
        let here = self.here;
        let at_m = self.placer.place_m(sample.placing());
        let miss = sample
            .miss(&sample.error(at_m + self.from_level * here.displacement(sample) + here.drifted_m(sample)));
        self.columns.clear();
        self.placer.slopes(sample.placing(), self.numbers, &mut self.columns);
        for (column, number) in self.columns.iter_mut().zip(self.numbers) {
            match *number {
                Number::Gravity(c) => {
                    let pulled = here.leaning(sample, c);
                    *column = self.from_level * (pulled + sample.deflection.known_slopes_m[c]);
                }
                Number::Drift(c) => *column = Vector3::ith(c, sample.part),
                Number::Tolerance(k) | Number::Effect(k) => *column = self.from_level * sample.nominal_m[k],
                _ => {}
            }
        }
        for &effect in &here.effects {
            sample.deflection.per_compliance(effect, &here.geometry.gravity, |by| {
                self.columns.push(self.from_level * by);
            });
        }
        further(sample, &self.placer, &mut self.columns);
        // products of rows that are scaled by the root of the weight contain the weight
        let root = here.weight(&miss).sqrt();
        let scales = sample.precision * root;
        self.columns.iter_mut().for_each(|column| column.component_mul_assign(&scales));
        miss.scaled_m * root
    }
}

/// Builds the normal equations of all samples, linearized about the model `here`. `further` adds columns that belong
/// to no number of the model.
pub(crate) fn normal(samples: &[&Sample], numbers: &[Number], here: &Fitted, further: Further) -> Normal {
    let own = numbers.len() + here.compliances.iter().map(Vec::len).sum::<usize>();
    let mut linearized = Linearized::new(here, numbers);
    let mut products: Option<Products> = None;
    // arm by arm, because the numbers of one arm move no point of another
    let mut samples: Vec<&Sample> = samples.to_vec();
    samples.sort_by_key(|sample| sample.arm);
    for block in samples.chunks(BLOCK) {
        for (k, sample) in block.iter().enumerate() {
            let error = linearized.at(sample, further);
            let columns = &linearized.columns;
            products.get_or_insert_with(|| Products::new(columns.len())).put(k, columns, &error);
        }
        products.iter_mut().for_each(|p| p.add(block.len()));
    }
    let (mut curvature, mut gradient) = products.unwrap_or_else(|| Products::new(own)).into_whole();
    let priors = numbers.iter().map(Number::prior).zip(&here.moved);
    // a weak prior keeps the equations regular for a compliance that no weight loads
    let compliances = here.compliances.iter().flatten().map(|c| (PRIOR_RAD_PER_NM, c));
    for (i, (prior, moved)) in priors.chain(compliances).enumerate() {
        let precision = prior.powi(-2);
        curvature[(i, i)] += precision;
        gradient[i] -= precision * moved;
    }
    Normal { curvature, gradient, own }
}

/// Sums of the products of the equations' rows, to which one block of rows is added after another.
struct Products {
    /// Rows of the equations of one block of samples. Each row of the equations is a column of this matrix.
    rows: DMatrix<f64>,
    right: DVector<f64>,
    curvature: DMatrix<f64>,
    gradient: DVector<f64>,
}

impl Products {
    fn new(width: usize) -> Self {
        Self {
            rows: DMatrix::zeros(width, 3 * BLOCK),
            right: DVector::zeros(3 * BLOCK),
            curvature: DMatrix::zeros(width, width),
            gradient: DVector::zeros(width),
        }
    }

    /// Stores the three rows of a sample (x, y, z) in the present block, as the block's sample number `k`.
    fn put(&mut self, k: usize, columns: &[Vector3<f64>], error: &Vector3<f64>) {
        for c in 0..3 {
            let mut row = self.rows.column_mut(3 * k + c);
            row.iter_mut().zip(columns).for_each(|(to, column)| *to = column[c]);
        }
        self.right.fixed_rows_mut::<3>(3 * k).copy_from(error);
    }

    /// Adds the products of the present block, which has `samples` samples, to the sums. Columns that are zero in the
    /// whole block are left out.
    fn add(&mut self, samples: usize) {
        let rows = self.rows.columns(0, 3 * samples);
        let own: Vec<usize> = (0..rows.nrows()).filter(|i| rows.row(*i).iter().any(|x| *x != 0.0)).collect();
        let mut transposed = DMatrix::zeros(own.len(), 3 * samples);
        for (mut to, from) in transposed.column_iter_mut().zip(rows.column_iter()) {
            to.iter_mut().zip(&own).for_each(|(to, i)| *to = from[*i]);
        }
        // products with an explicit transpose are faster
        let columns = transposed.transpose();
        let gradient = &transposed * self.right.rows(0, 3 * samples);
        own.iter().zip(gradient.iter()).for_each(|(i, x)| self.gradient[*i] += x);
        // the product is symmetric: in each stripe only the entries from the diagonal on are needed
        for first in (0..own.len()).step_by(STRIPE) {
            let count = STRIPE.min(own.len() - first);
            let product = transposed.rows_range(first..) * columns.columns(first, count);
            for (j, column) in product.column_iter().enumerate() {
                for (i, x) in column.iter().enumerate().skip(j) {
                    self.curvature[(own[first + i], own[first + j])] += x;
                }
            }
        }
    }

    /// The sums over all blocks: curvature and negative gradient.
    fn into_whole(mut self) -> (DMatrix<f64>, DVector<f64>) {
        self.curvature.fill_upper_triangle_with_lower_triangle();
        (self.curvature, self.gradient)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::{Rng, SeedableRng};

    #[test]
    fn sums_of_blocks_are_the_products_of_all_rows_at_once() {
        let mut dice = Xoshiro256PlusPlus::seed_from_u64(3);
        let mut next = || (dice.next_u64() >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
        // more than a stripe of columns; the last block is short, and some columns are zero in some blocks
        let (samples, width) = (2 * BLOCK + 7, STRIPE + 9);
        let is_on = |i: usize, j: usize| j % 3 != i / BLOCK;
        let rows = DMatrix::from_fn(3 * samples, width, |r, j| if is_on(r / 3, j) { next() } else { 0.0 });
        let errors = DVector::from_fn(3 * samples, |_, _| next());
        let mut products = Products::new(width);
        for first in (0..samples).step_by(BLOCK) {
            let count = BLOCK.min(samples - first);
            for k in 0..count {
                let three = 3 * (first + k);
                let columns: Vec<Vector3<f64>> =
                    (0..width).map(|j| rows.fixed_view::<3, 1>(three, j).into_owned()).collect();
                products.put(k, &columns, &errors.fixed_rows::<3>(three).into_owned());
            }
            products.add(count);
        }
        let (curvature, gradient) = products.into_whole();
        assert!((curvature - rows.tr_mul(&rows)).amax() < 1e-12);
        assert!((gradient - rows.tr_mul(&errors)).amax() < 1e-12);
    }
}
