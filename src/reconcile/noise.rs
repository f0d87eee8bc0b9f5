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
/// The same before any effect is looked for: the few frequencies that an effect moves must not be taken away.
const FEW_UNSEEN: f64 = 0.05;
/// Channels whose readings are judged.
const CHANNELS: [Channel; 3] = [Channel::Static, Channel::Modal, Channel::Windup];
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
    pub fn first_look(forward: &Forward, bare: &Fit, weights: &Weights) -> Self {
        let residuals = declared_residuals(forward, bare);
        let close = |channel| spread(&residuals[forward.range(channel)]) < CLOSE;
        if !CHANNELS.into_iter().all(close) {
            return Self::default();
        }
        let mut outliers = Self::from_fit(forward, bare, weights).outliers;
        outliers.retain(|(_, _, size)| *size > UNMISTAKABLE);
        let in_channel = |channel| outliers.iter().filter(|(c, _, _)| *c == channel).count();
        let few: Vec<Channel> = CHANNELS
            .into_iter()
            .filter(|c| in_channel(*c) <= at_most(FEW_UNSEEN, rows(forward, *c)))
            .collect();
        outliers.retain(|(channel, _, _)| few.contains(channel));
        Self { outliers, ..Self::default() }
    }

    /// Judges the readings by the residuals of a fit, which had these weights.
    pub fn from_fit(forward: &Forward, fit: &Fit, weights: &Weights) -> Self {
        let mut noise = Self::default();
        let residuals = declared_residuals(forward, fit);
        let leverages = fit.leverages(weights);
        for channel in CHANNELS {
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
            if gross.len() > at_most(FEW, rows(forward, channel)) {
                continue;
            }
            noise.outliers.extend(gross.iter().map(|(row, size)| (channel, *row, *size)));
            let kept = range.filter(|i| !gross.iter().any(|(row, _)| *row == forward.data[*i].row));
            noise.scale[channel as usize] = scale(kept.map(|i| (residuals[i], leverages[i])));
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

/// Rows of a channel's file.
fn rows(forward: &Forward, channel: Channel) -> usize {
    forward.data[forward.range(channel)].iter().map(|d| d.row).max().map_or(0, |r| r + 1)
}

/// A part of the rows of a file, one at least.
fn at_most(part: f64, rows: usize) -> usize {
    ((part * rows as f64) as usize).max(1)
}

/// Measured less predicted, in declared standard deviations.
fn declared_residuals(forward: &Forward, fit: &Fit) -> Vec<f64> {
    forward.data.iter().zip(&fit.point.predicted).map(|(d, p)| (d.value - p) / d.sigma).collect()
}

/// Standard deviation of most residuals, whatever the few largest are.
fn spread(residuals: &[f64]) -> f64 {
    1.4826 * median(residuals.iter().map(|r| r.abs()).collect())
}

/// Factor on declared deviations from residuals and their leverages. The square of a residual is expected to be
/// `1 - leverage`, for the rest of it the parameters have taken up. A factor within what chance does to honest
/// declarations counts too: to wait until it is significant would leave intervals too narrow wherever a channel
/// has few readings.
fn scale(kept: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (sum, count) =
        kept.fold((TRUST, TRUST), |(sum, count), (r, leverage)| (sum + r * r, count + 1.0 - leverage));
    (sum / count).sqrt().clamp(1.0, LARGEST_SCALE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forty_readings_a_sixth_noisier_than_declared_are_scaled_though_chance_could_do_that() {
        // of 40 squares with a quarter of each taken up by parameters, declared 1, true 1.15
        let readings = (0..40).map(|_| (1.15 * 0.75f64.sqrt(), 0.25));
        assert!((scale(readings) - ((15.0 + 30.0 * 1.15f64.powi(2)) / 45.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn a_declaration_is_neither_improved_nor_blamed_for_missing_physics() {
        assert_eq!(scale((0..40).map(|_| (0.5, 0.0))), 1.0);
        assert_eq!(scale((0..40).map(|_| (5.0, 0.0))), LARGEST_SCALE);
    }
}
