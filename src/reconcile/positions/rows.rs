//! Linearizes the model of positions: computes, for each sample, its weighted error and the derivatives of its position
//! with respect to every number, and sums these up to the normal equations.
//!
//! A fit asks for these equations in every step, without further columns. The columns of the model are computed for eight
//! samples at a time.
//!
//! The computing time grows in proportion to the number of samples. The memory is small: the rows of the equations are
//! computed in blocks, and only their products are kept. Many samples are divided into portions of fixed size, which
//! threads share; the sums of the portions are added in their order.

use super::fitted::{Fitted, Miss, Sample, by_arm, eights, misses};
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

/// Derivative of a sample's position with respect to a number that does not act through the geometry, such as the direction
/// of gravity \[m per unit\]; `None` for all other numbers.
fn slope_beyond_geometry(
    here: &Fitted,
    from_level: &Rotation3<f64>,
    sample: &Sample,
    number: &Number,
) -> Option<Vector3<f64>> {
    let by = match *number {
        Number::Gravity(c) => Some(from_level * here.leaning_m(sample, c)),
        Number::Tolerance(k) | Number::Effect(k) => Some(from_level * sample.nominal_m[k]),
        Number::Drift(c) => Some(Vector3::ith(c, sample.part)),
        _ => None,
    };
    assert_eq!(by.is_some(), number.acts_beyond_geometry(), "{number:?}");
    by
}

/// Builds the normal equations of all samples, linearized about the model `here`. `further` adds columns that belong
/// to no number of the model.
pub(crate) fn normal(samples: &[&Sample], numbers: &[Number], here: &Fitted, further: Further) -> Normal {
    sums(samples, &misses(samples, here), numbers, here, Some(further)).into_normal(numbers, here)
}

/// Builds the normal equations of a fit, without further columns. `misses` are the errors of the samples with the model
/// `here`.
pub(crate) fn normal_of_fit(
    samples: &[&Sample],
    misses: &[Miss],
    numbers: &[Number],
    here: &Fitted,
) -> Normal {
    sums(samples, misses, numbers, here, None).into_normal(numbers, here)
}

/// Calls `each` for each block of the samples, in their order, with the rows of its equations and their right-hand sides:
/// those of x, y and z of the first sample, then of the second, and so on. The columns are those of `numbers`, then those of
/// the compliances of the model `here`.
pub(super) fn in_blocks(
    samples: &[&Sample],
    numbers: &[Number],
    here: &Fitted,
    mut each: impl FnMut(&[&Sample], &DMatrix<f64>, &DMatrix<f64>),
) {
    let misses = misses(samples, here);
    let order: Vec<usize> = (0..samples.len()).collect();
    let mut products = Products::new(width(numbers, here));
    let mut rows = EightRows::new(here, numbers);
    for block in order.chunks(BLOCK) {
        rows.put_block(block, samples, &misses, &mut products);
        each(&samples[block[0]..][..block.len()], &products.rows, &products.right);
    }
}

/// For each of the `folds` of all samples, the equations of [`normal_of_fit`] without this fold.
pub(super) fn normals_without(folds: &[Vec<&Sample>], numbers: &[Number], here: &Fitted) -> Vec<Normal> {
    let of_fold = |fold: &Vec<&Sample>| sums(fold, &misses(fold, here), numbers, here, None);
    let of_folds: Vec<Products> = folds.iter().map(of_fold).collect();
    let without = |gone: usize| {
        let rest = of_folds.iter().enumerate().filter(|(fold, _)| *fold != gone);
        let mut all = Products::new(width(numbers, here));
        rest.for_each(|(_, own)| all.join(own));
        all.into_normal(numbers, here)
    };
    (0..folds.len()).map(without).collect()
}

/// The equations `normal` of a fit with the part `part` of the curvature that the readings give it. The priors stay.
pub(super) fn with_part(normal: &Normal, part: f64, numbers: &[Number], here: &Fitted) -> Normal {
    let mut curvature = &normal.curvature * part;
    for (i, (precision, _)) in precisions(numbers, here).enumerate() {
        curvature[(i, i)] += (1.0 - part) * precision;
    }
    Normal { curvature, gradient: normal.gradient.clone(), own: normal.own }
}

/// The precision of the prior of each number and compliance of the model `here`, with how far it is from the prior's mean.
fn precisions<'a>(numbers: &'a [Number], here: &'a Fitted) -> impl Iterator<Item = (f64, f64)> + 'a {
    let priors = numbers.iter().map(Number::prior).zip(here.moved.iter().copied());
    // a weak prior keeps the equations regular for a compliance that no weight loads
    let compliances = here.compliances.iter().flatten().map(|c| (PRIOR_RAD_PER_NM, *c));
    priors.chain(compliances).map(|(prior, moved)| (prior.powi(-2), moved))
}

/// The sums of the products of the equations of a fit, with `further` columns.
fn sums(
    samples: &[&Sample],
    misses: &[Miss],
    numbers: &[Number],
    here: &Fitted,
    further: Option<Further>,
) -> Products {
    let count = further.zip(samples.first()).map_or(0, |(further, sample)| {
        let mut placer = here.geometry.placer();
        placer.place_m(sample.placing());
        let mut columns = Vec::new();
        further(sample, &placer, &mut columns);
        columns.len()
    });
    let portions = by_arm(samples);
    let portions = portions.par_chunks(PORTION).map(|portion| {
        let mut products = Products::new(width(numbers, here) + count);
        let mut rows = EightRows::new(here, numbers);
        for block in portion.chunks(BLOCK) {
            rows.put_block(block, samples, misses, &mut products);
            if let Some(further) = further {
                rows.put_further(block, samples, misses, further, &mut products);
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

/// The sums of all portions, added in their order.
fn joined(portions: impl Iterator<Item = Products>, numbers: &[Number], here: &Fitted) -> Products {
    let sums = portions.reduce(|mut sums, portion| {
        sums.join(&portion);
        sums
    });
    sums.unwrap_or_else(|| Products::new(width(numbers, here)))
}

/// Computes the rows of the equations for up to eight samples of one arm at a time.
struct EightRows<'a> {
    here: &'a Fitted,
    numbers: &'a [Number],
    placer: EightPlacer<'a>,
    /// Places one sample at a time, for further columns, which are stored here.
    single: Placer<'a>,
    columns: Vec<Vector3<f64>>,
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
            single: here.geometry.placer(),
            columns: Vec::new(),
            beyond_geometry: (0..numbers.len()).filter(|&j| numbers[j].acts_beyond_geometry()).collect(),
        }
    }

    /// Stores the rows of those samples that have the indices `block` in the present block of `products`.
    fn put_block(&mut self, block: &[usize], samples: &[&Sample], misses: &[Miss], products: &mut Products) {
        let mut first = 0;
        for eight in eights(block, samples) {
            let own: Vec<(&Sample, &Miss)> = eight.iter().map(|&i| (samples[i], &misses[i])).collect();
            self.put(&own, first, products);
            first += eight.len();
        }
    }

    /// Stores the columns that `further` adds for the same samples, behind those of the model.
    fn put_further(
        &mut self,
        block: &[usize],
        samples: &[&Sample],
        misses: &[Miss],
        further: Further,
        products: &mut Products,
    ) {
        let first = width(self.numbers, self.here);
        for (k, &i) in block.iter().enumerate() {
            self.single.place_m(samples[i].placing());
            self.columns.clear();
            further(samples[i], &self.single, &mut self.columns);
            let scales = samples[i].precision * self.here.weight(&misses[i]).sqrt();
            for (j, column) in self.columns.iter().enumerate() {
                let mut to = products.rows.fixed_view_mut::<3, 1>(3 * k, first + j);
                to.copy_from(&column.component_mul(&scales));
            }
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

    /// Stores the derivatives of one sample that do not follow from the geometry: those with respect to all compliances
    /// and to the numbers in `beyond_geometry`.
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

    fn join(&mut self, other: &Self) {
        self.curvature += &other.curvature;
        self.gradient += &other.gradient;
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
        for (i, (precision, moved)) in precisions(numbers, here).enumerate() {
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
    use crate::mechanics::tip::UnitRotation;
    use crate::reconcile::positions::deflection::{Deflection, Slot};
    use crate::reconcile::positions::fit::ln_likelihood;
    use crate::reconcile::positions::kinematics::{Geometry, testing::ARM};
    use crate::reconcile::positions::pose::Pose;
    use crate::reconcile::positions::shape::Shape;
    use crate::reconcile::positions::tree::Tree;
    use crate::reconcile::readings::campaign::{Campaign, read_statement};
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::{Rng, SeedableRng};
    use std::sync::Arc;

    impl Fitted {
        /// The equations without the priors of `numbers`.
        fn without_priors(&self, numbers: &[Number], all: &Normal) -> Normal {
            let (mut curvature, mut gradient) = (all.curvature.clone(), all.gradient.clone());
            for (i, (precision, moved)) in precisions(numbers, self).enumerate() {
                curvature[(i, i)] -= precision;
                gradient[i] += precision * moved;
            }
            Normal { curvature, gradient, own: all.own }
        }
    }

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
            pose: Pose::new(&[0.3 * k as f64 - 1.0, 0.9 - 0.2 * k as f64]),
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
    fn equations_of_eight_samples_at_a_time_are_those_of_each_alone() {
        let (mut geometry, samples) = eleven();
        let drift = (0..3).map(Number::Drift);
        let numbers: Vec<Number> = (0..3).map(Number::BaseRotation).chain(drift.clone()).collect();
        geometry.step(&numbers, &[0.2, -0.1, 0.3, 0.04, 0.05, 0.06]);
        let mut here = Fitted::rigid(geometry, 0.01);
        here.moved = vec![0.1; numbers.len()];
        let samples: Vec<&Sample> = samples.iter().collect();
        let drifted = misses(&samples, &here);
        // the same columns twice: by eight samples, and as further columns by each sample alone
        let found = normal(&samples, &numbers, &here, &|sample, placer, columns| {
            let from = columns.len();
            placer.slopes(sample.placing(), &numbers, columns);
            let from_level = here.geometry.level_to_instrument();
            for (column, number) in columns[from..].iter_mut().zip(&numbers) {
                let by = slope_beyond_geometry(&here, &from_level, sample, number);
                by.into_iter().for_each(|by| *column = by);
            }
        });
        let eight = normal_of_fit(&samples, &drifted, &numbers, &here);
        let alone = here.without_priors(&numbers, &eight);
        let count = numbers.len();
        let further = found.curvature.view((count, count), (count, count)).into_owned();
        assert!((further - &alone.curvature).amax() < 1e-12 * alone.curvature.amax());
        let further = found.gradient.rows(count, count).into_owned();
        assert!((further - &alone.gradient).amax() < 1e-12 * alone.gradient.amax());
        // without the drift each row is off by its part of it
        here.geometry.step(&drift.collect::<Vec<_>>(), &[-0.04, -0.05, -0.06]);
        for (k, (with, without)) in drifted.iter().zip(misses(&samples, &here)).enumerate() {
            let moved_m = Vector3::new(0.04, 0.025, 0.06) * (0.1 * k as f64);
            assert!((without.scaled_m - with.scaled_m - moved_m).norm() < 1e-15, "{k}");
        }
    }

    /// A deflection by a spring and by the shapes `others` about the same axis, in the direction of gravity and across it.
    fn deflection(k: usize, others: &[Shape]) -> Deflection {
        let angle = 0.7 * k as f64;
        let rotation = UnitRotation {
            motion_m: Vector3::new(0.4 * angle.cos(), -0.3, 0.5 + 0.2 * angle.sin()),
            pull_nm: Vector3::new(20.0, 30.0 * angle.cos(), 40.0 * angle.sin() - 15.0),
        };
        let shapes = [Shape::Spring].into_iter().chain(others.iter().copied());
        let slot = |shape| Slot { first: 0, rotations: 1, compliances: 1, shape, driven: 0 };
        Deflection {
            known_slopes_m: [Vector3::new(1e-3, 2e-3, angle * 1e-3), Vector3::new(-1e-3, angle * 2e-3, 0.0)],
            rotations: Arc::new([rotation]),
            slots: shapes.map(slot).collect(),
            ..Deflection::known(Vector3::new(0.0, 0.0, -1e-3 * k as f64))
        }
    }

    #[test]
    fn the_gradient_is_that_of_the_likelihood_and_of_the_priors() {
        let (mut geometry, mut samples) = eleven();
        for (k, sample) in samples.iter_mut().enumerate() {
            sample.deflection = Arc::new(deflection(k, &[Shape::Play(12.0), Shape::Lift(11.0)]));
        }
        geometry.step(&(0..3).map(Number::BaseRotation).collect::<Vec<_>>(), &[0.2, -0.1, 0.3]);
        let numbers: Vec<Number> = (0..2)
            .map(Number::Gravity)
            .chain([Number::Zero(0), Number::Drift(1), Number::BasePosition(2)])
            .collect();
        geometry.step(&numbers, &[0.02, -0.03, 0.1, 0.05, 0.2]);
        let mut here = Fitted::rigid(geometry, 0.2);
        here.moved = vec![0.003; numbers.len()];
        (here.effects, here.compliances) = (vec![0, 1, 2], vec![vec![2e-3], vec![0.04], vec![1e-3]]);
        let samples: Vec<&Sample> = samples.iter().collect();
        let found = normal_of_fit(&samples, &misses(&samples, &here), &numbers, &here).gradient;
        let value = |j: usize, by: f64| {
            let mut moved = here.clone();
            match numbers.get(j) {
                Some(number) => {
                    moved.geometry.step(std::slice::from_ref(number), &[by]);
                    moved.moved[j] += by;
                }
                None => moved.compliances[j - numbers.len()][0] += by,
            }
            let compliances = moved.compliances.iter().flatten();
            let improbable: f64 = compliances.map(|c| 0.5 * (c / PRIOR_RAD_PER_NM).powi(2)).sum();
            ln_likelihood(&misses(&samples, &moved), here.scale_m)
                - moved.improbability(&numbers)
                - improbable
        };
        for (j, found) in found.iter().enumerate() {
            let difference = (value(j, 1e-6) - value(j, -1e-6)) / 2e-6;
            assert!((difference / found - 1.0).abs() < 1e-5, "{j}: {difference} {found}");
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
                products.rows.rows_mut(3 * k, 3).copy_from(&rows.rows(three, 3));
                products.right.rows_mut(3 * k, 3).copy_from(&errors.rows(three, 3));
            }
            products.add(count);
        }
        let (curvature, gradient) = products.into_whole();
        assert!((curvature - rows.tr_mul(&rows)).amax() < 1e-12);
        assert!((gradient - rows.tr_mul(&errors)).amax() < 1e-12);
    }
}
