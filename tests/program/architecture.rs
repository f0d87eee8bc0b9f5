//! The house: a room of the library knows only the rooms below it (docs/architecture.md).

use std::fs;
use std::path::{Path, PathBuf};

/// Rooms from the ground up; rooms of one storey do not know each other.
const STOREYS: &[&[&str]] = &[
    &["fault"],
    &["catalog"],
    &["arm"],
    &["mechanics"],
    &["sizing"],
    &["search"],
    &["report", "export"],
    &["reconcile"],
    &["study"],
    &["cli"],
];

fn storey(room: &str) -> Option<usize> {
    STOREYS.iter().position(|rooms| rooms.contains(&room))
}

fn source_files(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder of the crate") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            source_files(&path, out);
        } else if path.extension().is_some_and(|e| e == "rs") {
            out.push(path);
        }
    }
}

/// The room a file belongs to: `src/arm/file.rs` and `src/arm.rs` are in `arm`.
fn room_of(file: &Path) -> String {
    let inside = file.strip_prefix(src()).expect("a file of src");
    let first = inside.components().next().expect("a name").as_os_str().to_string_lossy().into_owned();
    first.trim_end_matches(".rs").to_string()
}

fn src() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// Code without comments and without the unit tests at its end, which may call a witness from any room.
fn code(text: &str) -> String {
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let lines = text.lines().map(|line| line.split("//").next().unwrap_or_default());
    lines.collect::<Vec<_>>().join("\n")
}

/// The rooms a text names: `crate::arm::...` and `use crate::{arm, catalog::...}`.
fn rooms_named(code: &str) -> Vec<String> {
    let mut rooms = Vec::new();
    for rest in code.split("crate::").skip(1) {
        match rest.strip_prefix('{') {
            None => rooms.push(word(rest)),
            Some(list) => {
                let mut depth = 0;
                let mut item = String::new();
                for c in list.chars() {
                    match c {
                        '{' => depth += 1,
                        '}' if depth == 0 => break,
                        '}' => depth -= 1,
                        ',' if depth == 0 => rooms.push(word(std::mem::take(&mut item).trim())),
                        _ if depth == 0 => item.push(c),
                        _ => {}
                    }
                }
                rooms.push(word(item.trim()));
            }
        }
    }
    rooms.retain(|room| src().join(room).is_dir() || src().join(format!("{room}.rs")).is_file());
    rooms
}

fn word(text: &str) -> String {
    text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

#[test]
fn no_room_knows_a_room_above_it_or_beside_it() {
    let mut files = Vec::new();
    source_files(&src(), &mut files);
    assert!(files.len() > 20, "the sources are not where this test looks");
    let mut violations = Vec::new();
    for file in files.iter().filter(|f| !f.ends_with("src/lib.rs") && !f.ends_with("src/main.rs")) {
        let room = room_of(file);
        let Some(here) = storey(&room) else {
            violations.push(format!("{}: the room \"{room}\" has no storey", file.display()));
            continue;
        };
        let text = fs::read_to_string(file).expect("a source file");
        for other in rooms_named(&code(&text)).into_iter().filter(|other| *other != room) {
            if storey(&other).is_none_or(|there| there >= here) {
                violations.push(format!("{}: {room} knows {other}", file.display()));
            }
        }
    }
    violations.dedup();
    assert!(violations.is_empty(), "{}", violations.join("\n"));
}

#[test]
fn the_ground_floors_print_nothing_and_read_no_files() {
    // mechanics, sizing and search are mathematics: what they say, others print
    for room in ["mechanics", "sizing", "search"] {
        let mut files = Vec::new();
        source_files(&src().join(room), &mut files);
        for file in files {
            let text = fs::read_to_string(&file).expect("a source file");
            let code = code(&text);
            for io in ["println!", "print!(", "std::fs", "fs_err", "std::io"] {
                assert!(!code.contains(io), "{} uses {io}", file.display());
            }
        }
    }
}

#[test]
fn only_the_command_line_prints() {
    let mut files = Vec::new();
    source_files(&src(), &mut files);
    for file in files.iter().filter(|f| !["cli", "main"].contains(&room_of(f).as_str())) {
        let text = fs::read_to_string(file).expect("a source file");
        let code = code(&text);
        assert!(!code.contains("println!"), "{} prints", file.display());
    }
}

#[test]
fn every_file_says_what_it_is_for() {
    let mut files = Vec::new();
    source_files(&src(), &mut files);
    for file in files {
        let text = fs::read_to_string(&file).expect("a source file");
        assert!(text.starts_with("//!"), "{} does not open with a paragraph", file.display());
    }
}
