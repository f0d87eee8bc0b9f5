//! Words that docs/glossary.md has replaced by standard ones must not appear again in documents, help texts or public
//! names.

use crate::starters::verbs;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Replaced words, as they stand in prose.
const IN_PROSE: [&str; 17] = [
    "alike", "parting", "rival", "rivals", "knob", "knobs", "kept-out", "kept out", "sag", "sags", "sagged",
    "sagging", "doubt", "doubts", "yields", "yielded", "yielding",
];

/// Replaced words inside public names.
const IN_NAMES: [&str; 12] = [
    "alike", "parting", "rival", "knob", "sag", "beside", "doubt", "bare", "carried", "yields", "yielded",
    "yielding",
];

fn project() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// All files below a folder with this ending.
pub fn files(folder: &Path, ending: &str, out: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder of the project") {
        let path = entry.expect("an entry").path();
        match path.is_dir() {
            true => files(&path, ending, out),
            false if path.extension().is_some_and(|e| e == ending) => out.push(path),
            false => {}
        }
    }
}

/// The documents, without code spans and blocks (keys and file names stay) and without what the glossary quotes.
fn documents() -> Vec<(String, String)> {
    let mut pages = vec![
        project().join("README.md"),
        project().join("CONTRIBUTING.md"),
        project().join("results/README.md"),
    ];
    files(&project().join("docs"), "md", &mut pages);
    let read = |path: PathBuf| {
        let text = fs::read_to_string(&path).expect("a page");
        let text = text.split("## Formerly called").next().unwrap_or_default().to_string();
        (path.display().to_string(), prose(&text))
    };
    pages.into_iter().map(read).collect()
}

/// Every second piece between backticks is code; a fence is three of them.
fn prose(text: &str) -> String {
    let outside_fences = text.split("```").step_by(2).collect::<String>();
    outside_fences.split('`').step_by(2).collect()
}

/// Whether a text has a word or words, bounded by what is no letter.
fn has(text: &str, word: &str) -> bool {
    let text = text.to_lowercase();
    let is_letter = |c: Option<char>| c.is_some_and(char::is_alphanumeric);
    text.match_indices(word).any(|(at, _)| {
        !is_letter(text[..at].chars().next_back()) && !is_letter(text[at + word.len()..].chars().next())
    })
}

fn help(words: &[&str]) -> String {
    let out =
        Command::new(env!("CARGO_BIN_EXE_armwright")).args(words).arg("--help").output().expect("it runs");
    String::from_utf8(out.stdout).expect("text")
}

#[test]
fn replaced_words_stay_away_from_documents_and_help() {
    let mut texts = documents();
    assert!(texts.len() > 40, "the documents are not where this test looks");
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let of_all = verbs(here, &[]);
    assert!(of_all.len() >= 18, "{of_all:?}");
    for verb in &of_all {
        texts.push((format!("armwright {verb} --help"), help(&[verb])));
        for inner in verbs(here, &[verb]) {
            texts.push((format!("armwright {verb} {inner} --help"), help(&[verb, &inner])));
        }
    }
    let mut found = Vec::new();
    for (name, text) in &texts {
        for line in text.lines() {
            let words = IN_PROSE.iter().filter(|word| has(line, word));
            found.extend(words.map(|word| format!("{name}: \"{word}\" in: {}", line.trim())));
        }
    }
    assert!(found.is_empty(), "docs/glossary.md has the words to use instead:\n{}", found.join("\n"));
}

#[test]
fn replaced_words_stay_away_from_public_names() {
    let mut sources = Vec::new();
    files(&project().join("src"), "rs", &mut sources);
    let mut found = Vec::new();
    for path in sources {
        for line in fs::read_to_string(&path).expect("a source file").lines() {
            let Some(rest) = line.trim_start().strip_prefix("pub ") else { continue };
            let kinds = [
                "const fn ",
                "unsafe fn ",
                "fn ",
                "struct ",
                "enum ",
                "trait ",
                "type ",
                "const ",
                "mod ",
                "static ",
            ];
            let rest = kinds.iter().find_map(|kind| rest.strip_prefix(kind)).unwrap_or(rest);
            let name: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            let parts = words_of(&name);
            if parts.iter().any(|part| IN_NAMES.contains(&part.as_str())) {
                found.push(format!("{}: {name}", path.display()));
            }
        }
    }
    assert!(found.is_empty(), "docs/glossary.md has the words to use instead:\n{}", found.join("\n"));
}

/// `LeastSag_m` is least, sag, m.
fn words_of(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    for c in name.chars() {
        if c == '_' || c.is_uppercase() {
            words.push(String::new());
        }
        if c != '_' {
            words.last_mut().expect("a word").extend(c.to_lowercase());
        }
    }
    words
}

#[test]
fn the_test_of_words_sees_words_and_not_parts_of_them() {
    assert!(has("the sag of a tube", "sag") && has("Sag.", "sag"));
    assert!(!has("a passage, a message", "sag"));
    assert_eq!(prose("a `kept_out` b ```\nsag\n``` c"), "a  b  c");
    assert_eq!(words_of("LeastSag_m"), ["", "least", "sag", "m"]);
}
