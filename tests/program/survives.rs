//! A run that meets trouble keeps what it has and says what is missing. Symbolic links are not followed, files of
//! others are not replaced, and after a signal no file is half-written.

use crate::running::{armwright, command, has_faults, said};
use crate::whole_results::{copy, study};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

fn with_study() -> tempfile::TempDir {
    let here = tempfile::tempdir().expect("a folder");
    fs::write(here.path().join("study.json"), study("short", 3.0)).expect("written");
    here
}

fn succeeds(here: &Path, words: &[&str]) -> String {
    let (code, text) = armwright(here, words);
    assert_eq!(code, 0, "{words:?}: {text}");
    text
}

/// Fails with this exit code, and says all of this.
fn fails(here: &Path, words: &[&str], expected: i32, says: &[&str]) {
    let (code, text) = armwright(here, words);
    assert_eq!(code, expected, "{words:?}: {text}");
    says.iter().for_each(|said| assert!(text.contains(said), "{words:?} lacks {said}: {text}"));
}

fn campaign() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/measured-arm")
}

fn copy_of_campaign(to: &Path) {
    fs::create_dir_all(to).expect("made");
    for entry in fs::read_dir(campaign()).expect("a campaign") {
        let from = entry.expect("an entry").path();
        fs::copy(&from, to.join(from.file_name().expect("a name"))).expect("copied");
    }
}

/// The result in `out` as a process leaves it that dies before it moves the first file.
fn half_moved(here: &Path) -> tempfile::TempDir {
    if !here.join("out").exists() {
        succeeds(here, &["run", "study.json", "--out", "out"]);
    }
    let there = tempfile::tempdir_in(here).expect("a folder");
    copy(&here.join("out"), &there.path().join(".armwright/ready"));
    there
}

#[cfg(unix)]
#[test]
fn unfinished_work_is_not_reached_over_links() {
    use std::os::unix::fs::symlink;
    let here = with_study();
    let victim = here.path().join("victim");
    fs::create_dir_all(victim.join("next")).expect("made");
    let names = ["pick-lightest-arm.svg", "next/keep.txt", "mine.txt"];
    names.iter().for_each(|name| fs::write(victim.join(name), "mine").expect("written"));
    let untouched = |what: &str| {
        names.iter().for_each(|n| assert_eq!(fs::read(victim.join(n)).expect(what), b"mine", "{what}"));
        assert_eq!(fs::read_dir(&victim).expect(what).count(), 3, "{what}");
    };
    type Harm<'a> = (&'a str, &'a dyn Fn(&Path));
    let harms: [Harm; 5] = [
        ("the target of a move", &|out| symlink(&victim, out.join("plots")).expect("linked")),
        ("the source of a move", &|out| {
            fs::remove_dir_all(out.join(".armwright/ready/plots")).expect("removed");
            symlink(&victim, out.join(".armwright/ready/plots")).expect("linked");
        }),
        ("the lock", &|out| symlink(victim.join("mine.txt"), out.join(".armwright/lock")).expect("linked")),
        ("next", &|out| symlink(&victim, out.join(".armwright/next")).expect("linked")),
        ("the state", &|out| {
            fs::remove_dir_all(out.join(".armwright")).expect("removed");
            symlink(&victim, out.join(".armwright")).expect("linked");
        }),
    ];
    for (what, harm) in harms {
        let half = half_moved(here.path());
        let out = half.path().to_str().expect("text");
        harm(half.path());
        for words in [&["compare", out][..], &["run", "study.json", "--out", out]] {
            fails(here.path(), words, 7, &["symbolic link"]);
            untouched(what);
        }
    }
}

#[test]
fn a_check_completes_a_result_whose_writer_died() {
    let here = with_study();
    let half = half_moved(here.path());
    let out = half.path().to_str().expect("text");
    assert!(succeeds(here.path(), &["check", out]).contains("result of a study, sound"));
    assert!(half.path().join("run.json").is_file());
    let again = half_moved(here.path());
    succeeds(here.path(), &["check", "--same", out, again.path().to_str().expect("text")]);
}

/// As if a signal came at this moment.
fn stopped_at(here: &Path, moment: &str, words: &[&str]) -> (i32, String) {
    let mut command = command(here, words);
    said(command.env("ARMWRIGHT_FAULT", format!("stop:{moment}")).env("ARMWRIGHT_KEEP_EVERY_MS", "0"))
}

#[test]
fn a_signal_after_the_search_leaves_a_whole_result_or_says_what_is_missing() {
    if !has_faults() {
        return;
    }
    for search in ["exhaustive", "exact"] {
        let here = with_study();
        let at = |name: &str| here.path().join("out").join(name);
        let run = ["run", "study.json", "--search", search, "--out", "out"];
        let (code, text) = stopped_at(here.path(), "front", &run);
        assert_eq!(code, 8, "{text}");
        assert!(text.contains("warning: not written: what goes with the front"), "{text}");
        let written: Value = serde_json::from_slice(&fs::read(at("run.json")).expect("read")).expect("JSON");
        assert!(written["not_written"][0].is_string() && !at("summary.md").exists(), "{written}");
        let (code, text) = armwright(here.path(), &["check", "out"]);
        assert!(code == 9 && text.contains("incomplete\n  not written: what goes with the front"), "{text}");
        let (code, text) = stopped_at(here.path(), "the summary on the terminal", &run);
        assert_eq!(code, 0, "everything is written: {text}");
        assert!(at("report.html").is_file() && !at(".armwright").exists());
    }
}

#[test]
fn a_signal_before_anything_is_written_ends_every_verb_with_its_own_code() {
    if !has_faults() {
        return;
    }
    let here = with_study();
    succeeds(here.path(), &["run", "study.json", "--shard", "1/1", "--out", "part"]);
    let campaign = campaign();
    for words in [
        &["merge", "part", "--out", "out"][..],
        &["reconcile", campaign.to_str().expect("text"), "--out", "out"],
        &["run", "paper-table1", "--out", "out"],
    ] {
        let (code, text) = stopped_at(here.path(), "begin", words);
        assert!(code == 8 && text.contains("stopped; nothing was written"), "{words:?}: {code} {text}");
        assert!(!here.path().join("out").exists(), "{words:?}");
    }
    assert_eq!(stopped_at(here.path(), "begin", &["run", "study.json", "--out", "out"]).0, 8);
    let (code, text) = stopped_at(here.path(), "front", &["merge", "part", "--out", "joined"]);
    assert!(code == 8 && text.contains("not written: what goes with the front"), "{code} {text}");
}

#[cfg(unix)]
#[test]
fn a_campaign_that_is_stopped_leaves_nothing() {
    let here = tempfile::tempdir().expect("a folder");
    let campaign = campaign();
    let words = ["reconcile", campaign.to_str().expect("text"), "--out", "out"];
    let mut command = command(here.path(), &words);
    let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("it runs");
    let begun = Instant::now();
    while !here.path().join("out/.armwright/lock").exists() && begun.elapsed() < Duration::from_secs(20) {
        std::thread::sleep(Duration::from_millis(2));
    }
    let pid = child.id().to_string();
    assert!(Command::new("kill").args(["-s", "TERM", &pid]).status().expect("sent").success());
    let output = child.wait_with_output().expect("it ends");
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(8), "{text}");
    assert!(text.contains("nothing was written") && !here.path().join("out").exists(), "{text}");
}

#[test]
fn a_record_of_progress_replaces_no_other_file() {
    let here = with_study();
    let text = fs::read(here.path().join("study.json")).expect("read");
    fs::write(here.path().join("notes.txt"), "mine").expect("written");
    let shard = ["run", "study.json", "--shard", "1/2", "--out", "part", "--progress"];
    let whole = ["run", "study.json", "--out", "out", "--progress"];
    for words in [&shard[..], &whole] {
        let with = |file| [words, &[file]].concat();
        fails(here.path(), &with("study.json"), 2, &["study.json is an input"]);
        fails(here.path(), &with("notes.txt"), 2, &["notes.txt is no record of progress"]);
        succeeds(here.path(), &with("progress.jsonl"));
    }
    fails(here.path(), &[&shard[..], &["part/shard.json"]].concat(), 2, &["part/shard.json is a file of"]);
    let new = ["run", "study.json", "--out", "new", "--progress", "new/front.csv"];
    fails(here.path(), &new, 2, &["new/front.csv is the place of a file of the result"]);
    assert_eq!(fs::read(here.path().join("study.json")).expect("read"), text);
    assert_eq!(fs::read(here.path().join("notes.txt")).expect("read"), b"mine");
}

#[test]
fn the_record_of_a_search_that_goes_on_keeps_its_lines() {
    if !has_faults() {
        return;
    }
    let here = with_study();
    let run = ["run", "study.json", "--search", "exhaustive", "--out", "out", "--progress", "p.jsonl"];
    assert_eq!(stopped_at(here.path(), "front", &run).0, 8);
    // what the stopped process wrote may be nothing, so a line stands for it
    let line = json!({"elapsed_s": 0.5, "designs": 1, "gap": null, "front_size": null, "boxes_open": null});
    fs::write(here.path().join("p.jsonl"), format!("{line}\n")).expect("written");
    assert!(succeeds(here.path(), &run).contains("goes on"));
    let record = || fs::read_to_string(here.path().join("p.jsonl")).expect("a record");
    assert!(record().starts_with(&format!("{line}\n")) && record().lines().count() > 1, "{}", record());
    succeeds(here.path(), &run);
    assert!(!record().contains(&line.to_string()), "a new search has a record of its own");
}

#[test]
fn a_verb_replaces_only_what_it_wrote() {
    let here = with_study();
    copy_of_campaign(&here.path().join("may"));
    let at = |name: &str| here.path().join(name);
    succeeds(here.path(), &["run", "study.json", "--out", "out"]);
    let front = fs::read_to_string(at("out/front.csv")).expect("a front");
    let ids: Vec<&str> = front.lines().skip(1).filter_map(|line| line.split(',').next()).collect();
    // design: another design replaces the first; an arm that somebody measured, or changed, is not replaced
    let arm = fs::read(at("may/arm.json")).expect("an arm");
    fails(here.path(), &["design", "out", ids[0], "--out", "may"], 2, &["arm.json"]);
    assert_eq!(fs::read(at("may/arm.json")).expect("an arm"), arm);
    succeeds(here.path(), &["design", "out", ids[0], "--out", "arm"]);
    succeeds(here.path(), &["design", "out", ids[1], "--out", "arm"]);
    fs::write(at("arm/cases.json"), "[]").expect("written");
    fails(here.path(), &["design", "out", ids[0], "--out", "arm"], 2, &["cases.json"]);
    // predict
    let measured = fs::read(at("may/modal.csv")).expect("readings");
    let predict = ["predict", "may/arm.json", "may/static.csv", "--campaign", "may/campaign.json", "--out"];
    fails(here.path(), &[&predict[..], &["may/modal.csv"]].concat(), 2, &["modal.csv is an input"]);
    fs::write(at("mine.csv"), "a,b\n1,2\n").expect("written");
    fails(here.path(), &[&predict[..], &["mine.csv"]].concat(), 2, &["mine.csv"]);
    assert_eq!(fs::read(at("may/modal.csv")).expect("readings"), measured);
    for _ in 0..2 {
        succeeds(here.path(), &[&predict[..], &["new.csv"]].concat());
    }
    // compare, export and man
    fs::create_dir(at("notes")).expect("made");
    for name in ["compare.md", "armwright.1", "export.json"] {
        fs::write(at("notes").join(name), "mine").expect("written");
    }
    let source = format!("out#{}", ids[0]);
    for (words, name) in [
        (&["compare", "out"][..], "compare.md"),
        (&["export", &source, "--to", "json"], "export.json"),
        (&["man"], "armwright.1"),
    ] {
        fails(here.path(), &[words, &["--out", "notes"]].concat(), 2, &[name]);
        assert_eq!(fs::read(at("notes").join(name)).expect("mine"), b"mine");
        for _ in 0..2 {
            succeeds(here.path(), &[words, &["--out", &format!("of-{name}")]].concat());
        }
    }
}

#[test]
fn options_of_a_search_are_refused_where_nothing_is_searched() {
    let here = tempfile::tempdir().expect("a folder");
    for option in [
        ["--shard", "1/2"],
        ["--effects", "none.json"],
        ["--gap", "1%"],
        ["--time-limit", "1"],
        ["--search", "exact"],
        ["--within", "1%"],
        ["--tolerance", "mass"],
        ["--mass-max-kg", "3"],
        ["--progress", "p.jsonl"],
    ] {
        fails(
            here.path(),
            &["run", "paper-table1", option[0], option[1]],
            2,
            &[option[0], "without a search"],
        );
    }
    assert_eq!(fs::read_dir(here.path()).expect("a folder").count(), 0);
    for verb in [&["size", "paper-table1"][..], &["slurm", "paper-table1", "--shards", "2"]] {
        fails(here.path(), verb, 2, &["is a study of the paper"]);
    }
}

#[test]
fn messages_name_their_limits() {
    let here = with_study();
    fails(here.path(), &["run", "study.json", "--shard", "1/1000000000"], 2, &["at most 100000"]);
    fails(here.path(), &["run", "study.json", "--mass-max-kg", "inf"], 2, &["finite"]);
    let script = |shards| succeeds(here.path(), &["slurm", "study.json", "--shards", shards]);
    assert!(script("1001").contains("MaxArraySize of at least 1002"), "{}", script("1001"));
    assert!(!script("1000").contains("MaxArraySize"));
    // a wrong command line is one object of the log too
    for words in [&["--log", "json", "run", "--nosuch"][..], &["run", "--log=json", "--nosuch"]] {
        let (code, text) = armwright(here.path(), words);
        let said: Value = serde_json::from_str(text.trim()).expect("one JSON object");
        assert_eq!((code, &said["event"], &said["exit_code"]), (2, &json!("error"), &json!(2)));
        assert!(
            said["message"].as_str().is_some_and(|words| words.starts_with("unexpected argument '--nosuch'"))
        );
    }
}

#[test]
fn a_study_may_have_a_name_without_ascii_letters() {
    let here = tempfile::tempdir().expect("a folder");
    fs::write(here.path().join("study.json"), study("腕", 3.0)).expect("written");
    succeeds(here.path(), &["run", "study.json"]);
    let names: Vec<_> = fs::read_dir(here.path().join("results")).expect("results").flatten().collect();
    assert!(names[0].file_name().to_string_lossy().starts_with("name-"), "{names:?}");
    fs::write(here.path().join("study.json"), study("--", 3.0)).expect("written");
    assert_eq!(armwright(here.path(), &["run", "study.json"]).0, 3);
}

#[test]
fn a_shard_that_is_asked_for_anew_begins_anew() {
    let here = with_study();
    let run = ["run", "study.json", "--shard", "1/1", "--out", "part"];
    succeeds(here.path(), &run);
    assert!(succeeds(here.path(), &run).contains("has this shard already"));
    assert!(!succeeds(here.path(), &[&run[..], &["--fresh"]].concat()).contains("already"));
}

#[test]
fn the_status_tells_running_stopped_and_missing_shards_apart() {
    let here = with_study();
    let at = |name: &str| here.path().join("parts").join(name);
    for part in ["1-of-4", "2-of-4"] {
        fs::create_dir_all(at(part).join(".armwright")).expect("made");
    }
    let lock = fs::File::create(at("1-of-4/.armwright/lock")).expect("made");
    lock.lock().expect("locked");
    let head = json!({"flags": {"search": "exhaustive", "shard": [2, 4]}});
    fs::write(at("2-of-4/.armwright/search.unfinished"), format!("{head}\n")).expect("written");
    let (running, stopped) = ("1/4  is running", "2/4  was stopped");
    let text = succeeds(here.path(), &["status", "parts"]);
    assert!(["no shard is finished", running, stopped].iter().all(|w| text.contains(w)), "{text}");
    succeeds(here.path(), &["run", "study.json", "--shard", "3/4", "--out", "parts/3-of-4"]);
    let text = succeeds(here.path(), &["status", "parts"]);
    assert!(["1 of 4 shards", running, stopped].iter().all(|w| text.contains(w)), "{text}");
    let listed = ["--shard 1/4", "--shard 2/4", "--shard 4/4"].map(|words| text.contains(words));
    assert_eq!(listed, [false, true, true], "{text}");
    drop(lock);
    assert!(!succeeds(here.path(), &["status", "parts"]).contains("is running"));
}

#[test]
fn shards_and_results_inside_a_result_are_compared_like_others() {
    let here = with_study();
    for parts in ["a", "b"] {
        let out = format!("{parts}/1-of-1");
        succeeds(here.path(), &["run", "study.json", "--shard", "1/1", "--out", &out]);
    }
    assert!(succeeds(here.path(), &["check", "--same", "a", "b"]).contains("3 files are the same"));
    let file = here.path().join("b/1-of-1/candidates.csv");
    let text = fs::read_to_string(&file).expect("candidates");
    fs::write(&file, format!("{text}\n")).expect("written");
    fails(here.path(), &["check", "--same", "a", "b"], 9, &["candidates.csv differs"]);
    for empty in ["c", "d"] {
        fs::create_dir(here.path().join(empty)).expect("made");
    }
    fails(here.path(), &["check", "--same", "c", "d"], 7, &["no files to compare"]);
    // a campaign with its study: two that differ in times and in hashes of files with times
    let write = |name: &str, second: f64| {
        let at = here.path().join(name).join("study/nominal");
        fs::create_dir_all(&at).expect("made");
        let run =
            json!({"study": "short", "elapsed_s": second, "files": {"summary.md": format!("{second}")}});
        fs::write(at.join("run.json"), run.to_string()).expect("written");
        let words = format!(
            "# short\n<!-- timing -->{second} s<!-- /timing -->\narmwright compare {name}/study/nominal\n"
        );
        fs::write(at.join("summary.md"), words).expect("written");
        let verdict =
            json!({"verdict": "explained", "files": {"study/nominal/run.json": format!("{second}")}});
        fs::write(here.path().join(name).join("verdict.json"), verdict.to_string()).expect("written");
    };
    write("may", 1.0);
    write("june", 2.0);
    succeeds(here.path(), &["check", "--same", "may", "june"]);
    let other = json!({"verdict": "no_gap", "files": {}});
    fs::write(here.path().join("june/verdict.json"), other.to_string()).expect("written");
    fails(here.path(), &["check", "--same", "may", "june"], 9, &["verdict.json differs"]);
}
