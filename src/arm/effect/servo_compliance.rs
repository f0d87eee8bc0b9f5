//! `servo_compliance`: a joint is softer in one kind of test, because a servo instead of a brake holds the joint in
//! this test.

use super::channel::Channel;
use super::kind::{Kind, Needs, Parameter, Place, Scale, Scope, Traits};
use super::subject::Subject;

/// Name of the parameter that says in which channel the joint is softer.
pub(crate) const CHANNEL: &str = "channel";

const PARAMETERS: &[Parameter] = &[
    Parameter::number("stiffness_nm_per_rad", 1e-3, 1e10, 2e5, Scale::Stiffness).expected(0.0, 6.0),
    Parameter { is_channel: true, default: None, ..Parameter::number(CHANNEL, 0.0, 3.0, 1.0, Scale::Linear) },
];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "servo_compliance",
    summary: "the joint is softer in one kind of test: a servo holds it there and not a brake",
    scope: Scope::Test,
    places: &[Place::Joint],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits {
        needs: Needs::TwistingJoint,
        sought_in: &[Channel::Static, Channel::Modal],
        odds: 0.6,
        starts: |_| vec![vec![0.1], vec![0.5]],
        ..Traits::USUAL
    },
};

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    if let Some(setup) = subject.setups.get_mut(numbers[1] as usize) {
        setup.servo_rad_per_nm.push((at.into(), 1.0 / numbers[0]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_joint_is_softer_in_its_channel_and_as_drawn_in_the_others() {
        let mut subject = super::super::validate::testing::two_link_subject();
        apply(&[5e4, Channel::Modal as usize as f64], "j2", &mut subject);
        let stiffness = |channel| {
            let mut structure = subject.structure_in(channel);
            1.0 / structure.joint_mut("j2").expect("j2").law.tangent_compliance_rad_per_nm(0.0)
        };
        // two springs of 5e4 N m/rad in series
        assert!((stiffness(Channel::Modal) / 2.5e4 - 1.0).abs() < 1e-12);
        for channel in [Channel::Static, Channel::Windup, Channel::Positions] {
            assert!((stiffness(channel) / 5e4 - 1.0).abs() < 1e-12, "{channel:?}");
        }
    }
}
