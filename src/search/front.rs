//! Pareto fronts of three objectives, all to be made small.

use std::collections::BTreeMap;
use std::collections::HashMap;

/// Decimal digits that count when two objectives are compared: what lies below is rounding.
const DIGITS: i32 = 12;

/// A number rounded to `DIGITS` significant decimal digits.
pub fn rounded(x: f64) -> f64 {
    if x == 0.0 || !x.is_finite() {
        return x;
    }
    let scale = 10f64.powi(DIGITS - 1 - x.abs().log10().floor() as i32);
    (x * scale).round() / scale
}

/// The largest value of the third objective's negative seen up to each value of the second: the
/// staircase of a sweep along the first.
#[derive(Default)]
struct Staircase(BTreeMap<u64, f64>);

impl Staircase {
    /// Smallest third objective among the points whose second is at most `second`.
    fn best(&self, second: f64) -> f64 {
        self.0.range(..=key(second)).next_back().map_or(f64::INFINITY, |(_, third)| *third)
    }

    fn insert(&mut self, second: f64, third: f64) {
        if self.best(second) <= third {
            return;
        }
        let covered: Vec<u64> =
            self.0.range(key(second)..).take_while(|(_, t)| **t >= third).map(|(k, _)| *k).collect();
        for k in covered {
            self.0.remove(&k);
        }
        self.0.insert(key(second), third);
    }
}

/// A key in the order of the numbers.
fn key(x: f64) -> u64 {
    let bits = (x + 0.0).to_bits();
    if bits >> 63 == 0 { bits | 1 << 63 } else { !bits }
}

/// Groups of points that no other point dominates, each group a tie (equal in all three to 12 digits),
/// sorted by the objectives; indices within a group ascend. NaN is dominated by everything.
pub fn nondominated(points: &[[f64; 3]]) -> Vec<Vec<usize>> {
    let mut ties: HashMap<[u64; 3], Vec<usize>> = HashMap::new();
    for (i, point) in points.iter().enumerate().filter(|(_, p)| p.iter().all(|x| !x.is_nan())) {
        ties.entry(point.map(|x| key(rounded(x)))).or_default().push(i);
    }
    let mut groups: Vec<([u64; 3], Vec<usize>)> = ties.into_iter().collect();
    groups.sort_unstable_by_key(|(point, _)| *point);
    let mut stairs = Staircase::default();
    groups
        .into_iter()
        .filter(|(_, members)| {
            let [_, second, third] = points[members[0]].map(rounded);
            let free = stairs.best(second) > third;
            if free {
                stairs.insert(second, third);
            }
            free
        })
        .map(|(_, members)| members)
        .collect()
}

/// Indices of the points that no other point beats by more than `slack` (relative) in all three
/// objectives, in the order of `points`.
pub fn not_clearly_beaten(points: &[[f64; 3]], slack: f64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_unstable_by(|&i, &j| points[i][0].total_cmp(&points[j][0]).then(i.cmp(&j)));
    let mut stairs = Staircase::default();
    let mut entered = 0;
    let mut kept = Vec::new();
    for &i in &order {
        let [first, second, third] = points[i].map(|x| x - slack * x.abs());
        while entered < order.len() && points[order[entered]][0] <= first {
            let [_, s, t] = points[order[entered]];
            stairs.insert(s, t);
            entered += 1;
        }
        if stairs.best(second) > third {
            kept.push(i);
        }
    }
    kept.sort_unstable();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn dominates(a: &[f64; 3], b: &[f64; 3]) -> bool {
        (0..3).all(|k| a[k] <= b[k]) && (0..3).any(|k| a[k] < b[k])
    }

    proptest! {
        #[test]
        fn the_front_is_that_of_all_pairs(points in prop::collection::vec([0u8..6, 0u8..6, 0u8..6], 0..60)) {
            let points: Vec<[f64; 3]> = points.iter().map(|p| p.map(|x| f64::from(x) - 2.0)).collect();
            let brute: Vec<usize> = (0..points.len())
                .filter(|&i| !points.iter().any(|p| dominates(p, &points[i])))
                .collect();
            let mut ours: Vec<usize> = nondominated(&points).into_iter().flatten().collect();
            ours.sort_unstable();
            prop_assert_eq!(ours, brute);
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

    #[test]
    fn ties_stay_together_and_rounding_does_not_part_them() {
        let points = [[1.0, 2.0, -3.0], [1.0 + 1e-15, 2.0, -3.0], [2.0, 2.0, -3.0]];
        assert_eq!(nondominated(&points), vec![vec![0, 1]]);
    }
}
