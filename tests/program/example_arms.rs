//! The arms of `examples/arms` must run as docs/example-arms.md says, with the results that are written there.

use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// Runs a study of `examples/arms`, with the parts that stand beside it if it has any, and returns `run.json` and the summary.
fn run(study: &str, parts: Option<&str>) -> (Value, String) {
    let [run, summary, _] = run_with_budget(study, parts);
    (serde_json::from_str(&run).expect("JSON"), summary)
}

/// As [`run`], with `budget.csv` too.
fn run_with_budget(study: &str, parts: Option<&str>) -> [String; 3] {
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
    ["run.json", "summary.md", "budget.csv"].map(read)
}

/// Percentages of the deflection of the knee, by piece.
fn shares_at_knee(budget: &str) -> Vec<(String, f64)> {
    let mut table = csv::Reader::from_reader(budget.as_bytes());
    let header = table.headers().expect("a header").clone();
    let column = |name: &str| header.iter().position(|c| c == name).expect("the column");
    let rows = table.records().map(|row| row.expect("a row"));
    rows.filter(|row| row[column("pick")].contains("knee"))
        .map(|row| {
            let share: f64 = row[column("share_of_deflection")].parse().expect("a number");
            (row[column("piece")].to_string(), 100.0 * share)
        })
        .collect()
}

/// The page in one line.
fn page() -> String {
    let page = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/example-arms.md"))
        .expect("a page");
    page.split_whitespace().collect::<Vec<_>>().join(" ")
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
    let [run, summary, budget] = run_with_budget("cobot.json", Some("cobot-parts"));
    let run = serde_json::from_str(&run).expect("JSON");
    answers("A cobot of integrated actuators", &run, &summary, 2000);
    let of_joints: f64 =
        shares_at_knee(&budget).iter().filter(|(piece, _)| piece.starts_with('j')).map(|(_, x)| x).sum();
    assert!((88.0..92.0).contains(&of_joints), "{of_joints} %");
    assert!(page().contains("At the knee nine tenths of the deflection come from the joints"));
}

#[test]
fn the_printed_arm_has_steppers_with_planetary_gears() {
    let [run, summary, budget] = run_with_budget("printed.json", Some("printed-parts"));
    let run = serde_json::from_str(&run).expect("JSON");
    answers("A printed arm with steppers", &run, &summary, 1296);
    assert!(summary.contains("creeps"), "{summary}");
    let shares = shares_at_knee(&budget);
    let of = |pieces: &[&str]| -> f64 {
        shares.iter().filter(|(piece, _)| pieces.contains(&piece.as_str())).map(|(_, share)| share).sum()
    };
    let words = format!(
        "At the knee the gears cause {:.0} % of the deflection, the bearing seat of j1 {:.0} %, the printed forearm {:.0} % and \
         the aluminium upper arm {:.0} %.",
        of(&["j1", "j2", "j3"]),
        of(&["j1.bearing"]),
        of(&["forearm"]),
        of(&["upper_arm"])
    );
    assert!(page().contains(&words), "{words}");
    assert!(summary.contains("knee"), "{summary}");
    // 20 arcmin at the 0.4 m of both links, the whole play
    let play = 1e3 * 0.4 * (20.0 / 60.0f64).to_radians();
    let words = format!(
        "with 20 arcmin of backlash: the tip is loose by up to {play:.1} mm from stop to stop, which is not"
    );
    let remarks: Vec<String> = serde_json::from_value(run["remarks"].clone()).expect("a list");
    let said: Vec<&String> = remarks.iter().filter(|said| said.contains("arcmin")).collect();
    assert!(said.iter().any(|said| said.starts_with("j2: ") && said.contains(&words)), "{words}: {said:?}");
    assert!(said.iter().all(|said| summary.contains(said.as_str())), "{said:?}");
    assert!(page().contains(&format!("at j2 alone it leaves the tip loose by up to {play:.1} mm")));
}

#[test]
fn the_palletizer_is_lighter_with_its_gas_spring() {
    let (run, summary) = run("palletizer.json", None);
    answers("A palletizer with a gas spring", &run, &summary, 16);
    assert!(summary.contains("stiffness that they add to modes is left out"), "{summary}");
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/arms");
    let text = std::fs::read_to_string(root.join("palletizer.json")).expect("a study");
    let with: Value = serde_json::from_str(&text).expect("JSON");
    let mut without = with.clone();
    without.as_object_mut().expect("a study").remove("springs").expect("springs");
    let shoulder_nm = |study: &Value| {
        let here = tempfile::tempdir().expect("a folder");
        std::fs::write(here.path().join("study.json"), study.to_string()).expect("written");
        let mut command = Command::new(env!("CARGO_BIN_EXE_armwright"));
        let command = command.current_dir(here.path());
        let output =
            command.args(["size", "study.json", "--design", "x0", "--json"]).output().expect("it runs");
        let rows: Vec<Value> = serde_json::from_slice(&output.stdout).expect("JSON");
        let row = rows.iter().find(|row| row["joint"] == "shoulder").expect("the shoulder");
        row["static_torque_nm"].as_f64().expect("a number")
    };
    let words =
        format!("carries {:.0} N m at rest instead of {:.0} N m", shoulder_nm(&with), shoulder_nm(&without));
    assert!(page().contains(&words), "{words}");
}

#[test]
fn the_scara_is_the_one_of_the_page() {
    let (run, summary) = run("../scara.json", None);
    answers("A SCARA with a quill", &run, &summary, 819_200);
    let knee = summary.lines().find(|line| line.starts_with("| knee")).expect("a knee");
    let cells: Vec<&str> = knee.split('|').map(str::trim).collect();
    let words = format!("The knee weighs {} kg and deflects by {} mm.", cells[3], cells[4]);
    assert!(page().contains(&words), "{words}");
    assert!(page().contains("images/arm-scara.svg"));
}

#[test]
fn the_gantry_is_as_stiff_as_its_guides_and_its_wrist() {
    let (run, summary) = run("gantry.json", None);
    answers("A gantry with a wrist", &run, &summary, 48);
}

#[test]
fn each_spring_of_the_palletizer_is_a_choice() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/arms");
    let out = tempfile::tempdir().expect("a folder");
    let mut command = Command::new(env!("CARGO_BIN_EXE_armwright"));
    let output =
        command.arg("run").arg(root.join("palletizer-springs.json")).arg("--out").arg(out.path()).output();
    let output = output.expect("the program starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let summary = std::fs::read_to_string(out.path().join("summary.md")).expect("written");
    let picks: Vec<&str> = summary.lines().filter(|line| line.contains(" with gas spring: force ")).collect();
    let force_kg_mm = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        let before = |unit: &str| words[words.iter().position(|word| *word == unit).expect("a unit") - 1];
        [
            before("N,").trim_start_matches('-').to_string(),
            before("kg,").to_string(),
            before("mm,").to_string(),
        ]
    };
    assert_eq!(picks.len(), 3, "{summary}");
    for line in picks {
        for word in force_kg_mm(line) {
            assert!(page().contains(&word), "{word} of \"{line}\" is not on the page");
        }
    }
}
