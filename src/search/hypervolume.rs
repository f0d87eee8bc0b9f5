//! Volume that a set of points dominates below a reference point: one number for how good a front is.
//!
//! The sweep of the front, once more: each point adds the area that it newly covers in the plane of second
//! and third objective, times its distance from the reference along the first. Every term is positive, so
//! nothing cancels; the sum is compensated (Neumaier). O(n log n). See Beume et al. 2009 for the problem.

use super::front::{NotANumber, all_numbers};
use super::sieve::sieve;
use super::ranking::{Ranked, Ranking};
use super::staircase::Staircase;
use rayon::prelude::*;

/// Volume of the part of space that is dominated by a point and dominates the reference point, all three
/// objectives to be made small. Points that are not below the reference in all three add nothing.
pub fn hypervolume(points: &[[f64; 3]], reference: [f64; 3]) -> Result<f64, NotANumber> {
    all_numbers(points)?;
    let inside = |p: &[f64; 3]| p.iter().zip(&reference).all(|(x, r)| x < r);
    let sieved = sieve(points, 0.0);
    let left: Vec<[f64; 3]> = sieved.par_iter().map(|&i| points[i as usize]).filter(inside).collect();
    let Ranking { order, second } = Ranking::new(&left);
    let mut stairs = Staircase::new(second.len());
    let mut volume = Sum::default();
    for Ranked { point, rank } in order {
        let [first, start, third] = left[point as usize];
        let mut height = stairs.best(rank).unwrap_or(reference[2]);
        if height <= third {
            continue;
        }
        let depth = reference[0] - first;
        let (mut from, mut open) = (start, true);
        stairs.insert(rank, third, |next, its_third| {
            let to = second[next as usize];
            volume.add((to - from) * (height - third) * depth);
            (from, height) = (to, its_third);
            open = its_third >= third;
        });
        if open {
            volume.add((reference[1] - from) * (height - third) * depth);
        }
    }
    Ok(volume.total())
}

/// A sum that carries what rounding took from it.
#[derive(Default)]
struct Sum {
    sum: f64,
    lost: f64,
}

impl Sum {
    fn add(&mut self, x: f64) {
        let sum = self.sum + x;
        self.lost += if self.sum.abs() >= x.abs() { (self.sum - sum) + x } else { (x - sum) + self.sum };
        self.sum = sum;
    }

    fn total(&self) -> f64 {
        self.sum + self.lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Counts unit cells below the reference that a point covers.
    fn counted(points: &[[u8; 3]], reference: u8) -> u32 {
        let cells = 0..reference;
        let covered = |cell: [u8; 3]| points.iter().any(|p| (0..3).all(|k| p[k] <= cell[k]));
        let mut count = 0;
        for a in cells.clone() {
            for b in cells.clone() {
                count += cells.clone().filter(|&c| covered([a, b, c])).count() as u32;
            }
        }
        count
    }

    proptest! {
        #[test]
        fn it_is_the_number_of_cells_covered(points in prop::collection::vec([0u8..9, 0u8..9, 0u8..9], 0..40)) {
            let numbers: Vec<[f64; 3]> = points.iter().map(|p| p.map(f64::from)).collect();
            prop_assert_eq!(hypervolume(&numbers, [7.0; 3]).unwrap(), f64::from(counted(&points, 7)));
        }

        #[test]
        fn it_does_not_depend_on_which_objective_is_swept(
            points in prop::collection::vec([-1.0f64..1.0, -1.0f64..1.0, -1.0f64..1.0], 0..60)
        ) {
            let turned: Vec<[f64; 3]> = points.iter().map(|&[a, b, c]| [c, a, b]).collect();
            let (one, other) = (
                hypervolume(&points, [0.9, 0.8, 0.7]).unwrap(),
                hypervolume(&turned, [0.7, 0.9, 0.8]).unwrap(),
            );
            prop_assert!((one - other).abs() <= 1e-14 * one, "{} {}", one, other);
        }
    }

    #[test]
    fn no_point_and_one_point() {
        assert_eq!(hypervolume(&[], [1.0; 3]).unwrap(), 0.0);
        assert_eq!(hypervolume(&[[1.0, 2.0, 3.0]], [2.0, 4.0, 6.0]).unwrap(), 6.0);
        assert_eq!(hypervolume(&[[1.0, 2.0, 3.0]], [2.0, 2.0, 6.0]).unwrap(), 0.0);
    }

    #[test]
    fn what_is_not_a_number_is_refused() {
        assert_eq!(hypervolume(&[[1.0, f64::NAN, 3.0]], [2.0; 3]), Err(NotANumber { point: 0 }));
    }
}
