//! `joint_compliance`: a joint that is rigid in the nominal model deflects in torsion.

use super::kind::{ElasticRotation, Kind, Needs, Parameter, Place, Scale, Scope, Traits};
use super::subject::Subject;

const PARAMETERS: &[Parameter] =
    &[Parameter::number("stiffness_nm_per_rad", 1e-3, 1e10, 2e5, Scale::Stiffness).expected(0.0, 20.0)];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "joint_compliance",
    summary: "a joint that the model holds rigid twists",
    scope: Scope::Product,
    places: &[Place::Joint],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits {
        needs: Needs::RigidJoint,
        rotation: Some(ElasticRotation::AboutAxis),
        starts: |_| vec![vec![0.5], vec![2.0]],
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
    fn a_rigid_joint_becomes_a_spring() {
        let mut subject = subject();
        subject.structure.joint_mut("j1").expect("j1").law = crate::arm::joint_law::Curve::Rigid.into();
        apply(&[5e4], "j1", &mut subject);
        let law = subject.structure.joint_mut("j1").expect("j1").law;
        assert!((law.angle_rad(100.0) - 100.0 / 5e4).abs() < 1e-18);
    }
}
