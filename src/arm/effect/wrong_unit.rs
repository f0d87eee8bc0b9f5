//! `wrong_unit`: a channel is written in another unit than its column states, such as inches, metres or degrees.

use super::kind::{EVERY_CHANNEL, Kind, Parameter, Scale, Scope, Traits};
use super::subject::Subject;

const PARAMETERS: &[Parameter] = &[Parameter::number("factor", 1e-7, 1e7, 25.4, Scale::Log)];

/// Description of the effect, for the list of all effects.
pub(crate) const KIND: Kind = Kind {
    name: "wrong_unit",
    summary: "a channel is written in another unit than its column says",
    scope: Scope::Test,
    places: EVERY_CHANNEL,
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits { is_sought: false, ..Traits::USUAL },
};

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    if let Some(reading) = subject.channel_mut(at) {
        reading.factor *= numbers[0];
    }
}

/// Factors by which a column is wrong if its unit was mistaken, each with the cause.
pub const SLIPS: &[(f64, &str)] = &[
    (25.4, "a value in mm stands 25.4 times too large: converted from inches twice"),
    (1.0 / 25.4, "inches in a column of mm"),
    (1000.0, "micrometres in a column of mm, or a conversion done twice"),
    (1e-3, "metres in a column of mm"),
    (10.0, "tenths in the column"),
    (0.1, "cm in a column of mm"),
    (std::f64::consts::PI / 180.0, "radians in a column of degrees"),
    (180.0 / std::f64::consts::PI, "degrees in a column of radians"),
    (60.0, "arcseconds in a column of arcmin, or rpm in a column of Hz"),
    (1.0 / 60.0, "degrees in a column of arcmin"),
    (std::f64::consts::TAU, "rad/s in a column of Hz"),
    (1.0 / std::f64::consts::TAU, "a frequency divided by 2 pi twice"),
    (std::f64::consts::PI / 10800.0, "radians in a column of arcmin"),
    (0.1 * std::f64::consts::PI / 10.8, "milliradians in a column of arcmin"),
];

#[cfg(test)]
mod tests {
    use super::super::channel::Channel;
    use super::*;

    fn subject() -> Subject {
        super::super::validate::testing::two_link_subject()
    }

    #[test]
    fn metres_in_a_column_of_millimetres() {
        let mut subject = subject();
        apply(&[1e-3], "static", &mut subject);
        assert_eq!(subject.channels[Channel::Static as usize].of(2.0, 0, 0), 2e-3);
    }
}
