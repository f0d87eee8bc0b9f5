//! The arms of `examples/arms` run as docs/example-arms.md says, with the answers that stand there.

use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// Runs a study of `examples/arms`, with the parts that stand beside it if it has any, and returns `run.json` and the summary.
fn run(study: &str, parts: Option<&str>) -> (Value, String) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/arms");
    let out = tempfile::tempdir().expect("a folder");
    let mut command = Command::new(env!("CARGO_BIN_EXE_armwright"));
    command.arg("run").arg(root.join(study)).arg("--out").arg(out.path());
    if let Some(parts) = parts {
        command.arg("--catalogs").arg(root.join(parts));
    }
    let output = command.output().expect("the program starts");
    assert!(output.status.success(), "{study}: {}", String::from_utf8_lossy(&output.stderr));
    let read = |name: &str| std::fs::read_to_string(out.path().join(name)).expect("written");
    (serde_json::from_str(&read("run.json")).expect("JSON"), read("summary.md"))
}

/// The answer on the page: the sentence in bold of the section of this example.
fn answer(section: &str) -> String {
    let page = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/example-arms.md"))
        .expect("a page");
    let from = page.find(&format!("## {section}\n")).expect("a section");
    let text = page[from..].split("**").nth(1).expect("an answer in bold");
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Asserts that the answer has each figure of the picks as the summary prints it.
fn answers(section: &str, run: &Value, summary: &str, designs: u64) {
    assert_eq!(run["designs_total"].as_u64(), Some(designs), "{section}");
    let line = summary.lines().find(|line| line.starts_with("| lightest")).expect("a lightest pick");
    let kg = line.split('|').nth(3).expect("a mass").trim();
    let answer = answer(section);
    assert!(answer.contains(&format!("{kg} kg")), "{section}: {kg} kg is not in \"{answer}\"");
}

#[test]
fn the_cobot_is_made_of_integrated_actuators() {
    let (run, summary) = run("cobot.json", Some("cobot-parts"));
    answers("A cobot of integrated actuators", &run, &summary, 2000);
}

#[test]
fn the_printed_arm_has_steppers_with_planetary_gears() {
    let (run, summary) = run("printed.json", Some("printed-parts"));
    answers("A printed arm with steppers", &run, &summary, 1296);
    assert!(summary.contains("creeps"), "{summary}");
}

#[test]
fn the_palletizer_is_lighter_with_its_gas_spring() {
    let (run, summary) = run("palletizer.json", None);
    answers("A palletizer with a gas spring", &run, &summary, 16);
    assert!(summary.contains("stiffness that they add to modes is left out"), "{summary}");
}

#[test]
fn the_gantry_is_as_stiff_as_its_guides_and_its_wrist() {
    let (run, summary) = run("gantry.json", None);
    answers("A gantry with a wrist", &run, &summary, 48);
}
