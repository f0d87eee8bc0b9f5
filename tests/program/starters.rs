//! What a new user starts with: starters that run unchanged, `armwright check` for any file, shell completions and
//! manual pages.

use crate::links::armwright;
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn project() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Exit code and standard output, whatever the code.
fn checked(here: &Path, words: &[&str]) -> (i32, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_armwright"))
        .current_dir(here)
        .arg("check")
        .args(words)
        .output()
        .expect("it runs");
    (output.status.code().expect("a code"), String::from_utf8(output.stdout).expect("text"))
}

fn started(what: &str) -> tempfile::TempDir {
    let here = tempfile::tempdir().expect("a folder");
    let (code, said) = armwright(here.path(), &["new", what, "--out", "mine"]);
    assert!(code == 0 && said.contains("mine/STARTER.md"), "{said}");
    let (code, said) = armwright(here.path(), &["new", what, "--out", "mine"]);
    assert!(code == 2 && said.contains("is there already"), "{said}");
    here
}

/// Every command of the starter's page that is about its own files. The runs of a study are the tutorial's.
fn run_page(here: &Path) -> usize {
    let page = fs::read_to_string(here.join("mine/STARTER.md")).expect("the page");
    let commands = page.lines().filter_map(|line| line.strip_prefix("armwright "));
    let mut count = 0;
    for command in commands.filter(|command| !command.starts_with("run ")) {
        let words: Vec<&str> = command.split('#').next().unwrap_or_default().split_whitespace().collect();
        let folder = if words.iter().any(|word| word.starts_with("mine")) {
            here.to_path_buf()
        } else {
            here.join("mine")
        };
        let (code, said) = armwright(&folder, &words);
        assert_eq!(code, 0, "{command}: {said}");
        count += 1;
    }
    count
}

#[test]
fn a_new_study_passes_its_check_and_is_sized() {
    let here = started("study");
    assert_eq!(run_page(here.path()), 2);
}

#[test]
fn check_compares_the_files_of_a_result_with_its_hashes() {
    let here = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| fs::write(here.path().join(name), text).expect("written");
    let hash = blake3::hash(b"a table").to_hex().to_string();
    write("run.json", &json!({"study": "s", "files": {"front.csv": hash}}).to_string());
    write("front.csv", "a table");
    assert_eq!(checked(here.path(), &["."]), (0, ".: result of a study, sound\n".to_string()));
    write("front.csv", "an edited table");
    let (code, said) = checked(here.path(), &["front.csv"]);
    assert!(code == 9 && said.contains("front.csv is not what was written"), "{said}");
    fs::remove_file(here.path().join("front.csv")).expect("removed");
    assert_eq!(checked(here.path(), &["."]).0, 9);
}

#[test]
fn a_new_arm_passes_its_check_and_is_analysed() {
    let here = started("arm");
    assert_eq!(run_page(here.path()), 4);
    assert!(here.path().join("mine/my-campaign/campaign.json").is_file());
}

#[test]
fn new_parts_pass_their_check_and_are_offered_to_a_study() {
    let here = started("parts");
    assert_eq!(run_page(here.path()), 3);
    let text = fs::read_to_string(project().join("examples/bench-arm.json")).expect("a study");
    let mut study: Value = serde_json::from_str(&text).expect("JSON");
    study["drives"] = json!({"gears": ["EXAMPLE-25-100"], "motor_models": ["EXAMPLE-60"]});
    study["chain"][1]["choose"]["materials"] = json!(["Example aluminium"]);
    study["constraints"] = json!({});
    fs::write(here.path().join("study.json"), study.to_string()).expect("written");
    let (code, said) = armwright(here.path(), &["size", "study.json", "--catalogs", "mine"]);
    assert!(code == 0 && said.contains("EXAMPLE-25-100 EXAMPLE-60"), "{said}");
}

#[test]
fn check_says_what_each_file_is_and_reports_every_fault_of_every_file() {
    let here = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| fs::write(here.path().join(name), text).expect("written");
    let bench = fs::read_to_string(project().join("examples/bench-arm.json")).expect("a study");
    write("sound.json", &bench);
    write("study.json", &bench.replace("\"poses\"", "\"pose\"").replace("\"mass_kg\": 3", "\"mass_kg\": -3"));
    write("arm.json", r#"{"name": "a", "chian": []}"#);
    write("cases.json", r#"[{"pose_deg": [0], "payload": {"mass": 1}}]"#);
    write("broken.json", "{\n \"name\": 1,}");
    write("other.json", r#"{"zzzz": 1}"#);
    write("list.json", r#"[{"effect": "outlier"}]"#);
    write("motors.csv", "type,model,source,confidence\nac-servo,M,s,sure\n");
    let names = [
        "sound.json",
        "study.json",
        "arm.json",
        "broken.json",
        "other.json",
        "list.json",
        "motors.csv",
        "absent.json",
        "sound.json",
    ];
    let (code, said) = checked(here.path(), &names);
    assert_eq!(code, 3, "{said}");
    for words in [
        "sound.json: study, sound\n",
        "study.json: study, 3 faults\n",
        "study.json:15: payload.mass_kg: = -3 must not be negative",
        "pose: unknown key; did you mean \"poses\"?",
        "arm.json: arm, 2 faults\n",
        "arm.json:1: chian: unknown key; did you mean \"chain\"?",
        "broken.json: unknown, 1 fault\n",
        "broken.json:2: column",
        "other.json: has no key of a file that is known; `armwright schema`",
        "list.json: has no key of a file that is known",
        ": catalogs, 1 fault\n",
        "confidence",
        "absent.json: unknown, cannot be read\n",
    ] {
        assert!(said.contains(words), "{words} is not in\n{said}");
    }
    assert_eq!(said.matches("sound.json").count(), 1, "a file is looked at once");
    let (code, said) = checked(here.path(), &["--json", "study.json", "sound.json"]);
    let findings: Value = serde_json::from_str(&said).expect("JSON");
    assert_eq!((code, &findings[0]["state"], &findings[1]["state"]), (3, &json!("faulty"), &json!("sound")));
    assert_eq!(findings[0]["faults"].as_array().map(Vec::len), Some(3));
    assert_eq!(checked(here.path(), &["absent.json"]).0, 7);
}

#[test]
fn check_reads_readings_with_their_campaign_and_cases_with_their_arm() {
    let here = tempfile::tempdir().expect("a folder");
    let from = project().join("examples/measured-arm");
    for name in ["campaign.json", "arm.json", "static.csv", "modal.csv", "windup.csv"] {
        fs::copy(from.join(name), here.path().join(name)).expect("copied");
    }
    fs::write(here.path().join("cases.json"), r#"[{"pose_deg": [0]}]"#).expect("written");
    assert_eq!(checked(here.path(), &["modal.csv", "campaign.json", "."]).0, 0);
    let (code, said) = checked(here.path(), &["cases.json"]);
    assert!(code == 3 && said.contains("has 1 angles, the arm has"), "{said}");
    let text = fs::read_to_string(here.path().join("modal.csv")).expect("readings");
    fs::write(here.path().join("modal.csv"), text.replacen("frequency_hz", "frequenzy_hz", 1))
        .expect("written");
    let (code, said) = checked(here.path(), &["modal.csv"]);
    assert!(code == 3 && said.contains("campaign, ") && said.contains("frequency_hz"), "{said}");
}

/// Verbs and verbs of verbs, as the help lists them.
pub fn verbs(here: &Path, words: &[&str]) -> Vec<String> {
    let (code, help) = armwright(here, &[words, &["--help"]].concat());
    assert_eq!(code, 0, "{help}");
    let list = help.split("Commands:\n").nth(1).unwrap_or_default().split("\n\n").next().unwrap_or_default();
    let names = list.lines().filter_map(|line| {
        line.strip_prefix("  ").filter(|line| !line.starts_with(' '))?.split_whitespace().next()
    });
    names.filter(|name| *name != "help").map(String::from).collect()
}

#[test]
fn completions_and_manual_pages_have_every_verb() {
    let here = tempfile::tempdir().expect("a folder");
    let verbs_of_all = verbs(here.path(), &[]);
    assert!(verbs_of_all.len() >= 18, "{verbs_of_all:?}");
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let (code, script) = armwright(here.path(), &["completions", shell]);
        assert_eq!(code, 0);
        for verb in &verbs_of_all {
            assert!(script.contains(verb.as_str()), "{shell}: {verb}");
        }
    }
    let (code, said) = armwright(here.path(), &["man", "--out", "man/man1"]);
    assert_eq!(code, 0, "{said}");
    let page = |name: &str| fs::read_to_string(here.path().join("man/man1").join(name)).expect(name);
    for verb in &verbs_of_all {
        assert!(page("armwright.1").contains(&format!("armwright\\-{verb}(1)")), "armwright.1 lacks {verb}");
        assert!(page(&format!("armwright-{verb}.1")).contains("SYNOPSIS"));
    }
    for part in verbs(here.path(), &["new"]) {
        assert!(page(&format!("armwright-new-{part}.1")).contains("SYNOPSIS"));
    }
}
