//! `stiffness_waves`: the stiffness of a joint varies once and twice in each turn,
//! `k(q) = k / (1 + a sin(q + p) + b sin(2 q + r))`, because teeth, bearings or housings are not perfectly round.

use super::kind::{Absent, Kind, Needs, Parameter, Place, RARE_PRIOR, Scale, Scope, Setting, Traits};
use super::subject::Subject;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const fn size(name: &'static str) -> Parameter {
    let parameter = Parameter::number(name, 0.0, 0.9, 0.1, Scale::Linear).expected(0.0, 0.5);
    Parameter { default: Some(0.0), ..parameter }
}

const PARAMETERS: &[Parameter] = &[
    size("once"),
    size("twice"),
    Parameter {
        count: 2,
        default: Some(0.0),
        absent: Absent::Never,
        ..Parameter::number("phases_rad", -TAU, TAU, 1.0, Scale::Linear).expected(-PI, PI)
    },
];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "stiffness_waves",
    summary: "the stiffness of the joint varies once and twice a turn",
    scope: Scope::Product,
    places: &[Place::Joint],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits {
        needs: Needs::DrivenTwist,
        variants: &[
            &[("once", None), ("phases_rad", Some(0))],
            &[("twice", None), ("phases_rad", Some(1))],
            &[("once", None), ("twice", None), ("phases_rad", None)],
        ],
        odds: RARE_PRIOR,
        in_bounds: false,
        starts,
        is_nonlinear: true,
        contradiction,
        bounded,
        ..Traits::USUAL
    },
};

/// Starting points of a fit: waves of the typical amplitude, with the phase in each quarter of a turn. If two waves are
/// fitted, all pairs of phases are tried.
fn starts(setting: &Setting) -> Vec<Vec<f64>> {
    const PHASES: [f64; 4] = [-FRAC_PI_2, 0.0, FRAC_PI_2, PI];
    match setting.values_at_one.len() {
        2 => PHASES.map(|phase| vec![1.0, phase]).to_vec(),
        _ => PHASES.iter().flat_map(|p| PHASES.map(|r| vec![1.0, 1.0, *p, r])).collect(),
    }
}

/// Largest sum of both amplitudes in a fit. It is a little below the sum that an arm file may state.
const MOST_IN_A_FIT: f64 = 0.949;

/// Scales both amplitudes down, in place, if their sum is so large that the compliance would become zero or negative at
/// some angle. The phases are unchanged.
fn bounded(numbers: &mut [f64]) {
    let sum = numbers[0] + numbers[1];
    if sum > MOST_IN_A_FIT {
        numbers[..2].iter_mut().for_each(|size| *size *= MOST_IN_A_FIT / sum);
    }
}

fn contradiction(numbers: &[f64]) -> Option<(&'static str, &'static str)> {
    let is_whole = (1e-12..0.95).contains(&(numbers[0] + numbers[1]));
    (!is_whole)
        .then_some(("the sum of `once` and `twice` is zero, or at least 0.95", "give a sum below 0.95"))
}

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    if let Some(joint) = subject.structure.joint_mut(at) {
        let waves = &mut joint.law.waves;
        for (k, (size, phase)) in [(numbers[0], numbers[2]), (numbers[1], numbers[3])].into_iter().enumerate()
        {
            waves[2 * k] += size * libm::cos(phase);
            waves[2 * k + 1] += size * libm::sin(phase);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_joint_is_as_soft_as_the_law_says_at_every_angle() {
        let mut subject = super::super::validate::testing::two_link_subject();
        apply(&[0.2, 0.1, 0.4, -1.1], "j2", &mut subject);
        let law = subject.structure.joint_mut("j2").expect("j2").law;
        for q in [-2.0, 0.0, 0.7, 3.0] {
            let softer = 1.0 + 0.2 * libm::sin(q + 0.4f64) + 0.1 * libm::sin(2.0 * q - 1.1f64);
            let own = law.at_angle(q);
            assert!((own.tangent_compliance_rad_per_nm(7.0) * 5e4 / softer - 1.0).abs() < 1e-12, "{q}");
            assert!((own.angle_rad(-30.0) + 30.0 * softer / 5e4).abs() < 1e-15, "{q}");
        }
        assert_eq!(law.tangent_compliance_rad_per_nm(0.0), 1.0 / 5e4, "the bench shows the mean");
    }
}
