//! What every number of a result leaves out stands beside the numbers.

use crate::links::{armwright, folder_with};
use serde_json::{Value, json};

/// An arm of one joint and one open tube.
fn study(joint: Value) -> Value {
    let mut joint = joint;
    joint["type"] = json!("joint");
    joint["name"] = json!("shoulder");
    joint["axis"] = json!([0, 1, 0]);
    let choose = json!({"materials": ["Aluminium 6061-T6"],
        "sections": [{"shape": "rectangular_tube", "width_mm": [60, 80], "wall_mm": [2, 3]}]});
    json!({"name": "one joint", "question": "?", "payload": {"mass_kg": 2},
        "chain": [joint, {"type": "link", "name": "arm", "vector_m": [0.5, 0, 0], "choose": choose}],
        "poses": [{"name": "level", "pose_deg": [0]}]})
}

/// Whether terminal, summary, page and run.json say it.
fn said(joint: Value) -> [bool; 4] {
    let here = folder_with("study.json", &study(joint));
    let (code, terminal) = armwright(here.path(), &["run", "study.json", "--out", "out"]);
    assert_eq!(code, 0, "{terminal}");
    let read = |file: &str| std::fs::read_to_string(here.path().join("out").join(file)).expect(file);
    [terminal, read("summary.md"), read("report.html"), read("run.json")].map(|text| {
        let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
        words.contains("Left out of every number: the output bearings")
            && words.contains("the heat of the motors")
    })
}

#[test]
fn a_result_with_gears_says_that_bearings_heat_and_housings_are_left_out() {
    assert_eq!(said(json!({"drive": "first_fit"})), [true; 4]);
    assert_eq!(said(json!({"gear": "CSG-25-100", "mass_kg": 3.0})), [true; 4]);
}

#[test]
fn a_result_without_gears_leaves_no_bearing_out() {
    assert_eq!(said(json!({"stiffness_nm_per_rad": 1e5, "mass_kg": 3.0})), [false; 4]);
}
