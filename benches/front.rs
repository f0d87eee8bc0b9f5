//! Benchmarks of the Pareto filter and of the hypervolume on large sets of points. Run them with `cargo bench --bench
//! front`. Rates are in points per second.

use armwright::pareto::front::{exact_front, nondominated};
use armwright::pareto::hypervolume::hypervolume;
use divan::Bencher;
use divan::counter::ItemsCount;

fn main() {
    divan::main();
}

const SIZES: [usize; 2] = [100_000, 1_000_000];

/// Random points in a part of a spherical shell of this thickness and of inner radius 1, about the centre (1.5, 1.5,
/// 1.5). A point far from the centre has small objectives. With a thickness of 0 every point is on the front.
fn points(count: usize, thickness: f64) -> Vec<[f64; 3]> {
    let mut state = 1u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    (0..count)
        .map(|_| {
            let p = [0; 3].map(|_| 0.01 + random());
            let length = p.iter().map(|x| x * x).sum::<f64>().sqrt() / (1.0 + thickness * random());
            p.map(|x| 1.5 - x / length)
        })
        .collect()
}

#[divan::bench(args = SIZES, sample_count = 5)]
fn filter_of_a_shell(bencher: Bencher, count: usize) {
    let points = points(count, 0.2);
    bencher.counter(ItemsCount::new(count)).bench(|| exact_front(&points));
}

#[divan::bench(args = SIZES, sample_count = 5)]
fn filter_of_a_sphere(bencher: Bencher, count: usize) {
    let points = points(count, 0.0);
    bencher.counter(ItemsCount::new(count)).bench(|| exact_front(&points));
}

#[divan::bench(args = SIZES, sample_count = 5)]
fn filter_with_ties_to_twelve_digits(bencher: Bencher, count: usize) {
    let points = points(count, 0.2);
    bencher.counter(ItemsCount::new(count)).bench(|| nondominated(&points));
}

#[divan::bench(args = SIZES, sample_count = 5)]
fn hypervolume_of_a_sphere(bencher: Bencher, count: usize) {
    let points = points(count, 0.0);
    bencher.counter(ItemsCount::new(count)).bench(|| hypervolume(&points, [2.0; 3]));
}
