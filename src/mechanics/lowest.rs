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

/// What one pass at `λ` finds.
struct Pass {
    /// Whether every pivot before the last is positive.
    inner_sound: bool,
    /// The last pivot: positive below the lowest eigenvalue, negative just above it.
    last: f64,
}

/// Relative change of `λ` at which the root is found.
const CONVERGED: f64 = 4e-14;
const MOST_PASSES: usize = 200;

/// Lowest eigenvalue `λ₁ = ω₁²` of the chain, given `trace_s2 ≥ tr(C M)`; infinite if nothing yields.
pub fn lowest_eigenvalue<const N: usize>(steps: &[Step<'_, N>], trace_s2: f64) -> f64 {
    if trace_s2 <= 0.0 {
        return f64::INFINITY;
    }
    let (mut low, mut high) = (1.0 / trace_s2, f64::INFINITY);
    let mut low_pivot = pass(steps, low).last;
    // with the apparent inertia frozen the last pivot 1 - λ w vanishes at λ / (1 - pivot)
    let mut guess = low / (1.0 - low_pivot.min(0.5)).max(f64::MIN_POSITIVE);
    let mut high_pivot = f64::NAN;
    for _ in 0..MOST_PASSES {
        if guess <= low || guess >= high {
            guess = if high.is_finite() { 0.5 * (low + high) } else { 2.0 * low };
        }
        let here = pass(steps, guess);
        if here.inner_sound && here.last > 0.0 {
            let secant = extrapolate((low, low_pivot), (guess, here.last));
            (low, low_pivot) = (guess, here.last);
            guess =
                if high_pivot.is_nan() { secant } else { extrapolate((low, low_pivot), (high, high_pivot)) };
        } else {
            let sound = here.inner_sound;
            let secant = extrapolate((low, low_pivot), (guess, here.last));
            let previous = (high, high_pivot);
            (high, high_pivot) = (guess, if sound { here.last } else { f64::NAN });
            guess = match (sound, previous.1.is_nan()) {
                (false, _) => 0.5 * (low + high),
                (true, true) => secant,
                // both secants of a concave pivot: from above it is the sharper
                (true, false) => extrapolate(previous, (high, high_pivot)).max(secant),
            };
        }
        if (high - low).abs() <= CONVERGED * low || (guess - low).abs() <= CONVERGED * low {
            return guess.clamp(low, high);
        }
        if high.is_finite() && (high - guess).abs() <= CONVERGED * high {
            return guess.clamp(low, high);
        }
    }
    low
}

/// Frequency of an eigenvalue \[Hz\].
pub fn frequency_hz(eigenvalue: f64) -> f64 {
    eigenvalue.sqrt() / TAU
}

fn extrapolate((x0, y0): (f64, f64), (x1, y1): (f64, f64)) -> f64 {
    x1 - y1 * (x1 - x0) / (y1 - y0)
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
