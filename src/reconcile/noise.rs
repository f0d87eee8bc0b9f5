//! Gross errors and wrongly declared standard deviations, found from the residuals of a model.

use super::fit::{Fit, Weights};
use super::forward::Forward;
use super::stats::median;
use crate::arm::effect::Channel;

/// What the residuals say of the readings' quality.
#[derive(Debug, Clone, PartialEq)]
pub struct Noise {
    /// Factor on the declared standard deviations of static, modal and windup readings.
    pub scale: [f64; 3],
    /// Rows that are gross errors: channel, row from 0, size in declared standard deviations.
    pub outliers: Vec<(Channel, usize, f64)>,
}

/// Standard deviations from which a reading is a gross error.
const GROSS: f64 = 5.5;
/// The same before any effect is looked for: play or a break point can put a single reading ten off.
const UNMISTAKABLE: f64 = 16.0;
/// Part of a channel's rows that can be gross errors; more are structure.
const FEW: f64 = 0.10;
/// Largest factor on declared deviations that is put down to the declaration.
const LARGEST_SCALE: f64 = 1.3;
/// Spread of the residuals, in declared standard deviations, up to which a model fits most readings.
const CLOSE: f64 = 1.5;
/// Weight of the declaration, in readings.
const TRUST: f64 = 15.0;

impl Default for Noise {
    fn default() -> Self {
        Self { scale: [1.0; 3], outliers: Vec::new() }
    }
}

impl Noise {
    /// Weights of the data.
    pub fn weights(&self, forward: &Forward) -> Weights {
        let inverse = forward.data.iter().map(|d| {
            let gross = self.outliers.iter().any(|(c, row, _)| *c == d.channel && *row == d.row);
            if gross { 0.0 } else { 1.0 / (d.sigma * self.scale[d.channel as usize]) }
        });
        Weights { inverse: inverse.collect(), smooth_only: false }
    }

    /// Gross errors that show before any effect is looked for: only where calibration alone comes close
    /// to most readings, because what an effect does must not be taken for an error.
    pub fn first_look(forward: &Forward, bare: &Fit) -> Self {
        let residuals = declared_residuals(forward, bare);
        let close = |channel| spread(&residuals[forward.range(channel)]) < CLOSE;
        if ![Channel::Static, Channel::Modal, Channel::Windup].into_iter().all(close) {
            return Self::default();
        }
        let mut outliers = Self::from_fit(forward, bare).outliers;
        outliers.retain(|(_, _, size)| *size > UNMISTAKABLE);
        Self { outliers, ..Self::default() }
    }

    /// Judges the readings by the residuals of a fit.
    pub fn from_fit(forward: &Forward, fit: &Fit) -> Self {
        let mut noise = Self::default();
        let residuals = declared_residuals(forward, fit);
        let free = fit.point.u.len() as f64 / forward.data.len().max(1) as f64;
        for channel in [Channel::Static, Channel::Modal, Channel::Windup] {
            let range = forward.range(channel);
            let own = &residuals[range.clone()];
            let limit = GROSS * spread(own).clamp(1.0, 3.0);
            let mut gross: Vec<(usize, f64)> = Vec::new();
            for (r, datum) in own.iter().zip(&forward.data[range.clone()]) {
                if r.abs() > limit {
                    match gross.iter_mut().find(|(row, _)| *row == datum.row) {
                        Some((_, size)) => *size = size.max(r.abs()),
                        None => gross.push((datum.row, r.abs())),
                    }
                }
            }
            let rows = forward.data[range.clone()].iter().map(|d| d.row).max().map_or(0, |r| r + 1);
            if gross.len() as f64 > (FEW * rows as f64).max(1.0) {
                continue;
            }
            noise.outliers.extend(gross.iter().map(|(row, size)| (channel, *row, *size)));
            noise.scale[channel as usize] = scale(own, &forward.data[range], &gross, free);
        }
        noise
    }

    /// Whether two judgements leave out the same rows.
    pub fn same_rows(&self, other: &Self) -> bool {
        let rows = |n: &Self| n.outliers.iter().map(|(c, r, _)| (*c, *r)).collect::<Vec<_>>();
        rows(self) == rows(other)
    }

    /// Whether two judgements lead to the same weights, nearly.
    pub fn agrees(&self, other: &Self) -> bool {
        self.same_rows(other) && self.scale.iter().zip(&other.scale).all(|(a, b)| (a / b - 1.0).abs() < 0.03)
    }
}

/// Measured less predicted, in declared standard deviations.
fn declared_residuals(forward: &Forward, fit: &Fit) -> Vec<f64> {
    forward.data.iter().zip(&fit.point.predicted).map(|(d, p)| (d.value - p) / d.sigma).collect()
}

/// Standard deviation of most residuals, whatever the few largest are.
fn spread(residuals: &[f64]) -> f64 {
    1.4826 * median(residuals.iter().map(|r| r.abs()).collect())
}

fn scale(
    residuals: &[f64],
    data: &[super::forward::Datum],
    gross: &[(usize, f64)],
    parameters_per_datum: f64,
) -> f64 {
    let (mut sum, mut count) = (TRUST, TRUST);
    for (r, datum) in residuals.iter().zip(data) {
        if !gross.iter().any(|(row, _)| *row == datum.row) {
            sum += r * r;
            count += 1.0 - 0.7 * parameters_per_datum;
        }
    }
    let scale = (sum / count).sqrt();
    // within what chance does to honestly declared deviations nothing is changed
    if scale < 1.0 + 1.0 / (2.0 * count).sqrt() { 1.0 } else { scale.min(LARGEST_SCALE) }
}
