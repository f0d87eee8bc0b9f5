//! `sensor_bias`: the reading is the actual value plus a constant.

use super::channel::Channel;
use super::kind::{Kind, Measure, Parameter, Place, Scale, Scope, Traits};
use super::subject::Subject;

const DISPLACEMENT: &[Parameter] = &[Parameter::vector("bias_mm", -10.0, 10.0, 0.02)
    .expected(-0.5, 0.5)
    .growing_with(Measure::Displacement, 1.0 / 4.0)];
const TWIST: &[Parameter] = &[Parameter::number("bias_arcmin", -60.0, 60.0, 0.1, Scale::Linear)
    .expected(-3.0, 3.0)
    .growing_with(Measure::Twist, 1.0 / 4.0)];

fn parameters(place: Place) -> &'static [Parameter] {
    match place {
        Place::Channel(Channel::Windup) => TWIST,
        _ => DISPLACEMENT,
    }
}

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "sensor_bias",
    summary: "the sensor of a channel reads the truth plus a constant",
    scope: Scope::Test,
    places: &[
        Place::Channel(Channel::Static),
        Place::Channel(Channel::Windup),
        Place::Channel(Channel::Positions),
    ],
    parameters,
    apply,
    traits: Traits { starts: |setting| vec![vec![0.0; setting.values_at_one.len()]], ..Traits::USUAL },
};

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    if let Some(reading) = subject.channel_mut(at) {
        reading.bias.iter_mut().zip(numbers).for_each(|(bias, n)| *bias += n);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn subject() -> Subject {
        super::super::validate::testing::two_link_subject()
    }

    #[test]
    fn the_reading_is_truth_plus_bias() {
        let mut subject = subject();
        apply(&[0.0, 0.02, 0.0], "static", &mut subject);
        apply(&[0.1], "windup", &mut subject);
        assert_eq!(subject.channels[Channel::Static as usize].of(2.0, 1, 7), 2.02);
        assert_eq!(subject.channels[Channel::Windup as usize].of(2.0, 0, 7), 2.1);
    }
}
