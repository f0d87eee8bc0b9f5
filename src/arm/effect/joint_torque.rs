//! `joint_torque`: an undeclared torque on a joint, `a + b sin q + c cos q` with the joint angle q, such as the torque
//! of a counterbalance, a cable or a spring. It moves the working point of the gear, which is the torque at which its
//! torsion curve is evaluated.

use super::kind::{Absent, Kind, Needs, Parameter, Place, RARE_PRIOR, Scale, Scope, Setting, Traits};
use super::subject::Subject;

const fn torque(name: &'static str) -> Parameter {
    let parameter = Parameter::number(name, -1e5, 1e5, 10.0, Scale::Torque).expected(-1.0, 1.0);
    Parameter { default: Some(0.0), ..parameter.absent(Absent::AtZero) }
}

const PARAMETERS: &[Parameter] = &[torque("offset_nm"), torque("sin_nm"), torque("cos_nm")];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "joint_torque",
    summary: "a torque that nobody told of acts on the joint",
    scope: Scope::Product,
    places: &[Place::Joint],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits {
        needs: Needs::CurvedJoint,
        variants: &[
            &[("offset_nm", None)],
            &[("sin_nm", None), ("cos_nm", None)],
            &[("offset_nm", None), ("sin_nm", None), ("cos_nm", None)],
        ],
        odds: RARE_PRIOR,
        in_bounds: false,
        starts,
        is_nonlinear: true,
        moves_working_points: true,
        contradiction,
        ..Traits::USUAL
    },
};

/// Starting points of a fit, as fractions of the largest torque on the joint, of either sign. Some vary one of the
/// numbers a, b, c alone, others vary b and c (which depend on the angle) together. Natural frequencies jump where a
/// torque passes a break point of the gear. A fit by descent cannot pass such a jump, so the starts cover the whole
/// range.
fn starts(setting: &Setting) -> Vec<Vec<f64>> {
    const PARTS: [f64; 6] = [-0.7, -0.35, -0.1, 0.1, 0.35, 0.7];
    let count = setting.values_at_one.len();
    let alone = (0..count).flat_map(|k| {
        PARTS.map(|part| {
            let mut start = vec![0.0; count];
            start[k] = part;
            start
        })
    });
    let corner = |b: f64, c: f64| {
        let mut start = vec![0.0; count];
        (start[count - 2], start[count - 1]) = (b, c);
        start
    };
    let corners = [(0.35, 0.35), (0.35, -0.35), (-0.35, 0.35), (-0.35, -0.35)];
    let together = corners.into_iter().filter(|_| count > 1).map(|(b, c)| corner(b, c));
    alone.chain(together).collect()
}

fn contradiction(numbers: &[f64]) -> Option<(&'static str, &'static str)> {
    numbers.iter().all(|n| *n == 0.0).then_some(("no torque is given", "give offset_nm, sin_nm or cos_nm"))
}

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    if let Some(joint) = subject.structure.joint_mut(at) {
        joint.torque.offset_nm += numbers[0];
        joint.torque.sin_nm += numbers[1];
        joint.torque.cos_nm += numbers[2];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::LinkModel;
    use crate::arm::joint_law::{Curve, Windup};
    use crate::arm::load::Payload;
    use crate::mechanics::chain::Chain;
    use nalgebra::Vector3;

    const CURVE: Windup =
        Windup { k1_nm_per_rad: 1e4, k2_nm_per_rad: 2e4, k3_nm_per_rad: 4e4, t1_nm: 20.0, t2_nm: 60.0 };

    #[test]
    fn the_gear_turns_and_vibrates_at_the_sum_of_both_torques() {
        let mut subject = super::super::validate::testing::two_link_subject();
        subject.structure.joint_mut("j2").expect("j2").law.curve = Curve::Windup(CURVE);
        let state = |subject: &Subject| {
            let chain = Chain::new(&subject.structure, LinkModel::Full);
            let posed = chain.pose_rad(&[0.3, 0.5], &Payload::default(), Vector3::zeros());
            let statics = posed.statics();
            let at = statics.joint_torques_nm.iter().position(|(n, _)| n == "j2").expect("j2");
            let element = posed.elements().position(|e| e.name == "j2").expect("j2");
            (
                statics.joint_torques_nm[at].1,
                statics.deformations[element][0],
                statics.tangent_compliances[element][0],
            )
        };
        let (gravity_nm, ..) = state(&subject);
        apply(&[5.0, -8.0, 70.0], "j2", &mut subject);
        let total_nm = gravity_nm + 5.0 - 8.0 * libm::sin(0.5f64) + 70.0 * libm::cos(0.5f64);
        assert!(total_nm > 60.0, "beyond the second break point: {total_nm}");
        let (torque_nm, twist_rad, slope) = state(&subject);
        assert!((torque_nm - total_nm).abs() < 1e-9);
        let by_hand = 20.0 / 1e4 + 40.0 / 2e4 + (total_nm - 60.0) / 4e4;
        assert!((twist_rad - by_hand).abs() < 1e-12 && slope == 1.0 / 4e4, "{twist_rad} {by_hand} {slope}");
    }
}
