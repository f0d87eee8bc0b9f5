//! Results have the same bytes on processors with and without fused multiply-add and wide registers. The tests run the
//! program directly and in an emulator of an old processor.

use crate::front_check::STUDY;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A processor of 2008: no AVX and no fused multiply-add.
const OLD: &str = "Nehalem";

/// The emulator; `None`, said aloud, where there is none or where this is no x86-64 Linux.
fn emulator() -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let found =
        std::env::split_paths(&path).map(|folder| folder.join("qemu-x86_64")).find(|file| file.is_file());
    let usable = cfg!(all(target_arch = "x86_64", target_os = "linux"));
    if found.is_none() || !usable {
        eprintln!(
            "SKIPPED the same bytes without fused multiply-add: needs x86-64 Linux and qemu-x86_64 (apt-get install qemu-user)"
        );
    }
    found.filter(|_| usable)
}

/// Runs the program with these words on this processor and on the old one, and compares a file that each writes.
fn same_file(words: &[&str], file: &str) {
    let Some(emulator) = emulator() else { return };
    let here = tempfile::tempdir().expect("a folder");
    std::fs::write(here.path().join("study.json"), STUDY).expect("written");
    let program = Path::new(env!("CARGO_BIN_EXE_armwright"));
    let run = |command: &mut Command, out: &str| {
        let output =
            command.current_dir(here.path()).args(words).args(["--out", out]).output().expect("it runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        std::fs::read(here.path().join(out).join(file)).expect("a file")
    };
    let native = run(&mut Command::new(program), "native");
    let emulated = run(Command::new(emulator).args(["-cpu", OLD]).arg(program), "emulated");
    assert!(native == emulated, "{file} of {words:?} has other bytes on an old processor");
}

#[test]
fn the_front_of_an_exact_search_has_the_same_bytes_without_fused_multiply_add() {
    same_file(&["run", "study.json", "--gap", "0"], "front.csv");
}

#[test]
fn the_front_of_a_sweep_has_the_same_bytes_without_fused_multiply_add() {
    // a study of so few designs is searched by visiting them all
    same_file(&["run", "study.json"], "front.csv");
}

#[test]
fn a_verdict_has_the_same_bytes_without_fused_multiply_add() {
    let campaign = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/dial_gauge/full_conn");
    same_file(&["reconcile", campaign.to_str().expect("a name")], "verdict.json");
}
