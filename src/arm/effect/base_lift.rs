//! `base_lift`: the feet of the base lift off the floor. About world x and y the base is rigid up to a preload
//! moment, and deflects elastically beyond it.

use super::kind::{Kind, Parameter, Place, RARE_PRIOR, Scale, Scope, Setting, Traits};
use super::subject::Subject;
use crate::arm::base_lift::BaseLift;

const PARAMETERS: &[Parameter] = &[
    Parameter::number("stiffness_nm_per_rad", 1e-3, 1e10, 5e5, Scale::Stiffness).expected(0.0, 6.0),
    Parameter::number("preload_nm", 1e-3, 1e6, 100.0, Scale::Log)
        .expected(1.0, 1e4)
        .within_torque(0.05, 0.95),
];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "base_lift",
    summary: "the feet of the base lift off beyond a preload",
    scope: Scope::Product,
    places: &[Place::Base],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits {
        odds: RARE_PRIOR,
        starts,
        is_nonlinear: true,
        screens_at_starts: true,
        moves_working_points: true,
        in_bounds: false,
        ..Traits::USUAL
    },
};

/// Starting points of a fit: feet that lift off at 15 % to 85 % of the largest torque, each on soft and on stiffer
/// ground.
fn starts(setting: &Setting) -> Vec<Vec<f64>> {
    let preloads = [0.15, 0.35, 0.6, 0.85].map(|part| libm::log(part * setting.torque_nm));
    preloads.iter().flat_map(|preload| [0.1, 0.5].map(|soft| vec![soft, *preload])).collect()
}

fn apply(numbers: &[f64], _at: &str, subject: &mut Subject) {
    let lift = BaseLift { stiffness_nm_per_rad: numbers[0], preload_nm: numbers[1] };
    subject.structure.base_lift = Some(lift);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::LinkModel;
    use crate::arm::load::Payload;
    use crate::mechanics::chain::Chain;
    use nalgebra::Vector3;

    #[test]
    fn the_base_tilts_by_what_the_moment_has_beyond_the_preload() {
        let mut subject = super::super::validate::testing::two_link_subject();
        subject.structure.gravity_m_s2 = 0.0;
        apply(&[2e5, 30.0], "base", &mut subject);
        let share = |force_n: f64| {
            let chain = Chain::new(&subject.structure, LinkModel::Rigid);
            let posed = chain.pose_rad(&[0.0, 0.0], &Payload::default(), Vector3::new(0.0, 0.0, -force_n));
            let statics = posed.statics();
            let shares = statics.shares_m.iter().find(|(n, _)| n == "base_lift");
            (shares.expect("share").1, statics.tangent_compliances[0].clone())
        };
        // the tip is 1 m away along x, so the moment is about y
        let (standing, rigid) = share(29.0);
        assert_eq!((standing.norm(), rigid), (0.0, vec![0.0, 0.0]));
        let (lifted, soft) = share(50.0);
        assert!((lifted.z + 20.0 / 2e5).abs() < 1e-15, "{lifted}");
        assert_eq!(soft, [0.0, 1.0 / 2e5]);
    }
}
