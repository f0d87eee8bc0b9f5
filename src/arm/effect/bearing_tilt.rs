//! `bearing_tilt`: a joint tilts more than its nominal bearing allows. The effect is two equal rotational springs
//! about the two axes perpendicular to the joint's axis, in series with the bearing.

use super::kind::{ElasticRotation, Kind, Parameter, Place, Scale, Scope, Traits};
use super::subject::Subject;

const PARAMETERS: &[Parameter] =
    &[Parameter::number("stiffness_nm_per_rad", 1e-3, 1e10, 2e5, Scale::Stiffness).expected(0.0, 6.0)];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "bearing_tilt",
    summary: "the joint tilts beyond its nominal bearing, about the two axes across it",
    scope: Scope::Product,
    places: &[Place::Joint],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits {
        rotation: Some(ElasticRotation::Tilt),
        starts: |_| vec![vec![0.1], vec![0.5]],
        ..Traits::USUAL
    },
};

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    if let Some(joint) = subject.structure.joint_mut(at) {
        joint.tilt_rad_per_nm += 1.0 / numbers[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn subject() -> Subject {
        super::super::validate::testing::two_link_subject()
    }

    #[test]
    fn a_moment_across_the_axis_tilts_the_outboard_arm() {
        use crate::arm::LinkModel;
        use crate::arm::load::Payload;
        use nalgebra::Vector3;
        let mut subject = subject();
        apply(&[2e5], "j1", &mut subject);
        subject.structure.gravity_m_s2 = 0.0;
        let chain = crate::mechanics::chain::Chain::new(&subject.structure, LinkModel::Rigid);
        // j1 turns about z; a force of 10 N downward at the tip, 1 m away, puts 10 N m across the axis
        let posed = chain.pose_rad(&[0.0, 0.0], &Payload::default(), Vector3::new(0.0, 0.0, -10.0));
        let share = posed.statics().shares_m.iter().find(|(n, _)| n == "j1.bearing").expect("share").1;
        assert!((share.z + 10.0 / 2e5).abs() < 1e-12, "{share}");
    }

    #[test]
    fn the_tilt_comes_in_series_with_the_nominal_bearing() {
        let mut subject = subject();
        let joint = subject.structure.joint_mut("j1").expect("j1");
        joint.tilt_rad_per_nm = 1.0 / 3e5;
        apply(&[6e5], "j1", &mut subject);
        let tilt_rad_per_nm = subject.structure.joint_mut("j1").expect("j1").tilt_rad_per_nm;
        // springs of 3e5 and 6e5 N m/rad in series
        assert!((tilt_rad_per_nm * 2e5 - 1.0).abs() < 1e-12, "{tilt_rad_per_nm}");
    }
}
