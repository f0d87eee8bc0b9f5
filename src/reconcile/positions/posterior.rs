//! The posterior distribution of the numbers of a model of positions, if compliances outside the model are possible
//! too.
//!
//! The fit states numbers `θ` of geometry and compliances. Around it the readings are linear in these numbers and in the
//! compliances `u` that the model leaves out. With the curvature `H` and the negative gradient `g` of half of chi-squared
//! over `(θ, u)`, the priors of `θ` included, there are two cases.
//!
//! *Nothing outside the model is compliant.* `θ` has the mean `δ = H_θθ⁻¹ g_θ` from the fitted values, and the
//! covariance `C = f² H_θθ⁻¹`. Here `f` is the sandwich factor of the robust fit. `δ` is zero only if the fit used all
//! the derivatives that `H` has.
//!
//! *Every place is compliant.*
//!
//! - The mean of `θ` is lower by `M u`, with `M = H_θθ⁻¹ H_θu`, because a fit without `u` ascribes this part of its
//!   effect to `θ`. With `θ` eliminated, the readings give `u` the precision `S = (H_uu - H_uθ M) / f²` and the pull
//!   `w = (g_u - H_uθ δ) / f²`. (The pull is the linear term of the logarithm of the density.)
//! - Let `M_c` and `C_c` be the rows of `M` and the covariance that belong to the compliances `c` in the model. These
//!   compliances and those outside it together have the precision `[C_c⁻¹, C_c⁻¹ M_c; M_cᵀ C_c⁻¹, S + M_cᵀ C_c⁻¹ M_c]`
//!   and the pull `[C_c⁻¹ c₀; M_cᵀ C_c⁻¹ c₀ + w]`. Here `c₀` is `c` plus its part of `δ`.
//! - No compliance is negative. The prior of each is the exponential distribution with the mean `τ`, which has the
//!   largest entropy of all distributions of a positive number with this mean. It subtracts `1/τ` from each pull. The
//!   compliances in the model have this prior too: a compliance is named if it looks large, and noise and neighbouring
//!   compliances make some look larger than they are.
//! - `τ` is the mean of the posterior means of all compliances, found by expectation maximization. It does not depend
//!   much on how many compliances are named.
//! - The mean and covariance of the compliances ([`NonNegative`]) give those of all other numbers, which are linear in them.
//!
//! The interval of a number covers both cases. It always contains the fitted value.

use super::non_negative::NonNegative;
use super::normal::Normal;
use super::springs::ConstrainedStep;
use crate::reconcile::model::estimate::Z_95;
use nalgebra::{Cholesky, DMatrix, DVector, SymmetricEigen};

/// Largest number of times that the mean compliance is computed again.
const MOST_ROUNDS: usize = 60;
/// The mean compliance has converged if it changes by less than this fraction.
const SETTLED: f64 = 1e-3;
/// A compliance that no weight loads keeps its exponential prior. A wide normal distribution is multiplied to it, so
/// that the equations stay regular. Its standard deviation is this multiple of the mean.
const CUT: f64 = 30.0;

/// Posterior distribution of the numbers of a model, as changes from the fitted values.
pub(super) struct Posterior {
    /// Mean of each number if nothing outside the model is compliant.
    mean: DVector<f64>,
    /// Covariance matrix of the numbers if nothing outside the model is compliant.
    covariance: DMatrix<f64>,
    /// Whether each number is fixed at its constraint.
    is_fixed: Vec<bool>,
    everywhere: Option<Everywhere>,
}

/// The case that every place is compliant. Compliances in the model come first.
struct Everywhere {
    /// By how much each number of the model (row) changes per unit of each entry of `sizes` (column).
    moves: DMatrix<f64>,
    /// The compliances \[rad/(N m)\]. For those in the model, the mean is counted from the mean that they have if
    /// nothing outside the model is compliant.
    sizes: NonNegative,
    /// Covariance matrix of the numbers of the model if all compliances are known.
    left: DMatrix<f64>,
}

impl Posterior {
    /// The posterior distribution that follows from the normal equations. `best` is the step to the minimum, and
    /// `robust` the sandwich factor. Columns after those of the model belong to compliances outside it. `named` lists
    /// the compliances of the model that have the same prior as these, each with the index of its number \[rad/(N m)\].
    pub(super) fn new(
        equations: &Normal,
        best: &ConstrainedStep,
        robust: f64,
        named: &[(usize, f64)],
    ) -> Self {
        let own = equations.own;
        let unit = |i: usize| DVector::from_fn(own, |k, _| if k == i { 1.0 } else { 0.0 });
        let columns: Vec<DVector<f64>> = (0..own).map(|i| best.answer(&unit(i))).collect();
        let inverse = DMatrix::from_columns(&columns);
        let mut out = Self {
            mean: DVector::from_column_slice(&best.step),
            covariance: &inverse * (robust * robust),
            is_fixed: (0..own).map(|i| inverse[(i, i)] <= 0.0).collect(),
            everywhere: None,
        };
        out.everywhere =
            Outside::new(equations, best, robust).and_then(|outside| Everywhere::new(&out, outside, named));
        out
    }

    /// Distances of the lower and the upper end of the interval of a quantity from its fitted value, each divided by
    /// [`Z_95`]. The quantity has the derivatives `gradient` with respect to numbers of the model, each given with the
    /// index of its number. Infinite if all these numbers are fixed at their constraints.
    pub(super) fn reach(&self, gradient: &[(usize, f64)]) -> [f64; 2] {
        if gradient.iter().all(|(number, _)| self.is_fixed[*number]) {
            return [f64::INFINITY; 2];
        }
        let mean: f64 = gradient.iter().map(|(i, g)| g * self.mean[*i]).sum();
        let [low, high] = ends(mean, along(&self.covariance, gradient));
        let [lower, higher] = self.everywhere.as_ref().map_or([low, high], |everywhere| {
            let (moved, variance) = everywhere.of(gradient);
            ends(mean + moved, variance)
        });
        [-low.min(lower).min(0.0) / Z_95, high.max(higher).max(0.0) / Z_95]
    }
}

/// Variance of the quantity with the derivatives `gradient`, if the numbers have the covariance matrix `covariance`.
fn along(covariance: &DMatrix<f64>, gradient: &[(usize, f64)]) -> f64 {
    let row = |(i, g): &(usize, f64)| gradient.iter().map(|(j, h)| g * h * covariance[(*i, *j)]).sum::<f64>();
    gradient.iter().map(row).sum()
}

/// The ends of the 95 % interval of a number with this mean and variance.
fn ends(mean: f64, variance: f64) -> [f64; 2] {
    let reach = Z_95 * variance.max(0.0).sqrt();
    [mean - reach, mean + reach]
}

/// What the readings say about the compliances outside the model.
struct Outside {
    /// By how much each number of the model (row) is lower per unit of each compliance outside it (column).
    moves: DMatrix<f64>,
    precision: DMatrix<f64>,
    pull: DVector<f64>,
}

impl Outside {
    /// `None` if there are no compliances outside the model, or if the equations overflow.
    fn new(equations: &Normal, best: &ConstrainedStep, robust: f64) -> Option<Self> {
        let own = equations.own;
        let count = equations.gradient.len() - own;
        if count == 0 {
            return None;
        }
        let cross = equations.curvature.view((0, own), (own, count)).into_owned();
        let mut moves = DMatrix::zeros(own, count);
        (0..count).for_each(|k| moves.set_column(k, &best.answer(&cross.column(k).into_owned())));
        let alone = equations.curvature.view((own, own), (count, count));
        let precision = not_negative((alone - cross.transpose() * &moves) / (robust * robust))?;
        let step = DVector::from_column_slice(&best.step);
        let pull = (equations.gradient.rows(own, count) - cross.transpose() * step) / (robust * robust);
        Some(Self { moves, precision, pull })
    }
}

/// The matrix with its negative eigenvalues, which come from rounding, set to zero. `None` if it has an entry that is
/// not finite.
fn not_negative(matrix: DMatrix<f64>) -> Option<DMatrix<f64>> {
    if matrix.iter().any(|entry| !entry.is_finite()) {
        return None;
    }
    let mut eigen = SymmetricEigen::new((&matrix + matrix.transpose()) * 0.5);
    eigen.eigenvalues.apply(|e| *e = e.max(0.0));
    Some(eigen.recompose())
}

impl Everywhere {
    /// `alone` is the posterior distribution if nothing outside the model is compliant. `named` is as in
    /// [`Posterior::new`]. `None` if `named` is empty, or if the equations are singular.
    fn new(alone: &Posterior, outside: Outside, named: &[(usize, f64)]) -> Option<Self> {
        let (inside, count) = (named.len(), outside.pull.len());
        if inside == 0 {
            return None;
        }
        let all = alone.mean.len();
        let of_named = DMatrix::from_fn(inside, all, |i, k| alone.covariance[(named[i].0, k)]);
        let own = DMatrix::from_fn(inside, inside, |i, j| of_named[(i, named[j].0)]);
        let inverse = Cholesky::new(own)?.inverse();
        let moves = DMatrix::from_fn(inside, count, |i, k| outside.moves[(named[i].0, k)]);
        let expected = DVector::from_fn(inside, |i, _| named[i].1 + alone.mean[named[i].0]);
        let across = &inverse * &moves;
        let mut precision = DMatrix::zeros(inside + count, inside + count);
        precision.view_mut((0, 0), (inside, inside)).copy_from(&inverse);
        precision.view_mut((0, inside), (inside, count)).copy_from(&across);
        precision.view_mut((inside, 0), (count, inside)).copy_from(&across.transpose());
        let further = outside.precision + moves.transpose() * &across;
        precision.view_mut((inside, inside), (count, count)).copy_from(&further);
        let mut pull = DVector::zeros(inside + count);
        pull.rows_mut(0, inside).copy_from(&(&inverse * &expected));
        pull.rows_mut(inside, count).copy_from(&(across.transpose() * &expected + outside.pull));
        let first = named.iter().map(|(_, c)| c).sum::<f64>() / inside as f64;
        let mut sizes = exchangeable(&precision, &pull, first)?;
        let mut middle = sizes.mean.rows_mut(0, inside);
        middle -= expected;
        // the regression of all numbers on the named compliances, and the covariance that is left
        let follow = of_named.transpose() * &inverse;
        let mut all_moves = DMatrix::zeros(all, inside + count);
        all_moves.view_mut((0, 0), (all, inside)).copy_from(&follow);
        let further = &follow * &moves - outside.moves;
        all_moves.view_mut((0, inside), (all, count)).copy_from(&further);
        Some(Self { moves: all_moves, sizes, left: &alone.covariance - follow * of_named })
    }

    /// By how much the mean of the quantity with the derivatives `gradient` is larger than if nothing outside the model
    /// is compliant, and the variance of the quantity.
    fn of(&self, gradient: &[(usize, f64)]) -> (f64, f64) {
        let mut moves = DVector::zeros(self.sizes.mean.len());
        gradient.iter().for_each(|(number, g)| moves += self.moves.row(*number).transpose() * *g);
        let variance = moves.dot(&(&self.sizes.covariance * &moves)) + along(&self.left, gradient).max(0.0);
        (moves.dot(&self.sizes.mean), variance)
    }
}

/// Posterior distribution of positive numbers that have the same exponential prior. The readings give them this
/// precision and this pull. The mean of the prior is found as the mean of the numbers; `first` is the first guess of
/// it. `None` if the equations are singular.
fn exchangeable(precision: &DMatrix<f64>, pull: &DVector<f64>, first: f64) -> Option<NonNegative> {
    let mut usual = first;
    let mut found = exponential(precision, pull, usual)?;
    for _ in 1..MOST_ROUNDS {
        let next = found.mean.mean();
        if (next / usual - 1.0).abs() < SETTLED {
            break;
        }
        usual = next;
        found = exponential(precision, pull, usual)?;
    }
    Some(found)
}

/// Posterior distribution of positive numbers that have an exponential prior with the mean `usual`. The readings give
/// them this precision and this pull.
fn exponential(precision: &DMatrix<f64>, pull: &DVector<f64>, usual: f64) -> Option<NonNegative> {
    let cut = DMatrix::from_diagonal_element(pull.len(), pull.len(), CUT.powi(-2));
    let own = NonNegative::new(precision * (usual * usual) + cut, &(pull * usual).add_scalar(-1.0))?;
    Some(own.times(usual))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Precision and pull of independent numbers with the given values and standard deviations. The readings say
    /// nothing about a number whose deviation is infinite.
    fn known(numbers: &[(f64, f64)]) -> (DMatrix<f64>, DVector<f64>) {
        let precisions = DVector::from_iterator(numbers.len(), numbers.iter().map(|(_, sd)| sd.powi(-2)));
        let values = DVector::from_iterator(numbers.len(), numbers.iter().map(|(value, _)| *value));
        (DMatrix::from_diagonal(&precisions), precisions.component_mul(&values))
    }

    #[test]
    fn a_compliance_that_the_readings_do_not_show_is_as_large_as_the_others() {
        for named in [vec![1e-6, 3e-6], vec![1e-6, 3e-6, 1.5e-6, 2.5e-6, 0.5e-6, 3.5e-6]] {
            let count = named.len();
            let mut numbers: Vec<(f64, f64)> = named.into_iter().map(|c| (c, 1e-8)).collect();
            numbers.extend([(0.0, f64::INFINITY); 2]);
            let (precision, pull) = known(&numbers);
            let found = exchangeable(&precision, &pull, 5e-6).expect("regular");
            // an exponential distribution has its mean as standard deviation; the cut takes a little of it
            for k in count..count + 2 {
                assert!((found.mean[k] / 2e-6 - 1.0).abs() < 0.02, "{}", found.mean);
                assert!((found.covariance[(k, k)].sqrt() / 2e-6 - 1.0).abs() < 0.02, "{}", found.covariance);
            }
        }
    }

    /// A model with the compliance `c` = 2 ± 0.01 and one number of the geometry that follows it, and a compliance outside that
    /// the readings do not show apart from `c`: `c` is lower by `0.5 u`. So `c = 2 - 0.5 u`, and `u` is exponential up to 4.
    #[test]
    fn an_interval_reaches_over_the_model_alone_and_the_model_with_what_it_lacks() {
        let covariance = DMatrix::from_row_slice(2, 2, &[1e-4, 2e-4, 2e-4, 5e-4]);
        let alone =
            Posterior { mean: DVector::zeros(2), covariance, is_fixed: vec![false, false], everywhere: None };
        let outside = Outside {
            moves: DMatrix::from_row_slice(2, 1, &[0.5, 0.0]),
            precision: DMatrix::zeros(1, 1),
            pull: DVector::zeros(1),
        };
        let everywhere = Everywhere::new(&alone, outside, &[(0, 2.0)]).expect("regular");
        let found = Posterior { everywhere: Some(everywhere), ..alone };
        // by a sum over u from 0 to 4, with the density exp(-(u + c)/τ) = exp(-(u/2 + 2)/τ), τ = (mean u + mean c)/2
        let mut usual: f64 = 1.0;
        let (mut mean, mut deviation) = (0.0, 0.0);
        for _ in 0..100 {
            let points = (0..4000).map(|k| (k as f64 + 0.5) * 1e-3);
            let of =
                |power: i32| points.clone().map(|u| u.powi(power) * (-0.5 * u / usual).exp()).sum::<f64>();
            mean = of(1) / of(0);
            deviation = (of(2) / of(0) - mean * mean).sqrt();
            usual = 0.5 * (mean + 2.0 - 0.5 * mean);
        }
        let [below, above] = found.reach(&[(0, 1.0)]);
        // not below the model alone; the end of a distribution that ends at 2 is estimated by its deviation
        assert!((0.01..0.3).contains(&above), "{above}");
        let expected = 0.5 * mean / Z_95 + 0.5 * deviation;
        // of two restrictions of nearly one number, expectation propagation makes a little too much
        assert!((0.95..1.2).contains(&(below / expected)), "{below} {expected}");
        // the geometry: u alone does not move it, so it keeps its own interval
        let [below, above] = found.reach(&[(1, 1.0)]);
        assert!(
            (below / 5e-4f64.sqrt() - 1.0).abs() < 1e-2 && (above / 5e-4f64.sqrt() - 1.0).abs() < 1e-2,
            "{below} {above}"
        );
    }
}
