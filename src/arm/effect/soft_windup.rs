//! `soft_windup`: the three-segment torsion curve of a gear replaces the single stiffness of the joint.

use super::kind::{Absent, Kind, Needs, Parameter, Place, Scale, Scope, Setting, Traits};
use super::subject::Subject;
use crate::arm::joint_law::{Curve, Windup};

/// Name of the slope that is nearest to the nominal stiffness of a joint.
pub(crate) const MIDDLE_SLOPE: &str = "k2_nm_per_rad";

/// Parameters of the effect: the slopes K1, K2, K3 and the break points. The nominal stiffness of a joint is usually
/// the slope K2 of its gear. So a fit expects K2 near the nominal stiffness, K1 below and K3 above.
const PARAMETERS: &[Parameter] = &[
    Parameter::number("k1_nm_per_rad", 1e-3, 1e10, 1e5, Scale::Stiffness)
        .expected(1.02, 4.0)
        .absent(Absent::Never),
    Parameter::number(MIDDLE_SLOPE, 1e-3, 1e10, 1.5e5, Scale::Stiffness)
        .expected(0.9, 1.1)
        .absent(Absent::Never),
    Parameter::number("k3_nm_per_rad", 1e-3, 1e10, 2e5, Scale::Stiffness)
        .expected(0.25, 0.98)
        .absent(Absent::Never),
    Parameter::number("t1_nm", 0.01, 1e5, 50.0, Scale::Log).expected(0.5, 5e3).within_torque(0.02, 1.0),
    Parameter::number("t2_nm", 0.01, 1e5, 150.0, Scale::Log)
        .expected(0.5, 5e3)
        .within_torque(0.05, 1.5)
        .at_least("t1_nm"),
];

/// Break points (T1, T2) at which a fit starts, as fractions of the largest torque. A fit finds only break points
/// near its start, so the pairs cover the range.
const BREAKS: [(f64, f64); 8] = [
    (0.08, 0.25),
    (0.08, 0.6),
    (0.15, 0.4),
    (0.15, 0.75),
    (0.25, 0.5),
    (0.25, 0.85),
    (0.4, 0.65),
    (0.5, 0.85),
];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "soft_windup",
    summary: "the three-segment torsion curve replaces the single stiffness",
    scope: Scope::Product,
    places: &[Place::Joint],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits { needs: Needs::TwistingJoint, is_gear_curve: true, starts, ..Traits::USUAL },
};

fn starts(setting: &Setting) -> Vec<Vec<f64>> {
    let ln_torque = |part: &f64| libm::log(part * setting.torque_nm);
    BREAKS.iter().map(|(a, b)| vec![1.4, 1.0, 0.85, ln_torque(a), ln_torque(b)]).collect()
}

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    if let Some(joint) = subject.structure.joint_mut(at) {
        joint.law.curve = Curve::Windup(Windup {
            k1_nm_per_rad: numbers[0],
            k2_nm_per_rad: numbers[1],
            k3_nm_per_rad: numbers[2],
            t1_nm: numbers[3],
            t2_nm: numbers[4],
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn subject() -> Subject {
        super::super::validate::testing::two_link_subject()
    }

    #[test]
    fn the_twist_is_the_sum_of_the_segments() {
        let mut subject = subject();
        apply(&[4e4, 8e4, 1e5, 10.0, 30.0], "j1", &mut subject);
        let law = subject.structure.joint_mut("j1").expect("j1").law;
        let by_hand = 10.0 / 4e4 + 20.0 / 8e4 + 15.0 / 1e5;
        assert!((law.angle_rad(-45.0) + by_hand).abs() < 1e-15);
        assert_eq!(1.0 / law.tangent_compliance_rad_per_nm(20.0), 8e4);
    }
}
