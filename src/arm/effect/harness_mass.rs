//! `harness_mass`: cables and hoses along a link. They add mass and weight on the axis of the link, but no stiffness.

use super::kind::{Kind, Measure, Parameter, Place, Scale, Scope, Traits};
use super::subject::Subject;

const PARAMETERS: &[Parameter] = &[Parameter::number("kg_per_m", 0.0, 100.0, 2.0, Scale::Linear)
    .expected(0.0, 15.0)
    .growing_with(Measure::ArmMassPerLength, 1.0 / 4.0)];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "harness_mass",
    summary: "cables and hoses along a link: mass without stiffness",
    scope: Scope::Product,
    places: &[Place::Link],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits::USUAL,
};

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    if let Some(link) = subject.structure.link_mut(at) {
        link.harness_kg_per_m += numbers[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn subject() -> Subject {
        super::super::validate::testing::two_link_subject()
    }

    #[test]
    fn the_root_carries_its_weight() {
        use crate::arm::LinkModel;
        use crate::arm::load::Payload;
        use nalgebra::Vector3;
        let base_force = |kg_per_m: f64| {
            let mut subject = subject();
            apply(&[kg_per_m], "forearm", &mut subject);
            let chain = crate::mechanics::chain::Chain::new(&subject.structure, LinkModel::Full);
            chain.pose_rad(&[0.0, 0.0], &Payload::default(), Vector3::zeros()).statics().base_wrench[2]
        };
        assert!((base_force(2.0) - base_force(0.0) + 2.0 * 0.5 * 9.81).abs() < 1e-9);
    }
}
