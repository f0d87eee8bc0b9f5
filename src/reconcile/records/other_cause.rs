//! Causes of an error of the angles that are not effects of the library. Over a part of a turn, such a cause can look
//! like a transmission error once and twice a turn.
//!
//! - A link's encoder with a wrong gain, or a wrong gear ratio: an error in proportion to the angle.
//! - A belt, a bearing or a gear stage between motor and output: a sine wave of another order, that is with another
//!   number of waves in a turn.
//!
//! For each cause, a fit is made in which its one or two columns replace the four columns of the transmission error of
//! the output. A cause that predicts held-out blocks (blocks of time left out of the fit) clearly better, with fewer
//! columns, is nearer to the truth.

use super::blocks::Fitted;
use super::twist::{CLEARLY, Group, TwistModel, columns, fill_known};

/// First order that is tried, and the step to the next. The order is the number of sine waves in one turn of the
/// output.
const FIRST_ORDER: f64 = 0.5;
const ORDER_STEP: f64 = 0.1;
/// Number of orders that are tried.
const ORDERS: usize = 120;
/// About this number of rows, evenly spaced, is used to choose the order of a wave.
const ENOUGH_ROWS: usize = 3000;
/// A cause must lower the root mean square error on held-out blocks to less than this fraction of the error of the
/// model with the transmission error.
const LARGEST_ERROR_RATIO: f64 = 0.9;

/// A cause that explains the records better than a transmission error once and twice a turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum OtherCause {
    /// An error in proportion to the angle: the fraction by which the link's reading turns farther than the motor's
    /// \[-\], and the root mean square error of the twist on held-out blocks with this cause \[rad\].
    Gain(f64, f64),
    /// A sine wave: its order, its amplitude \[rad\], and the root mean square error with it on held-out blocks
    /// \[rad\].
    Wave(f64, f64, f64),
}

impl OtherCause {
    /// The cause as a sentence. `with` is the fit with the transmission error.
    pub(super) fn sentence(&self, with: &Fitted) -> String {
        let instead = |rms_rad: f64| {
            format!(
                "it leaves {:.4} mrad on held-out blocks, and a transmission error once and twice a turn leaves {:.4} mrad",
                1e3 * rms_rad,
                1e3 * with.held_out_rms()
            )
        };
        match *self {
            Self::Gain(gain, rms_rad) => format!(
                "an error in proportion to the angle explains the twist better than a transmission error: the link's reading \
                 turns by {:.3} % too far, from a gain of its encoder or a wrong ratio; {}",
                100.0 * gain,
                instead(rms_rad)
            ),
            Self::Wave(order, amplitude_rad, rms_rad) => format!(
                "a wave of {:.3} mrad that repeats {order:.1} times a turn of the output explains the twist better than a \
                 transmission error, as of a belt or a gear stage between motor and output; {}",
                1e3 * amplitude_rad,
                instead(rms_rad)
            ),
        }
    }

    /// Root mean square error of the twist on held-out blocks with this cause \[rad\].
    fn rms_rad(&self) -> f64 {
        match self {
            Self::Gain(_, rms_rad) | Self::Wave(_, _, rms_rad) => *rms_rad,
        }
    }
}

/// The cause that predicts held-out blocks best, if it does so clearly better than the transmission error of the
/// output. `None` if the model has no such error, or if no cause is clearly better.
pub(super) fn other_cause(model: &TwistModel) -> Option<OtherCause> {
    if !model.groups.contains(&Group::Output) {
        return None;
    }
    let (gain, wave) = (gain(model), wave(model));
    [gain, wave].into_iter().flatten().min_by(|a, b| a.rms_rad().total_cmp(&b.rms_rad()))
}

/// The error in proportion to the angle, if it is clearly better than the transmission error.
fn gain(model: &TwistModel) -> Option<OtherCause> {
    let fit = fit(model, 1, |angle_rad| [angle_rad, 0.0])?;
    let gain = -fit.value(model.places.further());
    is_better(&fit, model).then(|| OtherCause::Gain(gain, fit.held_out_rms()))
}

/// The sine wave of the best order, if it is clearly better than the transmission error.
fn wave(model: &TwistModel) -> Option<OtherCause> {
    let every = (model.rows.samples.len() / ENOUGH_ROWS).max(1);
    let tried = (0..ORDERS).map(|i| FIRST_ORDER + ORDER_STEP * i as f64);
    let errors = tried.filter_map(|order| Some((order, fit(model, every, |q| wave_of(order, q))?.squares)));
    let (order, _) = errors.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let fit = fit(model, 1, |q| wave_of(order, q))?;
    let first = model.places.further();
    let amplitude_rad = libm::hypot(fit.value(first), fit.value(first + 1));
    is_better(&fit, model).then(|| OtherCause::Wave(order, amplitude_rad, fit.held_out_rms()))
}

/// `sin` and `cos - 1` of `order` times the angle.
fn wave_of(order: f64, angle_rad: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(order * angle_rad);
    [sin, cos - 1.0]
}

/// Whether `fit` predicts held-out blocks clearly better than the fit of the model.
fn is_better(fit: &Fitted, model: &TwistModel) -> bool {
    let with = &model.fitted;
    fit.better_than(with) > CLEARLY && fit.held_out_rms() < LARGEST_ERROR_RATIO * with.held_out_rms()
}

/// Fit of the twist with another cause in the place of the transmission error of the output. `shape` gives the two
/// columns of the cause for an angle \[rad\]; the other groups of the model stay. One row in `every` is used. `None` if
/// the fit is impossible.
fn fit(model: &TwistModel, every: usize, shape: impl Fn(f64) -> [f64; 2]) -> Option<Fitted> {
    let first = model.places.further();
    let target = first + 2;
    let sums = model.rows.sums(target + 1, |i, sample, row| {
        if i % every != 0 || !fill_known(model.rows, i, model.shift_s, row) {
            return false;
        }
        row[first..target].copy_from_slice(&shape(sample.angle_rad));
        true
    });
    let others: Vec<Group> = model.groups.iter().copied().filter(|g| *g != Group::Output).collect();
    let all = [columns(model.rows, &others), vec![first, first + 1]].concat();
    sums.fit(&all, target, |c| model.prior(c))
}
