//! `hysteresis`: friction holds a joint back, so its angle of torsion lags a reversal of the torque by up to the half
//! width.

use super::kind::{Kind, Measure, Needs, Parameter, Place, Scale, Scope, Setting, Traits};
use super::subject::Subject;

const PARAMETERS: &[Parameter] = &[Parameter::number("half_width_rad", 0.0, 0.1, 1e-4, Scale::Linear)
    .expected(0.0, 2e-3)
    .sought_up_to(5e-3)
    .growing_with(Measure::Angle, 1.0)];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "hysteresis",
    summary: "friction play: the twist lags a reversal of torque",
    scope: Scope::Product,
    places: &[Place::Joint],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits { needs: Needs::TwistingJoint, starts, ..Traits::USUAL },
};

/// Half widths of the friction play at which a fit starts. A joint whose friction play is as wide as its largest angle
/// of torsion does not move, and the objective then has no slope to follow. So no start is wider than 0.3 of this
/// angle.
fn starts(setting: &Setting) -> Vec<Vec<f64>> {
    const WIDEST: f64 = 0.3;
    let usual_rad = [0.25e-4, 1e-4, 3e-4].into_iter().filter(|h| *h < WIDEST * setting.twist_rad);
    let parts_rad = [0.01, 0.06].into_iter().map(|part| part * setting.twist_rad);
    parts_rad.chain(usual_rad).map(|h| vec![h / setting.values_at_one[0]]).collect()
}

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    if let Some(joint) = subject.structure.joint_mut(at) {
        joint.law.hysteresis_rad += numbers[0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn subject() -> Subject {
        super::super::validate::testing::two_link_subject()
    }

    #[test]
    fn a_torque_rising_from_rest_twists_less_by_the_half_width() {
        let mut subject = subject();
        apply(&[1e-4], "j1", &mut subject);
        let law = subject.structure.joint_mut("j1").expect("j1").law;
        assert!((law.rising_angle_rad(100.0) - (100.0 / 1e5 - 1e-4)).abs() < 1e-15);
        assert!((law.tangent_compliance_rad_per_nm(100.0) - 1e-5).abs() < 1e-20);
    }

    #[test]
    fn the_play_drags_its_spring_at_the_half_width() {
        let mut subject = subject();
        apply(&[1e-4], "j1", &mut subject);
        let law = subject.structure.joint_mut("j1").expect("j1").law;
        // the half width h of the play corresponds to a torque k h = 10 N m; the torque rises to 100, falls to 50 and
        // then to 45 N m
        let mut state = 10.0;
        let twist: Vec<f64> = [100.0, 50.0, 45.0].map(|t| law.play_angle_rad(t, &mut state)).to_vec();
        assert!((twist[0] - (1e-3 - 1e-4)).abs() < 1e-15);
        assert!((twist[1] - (0.5e-3 + 1e-4)).abs() < 1e-15);
        assert!((twist[2] - (0.45e-3 + 1e-4)).abs() < 1e-15);
    }
}
