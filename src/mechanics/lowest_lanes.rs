//! The lowest natural frequency of eight chains at once.
//!
//! The eight chains share everything outboard of one piece. The pass is the same as in [`lowest`](super::lowest): it
//! computes the apparent inertia from the tip to the base, with one pivot for each strain coordinate (each elastic
//! degree of freedom). One pass serves all eight chains, each at its own `λ`. The shared part is read from memory once.

// Loops over row and column indices read better here than iterators.
#![allow(clippy::needless_range_loop)]

use super::lanes::{Eight, LANES, Lanes};
use super::lowest::{BlockLink, LAST_STEP, SHOWN_ERROR, Step, UNKNOWN_STEP};
use nalgebra::{SMatrix, SVector};

/// The outboard part of the chain, which all eight chains share. Its steps are ordered tip first.
#[derive(Debug, Clone)]
pub(crate) struct Outboard<const N: usize> {
    /// Inertia of everything outboard of the first compliant element.
    start: SMatrix<f64, N, N>,
    steps: Vec<Shared<N>>,
}

/// A step of the computation from the tip to the base: a body, a joint or a link of the outboard part. It is the same
/// for all eight chains. A joint has the twist vector of its axis and its compliance \[rad/(N m)\].
#[derive(Debug, Clone)]
enum Shared<const N: usize> {
    Body(SMatrix<f64, N, N>),
    Joint(SVector<f64, N>, f64),
    Link(Box<BlockLink<N>>),
}

/// The inboard pieces of eight chains, in which the chains differ.
pub(crate) trait Inner<V: Lanes, const N: usize> {
    /// Adds the inboard pieces to a pass, from the tip inward. If any of these pieces is compliant, the last piece must
    /// be compliant.
    fn add_to(&self, walk: &mut Walk<V, N>);
}

/// A matrix for each of eight chains.
pub(crate) type LaneMatrix<const N: usize> = [[Eight; N]; N];

/// A condensed link in a pose, for each of eight chains. The fields have the same meaning as in [`BlockLink`]. Only
/// the lower triangle of symmetric matrices is used.
#[derive(Debug, Clone)]
pub(crate) struct LaneLink<const N: usize> {
    root: [LaneMatrix<N>; 3],
    cross: [LaneMatrix<N>; 3],
    end_inertia: [LaneMatrix<N>; 3],
    end: LaneMatrix<N>,
}

/// Result of one pass in each lane, each at its own `λ`. A lane is the place of one of the eight chains.
#[derive(Clone, Copy)]
pub(crate) struct LanePass<V> {
    /// Bit mask: lanes in which no pivot is negative, which means that no eigenvalue is below `λ`.
    pub below_all: u8,
    /// Bit mask: lanes in which at most one pivot is negative, which means that at most one eigenvalue is below `λ`.
    pub near_first: u8,
    /// Product of all pivots.
    pub product: V,
}

/// The lowest eigenvalues that the search for roots found.
#[derive(Clone, Copy)]
pub(crate) struct Roots<V> {
    /// Lowest eigenvalue in each wanted lane \[1/s²\].
    pub eigenvalue: V,
    /// Bit mask: lanes that were asked for, but in which no root was found.
    pub unsure: u8,
}

/// Largest number of passes. A lane that needs more is computed by itself with
/// [`lowest_eigenvalue`](super::lowest::lowest_eigenvalue).
const MOST_PASSES: usize = 16;

impl<const N: usize> Default for Outboard<N> {
    fn default() -> Self {
        Self { start: SMatrix::zeros(), steps: Vec::new() }
    }
}

impl<const N: usize> Outboard<N> {
    /// Replaces the shared part by `steps`, the steps of a chain, tip first. Bodies between two compliant elements are
    /// added up, and rigid links become bodies, so that a pass has as few steps as possible.
    pub(crate) fn refill<'a>(&mut self, steps: impl Iterator<Item = Step<'a, N>>) {
        self.start = SMatrix::zeros();
        self.steps.clear();
        for step in steps {
            match step {
                Step::Body(mass, inertia) => match self.steps.last_mut() {
                    None => self.start += inertia * mass,
                    Some(Shared::Body(sum)) => *sum += inertia * mass,
                    _ => self.steps.push(Shared::Body(inertia * mass)),
                },
                Step::Joint(twist, compliance) => self.steps.push(Shared::Joint(*twist, compliance)),
                Step::Link(link) if link.is_compliant() => {
                    self.steps.push(Shared::Link(Box::new(link.clone())))
                }
                Step::Link(link) => self.steps.push(Shared::Body(link.root[0])),
            }
        }
    }
}

impl<const N: usize> LaneLink<N> {
    /// Stores eight links in one value, with the eight numbers of each entry side by side, so that one instruction
    /// handles them.
    pub(crate) fn new(links: [&BlockLink<N>; LANES]) -> Self {
        Self {
            root: std::array::from_fn(|k| side_by_side(|lane| &links[lane].root[k])),
            cross: std::array::from_fn(|k| side_by_side(|lane| &links[lane].cross[k])),
            end_inertia: std::array::from_fn(|k| side_by_side(|lane| &links[lane].end_inertia[k])),
            end: side_by_side(|lane| &links[lane].end),
        }
    }
}

/// Eight matrices, stored as one matrix that has the eight numbers of each entry side by side.
pub(crate) fn side_by_side<'a, const N: usize>(
    of: impl Fn(usize) -> &'a SMatrix<f64, N, N>,
) -> LaneMatrix<N> {
    std::array::from_fn(|i| std::array::from_fn(|j| std::array::from_fn(|lane| of(lane)[(i, j)])))
}

/// A symmetric matrix in each lane, of which only the lower triangle is used.
type Inertia<V, const N: usize> = [[V; N]; N];

/// The entry (i, j) of a symmetric matrix that is stored as its lower triangle.
#[inline(always)]
fn entry<V: Copy, const N: usize>(of: &Inertia<V, N>, i: usize, j: usize) -> V {
    if i >= j { of[i][j] } else { of[j][i] }
}

/// One pass from the tip to the base for eight chains, with one `λ` in each lane: computes the apparent inertia and
/// counts negative pivots.
#[inline(always)]
pub(crate) fn pass<V: Lanes, const N: usize>(
    outboard: &Outboard<N>,
    inner: &impl Inner<V, N>,
    lambda: V,
) -> LanePass<V> {
    let mut state = Walk::new(&outboard.start, lambda);
    for step in &outboard.steps {
        match step {
            Shared::Body(inertia) => state.body(inertia),
            Shared::Joint(twist, compliance) => state.joint(twist, V::splat(*compliance)),
            Shared::Link(link) => state.compliant_link(&**link),
        }
    }
    // The inboard pieces are added to the same walk, because the pivots of shared and inboard pieces form one sequence.
    inner.add_to(&mut state);
    LanePass { below_all: !state.negative, near_first: !state.twice_negative, product: state.product }
}

/// The matrices of a condensed link (inertia of the root and of the end coordinates, their coupling, twist of
/// everything outboard per end coordinate), read entry by entry as one value per lane. The three inertias have one
/// matrix for each `order`, the power of `λ`. Implemented for links that differ from lane to lane and for one link
/// that all eight chains share.
trait LinkNumbers<const N: usize> {
    fn root<V: Lanes>(&self, order: usize, i: usize, j: usize) -> V;
    fn cross<V: Lanes>(&self, order: usize, i: usize, j: usize) -> V;
    fn end_inertia<V: Lanes>(&self, order: usize, i: usize, j: usize) -> V;
    fn end<V: Lanes>(&self, i: usize, j: usize) -> V;
}

impl<const N: usize> LinkNumbers<N> for LaneLink<N> {
    #[inline(always)]
    fn root<V: Lanes>(&self, order: usize, i: usize, j: usize) -> V {
        V::load(&self.root[order][i][j])
    }

    #[inline(always)]
    fn cross<V: Lanes>(&self, order: usize, i: usize, j: usize) -> V {
        V::load(&self.cross[order][i][j])
    }

    #[inline(always)]
    fn end_inertia<V: Lanes>(&self, order: usize, i: usize, j: usize) -> V {
        V::load(&self.end_inertia[order][i][j])
    }

    #[inline(always)]
    fn end<V: Lanes>(&self, i: usize, j: usize) -> V {
        V::load(&self.end[i][j])
    }
}

impl<const N: usize> LinkNumbers<N> for BlockLink<N> {
    #[inline(always)]
    fn root<V: Lanes>(&self, order: usize, i: usize, j: usize) -> V {
        V::splat(self.root[order][(i, j)])
    }

    #[inline(always)]
    fn cross<V: Lanes>(&self, order: usize, i: usize, j: usize) -> V {
        V::splat(self.cross[order][(i, j)])
    }

    #[inline(always)]
    fn end_inertia<V: Lanes>(&self, order: usize, i: usize, j: usize) -> V {
        V::splat(self.end_inertia[order][(i, j)])
    }

    #[inline(always)]
    fn end<V: Lanes>(&self, i: usize, j: usize) -> V {
        V::splat(self.end[(i, j)])
    }
}

/// `$a += $term` for each entry of the lower triangle. It is a macro because a closure would not be compiled for the
/// wide instruction set.
macro_rules! add_lower {
    ($a:expr, |$i:ident, $j:ident| $term:expr) => {
        for $i in 0..N {
            for $j in 0..=$i {
                $a[$i][$j] = $a[$i][$j] + $term;
            }
        }
    };
}

/// The entry of a link's effective inertia at `λ`, from the coefficients of 1, λ and λ².
macro_rules! at_lambda {
    ($link:ident.$of:ident($i:expr, $j:expr), $lambda:expr) => {
        $link.$of::<V>(0, $i, $j)
            + ($link.$of::<V>(1, $i, $j) + $link.$of::<V>(2, $i, $j) * $lambda) * $lambda
    };
}

/// The state of a pass from the tip to the base.
pub(crate) struct Walk<V, const N: usize> {
    lambda: V,
    apparent: Inertia<V, N>,
    /// Bit mask of the lanes with at least one negative pivot. The next field is the bit mask of the lanes with at
    /// least two.
    negative: u8,
    twice_negative: u8,
    /// Product of all pivots so far.
    product: V,
}

impl<V: Lanes, const N: usize> Walk<V, N> {
    #[inline(always)]
    fn new(start: &SMatrix<f64, N, N>, lambda: V) -> Self {
        let mut apparent = [[V::zero(); N]; N];
        add_lower!(apparent, |i, j| V::splat(start[(i, j)]));
        Self { lambda, apparent, negative: 0, twice_negative: 0, product: V::splat(1.0) }
    }

    /// Records the pivot of one coordinate in each lane: its sign, and its product with the pivots before.
    #[inline(always)]
    fn pivot(&mut self, pivot: V) {
        let negative = pivot.less(V::zero());
        self.twice_negative |= self.negative & negative;
        self.negative |= negative;
        self.product = self.product * pivot;
    }

    /// Adds a body that is the same in all eight chains.
    #[inline(always)]
    pub(crate) fn body(&mut self, inertia: &SMatrix<f64, N, N>) {
        add_lower!(self.apparent, |i, j| V::splat(inertia[(i, j)]));
    }

    /// Adds a mass, one per lane, times the inertia matrix of one kilogram.
    #[inline(always)]
    pub(crate) fn mass(&mut self, mass: V, inertia: &SMatrix<f64, N, N>) {
        add_lower!(self.apparent, |i, j| mass * V::splat(inertia[(i, j)]));
    }

    /// Adds a rigid link, one for each of the eight chains. Only its inertia over the motion of the root is used.
    #[inline(always)]
    pub(crate) fn rigid(&mut self, link: &LaneLink<N>) {
        add_lower!(self.apparent, |i, j| V::load(&link.root[0][i][j]));
    }

    /// Eliminates one strain coordinate, given its pivot and its row of the matrix, one per lane. The apparent inertia
    /// for everything inboard grows by `λ row rowᵀ / pivot`. `scale` is `λ / pivot`; for a joint it is multiplied by
    /// the compliance of the joint.
    #[inline(always)]
    fn release_by(&mut self, pivot: V, row: &[V; N], scale: V) {
        for i in 0..N {
            let scaled = row[i] * scale;
            for j in 0..=i {
                self.apparent[i][j] = self.apparent[i][j] + scaled * row[j];
            }
        }
        self.pivot(pivot);
    }

    /// Adds a joint, given the twist vector of its axis and its compliance \[rad/(N m)\], one per lane.
    #[inline(always)]
    pub(crate) fn joint(&mut self, twist: &SVector<f64, N>, compliance: V) {
        let mut momentum = [V::zero(); N];
        let mut own = V::zero();
        for i in 0..N {
            for j in 0..N {
                momentum[i] = momentum[i] + entry(&self.apparent, i, j) * V::splat(twist[j]);
            }
            own = own + momentum[i] * V::splat(twist[i]);
        }
        let softness = self.lambda * compliance;
        // The pivot is 1 - λ c tᵀWt, where c is the compliance of the joint.
        let pivot = V::splat(1.0) - softness * own;
        self.release_by(pivot, &momentum, softness / pivot);
    }

    /// Adds a compliant link that differs between the eight chains.
    #[inline(always)]
    pub(crate) fn link(&mut self, link: &LaneLink<N>) {
        self.compliant_link(link);
    }

    /// Adds a link that is the same in all eight chains, compliant or rigid.
    #[inline(always)]
    pub(crate) fn shared_link(&mut self, link: &BlockLink<N>) {
        match link.is_compliant() {
            true => self.compliant_link(link),
            false => self.body(&link.root[0]),
        }
    }

    /// Adds a compliant link, whether the eight chains share it or not. It forms `S` and `P` of the formula in
    /// [`lowest`](super::lowest), then eliminates the end coordinates one by one.
    #[inline(always)]
    fn compliant_link<L: LinkNumbers<N>>(&mut self, link: &L) {
        let lambda = self.lambda;
        // The product W t of the formula.
        let mut moved = [[V::zero(); N]; N];
        for g in 0..N {
            for k in 0..N {
                let end = link.end::<V>(k, g);
                for i in 0..N {
                    moved[i][g] = moved[i][g] + entry(&self.apparent, i, k) * end;
                }
            }
        }
        // `s` is the lower triangle of 1 - λS, and `p` is Pᵀ with one row for each end coordinate.
        let (mut s, mut p) = ([[V::zero(); N]; N], [[V::zero(); N]; N]);
        for g in 0..N {
            for h in 0..=g {
                let mut sum = at_lambda!(link.end_inertia(g, h), lambda);
                for k in 0..N {
                    sum = sum + link.end::<V>(k, g) * moved[k][h];
                }
                s[g][h] = V::splat(if g == h { 1.0 } else { 0.0 }) - sum * lambda;
            }
            for i in 0..N {
                p[g][i] = at_lambda!(link.cross(i, g), lambda) + moved[i][g];
            }
        }
        add_lower!(self.apparent, |i, j| at_lambda!(link.root(i, j), lambda));
        // This loop does two things at once: the LDLᵀ factorization of 1 - λS and the forward substitution of P.
        for k in 0..N {
            let pivot = s[k][k];
            let inverse = V::splat(1.0) / pivot;
            for g in k + 1..N {
                let factor = s[g][k] * inverse;
                for h in k + 1..=g {
                    s[g][h] = s[g][h] - factor * s[h][k];
                }
                for i in 0..N {
                    p[g][i] = p[g][i] - factor * p[k][i];
                }
            }
            self.release_by(pivot, &p[k], lambda * inverse);
        }
    }
}

/// Lowest eigenvalue of every wanted lane, by the secant method on the product of all pivots times `x = 1/λ`.
///
/// The product of the pivots is `Π (1 - x_i / x)`, so this function is `(x - x_1) Π (1 - x_i / x)`, where the product
/// `Π` is over all modes except the first. The function is a straight line if the other modes are far away. However
/// near they are, the function has no poles at positive `x`, which are points where it is infinite. A guess beyond the
/// second mode is moved back.
#[inline(always)]
pub(crate) fn roots<V: Lanes, const N: usize>(
    outboard: &Outboard<N>,
    inner: &impl Inner<V, N>,
    guess: V,
    wanted: u8,
) -> Roots<V> {
    let one = V::splat(1.0);
    let mut open = wanted;
    let mut x = one / guess;
    // The first step uses the slope 1, which is exact if the other modes are far away.
    let (mut result, mut slope) = (x, one);
    let (mut x_before, mut y_before) = (V::zero(), V::zero());
    let unknown = V::splat(UNKNOWN_STEP) * x;
    let (mut step_before, mut step_two_before) = (unknown, unknown);
    let mut has_before = 0u8;
    for _ in 0..MOST_PASSES {
        let here = pass(outboard, inner, one / x);
        let y = here.product * x;
        let secant = (y - y_before) / (x - x_before);
        // A point beyond a pole belongs to another branch of the curve, so no secant is drawn through it.
        slope = V::choose(has_before & here.near_first & open, secant, slope);
        let next = x - y / slope;
        let step = (next - x).abs();
        let settled = step.less(V::splat(LAST_STEP) * x)
            & (step * step).less(V::splat(SHOWN_ERROR) * x * step_two_before)
            & here.near_first
            & open;
        result = V::choose(settled, next, result);
        open &= !settled;
        if open == 0 {
            break;
        }
        // A step must not lead beyond a pole, and must not change x by more than a factor of four.
        let in_reach = next.less(V::splat(4.0) * x) & (V::splat(0.25) * x).less(next) & here.near_first;
        let drawn_back = V::choose(V::zero().less(y) & here.near_first, V::splat(0.5) * x, V::splat(1.5) * x);
        has_before = here.near_first;
        // The length of a step that was cut short does not show the error.
        step_two_before = step_before;
        step_before = V::choose(in_reach, step, V::splat(UNKNOWN_STEP) * x);
        (x_before, y_before) = (x, y);
        x = V::choose(open, V::choose(in_reach, next, drawn_back), x);
    }
    Roots { eigenvalue: one / result, unsure: open }
}
