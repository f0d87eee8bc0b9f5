//! A measured arm's study run again: `reconcile --study` on the campaign of `examples/measured-arm`, whose picks must
//! change as a slow, separately written search says (see `brute`).

use crate::brute::catalog::Catalog;
use crate::brute::design::{Design, search};
use crate::brute::front::{Place, places};
use crate::brute::program::{FrontRow, Results, armwright, armwright_ok, read_json, word};
use crate::brute::study::Study;
use serde_json::Value;
use std::path::Path;

/// Both compute the same objectives, the one by compliances, the other by finite elements.
const TOLERANCE: f64 = 1e-6;

fn example() -> String {
    format!("{}/examples/measured-arm", env!("CARGO_MANIFEST_DIR"))
}

fn reconciled(dir: &Path, campaign: &str, study: &str) -> (String, Value) {
    let said = armwright_ok(&["reconcile", campaign, "--study", study, "--out", word(dir)]);
    (said, read_json(&dir.join("verdict.json")))
}

/// Mass, deflection and minus the mode.
fn minimized(design: &Design) -> [f64; 3] {
    [design.mass_kg, design.tip_deflection_mm, -design.lowest_mode_hz]
}

/// Nearest to the ideal point in logarithms, each objective scaled by its range over the front.
fn knee<'a>(front: &[&'a Design]) -> &'a Design {
    let logarithms = |d: &Design| minimized(d).map(|x| x.abs().ln() * x.signum());
    let ends = |i: usize, start: f64, better: fn(f64, f64) -> f64| {
        front.iter().map(|d| logarithms(d)[i]).fold(start, better)
    };
    let distance = |d: &Design| -> f64 {
        let own = logarithms(d);
        let part = |i: usize| {
            let (least, most) = (ends(i, f64::INFINITY, f64::min), ends(i, f64::NEG_INFINITY, f64::max));
            ((own[i] - least) / (most - least)).powi(2)
        };
        (0..3).map(part).sum()
    };
    front.iter().copied().min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("a front")
}

/// What brute force makes of a result's own study: the picks by their choices, in the order of the verdict's.
fn picks_by_brute_force(results: &Path) -> Vec<(String, [f64; 3])> {
    let study = Study::from_json(&read_json(&results.join("study.json")), &Catalog::built_in());
    let searched = search(&study);
    let all: Vec<&Design> = searched.designs.iter().collect();
    let stands = places(&all);
    assert!(
        !stands.contains(&Place::Close),
        "a design whose place hangs on the last millionth is no example"
    );
    let front: Vec<&Design> =
        all.iter().zip(&stands).filter(|(_, place)| **place == Place::On).map(|(d, _)| *d).collect();
    let best = |i: usize| {
        let by = |a: &&&Design, b: &&&Design| minimized(a)[i].total_cmp(&minimized(b)[i]);
        *front.iter().min_by(by).expect("a front")
    };
    [best(0), best(1), best(2), knee(&front)].map(|d| (d.key(&study), minimized(d))).to_vec()
}

fn key_of(results: &Path, id: &str) -> String {
    let study = read_json(&results.join("study.json"));
    let front = Results::read(results).front;
    let row: &FrontRow =
        front.iter().find(|row| row.text("design_id") == id).expect("a pick is on its front");
    row.key(&study)
}

#[test]
fn the_picks_of_a_measured_arms_study_change_as_brute_force_says() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let study = format!("{}/study.json", example());
    let (said, verdict) = reconciled(dir.path(), &example(), &study);
    assert_eq!(verdict["verdict"], "explained", "{said}");
    assert_found_what_it_was_built_with(&verdict);
    let rerun = &verdict["study"];
    assert_eq!(rerun["status"], "complete");
    let folders = ["nominal", "corrected"].map(|side| dir.path().join("study").join(side));
    let [before, after] = folders.each_ref().map(|folder| picks_by_brute_force(folder));
    let picks = rerun["picks"].as_array().expect("picks");
    assert_eq!(picks.len(), 4);
    for ((pick, (old, old_values)), (new, new_values)) in picks.iter().zip(&before).zip(&after) {
        let name = pick["pick"].as_str().expect("a name");
        let id = |side: &str| pick[format!("{side}_design_id")].as_str().expect("an id").to_string();
        assert_eq!(&key_of(&folders[0], &id("nominal")), old, "{name}");
        assert_eq!(&key_of(&folders[1], &id("corrected")), new, "{name}");
        assert_eq!(pick["changes"].as_bool(), Some(old != new), "{name}");
        for (side, values) in [("nominal", old_values), ("corrected", new_values)] {
            let theirs =
                ["mass_kg", "tip_deflection_mm", "lowest_mode_hz"].map(|k| pick[side][k].as_f64().expect(k));
            for (a, b) in theirs.iter().zip(values) {
                assert!(
                    (a / b.abs() - 1.0).abs() < TOLERANCE,
                    "{name}, {side}: {theirs:?}, brute force {values:?}"
                );
            }
        }
        assert!(said.contains(name), "{said}");
    }
    assert!(picks.iter().any(|p| p["changes"] == true), "an example in which something changes: {picks:?}");
    assert_every_design_of_either_front_is_listed(dir.path(), &folders.each_ref().map(|f| Results::read(f)));

    let exact = dir.path().join("exact");
    armwright_ok(&["reconcile", &example(), "--study", &study, "--search", "exact", "--out", word(&exact)]);
    let changes = |dir: &Path| std::fs::read(dir.join("study_changes.csv")).expect("written");
    assert_eq!(changes(dir.path()), changes(&exact), "both searches find the whole front");
}

/// The effects of the key, each within its interval.
fn assert_found_what_it_was_built_with(verdict: &Value) {
    let built = read_json(Path::new(&format!("{}/built-with.json", example())));
    let found = verdict["effects"].as_array().expect("effects");
    assert_eq!(found.len(), built.as_array().expect("effects").len(), "{found:?}");
    for effect in built.as_array().expect("effects") {
        let same = |f: &&Value| f["effect"] == effect["effect"] && f["at"] == effect["at"];
        let own = found.iter().find(same).unwrap_or_else(|| panic!("{effect} is not found: {found:?}"));
        for (name, value) in effect["parameters"].as_object().expect("parameters") {
            let end = |side: &str| own["parameters"][name][side].as_f64().expect("an interval");
            let value = value.as_f64().expect("a number");
            assert!(end("low") <= value && value <= end("high"), "{effect}: {own}");
        }
    }
}

fn assert_every_design_of_either_front_is_listed(dir: &Path, [nominal, corrected]: &[Results; 2]) {
    let text = std::fs::read_to_string(dir.join("study_changes.csv")).expect("written");
    let mut rows = csv::Reader::from_reader(text.as_bytes());
    let header = rows.headers().expect("a header").clone();
    let at = |name: &str| header.iter().position(|c| c == name).expect("the column");
    let has = |front: &[FrontRow], id: &str| front.iter().any(|row| row.text("design_id") == id);
    let mut count = 0;
    for row in rows.records() {
        let row = row.expect("a row");
        let id = &row[at("design_id")];
        let expected = match [has(&nominal.front, id), has(&corrected.front, id)] {
            [true, true] => "stays",
            [true, false] => "leaves",
            [false, true] => "enters",
            [false, false] => panic!("{id} is on neither front"),
        };
        assert_eq!(&row[at("front")], expected, "{id}");
        count += if expected == "stays" { 2 } else { 1 };
    }
    assert_eq!(count, nominal.front.len() + corrected.front.len());
}

#[test]
fn a_study_is_not_run_again_where_nothing_is_explained() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    let hidden = format!("{}/tests/data/campaigns/hard-d6dfd", env!("CARGO_MANIFEST_DIR"));
    // its effect is one of the payload: explained, and nothing to build differently
    let (said, verdict) = reconciled(dir.path(), &hidden, &format!("{}/study.json", example()));
    assert_eq!(verdict["study"]["status"], "not_run", "{said}");
    assert!(said.contains("not re-run"), "{said}");
    assert!(!dir.path().join("study").exists());
}

#[test]
fn a_study_of_very_many_designs_is_not_searched_design_by_design() {
    let dir = tempfile::tempdir().expect("a temporary folder");
    // far more designs than can be visited, of an arm whose joint 3 has play
    let builtin = concat!(env!("CARGO_MANIFEST_DIR"), "/studies/compare-materials.json");
    let mut large = read_json(Path::new(builtin));
    for piece in large["chain"].as_array_mut().expect("pieces") {
        if ["j2", "j3"].iter().any(|name| piece["name"] == *name) {
            piece.as_object_mut().expect("a joint").remove("drives");
        }
    }
    let file = dir.path().join("large.json");
    std::fs::write(&file, large.to_string()).expect("written");
    let campaign = format!("{}/tests/data/campaigns/plain-0251e", env!("CARGO_MANIFEST_DIR"));
    let out = dir.path().join("large");
    let output = armwright(&[
        "reconcile",
        &campaign,
        "--study",
        word(&file),
        "--time-limit",
        "2",
        "--out",
        word(&out),
    ]);
    let said = String::from_utf8(output.stdout).expect("text");
    assert_eq!(output.status.code(), Some(10), "{said}");
    let rerun = read_json(&out.join("verdict.json"))["study"].clone();
    assert_eq!(rerun["status"], "partial", "{said}");
    for side in ["nominal", "corrected"] {
        let run = read_json(&out.join("study").join(side).join("run.json"));
        assert!(run["designs_total"].as_f64().expect("a number") > 1e9);
        assert_eq!((&run["search"], &run["gap"]), (&"exact".into(), &rerun[side]["gap"]));
        let effects = run["effects"].as_array().expect("effects");
        assert_eq!(effects.iter().any(|e| e["effect"] == "lost_motion"), side == "corrected", "{effects:?}");
    }
    assert_eq!(rerun["picks"].as_array().expect("picks").len(), 4);
    assert!(said.contains("Not all designs are listed"), "{said}");
}

#[test]
fn a_study_without_a_design_is_no_success_and_the_verdict_stands() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut study = read_json(Path::new(&format!("{}/study.json", example())));
    study["constraints"]["mass_max_kg"] = 0.1.into();
    let file = dir.path().join("light.json");
    std::fs::write(&file, study.to_string()).expect("written");
    let out = dir.path().join("out");
    let output = armwright(&["reconcile", &example(), "--study", word(&file), "--out", word(&out)]);
    let said = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(6), "{said}");
    assert!(said.contains("the nominal model finds no design"), "{said}");
    let verdict = read_json(&out.join("verdict.json"));
    assert_eq!(
        (&verdict["verdict"], &verdict["study"]["status"]),
        (&"explained".into(), &"infeasible".into())
    );
}

#[test]
fn a_stop_in_the_first_search_ends_the_second_too_and_nothing_is_compared() {
    if !cfg!(feature = "faults") {
        eprintln!("SKIPPED a stop at a chosen moment: needs --features faults, which scripts/test gives");
        return;
    }
    let dir = tempfile::tempdir().expect("a folder");
    let study = format!("{}/study.json", example());
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_armwright"));
    command.args(["reconcile", &example(), "--study", &study, "--out", word(dir.path())]);
    // the program is stopped when the first front is found
    let output = command.env("ARMWRIGHT_FAULT", "stop:front").output().expect("it runs");
    let said = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(8), "{said}");
    assert!(said.contains("the search with the nominal model was stopped, so nothing is compared"), "{said}");
    assert!(!said.contains("no design is missing"), "{said}");
    assert_eq!(read_json(&dir.path().join("verdict.json"))["study"]["status"], "interrupted");
    assert!(dir.path().join("study/nominal/front.csv").is_file());
    assert!(!dir.path().join("study/corrected").exists());
}
