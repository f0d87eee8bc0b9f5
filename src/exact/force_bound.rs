//! Bounds on a force. Together with the options that remain they define a region.
//!
//! The torque on a gear is a sum over the weights outboard. Where its interval is wide, the products of force and
//! compliance are bounded poorly, and no single level is the cause. So a region may be halved by the torque itself
//! ([`branching`](super::branching)). A bound on one force then tightens the interval of every other force that the
//! same weights cause.

use super::pose::Row;

/// Relative margin for the rounding of a force.
const ROUNDING: f64 = 1e-12;

/// An interval to which the region restricts one generalized force of a judged case. A judged case counts
/// for deflection and lowest mode.
#[derive(Debug, Clone, Copy)]
pub(super) struct ForceBound {
    /// Index of the case among all cases of the study.
    pub case: usize,
    /// Index of the force's row among the rows of the case.
    pub row: usize,
    /// Least and greatest allowed force \[N or N m\]; infinite on a side without a bound.
    pub between: [f64; 2],
}

impl ForceBound {
    /// Tightens the interval `force` of another generalized force, which the same weights cause. `by` is the row of
    /// the force that this bound restricts, and `of` is the row of the other force. A row gives a force as a linear
    /// function of the weights. `weights` are the intervals of the weights \[N\].
    ///
    /// For any number `a`, the other force equals `a` times the restricted force plus a remainder that is linear in
    /// the weights. The interval of this sum bounds the other force. The bound is piecewise linear in `a`. It is best
    /// at some value of `a` for which a weight drops out of the remainder, so all these values are tried.
    pub(super) fn tighten(&self, of: &Row, by: &Row, weights: &[[f64; 2]], force: &mut [f64; 2]) {
        for (weight, per_n) in by.per_n.iter().enumerate().filter(|(_, c)| **c != 0.0) {
            let a = of.per_n.get(weight).copied().unwrap_or(0.0) / per_n;
            if a == 0.0 {
                continue;
            }
            let [x, y] = self.between.map(|f| a * (f - by.fixed));
            let (mut low, mut high) = (of.fixed + x.min(y), of.fixed + x.max(y));
            // Where a coefficient is little more than rounding, `a` is large and the remainder is the
            // difference of large numbers. The margin grows with their size.
            let (mut low_size, mut high_size) =
                (of.fixed.abs() + x.min(y).abs(), of.fixed.abs() + x.max(y).abs());
            for (k, w) in weights.iter().enumerate() {
                let at = |per_n: &[f64]| per_n.get(k).copied().unwrap_or(0.0);
                let left = at(&of.per_n) - a * at(&by.per_n);
                let (x, y) = (left * w[0], left * w[1]);
                low += x.min(y);
                high += x.max(y);
                low_size += x.min(y).abs();
                high_size += x.max(y).abs();
            }
            force[0] = force[0].max(low - ROUNDING * low_size);
            force[1] = force[1].min(high + ROUNDING * high_size);
        }
    }
}

#[cfg(test)]
#[path = "force_bound_tests.rs"]
mod tests;
