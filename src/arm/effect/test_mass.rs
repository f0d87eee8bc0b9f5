//! `test_mass`: an additional mass at the tip in one kind of test, such as accelerometers and their cables.

use super::channel::Channel;
use super::kind::{Kind, Measure, Parameter, Place, RARE_PRIOR, Scale, Scope, Traits};
use super::subject::Subject;
use nalgebra::Vector3;

const PARAMETERS: &[Parameter] = &[
    Parameter::number("mass_kg", 0.0, 20.0, 0.2, Scale::Linear)
        .expected(0.0, 2.0)
        .growing_with(Measure::ArmMass, 1.0 / 20.0),
    Parameter { default: Some(0.0), ..Parameter::vector("cg_m", -0.5, 0.5, 0.05) }.expected(-0.2, 0.2),
];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "test_mass",
    summary: "something hangs at the tip in one kind of test",
    scope: Scope::Test,
    places: &[
        Place::Channel(Channel::Static),
        Place::Channel(Channel::Modal),
        Place::Channel(Channel::Positions),
    ],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits {
        // static readings are differences from a reference state in which the arm has this mass as well, so they cannot
        // show it
        sought_in: &[Channel::Modal],
        variants: &[&[("mass_kg", None)], &[("mass_kg", None), ("cg_m", None)]],
        odds: RARE_PRIOR,
        starts: |setting| vec![(0..setting.values_at_one.len()).map(|i| f64::from(i == 0)).collect()],
        ..Traits::USUAL
    },
};

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    let Some(setup) = subject.setup_mut(at) else { return };
    let (mass_kg, cg_m) = (numbers[0], Vector3::new(numbers[1], numbers[2], numbers[3]));
    let moment = setup.cg_m * setup.mass_kg + cg_m * mass_kg;
    setup.mass_kg += mass_kg;
    setup.cg_m = if setup.mass_kg == 0.0 { cg_m } else { moment / setup.mass_kg };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arm::LinkModel;
    use crate::arm::load::Payload;
    use crate::mechanics::chain::Chain;

    fn subject() -> Subject {
        super::super::validate::testing::two_link_subject()
    }

    #[test]
    fn it_weighs_and_swings_like_a_payload_in_its_channel_and_nowhere_else() {
        let mut subject = subject();
        let bare = subject.structure.clone();
        apply(&[0.4, 0.02, -0.03, 0.05], "modal", &mut subject);
        let payload = Payload { mass_kg: 0.4, cg_m: Vector3::new(0.02, -0.03, 0.05), ..Payload::default() };
        let answers = |structure: &crate::arm::structure::Structure, payload: &Payload| {
            let chain = Chain::new(structure, LinkModel::Full);
            let posed = chain.pose_rad(&[0.4, 0.9], payload, Vector3::new(3.0, -2.0, 1.0));
            let statics = posed.statics();
            let modes = posed.modes(&statics, 4);
            (statics.tip_displacement_m, modes.iter().map(|m| m.frequency_hz).collect::<Vec<_>>())
        };
        let (with_m, with_hz) = answers(&subject.structure_in(Channel::Modal), &Payload::default());
        let (like_m, like_hz) = answers(&bare, &payload);
        assert!((with_m - like_m).norm() < 1e-12, "{with_m} {like_m}");
        assert!(
            with_hz.iter().zip(&like_hz).all(|(a, b)| (a / b - 1.0).abs() < 1e-9),
            "{with_hz:?} {like_hz:?}"
        );
        assert_eq!(subject.structure_in(Channel::Static), bare);
    }
}
