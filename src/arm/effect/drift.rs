//! `drift`: the zero of a sensor or of its mounting changes steadily. The reading is the actual value plus rate x
//! (row - 1), with rows counted from 1 in the file.

use super::channel::Channel;
use super::kind::{Kind, Measure, Parameter, Place, Scope, Traits};
use super::subject::Subject;

const PARAMETERS: &[Parameter] = &[Parameter::vector("rate_mm_per_row", -0.1, 0.1, 2e-4)
    .expected(-0.01, 0.01)
    .growing_with(Measure::DisplacementPerRow, 1.0 / 4.0)];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "drift",
    summary: "the zero of a channel creeps from row to row",
    scope: Scope::Test,
    places: &[Place::Channel(Channel::Static), Place::Channel(Channel::Positions)],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits { starts: |setting| vec![vec![0.0; setting.values_at_one.len()]], ..Traits::USUAL },
};

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    if let Some(reading) = subject.channel_mut(at) {
        reading.drift_per_row.iter_mut().zip(numbers).for_each(|(drift, n)| *drift += n);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn subject() -> Subject {
        super::super::validate::testing::two_link_subject()
    }

    #[test]
    fn the_first_row_is_true_and_the_eleventh_ten_rates_off() {
        let mut subject = subject();
        apply(&[0.0, 0.0, 0.001], "static", &mut subject);
        let reading = &subject.channels[Channel::Static as usize];
        assert_eq!(reading.of(1.0, 2, 0), 1.0);
        assert!((reading.of(1.0, 2, 10) - 1.01).abs() < 1e-15);
    }
}
