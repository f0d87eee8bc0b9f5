//! Uncertainty that small compliances outside the model add to the parameters in it.
//!
//! Every joint and bearing is slightly compliant. Compliances that are too small to be worth their price are not in the
//! model, and those in the model take over a part of their effect. The linearized model with all of them gives the size
//! of this part. Before the readings are used, the prior standard deviation of a compliance outside the model is that
//! of the smallest compliance in it. With the readings, the compliances outside the model have the most probable values
//! `m` and the covariance matrix `P`. A number of the model with the variance `σ²` changes by `-L` per unit of these
//! compliances. Its variance then becomes `σ² + L P Lᵀ + (L m)²`.

use super::analysis::Positions;
use super::fitted::Sample;
use super::loads::CompliantPlace;
use super::normal::Factor;
use super::rows::normal;
use super::shape::Shape;
use crate::arm::BASE;
use crate::arm::effect::kind::ElasticRotation;
use crate::arm::structure::Piece;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

impl Positions {
    /// Widens the standard deviations of the model's numbers by the uncertainty that comes from compliances outside
    /// the model.
    pub(super) fn widen(&mut self) {
        let unnamed = self.unnamed_springs();
        let Some(usual) = self.stiffest_named().filter(|_| !unnamed.is_empty()) else { return };
        let Some(further) = self.further_variances(&unnamed, usual) else { return };
        let compliances = self.fitted.deviations.iter_mut().flatten();
        let own = self.fitted.number_deviations.iter_mut().chain(compliances);
        own.zip(&further).for_each(|(own, more)| *own = (own.powi(2) + more).sqrt());
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

    /// The smallest compliance \[rad/(N m)\] among those effects of the model that are springs with a single
    /// compliance; `None` if there are none.
    fn stiffest_named(&self) -> Option<f64> {
        let named = self.fitted.effects.iter().zip(&self.fitted.compliances);
        let springs = named.filter(|(e, own)| self.candidates[**e].shape == Shape::Spring && own.len() == 1);
        springs.map(|(_, own)| own[0]).filter(|c| *c > 0.0).reduce(f64::min)
    }

    /// Variance that the compliances outside the model add to every number of the model, those of the geometry first.
    /// `unnamed` are the indices of the candidates outside the model, and `usual` is the prior standard deviation of
    /// their compliances \[rad/(N m)\]. `None` if the equations are singular.
    fn further_variances(&self, unnamed: &[usize], usual: f64) -> Option<Vec<f64>> {
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
        let likely = match self.is_long() {
            true => none_negative(&seen, &(pull * (per / usual))) * usual,
            false => seen.solve(&(pull * (per / usual))).map(|c| c.max(0.0) * usual),
        };
        let variance = |row: usize| {
            let row = moves.row(row).transpose();
            row.dot(&seen.solve(&row)) * usual.powi(2) + row.dot(&likely).powi(2)
        };
        Some((0..own).map(variance).collect())
    }
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
