//! What the operator of a run sees: logs without carriage returns, JSON lines, quiet runs, and exit codes of runs that
//! were stopped. Results must be equal except for their timings.

use crate::front_check::STUDY;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn armwright(folder: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_armwright")).current_dir(folder).args(words).output().expect("it runs")
}

fn with_study() -> tempfile::TempDir {
    let here = tempfile::tempdir().expect("a folder");
    std::fs::write(here.path().join("study.json"), STUDY).expect("written");
    here
}

#[test]
fn a_log_in_a_file_has_no_carriage_return_and_its_last_line_has_totals_and_time() {
    let here = with_study();
    for search in ["exact", "exhaustive"] {
        let output = armwright(here.path(), &["run", "study.json", "--search", search, "--out", "out"]);
        for stream in [&output.stdout, &output.stderr] {
            let text = String::from_utf8_lossy(stream);
            assert!(!text.contains('\r'), "{text}");
            let last = text.lines().last().expect("a line");
            assert!(last.contains(" s") && last.chars().any(|c| c.is_ascii_digit()), "{last}");
        }
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(text.lines().last().is_some_and(|line| line.contains(" designs in ")), "{text}");
    }
}

#[test]
fn a_log_in_json_is_an_object_a_line_and_a_quiet_run_says_errors_alone() {
    let here = with_study();
    for search in ["exact", "exhaustive"] {
        let words = ["run", "study.json", "--search", search, "--out", "out"];
        let output = armwright(here.path(), &[&words[..], &["--log", "json"]].concat());
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        let events: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
        let last = events.last().expect("an event");
        assert!(
            last["event"] == "searched" && last["elapsed_s"].is_f64() && last["designs"].is_u64(),
            "{last}"
        );
        let quiet = armwright(here.path(), &[&words[..], &["--quiet"]].concat());
        assert_eq!((quiet.status.code(), quiet.stderr.as_slice()), (Some(0), &b""[..]));
    }
    let failed = armwright(here.path(), &["run", "missing.json", "--log", "json", "--quiet"]);
    let error: Value = serde_json::from_slice(&failed.stderr).expect("JSON");
    assert_eq!((&error["event"], &error["exit_code"]), (&Value::from("error"), &Value::from(7)));
}

#[test]
fn studies_whose_names_differ_beyond_ascii_have_folders_of_their_own() {
    let here = tempfile::tempdir().expect("a folder");
    for (file, name) in [("a.json", "Ärm 5 kg"), ("b.json", "Örm 5 kg"), ("c.json", "Arm 5 kg")] {
        let mut study: Value = serde_json::from_str(STUDY).expect("JSON");
        study["name"] = name.into();
        std::fs::write(here.path().join(file), study.to_string()).expect("written");
        assert!(armwright(here.path(), &["run", file]).status.success(), "{name}");
    }
    let folders = std::fs::read_dir(here.path().join("results")).expect("results");
    let mut names: Vec<String> =
        folders.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    assert!(names.len() == 3 && names[0] == "arm-5-kg", "{names:?}");
    assert!(names[1..].iter().all(|name| name.starts_with("rm-5-kg-")), "{names:?}");
}

#[test]
fn results_are_the_same_outside_of_their_timings_for_any_number_of_threads() {
    let here = with_study();
    for search in ["exact", "exhaustive"] {
        for (threads, out) in [("1", "one"), ("2", "two")] {
            let words = ["run", "study.json", "--search", search, "--threads", threads, "--out", out];
            assert!(armwright(here.path(), &words).status.success());
        }
        let same = armwright(here.path(), &["check", "--same", "one", "two"]);
        assert!(same.status.success(), "{}", String::from_utf8_lossy(&same.stderr));
        // the page names its folder, and a path in HTML is written otherwise than in Markdown
        let words = ["run", "study.json", "--search", search, "--out", "in a folder/one & only"];
        assert!(armwright(here.path(), &words).status.success());
        let same = armwright(here.path(), &["check", "--same", "one", "in a folder/one & only"]);
        assert!(same.status.success(), "{}", String::from_utf8_lossy(&same.stderr));
        let [one, two] =
            ["one", "two"].map(|out| std::fs::read(here.path().join(out).join("run.json")).expect("a run"));
        assert_ne!(one, two, "threads and time differ");
    }
    std::fs::remove_file(here.path().join("two/budget.csv")).expect("removed");
    let other = armwright(here.path(), &["check", "--same", "one", "two"]);
    assert_eq!(other.status.code(), Some(9));
    assert!(String::from_utf8_lossy(&other.stderr).contains("budget.csv is only in one"));
    for out in ["paper-one", "paper-two"] {
        assert!(armwright(here.path(), &["run", "paper-table1", "--out", out]).status.success());
    }
    let same = armwright(here.path(), &["check", "--same", "paper-one", "paper-two"]);
    assert!(same.status.success(), "{}", String::from_utf8_lossy(&same.stderr));
}

#[test]
fn a_search_that_a_time_limit_ends_is_partial_and_its_check_settles_nothing_in_no_time() {
    let here = tempfile::tempdir().expect("a folder");
    // a machine with other work may find no design in a few seconds
    let mut runs = ["6", "40", "100"]
        .into_iter()
        .map(|limit| armwright(here.path(), &["run", "full-catalog", "--time-limit", limit, "--out", "out"]));
    let partial =
        runs.find(|_| here.path().join("out/front.csv").exists()).expect("a design within some limit");
    assert_eq!(partial.status.code(), Some(10), "{}", String::from_utf8_lossy(&partial.stderr));
    let said =
        [&partial.stdout, &partial.stderr].map(|text| String::from_utf8_lossy(text).into_owned()).concat();
    assert!(said.contains("partial") || said.contains("time limit"), "{said}");
    let check = armwright(here.path(), &["front", "check", "out", "--time-limit", "0.001"]);
    assert_eq!(check.status.code(), Some(11), "{}", String::from_utf8_lossy(&check.stdout));
}

/// A study of which a visit takes many minutes.
#[cfg(unix)]
#[test]
fn ctrl_c_ends_a_visit_at_once_and_the_front_of_the_designs_visited_is_written() {
    let here = tempfile::tempdir().expect("a folder");
    let words = ["run", "compare-materials", "--search", "exhaustive", "--threads", "1", "--out", "out"];
    let mut command = Command::new(env!("CARGO_BIN_EXE_armwright"));
    let command = command.current_dir(here.path()).args(words).stdout(Stdio::piped()).stderr(Stdio::piped());
    let run = command.spawn().expect("it runs");
    std::thread::sleep(std::time::Duration::from_secs(4));
    let stopped = Command::new("kill").args(["-INT", &run.id().to_string()]).status();
    assert!(stopped.expect("kill runs").success());
    let output = run.wait_with_output().expect("it ends");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(8) && said.contains("stopped after"), "{:?} {said}", output.status);
    if said.contains("none of them meets") {
        return;
    }
    let run = std::fs::read_to_string(here.path().join("out/run.json")).expect("a run");
    let run: Value = serde_json::from_str(&run).expect("JSON");
    assert_eq!(run["status"], "interrupted");
    assert!(run["front_size"].as_u64() > Some(0));
}
