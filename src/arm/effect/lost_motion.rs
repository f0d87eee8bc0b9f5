//! `lost_motion`: clearance that closes smoothly as the torque T grows. It adds the angle `h tanh(T/T_c)`.

use super::kind::{Kind, Measure, Needs, Parameter, Place, Scale, Scope, Setting, Traits};
use super::subject::Subject;
use crate::arm::joint_law::LostMotion;

const PARAMETERS: &[Parameter] = &[
    Parameter::number("half_width_rad", 0.0, 0.1, 1.5e-4, Scale::Linear)
        .expected(0.0, 2e-3)
        .sought_up_to(5e-3)
        .growing_with(Measure::Angle, 1.0),
    Parameter::number("torque_nm", 1e-4, 1e4, 10.0, Scale::Log)
        .expected(0.3, 500.0)
        .within_torque(0.003, 1.0),
];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "lost_motion",
    summary: "play that closes smoothly as the torque grows",
    scope: Scope::Product,
    places: &[Place::Joint],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits { needs: Needs::TwistingJoint, is_nonlinear: true, starts, ..Traits::USUAL },
};

fn starts(setting: &Setting) -> Vec<Vec<f64>> {
    [0.03, 0.1, 0.3].iter().map(|part| vec![1.0, libm::log(part * setting.torque_nm)]).collect()
}

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    if let Some(joint) = subject.structure.joint_mut(at) {
        joint.law.lost_motion = Some(LostMotion { half_width_rad: numbers[0], torque_nm: numbers[1] });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn subject() -> Subject {
        super::super::validate::testing::two_link_subject()
    }

    #[test]
    fn the_play_adds_its_half_width_at_high_torque_and_its_slope_at_none() {
        let mut subject = subject();
        apply(&[2e-4, 10.0], "j1", &mut subject);
        let law = subject.structure.joint_mut("j1").expect("j1").law;
        assert!((law.angle_rad(1000.0) - (1000.0 / 1e5 + 2e-4)).abs() < 1e-15);
        assert!((law.tangent_compliance_rad_per_nm(0.0) - (1e-5 + 2e-5)).abs() < 1e-18);
    }
}
