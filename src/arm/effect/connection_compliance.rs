//! `connection_compliance`: a flange, shaft or bolts deflect in torsion in series with the gear:
//! `1/k = 1/k_gear + 1/c`.

use super::kind::{ElasticRotation, Kind, Needs, Parameter, Place, Scale, Scope, Traits};
use super::subject::Subject;

const PARAMETERS: &[Parameter] =
    &[Parameter::number("stiffness_nm_per_rad", 1e-3, 1e10, 1e6, Scale::Stiffness).expected(0.0, 4.0)];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "connection_compliance",
    summary: "flange, shaft or bolts twisting in series with the gear",
    scope: Scope::Product,
    places: &[Place::Joint],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits {
        needs: Needs::TwistingJoint,
        rotation: Some(ElasticRotation::AboutAxis),
        starts: |_| vec![vec![0.1], vec![0.5]],
        ..Traits::USUAL
    },
};

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    if let Some(joint) = subject.structure.joint_mut(at) {
        joint.law.connection_rad_per_nm += 1.0 / numbers[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn subject() -> Subject {
        super::super::validate::testing::two_link_subject()
    }

    #[test]
    fn two_springs_in_series() {
        let mut subject = subject();
        apply(&[2e5], "j1", &mut subject);
        let law = subject.structure.joint_mut("j1").expect("j1").law;
        assert!((law.angle_rad(100.0) - 100.0 * (1.0 / 1e5 + 1.0 / 2e5)).abs() < 1e-15);
        assert!((1.0 / law.tangent_compliance_rad_per_nm(0.0) - 2e5 / 3.0).abs() < 1e-6);
    }
}
