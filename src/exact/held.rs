//! Forces that a region holds between two bounds.
//!
//! The torque on a gear is a sum over the weights outboard. Where its interval is wide the products of force and
//! compliance are known badly, and no single level's options are to blame; so a region may be parted by the torque
//! itself ([`parting`](super::parting)). What is known of one force then says something of every other force that the
//! same weights make.

use super::pose::Row;

/// Rounding of a force.
const ROUNDING: f64 = 1e-12;

/// A force of a judged case between two bounds.
#[derive(Debug, Clone, Copy)]
pub(super) struct Held {
    pub case: usize,
    /// Its row in the case.
    pub row: usize,
    pub between: [f64; 2],
}

impl Held {
    /// Bounds of another force made by weights between bounds.
    ///
    /// For any `a` the force is `a` times the held one, plus what is left of it: a sum over the weights. The bound is
    /// piecewise linear in `a` and best where a weight drops out of what is left.
    pub fn tighten(&self, of: &Row, by: &Row, weights: &[[f64; 2]], force: &mut [f64; 2]) {
        for (held, per_n) in by.per_n.iter().enumerate().filter(|(_, c)| **c != 0.0) {
            let a = of.per_n.get(held).copied().unwrap_or(0.0) / per_n;
            if a == 0.0 {
                continue;
            }
            let [x, y] = self.between.map(|f| a * (f - by.fixed));
            let (mut low, mut high) = (of.fixed + x.min(y), of.fixed + x.max(y));
            // where a coefficient is hardly more than rounding `a` is large, and what is left next to nothing beside it
            let (mut low_size, mut high_size) =
                (of.fixed.abs() + x.min(y).abs(), of.fixed.abs() + x.max(y).abs());
            for (k, w) in weights.iter().enumerate() {
                let at = |per_n: &[f64]| per_n.get(k).copied().unwrap_or(0.0);
                let left = at(&of.per_n) - a * at(&by.per_n);
                let (x, y) = (left * w[0], left * w[1]);
                low += x.min(y);
                high += x.max(y);
                low_size += x.min(y).abs();
                high_size += x.max(y).abs();
            }
            force[0] = force[0].max(low - ROUNDING * low_size);
            force[1] = force[1].min(high + ROUNDING * high_size);
        }
    }
}

#[cfg(test)]
mod tests {
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
            way_m: 0.0,
        }
    }

    fn force(row: &Row, weights: &[f64]) -> f64 {
        row.fixed + row.per_n.iter().zip(weights).map(|(c, w)| c * w).sum::<f64>()
    }

    proptest! {
        /// Tightened bounds hold for all weights whose held force is within its own; they are the best there are: by a
        /// grid over the weights that keep to it.
        #[test]
        fn a_held_force_tightens_others_and_leaves_out_none(
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
            let held = Held { case: 0, row: 0, between: [middle - 0.5, middle + 0.5] };
            let mut bounds = interval(of.fixed, &of.per_n, &weights);
            held.tighten(&of, &by, &weights, &mut bounds);
            let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
            for n in 0..41usize.pow(3) {
                let weights = grid(n, 40);
                if (force(&by, &weights) - middle).abs() <= 0.5 {
                    let force = force(&of, &weights);
                    prop_assert!(bounds[0] - 1e-9 <= force && force <= bounds[1] + 1e-9);
                    (least, most) = (least.min(force), most.max(force));
                }
            }
            // a step of the grid moves either force by no more than 3 coefficients of 3 at 3/40 each
            prop_assert!(least - bounds[0] < 1.5 && bounds[1] - most < 1.5, "{least} {most} {bounds:?}");
        }

        /// A weight whose lever arm is rounding does not make rounding a bound.
        #[test]
        fn a_coefficient_of_next_to_nothing_does_no_harm(at in 1.0f64..9.0, nearly in 1e-18f64..1e-16) {
            let (of, by) = (row(&[0.0, 1.0, 1.0, 1.0]), row(&[0.0, 1.0, nearly, 1.0]));
            let weights = [[at, at], [0.0, 1.0], [0.0, 0.0]];
            let whole = interval(of.fixed, &of.per_n, &weights);
            let mut bounds = whole;
            Held { case: 0, row: 0, between: [0.9 * at, at] }.tighten(&of, &by, &weights, &mut bounds);
            prop_assert!((bounds[0] - whole[0]).abs() < 1e-9 && (bounds[1] - whole[1]).abs() < 1e-9, "{bounds:?}");
        }

        #[test]
        fn one_side_may_be_open(numbers in prop::collection::vec(-3i32..4, 4), at in -9.0f64..9.0) {
            let row = row(&numbers.into_iter().map(f64::from).collect::<Vec<f64>>());
            let weights = [[0.0, 2.0]; 3];
            let whole = interval(row.fixed, &row.per_n, &weights);
            let mut bounds = whole;
            Held { case: 0, row: 0, between: [at, f64::INFINITY] }.tighten(&row, &row, &weights, &mut bounds);
            prop_assert!((bounds[1] - whole[1]).abs() < 1e-9);
            let least = if row.per_n.iter().any(|c| *c != 0.0) { whole[0].max(at) } else { whole[0] };
            prop_assert!((bounds[0] - least).abs() < 1e-9);
        }
    }
}
