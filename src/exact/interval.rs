//! Sums over weights that are known as intervals.

/// The least and the greatest value of `fixed + Σ per_n · weight` if each weight lies in its interval of `weights`
/// \[N\]. Each weight occurs once, so the interval is exact.
#[inline]
pub(super) fn interval(fixed: f64, per_n: &[f64], weights: &[[f64; 2]]) -> [f64; 2] {
    let (mut low, mut high) = (fixed, fixed);
    for (c, w) in per_n.iter().zip(weights) {
        let (a, b) = (c * w[0], c * w[1]);
        low += a.min(b);
        high += a.max(b);
    }
    [low, high]
}
