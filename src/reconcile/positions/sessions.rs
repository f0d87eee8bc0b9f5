//! Finds sessions: before some row of the file, a point was at another place on the tool, or the instrument or the base
//! stood elsewhere.
//!
//! Between two sessions a reflector is put back slightly differently, or the instrument or the base is moved. Every row
//! is tried as the first of a new session, by the gain of the linearized model. The earlier rows then have an offset or
//! a placement of their own.
//!
//! The gain is `½ bᵀ S⁻¹ b` with
//! - `S = Σ s sᵀ - Cᵀ C`,
//! - `b = Σ s e - Cᵀ W g`,
//! - `C = Σ W m sᵀ`.
//!
//! Here `A` is the curvature matrix of the model, `W` its whitening factor (`A⁻¹ = WᵀW`), and `g` its negative gradient
//! over all rows. The sums are over the earlier rows. For each row, `s` are the derivatives of its position with
//! respect to the offset, `m` those with respect to the model's numbers, and `e` is its error. All sums grow row by
//! row, so one pass tries every row. The computing time is proportional to the number of rows, and the memory does not
//! depend on it.

use super::analysis::Positions;
use super::fit::fit;
use super::fitted::{Fitted, Sample, misses, readings};
use super::kinematics::Number;
use super::moved::{Boundary, Kind, Moved};
use super::normal::Factor;
use super::points::Point;
use super::rows::{in_blocks, normal_of_fit};
use super::structure::squares;
use crate::mechanics::product::Panels;
use nalgebra::{Cholesky, DMatrix, DVector};
use rayon::prelude::*;
use std::ops::Range;

/// Smallest number of positions that a session must have on either side of its boundary.
const FEWEST_PER_SIDE: usize = 5;
/// A matrix is regular if the smallest entry on the diagonal of its Cholesky factor is more than this times the largest.
const REGULAR: f64 = 0.01;
/// Largest number of sessions that are found, beyond the first.
const MOST_SESSIONS: usize = 6;

/// A fitted model in which the rows before the row `first` have become a session with a placement of its own.
pub(super) struct Split {
    samples: Vec<Sample>,
    numbers: Vec<Number>,
    pub fitted: Fitted,
    moved: Moved,
    new: Moved,
    pub first: usize,
    gain: f64,
}

/// Factorized normal equations and gradient of a model before its rows are divided into sessions.
pub(super) struct Whole {
    factor: Factor,
    gradient: DVector<f64>,
}

impl Positions {
    /// Adds sessions to the model, as long as another session is worth its price, and returns how many were added.
    /// `tools_free` and `base_free` say whether points on the tool, and instrument or base, can have been moved.
    pub(crate) fn find_sessions(&mut self, tools_free: bool, base_free: bool) -> usize {
        let mut found = 0;
        while found < MOST_SESSIONS {
            let kinds = self.kinds(tools_free, base_free);
            let Some(whole) = self.whole() else { break };
            let firsts: Vec<_> = kinds.par_iter().map(|&moved| self.best_first(moved, &whole)).collect();
            let splits = kinds.iter().zip(firsts).filter_map(|(&moved, first)| {
                let (first, gain) = first?;
                let price = self.session_price(moved.numbers().len(), kinds.len());
                self.may_rise(gain, price).then(|| self.split(moved, first, kinds.len()))
            });
            let Some(best) = splits.filter(|s| s.gain > 0.0).max_by(|a, b| a.gain.total_cmp(&b.gain)) else {
                break;
            };
            self.take(best, false);
            found += 1;
        }
        found
    }

    /// Starts a new session at each of the places `at` (what was moved, and the first row), whether or not the fit
    /// gets better by it. `declared` says whether campaign.json states these boundaries.
    pub(crate) fn divide(&mut self, at: &[(Kind, usize)], declared: bool) {
        for &(kind, first) in at {
            let of_kind = |s: &&Sample| s.index >= first && self.is_of(s, kind);
            let Some(moved) = self.samples.iter().find(of_kind).map(|s| kind.label(s)) else { continue };
            if self.samples[..first].iter().any(|s| moved.has(s)) {
                let split = self.split(moved, first, 1);
                self.take(split, declared);
            }
        }
    }

    /// Whether a sample is affected by a move of `kind`. A sample is affected by a move of its point on the tool, and
    /// every sample by a move of the instrument or base.
    pub(super) fn is_of(&self, sample: &Sample, kind: Kind) -> bool {
        let same = |a: &Point, b: &Point| (a.arm, &a.name) == (b.arm, &b.name);
        match kind {
            Kind::Point(p) => same(&self.points[sample.point], &self.points[p]),
            Kind::Station => true,
        }
    }

    /// The labels of everything that may have been moved: all points if tool offsets are free (`tools_free`), all
    /// set-ups of instrument and base if the base placement is free (`base_free`).
    pub(super) fn kinds(&self, tools_free: bool, base_free: bool) -> Vec<Moved> {
        let points = (0..self.points.len()).filter(|_| tools_free).map(Moved::Point);
        let stations = (0..self.fitted.geometry.stations.len()).filter(|_| base_free).map(Moved::Station);
        points.chain(stations).collect()
    }

    /// Price of a session whose placement has `numbers` parameters \[ln of the likelihood\]. It charges for these
    /// parameters, and for having examined every row for `kinds` things that may have been moved.
    pub(super) fn session_price(&self, numbers: usize, kinds: usize) -> f64 {
        let readings = readings(&self.samples) as f64;
        0.5 * numbers as f64 * libm::log(readings) + libm::log(readings * kinds as f64) + 3.0
    }

    pub(super) fn whole(&self) -> Option<Whole> {
        let all: Vec<&Sample> = self.samples.iter().collect();
        let normal = normal_of_fit(&all, &misses(&all, &self.fitted), &self.numbers, &self.fitted);
        let own: Vec<usize> = (0..normal.own).collect();
        Some(Whole { factor: Factor::new(&normal.curvature, &own)?, gradient: normal.gradient })
    }

    /// The best first row, counted from 0, for a new session that begins because `moved` was moved, with the rise of
    /// the logarithm of the likelihood that the linearized model expects. `None` if no row has enough rows before and
    /// after it.
    pub(super) fn best_first(&self, moved: Moved, whole: &Whole) -> Option<(usize, f64)> {
        let rows: Vec<&Sample> = self.samples.iter().filter(|s| moved.has(s)).collect();
        let inside = FEWEST_PER_SIDE..rows.len().saturating_sub(FEWEST_PER_SIDE);
        let numbers = [self.numbers.as_slice(), &moved.numbers()].concat();
        let offset = self.numbers.len()..numbers.len();
        let mut earlier = Earlier::new(whole, offset);
        let mut best: Option<(usize, f64)> = None;
        let mut at = 0;
        in_blocks(&rows[..inside.end], &numbers, &self.fitted, |block, slopes, errors| {
            let whitened = earlier.whitened(slopes);
            for (k, sample) in block.iter().enumerate() {
                if inside.contains(&at) {
                    let gain = earlier.gain();
                    if best.is_none_or(|(_, most)| gain >= most) {
                        best = Some((sample.index, gain));
                    }
                }
                earlier.add(3 * k, &whitened, slopes, errors);
                at += 1;
            }
        });
        best
    }

    /// Divides a session: fits the model in which those rows before `first` that have the label `moved` get a
    /// placement of their own. The gain of the result is the [telling part](telling_part) of the rise of the logarithm of
    /// the likelihood, less the price of the session.
    pub(super) fn split(&self, moved: Moved, first: usize, kinds: usize) -> Split {
        let mut start = self.fitted.clone();
        let geometry = &mut start.geometry;
        let new = match moved {
            Moved::Point(p) => {
                geometry.tools_m.push(geometry.tools_m[p]);
                Moved::Point(geometry.tools_m.len() - 1)
            }
            Moved::Station(s) => {
                geometry.stations.push(geometry.stations[s]);
                Moved::Station(geometry.stations.len() - 1)
            }
        };
        let mut samples = self.samples.clone();
        moved.relabel(&mut samples, first, new);
        let mut numbers = self.numbers.clone();
        numbers.extend(new.numbers());
        let all: Vec<&Sample> = samples.iter().collect();
        let fitted = fit(&all, &numbers, &start.effects, &start);
        let price = self.session_price(new.numbers().len(), kinds);
        let rise = fitted.ln_likelihood - self.fitted.ln_likelihood;
        let gain = telling_part(&fitted, &numbers, &samples, new.numbers().len()) * rise - price;
        Split { samples, numbers, fitted, moved, new, first, gain }
    }

    fn take(&mut self, split: Split, declared: bool) {
        (self.samples, self.numbers, self.fitted) = (split.samples, split.numbers, split.fitted);
        let kind = match split.moved {
            Moved::Point(p) => {
                let point = self.points[p].clone();
                // the point in its last session, which the model without this boundary has too
                let same = |other: &Point| (other.arm, &other.name) == (point.arm, &point.name);
                let own = self.points.iter().position(same).unwrap_or(p);
                self.points.push(Point { before_row: Some(split.first + 1), ..point });
                Kind::Point(own)
            }
            Moved::Station(_) => Kind::Station,
        };
        self.sessions.push(Boundary { kind, earlier: split.new, first: split.first, declared });
    }
}

/// The fraction of a rise of the logarithm of the likelihood that is not due to chance, if `new` further numbers of the
/// model `fitted` caused the rise: `(n - p + k/2 - 1)/n` (Bartlett), at least 0. Here `n` is the number of readings,
/// `p` the number of parameters that the readings determine, and `k` the number of new parameters (`new`).
///
/// The scale of the errors is fitted. If there are few more readings than numbers, the scale falls with every further
/// number that is free, and the likelihood rises by more than half of chi-squared.
pub(super) fn telling_part(fitted: &Fitted, numbers: &[Number], samples: &[Sample], new: usize) -> f64 {
    let count = readings(samples) as f64;
    let left = count - determined(fitted, numbers);
    ((left + 0.5 * new as f64 - 1.0) / count).max(0.0)
}

/// How many numbers of the model `fitted` the readings determine. A number whose prior determines it hardly counts.
fn determined(fitted: &Fitted, numbers: &[Number]) -> f64 {
    let free = numbers.iter().zip(&fitted.number_deviations).map(|(number, deviation)| {
        let left = deviation / fitted.robust_factor / number.prior();
        (1.0 - left * left).max(0.0)
    });
    free.sum::<f64>() + fitted.compliances.iter().map(Vec::len).sum::<usize>() as f64
}

/// Sums over the rows before some row. They give the gain if these rows had an offset (a placement) of their own.
struct Earlier {
    /// The whitening factor `W`, with a column of zeros for each number of the offset. A product with the transpose of the
    /// slopes whitens those of the model's numbers.
    whitening: Panels,
    /// Indices of the columns of the slopes that belong to the offset.
    columns: Range<usize>,
    /// Derivatives of the logarithm of the likelihood of all rows with respect to the model's numbers, multiplied by
    /// the whitening factor `W`.
    gradient: DVector<f64>,
    cross: DMatrix<f64>,
    curvature: DMatrix<f64>,
    slope: DVector<f64>,
}

impl Earlier {
    /// Sums over no rows, for an offset whose numbers have the columns `columns` of the slopes.
    fn new(whole: &Whole, columns: Range<usize>) -> Self {
        let (numbers, width) = (whole.gradient.len(), columns.len());
        let mut gradient = DMatrix::from_columns(std::slice::from_ref(&whole.gradient));
        whole.factor.whiten(&mut gradient);
        let mut whitening = DMatrix::identity(numbers, numbers);
        whole.factor.whiten(&mut whitening);
        Self {
            whitening: Panels::of_rows(&whitening.insert_columns(columns.start, width, 0.0)),
            columns,
            gradient: gradient.column(0).into_owned(),
            cross: DMatrix::zeros(numbers, width),
            curvature: DMatrix::zeros(width, width),
            slope: DVector::zeros(width),
        }
    }

    /// The derivatives `slopes` with respect to the model's numbers, multiplied by `W`: a column for each row of `slopes`.
    fn whitened(&self, slopes: &DMatrix<f64>) -> DMatrix<f64> {
        self.whitening.times(slopes.transpose().as_view())
    }

    /// Adds the equations of one position to the sums. They are three rows of `slopes` and `errors`, and columns of
    /// `whitened`, from `first` on.
    fn add(&mut self, first: usize, whitened: &DMatrix<f64>, slopes: &DMatrix<f64>, errors: &DMatrix<f64>) {
        let offset = slopes.view((first, self.columns.start), (3, self.columns.len()));
        self.cross.gemm(1.0, &whitened.columns(first, 3), &offset, 1.0);
        self.curvature.gemm_tr(1.0, &offset, &offset, 1.0);
        self.slope.gemv_tr(1.0, &offset, &errors.fixed_view::<3, 1>(first, 0), 1.0);
    }

    /// Rise of the logarithm of the likelihood, by the linearized model, if the rows added so far had an offset of
    /// their own.
    fn gain(&self) -> f64 {
        let left = &self.curvature - self.cross.tr_mul(&self.cross);
        let gradient = &self.slope - self.cross.tr_mul(&self.gradient);
        0.5 * regular_square(&left, &gradient).unwrap_or_else(|| squares(&left, &gradient).0)
    }
}

/// The statistic `bᵀ S⁻¹ b`; `None` if the matrix is singular, or nearly so.
fn regular_square(s: &DMatrix<f64>, b: &DVector<f64>) -> Option<f64> {
    let factor = Cholesky::new(s.clone())?;
    let pivots = factor.l_dirty().diagonal();
    (pivots.min() > REGULAR * pivots.max()).then(|| b.dot(&factor.solve(b)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::{Rng, SeedableRng};

    const ROWS: usize = 40;
    const NUMBERS: usize = 7;

    /// The gain by its definition, for comparison: one set of normal equations for all rows, in which the columns of
    /// the offset are zero from the row `first` on.
    fn dense_gain(rows: &[(Vec<Vector3<f64>>, Vector3<f64>)], width: usize, first: usize) -> f64 {
        let column = |r: usize, j: usize| {
            let is_on = j < NUMBERS || r / 3 < first;
            if is_on { rows[r / 3].0[j][r % 3] } else { 0.0 }
        };
        let x = DMatrix::from_fn(3 * ROWS, NUMBERS + width, column);
        let e = DVector::from_fn(3 * ROWS, |r, _| rows[r / 3].1[r % 3]);
        let fall = |x: &DMatrix<f64>| {
            let gradient = x.tr_mul(&e);
            0.5 * gradient.dot(&(x.tr_mul(x).try_inverse().expect("regular") * &gradient))
        };
        fall(&x) - fall(&x.columns(0, NUMBERS).into_owned())
    }

    #[test]
    fn one_pass_gives_every_row_the_gain_of_the_dense_equations() {
        let mut dice = Xoshiro256PlusPlus::seed_from_u64(7);
        let mut next = || (dice.next_u64() >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
        for width in [3, 6] {
            let mut vector = || Vector3::new(next(), next(), next());
            let rows: Vec<(Vec<Vector3<f64>>, Vector3<f64>)> =
                (0..ROWS).map(|_| ((0..NUMBERS + width).map(|_| vector()).collect(), vector())).collect();
            let x = DMatrix::from_fn(3 * ROWS, NUMBERS, |r, j| rows[r / 3].0[j][r % 3]);
            let e = DVector::from_fn(3 * ROWS, |r, _| rows[r / 3].1[r % 3]);
            let all: Vec<usize> = (0..NUMBERS).collect();
            let factor = Factor::new(&x.tr_mul(&x), &all).expect("regular");
            let whole = Whole { factor, gradient: x.tr_mul(&e) };
            let mut earlier = Earlier::new(&whole, NUMBERS..NUMBERS + width);
            let slopes = DMatrix::from_fn(3 * ROWS, NUMBERS + width, |r, j| rows[r / 3].0[j][r % 3]);
            let errors = DMatrix::from_fn(3 * ROWS, 1, |r, _| rows[r / 3].1[r % 3]);
            let whitened = earlier.whitened(&slopes);
            for first in 0..ROWS {
                if (FEWEST_PER_SIDE..ROWS - FEWEST_PER_SIDE).contains(&first) {
                    let (own, dense) = (earlier.gain(), dense_gain(&rows, width, first));
                    assert!((own - dense).abs() < 1e-9 * dense, "row {first}: {own} and {dense}");
                }
                earlier.add(3 * first, &whitened, &slopes, &errors);
            }
        }
    }
}
