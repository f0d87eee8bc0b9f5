//! Hypervolume: the volume that a set of points dominates below a reference point. It measures with one number how
//! good a front is.
//!
//! The points are swept as for the front. Each point adds the area that it newly covers in the plane of the second and
//! third objective, times its distance from the reference point along the first. Every term is positive, so nothing
//! cancels, and the sum is compensated (Neumaier). The method takes O(n log n) time. See Beume et al. 2009 for the
//! problem.

use super::front::{NotANumber, all_numbers};
use super::objectives::Objectives;
use super::ranking::{Ranked, Ranking};
use super::sieve::sieve;
use super::staircase::Staircase;
use rayon::prelude::*;

/// Volume of the space between the points and the reference point: everything that some point dominates and that
/// dominates the reference. All three objectives are minimized. A point that is not below the reference in all three
/// adds nothing.
///
/// # Errors
/// [`NotANumber`] with the first point that has a NaN.
///
/// ```
/// use armwright::pareto::hypervolume::hypervolume;
///
/// // two boxes of 1 x 2 x 2 and 2 x 1 x 2 share a cube of 1 x 1 x 2
/// let points = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// assert_eq!(hypervolume(&points, [2.0; 3]).unwrap(), 4.0 + 4.0 - 2.0);
/// ```
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
        // points come in ascending order of the first objective, so a newly covered area stays covered up to the
        // reference
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

/// The reference point below which fronts of studies are measured: 100 mm, 1 t, 0.1 Hz. It is the same for every study.
pub const REFERENCE: Objectives = Objectives { tip_deflection_m: 0.1, mass_kg: 1000.0, lowest_mode_hz: 0.1 };

/// Hypervolume of designs below [`REFERENCE`], in the natural logarithms of mass, deflection and lowest mode. With
/// logarithms a factor of two counts the same in each objective. A design with an objective that has no logarithm
/// adds nothing.
pub fn front_hypervolume(designs: impl Iterator<Item = Objectives>) -> f64 {
    let logarithms =
        |o: Objectives| [libm::log(o.mass_kg), libm::log(o.tip_deflection_m), -libm::log(o.lowest_mode_hz)];
    let points: Vec<[f64; 3]> = designs.map(logarithms).filter(|p| p.iter().all(|x| x.is_finite())).collect();
    hypervolume(&points, logarithms(REFERENCE)).unwrap_or_default()
}

/// A compensated (Neumaier) sum: the rounding errors are summed separately and added at the end.
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
#[path = "hypervolume_tests.rs"]
mod tests;
