//! A result is replaced as a whole: at whatever moment the program stops, a reader finds either the old result or the
//! new one, complete. Files that do not belong to the result are neither replaced nor removed.

use crate::running::{command, has_faults, said};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// A study of two designs, which is searched at once, with this payload.
pub(crate) fn study(name: &str, payload_kg: f64) -> String {
    json!({"name": name, "chain": [
        {"type": "joint", "name": "j", "axis": [0, 1, 0], "stiffness_nm_per_rad": 50000, "mass_kg": 2},
        {"type": "link", "name": "l", "vector_m": [0.5, 0, 0], "choose": {
            "materials": ["Aluminium 6061-T6"],
            "sections": [{"shape": "round_tube", "diameter_mm": [50], "wall_mm": [2, 4]}]}}],
        "payload": {"mass_kg": payload_kg}, "poses": [{"pose_deg": [0]}]})
    .to_string()
}

fn succeeds(folder: &Path, words: &[&str]) -> String {
    let (code, text) = said(&mut command(folder, words));
    assert_eq!(code, 0, "{words:?}: {text}");
    text
}

fn json_of(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display())))
        .expect("JSON")
}

/// All files of a folder, relative to it.
fn files(folder: &Path) -> BTreeSet<String> {
    let mut out = BTreeSet::new();
    let mut open = vec![PathBuf::new()];
    while let Some(inside) = open.pop() {
        for entry in fs::read_dir(folder.join(&inside)).expect("a folder") {
            let entry = entry.expect("an entry");
            let path = inside.join(entry.file_name());
            match entry.file_type().expect("a type").is_dir() {
                true => open.push(path),
                false => drop(out.insert(path.to_str().expect("text").to_string())),
            }
        }
    }
    out
}

pub(crate) fn copy(from: &Path, to: &Path) {
    for name in files(from) {
        let target = to.join(&name);
        fs::create_dir_all(target.parent().expect("a folder")).expect("made");
        fs::copy(from.join(name), target).expect("copied");
    }
}

/// The name of the study of a result, after every file has been compared with the list of them.
fn whole(folder: &Path) -> String {
    let run = json_of(&folder.join("run.json"));
    let listed = run["files"].as_object().expect("a list");
    for (name, hash) in listed {
        let bytes = fs::read(folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(hash, blake3::hash(&bytes).to_hex().as_str(), "{name} is of another run");
    }
    let own: BTreeSet<String> = listed.keys().cloned().chain(["run.json".to_string()]).collect();
    assert_eq!(files(folder), own, "files of no result");
    run["study"].as_str().expect("a name").to_string()
}

/// Lets a run replace a result, with a fault at each step to the disk in turn. Returns the names of the studies that were
/// found afterwards.
fn with_faults(
    here: &Path,
    old: &str,
    new: &str,
    fault: &str,
    steps: impl Iterator<Item = u32>,
) -> BTreeSet<String> {
    succeeds(here, &["run", old, "--out", "old"]);
    let mut found = BTreeSet::new();
    for step in steps {
        let _ = fs::remove_dir_all(here.join("out"));
        copy(&here.join("old"), &here.join("out"));
        let mut run = command(here, &["run", new, "--out", "out"]);
        let (code, text) = said(run.env("ARMWRIGHT_FAULT", format!("{fault}:{step}")));
        assert!([-1, 0, 7].contains(&code), "step {step}: {text}");
        // a reader completes what was decided; what it says of these studies does not matter here
        let (_, text) = said(&mut command(here, &["compare", "out"]));
        assert!(!text.contains("not one result"), "step {step}: {text}");
        // what was not decided is swept by the next writer
        let _ = fs::remove_dir_all(here.join("out/.armwright"));
        found.insert(whole(&here.join("out")));
        if code == 0 && fault == "kill" {
            break;
        }
    }
    found
}

#[test]
fn a_process_that_dies_at_any_step_leaves_the_old_result_or_the_new_one() {
    if !has_faults() {
        return;
    }
    let here = tempfile::tempdir().expect("a folder");
    let found = with_faults(here.path(), "fig4-composites", "fig2-metals", "kill", 1..);
    assert_eq!(found.into_iter().collect::<Vec<_>>(), ["fig2-metals", "fig4-composites"]);
}

#[test]
fn a_search_that_dies_at_some_step_leaves_the_old_result_or_the_new_one() {
    if !has_faults() {
        return;
    }
    let here = tempfile::tempdir().expect("a folder");
    for (name, kg) in [("old", 3.0), ("new", 5.0)] {
        fs::write(here.path().join(format!("{name}.json")), study(name, kg)).expect("written");
    }
    let found = with_faults(here.path(), "old.json", "new.json", "kill", (1..).step_by(11));
    assert_eq!(found.into_iter().collect::<Vec<_>>(), ["new", "old"]);
}

#[test]
fn a_disk_that_fills_at_any_step_leaves_the_old_result_or_the_new_one() {
    if !has_faults() {
        return;
    }
    let here = tempfile::tempdir().expect("a folder");
    let found = with_faults(here.path(), "fig4-composites", "fig2-metals", "full", 1..16);
    assert!(found.contains("fig4-composites"), "{found:?}");
}

#[test]
fn a_disk_that_is_full_loses_no_front_once_it_is_written() {
    if !has_faults() {
        return;
    }
    let here = tempfile::tempdir().expect("a folder");
    fs::write(here.path().join("study.json"), study("new", 3.0)).expect("written");
    let mut codes = BTreeSet::new();
    for step in [1, 2, 3, 5, 6, 7, 9, 20] {
        let _ = fs::remove_dir_all(here.path().join("out"));
        let mut run = command(here.path(), &["run", "study.json", "--out", "out"]);
        let (code, text) = said(run.env("ARMWRIGHT_FAULT", format!("full:{step}")));
        codes.insert(code);
        match code {
            7 => assert!(!here.path().join("out").exists(), "step {step} leaves something: {text}"),
            _ => {
                assert!(text.contains("warning: not written"), "step {step}: {text}");
                let said = succeeds(here.path(), &["design", "out", "x0", "--out", "x0"]);
                assert!(said.contains("mass"), "{said}");
            }
        }
    }
    assert_eq!(codes.into_iter().collect::<Vec<_>>(), [0, 7]);
}

/// Numbers that look random and are the same each time.
fn moments() -> impl Iterator<Item = u64> {
    (1u64..).map(|n| n.wrapping_mul(6_364_136_223_846_793_005).rotate_left(29) % 1000)
}

#[test]
fn a_process_that_is_killed_at_any_moment_leaves_one_whole_result() {
    let here = tempfile::tempdir().expect("a folder");
    for (name, kg) in [("light", 3.0), ("heavy", 5.0)] {
        fs::write(here.path().join(format!("{name}.json")), study(name, kg)).expect("written");
    }
    let start = std::time::Instant::now();
    succeeds(here.path(), &["run", "light.json", "--out", "out"]);
    let whole_run = start.elapsed();
    let (names, mut killed) = (["heavy.json", "light.json"], 0);
    for (nth, moment) in moments().take(20).enumerate() {
        let mut child = command(here.path(), &["run", names[nth % 2], "--out", "out"])
            .stdout(std::process::Stdio::null())
            .stderr(std::process::Stdio::null())
            .spawn()
            .expect("it runs");
        std::thread::sleep(whole_run.mul_f64(moment as f64 / 1000.0));
        child.kill().expect("killed");
        killed += usize::from(child.wait().expect("an end").code().is_none());
        let said = succeeds(here.path(), &["design", "out", "x0", "--out", "x0"]);
        let study = json_of(&here.path().join("out/run.json"))["study"].as_str().expect("a name").to_string();
        assert!(said.starts_with(&format!("design x0 of {study}:")), "{said}");
        let payload_kg = json_of(&here.path().join("x0/cases.json"))[0]["payload"]["mass_kg"].as_f64();
        assert_eq!(payload_kg, Some(if study == "heavy" { 5.0 } else { 3.0 }), "of another study");
        succeeds(here.path(), &["front", "check", "out"]);
    }
    assert!(killed > 5, "only {killed} of 20 runs were killed: the others were done");
}

#[test]
fn a_mixture_of_two_results_is_refused_by_every_reader() {
    let here = tempfile::tempdir().expect("a folder");
    for (name, kg) in [("light", 3.0), ("heavy", 5.0)] {
        fs::write(here.path().join(format!("{name}.json")), study(name, kg)).expect("written");
        succeeds(here.path(), &["run", &format!("{name}.json"), "--out", name]);
    }
    fs::copy(here.path().join("heavy/front.csv"), here.path().join("light/front.csv")).expect("copied");
    let readers: [&[&str]; 4] = [
        &["design", "light", "x0"],
        &["front", "check", "light"],
        &["compare", "light"],
        &["compare", "light/front.csv"],
    ];
    for words in readers {
        let (code, text) = said(&mut command(here.path(), words));
        assert_eq!(code, 9, "{words:?}: {text}");
        assert!(text.contains("light is not one result: front.csv"), "{words:?}: {text}");
    }
    // a copy without pictures is no mixture
    fs::remove_dir_all(here.path().join("heavy/plots")).expect("removed");
    succeeds(here.path(), &["design", "heavy", "x0"]);
}

#[test]
fn an_edited_run_json_is_refused_by_every_reader_and_an_empty_one_is_written_anew() {
    let here = tempfile::tempdir().expect("a folder");
    let path = here.path().join("out/run.json");
    fs::write(here.path().join("study.json"), study("new", 3.0)).expect("written");
    succeeds(here.path(), &["run", "study.json", "--out", "out"]);
    let mut run = json_of(&path);
    run["designs_evaluated"] = json!(3);
    fs::write(&path, format!("{run:#}")).expect("written");
    let readers: [&[&str]; 4] =
        [&["design", "out", "x0"], &["front", "check", "out"], &["compare", "out"], &["check", "out"]];
    for words in readers {
        let (code, text) = said(&mut command(here.path(), words));
        assert!(code == 9 && text.contains("run.json is not what was written"), "{words:?}: {code} {text}");
    }
    fs::write(&path, "").expect("written");
    let (code, text) = said(&mut command(here.path(), &["design", "out", "x0"]));
    assert!(code == 7 && text.contains("has an empty run.json"), "{code} {text}");
    succeeds(here.path(), &["run", "study.json", "--out", "out"]);
    assert_eq!(whole(&here.path().join("out")), "new");
}

#[test]
fn a_second_writer_is_refused_until_the_first_one_ends() {
    let here = tempfile::tempdir().expect("a folder");
    fs::write(here.path().join("study.json"), study("new", 3.0)).expect("written");
    fs::create_dir_all(here.path().join("out/.armwright")).expect("made");
    let lock = fs::File::create(here.path().join("out/.armwright/lock")).expect("a lock");
    fs::write(here.path().join("out/.armwright/lock"), "process 4711\n").expect("written");
    lock.lock().expect("locked");
    let (code, text) = said(&mut command(here.path(), &["run", "study.json", "--out", "out"]));
    assert_eq!(code, 12, "{text}");
    assert!(text.contains("out is being written by process 4711") && text.contains("--out"), "{text}");
    // the file stays, as that of a process that died; it counts for nothing
    drop(lock);
    succeeds(here.path(), &["run", "study.json", "--out", "out"]);
    assert_eq!(whole(&here.path().join("out")), "new");
}

#[test]
fn only_files_that_the_last_result_lists_are_replaced_or_removed() {
    let here = tempfile::tempdir().expect("a folder");
    let at = |name: &str| here.path().join(name);
    fs::write(at("study.json"), study("new", 3.0)).expect("written");
    succeeds(here.path(), &["run", "study.json", "--out", "out"]);
    let old = files(&at("out"));
    fs::write(at("out/plots/my-measurements.csv"), "mine").expect("written");
    fs::write(at("out/near.csv"), "mine").expect("written");
    succeeds(here.path(), &["run", "fig2-metals", "--out", "out"]);
    let new = files(&at("out"));
    assert!(new.contains("plots/my-measurements.csv") && new.contains("near.csv"), "{new:?}");
    let gone = ["front.csv", "study.json", "front.aluminium-6061-t6.csv", "plots/pick-lightest-arm.svg"];
    assert!(gone.iter().all(|name| old.contains(*name) && !new.contains(*name)), "{old:?} {new:?}");
    // near.csv is no file of a result: a run that would write one says so
    let (code, text) = said(&mut command(here.path(), &["run", "study.json", "--out", "out"]));
    assert_eq!(code, 2, "{text}");
    assert!(text.contains("no part of an earlier result") && text.contains("near.csv"), "{text}");
    assert_eq!(files(&at("out")), new);
}

#[test]
fn run_json_names_a_plot_in_whose_place_someone_elses_file_stands() {
    let here = tempfile::tempdir().expect("a folder");
    let at = |name: &str| here.path().join(name);
    fs::write(at("study.json"), study("new", 3.0)).expect("written");
    fs::create_dir_all(at("out/plots")).expect("made");
    fs::write(at("out/plots/front.svg"), "mine").expect("written");
    succeeds(here.path(), &["run", "study.json", "--out", "out"]);
    let run: Value =
        serde_json::from_str(&fs::read_to_string(at("out/run.json")).expect("a run")).expect("JSON");
    let [what] = run["not_written"].as_array().expect("a list").as_slice() else { panic!("{run}") };
    assert!(what.as_str().expect("words").starts_with("plots/front.svg: "), "{what}");
    let (code, text) = said(&mut command(here.path(), &["check", "out"]));
    assert!(code == 9 && text.contains("not written: plots/front.svg"), "{code} {text}");
    assert_eq!(fs::read_to_string(at("out/plots/front.svg")).expect("a file"), "mine");
}

#[test]
fn verdict_json_names_a_plot_in_whose_place_someone_elses_file_stands() {
    let here = tempfile::tempdir().expect("a folder");
    let at = |name: &str| here.path().join(name);
    let campaign = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/dial_gauge/z0_none");
    fs::create_dir_all(at("out/plots")).expect("made");
    fs::write(at("out/plots/channels.svg"), "mine").expect("written");
    succeeds(here.path(), &["reconcile", campaign.to_str().expect("text"), "--out", "out"]);
    let verdict = json_of(&at("out/verdict.json"));
    let [what] = verdict["not_written"].as_array().expect("a list").as_slice() else { panic!("{verdict}") };
    assert!(what.as_str().expect("words").starts_with("plots/channels.svg: "), "{what}");
    let (code, text) = said(&mut command(here.path(), &["check", "out"]));
    assert!(code == 9 && text.contains("not written: plots/channels.svg"), "{code} {text}");
    assert_eq!(fs::read_to_string(at("out/plots/channels.svg")).expect("a file"), "mine");
    // once the place is free, the same command makes the whole result
    fs::remove_file(at("out/plots/channels.svg")).expect("removed");
    succeeds(here.path(), &["reconcile", campaign.to_str().expect("text"), "--out", "out"]);
    succeeds(here.path(), &["check", "out"]);
    assert!(fs::read_to_string(at("out/plots/channels.svg")).expect("a file").starts_with("<svg"));
}

#[cfg(unix)]
#[test]
fn symbolic_links_are_not_followed() {
    let here = tempfile::tempdir().expect("a folder");
    let at = |name: &str| here.path().join(name);
    fs::write(at("study.json"), study("new", 3.0)).expect("written");
    succeeds(here.path(), &["run", "study.json", "--out", "out"]);
    // the plots are elsewhere now, under the names that run.json lists
    fs::rename(at("out/plots"), at("elsewhere")).expect("renamed");
    std::os::unix::fs::symlink(at("elsewhere"), at("out/plots")).expect("linked");
    fs::write(at("notes.md"), "mine").expect("written");
    fs::remove_file(at("out/summary.md")).expect("removed");
    std::os::unix::fs::symlink(at("notes.md"), at("out/summary.md")).expect("linked");
    let elsewhere = files(&at("elsewhere"));
    let (code, text) = said(&mut command(here.path(), &["run", "fig2-metals", "--out", "out"]));
    assert_eq!(code, 0, "{text}");
    assert!(text.contains("warning: not written: plots/"), "{text}");
    // in a log of JSON a warning is an object as everything else
    let words = ["run", "fig2-metals", "--out", "out", "--log", "json"];
    let logged = command(here.path(), &words).output().expect("it runs");
    let text = String::from_utf8_lossy(&logged.stderr).into_owned();
    let mut events = text.lines().map(|line| serde_json::from_str::<Value>(line).expect(line));
    let begins =
        |event: &Value| event["message"].as_str().is_some_and(|s| s.starts_with("not written: plots/"));
    assert!(events.any(|event| event["event"] == "warning" && begins(&event)), "{text}");
    assert_eq!(files(&at("elsewhere")), elsewhere);
    assert_eq!(fs::read_to_string(at("notes.md")).expect("mine"), "mine");
    assert!(!at("out/summary.md").is_symlink());
}

#[test]
fn a_small_disk_that_is_full_is_an_error_and_keeps_the_old_result() {
    let here = tempfile::tempdir().expect("a folder");
    let disk = here.path().join("disk");
    fs::create_dir(&disk).expect("made");
    let mount = |words: &[&str]| Command::new(words[0]).args(&words[1..]).arg(&disk).output();
    let mounted = mount(&["mount", "-t", "tmpfs", "-o", "size=700k", "none"]);
    if !mounted.is_ok_and(|output| output.status.success()) {
        eprintln!("SKIPPED a full disk: this test may not mount one");
        return;
    }
    let tried = std::panic::catch_unwind(|| {
        for (name, kg) in [("light", 3.0), ("heavy", 5.0)] {
            fs::write(here.path().join(format!("{name}.json")), study(name, kg)).expect("written");
        }
        succeeds(here.path(), &["run", "light.json", "--out", "disk/out"]);
        // fills what is left
        let filler = fs::write(disk.join("filler"), vec![0u8; 700 << 10]);
        assert!(filler.is_err(), "the disk is not full");
        let (code, text) = said(&mut command(here.path(), &["run", "heavy.json", "--out", "disk/out"]));
        assert_eq!(code, 7, "{text}");
        assert!(text.contains("No space left"), "{text}");
        succeeds(here.path(), &["front", "check", "disk/out"]);
        assert_eq!(whole(&disk.join("out")), "light");
    });
    std::thread::sleep(Duration::from_millis(10));
    mount(&["umount"]).expect("unmounted");
    tried.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
}
