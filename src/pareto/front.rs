//! Pareto fronts of three objectives, all to be minimized.
//!
//! A sieve first drops most dominated points. The rest are swept along the first objective, over a staircase of the
//! other two. The method is exact, keeps duplicates, and takes O(n log n) time for any set of points.

use super::ranking::{Ranked, Ranking};
use super::sieve::sieve;
use super::staircase::Staircase;
use rayon::prelude::*;

/// Number of significant decimal digits that count when two objectives are compared. Smaller differences are rounding
/// errors.
const DIGITS_COMPARED: i32 = 12;
/// Two numbers that differ by at least this fraction surely differ after rounding to twelve digits.
const SURELY_APART: f64 = 1e-10;

/// The error for a point with an objective that is not a number (NaN), which cannot be compared with others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "point {point} has an objective that is not a number: leave the point out, or find out what it should be"
)]
pub struct NotANumber {
    /// Index of the first point with a NaN.
    pub point: usize,
}

/// A number rounded to 12 significant decimal digits.
pub fn rounded(x: f64) -> f64 {
    if x == 0.0 || !x.is_finite() {
        return x;
    }
    let scale = 10f64.powi(DIGITS_COMPARED - 1 - libm::log10(x.abs()).floor() as i32);
    // the scale of numbers below 1e-297 overflows, so they are not rounded
    if scale.is_finite() { (x * scale).round() / scale } else { x }
}

/// Checks that no point has a NaN, because NaN cannot be compared. The error names the first point that has one.
pub(crate) fn all_numbers(points: &[[f64; 3]]) -> Result<(), NotANumber> {
    let faulty = points.par_iter().position_first(|p| p.iter().any(|x| x.is_nan()));
    faulty.map_or(Ok(()), |point| Err(NotANumber { point }))
}

/// The front: indices, ascending, of the points that no other point dominates. A point dominates another if it is
/// larger in no objective and smaller in at least one. Comparisons are exact, and equal points are all kept.
///
/// # Errors
/// [`NotANumber`] with the first point that has a NaN.
///
/// ```
/// use armwright::pareto::front::exact_front;
///
/// let points = [[1.0, 3.0, 0.0], [2.0, 2.0, 0.0], [2.0, 3.0, 0.0], [1.0, 3.0, 0.0]];
/// assert_eq!(exact_front(&points).unwrap(), [0, 1, 3], "point 2 is dominated, points 0 and 3 are equal");
/// assert!(exact_front(&[[f64::NAN, 0.0, 0.0]]).is_err());
/// ```
pub fn exact_front(points: &[[f64; 3]]) -> Result<Vec<usize>, NotANumber> {
    all_numbers(points)?;
    let sieved = sieve(points, 0.0);
    let left: Vec<[f64; 3]> = sieved.par_iter().map(|&i| points[i as usize]).collect();
    let mut front: Vec<usize> = swept(&left).into_iter().map(|i| sieved[i as usize] as usize).collect();
    front.par_sort_unstable();
    Ok(front)
}

/// The front after rounding to twelve digits, as sets of ties. The points of a set are equal to 12 digits in all three
/// objectives. Sets are sorted by the objectives, and the indices within a set ascend.
///
/// # Errors
/// [`NotANumber`] with the first point that has a NaN.
pub fn nondominated(points: &[[f64; 3]]) -> Result<Vec<Vec<usize>>, NotANumber> {
    all_numbers(points)?;
    let sieved = sieve(points, SURELY_APART);
    let left: Vec<[f64; 3]> = sieved.par_iter().map(|&i| points[i as usize].map(rounded)).collect();
    let groups = swept(&left);
    let tied = groups.chunk_by(|&a, &b| left[a as usize] == left[b as usize]);
    Ok(tied.map(|group| group.iter().map(|&i| sieved[i as usize] as usize).collect()).collect())
}

/// Indices of the points that no other point dominates, in the order in which the sweep visits the points. Equal points
/// follow each other, with ascending indices.
fn swept(points: &[[f64; 3]]) -> Vec<u32> {
    let Ranking { order, second } = Ranking::new(points);
    let mut stairs = Staircase::new(second.len());
    let mut kept: Vec<u32> = Vec::new();
    for Ranked { point: i, rank } in order {
        let point = &points[i as usize];
        // A point that was swept before is no larger in the first objective, so the other two objectives decide.
        if !stairs.covers(rank, point[2]) {
            stairs.insert(rank, point[2], |_, _| ());
            kept.push(i);
        } else if kept.last().is_some_and(|&last| points[last as usize] == *point) {
            kept.push(i);
        }
    }
    kept
}

/// Indices, ascending, of the points for which no other point is better by more than `slack` (relative) in all
/// three objectives.
pub fn not_clearly_beaten(points: &[[f64; 3]], slack: f64) -> Vec<usize> {
    let lowered = |x: f64| x - slack * x.abs();
    let Ranking { order, second } = Ranking::new(points);
    let reach = reaches(&second, lowered);
    let mut stairs = Staircase::new(second.len());
    let mut entered = order.iter().peekable();
    let mut kept = Vec::new();
    for &Ranked { point: i, rank } in &order {
        let [first, _, third] = points[i as usize].map(lowered);
        while let Some(next) = entered.next_if(|next| points[next.point as usize][0] <= first) {
            let (rank, third) = (next.rank, points[next.point as usize][2]);
            if !stairs.covers(rank, third) {
                stairs.insert(rank, third, |_, _| ());
            }
        }
        let beaten = reach[rank as usize].is_some_and(|rank| stairs.covers(rank, third));
        if !beaten {
            kept.push(i as usize);
        }
    }
    kept.sort_unstable();
    kept
}

/// For each rank of the second objective, the largest rank whose value is at most the lowered value of this rank, as
/// `lowered` computes it. `None` if there is no such rank.
fn reaches(second: &[f64], lowered: impl Fn(f64) -> f64) -> Vec<Option<u32>> {
    let mut below = 0;
    let count = second.iter().map(|&x| {
        while below < second.len() && second[below] <= lowered(x) {
            below += 1;
        }
        (below as u32).checked_sub(1)
    });
    count.collect()
}

#[cfg(test)]
#[path = "front_tests.rs"]
mod tests;
