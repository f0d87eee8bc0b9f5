//! The lowest natural frequency of eight chains at once that share everything outboard of one piece.
//!
//! The pass is that of [`lowest`](super::lowest): the apparent inertia carried inward, one pivot per
//! way of yielding. What the eight share is read once; a pass is made for all, each at its own `λ`.

// matrices by row and column read better than iterators over them
#![allow(clippy::needless_range_loop)]

use super::lanes::{Eight, LANES, Lanes};
use super::lowest::{BlockLink, LAST_STEP, SHOWN_ERROR, Step, UNKNOWN_STEP};
use nalgebra::{SMatrix, SVector};

/// What eight chains share, from the tip inward.
#[derive(Debug, Clone)]
pub struct Outboard<const N: usize> {
    /// Inertia before anything yields.
    start: SMatrix<f64, N, N>,
    steps: Vec<Shared<N>>,
}

#[derive(Debug, Clone)]
enum Shared<const N: usize> {
    Body(SMatrix<f64, N, N>),
    Joint(SVector<f64, N>, f64),
    Link(Box<BlockLink<N>>),
}

/// The pieces of eight chains that they do not share, from the tip inward.
pub trait Inner<V: Lanes, const N: usize> {
    /// Walks over them. The last must be one that yields if any does.
    fn carry(&self, walk: &mut Walk<V, N>);
}

/// A matrix for each of eight chains.
pub type LaneMatrix<const N: usize> = [[Eight; N]; N];

/// A placed link for each of eight chains; of symmetric matrices only the lower part is used.
#[derive(Debug, Clone)]
pub struct LaneLink<const N: usize> {
    root: [LaneMatrix<N>; 3],
    cross: [LaneMatrix<N>; 3],
    end_inertia: [LaneMatrix<N>; 3],
    end: LaneMatrix<N>,
}

/// What one pass at `λ` finds in each lane.
#[derive(Clone, Copy)]
pub struct LanePass<V> {
    /// Bits of the lanes in which every pivot before the last is positive.
    pub sound: u8,
    /// The last pivot.
    pub last: V,
}

/// Roots found.
#[derive(Clone, Copy)]
pub struct Roots<V> {
    /// Lowest eigenvalue in each wanted lane.
    pub eigenvalue: V,
    /// Bits of the wanted lanes in which no root was found.
    pub unsure: u8,
}

const MOST_PASSES: usize = 10;

impl<const N: usize> Default for Outboard<N> {
    fn default() -> Self {
        Self { start: SMatrix::zeros(), steps: Vec::new() }
    }
}

impl<const N: usize> Outboard<N> {
    /// Takes over the steps of a chain, tip first.
    pub fn refill<'a>(&mut self, steps: impl Iterator<Item = Step<'a, N>>) {
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
                Step::Link(link) if link.yields() => self.steps.push(Shared::Link(Box::new(link.clone()))),
                Step::Link(link) => self.steps.push(Shared::Body(link.root[0])),
            }
        }
    }
}

impl<const N: usize> LaneLink<N> {
    /// Puts eight links side by side.
    pub fn new(links: [&BlockLink<N>; LANES]) -> Self {
        Self {
            root: std::array::from_fn(|k| side_by_side(|lane| &links[lane].root[k])),
            cross: std::array::from_fn(|k| side_by_side(|lane| &links[lane].cross[k])),
            end_inertia: std::array::from_fn(|k| side_by_side(|lane| &links[lane].end_inertia[k])),
            end: side_by_side(|lane| &links[lane].end),
        }
    }
}

/// A matrix of each of eight things side by side.
pub fn side_by_side<'a, const N: usize>(of: impl Fn(usize) -> &'a SMatrix<f64, N, N>) -> LaneMatrix<N> {
    std::array::from_fn(|i| std::array::from_fn(|j| std::array::from_fn(|lane| of(lane)[(i, j)])))
}

/// Lower part of a symmetric matrix per lane.
type Inertia<V, const N: usize> = [[V; N]; N];

#[inline(always)]
fn entry<V: Copy, const N: usize>(of: &Inertia<V, N>, i: usize, j: usize) -> V {
    if i >= j { of[i][j] } else { of[j][i] }
}

/// Carries the apparent inertia from tip to base at one `λ` per lane.
#[inline(always)]
pub fn pass<V: Lanes, const N: usize>(
    outboard: &Outboard<N>,
    inner: &impl Inner<V, N>,
    lambda: V,
) -> LanePass<V> {
    let mut state = Walk::new(&outboard.start, lambda);
    for step in &outboard.steps {
        match step {
            Shared::Body(inertia) => state.body(inertia),
            Shared::Joint(twist, compliance) => state.joint(twist, V::splat(*compliance)),
            Shared::Link(link) => state.yielding_link(&**link),
        }
    }
    inner.carry(&mut state);
    LanePass { sound: state.sound, last: state.last }
}

/// A link's numbers in lanes, whether shared or not.
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

/// `$a += $term` for each entry of the lower part.
macro_rules! add_lower {
    ($a:expr, |$i:ident, $j:ident| $term:expr) => {
        for $i in 0..N {
            for $j in 0..=$i {
                $a[$i][$j] = $a[$i][$j] + $term;
            }
        }
    };
}

/// An entry of a link's inertia at `λ`.
macro_rules! at_lambda {
    ($link:ident.$of:ident($i:expr, $j:expr), $lambda:expr) => {
        $link.$of::<V>(0, $i, $j)
            + ($link.$of::<V>(1, $i, $j) + $link.$of::<V>(2, $i, $j) * $lambda) * $lambda
    };
}

/// The walk from tip to base.
pub struct Walk<V, const N: usize> {
    lambda: V,
    apparent: Inertia<V, N>,
    sound: u8,
    last: V,
}

impl<V: Lanes, const N: usize> Walk<V, N> {
    #[inline(always)]
    fn new(start: &SMatrix<f64, N, N>, lambda: V) -> Self {
        let mut apparent = [[V::zero(); N]; N];
        add_lower!(apparent, |i, j| V::splat(start[(i, j)]));
        Self { lambda, apparent, sound: u8::MAX, last: V::splat(1.0) }
    }

    #[inline(always)]
    fn pivot(&mut self, pivot: V) {
        self.sound &= V::zero().less(self.last);
        self.last = pivot;
    }

    /// A body that all eight have.
    #[inline(always)]
    pub fn body(&mut self, inertia: &SMatrix<f64, N, N>) {
        add_lower!(self.apparent, |i, j| V::splat(inertia[(i, j)]));
    }

    /// A mass times the inertia of one kilogram.
    #[inline(always)]
    pub fn mass(&mut self, mass: V, inertia: &SMatrix<f64, N, N>) {
        add_lower!(self.apparent, |i, j| mass * V::splat(inertia[(i, j)]));
    }

    /// A link that does not yield.
    #[inline(always)]
    pub fn rigid(&mut self, link: &LaneLink<N>) {
        add_lower!(self.apparent, |i, j| V::load(&link.root[0][i][j]));
    }

    /// A pivot and the row it belongs to: everything inboard sees `λ row rowᵀ / pivot` more.
    #[inline(always)]
    fn yield_by(&mut self, pivot: V, row: &[V; N], scale: V) {
        for i in 0..N {
            let scaled = row[i] * scale;
            for j in 0..=i {
                self.apparent[i][j] = self.apparent[i][j] + scaled * row[j];
            }
        }
        self.pivot(pivot);
    }

    /// A joint: its twist and compliance.
    #[inline(always)]
    pub fn joint(&mut self, twist: &SVector<f64, N>, compliance: V) {
        let mut momentum = [V::zero(); N];
        let mut own = V::zero();
        for i in 0..N {
            for j in 0..N {
                momentum[i] = momentum[i] + entry(&self.apparent, i, j) * V::splat(twist[j]);
            }
            own = own + momentum[i] * V::splat(twist[i]);
        }
        let yielding = self.lambda * compliance;
        let pivot = V::splat(1.0) - yielding * own;
        self.yield_by(pivot, &momentum, yielding / pivot);
    }

    /// A link that yields.
    #[inline(always)]
    pub fn link(&mut self, link: &LaneLink<N>) {
        self.yielding_link(link);
    }

    #[inline(always)]
    fn yielding_link<L: LinkNumbers<N>>(&mut self, link: &L) {
        let lambda = self.lambda;
        let mut moved = [[V::zero(); N]; N];
        for g in 0..N {
            for k in 0..N {
                let end = link.end::<V>(k, g);
                for i in 0..N {
                    moved[i][g] = moved[i][g] + entry(&self.apparent, i, k) * end;
                }
            }
        }
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
        // LDLᵀ of 1 - λS and forward substitution of P together
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
            self.yield_by(pivot, &p[k], lambda * inverse);
        }
    }
}

/// Lowest eigenvalue of every wanted lane by secants on `1/λ - w` over `1/λ`, as in
/// [`lowest_eigenvalue`](super::lowest::lowest_eigenvalue). A guess beyond a pole is drawn back.
#[inline(always)]
pub fn roots<V: Lanes, const N: usize>(
    outboard: &Outboard<N>,
    inner: &impl Inner<V, N>,
    guess: V,
    wanted: u8,
) -> Roots<V> {
    let one = V::splat(1.0);
    let mut open = wanted;
    let mut x = one / guess;
    let (mut result, mut slope) = (x, one);
    let (mut x_before, mut y_before) = (V::zero(), V::zero());
    let unknown = V::splat(UNKNOWN_STEP) * x;
    let (mut step_before, mut step_two_before) = (unknown, unknown);
    let mut has_before = 0u8;
    for _ in 0..MOST_PASSES {
        let here = pass(outboard, inner, one / x);
        let y = here.last * x;
        let secant = (y - y_before) / (x - x_before);
        slope = V::choose(has_before & here.sound & open, secant, slope);
        let next = x - y / slope;
        let step = (next - x).abs();
        let settled = step.less(V::splat(LAST_STEP) * x)
            & (step * step).less(V::splat(SHOWN_ERROR) * x * step_two_before)
            & here.sound
            & open;
        result = V::choose(settled, next, result);
        open &= !settled;
        if open == 0 {
            break;
        }
        // not beyond a pole, and by no more than a factor of four at once
        let in_reach = next.less(V::splat(4.0) * x) & (V::splat(0.25) * x).less(next) & here.sound;
        let drawn_back = V::choose(V::zero().less(y) & here.sound, V::splat(0.5) * x, V::splat(1.5) * x);
        has_before = here.sound;
        step_two_before = step_before;
        step_before = V::choose(in_reach, step, V::splat(UNKNOWN_STEP) * x);
        (x_before, y_before) = (x, y);
        x = V::choose(open, V::choose(in_reach, next, drawn_back), x);
    }
    Roots { eigenvalue: one / result, unsure: open }
}
