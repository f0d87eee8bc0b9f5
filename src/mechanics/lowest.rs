//! The lowest natural frequency of a chain without forming its matrices.
//!
//! Going from the tip inward, `W(λ)` is the apparent inertia of everything outboard at `λ = ω²`: a
//! rigid body's inertia plus what its flexibility adds. Through an element with unit stiffness and
//! end motion `t` (a joint: its axis times the root of its compliance; a link: see
//! [`condensed`](super::condensed)),
//!
//! ```text
//! W_in = W_rr + λ P (1 - λ S)⁻¹ Pᵀ,   P = (M_rg + W t),   S = M_gg + tᵀ W t
//! ```
//!
//! The pivots of all `1 - λ S` are positive exactly below the lowest eigenvalue, so the pass both
//! counts (Sturm) and, through its last pivot, points to the root. A lower bound to start from is
//! Dunkerley's: `1/λ₁ ≤ Σ 1/λ_i = tr(C M)`.

use nalgebra::{SMatrix, SVector};
use std::f64::consts::TAU;

/// What a chain shows the pass: its elements from tip to base, restricted to `N` of the six motions.
#[derive(Debug, Clone)]
pub enum Step<'a, const N: usize> {
    /// Inertia rigidly attached, times a factor (a mass).
    Body(f64, &'a SMatrix<f64, N, N>),
    /// A joint: its twist and its compliance \[rad/(N m)\].
    Joint(&'a SVector<f64, N>, f64),
    /// A link.
    Link(&'a BlockLink<N>),
}

/// A placed link restricted to `N` of the six motions.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockLink<const N: usize> {
    /// Root-root inertia by order in λ.
    pub root: [SMatrix<f64, N, N>; 3],
    /// Root-end inertia by order in λ.
    pub cross: [SMatrix<f64, N, N>; 3],
    /// End-end inertia by order in λ.
    pub end_inertia: [SMatrix<f64, N, N>; 3],
    /// Twist of everything outboard per end coordinate.
    pub end: SMatrix<f64, N, N>,
}

impl<const N: usize> BlockLink<N> {
    /// Whether any motion of its end is elastic.
    pub fn yields(&self) -> bool {
        self.end.amax() > 0.0 || self.end_inertia.iter().any(|m| m.amax() > 0.0)
    }
}

/// What one pass at `λ` finds.
struct Pass {
    /// Whether every pivot before the last is positive.
    inner_sound: bool,
    /// The last pivot: positive below the lowest eigenvalue, negative just above it.
    last: f64,
}

/// Relative step below which a secant's result is accepted: its error is of the order of the product of
/// the last two steps.
const SMALL_STEP: f64 = 1e-9;
const MOST_PASSES: usize = 200;

/// Lowest eigenvalue `λ₁ = ω₁²` of the chain, given `trace_s2 ≥ tr(C M)`; infinite if nothing yields.
///
/// The last pivot is `1 - λ w(λ)` with `w` nearly constant, so secants are drawn for `1/λ - w` over `1/λ`,
/// which is straight if everything outboard is rigid. A guess outside the bracket, or beyond a pole of
/// `w` (an inner pivot not positive), is replaced by the middle of the bracket.
pub fn lowest_eigenvalue<const N: usize>(steps: &[Step<'_, N>], trace_s2: f64) -> f64 {
    if trace_s2 <= 0.0 {
        return f64::INFINITY;
    }
    let (mut low, mut high) = (0.0, f64::INFINITY);
    let mut guess = 1.0 / trace_s2;
    // the last two points at which the curve was sound: 1/λ and 1/λ - w
    let mut before: Option<(f64, f64)> = None;
    for _ in 0..MOST_PASSES {
        let here = pass(steps, guess);
        if here.inner_sound && here.last > 0.0 {
            low = guess;
        } else {
            high = guess;
        }
        if high.is_finite() && high - low <= 4.0 * f64::EPSILON * high {
            return low;
        }
        let next = if here.inner_sound {
            let point = (1.0 / guess, here.last / guess);
            let inverse = match before {
                Some((x, y)) if y != point.1 => point.0 - point.1 * (point.0 - x) / (point.1 - y),
                _ => point.0 - point.1,
            };
            before = Some(point);
            1.0 / inverse
        } else {
            f64::NAN
        };
        if (next - guess).abs() <= SMALL_STEP * guess {
            return next;
        }
        guess = match next > low && next < high {
            true => next,
            false if high.is_finite() => 0.5 * (low + high),
            false => 2.0 * low,
        };
    }
    low
}

/// Frequency of an eigenvalue \[Hz\].
pub fn frequency_hz(eigenvalue: f64) -> f64 {
    eigenvalue.sqrt() / TAU
}

/// Carries the apparent inertia from tip to base.
#[inline]
fn pass<const N: usize>(steps: &[Step<'_, N>], lambda: f64) -> Pass {
    let mut apparent = SMatrix::<f64, N, N>::zeros();
    let mut out = Pass { inner_sound: true, last: 1.0 };
    for step in steps {
        match step {
            Step::Body(mass, inertia) => apparent += *inertia * *mass,
            Step::Joint(twist, compliance) => {
                let momentum = apparent * *twist;
                let pivot = 1.0 - lambda * compliance * twist.dot(&momentum);
                apparent += momentum * momentum.transpose() * (lambda * compliance / pivot);
                out.next(pivot);
            }
            Step::Link(link) => through_link(link, lambda, &mut apparent, &mut out),
        }
    }
    out
}

#[inline]
fn through_link<const N: usize>(
    link: &BlockLink<N>,
    lambda: f64,
    apparent: &mut SMatrix<f64, N, N>,
    out: &mut Pass,
) {
    let at = |m: &[SMatrix<f64, N, N>; 3]| m[0] + (m[1] + m[2] * lambda) * lambda;
    let moved = *apparent * link.end;
    let mut s = (at(&link.end_inertia) + link.end.tr_mul(&moved)) * -lambda;
    for i in 0..N {
        s[(i, i)] += 1.0;
    }
    let mut p = (at(&link.cross) + moved).transpose();
    // LDLᵀ of 1 - λS and forward substitution of P together
    *apparent += at(&link.root);
    for k in 0..N {
        let pivot = s[(k, k)];
        out.next(pivot);
        let inverse = 1.0 / pivot;
        for i in k + 1..N {
            let factor = s[(i, k)] * inverse;
            for j in k + 1..=i {
                s[(i, j)] -= factor * s[(j, k)];
            }
            for j in 0..N {
                p[(i, j)] -= factor * p[(k, j)];
            }
        }
        let scale = lambda * inverse;
        for j in 0..N {
            let pj = p[(k, j)] * scale;
            for i in 0..N {
                apparent[(i, j)] += p[(k, i)] * pj;
            }
        }
    }
}

impl Pass {
    #[inline]
    fn next(&mut self, pivot: f64) {
        self.inner_sound &= self.last > 0.0;
        self.last = pivot;
    }
}
