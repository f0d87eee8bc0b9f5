//! Value, slope and curvature of a sampled signal, from a cubic fitted to the rows around each row.
//!
//! The window is the widest one whose misfit is still the signal's own noise: a wider one would distort the signal, a
//! narrower one would remove less noise. The noise is estimated from fourth differences, to which a smooth signal
//! contributes nothing.

use nalgebra::{Matrix4, Vector4};

/// Half widths of the smoothing window that are tried \[rows\].
const HALF_WIDTHS: [usize; 9] = [3, 4, 6, 8, 12, 16, 24, 32, 48];
/// Largest misfit of a window (root mean square), as a multiple of the signal's noise. At this value the distortion
/// by the window is a third of the noise.
const STILL_NOISE: f64 = 1.05;
/// A window that lasts this many times as long as its usual steps has a gap between its rows.
const LONGEST: f64 = 1.5;
/// Sum of the squares of the weights of a fourth difference (1, -4, 6, -4, 1).
const FOURTH_DIFFERENCE_VARIANCE: f64 = 70.0;

/// Smoothed value and derivatives of a signal, one per row. The entries of rows that are too near to an end or a gap
/// are NaN.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Smooth {
    /// Smoothed value, in the unit of the signal.
    pub value: Vec<f64>,
    /// First derivative with respect to time \[unit of the signal per s\].
    pub slope: Vec<f64>,
    /// Second derivative with respect to time \[unit of the signal per s²\].
    pub curvature: Vec<f64>,
}

/// Usual (median) time between rows \[s\].
pub(crate) fn usual_step_s(t_s: &[f64]) -> f64 {
    crate::reconcile::fit::stats::median(t_s.windows(2).map(|w| w[1] - w[0]).collect())
}

/// Standard deviation of the noise of a signal from row to row, from its fourth differences, in the unit of the
/// signal.
pub(crate) fn noise(x: &[f64]) -> f64 {
    let squares: f64 =
        x.windows(5).map(|w| (w[0] - 4.0 * w[1] + 6.0 * w[2] - 4.0 * w[3] + w[4]).powi(2)).sum();
    (squares / FOURTH_DIFFERENCE_VARIANCE / x.len().saturating_sub(4).max(1) as f64).sqrt()
}

/// Standard deviation of the slope that [`smooth`] finds, caused by the noise of the rows \[unit of the signal per s\].
/// The slope of a cubic at the middle of its window scatters 2.5 times as much as that of a straight line.
pub(crate) fn slope_noise(x: &[f64], half: usize, step_s: f64) -> f64 {
    2.5 * noise(x) * (12.0 / ((2 * half + 1) as f64).powi(3)).sqrt() / step_s
}

/// Standard deviation of the value that [`smooth`] finds in the middle of its window, as a part of the noise of the rows.
pub(crate) fn value_noise(half: usize) -> f64 {
    (9.0 / (4.0 * (2 * half + 1) as f64)).sqrt()
}

/// Half width of the widest window whose misfit is still the signal's own noise \[rows\].
pub(crate) fn half_width(t_s: &[f64], x: &[f64]) -> usize {
    let noise = noise(x);
    let fits = |half: &&usize| {
        let smooth = smooth(t_s, x, **half);
        let left = x.iter().zip(&smooth.value).filter(|(_, v)| !v.is_nan());
        let (sum, count) = left.fold((0.0, 0usize), |(s, n), (x, v)| (s + (x - v).powi(2), n + 1));
        // a cubic removes this fraction of the noise's variance from the residuals in the middle of its window
        let taken = value_noise(**half).powi(2);
        count > x.len() / 2 && (sum / count as f64).sqrt() <= STILL_NOISE * noise * (1.0 - taken).sqrt()
    };
    HALF_WIDTHS
        .iter()
        .take_while(|h| **h == HALF_WIDTHS[0] || fits(h))
        .last()
        .copied()
        .unwrap_or(HALF_WIDTHS[0])
}

/// Fits, at each row, a cubic to the rows from `half` before to `half` after it, and returns the value and the
/// derivatives of the cubic at this row.
pub(crate) fn smooth(t_s: &[f64], x: &[f64], half: usize) -> Smooth {
    let n = x.len();
    let step = usual_step_s(t_s);
    let nan = vec![f64::NAN; n];
    let mut out = Smooth { value: nan.clone(), slope: nan.clone(), curvature: nan };
    for i in half..n.saturating_sub(half) {
        let window = i - half..=i + half;
        let width = t_s[i + half] - t_s[i - half];
        if width > step * (2 * half) as f64 * LONGEST {
            continue;
        }
        let scale = 0.5 * width;
        let (mut normal, mut right) = (Matrix4::zeros(), Vector4::zeros());
        for j in window {
            let u = (t_s[j] - t_s[i]) / scale;
            let powers = Vector4::new(1.0, u, u * u, u * u * u);
            normal += powers * powers.transpose();
            right += powers * (x[j] - x[i]);
        }
        if let Some(c) = normal.cholesky().map(|c| c.solve(&right)) {
            out.value[i] = c[0] + x[i];
            out.slope[i] = c[1] / scale;
            out.curvature[i] = 2.0 * c[2] / scale.powi(2);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Noise that is the same in every run. Each value is the sum of twelve uniform numbers of a linear congruential
    /// generator, which is nearly a normal deviate.
    fn deviates(n: usize) -> Vec<f64> {
        let mut state = 1u64;
        let mut uniform = move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        (0..n).map(|_| (0..12).map(|_| uniform()).sum()).collect()
    }

    #[test]
    fn a_cubic_is_met_exactly_at_uneven_times() {
        let t: Vec<f64> = (0..60).map(|i| 0.01 * i as f64 + 0.002 * libm::sin(i as f64)).collect();
        let x: Vec<f64> = t.iter().map(|t| 1.0 + 2.0 * t - 3.0 * t * t + 4.0 * t * t * t).collect();
        let s = smooth(&t, &x, 6);
        let at = t[30];
        assert!((s.slope[30] - (2.0 - 6.0 * at + 12.0 * at * at)).abs() < 1e-9);
        assert!((s.curvature[30] - (-6.0 + 24.0 * at)).abs() < 1e-7);
        assert!(s.value[5].is_nan() && !s.value[6].is_nan());
    }

    #[test]
    fn the_noise_of_a_smooth_signal_is_found_and_widens_the_window() {
        let t: Vec<f64> = (0..4000).map(|i| 0.001 * i as f64).collect();
        let with = |size: f64| -> Vec<f64> {
            t.iter().zip(deviates(4000)).map(|(t, e)| libm::sin(9.0 * t) + size * e).collect()
        };
        assert!((noise(&with(0.01)) / 0.01 - 1.0).abs() < 0.05);
        assert!(half_width(&t, &with(1e-2)) > half_width(&t, &with(1e-7)));
    }
}
