//! A search that was stopped or killed, or whose disk was full, continues with the same command. Its result has the
//! same bytes as that of a search without interruption.
//!
//! `ARMWRIGHT_KILLS=50` sets the number of random moments at which the search is killed; the default is 5.

use crate::running::{command, has_faults, said};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Walls of each tube: few enough that a debug build needs a second or so, and many enough for several states.
const EXHAUSTIVE: u32 = 24;
const EXACT: u32 = 8;

/// A study of two links and two joints with so many walls of each tube; its designs are visited in a second or so.
fn study(name: &str, walls: u32) -> String {
    let tube = |from: u32| -> Value {
        let walls: Vec<f64> = (0..walls).map(|n| 2.0 + 0.01 * f64::from(n)).collect();
        json!({"materials": ["Structural steel S355", "Aluminium 6061-T6"],
            "sections": [{"shape": "round_tube", "diameter_mm": [from, from + 10, from + 30], "wall_mm": walls}]})
    };
    let joint = |name: &str| -> Value {
        json!({"type": "joint", "name": name, "axis": [0, 1, 0], "drive": "all_fits",
            "drives": {"gears": ["CSG-32-100", "CSG-40-100"], "motor_models": ["ILM85x26"]}})
    };
    json!({"name": name, "chain": [
        joint("shoulder"), {"type": "link", "name": "upper", "vector_m": [0.5, 0, 0], "choose": tube(60)},
        joint("elbow"), {"type": "link", "name": "fore", "vector_m": [0.4, 0, 0], "choose": tube(50)}],
        "payload": {"mass_kg": 3}, "poses": [{"pose_deg": [0, 0]}, {"pose_deg": [-40, 90]}]})
    .to_string()
}

fn succeeds(folder: &Path, words: &[&str]) -> String {
    let (code, text) = said(&mut command(folder, words));
    assert_eq!(code, 0, "{words:?}: {text}");
    text
}

const GOES_ON: &str = "goes on where an earlier run was";

fn run(search: &str) -> [&str; 6] {
    ["run", "study.json", "--search", search, "--out", "out"]
}

/// A folder with a study and the result of a search that was not stopped, in `whole`.
fn searched(search: &str, walls: u32) -> tempfile::TempDir {
    let here = tempfile::tempdir().expect("a folder");
    fs::write(here.path().join("study.json"), study("short arm", walls)).expect("written");
    succeeds(here.path(), &[&run(search)[..5], &["whole"]].concat());
    here
}

/// The result is that of a search that was not stopped, and nothing of the search is left.
fn is_whole(here: &Path) {
    succeeds(here, &["check", "--same", "whole", "out"]);
    assert!(!here.join("out/.armwright").exists(), "the state is still there");
}

/// A search that keeps its state whenever it looks.
fn keeping(here: &Path, search: &str) -> Command {
    let mut command = command(here, &run(search));
    command.env("ARMWRIGHT_KEEP_EVERY_MS", "0");
    command
}

#[test]
fn a_search_that_dies_at_any_step_of_keeping_its_state_goes_on_to_the_same_bytes() {
    if !has_faults() {
        return;
    }
    for (search, walls) in [("exhaustive", EXHAUSTIVE), ("exact", EXACT)] {
        let here = searched(search, walls);
        let (mut died, mut went_on) = (0, 0);
        // the first steps make the folder; then each state is three steps, and each process dies at another of them
        for step in [2, 4, 5, 6, 8] {
            let mut command = keeping(here.path(), search);
            let (code, text) = said(command.env("ARMWRIGHT_FAULT", format!("kill:{step}")));
            assert!(code == -1 || code == 0, "{search}, step {step}: {text}");
            died += usize::from(code == -1);
            went_on += usize::from(text.contains(GOES_ON));
        }
        assert!(died == 5 && went_on >= 3, "{search}: {died} died, {went_on} went on");
        succeeds(here.path(), &run(search));
        is_whole(here.path());
    }
}

#[test]
fn a_disk_that_fills_while_a_state_is_kept_ends_no_search() {
    if !has_faults() {
        return;
    }
    let here = searched("exhaustive", EXHAUSTIVE);
    // every write fails: the search ends, and says that its result cannot be written
    let (code, text) = said(keeping(here.path(), "exhaustive").env("ARMWRIGHT_FAULT", "full:1"));
    assert!(code == 7 && text.contains("the search goes on, but a run after this one"), "{text}");
    // from the second state on; what the first one has is not searched again
    let (code, text) = said(keeping(here.path(), "exhaustive").env("ARMWRIGHT_FAULT", "full:5"));
    assert_eq!(code, 7, "{text}");
    assert!(succeeds(here.path(), &run("exhaustive")).contains(GOES_ON));
    is_whole(here.path());
}

/// The same with a real disk that has no room left.
#[test]
fn a_small_disk_that_fills_while_states_are_kept_ends_no_search() {
    let here = searched("exhaustive", EXHAUSTIVE);
    let disk = here.path().join("disk");
    fs::create_dir(&disk).expect("made");
    let mount = |words: &[&str]| Command::new(words[0]).args(&words[1..]).arg(&disk).output();
    let mounted = mount(&["mount", "-t", "tmpfs", "-o", "size=4096k", "none"]);
    if !mounted.is_ok_and(|output| output.status.success()) {
        eprintln!("SKIPPED a full disk: this test may not mount one");
        return;
    }
    let tried = std::panic::catch_unwind(|| {
        let words = ["run", "study.json", "--search", "exhaustive", "--out", "disk/out"];
        // room for a folder and a lock, and for some states or none, but not for the result
        let filler = fs::write(disk.join("filler"), vec![0u8; 4072 << 10]);
        assert!(filler.is_ok(), "{filler:?}");
        let mut command = command(here.path(), &words);
        let (code, text) = said(command.env("ARMWRIGHT_KEEP_EVERY_MS", "0"));
        assert!(code == 7 && text.contains("No space left"), "{code} {text}");
        let went_on = text.contains("the search goes on, but a run after this one");
        fs::remove_file(disk.join("filler")).expect("removed");
        let text = succeeds(here.path(), &words);
        eprintln!("a state did not fit: {went_on}; the next run went on: {}", text.contains(GOES_ON));
        assert!(went_on || text.contains(GOES_ON), "no state was tried: {text}");
        // the page names its folder, so that the fronts are compared
        let [whole, again] = ["whole", "disk/out"]
            .map(|dir| fs::read(here.path().join(dir).join("front.csv")).expect("a front"));
        assert!(whole == again, "another front");
    });
    std::thread::sleep(Duration::from_millis(10));
    mount(&["umount"]).expect("unmounted");
    tried.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
}

/// Faults that the system makes and not the program: renames that fail.
#[test]
fn a_rename_that_the_system_refuses_loses_nothing() {
    let can = Command::new("strace")
        .args(["-f", "-o", "/dev/null", "-e", "inject=rename:error=EIO:when=1", "true"])
        .status();
    if !can.is_ok_and(|status| status.success()) {
        eprintln!("SKIPPED faults made by the system: no strace that may trace here");
        return;
    }
    let here = searched("exact", EXACT);
    for fault in ["error=EIO:when=1+", "error=ENOSPC:when=2+"] {
        let inject = format!("inject=rename,renameat,renameat2:{fault}");
        let mut command = Command::new("strace");
        command.args([
            "-f",
            "--seccomp-bpf",
            "-o",
            "/dev/null",
            "-e",
            "trace=rename,renameat,renameat2",
            "-e",
            &inject,
        ]);
        command.arg(env!("CARGO_BIN_EXE_armwright")).args(run("exact"));
        let (code, text) = said(command.current_dir(here.path()).env("ARMWRIGHT_KEEP_EVERY_MS", "0"));
        assert_eq!(code, 7, "{fault}: {text}");
        assert!(!here.path().join("out/run.json").exists(), "{fault}: half a result");
    }
    succeeds(here.path(), &run("exact"));
    is_whole(here.path());
}

#[test]
fn another_study_in_the_same_folder_is_refused_until_it_is_asked_for_anew() {
    if !has_faults() {
        return;
    }
    let here = searched("exhaustive", EXHAUSTIVE);
    said(keeping(here.path(), "exhaustive").env("ARMWRIGHT_FAULT", "kill:7"));
    let state = here.path().join("out/.armwright/search.unfinished");
    let kept = fs::read(&state).expect("a state");
    let (code, text) = said(&mut command(here.path(), &run("exact")));
    assert!(code == 2 && text.contains("another search") && text.contains("--fresh"), "{code} {text}");
    fs::write(here.path().join("study.json"), study("short arm", EXHAUSTIVE - 1)).expect("written");
    let (code, text) = said(&mut command(here.path(), &run("exhaustive")));
    assert!(code == 2 && text.contains("another study"), "{code} {text}");
    assert_eq!(fs::read(&state).expect("still there"), kept);
    // a byte that changed is found
    fs::write(here.path().join("study.json"), study("short arm", EXHAUSTIVE)).expect("written");
    let mut damaged = kept.clone();
    *damaged.last_mut().expect("a byte") ^= 1;
    fs::write(&state, damaged).expect("written");
    let (code, text) = said(&mut command(here.path(), &run("exhaustive")));
    assert!(code == 7 && text.contains("damaged"), "{code} {text}");
    let text = succeeds(here.path(), &[&run("exhaustive")[..], &["--fresh"]].concat());
    assert!(!text.contains(GOES_ON), "{text}");
    is_whole(here.path());
}

#[test]
fn a_shard_goes_on_too() {
    if !has_faults() {
        return;
    }
    let here = searched("exhaustive", EXHAUSTIVE);
    for part in ["1/2", "2/2"] {
        let out = format!("parts/{}", &part[..1]);
        let words = ["run", "study.json", "--shard", part, "--out", &out];
        let mut dies = command(here.path(), &words);
        dies.env("ARMWRIGHT_KEEP_EVERY_MS", "0").env("ARMWRIGHT_FAULT", "kill:6");
        assert_eq!(said(&mut dies).0, -1);
        assert!(succeeds(here.path(), &words).contains(GOES_ON));
        assert!(!here.path().join(out).join(".armwright").exists());
    }
    succeeds(here.path(), &["merge", "parts", "--out", "out"]);
    is_whole(here.path());
}

#[test]
fn a_shard_of_an_exact_search_goes_on_too() {
    if !has_faults() {
        return;
    }
    let here = searched("exact", EXACT);
    for part in ["1/2", "2/2"] {
        let out = format!("parts/{}", &part[..1]);
        let words = ["run", "study.json", "--search", "exact", "--shard", part, "--out", &out];
        let mut dies = command(here.path(), &words);
        dies.env("ARMWRIGHT_KEEP_EVERY_MS", "0").env("ARMWRIGHT_FAULT", "kill:8");
        assert_eq!(said(&mut dies).0, -1);
        assert!(succeeds(here.path(), &words).contains(GOES_ON));
        assert!(!here.path().join(out).join(".armwright").exists());
    }
    succeeds(here.path(), &["merge", "parts", "--out", "out"]);
    for front in ["front.csv", "front.aluminium-6061-t6.csv"] {
        let [whole, joined] =
            ["whole", "out"].map(|dir| fs::read(here.path().join(dir).join(front)).expect("a front"));
        assert!(whole == joined, "another {front}");
    }
}

#[test]
fn a_check_that_is_killed_goes_on_to_the_same_words() {
    if !has_faults() {
        return;
    }
    let here = searched("exact", 2);
    let check = ["front", "check", "whole"];
    let whole = succeeds(here.path(), &check);
    // the first process dies before a state is in its place, the second after that, the third after the next one
    for (step, goes_on) in [(2, false), (4, false), (3, true)] {
        let mut command = command(here.path(), &check);
        command.env("ARMWRIGHT_KEEP_EVERY_MS", "0").env("ARMWRIGHT_FAULT", format!("kill:{step}"));
        let (code, text) = said(&mut command);
        assert_eq!((code, text.contains(GOES_ON)), (-1, goes_on), "step {step}: {text}");
    }
    let text = succeeds(here.path(), &check);
    assert!(text.contains(GOES_ON), "{text}");
    let words = text.lines().filter(|line| !line.contains(GOES_ON)).collect::<Vec<_>>().join("\n");
    assert_eq!(words.trim(), whole.trim(), "boxes that were bounded before count once");
    assert!(!here.path().join("whole/.armwright").exists(), "the state is still there");
    // the state of a check of another front is not used
    let mut dies = command(here.path(), &check);
    assert_eq!(said(dies.env("ARMWRIGHT_KEEP_EVERY_MS", "0").env("ARMWRIGHT_FAULT", "kill:4")).0, -1);
    succeeds(here.path(), &["run", "study.json", "--search", "exact", "--gap", "5%", "--out", "other"]);
    fs::create_dir(here.path().join("other/.armwright")).expect("made");
    let state = |dir: &str| here.path().join(dir).join(".armwright/check.unfinished");
    fs::copy(state("whole"), state("other")).expect("a state");
    let text = succeeds(here.path(), &["front", "check", "other"]);
    assert!(!text.contains(GOES_ON) && !state("other").exists(), "{text}");
}

fn spawn(command: &mut Command) -> Child {
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("it runs")
}

#[cfg(unix)]
#[test]
fn a_signal_is_answered_within_a_second_and_what_was_found_is_kept() {
    for (search, walls, signal) in [("exhaustive", 400, "INT"), ("exact", 400, "TERM")] {
        let here = tempfile::tempdir().expect("a folder");
        fs::write(here.path().join("study.json"), study("short arm", walls)).expect("written");
        let mut child = spawn(&mut command(here.path(), &run(search)));
        std::thread::sleep(Duration::from_millis(1500));
        let sent = Instant::now();
        let pid = child.id().to_string();
        assert!(Command::new("kill").args(["-s", signal, &pid]).status().expect("sent").success());
        let code = child.wait().expect("an end").code();
        let took = sent.elapsed();
        assert_eq!(code, Some(8), "{search}");
        // a build for tests is slower than what a user has, who waits for less than a second, and other tests run beside this one
        assert!(took < Duration::from_secs(20), "{search}: {took:?}");
        eprintln!("{search}: answered after {took:?}");
        if !here.path().join("out/run.json").exists() {
            eprintln!("{search}: nothing was found in this time");
            continue;
        }
        let (code, text) = said(&mut command(here.path(), &["front", "check", "out", "--time-limit", "1"]));
        assert!(code == 0 || code == 11, "{search}: {code} {text}");
    }
}

/// Numbers that look random and are the same each time.
fn moments() -> impl Iterator<Item = u64> {
    (1u64..).map(|n| n.wrapping_mul(6_364_136_223_846_793_005).rotate_left(29) % 1000)
}

#[test]
fn searches_that_are_killed_at_random_moments_go_on_to_the_same_bytes() {
    let kills = std::env::var("ARMWRIGHT_KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(5);
    let mut moments = moments();
    for (search, walls) in [("exhaustive", EXHAUSTIVE), ("exact", EXACT)] {
        let here = searched(search, walls);
        let (mut killed, mut went_on) = (0, 0);
        for moment in moments.by_ref().take(kills) {
            let mut command = keeping(here.path(), search);
            let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn();
            let mut child = child.expect("it runs");
            std::thread::sleep(Duration::from_millis(moment * 2 / 3));
            child.kill().expect("killed");
            let output = child.wait_with_output().expect("an end");
            killed += usize::from(output.status.code().is_none());
            went_on += usize::from(String::from_utf8_lossy(&output.stderr).contains(GOES_ON));
        }
        eprintln!("{search}: {killed} of {kills} killed, {went_on} went on");
        succeeds(here.path(), &run(search));
        is_whole(here.path());
    }
}
