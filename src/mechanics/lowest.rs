//! The lowest natural frequency of a chain, computed without forming its mass and stiffness matrices.
//!
//! A pass goes from the tip to the base at a trial value `λ = ω²`. It computes `W(λ)`, the apparent inertia of
//! everything outboard: the inertia of a rigid body, plus what its flexibility adds. An element with unit stiffness
//! and end motion `t` changes it from `W` on its outboard side to `W_in` on its inboard side. For a joint, `t` is the
//! twist vector of its axis times the square root of its compliance; for a link see [`condensed`](super::condensed).
//! The indices r and g stand for the motion of the root and for the end coordinates, which are the six motions of the
//! link's end.
//!
//! ```text
//! W_in = W_rr + λ P (1 - λ S)⁻¹ Pᵀ,   P = (M_rg + W t),   S = M_gg + tᵀ W t
//! ```
//!
//! All pivots of all matrices `1 - λ S` are positive exactly if `λ` is below the lowest eigenvalue (Sturm). A pass
//! therefore tells on which side of the lowest eigenvalue `λ` is, and the last pivot is used to approach the
//! eigenvalue by secants. The search starts from Dunkerley's lower bound: `1/λ₁ ≤ Σ 1/λ_i = tr(C M)`.

use nalgebra::{SMatrix, SVector};
use std::f64::consts::TAU;

/// One step of a pass: a body or an elastic element, restricted to `N` of the six components of motion. Steps are
/// ordered tip first.
#[derive(Debug, Clone)]
pub(crate) enum Step<'a, const N: usize> {
    /// A body: a factor (such as a mass), and the inertia matrix that it multiplies.
    Body(f64, &'a SMatrix<f64, N, N>),
    /// A joint: the twist vector of its axis, and its compliance \[rad/(N m)\].
    Joint(&'a SVector<f64, N>, f64),
    /// A condensed link.
    Link(&'a BlockLink<N>),
}

/// A condensed link in a pose, restricted to `N` of the six components of motion. Each inertia is a list of
/// coefficients of 1, λ and λ².
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BlockLink<const N: usize> {
    /// Inertia over the motion of the root, coefficients of 1, λ and λ².
    pub root: [SMatrix<f64, N, N>; 3],
    /// Inertia between the motion of the root and the end coordinates, coefficients of 1, λ and λ².
    pub cross: [SMatrix<f64, N, N>; 3],
    /// Inertia over the end coordinates, coefficients of 1, λ and λ².
    pub end_inertia: [SMatrix<f64, N, N>; 3],
    /// Twist of everything outboard per unit of each end coordinate.
    pub end: SMatrix<f64, N, N>,
}

impl<const N: usize> BlockLink<N> {
    /// Whether the link is compliant in any direction.
    pub(crate) fn is_compliant(&self) -> bool {
        self.end.amax() > 0.0 || self.end_inertia.iter().any(|m| m.amax() > 0.0)
    }
}

/// Result of one pass at a trial value `λ`.
struct Pass {
    /// Whether all pivots except the last are positive.
    inner_sound: bool,
    /// The last pivot, which is the pivot of the innermost coordinate. It is positive where `λ` is below the lowest
    /// eigenvalue, and negative just above it.
    last: f64,
    /// Product of all pivots except the last.
    inner_product: f64,
    /// Number of pivots.
    count: i32,
}

impl Pass {
    /// Whether all eigenvalues are above the trial value `λ`, which means that every pivot is positive.
    fn below_all(&self) -> bool {
        self.inner_sound && self.last > 0.0
    }
}

/// Largest estimated error of an accepted root, relative to `1/λ`.
///
/// The error of a secant step is `C` times the product of the last two steps. `C` is about 1 for most arms and far
/// larger if a pole ([`lowest_eigenvalue`]) is near. The last three steps show how large `C` is, so the limit applies
/// to the error estimated from them.
pub(super) const SHOWN_ERROR: f64 = 1e-13;
/// Largest last step of an accepted root, relative to `1/λ`. A larger step could jump over another mode between the
/// last two points.
pub(super) const LAST_STEP: f64 = 5e-8;
/// Assumed size of the two steps before the first step of the iteration, relative to `1/λ`. The factor `C` of
/// [`SHOWN_ERROR`] is estimated as a step divided by the product of the two steps before it. So small a previous step
/// makes the estimate very large. No root is therefore accepted before the iteration has taken real steps, unless a
/// step is practically zero.
pub(super) const UNKNOWN_STEP: f64 = 1e-9;
/// The value of [`LAST_STEP`] that is used when one chain is solved by itself. It is stricter, because one more pass
/// then costs little.
const CAREFUL_LAST_STEP: f64 = 1e-11;
/// Number of passes (evaluations at one trial value) after which the quick method gives up and the careful method takes
/// over.
const QUICK_PASSES: usize = 12;
/// Number of passes after which the careful method returns its best value so far.
const MOST_PASSES: usize = 300;

/// Lowest eigenvalue `λ₁ = ω₁²` of the chain \[1/s²\], given an upper bound `trace_s2 ≥ tr(C M)` \[s²\]. It is
/// infinite if no element is compliant.
///
/// The last pivot is `1 - λ w(λ)`, where `w` is nearly constant. The secant method is therefore applied to `1/λ - w`
/// as a function of `1/λ`, which is a straight line if everything outboard is rigid. It converges quickly unless the
/// last joint hardly takes part in the mode: then a pole of `w` (a value of `λ` at which `w` is infinite) is next to
/// the root. In that case the root of the product of all pivots is searched instead. This product has no poles.
pub(crate) fn lowest_eigenvalue<const N: usize>(steps: &[Step<'_, N>], trace_s2: f64) -> f64 {
    if trace_s2 <= 0.0 {
        return f64::INFINITY;
    }
    quick_root(steps, trace_s2).unwrap_or_else(|| careful_root(steps, trace_s2))
}

/// The lowest eigenvalue \[1/s²\] by the secant method on the last pivot. `trace_s2` is an upper bound of its
/// reciprocal. `None` if a step leads beyond a pole or convergence is too slow.
fn quick_root<const N: usize>(steps: &[Step<'_, N>], trace_s2: f64) -> Option<f64> {
    let mut x = trace_s2;
    let mut before: Option<(f64, f64)> = None;
    let (mut step_before, mut step_two_before) = (UNKNOWN_STEP * x, UNKNOWN_STEP * x);
    for _ in 0..QUICK_PASSES {
        let here = pass(steps, 1.0 / x);
        // Beyond a pole the last pivot belongs to another branch of the curve, so the secant would mislead.
        if !here.inner_sound {
            return None;
        }
        let y = here.last * x;
        // For the first step `w` is taken as constant. Then 1/λ - w has the slope 1.
        let slope = before.map_or(1.0, |(x0, y0)| (y - y0) / (x - x0));
        let next = x - y / slope;
        let step = (next - x).abs();
        if y == 0.0 || (step < CAREFUL_LAST_STEP * x && step * step < SHOWN_ERROR * x * step_two_before) {
            return Some(1.0 / next).filter(|root| root.is_finite()).or(Some(1.0 / x));
        }
        if next.is_nan() || next <= 0.0 {
            return None;
        }
        (step_two_before, step_before) = (step_before, step);
        before = Some((x, y));
        x = next;
    }
    None
}

/// The lowest eigenvalue λ₁ \[1/s²\], by the secant method on the product of all pivots times a power of `x = 1/λ`.
///
/// This product is about `Π (x - x_i)`, where the `x_i` are the reciprocals of the eigenvalues. Beyond the largest
/// `x_i` it is convex, so secants from above approach this root without overshooting, however near the next root is.
/// Rounding, or the inner modes of links, may still make a step overshoot; the interval is then bisected.
fn careful_root<const N: usize>(steps: &[Step<'_, N>], trace_s2: f64) -> f64 {
    let product = |x: f64| {
        let here = pass(steps, 1.0 / x);
        here.below_all().then_some((x, here.last * here.inner_product, here.count))
    };
    // For a single spring the bound is exact, so rounding may place the root just above the bound.
    let (Some(mut far), Some(mut near)) = (product(2.0 * trace_s2), product((1.0 + 1e-9) * trace_s2)) else {
        return 1.0 / trace_s2;
    };
    let mut beyond = 0.0;
    for _ in 0..MOST_PASSES {
        // Ratio of the polynomial (about `Π (x - x_i)`) at `far` to the polynomial at `near`.
        let ratio = far.1 / near.1 * (far.0 / near.0).powi(near.2);
        let secant = near.0 - (far.0 - near.0) / (ratio - 1.0);
        let next = if secant > beyond && secant < near.0 { secant } else { 0.5 * (beyond + near.0) };
        if near.0 - next <= 1e-15 * near.0 {
            return 1.0 / next;
        }
        // The root stays between `beyond` and `near`: `beyond` is smaller than the root, and `near` is larger.
        match product(next) {
            Some(point) => (far, near) = (near, point),
            None => beyond = next,
        }
        if near.0 - beyond <= 4.0 * f64::EPSILON * near.0 {
            break;
        }
    }
    1.0 / near.0
}

/// Frequency \[Hz\] of an eigenvalue \[1/s²\].
pub(crate) fn frequency_hz(eigenvalue: f64) -> f64 {
    eigenvalue.sqrt() / TAU
}

/// One elimination pass over the chain from the tip to the base, at the trial value `lambda` of the eigenvalue `ω²`
/// \[1/s²\]. After each step, everything outboard of it is reduced to its apparent inertia at this frequency. The
/// pivots of the elimination are collected in the result.
#[inline]
fn pass<const N: usize>(steps: &[Step<'_, N>], lambda: f64) -> Pass {
    let mut apparent = SMatrix::<f64, N, N>::zeros();
    let mut out = Pass { inner_sound: true, last: 1.0, inner_product: 1.0, count: 0 };
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

/// Changes the apparent inertia from its value at the end of a compliant link to its value at the root, for the trial
/// value `lambda`. The pivots of the link are added to `out`.
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
    // This loop does two things at once: the LDLᵀ factorization of 1 - λS and the forward substitution of P.
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
    /// Records the pivot of the next coordinate. The pivot before it now counts among the inner pivots.
    #[inline]
    fn next(&mut self, pivot: f64) {
        self.inner_sound &= self.last > 0.0;
        self.inner_product *= self.last;
        self.count += 1;
        self.last = pivot;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix2, Vector2};

    /// Lowest eigenvalue of two springs in series that carry a body with inertia matrix `m`, by the quadratic
    /// formula.
    fn by_hand(m: &Matrix2<f64>, c: [f64; 2], twists: [Vector2<f64>; 2]) -> f64 {
        let a = |i: usize, j: usize| (c[i] * c[j]).sqrt() * twists[i].dot(&(m * twists[j]));
        let (mean, half) = (0.5 * (a(0, 0) + a(1, 1)), 0.5 * (a(0, 0) - a(1, 1)));
        1.0 / (mean + libm::hypot(half, a(0, 1)))
    }

    #[test]
    fn nearly_decoupled_modes_are_told_apart_whichever_is_lower() {
        let twists = [Vector2::x(), Vector2::y()];
        for coupling in [0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 0.3] {
            for second in [0.1, 0.5, 0.999, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.001, 2.0, 50.0] {
                let inertia = Matrix2::new(1.0, coupling, coupling, second);
                for c in [[1e-5, 1e-5], [1e-5, 3e-6], [2e-6, 1e-5]] {
                    let steps = [
                        Step::Body(1.0, &inertia),
                        Step::Joint(&twists[0], c[0]),
                        Step::Joint(&twists[1], c[1]),
                    ];
                    let found = lowest_eigenvalue(&steps, c[0] + c[1] * second);
                    let expected = by_hand(&inertia, c, twists);
                    let error = (found / expected - 1.0).abs();
                    assert!(error < 1e-10, "{coupling:e} {second} {c:?}: {found} {expected} {error:e}");
                }
            }
        }
    }

    #[test]
    fn springs_that_move_no_mass_do_not_matter() {
        let twists = [Vector2::x(), Vector2::y()];
        let inertia = Matrix2::new(0.0, 0.0, 0.0, 2.0);
        let steps = [Step::Body(1.0, &inertia), Step::Joint(&twists[0], 1e-3), Step::Joint(&twists[1], 1e-5)];
        assert!((lowest_eigenvalue(&steps, 2e-5) * 2e-5 - 1.0).abs() < 1e-14);
        let last = [Step::Body(1.0, &inertia), Step::Joint(&twists[1], 1e-5), Step::Joint(&twists[0], 1e-3)];
        assert!((lowest_eigenvalue(&last, 2e-5) * 2e-5 - 1.0).abs() < 1e-12);
        assert_eq!(lowest_eigenvalue::<2>(&[Step::Body(1.0, &inertia)], 0.0), f64::INFINITY);
    }
}
