//! The list of all effects. A new effect needs one file in this folder, one line in this list and a page in
//! `docs/effects`.

use super::kind::Kind;
use super::{
    base_compliance, base_lift, bearing_tilt, connection_compliance, drift, empirical, extra_mass,
    frame_compliance, guide_tilt, harness_mass, hysteresis, immersion, joint_compliance, joint_torque,
    link_flexibility, lost_motion, modulus_error, outlier, payload_cg_error, payload_mass_error, sensor_bias,
    sensor_gain, servo_compliance, soft_windup, stiffness_waves, test_mass, thermal_modulus, time_shift,
    transmission_error, travel_compliance, wrong_unit,
};

const COUNT: usize = 31;

/// The descriptions of all effects, in the order of the documentation.
pub static KINDS: [&Kind; COUNT] = [
    &connection_compliance::KIND,
    &soft_windup::KIND,
    &lost_motion::KIND,
    &hysteresis::KIND,
    &bearing_tilt::KIND,
    &base_compliance::KIND,
    &base_lift::KIND,
    &frame_compliance::KIND,
    &travel_compliance::KIND,
    &guide_tilt::KIND,
    &payload_mass_error::KIND,
    &payload_cg_error::KIND,
    &extra_mass::KIND,
    &harness_mass::KIND,
    &modulus_error::KIND,
    &immersion::KIND,
    &joint_torque::KIND,
    &stiffness_waves::KIND,
    &joint_compliance::KIND,
    &link_flexibility::KIND,
    &transmission_error::KIND,
    &sensor_gain::KIND,
    &sensor_bias::KIND,
    &drift::KIND,
    &test_mass::KIND,
    &servo_compliance::KIND,
    &thermal_modulus::KIND,
    &outlier::KIND,
    &wrong_unit::KIND,
    &time_shift::KIND,
    &empirical::KIND,
];

/// The names of all effects.
pub(crate) static NAMES: [&str; COUNT] = {
    let mut names = [""; COUNT];
    let mut i = 0;
    while i < COUNT {
        names[i] = KINDS[i].name;
        i += 1;
    }
    names
};

/// The description of the effect with this name; `None` if there is no such effect.
pub fn kind(name: &str) -> Option<&'static Kind> {
    KINDS.iter().copied().find(|k| k.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_has_a_name_of_its_own_a_place_and_a_page() {
        for (i, kind) in KINDS.iter().enumerate() {
            assert!(KINDS[..i].iter().all(|k| k.name != kind.name));
            assert!(!kind.places.is_empty() && !kind.summary.is_empty());
            let page = format!("{}/docs/effects/{}.md", env!("CARGO_MANIFEST_DIR"), kind.name);
            assert!(std::path::Path::new(&page).exists(), "{page} is missing");
            for place in kind.places {
                for p in (kind.parameters)(*place) {
                    assert!(p.low <= p.typical && p.typical <= p.high, "{} {}", kind.name, p.name);
                }
            }
        }
    }
}
