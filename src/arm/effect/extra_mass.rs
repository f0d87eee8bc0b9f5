//! `extra_mass`: a point mass at a joint that the tolerance of the joint's mass does not cover. At a prismatic joint
//! it travels.

use super::kind::{Kind, Measure, Parameter, Place, Removes, Scale, Scope, Traits};
use super::subject::Subject;

const PARAMETERS: &[Parameter] = &[Parameter::number("delta_kg", -10.0, 50.0, 1.0, Scale::Linear)
    .expected(-3.0, 12.0)
    .growing_with(Measure::ArmMass, 1.0 / 8.0)];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "extra_mass",
    summary: "a point mass at a joint beyond tolerance",
    scope: Scope::Product,
    places: &[Place::Joint, Place::Prismatic],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits {
        removes: Some(Removes::JointMass),
        starts: |_| vec![vec![0.5], vec![2.0]],
        ..Traits::USUAL
    },
};

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    if let Some(joint) = subject.structure.joint_mut(at) {
        joint.mass_kg += numbers[0];
    }
    if let Some(joint) = subject.structure.prismatic_mut(at) {
        joint.mass_kg += numbers[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn subject() -> Subject {
        super::super::validate::testing::two_link_subject()
    }

    #[test]
    fn a_kilogram_at_half_a_metre_adds_its_weight_times_the_lever() {
        use crate::arm::LinkModel;
        use crate::arm::load::Payload;
        use nalgebra::Vector3;
        let torque = |delta: f64| {
            let mut subject = subject();
            apply(&[delta], "j2", &mut subject);
            subject.structure.joint_mut("j1").expect("j1").axis = nalgebra::Vector3::y_axis();
            let chain = crate::mechanics::chain::Chain::new(&subject.structure, LinkModel::Rigid);
            let posed = chain.pose_rad(&[0.0, 0.0], &Payload::default(), Vector3::zeros());
            posed.statics().joint_torques_nm[0].1
        };
        assert!((torque(1.0) - torque(0.0) - 9.81 * 0.5).abs() < 1e-12);
    }
}
