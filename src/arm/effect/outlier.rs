//! `outlier`: single rows of readings are gross errors, for example because a reflector slipped or a number was
//! mistyped.

use super::kind::{EVERY_CHANNEL, Kind, Parameter, Scale, Scope, Traits};
use super::subject::Subject;

/// The parameter of the effect: the numbers of the rows that are gross errors. There may be any number of them.
const ROWS: &[Parameter] =
    &[Parameter { count: 0, ..Parameter::number("rows", 1.0, 1e9, 1.0, Scale::Linear) }];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "outlier",
    summary: "single rows are gross errors",
    scope: Scope::Test,
    places: EVERY_CHANNEL,
    parameters: |_| ROWS,
    apply,
    traits: Traits { is_sought: false, ..Traits::USUAL },
};

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    if let Some(reading) = subject.channel_mut(at) {
        reading.outlier_rows.extend(numbers.iter().map(|n| *n as usize));
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
    fn the_rows_are_remembered() {
        let mut subject = subject();
        apply(&[3.0, 17.0], "static", &mut subject);
        assert_eq!(subject.channels[Channel::Static as usize].outlier_rows, [3, 17]);
    }
}
