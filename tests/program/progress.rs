//! The progress that a run reports while it searches (`--progress`), and what it proves of a part of the front
//! (`--mass-max-kg`).

use crate::front_check::STUDY;
use crate::running::armwright;
use serde_json::{Value, json};
use std::path::Path;

/// Exit code and everything that was said.
fn json_of(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).expect("a file")).expect("JSON")
}

/// The lines of a progress record.
fn record(path: &Path) -> Vec<Value> {
    let text = std::fs::read_to_string(path).expect("a record");
    text.lines().map(|line| serde_json::from_str(line).expect("a JSON object a line")).collect()
}

/// Mass and the whole row of each design of a front.
fn rows(path: &Path) -> Vec<(f64, String)> {
    let text = std::fs::read_to_string(path).expect("a front");
    let mut lines = text.lines();
    let column = lines.next().and_then(|head| head.split(',').position(|name| name == "mass_kg"));
    let mass = |line: &str| line.split(',').nth(column.expect("a column")).and_then(|word| word.parse().ok());
    lines.map(|line| (mass(line).expect("a mass"), line.to_string())).collect()
}

#[test]
fn a_progress_record_has_the_keys_of_its_contract_and_its_gap_never_rises() {
    let here = tempfile::tempdir().expect("a folder");
    // a study of more designs than can be visited
    let words = ["run", "full-catalog", "--time-limit", "12", "--progress", "seen.jsonl", "--out", "out"];
    let (code, said) = armwright(here.path(), &words);
    assert!(code == 0 || code == 10, "{said}");
    let (lines, run) = (record(&here.path().join("seen.jsonl")), json_of(&here.path().join("out/run.json")));
    assert!(lines.len() > 4, "a line every second: {lines:?}");
    for line in &lines {
        let keys: Vec<&String> = line.as_object().expect("an object").keys().collect();
        assert_eq!(keys, ["elapsed_s", "designs", "gap", "front_size", "boxes_open"]);
    }
    let all = |key: &str| lines.iter().filter_map(|line| line[key].as_f64()).collect::<Vec<f64>>();
    let (gaps, times) = (all("gap"), all("elapsed_s"));
    assert!(gaps.len() > 1 && gaps.windows(2).all(|pair| pair[1] <= pair[0]), "{gaps:?}");
    assert!(times.windows(2).all(|pair| pair[0] <= pair[1]), "{times:?}");
    let last = lines.last().expect("a line");
    assert_eq!((&last["gap"], &last["front_size"]), (&run["gap"], &run["front_size"]));
    assert_eq!((&last["boxes_open"], &last["designs"]), (&run["boxes_open"], &run["designs_evaluated"]));
}

#[test]
fn the_record_of_an_exhaustive_search_ends_with_its_whole_front() {
    let here = tempfile::tempdir().expect("a folder");
    std::fs::write(here.path().join("study.json"), STUDY).expect("written");
    let (code, said) =
        armwright(here.path(), &["run", "study.json", "--progress", "seen.jsonl", "--out", "out"]);
    assert_eq!(code, 0, "{said}");
    let (lines, run) = (record(&here.path().join("seen.jsonl")), json_of(&here.path().join("out/run.json")));
    let last = lines.last().expect("a line");
    assert_eq!((&last["gap"], &last["front_size"]), (&json!(0.0), &run["front_size"]));
    assert_eq!((&last["designs"], &last["boxes_open"]), (&run["designs_total"], &Value::Null));
    let (code, said) =
        armwright(here.path(), &["run", "study.json", "--progress", "no/such/folder", "--out", "out"]);
    assert_eq!(code, 7, "{said}");
}

#[test]
fn a_limit_of_mass_proves_that_part_of_the_front_and_says_up_to_which_mass() {
    let here = tempfile::tempdir().expect("a folder");
    std::fs::write(here.path().join("study.json"), STUDY).expect("written");
    for search in ["exact", "exhaustive"] {
        let run = |more: &[&str], out: &str| {
            let words = ["run", "study.json", "--search", search, "--out", out];
            let (code, said) = armwright(here.path(), &[&words[..], more].concat());
            assert_eq!(code, 0, "{said}");
            (json_of(&here.path().join(out).join("run.json")), said)
        };
        let (whole, _) = run(&[], "whole");
        assert_eq!((&whole["proved_to_mass_kg"], whole["status"] == "partial"), (&Value::Null, false));
        let all = rows(&here.path().join("whole/front.csv"));
        let most_kg = 0.5 * (all[all.len() / 2].0 + all[all.len() / 2 + 1].0);
        let (part, said) = run(&["--mass-max-kg", &most_kg.to_string()], "part");
        assert_eq!(part["proved_to_mass_kg"], json!(most_kg));
        assert!(search != "exact" || said.contains("of the front up to"), "{said}");
        let objectives = |rows: Vec<(f64, String)>| -> Vec<f64> {
            rows.into_iter().map(|(mass_kg, _)| mass_kg).filter(|mass_kg| *mass_kg <= most_kg).collect()
        };
        let found = rows(&here.path().join("part/front.csv"));
        assert!(found.len() < all.len() && found.len() > 1);
        assert_eq!(objectives(found), objectives(all));
        let (code, said) = armwright(here.path(), &["front", "check", "part"]);
        assert_eq!(code, 0, "{said}");
    }
    for wrong in ["0", "-3", "heavy", "inf"] {
        let word = format!("--mass-max-kg={wrong}");
        assert_eq!(armwright(here.path(), &["run", "study.json", &word, "--out", "none"]).0, 2, "{wrong}");
    }
}
