//! The `armwright` program as a user runs it, and the files it writes.

use serde_json::Value;
use std::collections::{BTreeMap, HashMap};
use std::path::Path;
use std::process::{Command, Output};

use super::design::link_key;

/// Runs `armwright` with these words.
pub fn armwright(words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_armwright")).args(words).output().expect("the program starts")
}

/// Runs `armwright`, which must succeed, and returns what it printed.
pub fn armwright_ok(words: &[&str]) -> String {
    let output = armwright(words);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "armwright {words:?} failed with {:?}: {said}", output.status.code());
    String::from_utf8(output.stdout).expect("text")
}

/// Exit code and what was written to standard error.
pub fn armwright_fails(words: &[&str]) -> (i32, String) {
    let output = armwright(words);
    assert!(!output.status.success(), "armwright {words:?} should have failed");
    (output.status.code().expect("an exit code"), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// A path as a word of the command line.
pub fn word(path: &Path) -> &str {
    path.to_str().expect("temporary folders have plain names")
}

/// Writes a study into the folder and runs it; the results are in `results/`.
pub fn run_study(dir: &Path, study: &Value) -> Results {
    run_study_with(dir, study, &[])
}

/// The same with more words on the command line.
pub fn run_study_with(dir: &Path, study: &Value, more: &[&str]) -> Results {
    let (file, out) = (dir.join("study.json"), dir.join("results"));
    std::fs::write(&file, serde_json::to_string_pretty(study).expect("a value serializes")).expect("written");
    let words = [&["run", word(&file), "--out", word(&out)], more].concat();
    armwright_ok(&words);
    Results::read(&out)
}

/// What a run wrote.
pub struct Results {
    pub run: Value,
    pub front: Vec<FrontRow>,
    pub by_material: BTreeMap<String, Vec<FrontRow>>,
}

impl Results {
    /// The results in a folder.
    pub fn read(dir: &Path) -> Self {
        let run: Value = read_json(&dir.join("run.json"));
        let materials = run["materials"].as_array().expect("a list of materials").clone();
        let front_of = |m: &Value| {
            let file = format!("front.{}.csv", m["slug"].as_str().expect("a slug"));
            (m["name"].as_str().expect("a name").to_owned(), read_front(&dir.join(file)))
        };
        let by_material = materials.iter().map(front_of).collect();
        Self { run, front: read_front(&dir.join("front.csv")), by_material }
    }

    /// A count in run.json.
    pub fn count(&self, key: &str) -> usize {
        self.run[key].as_u64().unwrap_or_else(|| panic!("no count {key} in run.json")) as usize
    }
}

/// A JSON file.
pub fn read_json(path: &Path) -> Value {
    let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    serde_json::from_str(&text).expect("JSON")
}

/// One design of a front, as printed.
#[derive(Clone, Debug)]
pub struct FrontRow(HashMap<String, String>);

fn read_front(path: &Path) -> Vec<FrontRow> {
    let mut reader = csv::Reader::from_path(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    reader.deserialize().map(|row| FrontRow(row.expect("a row reads"))).collect()
}

impl FrontRow {
    pub fn text(&self, column: &str) -> &str {
        self.0.get(column).unwrap_or_else(|| panic!("no column {column}"))
    }

    pub fn number(&self, column: &str) -> f64 {
        self.text(column).parse().unwrap_or_else(|_| panic!("{column}: {}", self.text(column)))
    }

    /// The same text as [`super::design::Design::key`] gives: links and free drives in the order of the chain.
    pub fn key(&self, study: &Value) -> String {
        let pieces = study["chain"].as_array().expect("a chain");
        let part = |piece: &Value| {
            let name = piece["name"].as_str().expect("a name");
            if piece["drive"] == "all_fits" {
                let part = |what: &str| self.text(&format!("{name}_{what}"));
                return Some(format!("{} + {}", part("gear"), part("motor")));
            }
            piece["choose"].is_object().then(|| self.link_key(name))
        };
        pieces.iter().filter_map(part).collect::<Vec<_>>().join("; ")
    }

    fn link_key(&self, link: &str) -> String {
        let text = |what: &str| self.text(&format!("{link}_{what}"));
        let size = |what: &str| self.number(&format!("{link}_{what}"));
        link_key(text("material"), text("profile"), size("width_mm"), size("height_mm"), size("wall_mm"))
    }
}
