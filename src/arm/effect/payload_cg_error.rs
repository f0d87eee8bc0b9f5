//! `payload_cg_error`: the centre of gravity of the payload is not at the stated position. The offset is written in
//! the last frame.

use super::kind::{Kind, Parameter, Place, Scope, Traits};
use super::subject::Subject;
use nalgebra::Vector3;

const PARAMETERS: &[Parameter] = &[Parameter::vector("offset_m", -0.5, 0.5, 0.01).expected(-0.1, 0.1)];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "payload_cg_error",
    summary: "the centre of gravity of the payload is not where it is stated",
    scope: Scope::Test,
    places: &[Place::Payload],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits { starts: |_| vec![vec![0.0; 3]], ..Traits::USUAL },
};

fn apply(numbers: &[f64], _at: &str, subject: &mut Subject) {
    subject.payload_offset_m += Vector3::new(numbers[0], numbers[1], numbers[2]);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn subject() -> Subject {
        super::super::validate::testing::two_link_subject()
    }

    #[test]
    fn the_true_centre_is_stated_plus_offset() {
        let mut subject = subject();
        apply(&[0.01, 0.0, -0.02], "payload", &mut subject);
        let stated = crate::arm::load::Payload { mass_kg: 1.0, cg_m: Vector3::x(), ..Default::default() };
        assert_eq!(subject.payload(&stated).cg_m, Vector3::new(1.01, 0.0, -0.02));
    }
}
