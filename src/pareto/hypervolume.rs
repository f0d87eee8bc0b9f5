//! Volume that a set of points dominates below a reference point: one number for how good a front is.
//!
//! The sweep of the front, once more: each point adds the area that it newly covers in the plane of second
//! and third objective, times its distance from the reference along the first. Every term is positive, so
//! nothing cancels; the sum is compensated (Neumaier). O(n log n). See Beume et al. 2009 for the problem.

use super::front::{NotANumber, all_numbers};
use super::objectives::Objectives;
use super::ranking::{Ranked, Ranking};
use super::sieve::sieve;
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

/// The point below which a study's front is measured, the same for every study: 100 mm, 1 t, 0.1 Hz.
pub const REFERENCE: Objectives = Objectives { tip_deflection_m: 0.1, mass_kg: 1000.0, lowest_mode_hz: 0.1 };

/// Hypervolume of designs below [`REFERENCE`] in the natural logarithms of mass, deflection and lowest mode, so that
/// halving any of them counts alike; designs with an objective that has no logarithm add nothing.
pub fn front_hypervolume(designs: impl Iterator<Item = Objectives>) -> f64 {
    let logarithms = |o: Objectives| [o.mass_kg.ln(), o.tip_deflection_m.ln(), -o.lowest_mode_hz.ln()];
    let points: Vec<[f64; 3]> = designs.map(logarithms).filter(|p| p.iter().all(|x| x.is_finite())).collect();
    hypervolume(&points, logarithms(REFERENCE)).unwrap_or_default()
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
    fn a_design_that_halves_an_objective_adds_the_same_whichever_it_is() {
        let design = |kg: f64, mm: f64, hz: f64| Objectives {
            tip_deflection_m: mm / 1e3,
            mass_kg: kg,
            lowest_mode_hz: hz,
        };
        let one = |o: Objectives| front_hypervolume([o].into_iter());
        let cube = one(design(100.0, 10.0, 1.0));
        assert!((cube - 10f64.ln().powi(3)).abs() < 1e-12);
        for better in [design(50.0, 10.0, 1.0), design(100.0, 5.0, 1.0), design(100.0, 10.0, 2.0)] {
            assert!((one(better) / cube - 20f64.ln() / 10f64.ln()).abs() < 1e-12);
        }
        assert_eq!(one(design(100.0, 10.0, f64::INFINITY)), 0.0);
    }

    #[test]
    fn what_is_not_a_number_is_refused() {
        assert_eq!(hypervolume(&[[1.0, f64::NAN, 3.0]], [2.0; 3]), Err(NotANumber { point: 0 }));
    }
}
