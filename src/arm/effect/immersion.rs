//! `immersion`: the arm is in water. Its links are sealed tubes: they lose weight by buoyancy, and some water moves
//! with them (added mass).

use super::kind::{Absent, Kind, Parameter, Place, Scale, Scope, Traits};
use super::subject::Subject;
use crate::arm::load::Water;

/// Name of the parameter for the density of the payload. A campaign may state its value.
pub(crate) const PAYLOAD_DENSITY: &str = "payload_density_kg_m3";

const PARAMETERS: &[Parameter] = &[
    Parameter::number("water_density_kg_m3", 0.0, 2000.0, 1000.0, Scale::Linear).expected(0.0, 1500.0),
    Parameter::number("added_mass_coefficient", 0.0, 4.0, 1.0, Scale::Linear)
        .expected(0.0, 2.5)
        .absent(Absent::Never),
    Parameter {
        default: Some(7850.0),
        ..Parameter::number(PAYLOAD_DENSITY, 1.0, 30000.0, 7850.0, Scale::Linear)
    },
];

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "immersion",
    summary: "the arm is in water: buoyancy and added mass",
    scope: Scope::Product,
    places: &[Place::Arm],
    parameters: |_| PARAMETERS,
    apply,
    traits: Traits { is_nonlinear: true, starts: |_| vec![vec![1.0, 1.0]], ..Traits::USUAL },
};

fn apply(numbers: &[f64], _at: &str, subject: &mut Subject) {
    subject.structure.water = Some(Water {
        density_kg_m3: numbers[0],
        added_mass_coefficient: numbers[1],
        payload_density_kg_m3: numbers[2],
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn subject() -> Subject {
        super::super::validate::testing::two_link_subject()
    }

    #[test]
    fn the_weight_falls_by_the_displaced_water() {
        use crate::arm::LinkModel;
        use crate::arm::load::Payload;
        use nalgebra::Vector3;
        let base_force = |wet: bool| {
            let mut subject = subject();
            if wet {
                apply(&[1000.0, 1.0, 7850.0], "arm", &mut subject);
            }
            let chain = crate::mechanics::chain::Chain::new(&subject.structure, LinkModel::Full);
            let payload = Payload { mass_kg: 7.85, ..Default::default() };
            chain.pose_rad(&[0.0, 0.0], &payload, Vector3::zeros()).statics().base_wrench[2]
        };
        // two links of 0.5 m, 0.1 x 0.1 m outside, and 1 litre of payload
        let displaced_kg = 1000.0 * (2.0 * 0.5 * 0.01) + 1.0;
        assert!((base_force(true) - base_force(false) - 9.81 * displaced_kg).abs() < 1e-9);
    }
}
