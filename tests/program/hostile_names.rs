//! Names that could do harm: they would write outside the folder, make two files the same, run as a formula in a
//! spreadsheet, or look like another name.

use crate::running::armwright;
use crate::whole_results::study;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

fn write(folder: &Path, name: &str, text: &str) {
    let file = folder.join(name);
    fs::create_dir_all(file.parent().expect("a folder")).expect("made");
    fs::write(file, text).expect("written");
}

/// The small study, changed.
fn changed(change: impl Fn(&mut Value)) -> String {
    let mut value: Value = serde_json::from_str(&study("new", 3.0)).expect("JSON");
    change(&mut value);
    value.to_string()
}

#[test]
fn materials_with_the_same_letters_have_files_of_their_own() {
    let here = tempfile::tempdir().expect("a folder");
    let header = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("catalogs/materials.csv"));
    let header = header.expect("materials").lines().next().expect("a header").to_string();
    let long = "m".repeat(300);
    let row = |name: &str, density: &str| {
        let cells = header.split(',').map(|column| match column {
            "name" => name.to_string(),
            "class" => "metal".into(),
            "density_kg_m3" => density.into(),
            "e_pa" => "7e10".into(),
            "g_pa" => "2.6e10".into(),
            "source" => "made for a test".into(),
            "confidence" => "representative".into(),
            _ => String::new(),
        });
        cells.collect::<Vec<_>>().join(",")
    };
    let rows = [row("PA6+X", "1400"), row("PA6 X", "2800"), row(&long, "2000")];
    write(here.path(), "parts/materials.csv", &format!("{header}\n{}\n", rows.join("\n")));
    let names = json!(["PA6+X", "PA6 X", long]);
    write(here.path(), "study.json", &changed(|s| s["chain"][1]["choose"]["materials"] = names.clone()));
    let (code, text) = armwright(here.path(), &["run", "study.json", "--catalogs", "parts", "--out", "out"]);
    assert_eq!(code, 0, "{text}");
    for name in ["front.pa6-x.csv", "front.pa6-x-2.csv"] {
        assert!(here.path().join("out").join(name).exists(), "{name}");
    }
    let (code, text) = armwright(here.path(), &["compare", "out", "--json", "--catalogs", "parts"]);
    assert_eq!(code, 0, "{text}");
    // the lighter one of the two is half as heavy in its tube
    let front = |name: &str| fs::read_to_string(here.path().join("out").join(name)).expect("a front");
    assert!(front("front.pa6-x.csv").contains("PA6+X") && front("front.pa6-x-2.csv").contains("PA6 X"));
    assert!(!front("front.pa6-x.csv").contains("PA6 X"));
}

#[test]
fn a_joint_with_a_long_name_is_drawn() {
    let here = tempfile::tempdir().expect("a folder");
    let long = "j".repeat(200);
    write(here.path(), "study.json", &changed(|s| s["chain"][0]["name"] = json!(long)));
    let (code, text) = armwright(here.path(), &["run", "study.json", "--out", "out"]);
    assert_eq!(code, 0, "{text}");
    assert!(!text.contains("warning"), "{text}");
    assert!(here.path().join("out/plots/pick-lightest-arm.svg").exists());
}

#[test]
fn names_of_studies_and_campaigns_do_not_lead_out_of_the_folder() {
    let here = tempfile::tempdir().expect("a folder");
    write(here.path(), "a/study.json", &changed(|s| s["name"] = json!("../../x")));
    let (code, text) = armwright(&here.path().join("a"), &["run", "study.json"]);
    assert_eq!(code, 0, "{text}");
    assert!(here.path().join("a/results/x/front.csv").exists(), "{text}");
    assert!(!here.path().join("x").exists());
    let campaign = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/dial_gauge/full_conn");
    for entry in fs::read_dir(campaign).expect("a campaign") {
        let path = entry.expect("an entry").path();
        if path.is_file() {
            let name = path.file_name().expect("a name").to_str().expect("text");
            write(here.path(), &format!("a/may/{name}"), &fs::read_to_string(&path).expect("text"));
        }
    }
    let file = here.path().join("a/may/campaign.json");
    let mut value: Value = serde_json::from_str(&fs::read_to_string(&file).expect("text")).expect("JSON");
    value["name"] = json!("../../../y");
    fs::write(&file, value.to_string()).expect("written");
    let (code, text) = armwright(&here.path().join("a"), &["reconcile", "may"]);
    assert_eq!(code, 0, "{text}");
    let verdict = here.path().join("a/results/y/verdict.json");
    let value: Value = serde_json::from_str(&fs::read_to_string(&verdict).expect("a verdict")).expect("JSON");
    for (name, hash) in value["files"].as_object().expect("a list") {
        let bytes = fs::read(here.path().join("a/results/y").join(name)).expect("a file");
        assert_eq!(hash, blake3::hash(&bytes).to_hex().as_str(), "{name}");
    }
    let outside: Vec<_> = fs::read_dir(here.path()).expect("a folder").collect();
    assert_eq!(outside.len(), 1, "something was written outside: {outside:?}");
}

#[test]
fn names_that_deceive_or_run_are_faults_with_their_line() {
    let here = tempfile::tempdir().expect("a folder");
    for (name, problem) in [
        ("a\u{1b}[2Jb", "has U+001B, a control character"),
        ("a\nb", "has U+000A, a control character"),
        ("\u{202e}gpj", "has U+202E, a character that turns the direction of writing"),
        ("=cmd()", "would run as a formula in a spreadsheet"),
        ("+x", "would run as a formula in a spreadsheet"),
        ("@x", "would run as a formula in a spreadsheet"),
        ("-x", "would run as a formula in a spreadsheet"),
    ] {
        let text = format!(
            "{{\n\"name\": {},\n{}",
            json!(name),
            &changed(|s| drop(s.as_object_mut().expect("an object").remove("name")))[1..]
        );
        write(here.path(), "study.json", &text);
        let (code, said) = armwright(here.path(), &["run", "study.json", "--out", "out"]);
        assert_eq!(code, 3, "{name:?}: {said}");
        assert!(said.contains("study.json:2: name: ") && said.contains(problem), "{name:?}: {said}");
        assert!(!said.contains('\u{1b}') && !said.contains('\u{202e}'), "the message deceives too: {said:?}");
        write(here.path(), "study.json", &changed(|s| s["chain"][0]["name"] = json!(name)));
        assert_eq!(armwright(here.path(), &["run", "study.json", "--out", "out"]).0, 3, "a joint {name:?}");
    }
    let readings = |test: &str| {
        format!("test,joint,torque_nm,branch,windup_arcmin,sigma_arcmin\n{test},j2,10,loading,0.1,0.01\n")
    };
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/measured-arm");
    for name in ["campaign.json", "arm.json", "static.csv", "modal.csv"] {
        write(here.path(), &format!("may/{name}"), &fs::read_to_string(example.join(name)).expect("text"));
    }
    for name in ["=1+1", "+x", "a\u{7}b", "\u{202e}x"] {
        write(here.path(), "may/windup.csv", &readings(name));
        let (code, said) = armwright(here.path(), &["reconcile", "may", "--out", "out"]);
        assert_eq!(code, 3, "{name:?}: {said}");
        assert!(said.contains("windup.csv:2: test: "), "{name:?}: {said}");
    }
    assert!(!here.path().join("out").exists());
}

#[test]
fn no_design_has_the_name_of_a_number_and_earlier_names_are_read() {
    let here = tempfile::tempdir().expect("a folder");
    write(here.path(), "study.json", &study("new", 3.0));
    assert_eq!(armwright(here.path(), &["run", "study.json", "--out", "out"]).0, 0);
    let front = fs::read_to_string(here.path().join("out/front.csv")).expect("a front");
    let ids: Vec<&str> = front.lines().skip(1).filter_map(|line| line.split(',').next()).collect();
    assert_eq!(ids, ["x0", "x1"]);
    for id in ["x1", "1"] {
        let (code, text) = armwright(here.path(), &["design", "out", id]);
        assert_eq!(code, 0, "{text}");
        assert_eq!(armwright(here.path(), &["size", "study.json", "--design", id]).0, 0);
    }
    // a result of an earlier version: no list of files, no x
    fs::write(here.path().join("out/front.csv"), front.replace("\nx", "\n")).expect("written");
    let file = here.path().join("out/run.json");
    let mut run: Value = serde_json::from_str(&fs::read_to_string(&file).expect("text")).expect("JSON");
    for key in ["files", "manifest_hash"] {
        run.as_object_mut().expect("an object").remove(key);
    }
    fs::write(&file, run.to_string()).expect("written");
    assert_eq!(armwright(here.path(), &["design", "out", "1"]).0, 0);
    // there it would be the design of number 33 * 36 + 1
    assert_eq!(armwright(here.path(), &["design", "out", "x1"]).0, 2);
    let (code, text) = armwright(here.path(), &["front", "check", "out"]);
    assert_eq!(code, 0, "{text}");
    // its files may be replaced, as those of any result
    assert_eq!(armwright(here.path(), &["run", "study.json", "--out", "out"]).0, 0);
}
