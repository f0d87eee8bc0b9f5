//! Studies in which output bearings decide, by the program and by brute force.

use crate::brute::catalog::Catalog;
use crate::brute::design::search;
use crate::brute::study::Study;
use crate::brute_force::assert_same;
use crate::brute_studies::{ALUMINIUM, STEEL, boxes, six_axes};
use serde_json::{Value, json};

/// A reach and a payload that ask more of bearings than of teeth: at the waist, whose gear is a choice, and at the wrist.
fn heavy() -> Value {
    let mut chain = six_axes(
        boxes(&[STEEL, ALUMINIUM], json!([100, 160]), json!([120, 160]), json!([4])),
        boxes(&[STEEL, ALUMINIUM], json!([60, 120]), json!([100]), json!([3])),
    );
    chain[0]["drive"] = json!("all_fits");
    chain[8]["bearing"] = json!({"tilt_stiffness_nm_per_rad": 6e4, "permissible_moment_nm": 60, "mass_kg": 0.4,
        "pitch_diameter_m": 0.05, "static_load_rating_n": 9000, "dynamic_load_rating_n": 5800});
    json!({
        "name": "brute-bearings", "extras": {"flange_kg": 0.2},
        "chain": chain,
        "payload": {"mass_kg": 9, "cg_m": [0.02, 0.06, 0.04], "inertia_about_cg_kgm2": [0.02, 0.03, 0.02]},
        "poses": [{"name": "stretched", "pose_deg": [0, 0, 0, 0, 0, 0]},
            {"name": "aside", "pose_deg": [30, -40, 70, 50, -60, 20], "tip_force_n": [15, -20, -30]}],
        "motion": {"tip_speed_m_s": 1.0, "ramp_time_s": 0.2, "life_h": 15000},
        "drives": {"gear_series": ["CSG", "SHG"], "ratios": [100], "motor_models": ["ILM50x14", "ILM70x18", "ILM85x26",
            "ILM115x25"], "gear_mass": "housed_unit"}
    })
}

#[test]
fn finds_the_same_front_where_bearings_decide() {
    let agreement = assert_same(&heavy());
    assert!(agreement.front > 5, "{agreement:?}");
}

/// The study would tell nothing if teeth and motors decided.
#[test]
fn without_its_bearings_the_study_has_other_designs() {
    let catalog = Catalog::built_in();
    let with = search(&Study::from_json(&heavy(), &catalog)).designs;
    let mut rigid = heavy();
    for piece in rigid["chain"].as_array_mut().expect("a chain") {
        if piece["type"] == "joint" {
            piece["bearing"] = Value::Null;
        }
    }
    let without = search(&Study::from_json(&rigid, &catalog)).designs;
    println!("{} designs hold, {} without bearings", with.len(), without.len());
    assert!(with.len() > 20 && with.len() * 11 < without.len() * 10);
}
