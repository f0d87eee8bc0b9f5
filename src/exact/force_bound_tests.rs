//! Tests of the bounds on a force: they tighten the intervals of other forces and exclude no possible value.

use super::*;
use crate::exact::interval::interval;
use nalgebra::Vector3;
use proptest::prelude::*;

fn row(numbers: &[f64]) -> Row {
    let (fixed, per_n) = numbers.split_first().unwrap();
    Row {
        piece: 0,
        coordinate: 0,
        fixed: *fixed,
        per_n: per_n.to_vec(),
        tip_m: Vector3::zeros(),
        tip_m_per_unit: 0.0,
    }
}

fn force(row: &Row, weights: &[f64]) -> f64 {
    row.fixed + row.per_n.iter().zip(weights).map(|(c, w)| c * w).sum::<f64>()
}

proptest! {
    /// The tightened bounds are valid for all weights that keep the bounded force in its interval, and no tighter
    /// bounds are valid: both are compared with a grid over the weights.
    #[test]
    fn a_bounded_force_tightens_others_and_leaves_out_none(
        of in prop::collection::vec(-3i32..4, 4), by in prop::collection::vec(-3i32..4, 4),
        low in prop::collection::vec(0u32..4, 3), wide in prop::collection::vec(0u32..4, 3), at in 0usize..64,
    ) {
        let [of, by] = [of, by].map(|numbers| row(&numbers.into_iter().map(f64::from).collect::<Vec<f64>>()));
        let weights: Vec<[f64; 2]> =
            low.iter().zip(&wide).map(|(l, w)| [f64::from(*l), f64::from(l + w)]).collect();
        let grid = |n: usize, steps: usize| -> Vec<f64> {
            let part = |k: u32| (n / (steps + 1).pow(k) % (steps + 1)) as f64 / steps as f64;
            weights.iter().zip(0..).map(|([a, b], k)| a + (b - a) * part(k)).collect()
        };
        let middle = force(&by, &grid(at, 3));
        let bound = ForceBound { case: 0, row: 0, between: [middle - 0.5, middle + 0.5] };
        let mut bounds = interval(of.fixed, &of.per_n, &weights);
        bound.tighten(&of, &by, &weights, &mut bounds);
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for n in 0..41usize.pow(3) {
            let weights = grid(n, 40);
            if (force(&by, &weights) - middle).abs() <= 0.5 {
                let force = force(&of, &weights);
                prop_assert!(bounds[0] - 1e-9 <= force && force <= bounds[1] + 1e-9);
                (least, most) = (least.min(force), most.max(force));
            }
        }
        // One step of the grid moves either force by at most three coefficients of 3, each times 3/40.
        prop_assert!(least - bounds[0] < 1.5 && bounds[1] - most < 1.5, "{least} {most} {bounds:?}");
    }

    /// A coefficient that is only rounding must not make the bounds wrong.
    #[test]
    fn a_coefficient_of_next_to_nothing_does_no_harm(at in 1.0f64..9.0, nearly in 1e-18f64..1e-16) {
        let (of, by) = (row(&[0.0, 1.0, 1.0, 1.0]), row(&[0.0, 1.0, nearly, 1.0]));
        let weights = [[at, at], [0.0, 1.0], [0.0, 0.0]];
        let whole = interval(of.fixed, &of.per_n, &weights);
        let mut bounds = whole;
        ForceBound { case: 0, row: 0, between: [0.9 * at, at] }.tighten(&of, &by, &weights, &mut bounds);
        prop_assert!((bounds[0] - whole[0]).abs() < 1e-9 && (bounds[1] - whole[1]).abs() < 1e-9, "{bounds:?}");
    }

    #[test]
    fn one_side_may_be_open(numbers in prop::collection::vec(-3i32..4, 4), at in -9.0f64..9.0) {
        let row = row(&numbers.into_iter().map(f64::from).collect::<Vec<f64>>());
        let weights = [[0.0, 2.0]; 3];
        let whole = interval(row.fixed, &row.per_n, &weights);
        let mut bounds = whole;
        ForceBound { case: 0, row: 0, between: [at, f64::INFINITY] }.tighten(&row, &row, &weights, &mut bounds);
        prop_assert!((bounds[1] - whole[1]).abs() < 1e-9);
        let least = if row.per_n.iter().any(|c| *c != 0.0) { whole[0].max(at) } else { whole[0] };
        prop_assert!((bounds[0] - least).abs() < 1e-9);
    }
}
