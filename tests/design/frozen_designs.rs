//! Designs that were found before output bearings were modelled, frozen with their cases: `stiff-arm` 39n20 and
//! `compare-materials` 44m0k. Their files name housed gears and no bearing, so the catalog's bearings count.
//!
//! The tip deflections with bearings were worked out from the design files by another program: each bearing tilts by the
//! moment across its axis over the catalog's tilting stiffness (Harmonic Drive AG, engineering data SHG-2UH 1021387, page 45).
//! They have four decimals, so that the two programs must agree to 1e-4 mm.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

fn frozen(design: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/frozen").join(design)
}

/// Largest norm of the tip displacement over the cases of a design \[mm\].
fn tip_deflection_mm(arm: &Path, cases: &Path) -> f64 {
    let mut command = Command::new(env!("CARGO_BIN_EXE_armwright"));
    let output = command.arg("analyze").arg(arm).arg("--cases").arg(cases).arg("--json").output();
    let output = output.expect("runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let answers: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let norm_m = |case: &Value| -> f64 {
        let components = case["tip_displacement_m"].as_array().expect("a vector");
        components.iter().map(|x| x.as_f64().expect("a number").powi(2)).sum::<f64>().sqrt()
    };
    let answers = answers.as_array().expect("a list").iter();
    1e3 * answers.map(norm_m).fold(0.0, f64::max)
}

#[test]
fn frozen_designs_tilt_in_the_bearings_of_their_gears() {
    for (design, expected_mm) in [("39n20", 4.3375), ("44m0k", 4.3874)] {
        let dir = frozen(design);
        let found_mm = tip_deflection_mm(&dir.join("arm.json"), &dir.join("cases.json"));
        assert!((found_mm - expected_mm).abs() < 1e-4, "{design}: {found_mm} mm, not {expected_mm} mm");
    }
}

#[test]
fn frozen_designs_deflect_as_they_did_where_their_bearings_are_stated_rigid() {
    for (design, expected_mm) in [("39n20", 1.029278541463723), ("44m0k", 2.9532174002276994)] {
        let dir = frozen(design);
        let text = std::fs::read_to_string(dir.join("arm.json")).expect("an arm");
        let mut arm: Value = serde_json::from_str(&text).expect("JSON");
        for element in arm["chain"].as_array_mut().expect("a chain") {
            if element["type"] == "joint" {
                element["bearing"] = Value::Null;
            }
        }
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("arm.json");
        std::fs::write(&file, arm.to_string()).expect("written");
        let found_mm = tip_deflection_mm(&file, &dir.join("cases.json"));
        assert!(
            (found_mm / expected_mm - 1.0).abs() < 1e-12,
            "{design}: {found_mm} mm, not {expected_mm} mm"
        );
    }
}
