//! The JSON Schemas of written files agree with the files: every file that the program writes is valid, and every key
//! and column of a schema is in some file.

use crate::front_check::STUDY;
use crate::running::armwright;
use boon::{Compiler, Schemas};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::Path;

fn printed(kind: &str) -> Value {
    let (code, said) = armwright(Path::new(env!("CARGO_MANIFEST_DIR")), &["schema", kind]);
    assert_eq!(code, 0, "{said}");
    serde_json::from_str(&said).expect("JSON")
}

fn read(path: &Path) -> Value {
    let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    serde_json::from_str(&text).expect("JSON")
}

/// Checks files against the schema of their kind. Every key of the whole document must be in one of them.
fn hold(kind: &str, files: &[Value], never: &[&str]) {
    let schema = printed(kind);
    let (mut schemas, mut compiler) = (Schemas::new(), Compiler::new());
    compiler.add_resource("http://localhost/x.json", schema.clone()).expect("a resource");
    let root = compiler.compile("http://localhost/x.json", &mut schemas).expect("a schema");
    let mut seen = BTreeSet::new();
    for file in files {
        schemas.validate(file, root).unwrap_or_else(|e| panic!("{kind}: {e:#}"));
        seen.extend(file.as_object().expect("an object").keys().cloned());
        // the schema says no to a file with another key
        let mut wrong = file.clone();
        wrong["nonsense"] = json!(1);
        assert!(schemas.validate(&wrong, root).is_err(), "{kind} takes any key");
    }
    let known = schema["$defs"][kind]["properties"].as_object().expect("keys").keys();
    let unseen: Vec<&String> =
        known.filter(|key| !seen.contains(*key) && !never.contains(&key.as_str())).collect();
    assert!(unseen.is_empty(), "{kind}: no file has {unseen:?}");
}

#[test]
fn runs_shards_and_fronts_are_what_their_schemas_say() {
    let here = tempfile::tempdir().expect("a folder");
    let here = here.path();
    std::fs::write(here.join("study.json"), STUDY).expect("written");
    let done = |words: &[&str]| {
        let (code, said) = armwright(here, words);
        assert_eq!(code, 0, "{words:?}: {said}");
    };
    let supplements = ["--within", "5%", "--tolerance", "mass=2%", "--samples", "20"];
    for search in ["exhaustive", "exact"] {
        let words = ["run", "study.json", "--search", search, "--out"];
        done(&[&words[..], &[search], &supplements].concat());
        done(&[&words[..], &[&format!("{search}-1"), "--shard", "1/2"]].concat());
    }
    let files =
        |name: &str| ["exhaustive", "exact"].map(|search| read(&here.join(search.to_string() + name)));
    hold("run", &files("/run.json"), &[]);
    let mut study: Value = serde_json::from_str(STUDY).expect("JSON");
    study["counterweights"] = json!([{"at": "upper", "point_m": [-0.1, 0, 0], "mass_kg": [0, 1]}]);
    std::fs::write(here.join("open.json"), study.to_string()).expect("written");
    done(&["run", "open.json", "--out", "open"]);
    hold("choices", &[read(&here.join("open/choices.json"))], &[]);
    hold("shard", &files("-1/shard.json"), &[]);
    columns_hold("front", &std::fs::read_to_string(here.join("exact/front.csv")).expect("a front"));
}

#[test]
fn exports_and_bills_are_what_their_schemas_say() {
    let here = tempfile::tempdir().expect("a folder");
    let arm = format!("{}/examples/measured-arm/arm.json", env!("CARGO_MANIFEST_DIR"));
    let record = |form: &str| {
        let (code, said) =
            armwright(here.path(), &["export", &arm, "--payload-kg", "2", "--to", form, "--out", form]);
        assert_eq!(code, 0, "{said}");
        read(&here.path().join(form).join("export.json"))
    };
    let records = ["calculix", "mjcf", "urdf", "json", "csv", "bom"].map(record);
    hold("export", &records, &[]);
    columns_hold("bom", &std::fs::read_to_string(here.path().join("bom/bom.csv")).expect("a bill"));
}

#[test]
fn a_verdict_is_what_its_schema_says() {
    let here = tempfile::tempdir().expect("a folder");
    let campaign = format!("{}/examples/measured-arm", env!("CARGO_MANIFEST_DIR"));
    let (code, said) = armwright(here.path(), &["reconcile", &campaign, "--out", "out"]);
    assert_eq!(code, 0, "{said}");
    let verdict = read(&here.path().join("out/verdict.json"));
    assert!(verdict["effects"].as_array().is_some_and(|effects| !effects.is_empty()), "{verdict}");
    // what a second run of the study adds is tested where it is run
    hold("verdict", std::slice::from_ref(&verdict), &["study"]);
    // the effects of the verdict are effects of the schema
    let effects = printed("effects");
    let (mut schemas, mut compiler) = (Schemas::new(), Compiler::new());
    compiler.add_resource("http://localhost/e.json", effects).expect("a resource");
    let root = compiler.compile("http://localhost/e.json", &mut schemas).expect("a schema");
    let arm = read(&here.path().join("out/arm.corrected.json"));
    let written = arm["effects"].as_array().expect("a list");
    assert!(!written.is_empty());
    for effect in written {
        schemas.validate(effect, root).unwrap_or_else(|e| panic!("{effect}: {e:#}"));
        let mut wrong = effect.clone();
        wrong["parameters"]["nonsense"] = json!(1);
        assert!(schemas.validate(&wrong, root).is_err());
    }
}

/// Checks the columns of a table: in the order of its schema, each by a name in which `<link>` or `<joint>` is any word.
fn columns_hold(kind: &str, text: &str) {
    let header: Vec<&str> = text.lines().next().expect("a header").split(',').collect();
    let schema = printed(kind);
    let fields = schema["fields"].as_array().expect("fields");
    let name = |field: &Value| field["name"].as_str().expect("a name").to_string();
    let place = |column: &str| {
        let fits = |pattern: &str| match pattern.split_once('>') {
            Some((_, end)) => column.len() > end.len() && column.ends_with(end),
            None => column == pattern,
        };
        // a longer name is more particular: `_bearing_margin` is no `_margin`
        let fitting = fields.iter().enumerate().filter(|(_, field)| fits(&name(field)));
        fitting.max_by_key(|(_, field)| (!name(field).contains('<'), name(field).len())).map(|(at, _)| at)
    };
    let places: Vec<usize> = header
        .iter()
        .map(|column| place(column).unwrap_or_else(|| panic!("{kind} has no column {column}")))
        .collect();
    let seen: BTreeSet<usize> = places.iter().copied().collect();
    let unseen: Vec<String> = fields
        .iter()
        .enumerate()
        .filter(|(at, _)| !seen.contains(at))
        .map(|(_, field)| name(field))
        .collect();
    assert!(unseen.is_empty(), "{kind}: no column is {unseen:?}");
}
