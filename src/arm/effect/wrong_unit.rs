//! `wrong_unit`: a channel is written in another unit than its column states, such as inches, metres or degrees.

use super::channel::Channel;
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

/// A unit that is mistaken for another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnitSlip {
    /// Factor by which the column is then wrong.
    pub factor: f64,
    /// The cause in words.
    pub cause: &'static str,
    /// The channels whose quantity has these units; all if the list is empty.
    pub channels: &'static [Channel],
}

impl UnitSlip {
    /// Whether a column of the channel can have these units.
    pub fn is_of(&self, channel: Channel) -> bool {
        self.channels.is_empty() || self.channels.contains(&channel)
    }
}

const LENGTHS: &[Channel] = &[Channel::Static, Channel::Positions];
const FREQUENCIES: &[Channel] = &[Channel::Modal];
const ANGLES: &[Channel] = &[Channel::Windup];

const fn slip(factor: f64, cause: &'static str, channels: &'static [Channel]) -> UnitSlip {
    UnitSlip { factor, cause, channels }
}

/// The units that are mistaken for each other.
pub const SLIPS: &[UnitSlip] = &[
    slip(25.4, "a value in mm stands 25.4 times too large: converted from inches twice", LENGTHS),
    slip(1.0 / 25.4, "inches in a column of mm", LENGTHS),
    slip(1000.0 / 25.4, "thousandths of an inch in a column of mm", LENGTHS),
    slip(1000.0, "thousandths (micrometres in a column of mm), or a conversion done twice", &[]),
    slip(1e-3, "thousands (metres in a column of mm)", &[]),
    slip(10.0, "tenths in the column", &[]),
    slip(0.1, "tens (cm in a column of mm)", &[]),
    slip(std::f64::consts::PI / 180.0, "radians in a column of degrees", ANGLES),
    slip(180.0 / std::f64::consts::PI, "degrees in a column of radians", ANGLES),
    slip(60.0, "arcseconds in a column of arcmin", ANGLES),
    slip(1.0 / 60.0, "degrees in a column of arcmin", ANGLES),
    slip(60.0, "revolutions per minute in a column of Hz", FREQUENCIES),
    slip(std::f64::consts::TAU, "rad/s in a column of Hz", FREQUENCIES),
    slip(1.0 / std::f64::consts::TAU, "a frequency divided by 2 pi twice", FREQUENCIES),
    slip(std::f64::consts::PI / 10800.0, "radians in a column of arcmin", ANGLES),
    slip(0.1 * std::f64::consts::PI / 10.8, "milliradians in a column of arcmin", ANGLES),
];

#[cfg(test)]
mod tests {
    use super::*;

    fn subject() -> Subject {
        super::super::validate::testing::two_link_subject()
    }

    #[test]
    fn a_length_is_mistaken_for_no_angle() {
        let of_lengths: Vec<f64> =
            SLIPS.iter().filter(|slip| slip.is_of(Channel::Static)).map(|slip| slip.factor).collect();
        assert!(of_lengths.contains(&(1000.0 / 25.4)) && !of_lengths.contains(&60.0), "{of_lengths:?}");
        assert!(SLIPS.iter().any(|slip| slip.is_of(Channel::Modal) && slip.factor == 60.0));
    }

    #[test]
    fn metres_in_a_column_of_millimetres() {
        let mut subject = subject();
        apply(&[1e-3], "static", &mut subject);
        assert_eq!(subject.channels[Channel::Static as usize].of(2.0, 0, 0), 2e-3);
    }
}
