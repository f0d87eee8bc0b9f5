//! Value, slope and curvature (second derivative) of a sampled signal. They come from a cubic polynomial that is fitted
//! to the rows around each row (the window).
//!
//! The window is the widest one in which the errors of the cubic are still no larger than the noise of the signal. A
//! wider window would distort the signal, and a narrower one would remove less noise. The noise is estimated from
//! fourth divided differences, because a smooth signal adds almost nothing to them.
//!
//! The curvature of the fitted cubic is an average of the true second derivative over the window. [`averaged`] averages
//! other signals with the same weights (the Peano kernel of the curvature). An equation between an acceleration and
//! such signals then holds exactly, however fast the acceleration changes within a window.

use crate::reconcile::readings::record::usual_step_s;
use nalgebra::{Matrix4, Vector4};

/// Half widths of the smoothing window that are tried \[rows\].
const HALF_WIDTHS: [usize; 9] = [3, 4, 6, 8, 12, 16, 24, 32, 48];
/// Largest root mean square error of the cubic in a window, as a multiple of the noise of the signal. At this value the
/// distortion of the signal is a third of the noise, because `1.05² = 1 + 0.32²`.
const STILL_NOISE: f64 = 1.05;
/// A window counts as having a gap if it lasts more than this many times as long as the same number of usual steps.
const LONGEST: f64 = 1.5;
/// Number of rows that enter a fourth divided difference.
const FIVE: usize = 5;

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

/// Standard deviation of the noise of a signal from row to row, in the unit of the signal. It is the root mean square
/// of the fourth divided differences of the values `x` at the times `t_s` \[s\]. Each difference is first divided by
/// the root of the sum of its squared weights, which gives it the variance of the noise for any steps between the rows.
/// Differences across a gap are left out.
pub(crate) fn noise(t_s: &[f64], x: &[f64]) -> f64 {
    let longest_s = LONGEST * (FIVE - 1) as f64 * usual_step_s(t_s);
    let windows = t_s.windows(FIVE).zip(x.windows(FIVE)).filter(|(t, _)| t[FIVE - 1] - t[0] <= longest_s);
    let (squares, count) = windows.fold((0.0, 0usize), |(sum, count), (t, x)| {
        let weights = divided_difference(t);
        // the middle value is subtracted, so that a large angle loses no digits in the sum
        let difference: f64 = weights.iter().zip(x).map(|(w, value)| w * (value - x[2])).sum();
        let size: f64 = weights.iter().map(|w| w * w).sum();
        (sum + difference.powi(2) / size, count + 1)
    });
    (squares / count.max(1) as f64).sqrt()
}

/// Weights of the five values at the times `t_s` \[s\] in their fourth divided difference. The difference is the
/// weighted sum of the values; it is zero for every polynomial of degree 3 or less. Time is measured in mean steps, so
/// that the weights have no unit.
fn divided_difference(t_s: &[f64]) -> [f64; FIVE] {
    let step_s = (t_s[FIVE - 1] - t_s[0]) / (FIVE - 1) as f64;
    std::array::from_fn(|i| {
        let others = (0..FIVE).filter(|j| *j != i);
        1.0 / others.map(|j| (t_s[i] - t_s[j]) / step_s).product::<f64>()
    })
}

/// Standard deviation of the slope that [`smooth`] finds with windows of `half` rows to either side, caused by the
/// noise of the signal `x` \[unit of the signal per s\]. The slope of a cubic at the middle of its window scatters 2.5
/// times as much as that of a straight line.
pub(crate) fn slope_noise(t_s: &[f64], x: &[f64], half: usize) -> f64 {
    2.5 * noise(t_s, x) * (12.0 / ((2 * half + 1) as f64).powi(3)).sqrt() / usual_step_s(t_s)
}

/// Standard deviation of the value that [`smooth`] finds with windows of `half` rows to either side, as a fraction of
/// the noise of single rows.
pub(crate) fn value_noise(half: usize) -> f64 {
    (9.0 / (4.0 * (2 * half + 1) as f64)).sqrt()
}

/// Half width of the widest window of [`HALF_WIDTHS`] in which a cubic still fits the signal `x` up to its noise
/// \[rows\]; at least the smallest of them.
pub(crate) fn half_width(t_s: &[f64], x: &[f64]) -> usize {
    let noise = noise(t_s, x);
    let fits = |half: &&usize| {
        let smooth = smooth(t_s, x, **half);
        let left = x.iter().zip(&smooth.value).filter(|(_, v)| !v.is_nan());
        let (sum, count) = left.fold((0.0, 0usize), |(s, n), (x, v)| (s + (x - v).powi(2), n + 1));
        // the fit of a cubic takes this fraction of the noise's variance out of the residual in the middle of its
        // window
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
    let nan = vec![f64::NAN; x.len()];
    let mut out = Smooth { value: nan.clone(), slope: nan.clone(), curvature: nan };
    for i in whole_windows(t_s, half) {
        let scale = 0.5 * (t_s[i + half] - t_s[i - half]);
        let (mut normal, mut right) = (Matrix4::zeros(), Vector4::zeros());
        for j in i - half..=i + half {
            let powers = powers((t_s[j] - t_s[i]) / scale);
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

/// The powers 0 to 3 of `u`.
fn powers(u: f64) -> Vector4<f64> {
    Vector4::new(1.0, u, u * u, u * u * u)
}

/// Indices of the rows whose window, from `half` rows before to `half` rows after, is within the signal and has no gap.
fn whole_windows(t_s: &[f64], half: usize) -> impl Iterator<Item = usize> {
    let longest_s = usual_step_s(t_s) * (2 * half) as f64 * LONGEST;
    (half..t_s.len().saturating_sub(half)).filter(move |i| t_s[i + half] - t_s[i - half] <= longest_s)
}

/// Averages of several signals over the window around each row, one list for each signal. The weights are those with
/// which the curvature of [`smooth`] averages the second derivative. Rows near an end or a gap are NaN. The second
/// result is the standard deviation of the noise after averaging, as a fraction of that before: `sqrt(sum w^2)` for the
/// weights `w` of a window, as a root mean square over the windows.
pub(crate) fn averaged<const N: usize>(
    t_s: &[f64],
    half: usize,
    signals: [&[f64]; N],
) -> ([Vec<f64>; N], f64) {
    let mut out: [Vec<f64>; N] = std::array::from_fn(|_| vec![f64::NAN; t_s.len()]);
    let (mut squares, mut count) = (0.0, 0usize);
    for i in whole_windows(t_s, half) {
        let Some(weights) = curvature_kernel(&t_s[i - half..=i + half], half) else { continue };
        squares += weights.iter().map(|w| w * w).sum::<f64>();
        count += 1;
        for (out, signal) in out.iter_mut().zip(signals) {
            let window = &signal[i - half..=i + half];
            // the middle value is subtracted, so that a large angle loses no digits in the sum
            let sum: f64 = weights.iter().zip(window).map(|(w, x)| w * (x - window[half])).sum();
            out[i] = window[half] + sum;
        }
    }
    (out, (squares / count.max(1) as f64).sqrt())
}

/// Weights of the rows at the times `t_s` \[s\] of a window. With these weights, the curvature of the cubic fitted to
/// the window averages the second derivative of the signal. The curvature at the row `middle` is `sum_j d_j x(t_j)`,
/// and `sum_j d_j x(t_j)` is the integral of `k(t) x''(t)` with `k(t) = sum_j d_j max(t_j - t, 0)` (Peano). The
/// integral is computed by the trapezoidal rule. The sum of the weights is 1. `None` if no cubic is determined.
fn curvature_kernel(t_s: &[f64], middle: usize) -> Option<Vec<f64>> {
    let last = t_s.len() - 1;
    let scale = 0.5 * (t_s[last] - t_s[0]);
    let u: Vec<f64> = t_s.iter().map(|t| (t - t_s[middle]) / scale).collect();
    let normal = u.iter().map(|u| powers(*u)).fold(Matrix4::zeros(), |sum, p| sum + p * p.transpose());
    let of_curvature = normal.cholesky()?.solve(&Vector4::new(0.0, 0.0, 2.0, 0.0));
    let mut weights = vec![0.0; t_s.len()];
    let (mut slope, mut kernel) = (0.0, 0.0);
    for i in (1..last).rev() {
        slope += of_curvature.dot(&powers(u[i + 1]));
        kernel += slope * (u[i + 1] - u[i]);
        weights[i] = kernel * 0.5 * (u[i + 1] - u[i - 1]);
    }
    let sum: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|w| *w /= sum);
    Some(weights)
}

/// Slope of the signal `x` at each row, from the rows before and after it \[unit of the signal per s\]. NaN at the
/// ends, and where the signal is NaN before or after the row.
pub(crate) fn slope(t_s: &[f64], x: &[f64]) -> Vec<f64> {
    let mut out = vec![f64::NAN; x.len()];
    for i in 1..x.len().saturating_sub(1) {
        out[i] = (x[i + 1] - x[i - 1]) / (t_s[i + 1] - t_s[i - 1]);
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
    fn an_average_of_the_second_derivative_is_the_curvature() {
        // the second derivative jumps within the windows, and the times are uneven
        let t: Vec<f64> = (0..400).map(|i| 0.001 * i as f64 + 0.0002 * libm::sin(i as f64)).collect();
        let jump_s = 0.2;
        let x: Vec<f64> = t.iter().map(|t| 0.5 * (t - jump_s).max(0.0).powi(2)).collect();
        let second: Vec<f64> = t.iter().map(|t| if *t > jump_s { 1.0 } else { 0.0 }).collect();
        let curvature = smooth(&t, &x, 16).curvature;
        let ([average], _) = averaged(&t, 16, [&second]);
        let pairs = curvature.iter().zip(&average).filter(|(c, _)| !c.is_nan());
        // the jump lies between two rows, which makes an error of half a row in a window of 32 rows, times the largest
        // weight
        let worst = pairs.map(|(c, a)| (c - a).abs()).fold(0.0, f64::max);
        assert!(worst < 0.04, "{worst}");
    }

    #[test]
    fn noise_is_the_same_with_gaps_and_uneven_steps() {
        let rows = (0..4000).filter(|i| i % 17 != 0 && !(1000..1400).contains(i));
        let t: Vec<f64> = rows.map(|i| 0.001 * i as f64 + 0.0002 * libm::sin(3.0 * i as f64)).collect();
        let noisy = |(t, e): (&f64, f64)| libm::sin(9.0 * t) + 1e-6 * e;
        let x: Vec<f64> = t.iter().zip(deviates(t.len())).map(noisy).collect();
        assert!((noise(&t, &x) / 1e-6 - 1.0).abs() < 0.05, "{}", noise(&t, &x));
    }

    #[test]
    fn an_average_leaves_its_gain_of_the_noise() {
        let t: Vec<f64> = (0..20_000).map(|i| 0.001 * i as f64).collect();
        for half in [3, 8, 24] {
            let ([average], gain) = averaged(&t, half, [&deviates(t.len())]);
            let known: Vec<f64> = average.into_iter().filter(|x| !x.is_nan()).collect();
            let left = (known.iter().map(|x| x * x).sum::<f64>() / known.len() as f64).sqrt();
            // three standard deviations of a root mean square of as many independent averages as there are windows
            let windows = t.len() as f64 / (2 * half + 1) as f64;
            assert!((left / gain - 1.0).abs() < 3.0 / (2.0 * windows).sqrt(), "{half}: {left} for {gain}");
        }
    }

    #[test]
    fn the_noise_of_a_smooth_signal_is_found_and_widens_the_window() {
        let t: Vec<f64> = (0..4000).map(|i| 0.001 * i as f64).collect();
        let with = |size: f64| -> Vec<f64> {
            t.iter().zip(deviates(4000)).map(|(t, e)| libm::sin(9.0 * t) + size * e).collect()
        };
        assert!((noise(&t, &with(0.01)) / 0.01 - 1.0).abs() < 0.05);
        assert!(half_width(&t, &with(1e-2)) > half_width(&t, &with(1e-7)));
    }
}
