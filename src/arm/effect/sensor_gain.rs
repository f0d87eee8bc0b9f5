//! `sensor_gain`: the reading is the actual value times a factor.

use super::kind::{Absent, EVERY_CHANNEL, Kind, Parameter, Scale, Scope, Traits};
use super::subject::Subject;

const PARAMETERS: &[Parameter] =
    &[Parameter::number("gain", 0.2, 5.0, 1.03, Scale::Linear).expected(0.6, 1.6).absent(Absent::AtOne)];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "sensor_gain",
    summary: "the sensor of a channel reads a factor times the truth",
    scope: Scope::Test,
    places: EVERY_CHANNEL,
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits { starts: |setting| vec![vec![1.0 / setting.values_at_one[0]]], ..Traits::USUAL },
};

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    if let Some(reading) = subject.channel_mut(at) {
        reading.factor *= numbers[0];
    }
}

#[cfg(test)]
mod tests {
    use super::super::channel::Channel;
    use super::*;

    fn subject() -> Subject {
        super::super::validate::testing::two_link_subject()
    }

    #[test]
    fn the_reading_is_gain_times_truth() {
        let mut subject = subject();
        apply(&[1.05], "static", &mut subject);
        assert_eq!(subject.channels[Channel::Static as usize].of(2.0, 1, 7), 2.1);
        assert_eq!(subject.channels[Channel::Modal as usize].of(2.0, 0, 7), 2.0);
    }
}
