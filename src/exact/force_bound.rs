//! Forces that a region holds between two bounds.
//!
//! The torque on a gear is a sum over the weights outboard. Where its interval is wide the products of force and
//! compliance are known badly, and no single level's options are to blame; so a region may be parted by the torque
//! itself ([`parting`](super::parting)). What is known of one force then says something of every other force that the
//! same weights make.

use super::pose::Row;

/// Rounding of a force.
const ROUNDING: f64 = 1e-12;

/// A force of a judged case between two bounds.
#[derive(Debug, Clone, Copy)]
pub(super) struct ForceBound {
    pub case: usize,
    /// Its row in the case.
    pub row: usize,
    pub between: [f64; 2],
}

impl ForceBound {
    /// Bounds of another force made by weights between bounds.
    ///
    /// For any `a` the force is `a` times the held one, plus what is left of it: a sum over the weights. The bound is
    /// piecewise linear in `a` and best where a weight drops out of what is left.
    pub fn tighten(&self, of: &Row, by: &Row, weights: &[[f64; 2]], force: &mut [f64; 2]) {
        for (held, per_n) in by.per_n.iter().enumerate().filter(|(_, c)| **c != 0.0) {
            let a = of.per_n.get(held).copied().unwrap_or(0.0) / per_n;
            if a == 0.0 {
                continue;
            }
            let [x, y] = self.between.map(|f| a * (f - by.fixed));
            let (mut low, mut high) = (of.fixed + x.min(y), of.fixed + x.max(y));
            // where a coefficient is hardly more than rounding `a` is large, and what is left next to nothing beside it
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
