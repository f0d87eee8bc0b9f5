//! Poses other than the cases of a study: ranges of joints, the worst poses within them, and warnings for large
//! deflections.

use serde_json::{Value, json};
use std::path::Path;
use std::process::Command;

/// A vertical joint and a boom of one of two tubes, judged where the boom points 60 degrees up.
fn study(stiffness_nm_per_rad: f64, range_deg: Value) -> Value {
    let mut study = json!({
        "name": "boom", "question": "Which tube?",
        "chain": [
            {"type": "joint", "name": "j1", "axis": [0, 0, 1], "stiffness_nm_per_rad": 1e5, "mass_kg": 4},
            {"type": "link", "name": "column", "vector_m": [0, 0, 0.4]},
            {"type": "joint", "name": "j2", "axis": [0, 1, 0], "stiffness_nm_per_rad": stiffness_nm_per_rad,
             "mass_kg": 4},
            {"type": "link", "name": "boom", "vector_m": [1, 0, 0], "choose": {"materials": ["Aluminium 6061-T6"],
                "sections": [{"shape": "rectangular_tube", "width_mm": [60, 80], "height_mm": "=width", "wall_mm": [3]}]}}],
        "payload": {"mass_kg": 5}, "poses": [{"name": "up", "pose_deg": [0, -60]}], "models": {"links": "rigid"},
    });
    if !range_deg.is_null() {
        study["chain"][2]["range_deg"] = range_deg;
    }
    study
}

/// Exit code, and all that is printed, with single spaces.
fn run(here: &Path, study: &Value) -> (i32, String) {
    std::fs::write(here.join("boom.json"), study.to_string()).expect("written");
    let mut command = Command::new(env!("CARGO_BIN_EXE_armwright"));
    let output =
        command.current_dir(here).args(["run", "boom.json", "--out", "out"]).output().expect("it runs");
    let text =
        [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
    (output.status.code().unwrap_or(-1), text.split_whitespace().collect::<Vec<_>>().join(" "))
}

fn read(here: &Path, name: &str) -> String {
    std::fs::read_to_string(here.join("out").join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn a_pick_that_is_worse_in_another_pose_is_named_with_the_pose_everywhere() {
    let here = tempfile::tempdir().expect("a folder");
    let (code, said) = run(here.path(), &study(1e5, json!([-80, 40])));
    assert_eq!(code, 0, "{said}");
    let run: Value = serde_json::from_str(&read(here.path(), "run.json")).expect("JSON");
    let pick = &run["worst_poses"]["picks"][0];
    let deflection = &pick["tip_deflection"];
    assert_eq!((&deflection["pose_deg"], &deflection["load_of_case"]), (&json!([0.0, 0.0]), &json!("up")));
    // the boom's lever is half as long where it points 60 degrees up
    assert!((number(&deflection["worst_mm"]) / number(&deflection["judged_mm"]) - 2.0).abs() < 1e-9, "{run}");
    assert!((number(&deflection["worse_percent"]) - 100.0).abs() < 1e-6 && number(&pick["reach_m"]) == 1.0);
    assert_eq!(pick["small_displacements"], true);
    assert_eq!(
        run["worst_poses"]["ranges"][1],
        json!({"joint": "j2", "low_deg": -80.0, "high_deg": 40.0, "stated": true})
    );
    let spaced = |text: String| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let (summary, page) = (spaced(read(here.path(), "summary.md")), spaced(read(here.path(), "report.html")));
    for text in [&said, &summary, &page] {
        assert!(text.contains("in pose (0, 0) deg, 100.0 % more than the"), "{text}");
        assert!(text.contains("j1: range not stated: +-180 deg; j2: -80 to 40 deg"), "{text}");
        assert!(text.contains("passes through itself, its base or the floor"), "{text}");
        assert!(!text.contains("small displacements only"), "{text}");
    }
}

#[test]
fn a_range_without_a_worse_pose_says_so() {
    let here = tempfile::tempdir().expect("a folder");
    let (code, said) = run(here.path(), &study(1e5, json!([-80, -59.5])));
    assert!(code == 0 && said.contains("No pose within the ranges of the joints"), "{code}: {said}");
    assert!(!said.contains("in pose ("), "{said}");
}

#[test]
fn a_pick_that_deflects_by_more_than_a_twentieth_of_its_reach_carries_a_warning() {
    let here = tempfile::tempdir().expect("a folder");
    let (code, said) = run(here.path(), &study(350.0, Value::Null));
    assert_eq!(code, 0, "{said}");
    let words =
        "more than 5 % of the arm's reach of 1.000 m; the model is valid for small displacements only";
    assert!(said.contains(words) && read(here.path(), "summary.md").contains(words), "{said}");
    assert!(read(here.path(), "report.html").contains("the model is valid for small displacements only"));
    let run: Value = serde_json::from_str(&read(here.path(), "run.json")).expect("JSON");
    let pick = &run["worst_poses"]["picks"][0];
    let judged_mm = number(&pick["tip_deflection"]["judged_mm"]);
    assert!(judged_mm > 50.0 && pick["small_displacements"] == false, "{pick}");
}

#[test]
fn a_range_that_is_none_and_a_pose_beyond_a_range_are_faults_with_names() {
    let here = tempfile::tempdir().expect("a folder");
    let (code, said) = run(here.path(), &study(1e5, json!([40, -80])));
    assert!(code == 3 && said.contains("[40, -80] is no range"), "{code}: {said}");
    let (code, said) = run(here.path(), &study(1e5, json!([10, 10])));
    assert!(code == 3 && said.contains("[10, 10] is no range"), "{code}: {said}");
    let mut other = study(1e5, json!([-80, 40]));
    // a pose for sizing alone counts too
    other["poses"]
        .as_array_mut()
        .expect("poses")
        .push(json!({"name": "back", "pose_deg": [0, 90], "judged": false}));
    let (code, said) = run(here.path(), &other);
    let words = "turns j2 to 90 deg in pose \"back\", beyond its range_deg of -80 to 40";
    assert!(code == 3 && said.contains("poses[1].pose_deg") && said.contains(words), "{code}: {said}");
}
