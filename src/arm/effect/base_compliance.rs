//! `base_compliance`: the ground or base under the arm tilts elastically about world x and y, at the origin of the
//! chain.

use super::bearing_tilt;
use super::kind::{ElasticRotation, Kind, Parameter, Place, Scale, Scope, Traits};
use super::subject::Subject;

const PARAMETERS: &[Parameter] =
    &[Parameter::number("stiffness_nm_per_rad", 1e-3, 1e10, 5e5, Scale::Stiffness).expected(0.0, 6.0)];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "base_compliance",
    summary: "the base tilts about world x and y",
    scope: Scope::Product,
    places: &[Place::Base],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits {
        rotation: Some(ElasticRotation::Tilt),
        same_at_vertical_first_joint: Some(bearing_tilt::KIND.name),
        starts: |_| vec![vec![0.1], vec![0.5]],
        ..Traits::USUAL
    },
};

fn apply(numbers: &[f64], _at: &str, subject: &mut Subject) {
    subject.structure.base_tilt_rad_per_nm += 1.0 / numbers[0];
}

#[cfg(test)]
mod tests {
    use super::*;

    fn subject() -> Subject {
        super::super::validate::testing::two_link_subject()
    }

    #[test]
    fn it_is_the_same_as_the_tilt_of_a_vertical_first_joint() {
        use crate::arm::LinkModel;
        use crate::arm::load::Payload;
        use nalgebra::Vector3;
        let tip = |kind: &Kind, at: &str| {
            let mut subject = subject();
            (kind.apply)(&[3e5], at, &mut subject);
            let chain = crate::mechanics::chain::Chain::new(&subject.structure, LinkModel::Full);
            let posed = chain.pose_rad(&[0.7, 0.3], &Payload::default(), Vector3::new(5.0, -3.0, -10.0));
            posed.statics().tip_displacement_m
        };
        let difference = tip(&KIND, "base") - tip(&super::super::bearing_tilt::KIND, "j1");
        assert!(difference.norm() < 1e-15);
    }
}
