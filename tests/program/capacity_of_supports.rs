//! What bearings and guides that a study states leave of an arm's capacity, the speeds of joints that state their own, and
//! what joints hold while others move at the largest payload.

use crate::running::armwright;
use serde_json::{Value, json};
use std::path::Path;

const G_M_S2: f64 = 9.81;

fn said(folder: &Path, study: &Value, words: &[&str]) -> String {
    std::fs::write(folder.join("study.json"), study.to_string()).expect("written");
    let (code, said) = armwright(folder, words);
    assert_eq!(code, 0, "{words:?}: {said}");
    said
}

fn capacity(study: &Value) -> Value {
    let here = tempfile::tempdir().expect("a folder");
    serde_json::from_str(&said(here.path(), study, &["capacity", "study.json", "--json"])).expect("JSON")
}

/// The words of a verb about the study, on one line.
fn words(study: &Value, verb: &[&str]) -> String {
    let here = tempfile::tempdir().expect("a folder");
    let said = said(here.path(), study, &[verb, &["study.json"]].concat());
    said.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// A SCARA whose first joint is given in numbers, with a weak output bearing, and whose second is sized.
fn scara() -> Value {
    let tube = json!({"shape": "rectangular_tube", "width_m": 0.08, "height_m": 0.1, "wall_m": 0.004});
    json!({"name": "scara", "chain": [
        {"type": "joint", "name": "j1", "axis": [0, 0, 1], "stiffness_nm_per_rad": 1e5, "max_speed_rad_s": 4, "bearing": {
            "permissible_moment_nm": 60, "pitch_diameter_m": 0.1, "static_load_rating_n": 8000, "dynamic_load_rating_n": 5000,
            "tilt_stiffness_nm_per_rad": 3e5}},
        {"type": "link", "name": "u", "vector_m": [0.5, 0, 0], "material": "Aluminium 6082-T6", "section": tube},
        {"type": "joint", "name": "j2", "axis": [0, 0, 1], "drive": "first_fit", "max_speed_rad_s": 0.5},
        {"type": "link", "name": "f", "vector_m": [0.4, 0, 0], "material": "Aluminium 6082-T6", "section": tube}],
        "extras": "none", "payload": {"mass_kg": 3}, "motion": {"tip_speed_m_s": 1, "ramp_time_s": 0.2, "life_h": 1000},
        "poses": [{"name": "a", "pose_deg": [0, 0]}], "drives": {"gear_series": ["CSG"], "ratios": [100], "motors": ["electric"]}})
}

/// The moment of the payload about j1 grows by 9.81 · 0.9 N m for each kilogram, and the bearing ends it.
#[test]
fn a_bearing_that_the_study_states_at_a_given_drive_ends_the_capacity() {
    let found = capacity(&scara());
    assert_eq!(found["joint"], "j1", "{found}");
    let mut strong = scara();
    strong["chain"][0]["bearing"]["permissible_moment_nm"] = json!(70);
    let more = capacity(&strong);
    if found["check"] == "bearing moment" && more["check"] == "bearing moment" {
        let more_kg = number(&more["payload_kg"]) - number(&found["payload_kg"]);
        // half the width of the link times the force of a ramp adds to the moment a little
        assert!((more_kg * G_M_S2 * 0.9 / 10.0 - 1.0).abs() < 0.1, "{more_kg}");
    } else {
        panic!("{found} {more}");
    }
    // size and run say it too, of a bearing that is too weak for the payload of the study and of one that holds
    strong["chain"][0]["bearing"]["permissible_moment_nm"] = json!(20);
    let weak = "Output bearings of joints whose drives are given carry too much in the sizing cases: j1 (bearing moment";
    assert!(words(&strong, &["size"]).contains(weak), "{}", words(&strong, &["size"]));
    assert!(
        words(&strong, &["run", "--out", "out"])
            .contains("carry too much in the sizing cases of the picks: j1")
    );
    strong["chain"][0]["bearing"]["permissible_moment_nm"] = json!(500);
    assert!(
        words(&strong, &["size"])
            .contains("Output bearings of joints whose drives are given hold in the sizing cases")
    );
}

/// A column with 2 kg at 0.25 m, 3 kg at 0.5 m, 1 kg at 0.6 m and the payload at 0.7 m. While it stops with 10 m/s², the
/// guide carries the moment of all masses under 9.81 + 10 m/s².
fn column(max_pitch_nm: f64) -> Value {
    json!({"name": "column", "chain": [
        {"type": "prismatic", "name": "z", "axis": [0, 0, 1], "stiffness_n_per_m": 1e7, "mass_kg": 5, "guide": {
            "max_force_n": 2000, "max_roll_nm": max_pitch_nm, "max_pitch_nm": max_pitch_nm, "max_yaw_nm": max_pitch_nm}},
        {"type": "link", "name": "boom", "vector_m": [0.5, 0, 0], "mass_kg": 2},
        {"type": "joint", "name": "j", "axis": [0, 0, 1], "stiffness_nm_per_rad": 1e5, "mass_kg": 3},
        {"type": "link", "name": "l", "vector_m": [0.2, 0, 0], "choose": {"materials": ["Aluminium 6061-T6"],
            "sections": [{"shape": "round_tube", "diameter_mm": [50], "wall_mm": [2]}]}}],
        "payload": {"mass_kg": 1}, "motion": {"tip_speed_m_s": 1, "ramp_time_s": 0.2, "emergency_deceleration_m_s2": 10},
        "poses": [{"pose": {"z_mm": 0}}]})
}

#[test]
fn a_guide_whose_limits_are_stated_ends_the_capacity_in_its_own_stop() {
    let at = |max_nm: f64| {
        let found = capacity(&column(max_nm));
        assert_eq!((&found["joint"], &found["check"]), (&json!("z"), &json!("guide in a stop")), "{found}");
        number(&found["payload_kg"])
    };
    let per_kg_nm = 0.7 * (G_M_S2 + 10.0);
    let (first_kg, second_kg) = (at(100.0), at(170.0));
    assert!(((second_kg - first_kg) * per_kg_nm / 70.0 - 1.0).abs() < 1e-6, "{first_kg} {second_kg}");
    // without the stop the payload would be twice as large and more
    let tube_kg = 2.0 * (0.05 - 0.002) * 0.002 * std::f64::consts::PI / 2.0 * 0.2 * 2700.0;
    let empty_kgm = 2.0 * 0.25 + 3.0 * 0.5 + tube_kg * 0.6;
    let right_kg = (100.0 / (G_M_S2 + 10.0) - empty_kgm) / 0.7;
    assert!((first_kg / right_kg - 1.0).abs() < 2e-3, "{first_kg}, by hand {right_kg}");
    assert!(words(&column(100.0), &["size"]).contains("Guides bear across their travel"));
}

#[test]
fn a_joint_with_a_speed_of_its_own_gives_no_speed_of_the_tip() {
    let study = json!({"name": "own", "chain": [
        {"type": "joint", "name": "j", "axis": [0, 0, 1], "drive": "first_fit", "max_speed_rad_s": 0.5},
        {"type": "link", "name": "l", "vector_m": [0.5, 0, 0], "mass_kg": 2}],
        "payload": {"mass_kg": 5}, "poses": [{"pose_deg": [0]}],
        "drives": {"gear_series": ["CSG"], "ratios": [100], "motors": ["electric"]}});
    let speed = &capacity(&study)["largest_speed"];
    let factor = number(&speed["factor"]);
    assert!(speed["tip_speed_m_s"].is_null() && factor > 1.0, "{speed}");
    assert_eq!(speed["own_speeds"], json!([{"joint": "j", "max_speed_rad_s": 0.5 * factor}]));
    assert!(words(&study, &["capacity"]).contains("times as fast as the study asks (j at "));
    // a duty in numbers does not grow, so that nothing does
    let mut duty = study.clone();
    duty["chain"][0].as_object_mut().expect("a joint").remove("max_speed_rad_s");
    duty["chain"][0]["duty"] = json!([{"torque_nm": 5, "time_s": 1, "speed_rpm": 10}, {"torque_nm": 0, "time_s": 1, "speed_rpm": 0}]);
    assert!(capacity(&duty)["largest_speed"].is_null());
}

/// While j1 ramps by 40 rad/s², the wrist must hold 0.4 · 0.9 · 40 N m for each kilogram of the payload: with the largest
/// payload so much more than with the payload of the study.
#[test]
fn capacity_says_what_joints_hold_while_others_move_with_the_largest_payload() {
    let mut study = scara();
    study["chain"][0] = json!({"type": "joint", "name": "j1", "axis": [0, 0, 1], "drive": "first_fit", "max_speed_rad_s": 8,
        "drives": {"gear_series": ["CSG"], "ratios": [50], "motors": ["electric"]}});
    let held_nm = |said: &str| -> f64 {
        let from = said.split("j2 must hold ").nth(1).unwrap_or_else(|| panic!("{said}"));
        from.split(' ').next().and_then(|nm| nm.parse().ok()).unwrap_or_else(|| panic!("{from}"))
    };
    let most_kg = number(&capacity(&study)["payload_kg"]);
    let said = words(&study, &["capacity"]);
    assert!(said.contains("in the sizing cases with the largest payload"), "{said}");
    let more_nm = held_nm(&said) - held_nm(&words(&study, &["size"]));
    let by_hand_nm = (most_kg - 3.0) * 0.4 * 0.9 * 40.0;
    // the torques are printed with three digits
    assert!((more_nm - by_hand_nm).abs() < 0.02 * held_nm(&said), "{more_nm}, by hand {by_hand_nm}");
}

#[test]
fn advice_on_a_bearing_names_every_rating_that_is_too_small() {
    let mut study = scara();
    study["chain"][0] = json!({"type": "joint", "name": "j1", "axis": [0, 0, 1], "drive": "first_fit", "max_speed_rad_s": 1,
        "drives": {"gears": ["CSG-14-100", "CSG-17-100", "CSG-20-100"], "motor_models": ["ILM70x10", "ILM70x18"]}});
    study["payload"] = json!({"mass_kg": 12, "cg_m": [0, 0, -0.1]});
    study["motion"]["life_h"] = json!(10000);
    let here = tempfile::tempdir().expect("a folder");
    std::fs::write(here.path().join("study.json"), study.to_string()).expect("written");
    let (code, said) = armwright(here.path(), &["size", "study.json"]);
    let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
    assert_ne!(code, 0, "{said}");
    for rating in [
        "permissible_moment_nm of at least",
        "static_load_rating_n at least",
        "dynamic_load_rating_n at least",
    ] {
        assert!(said.contains(rating), "{rating}: {said}");
    }
    assert!(!said.contains("times)"), "a difference of safety factors: {said}");
}
