//! Parts for tests: some rows of the catalogs copied as code, and generators of random parts.

use super::bearing::{BearingDemand, BearingLoad};
use super::demand::JointMotion;
use super::drive::Drive;
use super::fit::{FitRequirement, MotorPlace};
use super::requirement::MotionRequirement;
use crate::arm::bearing::BearingSource;
use crate::arm::extras::ExtrasSource;
use crate::catalog::envelope::Envelope;
use crate::catalog::gear::{BearingRatings, Gear, GearKind, GearMass, LifeLaw};
use crate::catalog::motor::{Motor, MotorKind};
use crate::catalog::{Confidence, Provenance};
use proptest::prelude::*;

fn provenance() -> Provenance {
    Provenance {
        source: "test".into(),
        confidence: Confidence::Verified,
        unverified_fields: vec![],
        file: "test".into(),
        line: 1,
    }
}

/// A drive of a housed gear and a motor, without extras.
pub(crate) fn housed<'c>(gear: &'c Gear, motor: &'c Motor) -> Drive<'c> {
    Drive {
        gear,
        motor,
        gear_mass: GearMass::HousedUnit,
        bearing: BearingSource::OfGear,
        extras: ExtrasSource::NONE,
        stage: crate::arm::Stage::NONE,
    }
}

/// A drive of a gear as component set and a motor, without extras.
pub(crate) fn component_set<'c>(gear: &'c Gear, motor: &'c Motor) -> Drive<'c> {
    Drive { gear_mass: GearMass::ComponentSet, ..housed(gear, motor) }
}

/// A gear and a motor that pass every check under 300 N m of static and 100 N m of linear torque, 1.35 m from the
/// tip.
pub(crate) fn ample() -> (Gear, Motor) {
    let mut gear = gear("CSG-50-100", [600.0, 900.0, 700.0, 2000.0], [3500.0, 2500.0], 0.00125, [3.2, 8.9]);
    gear.life.rated_h = Some(10_000.0);
    gear.permissible_tilting_moment_nm = Some(700.0);
    gear.bearing = BearingRatings {
        pitch_diameter_m: Some(0.1),
        offset_m: Some(0.02),
        static_load_rating_n: Some(80e3),
        dynamic_load_rating_n: Some(40e3),
    };
    (gear, motor("M", [10.0, 20.0], [2000.0, 3000.0], 0.0003, 4.0))
}

/// A gear with every rating that a check needs. The numbers of each array are in the order of the columns of
/// `gears.csv`.
pub(crate) fn gear(
    id: &str,
    torques_nm: [f64; 4],
    input_rpm: [f64; 2],
    inertia: f64,
    masses_kg: [f64; 2],
) -> Gear {
    let mut parts = id.split('-');
    let mut next = || parts.next().expect("series-size-ratio");
    let (series, size) = (next().to_string(), next().parse().expect("a size"));
    Gear {
        series,
        size,
        rated_torque_nm: Some(torques_nm[0]),
        repeated_peak_torque_nm: Some(torques_nm[1]),
        average_torque_limit_nm: Some(torques_nm[2]),
        momentary_peak_torque_nm: Some(torques_nm[3]),
        max_input_speed_rpm: Some(input_rpm[0]),
        average_input_speed_limit_rpm: Some(input_rpm[1]),
        inertia_input_kgm2: Some(inertia),
        mass_component_set_kg: Some(masses_kg[0]),
        mass_housed_unit_kg: Some(masses_kg[1]),
        efficiency: Some(0.78),
        ..Gear::unrated(id, GearKind::StrainWave, next().parse().expect("a ratio"), provenance())
    }
}

/// A motor with every rating: rated and peak torque \[N m\], rated and largest speed \[rpm\], inertia \[kg m²\], mass
/// \[kg\].
pub(crate) fn motor(
    id: &str,
    torques_nm: [f64; 2],
    speeds_rpm: [f64; 2],
    inertia: f64,
    mass_kg: f64,
) -> Motor {
    Motor {
        id: id.to_string(),
        kind: MotorKind::AcServo,
        vendor: "test".into(),
        rated_torque_nm: Some(torques_nm[0]),
        peak_torque_nm: Some(torques_nm[1]),
        rated_speed_rpm: Some(speeds_rpm[0]),
        max_speed_rpm: Some(speeds_rpm[1]),
        rotor_inertia_kgm2: Some(inertia),
        mass_kg: Some(mass_kg),
        curve: Vec::new(),
        rated_power_w: None,
        envelope: Default::default(),
        provenance: provenance(),
    }
}

/// `catalogs/gears.csv`, row HFUC-58-100.
pub(crate) fn hfuc_58_100() -> Gear {
    let mut gear =
        gear("HFUC-58-100", [696.0, 1590.0, 1060.0, 3180.0], [3000.0, 2200.0], 0.00273, [4.7, 14.6]);
    gear.permissible_tilting_moment_nm = Some(1180.0);
    (gear.buckling_torque_nm, gear.ratcheting_torque_nm) = (Some(12000.0), Some(6400.0));
    gear
}

/// `catalogs/gears.csv`, row HFUC-40-100, with the housed unit's bearing.
pub(crate) fn hfuc_40_100() -> Gear {
    let mut gear = gear("HFUC-40-100", [265.0, 568.0, 372.0, 1080.0], [4000.0, 3000.0], 0.00045, [1.7, 5.0]);
    gear.permissible_tilting_moment_nm = Some(450.0);
    (gear.buckling_torque_nm, gear.ratcheting_torque_nm) = (Some(4300.0), Some(2100.0));
    gear
}

/// `catalogs/motors.csv`, row F11-10.
pub(crate) fn f11_10() -> Motor {
    let mut motor = motor("F11-10", [31.12, 62.23], [10200.0, 11200.0], 0.00039, 7.5);
    motor.kind = MotorKind::HydraulicPiston;
    motor
}

/// `catalogs/motors.csv`, row J 8.2 (129-). Its rotor inertia is blank.
pub(crate) fn char_lynn_j_8_2() -> Motor {
    let mut motor = motor("J 8.2 (129-)", [13.7, 16.2], [1992.0, 2390.0], 0.0, 2.0);
    motor.kind = MotorKind::HydraulicOrbital;
    motor.rotor_inertia_kgm2 = None;
    motor
}

/// A random rating within a range; one in twenty is blank.
fn rating_in(range: std::ops::Range<f64>) -> impl Strategy<Value = Option<f64>> {
    prop_oneof![19 => range.prop_map(Some), 1 => Just(None)]
}

prop_compose! {
    /// A gear with random ratings.
    pub fn any_gear()(
        series in prop_oneof![Just("CSG"), Just("HFUC")],
        life in any_life(),
        ratio in prop_oneof![Just(30u32), Just(50), Just(100), Just(160)],
        torques in prop::array::uniform4(rating_in(50.0..2000.0)),
        speeds in prop::array::uniform2(rating_in(300.0..6000.0)),
        inertia in rating_in(0.0..0.003),
        masses in prop::array::uniform2(rating_in(0.1..15.0)),
        tilt in rating_in(50.0..1000.0),
        bearing in (
            rating_in(0.05..0.3), rating_in(0.0..0.05), rating_in(1e4..1e5), rating_in(5e3..6e4),
        ),
        breaking in prop::array::uniform2(prop::option::of(50.0..4000.0f64)),
        efficiency in rating_in(0.5..0.9),
        envelope in any_envelope(),
    ) -> Gear {
        let mut gear = gear(&format!("{series}-32-{ratio}"), [0.0; 4], [0.0; 2], 0.0, [0.0; 2]);
        [gear.rated_torque_nm, gear.repeated_peak_torque_nm, gear.average_torque_limit_nm,
            gear.momentary_peak_torque_nm] = torques;
        [gear.max_input_speed_rpm, gear.average_input_speed_limit_rpm] = speeds;
        [gear.mass_component_set_kg, gear.mass_housed_unit_kg] = masses;
        (gear.inertia_input_kgm2, gear.efficiency) = (inertia, efficiency);
        (gear.kind, gear.life) = life;
        gear.permissible_tilting_moment_nm = tilt;
        let (pitch_diameter_m, offset_m, static_load_rating_n, dynamic_load_rating_n) = bearing;
        gear.bearing =
            BearingRatings { pitch_diameter_m, offset_m, static_load_rating_n, dynamic_load_rating_n };
        [gear.buckling_torque_nm, gear.ratcheting_torque_nm] = breaking;
        gear.envelope = envelope;
        gear
    }
}

/// A random kind of gear with its life formula; rated hours and speed may be blank.
fn any_life() -> impl Strategy<Value = (GearKind, LifeLaw)> {
    let kind = prop_oneof![
        4 => Just(GearKind::StrainWave),
        1 => Just(GearKind::Planetary),
        1 => Just(GearKind::Cycloidal),
        1 => Just(GearKind::Belt),
        1 => Just(GearKind::Direct),
    ];
    (kind, rating_in(2e3..3e4), rating_in(50.0..3000.0), 3.0..3.5f64).prop_map(
        |(kind, rated_h, rated_speed_rpm, p)| {
            let exponent = if kind == GearKind::StrainWave { 3.0 } else { p };
            (kind, LifeLaw { rated_h, rated_speed_rpm, exponent })
        },
    )
}

prop_compose! {
    /// A motor with random ratings.
    pub fn any_motor()(
        torques in prop::array::uniform2(rating_in(1.0..60.0)),
        speeds in prop::array::uniform2(rating_in(300.0..6000.0)),
        inertia in rating_in(0.0..0.003),
        mass in rating_in(0.1..15.0),
        envelope in any_envelope(),
    ) -> Motor {
        let mut motor = motor("M", [0.0; 2], [0.0; 2], 0.0, 0.0);
        [motor.rated_torque_nm, motor.peak_torque_nm] = torques;
        [motor.rated_speed_rpm, motor.max_speed_rpm] = speeds;
        (motor.rotor_inertia_kgm2, motor.mass_kg) = (inertia, mass);
        motor.envelope = envelope;
        motor
    }
}

prop_compose! {
    /// The motion of a joint at a random distance from the tip.
    pub fn any_motion()(
        reach in 0.2..2.0f64, ramp in 0.1..1.0f64, life in 1e3..5e4f64, fit in any_fit(),
    ) -> JointMotion {
        let study = MotionRequirement { ramp_time_s: ramp, life_h: life, ..Default::default() };
        JointMotion { fit, ..study.joint_motion(reach, None) }
    }
}

/// Random sizes of a part; some are blank.
fn any_envelope() -> impl Strategy<Value = Envelope> {
    let size = |range: std::ops::Range<f64>| prop_oneof![4 => range.prop_map(Some), 1 => Just(None)];
    (size(0.03..0.2), size(0.02..0.1), size(0.0..0.05)).prop_map(
        |(outer_diameter_m, length_m, hollow_bore_m)| Envelope { outer_diameter_m, length_m, hollow_bore_m },
    )
}

/// Random limits on sizes; often there is none.
fn any_fit() -> impl Strategy<Value = FitRequirement> {
    let asked = |range: std::ops::Range<f64>| prop_oneof![1 => range.prop_map(Some), 3 => Just(None)];
    let motor = prop_oneof![Just(MotorPlace::Behind), Just(MotorPlace::InLink), Just(MotorPlace::Beside)];
    (asked(0.5..2.0), motor, asked(0.0..0.03), asked(0.06..0.2), asked(0.02..0.1)).prop_map(
        |(gear_to_link_max, motor, cable_bore_min_m, drive_length_max_m, link_length_m)| FitRequirement {
            gear_to_link_max,
            motor,
            cable_bore_min_m,
            drive_length_max_m,
            link_length_m,
        },
    )
}

/// Width of a link and clear width of its hollow \[m\], at random.
pub(crate) fn any_link_m() -> impl Strategy<Value = [f64; 2]> {
    (0.05..0.2f64, 0.0..1.0f64).prop_map(|(width_m, clear)| [width_m, clear * width_m])
}

/// Loads on a bearing whose moment while running is `moment_nm` \[N m\]; the other loads are in a fixed ratio to it.
pub(crate) fn bearing_loads(moment_nm: f64) -> BearingDemand {
    let load = |times: f64| BearingLoad {
        moment_nm: times * moment_nm,
        radial_n: times * 3.0 * moment_nm,
        axial_n: times * 2.0 * moment_nm,
    };
    BearingDemand { at_rest: load(0.6), running: load(1.0), in_stop: load(1.4) }
}

/// Static torque, linear torque and moment on the bearing at random \[N m\]; one in ten is zero.
pub(crate) fn any_torques() -> impl Strategy<Value = [f64; 3]> {
    let torque = || prop_oneof![1 => Just(0.0), 9 => 0.0..800.0f64];
    (torque(), torque(), torque()).prop_map(|(a, b, c)| [a, b, c])
}
