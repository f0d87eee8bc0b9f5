//! Arms and studies with prismatic joints on the command line.

use serde_json::{Value, json};
use std::fs;
use std::process::{Command, Output};

fn run(folder: &std::path::Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_armwright")).current_dir(folder).args(words).output().expect("it starts")
}

fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A rail along y, and a boom of a metre with 10 kg at its end.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let arm = json!({"name": "boom", "chain": [
        {"type": "prismatic", "name": "rail", "axis": [0, 1, 0], "stiffness_n_per_m": 1e7, "mass_kg": 20,
         "guide": {"roll_nm_per_rad": 1e5}},
        {"type": "joint", "name": "j2", "axis": [0, 1, 0], "stiffness_nm_per_rad": 2e5},
        {"type": "link", "name": "boom", "vector_m": [1, 0, 0]}]});
    fs::write(folder.path().join("arm.json"), arm.to_string()).expect("written");
    folder
}

#[test]
fn analyze_prints_what_drive_and_guide_hold() {
    let folder = folder();
    let words = [
        "analyze",
        "arm.json",
        "--pose",
        "rail_mm=250,j2_deg=-30",
        "--payload-kg",
        "10",
        "--force-n",
        "0,50,0",
    ];
    let output = run(folder.path(), &[&words[..], &["--json"]].concat());
    assert!(output.status.success(), "{}", errors(&output));
    let out: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(out["joint_force_n"], json!({"rail": 50.0}));
    assert_eq!(out["joint_torque_nm"].as_object().expect("torques").len(), 1);
    let close = |value: &Value, expected: f64| (value.as_f64().expect("a number") - expected).abs() < 1e-9;
    // the rail travels along y: the weight at 0.866 m turns it about y, which is its roll
    let lever_m = 30f64.to_radians().cos();
    assert!(close(&out["guide_moment_nm"]["rail"][0], 98.1 * lever_m), "{out}");
    // the guide carries the carriage of 20 kg too
    assert!(close(&out["guide_force_n"]["rail"][1], -294.3), "{out}");
    let names: Vec<&str> =
        out["shares"].as_array().expect("shares").iter().filter_map(|s| s["element"].as_str()).collect();
    assert_eq!(names, ["rail.guide", "rail", "j2"]);
    let text = run(folder.path(), &words);
    let text = String::from_utf8_lossy(&text.stdout).into_owned();
    for line in ["pose rail 250 mm, j2 -30 deg", "50.000 N", "guide          force across N"] {
        assert!(text.contains(line), "{line}: {text}");
    }
}

#[test]
fn a_pose_that_does_not_fit_says_what_to_write() {
    let folder = folder();
    for (flags, says) in [
        (["--pose-deg", "250,30"], "write --pose rail_mm=0,j2_deg=0 with your numbers"),
        (["--pose", "rail_deg=250"], "rail slides: write rail_mm"),
        (["--pose", "rail"], "no entry such as j2_deg=30 or rail_mm=250"),
    ] {
        let output = run(folder.path(), &["analyze", "arm.json", flags[0], flags[1]]);
        assert_eq!(output.status.code(), Some(2), "{flags:?}");
        assert!(errors(&output).contains(says), "{flags:?}: {}", errors(&output));
    }
}

/// The front of a study with a rail, designed and analysed once more, has the figures of the front.
#[test]
fn a_study_with_a_rail_runs_designs_and_analyses() {
    let folder = folder();
    let study = json!({"name": "rail", "chain": [
        {"type": "prismatic", "name": "rail", "axis": [0, 1, 0], "stiffness_n_per_m": 1e7, "mass_kg": 20, "fixed_mass_kg": 4,
         "guide": {"roll_nm_per_rad": 1e5, "pitch_nm_per_rad": 2e5}, "range_mm": [0, 800]},
        {"type": "joint", "name": "j2", "axis": [0, 1, 0], "stiffness_nm_per_rad": 2e5, "mass_kg": 5},
        {"type": "link", "name": "boom", "vector_m": [0.8, 0, 0], "choose": {"materials": ["Aluminium 6061-T6"],
         "sections": [{"shape": "round_tube", "diameter_mm": [60, 80, 100], "wall_mm": [2, 4]}]}}],
        "payload": {"mass_kg": 5}, "poses": [{"pose": {"rail_mm": 250}}, {"pose": {"rail_mm": 700, "j2_deg": -40}}]});
    fs::write(folder.path().join("study.json"), study.to_string()).expect("written");
    for search in ["exhaustive", "exact"] {
        let output = run(folder.path(), &["run", "study.json", "--search", search, "--out", search]);
        assert!(output.status.success(), "{}", errors(&output));
    }
    let front =
        |search: &str| fs::read_to_string(folder.path().join(search).join("front.csv")).expect("a front");
    assert_eq!(front("exhaustive"), front("exact"));
    let check = run(folder.path(), &["front", "check", "exact"]);
    assert!(check.status.success(), "{}", errors(&check));
    let table = front("exact");
    let mut rows = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = rows.next().expect("a header");
    let row = rows.next().expect("a design");
    let cell = |name: &str| row[header.iter().position(|h| *h == name).expect(name)];
    let output = run(folder.path(), &["design", "exact", cell("design_id"), "--out", "d"]);
    assert!(output.status.success(), "{}", errors(&output));
    let output = run(folder.path(), &["analyze", "d/arm.json", "--cases", "d/cases.json", "--json"]);
    assert!(output.status.success(), "{}", errors(&output));
    let cases: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let norm = |case: &Value| {
        let parts = case["tip_displacement_m"].as_array().expect("a vector");
        parts.iter().map(|x| x.as_f64().expect("a number").powi(2)).sum::<f64>().sqrt()
    };
    let worst_mm = cases.as_array().expect("cases").iter().map(norm).fold(0.0, f64::max) * 1e3;
    let listed: f64 = cell("tip_deflection_mm").parse().expect("a number");
    assert!((worst_mm / listed - 1.0).abs() < 1e-12, "{worst_mm} {listed}");
    let run_json: Value =
        serde_json::from_str(&fs::read_to_string(folder.path().join("exact/run.json")).expect("a run"))
            .expect("JSON");
    assert_eq!(
        run_json["worst_poses"]["ranges"][0],
        json!({"joint": "rail", "low_mm": 0.0, "high_mm": 800.0, "stated": true})
    );
    assert!(run_json["worst_poses"]["picks"][0]["tip_deflection"]["pose"]["rail_mm"].is_number());
    assert!(
        fs::read_to_string(folder.path().join("exact/report.html")).expect("a page").contains("rail 250 mm")
    );
}

/// 10 kg half a metre above a rail that stops from 1 m/s with 8 m/s², with 2 kg on the carriage.
#[test]
fn a_study_says_what_its_guides_bear_at_rest_and_in_a_stop() {
    let folder = folder();
    let study = json!({"name": "mast", "chain": [
        {"type": "prismatic", "name": "rail", "axis": [1, 0, 0], "stiffness_n_per_m": 1e7, "mass_kg": 2,
         "guide": {"max_force_n": 500, "max_pitch_nm": 40}},
        {"type": "link", "name": "foot", "vector_m": [0, 0, 0.3], "mass_kg": 0},
        {"type": "link", "name": "mast", "vector_m": [0, 0, 0.2], "choose": {"materials": ["Aluminium 6061-T6"],
         "sections": [{"shape": "round_tube", "diameter_mm": [60], "wall_mm": [2, 4]}]}}],
        "motion": {"tip_speed_m_s": 1, "ramp_time_s": 0.25},
        "payload": {"mass_kg": 10}, "poses": [{"pose": {"rail_mm": 0}}]});
    fs::write(folder.path().join("study.json"), study.to_string()).expect("written");
    let output = run(folder.path(), &["run", "study.json", "--out", "out"]);
    assert!(output.status.success(), "{}", errors(&output));
    let text = fs::read_to_string(folder.path().join("out/run.json")).expect("a run");
    let written: Value = serde_json::from_str(&text).expect("JSON");
    let remarks = written["remarks"].as_array().expect("remarks");
    let said = |head: &str| {
        remarks.iter().filter_map(Value::as_str).find(|s| s.starts_with(head)).expect("a remark")
    };
    let front = fs::read_to_string(folder.path().join("out/front.csv")).expect("a front");
    let mut rows = front.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let at = rows.next().expect("a header").iter().position(|h| *h == "mass_kg").expect("a mass");
    // the arm's mass is that of the carriage and of the tube, whose centre is at 0.4 m
    let tube_kg = rows.map(|row| row[at].parse::<f64>().expect("a number") - 2.0).fold(0.0, f64::max);
    let (weight_n, moment_nm) = (9.81 * (12.0 + tube_kg), 8.0 * (10.0 * 0.5 + tube_kg * 0.4));
    let used = [weight_n / 500.0, weight_n / 500.0 + moment_nm / 40.0];
    let bear = said("Guides bear");
    let numbers: Vec<f64> = bear.split([' ', '(']).filter_map(|word| word.parse().ok()).collect();
    let expected = [weight_n, 0.0, 100.0 * used[0], weight_n, moment_nm, used[1]];
    for (number, expected) in numbers.iter().zip(expected) {
        // the percentage is printed as a whole number, the others with three digits
        assert!((number - expected).abs() <= 0.02 * expected, "{number} {expected}: {bear}");
    }
    assert!(
        numbers.len() == 6 && bear.ends_with("times what it holds) in an emergency stop of its own travel."),
        "{bear}"
    );
    assert!(said("Whether guides hold").contains("rail has no max_roll_nm, max_yaw_nm in its guide"));
    // water bears a part of the weight, and the whole mass is braked
    let mut sunk = study;
    sunk["environments"] = json!([{"name": "sea", "water": {"density_kg_m3": 1000}}]);
    fs::write(folder.path().join("sunk.json"), sunk.to_string()).expect("written");
    let output = run(folder.path(), &["run", "sunk.json", "--out", "sunk"]);
    assert!(output.status.success(), "{}", errors(&output));
    let text = fs::read_to_string(folder.path().join("sunk/run.json")).expect("a run");
    let moment = |said: &str| {
        let (_, stop) = said.split_once("at rest, ").expect("a stop");
        stop.split(' ').nth(3).and_then(|word| word.parse::<f64>().ok()).expect("a moment")
    };
    let (_, in_water) = text.split_once("Guides bear").expect("a remark");
    assert!((moment(in_water) - moment(bear)).abs() < 0.02 * moment(bear), "{in_water}");
}

#[test]
fn a_study_says_how_a_rail_is_sized() {
    let folder = folder();
    let study = json!({"name": "rail", "chain": [
        {"type": "prismatic", "name": "rail", "axis": [0, 1, 0], "stiffness_n_per_m": 1e7, "drive": "all_fits", "range_mm": [0, 100]},
        {"type": "link", "name": "boom", "vector_m": [0.8, 0, 0]}],
        "payload": {"mass_kg": 5}, "poses": [{"pose": {"rail_mm": 250}}, {"pose_deg": [250]}]});
    fs::write(folder.path().join("study.json"), study.to_string()).expect("written");
    let output = run(folder.path(), &["size", "study.json"]);
    assert_eq!(output.status.code(), Some(3));
    for says in [
        "write first_fit: the lightest pair of a screw or rack",
        "stiffness_n_per_m: stands beside \"drive\"",
        "write \"pose\": {\"rail_mm\": 0} instead",
    ] {
        assert!(errors(&output).contains(says), "{says}: {}", errors(&output));
    }
}
