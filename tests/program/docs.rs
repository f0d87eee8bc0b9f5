//! Checks that the documents say what is true: their commands run and print what is shown, their examples can be read,
//! every key that the readers know is described, and every file that they mention exists.
//!
//! In a block marked `console`, a line after `$ ` is a command, and the lines below it are what the command prints.
//! `...` on a line of its own stands for any number of lines, and `…` within a line for any text. A comment
//! `<!-- file: NAME -->` in front of a block makes the block a file of this name.

use armwright::arm::read_arm_document;
use armwright::arm::{DrivenJoint, read_load_cases};
use armwright::catalog::Catalogs;
use armwright::input::{Document, Faults};
use armwright::study::NAMED;
use armwright::study::read_study;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn project() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn text(name: &str) -> String {
    fs::read_to_string(project().join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// README.md and the pages of docs/.
fn pages() -> Vec<String> {
    let mut pages = vec!["README.md".to_string()];
    for entry in fs::read_dir(project().join("docs")).expect("docs/") {
        let name = entry.expect("an entry").file_name().to_string_lossy().into_owned();
        if name.ends_with(".md") {
            pages.push(format!("docs/{name}"));
        }
    }
    pages.sort();
    pages
}

/// A fenced block of a page: its language, the comment just before it, its lines.
struct Block {
    language: String,
    comment: String,
    lines: Vec<String>,
}

fn blocks(page: &str) -> Vec<Block> {
    let mut out = Vec::new();
    let mut open: Option<Block> = None;
    let mut comment = String::new();
    for line in page.lines() {
        match (&mut open, line.strip_prefix("```")) {
            (Some(_), Some("")) => out.extend(open.take()),
            (Some(block), _) => block.lines.push(line.to_string()),
            (None, Some(language)) => {
                let comment = std::mem::take(&mut comment);
                open = Some(Block { language: language.to_string(), comment, lines: Vec::new() });
            }
            (None, None) => {
                comment = line.strip_prefix("<!-- ").map_or("", |c| c.trim_end_matches(" -->")).to_string();
            }
        }
    }
    assert!(open.is_none(), "a block is not closed");
    out
}

/// Whether what was printed is what is shown.
fn matches(shown: &[&str], printed: &[&str]) -> bool {
    match shown.split_first() {
        None => printed.is_empty(),
        Some((&"...", rest)) => (0..=printed.len()).any(|skip| matches(rest, &printed[skip..])),
        Some((line, rest)) => printed
            .split_first()
            .is_some_and(|(first, others)| line_matches(line, first) && matches(rest, others)),
    }
}

fn line_matches(shown: &str, printed: &str) -> bool {
    let pieces: Vec<&str> = shown.trim_end().split('…').collect();
    let Some(mut rest) = printed.trim_end().strip_prefix(pieces[0]) else { return false };
    for piece in &pieces[1..] {
        match rest.find(piece) {
            Some(at) => rest = &rest[at + piece.len()..],
            None => return false,
        }
    }
    rest.is_empty() || shown.trim_end().ends_with('…')
}

/// Runs the commands of a page, one after another, in a folder with the project's examples.
fn run_page(page: &str) -> usize {
    let here = tempfile::tempdir().expect("a temporary folder");
    for folder in ["examples", "examples/measured-arm", "tests/data/campaigns/plain-0251e"] {
        fs::create_dir_all(here.path().join(folder)).expect("created");
        for entry in fs::read_dir(project().join(folder)).expect(folder) {
            let entry = entry.expect("an entry");
            if entry.path().is_file() {
                fs::copy(entry.path(), here.path().join(folder).join(entry.file_name())).expect("copied");
            }
        }
    }
    let mut commands = 0;
    for block in blocks(&text(page)) {
        if let Some(name) = block.comment.strip_prefix("file: ") {
            let path = here.path().join(name);
            fs::create_dir_all(path.parent().expect("a folder")).expect("created");
            fs::write(path, block.lines.join("\n") + "\n").expect("written");
        }
        if block.language == "console" {
            for step in block.lines.join("\n").split("$ armwright").skip(1) {
                run_step(page, step, here.path());
                commands += 1;
            }
        }
    }
    commands
}

fn run_step(page: &str, step: &str, here: &Path) {
    let mut lines = step.lines();
    let words: Vec<&str> = lines.next().unwrap_or_default().split_whitespace().collect();
    let shown: Vec<&str> = lines.collect();
    let output = Command::new(env!("CARGO_BIN_EXE_armwright")).current_dir(here).args(&words).output();
    let output = output.expect("it runs");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{page}: armwright {}: {errors}", words.join(" "));
    let printed = String::from_utf8(output.stdout).expect("text");
    let printed_lines: Vec<&str> = printed.lines().collect();
    assert!(
        matches(&shown, &printed_lines),
        "{page}: armwright {} prints\n{printed}\nbut the page shows\n{}",
        words.join(" "),
        shown.join("\n")
    );
}

#[test]
fn the_commands_of_the_pages_print_what_is_shown() {
    let commands: usize = pages().iter().map(|page| run_page(page)).sum();
    assert!(commands >= 7, "only {commands} commands were found");
}

#[test]
fn the_readme_opens_with_two_commands_for_a_new_machine() {
    let readme = text("README.md");
    let shell: Vec<Block> = blocks(&readme).into_iter().filter(|b| b.language == "sh").collect();
    let commands: Vec<&str> = shell.iter().flat_map(|b| &b.lines).map(String::as_str).collect();
    assert_eq!(commands, ["cargo run --release -- run compare-materials", "scripts/test"]);
    assert!(NAMED.iter().any(|(name, _)| *name == "compare-materials"));
    assert!(project().join("scripts/test").is_file());
}

#[test]
fn the_json_examples_of_the_pages_are_read() {
    let catalogs = Catalogs::builtin();
    let mut read = 0;
    for page in pages() {
        for block in blocks(&text(&page)).into_iter().filter(|b| b.language == "json") {
            let document = Document::parse(&page, &block.lines.join("\n")).expect("JSON");
            let fault = match block.comment.as_str() {
                "study" => read_study(document, &catalogs).err(),
                "arm" => read_arm_document(document, &catalogs).err(),
                "cases: 2 joints" => read_load_cases(document, &["a", "b"].map(DrivenJoint::turning)).err(),
                other => panic!("{page}: a json block is marked \"{other}\""),
            };
            assert!(fault.is_none(), "{page}: {}", fault.expect("a fault"));
            read += 1;
        }
    }
    assert!(read >= 3);
}

/// Keys in a fault's list "known keys: a, b, c".
fn known_keys(faults: &Faults) -> BTreeSet<String> {
    let lists = faults.0.iter().filter_map(|f| f.hint.split("known keys: ").nth(1));
    lists.flat_map(|list| list.split(", ")).map(String::from).collect()
}

/// The value with an unknown key in every object, at any depth.
fn with_unknown_keys(value: &Value) -> Value {
    match value {
        Value::Object(map) => {
            let mut out: serde_json::Map<_, _> =
                map.iter().map(|(k, v)| (k.clone(), with_unknown_keys(v))).collect();
            out.insert("zzzzzzzz".into(), json!(0));
            Value::Object(out)
        }
        Value::Array(items) => items.iter().map(with_unknown_keys).collect(),
        other => other.clone(),
    }
}

/// Fails for every key the reader knows that the page does not show as code.
fn assert_described(page: &str, keys: &BTreeSet<String>, at_least: usize) {
    assert!(keys.len() >= at_least, "{page}: the reader names only {keys:?}");
    let page_text = text(page);
    let missing: Vec<&String> = keys.iter().filter(|k| !page_text.contains(&format!("`{k}`"))).collect();
    assert!(missing.is_empty(), "{page} does not describe {missing:?}");
}

/// Every kind of object a study may hold.
fn every_study_object() -> Value {
    json!({
        "name": "all", "chain": [
            {"type": "joint", "name": "j1", "axis": [0, 0, 1], "drive": "first_fit", "drives": {"ratios": [100]},
                "duty": [{"torque_nm": 1, "time_s": 1, "speed_rpm": 1}]},
            {"type": "joint", "name": "j2", "axis": [0, 1, 0], "windup": {"k1_nm_per_rad": 1, "k2_nm_per_rad": 2,
                "k3_nm_per_rad": 3, "t1_nm": 1, "t2_nm": 2}},
            {"type": "link", "name": "a", "vector_m": [1, 0, 0], "choose": {
                "materials": ["Aluminium 6061-T6", "Structural steel S355"],
                "sections": [
                    {"shape": "rectangular_tube", "width_mm": {"from": 60, "to": 80, "step": 20}, "wall_mm": 2},
                    {"shape": "round_tube", "diameter_mm": 60, "wall_mm": 2},
                    {"profiles": {"family": "steel"}}]}},
            {"type": "link", "name": "b", "vector_m": [1, 0, 0], "material": "Aluminium 6061-T6",
                "section": {"shape": "rectangular_tube", "width_m": 0.1, "height_m": 0.1, "wall_m": 0.01}},
            {"type": "link", "name": "c", "vector_m": [1, 0, 0], "material": "Aluminium 6061-T6",
                "section": {"shape": "round_tube", "diameter_m": 0.1, "wall_m": 0.01}}],
        "payload": {"mass_kg": 1}, "poses": [{"pose_deg": [0, 0]}],
        "environments": [{"name": "sea", "water": {"density_kg_m3": 1025}}],
        "motion": {"cycle": [{"phase": "rest", "time_s": 1}]}, "drives": {}, "constraints": {}, "models": {},
        "effects": [{"effect": "bearing_tilt", "at": "j1", "parameters": {"stiffness_nm_per_rad": 1e5}}]
    })
}

#[test]
fn every_key_of_a_study_file_is_described() {
    let catalogs = Catalogs::builtin();
    let read =
        |value: &Value| read_study(Document::parse("study", &value.to_string()).expect("JSON"), &catalogs);
    if let Err(faults) = read(&every_study_object()) {
        panic!("{faults}");
    }
    let mut keys = known_keys(&read(&with_unknown_keys(&every_study_object())).expect_err("unknown keys"));
    // an object whose head is faulty is not read further: the parts once more, each alone
    for part in ["chain", "poses", "environments", "motion", "drives", "constraints", "models", "payload"] {
        let mut study = every_study_object();
        study[part] = with_unknown_keys(&study[part]);
        keys.extend(known_keys(&read(&study).expect_err("unknown keys")));
    }
    let mut study = every_study_object();
    study["effects"][0]["zzzzzzzz"] = json!(0);
    keys.extend(known_keys(&read(&study).expect_err("unknown keys")));
    assert_described("docs/study-format.md", &keys, 70);
}

#[test]
fn every_key_of_an_arm_file_is_described() {
    let catalogs = Catalogs::builtin();
    let arm = json!({"name": "all", "materials": {}, "chain": [
        {"type": "joint", "name": "j1", "axis": [0, 0, 1], "stiffness_nm_per_rad": 1.0},
        {"type": "joint", "name": "j2", "axis": [0, 1, 0], "windup": {"k1_nm_per_rad": 1, "k2_nm_per_rad": 2,
            "k3_nm_per_rad": 3, "t1_nm": 1, "t2_nm": 2}},
        {"type": "link", "name": "b", "vector_m": [1, 0, 0], "material": "Aluminium 6061-T6",
            "section": {"shape": "rectangular_tube", "width_m": 0.1, "height_m": 0.1, "wall_m": 0.01}},
        {"type": "link", "name": "c", "vector_m": [1, 0, 0], "material": "Aluminium 6061-T6",
            "section": {"shape": "round_tube", "diameter_m": 0.1, "wall_m": 0.01}}]});
    let read = |value: &Value| {
        read_arm_document(Document::parse("arm", &value.to_string()).expect("JSON"), &catalogs)
    };
    assert!(read(&arm).is_ok());
    let mut keys = known_keys(&read(&with_unknown_keys(&arm)).expect_err("unknown keys"));
    for (part, faulty) in [
        ("materials", json!({"m": {"zzzzzzzz": 0}})),
        ("effects", json!([{"effect": "base_compliance", "at": "base", "parameters": {}, "zzzzzzzz": 0}])),
    ] {
        let mut arm = arm.clone();
        arm[part] = faulty;
        keys.extend(known_keys(&read(&arm).expect_err("unknown keys")));
    }
    let cases = with_unknown_keys(
        &json!([{"pose_deg": [0], "payload": {"mass_kg": 1}, "water": {"density_kg_m3": 1}}]),
    );
    let read = read_load_cases(
        Document::parse("cases", &cases.to_string()).expect("JSON"),
        &[DrivenJoint::turning("j")],
    );
    keys.extend(known_keys(&read.expect_err("unknown keys")));
    assert_described("docs/arm-format.md", &keys, 40);
}

#[test]
fn every_column_and_key_of_a_result_is_described() {
    let here = tempfile::tempdir().expect("a temporary folder");
    let study = project().join("examples/bench-arm.json");
    let run = Command::new(env!("CARGO_BIN_EXE_armwright"))
        .current_dir(here.path())
        .args(["run", study.to_str().expect("text"), "--out", "out"])
        .output()
        .expect("the program starts");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let read = |name: &str| fs::read_to_string(here.path().join("out").join(name)).expect(name);
    let header = read("front.csv").lines().next().expect("a header").to_string();
    let general = |column: &str| {
        let link = column.replace("upper_arm_", "<link>_").replace("forearm_", "<link>_");
        link.replace("shoulder_", "<joint>_").replace("elbow_", "<joint>_")
    };
    let mut names: BTreeSet<String> = header.split(',').map(general).collect();
    let run: Value = serde_json::from_str(&read("run.json")).expect("JSON");
    names.extend(run.as_object().expect("an object").keys().cloned());
    for entry in fs::read_dir(here.path().join("out")).expect("the folder") {
        let name = entry.expect("an entry").file_name().to_string_lossy().into_owned();
        if !name.starts_with("front.") || name == "front.csv" || name == "front.svg" {
            names.insert(name);
        }
    }
    assert_described("docs/results-format.md", &names, 30);
}

#[test]
fn every_file_the_pages_point_at_exists() {
    for page in pages() {
        let folder = project().join(&page).parent().expect("a folder").to_path_buf();
        let page_text = text(&page);
        for link in page_text.split("](").skip(1) {
            let target = link.split([')', '#']).next().unwrap_or_default();
            if !target.is_empty() && !target.contains("://") {
                assert!(folder.join(target).exists(), "{page} points at {target}, which does not exist");
            }
        }
        for code in page_text.split('`').skip(1).step_by(2) {
            let is_path = ["src/", "tests/", "docs/", "scripts/", "catalogs/", "examples/", "studies/"]
                .iter()
                .any(|root| code.starts_with(root));
            if is_path && !code.contains([' ', '<', '*']) {
                assert!(project().join(code).exists(), "{page} names {code}, which does not exist");
            }
        }
    }
}
