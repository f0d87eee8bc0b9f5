//! Readings in another unit than the file says whose standard deviations are in the one it says.
//!
//! A column times 25.4 has 25.4 times the noise too. Beside the deviations as declared no model comes near such readings,
//! the one with the right factor neither, so the slip shows only once they are taken to be as much too small.

use super::stats::median;
use crate::arm::effect::channel::Channel;
use crate::arm::effect::wrong_unit;
use crate::reconcile::forward::coefficients::Coefficients;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::model::parameters::Candidate;

/// How far the readings of a channel may be from a factor of the unit slips, in ln: missing physics, and more.
const NEAR: f64 = 0.25;

/// Deviations of a channel that are too small by a factor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    channel: Channel,
    factor: f64,
}

impl Stretch {
    /// Whether the slip is among some effects.
    pub fn is_among(&self, effects: &[&Candidate]) -> bool {
        effects
            .iter()
            .any(|effect| effect.kind.name == wrong_unit::KIND.name && effect.at == self.channel.word())
    }

    /// What is taken for granted, in words.
    pub fn sentence(&self) -> String {
        let Self { channel, factor } = self;
        let (channel, factor) = (channel.word(), crate::report::number::significant(*factor, 4));
        format!(
            "the noise of the {channel} readings is about {factor} times what is declared, as they themselves are: their \
             standard deviations are taken to be {factor} times those of the file"
        )
    }
}

/// The channels whose readings are about a slip's factor of what the nominal arm gives, and which the best model misses
/// by far more than declared: nearer to the factor than to one.
pub fn stretches(forward: &Forward, best: &Coefficients) -> Vec<Stretch> {
    let nominal = forward.predict(&forward.coefficients(&forward.nominal));
    let predicted = forward.predict(best);
    let of_channel = |channel: Channel| {
        let range = forward.range(channel);
        let own = &forward.data[range.clone()];
        let (both, square) = own
            .iter()
            .zip(&nominal[range.clone()])
            .fold((0.0, 0.0), |(both, square), (d, model)| (both + d.value * model, square + model * model));
        let ratio = both / square;
        let slips = wrong_unit::SLIPS.iter().map(|(factor, _)| *factor).filter(|factor| *factor > 1.0);
        let factor = slips.min_by(|a, b| {
            let apart = |factor: &f64| (ratio / factor).ln().abs();
            apart(a).total_cmp(&apart(b))
        })?;
        let misses = own.iter().zip(&predicted[range]).map(|(d, model)| ((d.value - model) / d.sigma).abs());
        let is_slip = square > 0.0 && ratio > 0.0 && (ratio / factor).ln().abs() < NEAR;
        (is_slip && median(misses.collect()) > factor.sqrt()).then_some(Stretch { channel, factor })
    };
    [Channel::Static, Channel::Modal, Channel::Windup].into_iter().filter_map(of_channel).collect()
}

/// Takes the declared deviations of some channels for larger.
pub fn stretch(forward: &mut Forward, stretches: &[Stretch]) {
    for Stretch { channel, factor } in stretches {
        let range = forward.range(*channel);
        forward.data[range].iter_mut().for_each(|datum| datum.sigma *= factor);
    }
}
