//! `thermal_modulus`: the moduli of all links change with the temperature of the arm, or with the order of the tests
//! while it warms up.

use super::kind::{Kind, Needs, Parameter, Place, RARE_PRIOR, Scale, Scope, Setting, Traits};
use super::subject::Subject;

/// Name of the parameter for the relative change of the moduli per kelvin. It needs the temperature of each reading.
pub(crate) const PER_K: &str = "per_k";

/// Name of the parameter for the number of rows after which 63 % of the change of the moduli is reached.
pub(crate) const ROWS: &str = "rows";

const PARAMETERS: &[Parameter] = &[
    Parameter {
        default: Some(0.0),
        ..Parameter::number(PER_K, -0.05, 0.05, 1e-3, Scale::Linear).expected(-0.02, 0.02)
    },
    Parameter {
        default: Some(0.0),
        ..Parameter::number("change", -0.9, 3.0, 0.05, Scale::Linear).expected(-0.3, 0.3)
    },
    Parameter {
        default: Some(1.0),
        ..Parameter::number(ROWS, 0.1, 1e6, 30.0, Scale::Log).expected(2.0, 500.0)
    },
];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "thermal_modulus",
    summary: "the moduli of all links follow the temperature or the order of the tests",
    scope: Scope::Test,
    places: &[Place::Arm],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits {
        needs: Needs::BendingLink,
        variants: &[&[(PER_K, None)], &[("change", None), (ROWS, None)]],
        odds: RARE_PRIOR,
        starts,
        is_nonlinear: true,
        screens_at_starts: true,
        changes_bending: true,
        contradiction,
        ..Traits::USUAL
    },
};

/// Starting points of a fit. If the moduli change with the order of the tests, the starts let the change take place
/// early, in the middle, or until the end of the tests.
fn starts(setting: &Setting) -> Vec<Vec<f64>> {
    match setting.values_at_one.len() {
        1 => vec![vec![1.0]],
        _ => [0.04, 0.12, 0.3, 0.7, 1.5]
            .map(|part| vec![-1.0, libm::log((part * setting.rows).max(1.0))])
            .to_vec(),
    }
}

fn contradiction(numbers: &[f64]) -> Option<(&'static str, &'static str)> {
    (numbers[0] == 0.0 && numbers[1] == 0.0)
        .then_some(("no change is given", "give per_k, or change and rows"))
}

fn apply(numbers: &[f64], _at: &str, subject: &mut Subject) {
    subject.warming.per_k += numbers[0];
    // the moduli have at most one law of change with the order of the tests, so a later effect with such a change
    // replaces an earlier one
    if numbers[1] != 0.0 {
        (subject.warming.change, subject.warming.rows) = (numbers[1], numbers[2]);
    }
}

#[cfg(test)]
mod tests {
    use super::super::channel::Channel;
    use super::super::warming::Moment;
    use super::*;
    use crate::arm::LinkModel;
    use crate::arm::load::Payload;
    use crate::mechanics::chain::Chain;
    use nalgebra::Vector3;

    #[test]
    fn a_link_sags_as_much_more_as_its_modulus_is_lower_at_that_time() {
        let mut subject = super::super::validate::testing::two_link_subject();
        apply(&[-1e-3, -0.06, 40.0], "arm", &mut subject);
        let sag = |when: &Moment| {
            let mut structure = subject.structure_at(Channel::Static, when);
            structure.gravity_m_s2 = 0.0;
            for name in ["j1", "j2"] {
                structure.joint_mut(name).expect("joint").law = crate::arm::joint_law::Curve::Rigid.into();
            }
            let chain = Chain::new(&structure, LinkModel::Full);
            let posed = chain.pose_rad(&[0.2, 0.4], &Payload::default(), Vector3::new(0.0, 0.0, -100.0));
            posed.statics().tip_displacement_m.z
        };
        let cold = sag(&Moment::default());
        let warm = sag(&Moment { row: 80, temperature_c: Some(35.0) });
        let factor = 1.0 - 1e-3 * 15.0 - 0.06 * (1.0 - libm::exp(-2.0f64));
        assert!((cold / warm / factor - 1.0).abs() < 1e-12, "{cold} {warm} {factor}");
    }
}
