//! Other programs, CalculiX and MuJoCo, find the same torques, deflections and frequencies, where they are installed.
//! The comparisons are scripts in `tests/interchange`.

use crate::interchange::{ROBOTS, SCARA, project, urdf};
use std::process::Command;

/// A Python that has MuJoCo: `ARMWRIGHT_PYTHON`, that of `scripts/test`, or the system's.
fn python() -> Option<String> {
    let own = project().join("target/mujoco/bin/python").display().to_string();
    let candidates = [std::env::var("ARMWRIGHT_PYTHON").ok(), Some(own), Some("python3".into())];
    candidates.into_iter().flatten().find(|python| {
        Command::new(python)
            .args(["-c", "import mujoco, numpy"])
            .output()
            .is_ok_and(|output| output.status.success())
    })
}

/// Runs a comparison of `tests/interchange`.
fn compared(python: &str, script: &str, words: &[&str]) {
    let folder = tempfile::tempdir().expect("a folder");
    let output = Command::new(python)
        .arg(project().join("tests/interchange").join(script))
        .args([env!("CARGO_BIN_EXE_armwright"), &folder.path().display().to_string()])
        .args(words)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .output()
        .expect("it runs");
    let said = String::from_utf8_lossy(&output.stdout);
    println!("{said}");
    assert!(output.status.success(), "{script}:\n{said}{}", String::from_utf8_lossy(&output.stderr));
    assert!(said.lines().count() > 0, "{script} compared nothing");
}

#[test]
fn mujoco_finds_the_torques_deflections_and_frequencies_of_exported_arms() {
    match python() {
        Some(python) => compared(&python, "mujoco_export.py", &[]),
        None => eprintln!("SKIPPED: no Python with mujoco (set ARMWRIGHT_PYTHON)"),
    }
}

#[test]
fn mujoco_finds_the_torques_of_imported_robots() {
    let all = ROBOTS.iter().chain(&[SCARA]);
    let robots: Vec<String> = all.map(|(name, tip)| format!("{}:{tip}", urdf(name).display())).collect();
    let robots: Vec<&str> = robots.iter().map(String::as_str).collect();
    match python() {
        Some(python) => compared(&python, "mujoco_import.py", &robots),
        None => eprintln!("SKIPPED: no Python with mujoco (set ARMWRIGHT_PYTHON)"),
    }
}

#[test]
fn calculix_finds_the_deflections_and_frequencies_of_exported_arms() {
    let has = |program: &str| Command::new(program).arg("-v").output().is_ok();
    if !has("ccx") || !has("python3") {
        return eprintln!("SKIPPED: no ccx or no python3 on the PATH");
    }
    // all arms take a minute or more: ARMWRIGHT_CALCULIX=all
    match std::env::var("ARMWRIGHT_CALCULIX").as_deref() {
        Ok("all") => compared("python3", "calculix.py", &[]),
        _ => compared("python3", "calculix.py", &["linkage", "bodies", "driver outboard"]),
    }
}
