//! Finds the best compliances that are physically possible: none is negative, and the compliance matrix of a frame is
//! positive semidefinite.
//!
//! The normal equations of a fit describe a quadratic function, which is minimized under these constraints. A
//! compliance that would be negative is fixed at zero. The matrix of a frame is written as `L Lᵀ`, which is positive
//! semidefinite for every `L`, and the quadratic function is minimized over the entries of `L` and all other numbers.

use super::deflection::FRAME_ENTRIES;
use super::normal::{Factor, Normal};
use nalgebra::{Cholesky, DMatrix, DVector, Matrix2, Matrix3, Vector2};
use std::ops::Range;

/// Largest number of Newton steps over the entries of `L`, the Cholesky factor of a frame's compliance matrix `L Lᵀ`.
const MOST_STEPS: usize = 30;
/// Largest number of lengths that are tried for a Newton step. Each is half of the length before it, after which half
/// of chi-squared was larger.
const MOST_HALVINGS: i32 = 8;
/// The Newton steps end when the next one would lower half of chi-squared by less than this.
const SETTLED: f64 = 1e-6;
/// Fraction of the frame's largest compliance that is added to its diagonal before `L` is computed. If an entry of `L`
/// were zero, the derivative of half of chi-squared with respect to this entry could be zero, and the entry would stay
/// zero in the iteration.
const ROOM: f64 = 1e-3;
/// Row and column of each entry of `L` (the factor of a frame's compliance matrix). The base lacks the last entry:
/// its zz follows from the couplings.
const LOWER: [(usize, usize); FRAME_ENTRIES.len()] = [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)];

/// The step to the minimum of half of chi-squared, which is a quadratic function of the numbers.
pub(crate) struct ConstrainedStep {
    /// Change of each number of the model. The numbers of the geometry come first, then the compliances.
    pub step: Vec<f64>,
    /// By how much the step lowers half of chi-squared.
    pub fall: f64,
    /// Derivatives of the numbers of the model with respect to every free variable of the minimization.
    slopes: Vec<Slope>,
    /// The factorized curvature of half of chi-squared over the free variables.
    factor: Factor,
}

impl ConstrainedStep {
    /// Standard deviations of the model's numbers, in their units; infinite for a number that is fixed at its
    /// constraint.
    pub(crate) fn deviations(&self) -> Vec<f64> {
        let deviation = |number: usize| {
            let slopes = DVector::from_iterator(self.slopes.len(), self.slopes.iter().map(|s| s.of(number)));
            match slopes.iter().any(|s| *s != 0.0) {
                true => slopes.dot(&self.factor.solve(&slopes)).max(0.0).sqrt(),
                false => f64::INFINITY,
            }
        };
        (0..self.step.len()).map(deviation).collect()
    }

    /// The changes of the model's numbers that lead to the minimum if half of chi-squared has the negative gradient
    /// `gradient`. Numbers that are fixed at their constraint stay.
    pub(crate) fn answer(&self, gradient: &DVector<f64>) -> DVector<f64> {
        let along = |slope: &Slope| slope.entries().map(|(at, entry)| entry * gradient[at]).sum::<f64>();
        let right = DVector::from_iterator(self.slopes.len(), self.slopes.iter().map(along));
        let mut out = DVector::zeros(self.step.len());
        for (slope, by) in self.slopes.iter().zip(self.factor.solve(&right).iter()) {
            slope.entries().for_each(|(at, entry)| out[at] += entry * by);
        }
        out
    }
}

/// Derivatives of the numbers of the model with respect to one free variable of the minimization: a number itself, or
/// an entry of the factor `L` of a frame. Only the compliances of this frame depend on such an entry.
struct Slope {
    /// Index of the first number that depends on the variable. The other dependent numbers follow it directly.
    first: usize,
    /// How many numbers depend on the variable.
    count: usize,
    entries: [f64; FRAME_ENTRIES.len()],
}

impl Slope {
    /// The variable is the number with the index `at`.
    fn unit(at: usize) -> Self {
        Self { first: at, count: 1, entries: std::array::from_fn(|k| if k == 0 { 1.0 } else { 0.0 }) }
    }

    /// The derivatives that are not zero, each with the index of its number.
    fn entries(&self) -> impl Iterator<Item = (usize, f64)> {
        (self.first..).zip(self.entries[..self.count].iter().copied())
    }

    /// Derivative of the number with the index `number`.
    fn of(&self, number: usize) -> f64 {
        self.entries().find(|(at, _)| *at == number).map_or(0.0, |(_, entry)| entry)
    }
}

/// How the compliances of one effect may change in the minimization.
#[derive(Clone)]
enum Block {
    Free,
    /// The compliances are fixed at their constraint. These are their changes from the present values \[rad/(N m)\].
    Held(Vec<f64>),
    /// The compliances are those of a frame: the entries of the matrix `L Lᵀ`, with this `L`.
    Frame(Matrix3<f64>),
}

/// The step to the minimum of half of chi-squared at which every compliance is physically possible. `now` lists the
/// compliances of each effect before the step. The equations have `numbers` numbers of the geometry, followed by these
/// compliances. `None` if the equations are singular.
pub(crate) fn best_springs(normal: &Normal, numbers: usize, now: &[Vec<f64>]) -> Option<ConstrainedStep> {
    let mut first = numbers;
    let ranges: Vec<Range<usize>> = (now.iter())
        .map(|own| {
            let range = first..first + own.len();
            first = range.end;
            range
        })
        .collect();
    let own = normal.own;
    let curvature = normal.curvature.view((0, 0), (own, own)).into_owned();
    let gradient = normal.gradient.rows(0, own).into_owned();
    let blocks = vec![Block::Free; now.len()];
    let mut parabola = Parabola { curvature, gradient, numbers, now, ranges, blocks };
    loop {
        let mut best = parabola.best()?;
        // the value at the start is zero: if the descent from the projected compliances ends above it, it starts
        // again from the present compliances
        if best.fall < 0.0 {
            parabola.frames_from_now();
            best = parabola.best()?;
        }
        let mut is_settled = true;
        for (k, own) in now.iter().enumerate() {
            if !matches!(parabola.blocks[k], Block::Free) {
                continue;
            }
            let step = &best.step[parabola.ranges[k].clone()];
            let wanted: Vec<f64> = own.iter().zip(step).map(|(c, by)| c + by).collect();
            let spring = nearest_spring(&wanted);
            // the step violates the constraint: this block is put on its constraint, and the others are solved for
            // again
            if spring != wanted {
                is_settled = false;
                parabola.blocks[k] = match own.len() {
                    5.. => Block::Frame(factor_of(&spring)),
                    _ => Block::Held(spring.iter().zip(own).map(|(c, now)| c - now).collect()),
                };
            }
        }
        if is_settled {
            return Some(best);
        }
    }
}

/// The Cholesky factor `L` of a frame's compliance matrix. [`ROOM`] times the largest compliance is added to the
/// diagonal first.
fn factor_of(compliances: &[f64]) -> Matrix3<f64> {
    let matrix = frame_matrix(compliances);
    let room = (ROOM * matrix.diagonal().max()).max(f64::MIN_POSITIVE);
    Cholesky::new(matrix + Matrix3::identity() * room).map_or_else(Matrix3::zeros, |c| c.l())
}

/// Half of chi-squared as a quadratic function of the numbers, and how the compliances of each effect may change.
struct Parabola<'a> {
    curvature: DMatrix<f64>,
    gradient: DVector<f64>,
    numbers: usize,
    now: &'a [Vec<f64>],
    /// For each effect, the range of indices of its compliances among the numbers of the model.
    ranges: Vec<Range<usize>>,
    blocks: Vec<Block>,
}

impl Parabola<'_> {
    /// The step to the minimum of half of chi-squared. Without frames, one Newton step leads to the minimum. With
    /// frames several are needed, because the compliances of a frame are quadratic in the entries of `L`.
    fn best(&mut self) -> Option<ConstrainedStep> {
        let mut linear = vec![0.0; self.gradient.len()];
        let mut step = self.step(&linear);
        for _ in 0..MOST_STEPS {
            let slopes = self.slopes();
            let factor = self.factor(&slopes)?;
            let gradient = self.gradient_at(&step);
            let along = |slope: &Slope| slope.entries().map(|(at, entry)| entry * gradient[at]).sum::<f64>();
            let right = DVector::from_iterator(slopes.len(), slopes.iter().map(along));
            let move_by = factor.solve(&right);
            let (value, from, blocks) = (self.value(&step), linear.clone(), self.blocks.clone());
            let is_better = (0..MOST_HALVINGS).any(|halving| {
                (linear, self.blocks) = (from.clone(), blocks.clone());
                self.advance(&mut linear, &(&move_by * 0.5f64.powi(halving)));
                step = self.step(&linear);
                self.value(&step) <= value
            });
            if !is_better {
                (linear, self.blocks) = (from, blocks);
                step = self.step(&linear);
            }
            // without frames, one step leads to the minimum, and the derivatives are the same everywhere
            let is_linear = !self.blocks.iter().any(|block| matches!(block, Block::Frame(_)));
            if is_linear {
                return Some(ConstrainedStep { fall: -self.value(&step), step, slopes, factor });
            }
            if !is_better || right.dot(&move_by) < SETTLED {
                break;
            }
        }
        let slopes = self.slopes();
        let factor = self.factor(&slopes)?;
        Some(ConstrainedStep { fall: -self.value(&step), step, slopes, factor })
    }

    /// Sets the entries of `L` of every frame so that `L Lᵀ` is the frame's present compliance matrix, slightly
    /// enlarged. A new descent can then start from the present compliances.
    fn frames_from_now(&mut self) {
        for (block, now) in self.blocks.iter_mut().zip(self.now) {
            if let Block::Frame(l) = block {
                let size = (*l * l.transpose()).diagonal().max();
                let room = Matrix3::identity() * (ROOM * size);
                *l = Cholesky::new(frame_matrix(now) + room).map_or(room, |c| c.l());
            }
        }
    }

    /// The negative gradient of half of chi-squared after the step `step` of the model's numbers.
    fn gradient_at(&self, step: &[f64]) -> DVector<f64> {
        &self.gradient - &self.curvature * DVector::from_column_slice(step)
    }

    fn value(&self, step: &[f64]) -> f64 {
        let step = DVector::from_column_slice(step);
        0.5 * step.dot(&(&self.curvature * &step)) - step.dot(&self.gradient)
    }

    /// Factorizes the curvature of half of chi-squared over the free variables: free numbers and entries of `L`.
    /// `slopes` are the derivatives of the numbers with respect to these variables. `None` if the curvature is
    /// singular.
    fn factor(&self, slopes: &[Slope]) -> Option<Factor> {
        let all_free = self.blocks.iter().all(|block| matches!(block, Block::Free));
        let all: Vec<usize> = (0..slopes.len()).collect();
        match all_free {
            true => Factor::new(&self.curvature, &all),
            false => Factor::new(&self.curvature_along(slopes), &all),
        }
    }

    /// The curvature of half of chi-squared over the variables with the derivatives `slopes`.
    fn curvature_along(&self, slopes: &[Slope]) -> DMatrix<f64> {
        let half = DMatrix::from_fn(slopes.len(), self.gradient.len(), |i, j| {
            slopes[i].entries().map(|(at, entry)| entry * self.curvature[(at, j)]).sum::<f64>()
        });
        DMatrix::from_fn(slopes.len(), slopes.len(), |i, j| {
            slopes[j].entries().map(|(at, entry)| half[(i, at)] * entry).sum::<f64>()
        })
    }

    /// The step of every number of the model. `linear` gives the steps of the free numbers. The steps of the others
    /// follow from their constraint or from the entries of `L`.
    fn step(&self, linear: &[f64]) -> Vec<f64> {
        let mut step = linear.to_vec();
        for ((block, range), now) in self.blocks.iter().zip(&self.ranges).zip(self.now) {
            match block {
                Block::Free => {}
                Block::Held(by) => step[range.clone()].copy_from_slice(by),
                Block::Frame(l) => {
                    let matrix = l * l.transpose();
                    let entries = FRAME_ENTRIES.iter().zip(now);
                    step[range.clone()]
                        .iter_mut()
                        .zip(entries)
                        .for_each(|(step, (at, now))| *step = matrix[*at] - now);
                }
            }
        }
        step
    }

    /// Derivatives of the numbers of the model with respect to every free variable. A free variable is a number without
    /// constraint, or an entry of `L`.
    fn slopes(&self) -> Vec<Slope> {
        let mut slopes: Vec<Slope> = (0..self.numbers).map(Slope::unit).collect();
        for (block, range) in self.blocks.iter().zip(&self.ranges) {
            match block {
                Block::Free => slopes.extend(range.clone().map(Slope::unit)),
                Block::Held(_) => {}
                Block::Frame(l) => slopes.extend(LOWER[..range.len()].iter().map(|&(row, column)| {
                    let mut moved = Matrix3::zeros();
                    moved[(row, column)] = 1.0;
                    let slope = moved * l.transpose() + l * moved.transpose();
                    let entries = FRAME_ENTRIES.map(|entry| slope[entry]);
                    Slope { first: range.start, count: range.len(), entries }
                })),
            }
        }
        slopes
    }

    /// Moves the free numbers in `linear` and the entries of `L` by their steps in `by`.
    fn advance(&mut self, linear: &mut [f64], by: &DVector<f64>) {
        let mut by = by.iter();
        let mut next = || by.next().copied().unwrap_or_default();
        linear[..self.numbers].iter_mut().for_each(|x| *x += next());
        for (block, range) in self.blocks.iter_mut().zip(&self.ranges) {
            match block {
                Block::Free => linear[range.clone()].iter_mut().for_each(|x| *x += next()),
                Block::Held(_) => {}
                Block::Frame(l) => LOWER[..range.len()].iter().for_each(|at| l[*at] += next()),
            }
        }
    }
}

/// Projects the compliances of an effect onto physically possible values: none is negative, and a frame's matrix is
/// positive semidefinite.
fn nearest_spring(compliances: &[f64]) -> Vec<f64> {
    match compliances.len() {
        // the waves of a stiffness may have either sign
        2 | 4 => compliances.to_vec(),
        1 => vec![compliances[0].max(0.0)],
        5 => nearest_base(compliances),
        _ => nearest_frame(compliances),
    }
}

/// Projects the compliance of a base onto the positive semidefinite cone. Rotation about z cannot be observed, so zz is
/// not among the numbers. It follows as the smallest value with which the couplings xz and yz are possible. If the 2x2
/// matrix of x and y is not positive definite, it is projected, and the couplings are set to zero.
fn nearest_base(compliances: &[f64]) -> Vec<f64> {
    let level: Matrix2<f64> = frame_matrix(compliances).fixed_view::<2, 2>(0, 0).into_owned();
    let mut eigen = level.symmetric_eigen();
    if eigen.eigenvalues.min() > 0.0 {
        return compliances.to_vec();
    }
    eigen.eigenvalues.apply(|e| *e = e.max(0.0));
    let c = eigen.recompose();
    vec![c[(0, 0)], c[(1, 1)], c[(0, 1)], 0.0, 0.0]
}

fn nearest_frame(compliances: &[f64]) -> Vec<f64> {
    let mut eigen = frame_matrix(compliances).symmetric_eigen();
    if eigen.eigenvalues.min() >= 0.0 {
        return compliances.to_vec();
    }
    // slightly above zero, so that rounding does not make it negative
    let least = 1e-9 * eigen.eigenvalues.max().max(0.0);
    eigen.eigenvalues.apply(|e| *e = e.max(least));
    let c = eigen.recompose();
    FRAME_ENTRIES.iter().map(|&at| c[at]).collect()
}

/// The symmetric compliance matrix of a frame from its entries `compliances`. If zz is not among them, as for the
/// base, it is the smallest value with which the matrix is positive semidefinite.
pub(crate) fn frame_matrix(compliances: &[f64]) -> Matrix3<f64> {
    let mut out = Matrix3::zeros();
    for (&(i, j), c) in FRAME_ENTRIES.iter().zip(compliances) {
        (out[(i, j)], out[(j, i)]) = (*c, *c);
    }
    if compliances.len() == 5 {
        let coupling = Vector2::new(out[(0, 2)], out[(1, 2)]);
        let level: Matrix2<f64> = out.fixed_view::<2, 2>(0, 0).into_owned();
        out[(2, 2)] = level.try_inverse().map_or(0.0, |inverse| coupling.dot(&(inverse * coupling)));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_a_spring_stays_and_what_is_none_becomes_the_nearest() {
        let spring = [4e-6, 5e-6, 1e-6, 2e-6, -1e-6, 6e-6];
        assert_eq!(nearest_spring(&spring), spring);
        assert_eq!(nearest_spring(&[-1e-6]), [0.0]);
        // eigenvalues 3 and -1 about the diagonals of xy, 2 about z
        let made = nearest_spring(&[1.0, 1.0, 2.0, 0.0, 0.0, 2.0]);
        let nearest = [1.5, 1.5, 1.5, 0.0, 0.0, 2.0];
        assert!(made.iter().zip(nearest).all(|(a, b)| (a - b).abs() < 1e-6), "{made:?}");
        assert_eq!(nearest_spring(&[1.0, -1.0, 0.0, 0.5, 0.5]), [1.0, 0.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn a_base_turns_about_the_vertical_no_more_than_its_couplings_need() {
        let matrix = frame_matrix(&[4e-6, 5e-6, 1e-6, 2e-6, -1e-6]);
        let eigenvalues = matrix.symmetric_eigenvalues();
        assert!(eigenvalues.min().abs() < 1e-9 * eigenvalues.max(), "just a spring: {eigenvalues}");
        assert_eq!((matrix[(0, 1)], matrix[(2, 0)]), (1e-6, 2e-6));
    }
}
