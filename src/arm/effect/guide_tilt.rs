//! `guide_tilt`: the guide of a prismatic joint tilts more than its stated stiffnesses allow. The effect adds
//! three equal rotational springs about the axes of the guide, in series with the stated springs.

use super::kind::{Kind, Parameter, Place, Scale, Scope, Traits};
use super::subject::Subject;

const PARAMETERS: &[Parameter] =
    &[Parameter::number("stiffness_nm_per_rad", 1e-3, 1e10, 2e5, Scale::Stiffness).expected(0.0, 6.0)];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "guide_tilt",
    summary: "the guide of a prismatic joint tilts beyond its stated stiffnesses",
    scope: Scope::Product,
    places: &[Place::Prismatic],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits { starts: |_| vec![vec![0.1], vec![0.5]], ..Traits::USUAL },
};

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    if let Some(joint) = subject.structure.prismatic_mut(at) {
        joint.guide_rad_per_nm.add_scalar_mut(1.0 / numbers[0]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::JointModel;
    use crate::arm::file::read_arm_document;
    use crate::catalog::Catalogs;
    use crate::input::json::Document;

    #[test]
    fn the_tilt_comes_in_series_about_each_axis() {
        let text = r#"{"chain": [{"type": "prismatic", "name": "rail", "axis": [1, 0, 0], "stiffness_n_per_m": null,
            "guide": {"pitch_nm_per_rad": 3e5}}]}"#;
        let arm = read_arm_document(Document::parse("a.json", text).expect("JSON"), &Catalogs::default());
        let mut subject = arm.expect("sound").subject(JointModel::ThreeSegment);
        apply(&[6e5], "rail", &mut subject);
        let tilt = subject.structure.prismatic_mut("rail").expect("rail").guide_rad_per_nm;
        for (axis, stiffness) in [6e5, 2e5, 6e5].into_iter().enumerate() {
            assert!((tilt[axis] * stiffness - 1.0).abs() < 1e-12, "{tilt}");
        }
    }
}
