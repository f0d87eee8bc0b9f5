//! The fronts of reduced studies against a slow, separately written search (see `brute`).
//!
//! Each study runs through the `armwright` program; its files are all that is compared.

mod brute;
mod witness;

use brute::catalog::Catalog;
use brute::design::{Design, Searched, objectives, search};
use brute::front::{Place, SLACK, exact_front_size, places};
use brute::program::{FrontRow, Results, armwright_ok, read_json, run_study, run_study_with, word};
use brute::study::Study;
use serde_json::{Value, json};
use std::collections::HashMap;

const DEFLECTION_TOLERANCE: f64 = 5e-4;
const MODE_TOLERANCE: f64 = 1e-3;
const MASS_TOLERANCE: f64 = 1e-9;

/// The chain of a six-axis arm with open links and drives.
fn six_axes(upper_arm: Value, forearm: Value) -> Value {
    json!([
        {"type": "joint", "name": "j1", "axis": [0, 0, 1], "drive": "first_fit"},
        {"type": "link", "name": "shoulder", "vector_m": [0, 0, 0.3]},
        {"type": "joint", "name": "j2", "axis": [0, 1, 0], "drive": "first_fit"},
        {"type": "link", "name": "upper_arm", "vector_m": [0.8, 0, 0], "choose": upper_arm},
        {"type": "joint", "name": "j3", "axis": [0, 1, 0], "drive": "first_fit"},
        {"type": "link", "name": "forearm", "vector_m": [0.5, 0, 0], "choose": forearm},
        {"type": "joint", "name": "j4", "axis": [1, 0, 0], "drive": "first_fit"},
        {"type": "joint", "name": "j5", "axis": [0, 1, 0], "drive": "first_fit"},
        {"type": "joint", "name": "j6", "axis": [1, 0, 0], "drive": "first_fit"},
        {"type": "link", "name": "flange", "vector_m": [0.05, 0, 0]}
    ])
}

fn boxes(materials: &[&str], widths: Value, heights: Value, walls: Value) -> Value {
    json!({"materials": materials, "sections": [
        {"shape": "rectangular_tube", "width_mm": widths, "height_mm": heights, "wall_mm": walls}]})
}

const STEEL: &str = "Structural steel S355";
const ALUMINIUM: &str = "Aluminium 6061-T6";
const CFRP: &str = "CFRP T300/5208 (standard modulus) quasi-isotropic";

/// The built-in `compare-materials` with fewer materials and sections, and no limits.
fn compare_materials() -> Value {
    let materials = [STEEL, ALUMINIUM, CFRP];
    json!({
        "name": "brute-compare",
        "chain": six_axes(
            boxes(&materials, json!([80, 140]), json!({"from": 100, "to": 180, "step": 80}), json!([3, 6])),
            boxes(&materials, json!([60, 100]), json!([60, 120]), json!([2, 5])),
        ),
        "payload": {"mass_kg": 5, "cg_m": [0, 0, 0.05]},
        "poses": [{"name": "stretched", "pose_deg": [0, 0, 0, 0, 0, 0]},
            {"name": "elbow bent", "pose_deg": [0, -45, 90, 0, 45, 0]}],
        "motion": {"tip_speed_m_s": 1.0, "ramp_time_s": 0.2},
        "drives": {"motors": ["electric"], "gear_mass": "housed_unit"}
    })
}

/// What is compared about a study, and how well the two agree.
#[derive(Debug, Default)]
struct Agreement {
    designs: usize,
    on_the_front: usize,
    close_calls: usize,
    worst_mass: f64,
    worst_deflection: f64,
    worst_mode: f64,
}

/// Runs a study with both and compares everything.
fn assert_same(study_json: &Value) -> Agreement {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let results = run_study(dir.path(), study_json);
    let study = Study::from_json(study_json, &Catalog::built_in());
    let searched = search(&study);
    assert_counts(&results, &searched, study_json);
    let all: Vec<&Design> = searched.designs.iter().collect();
    let mut agreement = assert_same_front("front.csv", study_json, &study, &results.front, &all);
    agreement.designs = all.len();
    for (material, front) in &results.by_material {
        let of_material: Vec<&Design> =
            all.iter().copied().filter(|design| design.only_material() == Some(material)).collect();
        let part = assert_same_front(material, study_json, &study, front, &of_material);
        agreement.worst_deflection = agreement.worst_deflection.max(part.worst_deflection);
        agreement.worst_mode = agreement.worst_mode.max(part.worst_mode);
    }
    println!("{}: {agreement:?}", study_json["name"]);
    agreement
}

fn assert_counts(results: &Results, searched: &Searched, study_json: &Value) {
    let [total, evaluated, excluded] =
        ["designs_total", "designs_evaluated", "designs_excluded"].map(|key| results.count(key));
    assert_eq!(evaluated + excluded, total, "every design is evaluated or excluded");
    assert_eq!(results.count("front_size"), results.front.len());
    assert!(!searched.designs.is_empty(), "a study without designs shows nothing");
    let has_free_drives = study_json["chain"].as_array().expect("a chain").iter().any(|p| p["drive"] == "all_fits");
    if !has_free_drives {
        assert_eq!(total, searched.link_choices, "designs_total");
    }
    let has_limits = study_json["constraints"].is_object();
    match has_limits {
        true => assert!(evaluated >= searched.designs.len(), "{evaluated} evaluated, {} meet", searched.designs.len()),
        false => assert_eq!(evaluated, searched.designs.len(), "designs_evaluated"),
    }
}

/// The same designs on a front, up to those whose place depends on the last 0.1 %, with the same parts and objectives.
fn assert_same_front(
    what: &str,
    study_json: &Value,
    study: &Study,
    front: &[FrontRow],
    designs: &[&Design],
) -> Agreement {
    let rows: HashMap<String, &FrontRow> = front.iter().map(|row| (row.key(study_json), row)).collect();
    assert_eq!(rows.len(), front.len(), "{what}: no design stands on a front twice");
    let mut agreement = Agreement::default();
    let mut matched = 0;
    for (design, place) in designs.iter().zip(places(designs)) {
        let key = design.key(study);
        match (place, rows.get(&key)) {
            (Place::On, None) => panic!("{what}: {key} is missing, {}", told(design)),
            (Place::Off, Some(_)) => panic!("{what}: {key} is dominated, {}", told(design)),
            (_, Some(row)) => {
                matched += 1;
                assert_same_design(row, design, &mut agreement);
            }
            _ => {}
        }
        agreement.on_the_front += usize::from(place == Place::On);
        agreement.close_calls += usize::from(place == Place::Close);
    }
    assert_eq!(matched, front.len(), "{what}: every design of the front is one of the study's");
    println!("  {what}: {} by the program, {} by all pairs", front.len(), exact_front_size(designs));
    agreement
}

fn told(design: &Design) -> String {
    let Design { tip_deflection_mm, mass_kg, lowest_mode_hz, .. } = design;
    format!("{tip_deflection_mm} mm, {mass_kg} kg, {lowest_mode_hz} Hz, {:?}", design.drives())
}

fn assert_same_design(row: &FrontRow, design: &Design, agreement: &mut Agreement) {
    for (joint, gear, motor) in design.drives() {
        let chosen = [row.text(&format!("{joint}_gear")), row.text(&format!("{joint}_motor"))];
        assert_eq!(chosen, [gear, motor], "drive of {joint} in {}", row.text("design_id"));
    }
    let mut compare = |column: &str, ours: f64, tolerance: f64| {
        let theirs = row.number(column);
        let off = (theirs / ours - 1.0).abs();
        assert!(off <= tolerance, "{column} of {}: {theirs}, brute force {ours}", row.text("design_id"));
        off
    };
    let mass = compare("mass_kg", design.mass_kg, MASS_TOLERANCE);
    let deflection = compare("tip_deflection_mm", design.tip_deflection_mm, DEFLECTION_TOLERANCE);
    let mode = compare("lowest_mode_hz", design.lowest_mode_hz, MODE_TOLERANCE);
    agreement.worst_mass = agreement.worst_mass.max(mass);
    agreement.worst_deflection = agreement.worst_deflection.max(deflection);
    agreement.worst_mode = agreement.worst_mode.max(mode);
}

#[test]
fn finds_the_same_fronts_of_a_six_axis_arm_in_three_materials() {
    let agreement = assert_same(&compare_materials());
    assert!(agreement.on_the_front > 10, "{agreement:?}");
}
