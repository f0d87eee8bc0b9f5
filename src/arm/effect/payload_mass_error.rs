//! `payload_mass_error`: the payload weighs more or less than stated. Load cases without a payload are unchanged.

use super::kind::{Kind, Measure, Parameter, Place, Removes, Scale, Scope, Traits};
use super::subject::Subject;

const PARAMETERS: &[Parameter] = &[Parameter::number("delta_kg", -20.0, 20.0, 0.2, Scale::Linear)
    .expected(-3.0, 3.0)
    .growing_with(Measure::PayloadMass, 1.0 / 4.0)];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "payload_mass_error",
    summary: "the payload weighs more or less than stated",
    scope: Scope::Test,
    places: &[Place::Payload],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits { removes: Some(Removes::PayloadMass), ..Traits::USUAL },
};

fn apply(numbers: &[f64], _at: &str, subject: &mut Subject) {
    subject.payload_delta_kg += numbers[0];
}

#[cfg(test)]
mod tests {
    use super::*;

    fn subject() -> Subject {
        super::super::validate::testing::two_link_subject()
    }

    #[test]
    fn the_true_mass_is_stated_plus_delta_where_one_is_stated() {
        let mut subject = subject();
        apply(&[0.3], "payload", &mut subject);
        let loaded = crate::arm::load::Payload { mass_kg: 5.0, ..Default::default() };
        assert_eq!(subject.payload(&loaded).mass_kg, 5.3);
        assert_eq!(subject.payload(&Default::default()).mass_kg, 0.0);
    }
}
