//! Free vibration after a stop: the motor stands still, and the link vibrates in the lowest mode of the arm with locked
//! motors.
//!
//! A stretch is a run of rows in which the motor stands still. A straight line and one damped oscillation, `a + b t +
//! exp(-d t) (C cos 2 pi f t + S sin 2 pi f t)`, are fitted to the twist in a stretch. The frequency `f` starts at the
//! peak of the spectrum. Gauss-Newton steps improve it together with the decay rate `d`.

use super::blocks::{rows_per_reading, student_quantile};
use super::smooth::{half_width, noise, slope_noise, smooth};
use crate::reconcile::model::estimate::Estimate;
use crate::reconcile::readings::record::usual_step_s;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

/// The motor is taken as standing still if its speed is below this fraction of its largest speed in the record.
const AT_REST: f64 = 0.02;
/// A stretch with fewer rows than this is not fitted.
const FEWEST_ROWS: usize = 60;
/// Only this many rows of a stretch are fitted, because the vibration has decayed by then.
const MOST_ROWS: usize = 4000;
/// A stretch must contain at least this many periods of the vibration.
const FEWEST_PERIODS: f64 = 4.0;
/// Highest frequency of a vibration that is sought, as a fraction of the sampling rate of the record.
const HIGHEST_PART: f64 = 0.2;
/// The oscillation must explain at least this fraction of the sum of squares that a straight line alone leaves.
const TELLING: f64 = 0.6;
/// The root mean square of the oscillation of the twist must be at least this multiple of the noise of the twist from
/// row to row.
const LOUD: f64 = 4.0;
/// Largest number of Gauss-Newton steps that improve frequency and decay rate.
const ROUNDS: usize = 30;

/// Frequency and damping of the free vibration of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ringing {
    /// Frequency of the damped vibration \[Hz\].
    pub frequency_hz: Estimate,
    /// Damping ratio: the damping as a fraction of critical damping \[-\].
    pub damping: f64,
    /// Number of stretches in which the vibration was found. A stretch is a run of rows in which the motor stands
    /// still.
    pub stretches: usize,
}

#[derive(Debug, Clone, Copy)]
struct Swing {
    frequency_hz: f64,
    decay_per_s: f64,
    deviation_hz: f64,
}

/// Finds free vibrations in one record of one joint, from the angles of motor and link. Each result belongs to one
/// stretch in which the motor stands still. The result is the frequency \[Hz\], the decay rate \[1/s\] and the standard
/// deviation of the frequency \[Hz\].
pub(crate) fn swings(t_s: &[f64], motor_rad: &[f64], link_rad: &[f64]) -> Vec<(f64, f64, f64)> {
    let half = half_width(t_s, motor_rad);
    let speed = smooth(t_s, motor_rad, half).slope;
    let fastest = speed.iter().filter(|w| !w.is_nan()).fold(0.0f64, |m, w| m.max(w.abs()));
    let slow = (AT_REST * fastest).max(4.0 * slope_noise(t_s, motor_rad, half));
    let level = libm::hypot(noise(t_s, motor_rad), noise(t_s, link_rad));
    let mut out = Vec::new();
    let mut begin = 0usize;
    // the last value stands for the end of the record, which ends a stretch
    let moves = speed.iter().map(|w| w.is_nan() || w.abs() > slow).chain([true]);
    for (i, _) in moves.enumerate().filter(|(_, moves)| *moves) {
        if i.saturating_sub(begin) >= FEWEST_ROWS {
            let end = i.min(begin + MOST_ROWS);
            let twist: Vec<f64> = (begin..end).map(|k| motor_rad[k] - link_rad[k]).collect();
            out.extend(swing(&t_s[begin..end], &twist, level));
        }
        // for the next `half` rows the smoothing window still contains motion, so the stretch begins behind them
        begin = i + 1 + half;
    }
    out.into_iter().map(|s| (s.frequency_hz, s.decay_per_s, s.deviation_hz)).collect()
}

/// Joins the vibrations of all stretches, as [`swings`] gives them, into one frequency and damping ratio. Only
/// frequencies within 20 % of the median are used. `None` if these are fewer than half of the stretches, or none. The
/// interval of the frequency is at least as wide as the scatter of the frequencies requires.
pub(crate) fn joined(swings: &[(f64, f64, f64)]) -> Option<Ringing> {
    let median = crate::reconcile::fit::stats::median(swings.iter().map(|s| s.0).collect());
    let alike: Vec<_> = swings.iter().filter(|s| (s.0 / median - 1.0).abs() < 0.2).collect();
    if alike.is_empty() || 2 * alike.len() < swings.len() {
        return None;
    }
    let weight = |s: &&(f64, f64, f64)| 1.0 / s.2.powi(2);
    let total: f64 = alike.iter().map(&weight).sum();
    let mean = |of: fn(&(f64, f64, f64)) -> f64| alike.iter().map(|s| weight(s) * of(s)).sum::<f64>() / total;
    let (frequency_hz, decay) = (mean(|s| s.0), mean(|s| s.1));
    let count = alike.len() as f64;
    let scatter: f64 = alike.iter().map(|s| weight(s) * (s.0 - frequency_hz).powi(2)).sum::<f64>();
    let by_scatter = if count > 1.5 { scatter / (count - 1.0) } else { 1.0 };
    let dof = if count > 1.5 && by_scatter > 1.0 { count - 1.0 } else { 30.0 };
    let half = student_quantile(dof) * (by_scatter.max(1.0) / total).sqrt();
    let ends = |sign: f64| Some(frequency_hz + sign * half);
    Some(Ringing {
        frequency_hz: Estimate { value: frequency_hz, low: ends(-1.0), high: ends(1.0) },
        damping: decay / libm::hypot(TAU * frequency_hz, decay),
        stretches: alike.len(),
    })
}

/// Fits the vibration of one stretch. `noise_rad` is the standard deviation of the noise of the twist from row to row
/// \[rad\]. `None` if the oscillation is too short, too small, or explains too little of the twist.
fn swing(t_s: &[f64], twist_rad: &[f64], noise_rad: f64) -> Option<Swing> {
    let step = usual_step_s(t_s);
    let t: Vec<f64> = t_s.iter().map(|t| t - t_s[0]).collect();
    let duration = t[t.len() - 1];
    let mut guess = peak(&t, twist_rad, FEWEST_PERIODS / duration, HIGHEST_PART / step)?;
    let mut best: Option<(f64, [f64; 2])> = None;
    for decay in [0.0, 1.0 / duration, 4.0 / duration] {
        let (squares, end) = descend(&t, twist_rad, [guess, decay]);
        if best.is_none_or(|(b, _)| squares < b) {
            best = Some((squares, end));
        }
    }
    let (squares, [frequency, decay]) = best?;
    guess = frequency;
    let straight = squares_of(&t, twist_rad, &[]).0;
    let amplitude = ((straight - squares).max(0.0) / t.len() as f64).sqrt();
    let in_range =
        guess * duration >= FEWEST_PERIODS && guess < HIGHEST_PART / step && decay >= -0.5 / duration;
    if !in_range || squares > (1.0 - TELLING) * straight || amplitude < LOUD * noise_rad {
        return None;
    }
    // number of periods before the amplitude has fallen to a third
    let periods = guess * duration.min(1.1 / decay.max(1e-9));
    (periods > 2.0).then(|| Swing {
        frequency_hz: guess,
        decay_per_s: decay,
        deviation_hz: deviation_hz(&t, twist_rad, [guess, decay]),
    })
}

/// Frequency between `low_hz` and `high_hz` at which the spectrum of the signal `x` has its maximum \[Hz\]. A straight
/// line is removed from the signal first. `None` if the spectrum is zero.
fn peak(t: &[f64], x: &[f64], low_hz: f64, high_hz: f64) -> Option<f64> {
    let (_, errors) = squares_of(t, x, &[]);
    let duration = t[t.len() - 1];
    let count = ((high_hz - low_hz) * duration * 2.0).max(0.0) as usize;
    let turn = |f: f64| t.iter().map(move |t| libm::sincos(TAU * f * t));
    // rotates the sine and cosine of each row from one frequency to the next, which is faster than computing them for
    // each frequency
    let mut now: Vec<(f64, f64)> = turn(low_hz).collect();
    let on: Vec<(f64, f64)> = turn(0.5 / duration).collect();
    let mut best = (0.0, None);
    for i in 0..=count {
        let sum =
            now.iter().zip(&errors).fold((0.0, 0.0), |(s, c), ((sin, cos), e)| (s + e * sin, c + e * cos));
        let power = sum.0 * sum.0 + sum.1 * sum.1;
        if power > best.0 {
            best = (power, Some(low_hz + 0.5 * i as f64 / duration));
        }
        for ((sin, cos), (ds, dc)) in now.iter_mut().zip(&on) {
            (*sin, *cos) = (*sin * dc + *cos * ds, *cos * dc - *sin * ds);
        }
    }
    best.1
}

/// Sum of squared errors of a least-squares fit of `x` by a straight line and the given columns, and the errors
/// themselves, one per row.
fn squares_of(t: &[f64], x: &[f64], columns: &[Vec<f64>]) -> (f64, Vec<f64>) {
    let (errors, _) = solved(t, x, columns);
    (errors.iter().map(|e| e * e).sum(), errors)
}

/// Errors of a least-squares fit of `x` by a straight line and the given columns, and the coefficients of these
/// columns.
fn solved(t: &[f64], x: &[f64], columns: &[Vec<f64>]) -> (Vec<f64>, Vec<f64>) {
    let n = t.len();
    let p = 2 + columns.len();
    let mean = x.iter().sum::<f64>() / n as f64;
    let a = DMatrix::from_fn(n, p, |i, j| match j {
        0 => 1.0,
        1 => t[i] / t[n - 1],
        _ => columns[j - 2][i],
    });
    let b = DVector::from_iterator(n, x.iter().map(|x| x - mean));
    let mut normal = a.tr_mul(&a);
    for i in 0..p {
        normal[(i, i)] *= 1.0 + 1e-12;
    }
    let Some(c) = normal.cholesky().map(|c| c.solve(&a.tr_mul(&b))) else {
        return (b.as_slice().to_vec(), Vec::new());
    };
    let errors = b - a * &c;
    (errors.as_slice().to_vec(), c.as_slice()[2..].to_vec())
}

/// Columns of a damped cosine and a damped sine with the frequency `f` \[Hz\] and the decay rate `d` \[1/s\] at the
/// times `t` \[s\].
fn swing_columns(t: &[f64], [f, d]: [f64; 2]) -> [Vec<f64>; 2] {
    let column = |part: fn(f64) -> f64| t.iter().map(|t| libm::exp(-d * t) * part(TAU * f * t)).collect();
    [column(libm::cos), column(libm::sin)]
}

/// Improves frequency and decay rate by Gauss-Newton steps that start at the frequency \[Hz\] and decay rate \[1/s\] in
/// `at`. The amplitudes are solved for at each step. Returns the smallest sum of squared errors, and the frequency and
/// decay rate that give it.
fn descend(t: &[f64], x: &[f64], mut at: [f64; 2]) -> (f64, [f64; 2]) {
    let squares = |at: [f64; 2]| squares_of(t, x, &swing_columns(t, at)).0;
    let mut now = squares(at);
    for _ in 0..ROUNDS {
        let (_, c) = solved(t, x, &tangents(t, x, at));
        let [Some(df), Some(dd)] = [c.get(2), c.get(3)].map(|c| c.copied()) else { break };
        let mut part = 1.0;
        let mut moved = false;
        while part > 1e-3 && !moved {
            let next = [at[0] + part * df, at[1] + part * dd];
            let then = squares(next);
            moved = next[0] > 0.0 && then < now * (1.0 - 1e-12);
            if moved {
                (at, now) = (next, then);
            }
            part *= 0.5;
        }
        if !moved {
            break;
        }
    }
    (now, at)
}

/// The columns of the damped cosine and sine with the frequency and decay rate `at`, then the derivatives of the
/// oscillation with respect to frequency and decay rate at the best amplitudes.
fn tangents(t: &[f64], x: &[f64], at: [f64; 2]) -> [Vec<f64>; 4] {
    let [cos, sin] = swing_columns(t, at);
    let (_, c) = solved(t, x, &[cos.clone(), sin.clone()]);
    let (a, b) = (c.first().copied().unwrap_or_default(), c.get(1).copied().unwrap_or_default());
    let by_frequency = (0..t.len()).map(|i| TAU * t[i] * (b * cos[i] - a * sin[i])).collect();
    let by_decay = (0..t.len()).map(|i| -t[i] * (a * cos[i] + b * sin[i])).collect();
    [cos, sin, by_frequency, by_decay]
}

/// Standard deviation of the fitted frequency \[Hz\]. The autocorrelation of the errors is taken into account, which
/// makes it larger than for independent errors.
fn deviation_hz(t: &[f64], x: &[f64], at: [f64; 2]) -> f64 {
    let columns = tangents(t, x, at);
    let (errors, _) = solved(t, x, &columns);
    let a = DMatrix::from_fn(t.len(), 6, |i, j| match j {
        0 => 1.0,
        1 => t[i] / t[t.len() - 1],
        _ => columns[j - 2][i],
    });
    let scale: Vec<f64> = (0..6).map(|j| a.column(j).norm().max(1e-300)).collect();
    let scaled = DMatrix::from_fn(t.len(), 6, |i, j| a[(i, j)] / scale[j]);
    let inverse = scaled.tr_mul(&scaled).try_inverse();
    let variance =
        errors.iter().map(|e| e * e).sum::<f64>() / (t.len() - 6) as f64 * rows_per_reading(&errors);
    inverse.map_or(f64::INFINITY, |m| (m[(4, 4)].max(0.0) * variance).sqrt() / scale[4]).max(1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_damped_swing_after_a_stop_is_found() {
        let t: Vec<f64> = (0..3000).map(|i| 0.001 * i as f64).collect();
        let motor: Vec<f64> =
            t.iter().map(|t| if *t < 1.0 { 0.5 * t * t * (3.0 - 2.0 * t) } else { 0.5 }).collect();
        let swing = |t: f64| 1e-3 * libm::exp(-1.5 * (t - 1.0)) * libm::cos(TAU * 11.3 * (t - 1.0));
        let link: Vec<f64> =
            t.iter().zip(&motor).map(|(t, m)| m - if *t > 1.0 { swing(*t) } else { 0.0 }).collect();
        let found = joined(&swings(&t, &motor, &link)).expect("a swing");
        assert!((found.frequency_hz.value - 11.3).abs() < 0.01, "{found:?}");
        // the vibration starts between two rows, so that its start is uncertain by one row
        assert!((found.damping / (1.5 / (TAU * 11.3)) - 1.0).abs() < 0.1, "{found:?}");
    }

    #[test]
    fn a_resting_joint_without_a_swing_has_none() {
        let t: Vec<f64> = (0..3000).map(|i| 0.001 * i as f64).collect();
        let noise = |i: usize| 1e-6 * ((i * 7919) % 101) as f64;
        let link: Vec<f64> = (0..3000).map(noise).collect();
        assert!(joined(&swings(&t, &vec![0.0; 3000], &link)).is_none());
    }
}
