//! `modulus_error`: a factor on Young's modulus of one link, for example because of its layup or its bond lines.
//! Shear modulus and density are unchanged.

use super::kind::{Kind, Needs, Parameter, Place, Scale, Scope, Traits};
use super::subject::Subject;

const PARAMETERS: &[Parameter] =
    &[Parameter::number("factor", 0.05, 5.0, 0.85, Scale::Reciprocal).expected(0.5, 3.0)];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "modulus_error",
    summary: "one link has another modulus of elasticity than its material",
    scope: Scope::Product,
    places: &[Place::Tube],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits {
        needs: Needs::BendingLink,
        changes_bending: true,
        starts: |_| vec![vec![1.1], vec![1.4]],
        ..Traits::USUAL
    },
};

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    if let Some(beam) = subject.structure.link_mut(at).and_then(|l| l.beam.as_mut()) {
        beam.material.youngs_modulus_pa *= numbers[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn subject() -> Subject {
        super::super::validate::testing::two_link_subject()
    }

    #[test]
    fn bending_grows_by_the_reciprocal_and_torsion_does_not() {
        use crate::arm::LinkModel;
        use crate::mechanics::beam::PreparedBeam;
        let beam = |factor: f64| {
            let mut subject = subject();
            apply(&[factor], "forearm", &mut subject);
            let link = subject.structure.links().last().expect("forearm").clone();
            PreparedBeam::new(&link, &subject.structure, LinkModel::Full).expect("beam").compliances
        };
        let (nominal, soft) = (beam(1.0), beam(0.5));
        assert!((soft[0] / nominal[0] - 2.0).abs() < 1e-12, "curvature");
        assert!((soft[12] / nominal[12] - 1.0).abs() < 1e-12, "twist");
    }
}
