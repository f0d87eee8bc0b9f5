//! `travel_compliance`: the drive of a prismatic joint deflects along its travel more than its stated stiffness
//! allows. The effect is a spring in series: 1/k = 1/k_stated + 1/c.

use super::kind::{Kind, Parameter, Place, Scale, Scope, Traits};
use super::subject::Subject;

const PARAMETERS: &[Parameter] =
    &[Parameter::number("stiffness_n_per_m", 1.0, 1e12, 2e7, Scale::Stiffness).expected(0.0, 6.0)];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "travel_compliance",
    summary: "the drive of a prismatic joint is more compliant along its travel than stated",
    scope: Scope::Product,
    places: &[Place::Prismatic],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits { starts: |_| vec![vec![0.1], vec![0.5]], ..Traits::USUAL },
};

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    if let Some(joint) = subject.structure.prismatic_mut(at) {
        joint.m_per_n += 1.0 / numbers[0];
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
    fn a_softer_screw_is_in_series_with_the_stated_one() {
        let text = r#"{"chain": [{"type": "prismatic", "name": "rail", "axis": [1, 0, 0], "stiffness_n_per_m": 3e7}]}"#;
        let arm = read_arm_document(Document::parse("a.json", text).expect("JSON"), &Catalogs::default());
        let mut subject = arm.expect("sound").subject(JointModel::ThreeSegment);
        apply(&[6e7], "rail", &mut subject);
        let m_per_n = subject.structure.prismatic_mut("rail").expect("rail").m_per_n;
        // springs of 3e7 and 6e7 N/m in series
        assert!((m_per_n * 2e7 - 1.0).abs() < 1e-12, "{m_per_n}");
    }
}
