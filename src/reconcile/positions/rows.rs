//! Linearizes the model of positions: computes, for each sample, its weighted error and the derivatives of its position
//! with respect to every number, and sums these up to the normal equations.
//!
//! A fit asks for these equations in every step, without further columns. [`normal_of_fit`] computes them for eight
//! samples at a time.
//!
//! The computing time grows in proportion to the number of samples. The memory is small: the rows of the equations are
//! computed in blocks, and only their products are kept. Many samples are divided into portions of fixed size, which
//! threads share; the sums of the portions are added in their order.

use super::fitted::{Fitted, Miss, Sample, by_arm, eights};
use super::kinematics::{Number, Placer, Placing};
use super::kinematics_lanes::{EightPlacer, Slope};
use super::normal::Normal;
use crate::mechanics::lanes::LANES;
use crate::mechanics::product::Panels;
use nalgebra::{DMatrix, DVector, Rotation3, Vector3};
use rayon::prelude::*;

/// Prior standard deviation of a compliance \[rad/(N m)\]. It is far larger than the compliance of any real part.
/// Without a prior, a compliance that no weight loads could take any value.
const PRIOR_RAD_PER_NM: f64 = 0.1;
/// Number of samples (measured positions) whose rows of the equations are computed together. The rows then stay in
/// the processor's cache until their products are taken.
const BLOCK: usize = 64;
/// Number of samples whose products are summed up by one thread. It is a fixed number, so that the sums do not depend on the
/// number of threads.
const PORTION: usize = 80 * BLOCK;
/// Number of rows for which a block has room. Eight samples are always written at once, so there is room for the unused
/// lanes of the last group.
const HEIGHT: usize = 3 * (BLOCK + LANES);

/// A function that appends further columns to the equations: derivatives of a sample's position with respect to numbers
/// that the caller tests \[m per unit\]. These columns belong to no number of the model.
pub(crate) type Further<'a> = &'a (dyn Fn(&Sample, &Placer, &mut Vec<Vector3<f64>>) + Sync);

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
            if let Some(by) = slope_beyond_geometry(here, &self.from_level, sample, number) {
                *column = by;
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

/// Derivative of a sample's position with respect to a number that does not act through the geometry, such as the direction
/// of gravity \[m per unit\]; `None` for all other numbers.
fn slope_beyond_geometry(
    here: &Fitted,
    from_level: &Rotation3<f64>,
    sample: &Sample,
    number: &Number,
) -> Option<Vector3<f64>> {
    let by = match *number {
        Number::Gravity(c) => {
            Some(from_level * (here.leaning(sample, c) + sample.deflection.known_slopes_m[c]))
        }
        Number::Tolerance(k) | Number::Effect(k) => Some(from_level * sample.nominal_m[k]),
        Number::Drift(c) => Some(Vector3::ith(c, sample.part)),
        _ => None,
    };
    debug_assert_eq!(by.is_some(), number.acts_beyond_geometry(), "{number:?}");
    by
}

/// Builds the normal equations of all samples, linearized about the model `here`. `further` adds columns that belong
/// to no number of the model.
pub(crate) fn normal(samples: &[&Sample], numbers: &[Number], here: &Fitted, further: Further) -> Normal {
    let portions = by_arm(samples);
    let portions = portions.par_chunks(PORTION).map(|portion| {
        let mut linearized = Linearized::new(here, numbers);
        let mut products: Option<Products> = None;
        for block in portion.chunks(BLOCK) {
            for (k, &i) in block.iter().enumerate() {
                let error = linearized.at(samples[i], further);
                let columns = &linearized.columns;
                products.get_or_insert_with(|| Products::new(columns.len())).put(k, columns, &error);
            }
            products.iter_mut().for_each(|p| p.add(block.len()));
        }
        products
    });
    let portions: Vec<Option<Products>> = portions.collect();
    joined(portions.into_iter().flatten(), numbers, here)
}

/// Builds the normal equations of a fit, without further columns. `misses` are the errors of the samples with the model
/// `here`. The result has the same bits as that of [`normal`], but eight samples are computed at a time.
pub(crate) fn normal_of_fit(
    samples: &[&Sample],
    misses: &[Miss],
    numbers: &[Number],
    here: &Fitted,
) -> Normal {
    let portions = by_arm(samples);
    let portions = portions.par_chunks(PORTION).map(|portion| {
        let mut products = Products::new(width(numbers, here));
        let mut rows = EightRows::new(here, numbers);
        for block in portion.chunks(BLOCK) {
            let mut first = 0;
            for eight in eights(block, samples) {
                let own: Vec<(&Sample, &Miss)> = eight.iter().map(|&i| (samples[i], &misses[i])).collect();
                rows.put(&own, first, &mut products);
                first += eight.len();
            }
            products.add(block.len());
        }
        products
    });
    let portions: Vec<Products> = portions.collect();
    joined(portions.into_iter(), numbers, here)
}

/// Number of numbers and compliances of the model `here`.
fn width(numbers: &[Number], here: &Fitted) -> usize {
    numbers.len() + here.compliances.iter().map(Vec::len).sum::<usize>()
}

/// The normal equations with the sums of all portions, added in their order.
fn joined(portions: impl Iterator<Item = Products>, numbers: &[Number], here: &Fitted) -> Normal {
    let sums = portions.reduce(|mut sums, portion| {
        sums.curvature += portion.curvature;
        sums.gradient += portion.gradient;
        sums
    });
    sums.unwrap_or_else(|| Products::new(width(numbers, here))).into_normal(numbers, here)
}

/// Computes the rows of the equations for up to eight samples of one arm at a time.
struct EightRows<'a> {
    here: &'a Fitted,
    numbers: &'a [Number],
    placer: EightPlacer<'a>,
    from_level: Rotation3<f64>,
    /// For each arm, its derivatives with respect to the numbers, prepared for eight points at a time.
    slopes: Vec<Vec<Slope>>,
    /// Indices of those numbers that do not act through the geometry.
    beyond_geometry: Vec<usize>,
}

impl<'a> EightRows<'a> {
    fn new(here: &'a Fitted, numbers: &'a [Number]) -> Self {
        let placer = EightPlacer::new(&here.geometry);
        Self {
            here,
            numbers,
            from_level: here.geometry.level_to_instrument(),
            slopes: (0..here.geometry.arms()).map(|arm| placer.prepare(arm, numbers)).collect(),
            placer,
            beyond_geometry: (0..numbers.len()).filter(|&j| numbers[j].acts_beyond_geometry()).collect(),
        }
    }

    /// Stores the rows of the samples `own`, each given with its error, in the present block of `products`, from the
    /// block's sample number `first` on.
    fn put(&mut self, own: &[(&Sample, &Miss)], first: usize, products: &mut Products) {
        let asked: Vec<Placing> = own.iter().map(|(sample, _)| sample.placing()).collect();
        self.placer.place_m(&asked);
        let mut scales = [[0.0; LANES]; 3];
        for (lane, (sample, miss)) in own.iter().enumerate() {
            // products of rows that are scaled by the root of the weight contain the weight
            let root = self.here.weight(miss).sqrt();
            let own = sample.precision * root;
            (0..3).for_each(|c| scales[c][lane] = own[c]);
            products.right.fixed_view_mut::<3, 1>(3 * (first + lane), 0).copy_from(&(miss.scaled_m * root));
        }
        let (slopes, out) = (&self.slopes[asked[0].arm], &mut products.rows.as_mut_slice()[3 * first..]);
        self.placer.write_slopes(&asked, slopes, &scales, out, HEIGHT);
        for (lane, (sample, _)) in own.iter().enumerate() {
            let scales = Vector3::from(scales.map(|own| own[lane]));
            self.put_beyond_geometry(sample, &scales, first + lane, products);
        }
    }

    /// Stores the derivatives of one sample that do not follow from the geometry: those with respect to all
    /// compliances, and to the numbers in `beyond_geometry`.
    fn put_beyond_geometry(&self, sample: &Sample, scales: &Vector3<f64>, k: usize, products: &mut Products) {
        let mut store = |j: usize, by: Vector3<f64>| {
            products.rows.fixed_view_mut::<3, 1>(3 * k, j).copy_from(&by.component_mul(scales));
        };
        for &j in &self.beyond_geometry {
            let by = slope_beyond_geometry(self.here, &self.from_level, sample, &self.numbers[j]);
            by.into_iter().for_each(|by| store(j, by));
        }
        let mut j = self.numbers.len();
        for &effect in &self.here.effects {
            sample.deflection.per_compliance(effect, &self.here.geometry.gravity, |by| {
                store(j, self.from_level * by);
                j += 1;
            });
        }
    }
}

/// Sums of the products of the equations' rows, to which one block of rows is added after another.
struct Products {
    /// Rows of the equations of one block of samples: x, y and z of the first sample, then of the second, and so on.
    rows: DMatrix<f64>,
    right: DMatrix<f64>,
    curvature: DMatrix<f64>,
    gradient: DVector<f64>,
}

impl Products {
    fn new(width: usize) -> Self {
        Self {
            rows: DMatrix::zeros(HEIGHT, width),
            right: DMatrix::zeros(HEIGHT, 1),
            curvature: DMatrix::zeros(width, width),
            gradient: DVector::zeros(width),
        }
    }

    /// Stores the three rows of a sample (x, y, z) in the present block, as the block's sample number `k`.
    fn put(&mut self, k: usize, columns: &[Vector3<f64>], error: &Vector3<f64>) {
        for (j, column) in columns.iter().enumerate() {
            self.rows.fixed_view_mut::<3, 1>(3 * k, j).copy_from(column);
        }
        self.right.fixed_view_mut::<3, 1>(3 * k, 0).copy_from(error);
    }

    /// Adds the products of the present block, which has `samples` samples, to the sums. Columns that are zero in the
    /// whole block are left out.
    fn add(&mut self, samples: usize) {
        let count = 3 * samples;
        let columns: Vec<&[f64]> =
            self.rows.as_slice().chunks_exact(HEIGHT).map(|own| &own[..count]).collect();
        let own: Vec<usize> = (0..columns.len()).filter(|&j| columns[j].iter().any(|x| *x != 0.0)).collect();
        let columns: Vec<&[f64]> = own.iter().map(|&j| columns[j]).collect();
        let panels = Panels::of_slices(&columns, count);
        let gradient = panels.times(self.right.view((0, 0), (count, 1)));
        own.iter().zip(gradient.iter()).for_each(|(i, x)| self.gradient[*i] += x);
        let product = panels.lower_square(&columns);
        for (j, column) in product.column_iter().enumerate() {
            let mut sums = self.curvature.column_mut(own[j]);
            let (sums, column) = (sums.as_mut_slice(), &column.as_slice()[j..]);
            // neighbours are added together
            let mut first = j;
            for run in own[j..].chunk_by(|a, b| a + 1 == *b) {
                let to = &mut sums[run[0]..][..run.len()];
                to.iter_mut().zip(&column[first - j..]).for_each(|(sum, x)| *sum += x);
                first += run.len();
            }
        }
    }

    /// The sums over all blocks: curvature and negative gradient.
    fn into_whole(mut self) -> (DMatrix<f64>, DVector<f64>) {
        self.curvature.fill_upper_triangle_with_lower_triangle();
        (self.curvature, self.gradient)
    }

    /// The normal equations of the model `here` with these sums and with its priors.
    fn into_normal(self, numbers: &[Number], here: &Fitted) -> Normal {
        let (mut curvature, mut gradient) = self.into_whole();
        let priors = numbers.iter().map(Number::prior).zip(&here.moved);
        // a weak prior keeps the equations regular for a compliance that no weight loads
        let compliances = here.compliances.iter().flatten().map(|c| (PRIOR_RAD_PER_NM, c));
        for (i, (prior, moved)) in priors.chain(compliances).enumerate() {
            let precision = prior.powi(-2);
            curvature[(i, i)] += precision;
            gradient[i] -= precision * moved;
        }
        Normal { curvature, gradient, own: width(numbers, here) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::file::read_arm_document;
    use crate::catalog::Catalogs;
    use crate::input::json::Document;
    use crate::reconcile::positions::fitted::misses;
    use crate::reconcile::positions::kinematics::{Geometry, Pose, testing::ARM};
    use crate::reconcile::positions::loads::Deflection;
    use crate::reconcile::positions::tree::Tree;
    use crate::reconcile::readings::campaign::{Campaign, read_statement};
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::{Rng, SeedableRng};
    use std::sync::Arc;

    /// Eleven samples of the arm of the tests, each in a pose of its own.
    fn eleven() -> (Geometry, Vec<Sample>) {
        let folder = tempfile::tempdir().expect("temporary folder");
        let file = folder.path().join("campaign.json");
        std::fs::write(&file, "{}").expect("written");
        let statement = read_statement(&file).expect("sound");
        let arm =
            read_arm_document(Document::parse("a", ARM).expect("JSON"), &Catalogs::default()).expect("sound");
        let campaign = Campaign::of_positions(&statement, &[&arm], Vec::new()).expect("one trunk");
        let sample = |k: usize| Sample {
            pose: Arc::new(Pose::new(vec![0.3 * k as f64 - 1.0, 0.9 - 0.2 * k as f64])),
            arm: 0,
            point: 0,
            station: 0,
            part: 0.1 * k as f64,
            index: k,
            group: k,
            measured_m: Vector3::new(0.1, 0.2, 0.3) * k as f64,
            precision: Vector3::new(1.0, 0.5, 1.0),
            deflection: Arc::new(Deflection::known(Vector3::new(0.0, 0.0, -1e-3 * k as f64))),
            nominal_m: Arc::default(),
            second_order_m: Vector3::zeros(),
        };
        (Geometry::nominal(&Tree::new(&campaign), 1), (0..11).map(sample).collect())
    }

    #[test]
    fn equations_of_eight_samples_at_a_time_have_the_bits_of_each_alone() {
        let (mut geometry, samples) = eleven();
        let drift = (0..3).map(Number::Drift);
        let numbers: Vec<Number> = (0..3).map(Number::BaseRotation).chain(drift.clone()).collect();
        geometry.step(&numbers, &[0.2, -0.1, 0.3, 0.04, 0.05, 0.06]);
        let mut here = Fitted::rigid(geometry, 0.01);
        here.moved = vec![0.1; numbers.len()];
        let samples: Vec<&Sample> = samples.iter().collect();
        let drifted = misses(&samples, &here);
        let [alone, eight] = [
            normal(&samples, &numbers, &here, &|_, _, _| {}),
            normal_of_fit(&samples, &drifted, &numbers, &here),
        ];
        assert_eq!((&alone.curvature, &alone.gradient), (&eight.curvature, &eight.gradient));
        // without the drift, the error of each row changes by its fraction of the drift
        here.geometry.step(&drift.collect::<Vec<_>>(), &[-0.04, -0.05, -0.06]);
        for (k, (with, without)) in drifted.iter().zip(misses(&samples, &here)).enumerate() {
            let moved_m = Vector3::new(0.04, 0.025, 0.06) * (0.1 * k as f64);
            assert!((without.scaled_m - with.scaled_m - moved_m).norm() < 1e-15, "{k}");
        }
    }

    #[test]
    fn sums_of_blocks_are_the_products_of_all_rows_at_once() {
        let mut dice = Xoshiro256PlusPlus::seed_from_u64(3);
        let mut next = || (dice.next_u64() >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
        // the last block is short, and some columns are zero in some blocks
        let (samples, width) = (2 * BLOCK + 7, 41);
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
