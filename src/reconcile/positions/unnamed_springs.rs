//! Uncertainty that small compliances outside the model add to the parameters in it.
//!
//! Every joint and bearing is slightly compliant. Compliances that are too small to be worth their price are not in the
//! model, and those in the model take over a part of their effect. The linearized model with all of them gives the size
//! of this part. Before the readings are used, the prior standard deviation of a compliance outside the model is the
//! geometric mean of those in it: compliances of one arm scatter in ratios, and what is outside has a small effect, often
//! because its lever is short and not because it is stiff. The smallest compliance in the model would be too small a
//! deviation, and the smaller, the more compliances are named. With the readings, the compliances outside the model have the
//! most probable values `m` without a negative one, and the covariance matrix `P`. A number of the model with the variance
//! `σ²` changes by `-L` per unit of these compliances. Its variance then becomes `σ² + L P Lᵀ + (L m)²`.

use super::analysis::Positions;
use super::fitted::{Sample, misses};
use super::loads::CompliantPlace;
use super::normal::Factor;
use super::rows::{normal, normal_of_fit};
use super::shape::Shape;
use super::springs::best_springs;
use crate::arm::BASE;
use crate::arm::effect::kind::ElasticRotation;
use crate::arm::structure::Piece;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Derivatives of a quantity with respect to numbers of the model, each with the index of its number.
pub(super) type Gradient = Vec<(usize, f64)>;

/// What the readings say about compliances outside the model, and how these change the numbers of the model.
struct Unnamed {
    /// By how much each number of the model (row) changes per unit of each compliance outside the model (column), with the
    /// sign reversed.
    moves: DMatrix<f64>,
    /// The factorized inverse of the covariance matrix of these compliances, in units of `usual`.
    seen: Cholesky<f64, Dyn>,
    /// Their most probable values \[rad/(N m)\].
    likely: DVector<f64>,
    /// Standard deviation of each before the readings are used \[rad/(N m)\].
    usual: f64,
}

impl Unnamed {
    /// Variance that these compliances add to a quantity that depends on the model's numbers by the derivatives `gradient`,
    /// each given with the index of its number.
    fn variance(&self, gradient: &[(usize, f64)]) -> f64 {
        let none = DVector::zeros(self.likely.len());
        let moves =
            gradient.iter().fold(none, |sum, (number, g)| sum + self.moves.row(*number).transpose() * *g);
        moves.dot(&self.seen.solve(&moves)) * self.usual.powi(2) + moves.dot(&self.likely).powi(2)
    }
}

impl Positions {
    /// Widens the standard deviations of the model's numbers by the uncertainty that comes from compliances outside
    /// the model.
    pub(super) fn widen(&mut self) {
        let Some(unnamed) = self.unnamed() else { return };
        let compliances = self.fitted.deviations.iter_mut().flatten();
        let own = self.fitted.number_deviations.iter_mut().chain(compliances).enumerate();
        own.for_each(|(number, own)| *own = (own.powi(2) + unnamed.variance(&[(number, 1.0)])).sqrt());
    }

    /// Standard deviations of quantities that depend on the model's numbers: the numbers of the geometry first, then the
    /// compliances. Each quantity is given by its derivatives with respect to them, each with the index of its number. What the
    /// numbers have in common and what compliances outside the model add is counted.
    pub(super) fn deviations_of(&self, gradients: &[Gradient]) -> Vec<f64> {
        let all: Vec<&Sample> = self.samples.iter().collect();
        let equations = normal_of_fit(&all, &misses(&all, &self.fitted), &self.numbers, &self.fitted);
        let best = best_springs(&equations, self.numbers.len(), &self.fitted.compliances);
        let unnamed = self.unnamed();
        let deviation = |gradient: &Gradient| {
            let own = best.as_ref().map_or(f64::INFINITY, |best| best.deviation(gradient));
            let further = unnamed.as_ref().map_or(0.0, |unnamed| unnamed.variance(gradient));
            ((own * self.fitted.robust_factor).powi(2) + further).sqrt()
        };
        gradients.iter().map(deviation).collect()
    }

    /// The compliances outside the model; `None` if there are none, or if the model has no spring to compare them with.
    fn unnamed(&self) -> Option<Unnamed> {
        let unnamed = self.unnamed_springs();
        let usual = self.usual_named().filter(|_| !unnamed.is_empty())?;
        self.seen_outside(&unnamed, usual)
    }

    /// Indices of the candidates with a single compliance that are neither in the model nor contained in a frame of
    /// the model.
    fn unnamed_springs(&self) -> Vec<usize> {
        // tilt of the base and tilt of a first joint have the same effect
        let place = |c: &CompliantPlace| match (c.rotation, self.tree.pieces.first()) {
            (ElasticRotation::Tilt, Some(Piece::Joint(first))) if c.at == first.name => BASE.to_string(),
            _ => c.at.clone(),
        };
        let is_named = |c: usize| {
            let candidate = &self.candidates[c];
            self.fitted.effects.iter().any(|&e| {
                let named = &self.candidates[e];
                (named.rotation, place(named)) == (candidate.rotation, place(candidate))
                    || self.tree.contains(named, candidate)
            })
        };
        let is_spring = |c: &usize| {
            let candidate = &self.candidates[*c];
            self.considered[*c]
                && candidate.shape == Shape::Spring
                && candidate.rotation != ElasticRotation::Frame
        };
        (0..self.candidates.len()).filter(is_spring).filter(|c| !is_named(*c)).collect()
    }

    /// The geometric mean \[rad/(N m)\] of the compliances of those effects of the model that are springs with a single
    /// compliance; `None` if there are none.
    fn usual_named(&self) -> Option<f64> {
        let named = self.fitted.effects.iter().zip(&self.fitted.compliances);
        let springs = named.filter(|(e, own)| self.candidates[**e].shape == Shape::Spring && own.len() == 1);
        geometric_mean(springs.map(|(_, own)| own[0]).filter(|c| *c > 0.0))
    }

    /// What the readings say about the candidates with the indices `unnamed`, which are outside the model. `usual` is the
    /// prior standard deviation of their compliances \[rad/(N m)\]. `None` if the equations are singular.
    fn seen_outside(&self, unnamed: &[usize], usual: f64) -> Option<Unnamed> {
        let all: Vec<&Sample> = self.samples.iter().collect();
        let from_level = self.fitted.geometry.level_to_instrument();
        let gravity = &self.fitted.geometry.gravity;
        let equations = normal(&all, &self.numbers, &self.fitted, &|sample, _, columns| {
            for &candidate in unnamed {
                sample.deflection.per_compliance(candidate, gravity, |by| columns.push(from_level * by));
            }
        });
        let (own, count) = (equations.own, unnamed.len());
        let factor = Factor::new(&equations.curvature, &(0..own).collect::<Vec<_>>())?;
        let cross = equations.curvature.view((0, own), (own, count)).into_owned();
        let columns: Vec<DVector<f64>> =
            (0..count).map(|k| factor.solve(&cross.column(k).into_owned())).collect();
        let moves = DMatrix::from_columns(&columns);
        let whole = equations.curvature.view((own, own), (count, count));
        // in units of `usual`; the errors of the readings are scaled as in the robust fit
        let per = (usual / self.fitted.robust_factor).powi(2);
        let seen = (whole - cross.transpose() * &moves) * per + DMatrix::identity(count, count);
        let pull = equations.gradient.rows(own, count) - moves.transpose() * equations.gradient.rows(0, own);
        let seen = Cholesky::new(seen)?;
        // no compliance is negative
        let likely = none_negative(&seen, &(pull * (per / usual))) * usual;
        Some(Unnamed { moves, seen, likely, usual })
    }
}

/// The geometric mean of positive numbers; `None` if there are none.
fn geometric_mean(numbers: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = numbers.fold((0.0, 0.0), |(sum, count), x| (sum + libm::log(x), count + 1.0));
    (count > 0.0).then(|| libm::exp(sum / count))
}

/// The vector `x` without a negative entry at which `½ xᵀ A x - bᵀ x` is least, for a positive definite matrix `A` (the active
/// sets of Lawson and Hanson). Setting the negative entries of `A⁻¹ b` to zero gives another vector: two compliances that the
/// readings hardly tell apart have large values of either sign there, and the positive one alone explains nothing.
fn none_negative(a: &Cholesky<f64, Dyn>, b: &DVector<f64>) -> DVector<f64> {
    let a = a.l() * a.l().transpose();
    let mut x = DVector::zeros(b.len());
    let mut free: Vec<usize> = Vec::new();
    for _ in 0..3 * b.len() {
        let slope = b - &a * &x;
        let held = (0..b.len()).filter(|i| !free.contains(i));
        let Some(next) = held.max_by(|i, j| slope[*i].total_cmp(&slope[*j])) else { return x };
        if slope[next] <= 1e-9 * b.amax() {
            return x;
        }
        free.push(next);
        while let Some(best) = best_of_free(&a, b, &free) {
            // the part of the way to the best point on which each entry stays positive
            let part = |i: usize| if best[i] < 0.0 { x[i] / (x[i] - best[i]) } else { 1.0 };
            let parts: Vec<f64> = (0..x.len()).map(part).collect();
            let reach = free.iter().map(|i| parts[*i]).fold(1.0, f64::min);
            x += (&best - &x) * reach;
            if reach >= 1.0 {
                break;
            }
            free.retain(|i| parts[*i] > reach);
            (0..x.len()).filter(|i| !free.contains(i)).for_each(|i| x[i] = 0.0);
        }
    }
    x
}

/// The vector whose entries other than those with the indices `free` are zero and at which `½ xᵀ A x - bᵀ x` is least.
fn best_of_free(a: &DMatrix<f64>, b: &DVector<f64>, free: &[usize]) -> Option<DVector<f64>> {
    let own = DMatrix::from_fn(free.len(), free.len(), |i, j| a[(free[i], free[j])]);
    let found = Cholesky::new(own)?.solve(&DVector::from_fn(free.len(), |i, _| b[free[i]]));
    let mut out = DVector::zeros(b.len());
    free.iter().zip(found.iter()).for_each(|(i, x)| out[*i] = *x);
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::{Rng, SeedableRng};

    #[test]
    fn what_is_usual_does_not_fall_with_the_number_of_compliances_that_scatter() {
        assert_eq!(geometric_mean([].into_iter()), None);
        for count in [1, 3, 10] {
            let part = |k: i32| f64::from(k) / f64::from(count);
            let found = geometric_mean((-count..=count).map(|k| 3e-6 * libm::exp(part(k)))).expect("a mean");
            assert!((found / 3e-6 - 1.0).abs() < 1e-12, "{count}: {found}");
        }
    }

    #[test]
    fn compliances_outside_the_model_widen_a_quantity_by_what_they_may_be_and_by_what_they_are() {
        let moves = DMatrix::from_row_slice(2, 2, &[2.0, 0.0, -1.0, 3.0]);
        let seen = Cholesky::new(DMatrix::from_row_slice(2, 2, &[4.0, 0.0, 0.0, 25.0])).expect("definite");
        let unnamed = Unnamed { moves, seen, likely: DVector::from_vec(vec![0.1, 0.2]), usual: 10.0 };
        // of the first number plus twice the second: 0 and 6 per unit, with the variances 100/4 and 100/25
        let found = unnamed.variance(&[(0, 1.0), (1, 2.0)]);
        assert!((found - (36.0 * 4.0 + 1.2f64.powi(2))).abs() < 1e-9, "{found}");
    }

    #[test]
    fn the_best_vector_without_a_negative_entry_is_the_best_of_all_active_sets() {
        let mut dice = Xoshiro256PlusPlus::seed_from_u64(11);
        let mut next = || (dice.next_u64() >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
        for _ in 0..50 {
            let root = DMatrix::from_fn(6, 5, |_, _| next());
            let a = &root * root.transpose() * 100.0 + DMatrix::identity(6, 6);
            let b = DVector::from_fn(6, |_, _| 10.0 * next());
            let value = |x: &DVector<f64>| 0.5 * x.dot(&(&a * x)) - b.dot(x);
            let sets = (0..64usize).map(|set| (0..6).filter(|i| set >> i & 1 == 1).collect::<Vec<_>>());
            let points = sets.filter_map(|free| best_of_free(&a, &b, &free)).filter(|x| x.min() >= 0.0);
            let least = points.map(|x| value(&x)).fold(f64::INFINITY, f64::min);
            let found = none_negative(&Cholesky::new(a.clone()).expect("definite"), &b);
            assert!(
                found.min() >= 0.0 && (value(&found) - least).abs() <= 1e-9 * least.abs().max(1e-3),
                "{found}"
            );
        }
    }
}
