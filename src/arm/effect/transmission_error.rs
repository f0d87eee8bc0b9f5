//! `transmission_error`: the angle of a joint has an error once and twice in each turn, because of its gear or its
//! sensor.

use super::kind::{Kind, Parameter, Place, Scope, Traits};
use super::subject::Subject;

const PARAMETERS: &[Parameter] = &[Parameter {
    count: 4,
    ..Parameter::vector("sin_cos_sin2_cos2_rad", -0.02, 0.02, 3e-4).expected(-0.003, 0.003)
}];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "transmission_error",
    summary: "a joint turns unevenly, once and twice a turn; only absolute positions show it",
    scope: Scope::Test,
    places: &[Place::Joint],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits { is_sought: false, ..Traits::USUAL },
};

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    if let [a, b, c, d] = *numbers {
        subject.transmissions_rad.push((at.into(), [a, b, c, d]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_repeats_once_and_twice_a_turn() {
        let mut subject = super::super::validate::testing::two_link_subject();
        apply(&[1e-3, 0.0, 0.0, 2e-4], "j2", &mut subject);
        let at = |q: f64| subject.turned_rad(&[0.3, q])[1] - q;
        assert_eq!(subject.turned_rad(&[0.3, 0.7])[0], 0.3);
        assert!((at(0.0) - 2e-4).abs() < 1e-15 && (at(std::f64::consts::FRAC_PI_2) - 8e-4).abs() < 1e-15);
        assert!((at(1.0) - at(1.0 + std::f64::consts::TAU)).abs() < 1e-15);
    }
}
