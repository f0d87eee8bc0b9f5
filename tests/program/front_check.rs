//! `armwright front check` on results of both searches: a sound front passes. A front with a changed cell, a dropped
//! row or an added row is rejected.

use armwright::arm::read_arm_document;
use armwright::catalog::Catalogs;
use armwright::input::Document;
use serde_json::Value;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

pub const STUDY: &str = r#"{"name": "short-arm", "chain": [
  {"type": "joint", "name": "shoulder", "axis": [0, 1, 0], "drive": "first_fit", "drives": {"motors": ["electric"]}},
  {"type": "link", "name": "upper", "vector_m": [0.5, 0, 0], "choose": {
    "materials": ["Structural steel S355", "Aluminium 6061-T6"],
    "sections": [{"shape": "rectangular_tube", "width_mm": [50, 60, 80], "height_mm": [60, 80, 100], "wall_mm": [2, 3, 5]}]}},
  {"type": "joint", "name": "elbow", "axis": [0, 1, 0], "drive": "first_fit", "drives": {"motors": ["electric"]}},
  {"type": "link", "name": "fore", "vector_m": [0.4, 0, 0], "choose": {
    "materials": ["Aluminium 6061-T6"],
    "sections": [{"shape": "round_tube", "diameter_mm": [50, 60, 80], "wall_mm": [2, 4]}]}}],
  "payload": {"mass_kg": 3}, "poses": [{"pose_deg": [0, 0]}, {"pose_deg": [-40, 90]}]}"#;

fn armwright(words: &[&str]) -> (i32, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_armwright")).args(words).output().expect("runs");
    let text = [output.stdout, output.stderr].concat();
    (output.status.code().unwrap_or(-1), String::from_utf8_lossy(&text).into_owned())
}

/// A result of the small study.
fn result(search: &str) -> TempDir {
    let dir = tempfile::tempdir().expect("a folder");
    let study = dir.path().join("study.json");
    std::fs::write(&study, STUDY).expect("written");
    let (code, text) = armwright(&["run", path(&study), "--search", search, "--out", path(dir.path())]);
    assert_eq!(code, 0, "{text}");
    dir
}

fn path(path: &Path) -> &str {
    path.to_str().expect("a name")
}

/// Exit code and what was said, wherever lines end.
fn check(dir: &TempDir) -> (i32, String) {
    let (code, text) = armwright(&["front", "check", path(dir.path())]);
    (code, text.split_whitespace().collect::<Vec<_>>().join(" "))
}

fn front(dir: &TempDir) -> Vec<String> {
    let text = std::fs::read_to_string(dir.path().join("front.csv")).expect("a front");
    text.lines().map(String::from).collect()
}

/// Writes a front and makes run.json agree with its number of rows.
fn replace(dir: &TempDir, lines: &[String]) {
    std::fs::write(dir.path().join("front.csv"), lines.join("\n") + "\n").expect("written");
    let file = dir.path().join("run.json");
    let mut run: Value = serde_json::from_str(&std::fs::read_to_string(&file).expect("a run")).expect("JSON");
    run["front_size"] = (lines.len() - 1).into();
    let bytes = std::fs::read(dir.path().join("front.csv")).expect("a front");
    run["files"]["front.csv"] = blake3::hash(&bytes).to_hex().to_string().into();
    // without a hash of itself, as in early versions
    run.as_object_mut().expect("keys").remove("manifest_hash");
    std::fs::write(&file, run.to_string()).expect("written");
}

#[test]
fn both_searches_write_the_same_front_and_it_passes() {
    let (visited, exact) = (result("exhaustive"), result("exact"));
    assert_eq!(front(&visited), front(&exact));
    for (dir, status) in [(&visited, "complete"), (&exact, "certified")] {
        let run = std::fs::read_to_string(dir.path().join("run.json")).expect("a run");
        let run: Value = serde_json::from_str(&run).expect("JSON");
        assert_eq!(run["status"], status);
        let (code, text) = check(dir);
        assert_eq!(code, 0, "{text}");
        assert!(text.contains("no design is missing"), "{text}");
    }
}

#[test]
fn a_design_of_an_exact_front_can_be_taken_out_and_analysed() {
    let dir = result("exact");
    let lines = front(&dir);
    let id = lines[1].split(',').next().expect("an id");
    let (code, text) = armwright(&["design", path(dir.path()), id]);
    assert_eq!(code, 0, "{text}");
}

#[test]
fn a_result_of_an_earlier_version_is_neither_checked_nor_taken_apart() {
    let dir = result("exhaustive");
    let id = front(&dir)[1].split(',').next().expect("an id").to_string();
    let file = dir.path().join("run.json");
    let mut run: Value = serde_json::from_str(&std::fs::read_to_string(&file).expect("a run")).expect("JSON");
    run["tool_version"] = "0.1.0".into();
    std::fs::write(&file, run.to_string()).expect("written");
    for words in [vec!["front", "check", path(dir.path())], vec!["design", path(dir.path()), &id]] {
        let (code, text) = armwright(&words);
        assert_eq!(code, 3, "{text}");
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(text.contains("made by version 0.1.0, before output bearings were modelled"), "{text}");
        assert!(text.contains("run the study again"), "{text}");
    }
}

#[test]
fn a_design_is_written_with_the_bearing_of_its_gear_resolved_and_reads_back_the_same() {
    let dir = result("exhaustive");
    let id = front(&dir)[1].split(',').next().expect("an id").to_string();
    let out = dir.path().join("design");
    let (code, text) = armwright(&["design", path(dir.path()), &id, "--out", path(&out)]);
    assert_eq!(code, 0, "{text}");
    let text = std::fs::read_to_string(out.join("arm.json")).expect("an arm");
    let arm: Value = serde_json::from_str(&text).expect("JSON");
    let catalogs = Catalogs::builtin();
    for (joint, link) in [(0, 1), (2, 3)] {
        let (joint, link) = (&arm["chain"][joint], &arm["chain"][link]);
        let gear = catalogs.gear(joint["gear"].as_str().expect("a gear")).expect("in the catalog");
        let bearing = &joint["bearing"];
        let close = |key: &str, expected: Option<f64>| {
            let found = bearing[key].as_f64();
            let same =
                found.zip(expected).map_or(found == expected, |(a, b)| (a - b).abs() < 1e-12 * b.abs());
            assert!(same, "{key}: {found:?}, not {expected:?}");
        };
        close("tilt_stiffness_nm_per_rad", gear.tilting_stiffness_nm_per_rad);
        close("permissible_moment_nm", gear.permissible_tilting_moment_nm);
        close("pitch_diameter_m", gear.bearing.pitch_diameter_m);
        close("static_load_rating_n", gear.bearing.static_load_rating_n);
        close("dynamic_load_rating_n", gear.bearing.dynamic_load_rating_n);
        // the joints turn about y, across which links along x are as wide as their section
        let section = &link["section"];
        let width_m = section["width_m"].as_f64().or(section["diameter_m"].as_f64()).expect("a width");
        close("offset_m", Some(gear.bearing.offset_m.unwrap_or(0.0) + width_m / 2.0));
    }
    let read =
        read_arm_document(Document::parse("arm.json", &text).expect("JSON"), &catalogs).expect("sound");
    assert_eq!(read.to_json(), arm, "written and read");
}

#[test]
fn a_dropped_design_is_found_to_be_missing() {
    let dir = result("exhaustive");
    let mut lines = front(&dir);
    let dropped = lines.remove(lines.len() / 2);
    replace(&dir, &lines);
    let (code, text) = check(&dir);
    let id = dropped.split(',').next().expect("an id");
    assert_eq!(code, 9, "{text}");
    assert!(text.contains(&format!("design {id} belongs on the front")), "{text}");
}

#[test]
fn the_gap_that_a_stopped_run_claims_is_checked() {
    let dir = result("exact");
    let mut lines = front(&dir);
    let columns: Vec<&str> = lines[0].split(',').collect();
    let places = ["mass_kg", "tip_deflection_mm", "lowest_mode_hz"]
        .map(|name| columns.iter().position(|c| *c == name).expect("an objective"));
    let numbers = |line: &str| -> [f64; 3] {
        let cells: Vec<&str> = line.split(',').collect();
        places.map(|place| cells[place].parse().expect("a number"))
    };
    // how much better than a row the dropped one is, in the objective in which it is least so
    let dropped = lines.remove(lines.len() / 2);
    let [kg, mm, hz] = numbers(&dropped);
    let beyond = |line: &String| {
        let row = numbers(line);
        (row[0] / kg).max(row[1] / mm).max(hz / row[2]) - 1.0
    };
    let gap = lines[1..].iter().map(beyond).fold(f64::INFINITY, f64::min);
    assert!(gap > 1e-4, "rows are too close to each other: {gap}");
    replace(&dir, &lines);
    let id = dropped.split(',').next().expect("an id");
    for (claimed, code) in [(1.01 * gap, 0), (0.99 * gap, 9)] {
        let file = dir.path().join("run.json");
        let mut run: Value =
            serde_json::from_str(&std::fs::read_to_string(&file).expect("a run")).expect("JSON");
        run["status"] = "partial".into();
        run["gap"] = claimed.into();
        std::fs::write(&file, run.to_string()).expect("written");
        let (told, text) = check(&dir);
        assert_eq!(told, code, "{text}");
        // the line may break anywhere
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        match code {
            0 => assert!(text.contains("for every design of the study some listed one is at most"), "{text}"),
            _ => assert!(
                text.contains(&format!("design {id} is not there, and no row comes within")),
                "{text}"
            ),
        }
    }
}

#[test]
fn a_changed_cell_and_a_row_that_others_beat_are_found() {
    let dir = result("exact");
    let sound = front(&dir);
    let column = sound[0].split(',').position(|c| c == "mass_kg").expect("a mass");
    let mut lines = sound.clone();
    let mut cells: Vec<&str> = sound[1].split(',').collect();
    cells[column] = "1.5";
    lines[1] = cells.join(",");
    replace(&dir, &lines);
    let (code, text) = check(&dir);
    assert_eq!(code, 9, "{text}");
    assert!(text.contains("mass_kg is 1.5, the model gives"), "{text}");

    // a design that is not on the front: the first id that the front does not list
    let ids: Vec<&str> = sound[1..].iter().map(|l| l.split(',').next().expect("an id")).collect();
    let strange =
        ["0", "1", "2", "3", "4", "5", "6", "7"].into_iter().find(|id| !ids.contains(id)).expect("one");
    let mut lines = sound.clone();
    lines.push(lines[1].replacen(ids[0], strange, 1));
    replace(&dir, &lines);
    let (code, text) = check(&dir);
    assert_eq!(code, 9, "{text}");
    assert!(text.contains(&format!("design {strange}: does not hold, or another row beats it")), "{text}");
}
