//! Causes of an error of the angles that no effect of the library has, and that a transmission error once and twice a turn
//! can imitate over a part of a turn.
//!
//! - A link's encoder with a wrong gain, or a wrong gear ratio: an error in proportion to the angle.
//! - A wave of another order, as a belt, a bearing or a gear stage between motor and output makes it.
//!
//! The four waves of the transmission error of the output are replaced by the one or two columns of such a cause. A cause with
//! fewer columns that predicts held-out blocks clearly better is nearer to the truth.

use super::blocks::Fitted;
use super::twist::{CLEARLY, Group, TwistModel, columns, fill_known};

/// Orders of a wave that are tried, in turns of the wave for one turn of the output: the first one, and the step.
const FIRST_ORDER: f64 = 0.5;
const ORDER_STEP: f64 = 0.1;
/// Number of orders that are tried.
const ORDERS: usize = 120;
/// Number of rows that are enough to choose an order.
const ENOUGH_ROWS: usize = 3000;
/// A cause must lower the root mean square error on held-out blocks to less than this fraction of that with the transmission
/// error.
const LARGEST_ERROR_RATIO: f64 = 0.9;

/// A cause that explains the records better than a transmission error once and twice a turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum OtherCause {
    /// An error in proportion to the angle: how much more the link's reading turns than the motor's \[1\], and the root mean square
    /// error with it on held-out blocks \[rad\].
    Gain(f64, f64),
    /// A wave: its order, its amplitude \[rad\], and the root mean square error with it on held-out blocks \[rad\].
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

    fn rms_rad(&self) -> f64 {
        match self {
            Self::Gain(_, rms_rad) | Self::Wave(_, _, rms_rad) => *rms_rad,
        }
    }
}

/// The best of the other causes, if the model has a transmission error of the output and the cause predicts held-out blocks
/// clearly better.
pub(super) fn other_cause(model: &TwistModel) -> Option<OtherCause> {
    if !model.groups.contains(&Group::Output) {
        return None;
    }
    let (gain, wave) = (gain(model), wave(model));
    [gain, wave].into_iter().flatten().min_by(|a, b| a.rms_rad().total_cmp(&b.rms_rad()))
}

fn gain(model: &TwistModel) -> Option<OtherCause> {
    let fit = fit(model, 1, |angle_rad| [angle_rad, 0.0])?;
    let gain = -fit.value(model.places.further());
    is_better(&fit, model).then(|| OtherCause::Gain(gain, fit.held_out_rms()))
}

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

fn wave_of(order: f64, angle_rad: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(order * angle_rad);
    [sin, cos - 1.0]
}

fn is_better(fit: &Fitted, model: &TwistModel) -> bool {
    let with = &model.fitted;
    fit.better_than(with) > CLEARLY && fit.held_out_rms() < LARGEST_ERROR_RATIO * with.held_out_rms()
}

/// Fit of every n-th row by the groups of the model without the transmission error of the output, and by the columns that
/// `shape` gives for an angle.
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
