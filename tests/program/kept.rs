//! Finished results are never lost: the terminal may be closed, a page may be impossible to make, and an output may
//! have the path of an input.

use crate::running::{command, has_faults, said};
use crate::whole_results::study;
use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Stdio};

fn folder_with_study() -> tempfile::TempDir {
    let here = tempfile::tempdir().expect("a folder");
    fs::write(here.path().join("study.json"), study("new", 3.0)).expect("written");
    here
}

/// A device that is always full, on systems that have one.
fn full() -> Option<Stdio> {
    let device = File::options().write(true).open("/dev/full");
    if device.is_err() {
        eprintln!("SKIPPED a full terminal: this system has no /dev/full");
    }
    device.ok().map(Stdio::from)
}

#[test]
fn a_run_whose_standard_error_is_full_or_closed_keeps_its_result() {
    let here = folder_with_study();
    let Some(full) = full() else { return };
    let words = ["run", "study.json", "--search", "exact", "--out", "out"];
    let status = command(here.path(), &words).stderr(full).status().expect("it runs");
    assert_eq!(status.code(), Some(0));
    assert!(here.path().join("out/front.csv").exists());
    let program = env!("CARGO_BIN_EXE_armwright");
    let closed = format!("'{program}' run study.json --out closed 2>&-");
    let output = Command::new("sh").args(["-c", &closed]).current_dir(here.path()).output().expect("it runs");
    assert_eq!(output.status.code(), Some(0));
    assert!(here.path().join("closed/front.csv").exists());
}

#[test]
fn standard_output_that_cannot_be_written_is_an_error_of_verbs_that_print_much_or_little() {
    let here = folder_with_study();
    let verbs: [&[&str]; 7] = [
        &["size", "study.json", "--json"],
        &["studies"],
        &["catalog", "show", "motors"],
        &["catalog", "check"],
        &["run", "study.json", "--out", "out"],
        &["--help"],
        &["--version"],
    ];
    for words in verbs {
        let Some(full) = full() else { return };
        let output = command(here.path(), words).stdout(full).output().expect("it runs");
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(7), "{words:?}: {text}");
    }
    // what the run found is kept all the same
    assert!(here.path().join("out/run.json").exists());
}

/// Where standard output is closed before the program begins, its run-time library opens `/dev/null` in that place, so that
/// no file of a result can get its number. So a closed output is one that throws away, and no error.
#[cfg(unix)]
#[test]
fn a_standard_output_that_was_closed_throws_away_and_no_text_gets_into_a_result() {
    let here = folder_with_study();
    let script = r#""$0" run study.json --out closed >&- && "$0" studies >&- 2>&- <&-"#;
    let output = std::process::Command::new("sh")
        .args(["-c", script, env!("CARGO_BIN_EXE_armwright")])
        .current_dir(here.path())
        .output()
        .expect("a shell");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(command(here.path(), &["check", "closed"]).status().expect("it runs").code(), Some(0));
    assert_eq!(
        command(here.path(), &["run", "study.json", "--out", "open"]).output().expect("runs").status.code(),
        Some(0)
    );
    let same = ["check", "--same", "closed", "open"];
    assert_eq!(command(here.path(), &same).status().expect("it runs").code(), Some(0));
}

#[test]
fn a_piece_that_cannot_be_made_costs_no_other_and_is_named() {
    if !has_faults() {
        return;
    }
    let here = folder_with_study();
    let pieces = [
        ("summary.md", "summary.md"),
        ("front.svg", "front.svg"),
        ("budget.csv", "budget.csv"),
        ("report.html and plots", "report.html"),
        ("what was asked for in addition to the front", "none.csv"),
    ];
    for (piece, file) in pieces {
        let mut run = command(here.path(), &["run", "study.json", "--out", "out"]);
        let (code, text) = said(run.env("ARMWRIGHT_FAULT", format!("panic:{piece}")));
        assert_eq!(code, 0, "{text}");
        assert!(text.contains(&format!("warning: not written: {piece}: internal error")), "{piece}: {text}");
        assert!(!here.path().join("out").join(file).exists(), "{piece}");
        let run = fs::read_to_string(here.path().join("out/run.json")).expect("a run");
        assert!(run.contains(&format!("\"{piece}: internal error")), "{piece}: {run}");
        let (code, text) = said(&mut command(here.path(), &["front", "check", "out"]));
        assert_eq!(code, 0, "{piece}: {text}");
    }
}

#[test]
fn an_input_is_never_overwritten() {
    let here = tempfile::tempdir().expect("a folder");
    let campaign = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/measured-arm");
    for name in ["campaign.json", "arm.json", "static.csv"] {
        fs::copy(campaign.join(name), here.path().join(name)).expect("copied");
    }
    fs::create_dir(here.path().join("sub")).expect("made");
    let before = fs::read(here.path().join("static.csv")).expect("readings");
    // the same file by another path
    let words =
        ["predict", "arm.json", "static.csv", "--campaign", "campaign.json", "--out", "sub/../static.csv"];
    let (code, text) = said(&mut command(here.path(), &words));
    assert_eq!(code, 2, "{text}");
    assert!(text.contains("is an input of this command"), "{text}");
    assert_eq!(fs::read(here.path().join("static.csv")).expect("readings"), before);
    let (code, text) = said(&mut command(here.path(), &[&words[..6], &["out.csv"]].concat()));
    assert_eq!(code, 0, "{text}");
    // a study in a folder of results, asked for with another limit
    fs::write(here.path().join("study.json"), study("new", 3.0)).expect("written");
    assert_eq!(said(&mut command(here.path(), &["run", "study.json", "--out", "out"])).0, 0);
    let again = ["run", "out/study.json", "--out", "out"];
    assert_eq!(said(&mut command(here.path(), &again)).0, 0, "the same study");
    let (code, text) = said(&mut command(here.path(), &[&again[..], &["--mass-max-kg", "100"]].concat()));
    assert_eq!(code, 2, "{text}");
    let (code, text) = said(&mut command(here.path(), &[&again[..], &["--progress", "study.json"]].concat()));
    assert!(code == 2 && text.contains("study.json is no record of progress"), "{text}");
    let (code, text) =
        said(&mut command(here.path(), &[&again[..], &["--progress", "out/study.json"]].concat()));
    assert_eq!(code, 2, "{text}");
    // a file of a result is no place for another verb's output
    let (code, text) = said(&mut command(here.path(), &["compare", "out", "--out", "out"]));
    assert_eq!(code, 2, "{text}");
    assert!(text.contains("report.html is a file of the result"), "{text}");
}

#[cfg(unix)]
#[test]
fn files_have_the_permissions_of_umask() {
    use std::os::unix::fs::PermissionsExt;
    let here = folder_with_study();
    let program = env!("CARGO_BIN_EXE_armwright");
    for (umask, expected) in [("022", 0o644), ("027", 0o640)] {
        let script = format!(
            "umask {umask} && '{program}' run study.json --out {umask} && '{program}' design {umask} x0 --out {umask}-x0"
        );
        let output =
            Command::new("sh").args(["-c", &script]).current_dir(here.path()).output().expect("it runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        for file in ["front.csv", "run.json", "report.html", "plots/front.svg", "../x0/arm.json"] {
            let file = here.path().join(umask).join(file.replace("../x0", &format!("../{umask}-x0")));
            let mode = fs::metadata(&file).expect("a file").permissions().mode() & 0o777;
            assert_eq!(mode, expected, "{}", file.display());
        }
    }
}
