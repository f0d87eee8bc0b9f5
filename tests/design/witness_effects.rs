//! Each effect the witness can switch on, against what its law says of a case simple enough to do by hand.

use crate::witness::{
    self, Answer, Effects, Immersion, LoadCase, LostMotion, Options, Payload, ThreeSegment,
};
use nalgebra::Vector3;
use serde_json::{Value, json};
use std::collections::BTreeMap;

const STIFFNESS_NM_PER_RAD: f64 = 2e4;
const LEVER_M: f64 = 0.6;
const PAYLOAD_KG: f64 = 5.0;
const GRAVITY_M_S2: f64 = 9.81;
const TORQUE_NM: f64 = PAYLOAD_KG * GRAVITY_M_S2 * LEVER_M;

/// One sprung joint about y, a rigid weightless lever along x.
fn lever() -> Value {
    json!({
        "gravity_m_s2": GRAVITY_M_S2, "materials": {},
        "chain": [
            {"type": "joint", "name": "j", "axis": [0, 1, 0], "stiffness_nm_per_rad": STIFFNESS_NM_PER_RAD},
            {"type": "link", "name": "lever", "vector_m": [LEVER_M, 0, 0]}
        ]
    })
}

/// A round aluminium tube along x, clamped.
fn tube() -> Value {
    json!({
        "gravity_m_s2": GRAVITY_M_S2,
        "materials": {"aluminium": {
            "youngs_modulus_pa": 7e10, "shear_modulus_pa": 2.6e10, "density_kg_m3": 2700.0
        }},
        "chain": [{
            "type": "link", "name": "tube", "vector_m": [1.5, 0, 0], "material": "aluminium",
            "section": {"shape": "round_tube", "diameter_m": 0.05, "wall_m": 0.003}
        }]
    })
}

fn tube_area_m2() -> f64 {
    std::f64::consts::FRAC_PI_4 * (0.05_f64.powi(2) - 0.044_f64.powi(2))
}

fn tube_outer_area_m2() -> f64 {
    std::f64::consts::FRAC_PI_4 * 0.05_f64.powi(2)
}

/// A four-joint arm with every kind of part, for properties that hold of any arm.
fn crooked_arm() -> Value {
    let windup = json!({
        "k1_nm_per_rad": 3e4, "k2_nm_per_rad": 5e4, "k3_nm_per_rad": 7e4, "t1_nm": 14.0, "t2_nm": 48.0
    });
    let box_section = json!({"shape": "rectangular_tube", "width_m": 0.06, "height_m": 0.1, "wall_m": 0.004});
    let round_section = json!({"shape": "round_tube", "diameter_m": 0.07, "wall_m": 0.003});
    json!({
        "gravity_m_s2": GRAVITY_M_S2,
        "materials": {"steel": {
            "youngs_modulus_pa": 2.1e11, "shear_modulus_pa": 8.1e10, "density_kg_m3": 7850.0
        }},
        "chain": [
            {"type": "joint", "name": "a", "axis": [0, 0, 1], "stiffness_nm_per_rad": 8e4, "mass_kg": 4.0},
            {"type": "link", "name": "offset", "vector_m": [0.05, 0.02, 0.2], "mass_kg": 3.0},
            {"type": "joint", "name": "b", "axis": [0, 1, 0], "windup": windup, "mass_kg": 5.0},
            {"type": "link", "name": "upper", "vector_m": [0.5, 0.1, 0.05], "material": "steel",
             "section": box_section},
            {"type": "joint", "name": "c", "axis": [0, 0.6, 0.8], "stiffness_nm_per_rad": null, "mass_kg": 2.0},
            {"type": "link", "name": "fore", "vector_m": [0, 0, 0.4], "material": "steel",
             "section": round_section},
            {"type": "joint", "name": "d", "axis": [1, 0, 0], "stiffness_nm_per_rad": 9e3, "mass_kg": 1.0}
        ]
    })
}

fn crooked_case() -> LoadCase {
    LoadCase::unloaded(&[20.0, -35.0, 70.0, 50.0])
        .with_payload(Payload {
            inertia_about_cg_kgm2: Vector3::new(0.01, 0.02, 0.03),
            ..Payload::point(4.0, [0.1, 0.02, -0.03])
        })
        .with_tip_force([30.0, -20.0, 15.0])
}

fn every_effect() -> Effects {
    Effects {
        connection_compliance_nm_per_rad: at("b", 2e5),
        lost_motion: at("d", LostMotion { half_width_rad: 1e-4, torque_nm: 3.0 }),
        bearing_tilt_nm_per_rad: at("c", 1e5),
        base_compliance_nm_per_rad: Some(4e5),
        payload_mass_error_kg: 0.5,
        payload_cg_error_m: Vector3::new(0.01, 0.0, 0.02),
        extra_mass_kg: at("c", 1.5),
        harness_kg_per_m: at("upper", 2.0),
        modulus_factor: at("fore", 0.8),
        immersion: Some(Immersion {
            water_density_kg_m3: 1025.0,
            added_mass_coefficient: 1.0,
            payload_density_kg_m3: Some(7850.0),
        }),
        ..Effects::default()
    }
}

fn at<T>(place: &str, value: T) -> BTreeMap<String, T> {
    BTreeMap::from([(place.to_owned(), value)])
}

fn loaded() -> LoadCase {
    LoadCase::unloaded(&[0.0]).with_payload(Payload::point(PAYLOAD_KG, [0.0; 3]))
}

fn with(effects: Effects) -> Options {
    Options::default().with_effects(effects)
}

fn sag_m(answer: &Answer) -> f64 {
    -answer.tip_displacement_m.z
}

/// How far the lever's joint turned.
fn turn_rad(answer: &Answer) -> f64 {
    sag_m(answer) / LEVER_M
}

/// The stiffness the lever's mode feels.
fn felt_stiffness_nm_per_rad(answer: &Answer) -> f64 {
    let omega = answer.modes[0].frequency_hz * std::f64::consts::TAU;
    omega.powi(2) * PAYLOAD_KG * LEVER_M.powi(2)
}

#[track_caller]
fn assert_close(found: f64, expected: f64, relative: f64) {
    let deviation = (found / expected - 1.0).abs();
    assert!(deviation <= relative, "{found} against {expected}: {deviation:.2e} beyond {relative:.0e}");
}

#[test]
fn a_connection_is_a_spring_in_series() {
    let effects = Effects { connection_compliance_nm_per_rad: at("j", 3e4), ..Effects::default() };
    let answer = witness::analyze(&lever(), &loaded(), &with(effects));
    let series_nm_per_rad = 1.0 / (1.0 / STIFFNESS_NM_PER_RAD + 1.0 / 3e4);
    assert_close(turn_rad(&answer), TORQUE_NM / series_nm_per_rad, 1e-12);
    assert_close(felt_stiffness_nm_per_rad(&answer), series_nm_per_rad, 1e-12);
}

#[test]
fn a_soft_windup_replaces_the_number_and_modes_feel_its_slope() {
    let curve =
        ThreeSegment { k1_nm_per_rad: 1e4, k2_nm_per_rad: 2e4, k3_nm_per_rad: 3e4, t1_nm: 8.0, t2_nm: 25.0 };
    let effects = Effects { soft_windup: at("j", curve), ..Effects::default() };
    let answer = witness::analyze(&lever(), &loaded(), &with(effects));
    assert_close(turn_rad(&answer), 8.0 / 1e4 + 17.0 / 2e4 + (TORQUE_NM - 25.0) / 3e4, 1e-12);
    assert_close(felt_stiffness_nm_per_rad(&answer), 3e4, 1e-12);
}

#[test]
fn a_windup_in_the_arm_file_is_odd_in_the_torque() {
    let mut arm = lever();
    arm["chain"][0]["stiffness_nm_per_rad"] = Value::Null;
    arm["chain"][0]["windup"] = json!({
        "k1_nm_per_rad": 1e4, "k2_nm_per_rad": 2e4, "k3_nm_per_rad": 3e4, "t1_nm": 8.0, "t2_nm": 25.0
    });
    let lifted = loaded().with_tip_force([0.0, 0.0, 2.0 * PAYLOAD_KG * GRAVITY_M_S2]);
    let down = witness::analyze(&arm, &loaded(), &Options::default());
    let up = witness::analyze(&arm, &lifted, &Options::default());
    assert_close(sag_m(&up), -sag_m(&down), 1e-12);
    assert_close(up.torque_nm("j"), -TORQUE_NM, 1e-12);
}

#[test]
fn lost_motion_adds_its_tanh_and_softens_the_mode() {
    let (half_width_rad, scale_nm) = (3e-4, 20.0);
    let motion = LostMotion { half_width_rad, torque_nm: scale_nm };
    let effects = Effects { lost_motion: at("j", motion), ..Effects::default() };
    let answer = witness::analyze(&lever(), &loaded(), &with(effects));
    let tanh = (TORQUE_NM / scale_nm).tanh();
    assert_close(turn_rad(&answer), TORQUE_NM / STIFFNESS_NM_PER_RAD + half_width_rad * tanh, 1e-12);
    let slope = 1.0 / STIFFNESS_NM_PER_RAD + half_width_rad / scale_nm * (1.0 - tanh.powi(2));
    assert_close(felt_stiffness_nm_per_rad(&answer), 1.0 / slope, 1e-9);
}

#[test]
fn a_bearing_tilts_about_both_axes_across_the_joint() {
    let effects = Effects { bearing_tilt_nm_per_rad: at("j", 5e4), ..Effects::default() };
    let sideways = LoadCase::unloaded(&[0.0]).with_tip_force([0.0, 100.0, 0.0]);
    let answer = witness::analyze(&lever(), &sideways, &with(effects));
    assert_close(answer.tip_displacement_m.y, 100.0 * LEVER_M.powi(2) / 5e4, 1e-12);
    assert!(answer.tip_displacement_m.z.abs() < 1e-15, "the joint's own axis is not softened");
}

#[test]
fn bearing_tilt_of_a_vertical_first_joint_is_base_compliance() {
    let case = crooked_case();
    let tilt = Effects { bearing_tilt_nm_per_rad: at("a", 1e5), ..Effects::default() };
    let base = Effects { base_compliance_nm_per_rad: Some(1e5), ..Effects::default() };
    let tilted = witness::analyze(&crooked_arm(), &case, &with(tilt));
    let based = witness::analyze(&crooked_arm(), &case, &with(base));
    assert!((tilted.tip_displacement_m - based.tip_displacement_m).norm() < 1e-12);
    assert_close(tilted.modes[0].frequency_hz, based.modes[0].frequency_hz, 1e-9);
}

#[test]
fn a_payload_heavier_and_elsewhere_than_stated_is_another_payload() {
    let effects = Effects {
        payload_mass_error_kg: 0.7,
        payload_cg_error_m: Vector3::new(0.1, 0.0, 0.0),
        ..Effects::default()
    };
    let answer = witness::analyze(&lever(), &loaded(), &with(effects.clone()));
    let other = LoadCase::unloaded(&[0.0]).with_payload(Payload::point(PAYLOAD_KG + 0.7, [0.1, 0.0, 0.0]));
    let expected = witness::analyze(&lever(), &other, &Options::default());
    assert_close(sag_m(&answer), sag_m(&expected), 1e-12);
    let unloaded = witness::analyze(&lever(), &LoadCase::unloaded(&[0.0]), &with(effects));
    assert_eq!(unloaded.tip_displacement_m, Vector3::zeros(), "no payload stated, none wrong");
}

#[test]
fn a_harness_weighs_along_the_link_and_stiffens_nothing() {
    let kg_per_m = 2.5;
    let effects = Effects { harness_kg_per_m: at("tube", kg_per_m), ..Effects::default() };
    let case = LoadCase::unloaded(&[]);
    let bare = witness::analyze(&tube(), &case, &Options::default());
    let dressed = witness::analyze(&tube(), &case, &with(effects));
    let ratio = 1.0 + kg_per_m / (2700.0 * tube_area_m2());
    assert_close(sag_m(&dressed), ratio * sag_m(&bare), 1e-9);
    assert_close(dressed.modes[0].frequency_hz, bare.modes[0].frequency_hz / ratio.sqrt(), 2e-3);
}

#[test]
fn a_modulus_error_scales_bending_and_leaves_shear() {
    let effects = Effects { modulus_factor: at("tube", 0.5), ..Effects::default() };
    let case = LoadCase::unloaded(&[]).with_tip_force([0.0, 0.0, -200.0]);
    let mut arm = tube();
    arm["gravity_m_s2"] = json!(0.0);
    let full = witness::analyze(&arm, &case, &Options::default());
    let half = witness::analyze(&arm, &case, &with(effects));
    let shear_factor = 2.0 * 1.3 / (4.0 + 3.0 * 0.3);
    let shear_m = 200.0 * 1.5 / (shear_factor * 2.6e10 * tube_area_m2());
    assert_close(sag_m(&half) - shear_m, 2.0 * (sag_m(&full) - shear_m), 1e-9);
}

#[test]
fn water_lifts_the_links_and_moves_with_them() {
    let immersion =
        Immersion { water_density_kg_m3: 1000.0, added_mass_coefficient: 1.0, payload_density_kg_m3: None };
    let effects = Effects { immersion: Some(immersion), ..Effects::default() };
    let case = LoadCase::unloaded(&[]);
    let dry = witness::analyze(&tube(), &case, &Options::default());
    let wet = witness::analyze(&tube(), &case, &with(effects));
    let ratio = 1000.0 * tube_outer_area_m2() / (2700.0 * tube_area_m2());
    assert_close(sag_m(&wet), (1.0 - ratio) * sag_m(&dry), 1e-9);
    assert_close(wet.modes[0].frequency_hz, dry.modes[0].frequency_hz / (1.0 + ratio).sqrt(), 2e-3);
}

#[test]
fn water_lifts_a_payload_whose_density_is_known() {
    let immersion = Immersion {
        water_density_kg_m3: 1000.0,
        added_mass_coefficient: 1.0,
        payload_density_kg_m3: Some(4000.0),
    };
    let effects = Effects { immersion: Some(immersion), ..Effects::default() };
    let wet = witness::analyze(&lever(), &loaded(), &with(effects));
    assert_close(wet.torque_nm("j"), 0.75 * TORQUE_NM, 1e-12);
    assert_close(felt_stiffness_nm_per_rad(&wet), STIFFNESS_NM_PER_RAD, 1e-12);
}

#[test]
fn extra_mass_at_a_joint_is_a_heavier_joint() {
    let effects = Effects { extra_mass_kg: at("c", 1.5), ..Effects::default() };
    let mut heavier = crooked_arm();
    heavier["chain"][4]["mass_kg"] = json!(3.5);
    let found = witness::analyze(&crooked_arm(), &crooked_case(), &with(effects));
    let expected = witness::analyze(&heavier, &crooked_case(), &Options::default());
    assert_eq!(found.tip_displacement_m, expected.tip_displacement_m);
}

#[test]
fn effects_written_in_the_arm_file_are_the_same_effects() {
    let written = json!([
        {"effect": "connection_compliance", "at": "b", "parameters": {"stiffness_nm_per_rad": 2e5}},
        {"effect": "lost_motion", "at": "d", "parameters": {"half_width_rad": 1e-4, "torque_nm": 3.0}},
        {"effect": "bearing_tilt", "at": "c", "parameters": {"stiffness_nm_per_rad": 1e5}},
        {"effect": "base_compliance", "at": "base", "parameters": {"stiffness_nm_per_rad": 4e5}},
        {"effect": "payload_mass_error", "at": "payload", "parameters": {"delta_kg": 0.5}},
        {"effect": "payload_cg_error", "at": "payload", "parameters": {"offset_m": [0.01, 0, 0.02]}},
        {"effect": "extra_mass", "at": "c", "parameters": {"delta_kg": 1.5}},
        {"effect": "harness_mass", "at": "upper", "parameters": {"kg_per_m": 2.0}},
        {"effect": "modulus_error", "at": "fore", "parameters": {"factor": 0.8}},
        {"effect": "immersion", "at": "arm", "parameters": {
            "water_density_kg_m3": 1025.0, "added_mass_coefficient": 1.0, "payload_density_kg_m3": 7850.0
        }}
    ]);
    let read = witness::analyze(&crooked_arm(), &crooked_case(), &with(Effects::from_json(&written)));
    let built = witness::analyze(&crooked_arm(), &crooked_case(), &with(every_effect()));
    assert_eq!(read.tip_displacement_m, built.tip_displacement_m);
    assert_eq!(read.frequencies_hz(), built.frequencies_hz());
}

#[test]
fn shares_sum_to_the_tip_and_strain_energies_to_one() {
    let options = with(every_effect());
    let answer = witness::analyze(&crooked_arm(), &crooked_case(), &options);
    let shares = witness::shares(&crooked_arm(), &crooked_case(), &options);
    let names: Vec<&str> = shares.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["base_compliance", "a", "b", "upper", "bearing_tilt:c", "fore", "d"]);
    let sum_m: Vector3<f64> = shares.iter().map(|(_, share_m)| share_m).sum();
    assert!((sum_m - answer.tip_displacement_m).norm() < 1e-9 * sum_m.norm(), "{sum_m}");
    for mode in &answer.modes {
        assert_close(mode.strain_energy.iter().map(|(_, share)| share).sum(), 1.0, 1e-12);
    }
}

#[test]
fn flexible_links_change_no_torque() {
    let flexible = witness::analyze(&crooked_arm(), &crooked_case(), &with(every_effect()));
    let rigid_links = Options::rigid_links().with_effects(every_effect());
    let rigid = witness::analyze(&crooked_arm(), &crooked_case(), &rigid_links);
    for (joint, torque_nm) in &flexible.joint_torque_nm {
        assert!((torque_nm - rigid.torque_nm(joint)).abs() < 1e-6, "{joint}: {torque_nm}");
    }
}

#[test]
fn turning_the_whole_arm_about_gravity_turns_the_answer() {
    let case = |first_deg: f64| {
        LoadCase::unloaded(&[first_deg, -35.0, 70.0, 50.0]).with_payload(Payload::point(4.0, [0.1, 0.0, 0.0]))
    };
    let here = witness::analyze(&crooked_arm(), &case(0.0), &Options::default());
    let there = witness::analyze(&crooked_arm(), &case(90.0), &Options::default());
    let turned =
        Vector3::new(-here.tip_displacement_m.y, here.tip_displacement_m.x, here.tip_displacement_m.z);
    assert!((turned - there.tip_displacement_m).norm() < 1e-10);
    for (here_hz, there_hz) in here.frequencies_hz().iter().zip(there.frequencies_hz()) {
        assert_close(*here_hz, there_hz, 1e-8);
    }
}
