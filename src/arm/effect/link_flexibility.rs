//! `link_flexibility`: a link that is rigid in the nominal model deforms by bending, shear, torsion and stretch. The
//! parameter is a factor on the compliance of its section.

use super::kind::{Kind, Needs, Parameter, Place, Scale, Scope, Traits};
use super::subject::Subject;

const PARAMETERS: &[Parameter] =
    &[Parameter::number("factor", 0.0, 20.0, 1.0, Scale::Linear).expected(0.0, 5.0)];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "link_flexibility",
    summary: "a link that the model holds rigid bends; 1 = as its section says",
    scope: Scope::Product,
    places: &[Place::Tube],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits { needs: Needs::RigidLink, changes_bending: true, ..Traits::USUAL },
};

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    if let Some(beam) = subject.structure.link_mut(at).and_then(|l| l.beam.as_mut()) {
        beam.flexibility = numbers[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn subject() -> Subject {
        super::super::validate::testing::two_link_subject()
    }

    #[test]
    fn the_factor_scales_the_links_share() {
        use crate::arm::LinkModel;
        use crate::arm::load::Payload;
        use nalgebra::Vector3;
        let share = |factor: f64| {
            let mut subject = subject();
            apply(&[factor], "forearm", &mut subject);
            let chain = crate::mechanics::chain::Chain::new(&subject.structure, LinkModel::Full);
            let posed = chain.pose_rad(&[0.0, 0.0], &Payload::default(), Vector3::new(0.0, 0.0, -10.0));
            posed.statics().shares_m.iter().find(|(n, _)| n == "forearm").expect("share").1.z
        };
        assert!((share(3.0) / share(1.0) - 3.0).abs() < 1e-12);
        assert_eq!(share(0.0), 0.0);
    }
}
