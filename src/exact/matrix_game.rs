//! A matrix game, solved by the simplex method. The game is given by a matrix. Its solution is the weights of the
//! columns under which the least weighted sum of a row is as large as possible. The weights are not negative and sum to
//! one.

use crate::mechanics::lanes::{LANES, LaneWork, Lanes, in_lanes, subtract_multiple};
use std::ops::Range;

/// Greatest number of simplex pivots.
const MOST_PIVOTS: usize = 200;
/// Numbers below this count as rounding.
const ROUNDING: f64 = 1e-11;

/// Tolerance of the balance rows of the simplex tableau. It grows a little from column to column, so that no two pivots
/// are equal.
const BALANCE_TOLERANCE: f64 = 1e-6;

/// The solution of a matrix game.
pub(super) struct Game {
    /// Weights of the columns. None is negative, and they sum to one.
    pub weights: Vec<f64>,
    /// Weights of the rows in a mixture. They make the greatest weighted sum of a column as small as possible, and
    /// they sum to one.
    pub mix: Vec<f64>,
    /// Value of the game: the weighted sum of the numbers of a row, for the row in which it is least.
    pub value: f64,
}

/// Solves a matrix game: finds the weights of the columns that make the weighted sum of the worst row as large as
/// possible. `rows` has the numbers of all rows one after the other, `width` numbers for each row.
///
/// The simplex method solves the linear program of the other player, who mixes the rows: `max Σ z` with
/// `Σ_j (a_ji + c) z_j <= 1` for every column `i`, and `z >= 0`. The dual values of this program are the weights.
///
/// The columns in the range `balanced` are conditions on the mixture: `Σ_j a_ji z_j <= 0`. They come in pairs of
/// opposite sign, so the sum must be zero. If such a pair were two ordinary columns, equal weights on both would
/// guarantee the value zero and prove nothing.
pub(super) fn solve(rows: &[f64], width: usize, balanced: Range<usize>) -> Game {
    let count = rows.len() / width;
    let least = rows.iter().copied().fold(f64::INFINITY, f64::min);
    let most = rows.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // All entries become at least 1 after scaling by the spread, so the value of the game is positive and the
    // program is bounded.
    let spread = (most - least).max(f64::MIN_POSITIVE);
    let entry =
        |i: usize, a: f64| if balanced.contains(&i) { a / spread } else { (a - least) / spread + 1.0 };
    // The tableau has one line for each column of the game (its slack is basic at first) and one for the objective. A
    // line has a number for each variable that is not basic, and the right side. Basic variables have unit vectors,
    // which are left out. Lines are filled with zeros to whole registers.
    let line = (count + 1).next_multiple_of(LANES);
    let mut table = vec![0.0; (width + 1) * line];
    let (mut basic, mut others): (Vec<usize>, Vec<usize>) =
        ((count..count + width).collect(), (0..count).collect());
    for (i, numbers) in table.chunks_exact_mut(line).enumerate().take(width) {
        for (j, number) in numbers[..count].iter_mut().enumerate() {
            *number = entry(i, rows[j * width + i]);
        }
        numbers[count] =
            if balanced.contains(&i) { BALANCE_TOLERANCE * (1.0 + i as f64 / width as f64) } else { 1.0 };
    }
    table[width * line..width * line + count].fill(-1.0);
    for _ in 0..MOST_PIVOTS {
        let objective = &table[width * line..width * line + count];
        let cost = in_lanes(Least(objective));
        // No variable improves the objective: the tableau is optimal.
        if cost > -ROUNDING {
            break;
        }
        // Of several variables with this cost, the variable with the lowest number enters, wherever its column
        // stands in the tableau.
        let equals = (0..count).filter(|&j| objective[j] == cost);
        let Some(enter) = equals.min_by_key(|&j| others[j]) else { break };
        let ratio = |i: usize| {
            let a = table[i * line + enter];
            if a > ROUNDING { table[i * line + count] / a } else { f64::INFINITY }
        };
        let ratios = (0..width).map(|i| (i, ratio(i)));
        // The program is bounded, so a missing finite ratio is due to rounding. The solution so far is then used.
        let least = ratios.min_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, ratio)| ratio.is_finite());
        let Some((leave, _)) = least else { break };
        std::mem::swap(&mut basic[leave], &mut others[enter]);
        in_lanes(Pivot { table: &mut table, line, leave, enter });
    }
    let (mut weights, mut mix) = (vec![0.0; width], vec![0.0; count]);
    for (j, &variable) in others.iter().enumerate().filter(|(_, variable)| **variable >= count) {
        weights[variable - count] = table[width * line + j].max(0.0);
    }
    for (i, &variable) in basic.iter().enumerate().filter(|(_, variable)| **variable < count) {
        mix[variable] = table[i * line + count].max(0.0);
    }
    normalize(&mut weights);
    normalize(&mut mix);
    let weighted = |row: &[f64]| row.iter().zip(&weights).map(|(a, w)| a * w).sum::<f64>();
    let value = rows.chunks(width).map(weighted).fold(f64::INFINITY, f64::min);
    Game { weights, mix, value }
}

/// Divides shares by their sum.
fn normalize(shares: &mut [f64]) {
    let sum: f64 = shares.iter().sum();
    shares.iter_mut().for_each(|share| *share /= sum);
}

/// Computes the least number of a list.
struct Least<'a>(&'a [f64]);

impl LaneWork for Least<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<V: Lanes>(self) -> f64 {
        let (eights, rest) = self.0.as_chunks::<LANES>();
        let mut least = V::splat(f64::INFINITY);
        for eight in eights {
            least = least.min(V::load(eight));
        }
        least.store().iter().chain(rest).fold(f64::INFINITY, |least, x| least.min(*x))
    }
}

/// One step of the simplex method: the variable of column `enter` becomes basic and gets line `leave` of the tableau.
/// The basic variable that had this line gets column `enter`.
struct Pivot<'a> {
    table: &'a mut [f64],
    /// Number of entries in a line of the tableau.
    line: usize,
    leave: usize,
    enter: usize,
}

impl LaneWork for Pivot<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes>(self) {
        let Self { table, line, leave, enter } = self;
        let by = 1.0 / table[leave * line + enter];
        // The column of the variable that leaves was a unit vector.
        table[leave * line + enter] = 1.0;
        for x in &mut table[leave * line..(leave + 1) * line] {
            *x *= by;
        }
        let (before, rest) = table.split_at_mut(leave * line);
        let (pivotal, after) = rest.split_at_mut(line);
        for half in [before, after] {
            for other in half.chunks_exact_mut(line) {
                let factor = other[enter];
                if factor != 0.0 {
                    other[enter] = 0.0;
                    subtract_multiple::<V>(other, factor, pivotal);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The mixture satisfies the pair of balanced columns as an equation. The greatest of the other columns under
        /// the mixture equals the value that the weights guarantee, so no weights are better.
        #[test]
        fn a_balanced_pair_is_a_condition_and_no_stake(rows in prop::collection::vec(-1.0f64..1.0, 3 * 6)) {
            let rows: Vec<f64> = rows.chunks(3).flat_map(|r| [r[0], r[1], r[2], -r[2]]).collect();
            let of_both_signs = [-0.1, 0.1].map(|sign| rows.chunks(4).any(|row| row[2] * sign > 0.01));
            prop_assume!(of_both_signs == [true; 2]);
            let Game { weights, mix, value } = solve(&rows, 4, 2..4);
            let mixed = |i: usize| rows.chunks(4).zip(&mix).map(|(row, z)| row[i] * z).sum::<f64>();
            prop_assert!(weights.iter().chain(&mix).all(|x| *x >= 0.0));
            prop_assert!(weights[0] + weights[1] > 1e-3);
            prop_assert!(mixed(2).abs() < 1e-4, "{}", mixed(2));
            let stakes = value / (weights[0] + weights[1]);
            prop_assert!((mixed(0).max(mixed(1)) - stakes).abs() < 1e-3, "{} {stakes}", mixed(0).max(mixed(1)));
        }

        /// The value of the game lies between the value that the weights guarantee and the value that some mixture of
        /// rows attains. Fictitious play finds such mixtures independently.
        #[test]
        fn no_other_weights_are_better(rows in prop::collection::vec(-1.0f64..1.0, 4 * 6)) {
            let Game { weights, mix, value } = solve(&rows, 4, 0..0);
            let mixed = |i: usize| rows.chunks(4).zip(&mix).map(|(row, z)| row[i] * z).sum::<f64>();
            prop_assert!((0..4).all(|i| mixed(i) <= value + 1e-9));
            prop_assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-9);
            let mut sums = [0.0f64; 4];
            let mut counts = [0.0f64; 6];
            for step in 1..=4000 {
                let best = (0..4).max_by(|&a, &b| sums[a].total_cmp(&sums[b])).unwrap();
                counts.iter_mut().zip(rows.chunks(4)).for_each(|(c, row)| *c += row[best]);
                let worst = (0..6).min_by(|&a, &b| counts[a].total_cmp(&counts[b])).unwrap();
                sums.iter_mut().zip(&rows[worst * 4..]).for_each(|(s, a)| *s += a);
                if step == 4000 {
                    let box_bound = sums.iter().fold(f64::NEG_INFINITY, |m, s| m.max(s / 4000.0));
                    prop_assert!(value <= box_bound + 1e-9, "{value} {box_bound}");
                    prop_assert!(value >= box_bound - 0.1, "{value} {box_bound}");
                }
            }
        }
    }
}
