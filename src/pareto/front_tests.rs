//! Tests of fronts. Every front is compared with the result of comparing all pairs of points.

use super::*;
use proptest::prelude::*;

fn dominates(a: &[f64; 3], b: &[f64; 3]) -> bool {
    (0..3).all(|k| a[k] <= b[k]) && (0..3).any(|k| a[k] < b[k])
}

/// The front, found by comparing all pairs of points.
fn all_pairs(points: &[[f64; 3]]) -> Vec<usize> {
    (0..points.len()).filter(|&i| !points.iter().any(|p| dominates(p, &points[i]))).collect()
}

/// Random points of many kinds: small whole numbers (which give ties, duplicates and collinear points), both zeros,
/// infinities, neighbours in floating point, and widely spread numbers.
fn points() -> impl Strategy<Value = Vec<[f64; 3]>> {
    let near = |k: u8| 1.0 + f64::from(k) * f64::EPSILON;
    let odd = prop::sample::select(vec![-0.0, 0.0, f64::INFINITY, f64::NEG_INFINITY, 1e-300, -1e300]);
    let coordinate = prop_oneof![
        4 => (0u8..6).prop_map(|x| f64::from(x) - 2.0),
        1 => (0u8..3).prop_map(near),
        1 => odd,
        2 => -2.0f64..2.0,
    ];
    prop::collection::vec([coordinate.clone(), coordinate.clone(), coordinate], 0..80)
}

proptest! {
    #[test]
    fn the_exact_front_is_that_of_all_pairs(points in points()) {
        prop_assert_eq!(exact_front(&points).unwrap(), all_pairs(&points));
    }

    #[test]
    fn the_front_by_twelve_digits_is_that_of_all_pairs_of_rounded_points(points in points()) {
        let mut ours: Vec<usize> = nondominated(&points).unwrap().into_iter().flatten().collect();
        ours.sort_unstable();
        let rounded: Vec<[f64; 3]> = points.iter().map(|p| p.map(rounded)).collect();
        prop_assert_eq!(ours, all_pairs(&rounded));
    }

    #[test]
    fn slack_keeps_every_point_that_is_not_clearly_beaten(
        points in prop::collection::vec([0.5f64..2.0, 0.5f64..2.0, -2.0f64..-0.5], 0..60)
    ) {
        let slack = 0.1;
        let beaten = |i: usize| points.iter().any(|p| {
            (0..3).all(|k| p[k] <= points[i][k] - slack * points[i][k].abs())
        });
        let brute: Vec<usize> = (0..points.len()).filter(|&i| !beaten(i)).collect();
        prop_assert_eq!(not_clearly_beaten(&points, slack), brute);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// The points are numerous enough for the sieve to be used. `steps` determines how many ties there are, and `bulge`
    /// determines how large the front is.
    #[test]
    fn the_sieve_drops_no_point_of_the_front(
        seed in any::<u64>(), steps in 2u32..60, bulge in 0u8..3, digits in any::<bool>()
    ) {
        let mut state = seed;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            f64::from((state >> 33) as u32 % steps) / f64::from(steps)
        };
        let points: Vec<[f64; 3]> = (0..6000)
            .map(|_| {
                let [a, b, c] = [random(), random(), random()];
                match bulge {
                    0 => [a, b, c],
                    1 => [a, b, 0.3 * c - a - b],
                    _ => [libm::exp2(a).powi(40), 1.0 / (0.01 + a * b), c - b * b],
                }
            })
            .collect();
        let (ours, brute) = match digits {
            true => {
                let mut front: Vec<usize> = nondominated(&points).unwrap().concat();
                front.sort_unstable();
                let rounded: Vec<[f64; 3]> = points.iter().map(|p| p.map(rounded)).collect();
                (front, all_pairs(&rounded))
            }
            false => (exact_front(&points).unwrap(), all_pairs(&points)),
        };
        prop_assert_eq!(ours, brute);
    }
}

#[test]
fn ties_stay_together_and_rounding_does_not_part_them() {
    let points = [[1.0, 2.0, -3.0], [1.0 + 1e-15, 2.0, -3.0], [2.0, 2.0, -3.0]];
    assert_eq!(nondominated(&points).unwrap(), vec![vec![0, 1]]);
    assert_eq!(exact_front(&points).unwrap(), vec![0]);
}

#[test]
fn no_point_one_point_and_equal_points() {
    assert!(exact_front(&[]).unwrap().is_empty());
    assert!(nondominated(&[]).unwrap().is_empty());
    assert_eq!(exact_front(&[[1.0, 2.0, 3.0]]).unwrap(), vec![0]);
    assert_eq!(exact_front(&[[1.0, 2.0, 3.0]; 5000]).unwrap().len(), 5000);
}

#[test]
fn collinear_points_all_stay_where_they_trade_and_one_stays_where_they_do_not() {
    let trade: Vec<[f64; 3]> = (0..5000).map(|i| [1.0, f64::from(i), -f64::from(i)]).collect();
    assert_eq!(exact_front(&trade).unwrap().len(), 5000);
    let rise: Vec<[f64; 3]> = (0..5000).map(|i| [f64::from(i); 3]).collect();
    assert_eq!(exact_front(&rise).unwrap(), vec![0]);
}

#[test]
fn what_is_not_a_number_is_refused_by_its_place() {
    let points = [[1.0, 2.0, 3.0], [1.0, f64::NAN, 3.0]];
    assert_eq!(exact_front(&points), Err(NotANumber { point: 1 }));
    assert_eq!(nondominated(&points), Err(NotANumber { point: 1 }));
}
