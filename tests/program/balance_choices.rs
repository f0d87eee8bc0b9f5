//! Studies that leave values of springs and counterweights open: `armwright run` searches every choice of these values.
//! Its front must be the front of all designs of all choices.

use crate::running::armwright;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::Path;

/// A small arm with a spring and a counterweight, whose force and mass are `force` and `mass`.
fn study(force: &Value, mass: &Value) -> String {
    json!({"name": "crane", "question": "Which spring?", "chain": [
        {"type": "joint", "name": "shoulder", "axis": [0, 1, 0], "drive": "first_fit", "drives": {"motors": ["electric"]}},
        {"type": "link", "name": "upper", "vector_m": [0.5, 0, 0], "choose": {"materials": ["Aluminium 6061-T6"],
          "sections": [{"shape": "rectangular_tube", "width_mm": [50, 60, 80], "height_mm": [60, 80, 100], "wall_mm": [2, 3]}]}},
        {"type": "joint", "name": "elbow", "axis": [0, 1, 0], "drive": "first_fit", "drives": {"motors": ["electric"]}},
        {"type": "link", "name": "fore", "vector_m": [0.4, 0, 0], "choose": {"materials": ["Aluminium 6061-T6"],
          "sections": [{"shape": "round_tube", "diameter_mm": [50, 60], "wall_mm": [2, 4]}]}}],
      "springs": [{"name": "gas spring", "from": {"at": "base", "point_m": [0, 0, -0.2]},
                   "to": {"at": "upper", "point_m": [0.2, 0, 0]}, "force_n": force}],
      "counterweights": [{"at": "upper", "point_m": [-0.2, 0, 0], "mass_kg": mass}],
      "payload": {"mass_kg": 8},
      "poses": [{"pose_deg": [0, 0]}, {"pose_deg": [-40, 90]},
                {"name": "empty", "pose_deg": [0, 0], "payload": {"mass_kg": 0}, "judged": false}]})
    .to_string()
}

const FORCES_N: [f64; 3] = [0.0, -300.0, -700.0];
const MASSES_KG: [f64; 2] = [0.0, 3.0];

/// Runs `armwright run study.json` with further words in `folder`, which gets the study `text`.
fn run(folder: &Path, text: &str, words: &[&str]) -> String {
    std::fs::write(folder.join("study.json"), text).expect("written");
    let (code, said) = armwright(folder, &[&["run", "study.json"], words].concat());
    assert_eq!(code, 0, "{said}");
    said
}

/// The rows of a front: the values of these columns, and deflection, mass and lowest mode.
fn rows(front: &Path, columns: &[&str]) -> Vec<(Vec<String>, [f64; 3])> {
    let mut table = csv::Reader::from_path(front).expect("a front");
    let header = table.headers().expect("a header").clone();
    let at = |name: &str| header.iter().position(|c| c == name).unwrap_or_else(|| panic!("no column {name}"));
    let objectives = ["tip_deflection_mm", "mass_kg", "lowest_mode_hz"].map(at);
    let columns: Vec<usize> = columns.iter().map(|name| at(name)).collect();
    let read = |row: csv::StringRecord| {
        let objectives = objectives.map(|c| row[c].parse().expect("a number"));
        (columns.iter().map(|c| row[*c].to_string()).collect(), objectives)
    };
    table.records().map(|row| read(row.expect("a row"))).collect()
}

/// Whether `a` is at least as good as `b` in all objectives and better in one, after rounding to nine digits.
fn dominates(a: &[f64; 3], b: &[f64; 3]) -> bool {
    let better = |a: f64, b: f64| a < b * (1.0 - 1e-9);
    let pairs = [(a[0], b[0]), (a[1], b[1]), (b[2], a[2])];
    !pairs.iter().any(|(a, b)| better(*b, *a)) && pairs.iter().any(|(a, b)| better(*a, *b))
}

/// The front of all choices, from a run of each with one value a number. Brute force joins them.
fn brute_front(here: &Path) -> BTreeSet<Vec<String>> {
    let mut all = Vec::new();
    for force in FORCES_N {
        for mass in MASSES_KG {
            let out = format!("one-{force}-{mass}");
            run(here, &study(&json!(force), &json!(mass)), &["--out", &out]);
            for (id, objectives) in rows(&here.join(&out).join("front.csv"), &["design_id"]) {
                all.push((vec![force.to_string(), mass.to_string(), id[0].clone()], objectives));
            }
        }
    }
    let is_best = |objectives: &[f64; 3]| !all.iter().any(|(_, other)| dominates(other, objectives));
    all.iter().filter(|(_, objectives)| is_best(objectives)).map(|(design, _)| design.clone()).collect()
}

#[test]
fn the_front_of_all_choices_is_the_best_of_every_one_by_both_searches() {
    let here = tempfile::tempdir().expect("a folder");
    let here = here.path();
    let expected = brute_front(here);
    let chosen: BTreeSet<&str> = expected.iter().map(|design| design[0].as_str()).collect();
    assert!(chosen.len() > 1, "the choice of the spring is none: {expected:?}");
    let text = study(&json!(FORCES_N), &json!(MASSES_KG));
    for search in ["exhaustive", "exact"] {
        let said = run(here, &text, &["--search", search, "--out", search]);
        assert!(said.contains("Each choice was searched whole"), "{said}");
        let columns = ["gas_spring_force_n", "counterweight_1_mass_kg", "design_id"];
        let found = rows(&here.join(search).join("front.csv"), &columns);
        let found: BTreeSet<Vec<String>> = found.into_iter().map(|(design, _)| design).collect();
        assert_eq!(found, expected, "{search}");
    }
    // the pages of the choices do not depend on the run
    run(here, &text, &["--search", "exact", "--threads", "1", "--out", "again"]);
    let (code, said) = armwright(here, &["check", "--same", "exact", "again"]);
    assert_eq!(code, 0, "{said}");
}

#[test]
fn a_design_of_a_choice_has_the_numbers_of_the_joint_front() {
    let here = tempfile::tempdir().expect("a folder");
    run(here.path(), &study(&json!(FORCES_N), &json!(2)), &["--out", "out"]);
    let summary = std::fs::read_to_string(here.path().join("out/summary.md")).expect("a summary");
    let line = summary.lines().find(|line| line.starts_with("- lightest")).expect("a lightest design");
    let command = line.split('`').nth(1).expect("a command").strip_prefix("armwright ").expect("a verb");
    let words: Vec<&str> = command.split(' ').collect();
    let (code, said) = armwright(&here.path().join("out"), &words);
    assert_eq!(code, 0, "{said}");
    let kg = said.split("mass ").nth(1).and_then(|rest| rest.split(' ').next()).expect("a mass");
    let kg: f64 = kg.parse().expect("a number");
    let least = rows(&here.path().join("out/front.csv"), &["choice"]);
    let least = least.iter().map(|(_, objectives)| objectives[1]).fold(f64::INFINITY, f64::min);
    assert!((kg - least).abs() < 6e-4, "{kg} kg is not {least} kg");
}

/// The lines that announce a choice.
fn announced(said: &str) -> usize {
    said.lines().filter(|line| line.starts_with("choice ") && line.contains(" of ")).count()
}

#[test]
fn a_run_of_choices_that_failed_goes_on_with_the_choices_that_are_left() {
    let here = tempfile::tempdir().expect("a folder");
    let here = here.path();
    let text = study(&json!(FORCES_N), &json!(2));
    run(here, &text, &["--out", "whole"]);
    let choices: Value =
        serde_json::from_slice(&std::fs::read(here.join("whole/choices.json")).expect("a file"))
            .expect("JSON");
    let second = choices["choices"][1]["folder"].as_str().expect("a folder");
    // a file of the user's stands in the way of the second choice
    let foreign = here.join("out").join(second).join("front.csv");
    std::fs::create_dir_all(foreign.parent().expect("a folder")).expect("made");
    std::fs::write(&foreign, "mine").expect("written");
    let (code, said) = armwright(here, &["run", "study.json", "--out", "out"]);
    assert!(code == 2 && announced(&said) == 2, "{said}");
    assert!(!here.join("out/front.csv").exists());
    std::fs::remove_file(&foreign).expect("removed");
    // another study is not mixed with the choices that are done
    std::fs::write(here.join("other.json"), study(&json!(FORCES_N), &json!(1))).expect("written");
    let (code, said) = armwright(here, &["run", "other.json", "--out", "out"]);
    assert!(code == 2 && said.contains("--fresh"), "{said}");
    let said = run(here, &text, &["--out", "out"]);
    assert_eq!(announced(&said), 2, "the first choice was searched again: {said}");
    let (code, said) = armwright(here, &["check", "--same", "whole", "out"]);
    assert_eq!(code, 0, "{said}");
}

#[test]
fn choices_without_a_design_are_said_and_a_study_without_any_is_infeasible() {
    let here = tempfile::tempdir().expect("a folder");
    // the hard spring overloads every drive of the empty arm
    run(here.path(), &study(&json!([0, -40_000_000]), &json!(2)), &["--out", "out"]);
    let choices: Value =
        serde_json::from_slice(&std::fs::read(here.path().join("out/choices.json")).expect("a file"))
            .expect("JSON");
    let ended: Vec<&str> = choices["choices"]
        .as_array()
        .expect("a list")
        .iter()
        .filter_map(|of| of["status"].as_str())
        .collect();
    assert_eq!(ended, ["complete", "infeasible"]);
    std::fs::write(here.path().join("none.json"), study(&json!([-40_000_000, -50_000_000]), &json!(2)))
        .expect("written");
    let (code, said) = armwright(here.path(), &["run", "none.json", "--out", "none"]);
    assert!(code == 6 && said.contains("no choice"), "{said}");
}

#[test]
fn choices_in_which_the_time_ended_before_a_design_was_found_are_not_said_to_have_none() {
    let here = tempfile::tempdir().expect("a folder");
    std::fs::write(here.path().join("study.json"), study(&json!(FORCES_N), &json!(2))).expect("written");
    let words = ["run", "study.json", "--time-limit", "0.000000001", "--out", "out"];
    let (code, said) = armwright(here.path(), &words);
    assert!(code == 10 && said.contains("in its share of the time"), "{code} {said}");
}

#[test]
fn verbs_that_take_one_arm_refuse_open_choices_and_faulty_lists_are_named() {
    let here = tempfile::tempdir().expect("a folder");
    let here = here.path();
    let text = study(&json!(FORCES_N), &json!(2));
    // a picture of the user's is not replaced, and the program says so
    std::fs::create_dir_all(here.join("out/plots")).expect("made");
    std::fs::write(here.join("out/plots/fronts.svg"), "mine").expect("written");
    let said = run(here, &text, &["--out", "out"]);
    assert!(said.contains("not written: plots/fronts.svg"), "{said}");
    let (code, said) = armwright(here, &["check", "out"]);
    assert!(code == 9 && said.contains("not written: plots/fronts.svg"), "{code} {said}");
    let refused = |words: &[&str], part: &str| {
        let (code, said) = armwright(here, words);
        assert!(code != 0 && said.contains(part), "{words:?}: {code} {said}");
    };
    for verb in ["size", "capacity"] {
        refused(&[verb, "study.json"], "3 choices of springs");
    }
    refused(&["run", "study.json", "--shard", "1/2"], "3 choices of springs");
    refused(&["run", "study.json", "--progress", "p.jsonl"], "--progress does not go");
    refused(&["compare", "out"], "out/choice-*");
    refused(&["front", "check", "out"], "out/choice-*");
    for (force, part) in [
        (json!([]), "is an empty list"),
        (json!([-100, "hard"]), "not a number"),
        (json!((0..300).collect::<Vec<i32>>()), "has 300 choices"),
    ] {
        std::fs::write(here.join("study.json"), study(&force, &json!(2))).expect("written");
        let (code, said) = armwright(here, &["run", "study.json", "--out", "faulty"]);
        assert!(code == 3 && said.contains(part), "{said}");
    }
    let arm = json!({"chain": [{"type": "joint", "name": "j", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e4},
                              {"type": "link", "name": "l", "vector_m": [0.5, 0, 0], "mass_kg": 1}],
                     "counterweights": [{"at": "l", "point_m": [-0.2, 0, 0], "mass_kg": [1, 2]}]});
    std::fs::write(here.join("arm.json"), arm.to_string()).expect("written");
    refused(&["analyze", "arm.json"], "not a number");
}

#[test]
fn the_effects_of_a_measured_arm_count_once_in_every_choice() {
    let here = tempfile::tempdir().expect("a folder");
    let here = here.path();
    let soft = json!({"effect": "connection_compliance", "at": "shoulder", "parameters": {"stiffness_nm_per_rad": 20_000}});
    let arm = json!({"chain": [{"type": "joint", "name": "shoulder", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e5},
                              {"type": "link", "name": "upper", "vector_m": [0.5, 0, 0], "mass_kg": 1}],
                     "effects": [soft]});
    std::fs::write(here.join("arm.json"), arm.to_string()).expect("written");
    run(here, &study(&json!(0), &json!(2)), &["--effects", "arm.json", "--out", "one"]);
    let said = run(here, &study(&json!([0, -300]), &json!(2)), &["--effects", "arm.json", "--out", "two"]);
    assert!(said.contains("connection_compliance at shoulder"), "{said}");
    assert!(said.contains("Left out of every number"), "{said}");
    let choices: Value =
        serde_json::from_slice(&std::fs::read(here.join("two/choices.json")).expect("a file")).expect("JSON");
    let first = choices["choices"][0]["folder"].as_str().expect("a folder");
    let of = |front: &Path| rows(front, &["design_id"]);
    assert_eq!(of(&here.join("two").join(first).join("front.csv")), of(&here.join("one/front.csv")));
}
