//! Checks the rules of docs/architecture.md on the source: for example, a room of the library uses only the rooms below
//! it.

use crate::imports::{Crate, Module, circles};
use std::fs;
use std::path::{Path, PathBuf};

/// Rooms from the ground up; rooms of one storey do not know each other.
const STOREYS: &[&[&str]] = &[
    &["input", "pareto"],
    &["catalog"],
    &["arm"],
    &["mechanics"],
    &["sizing"],
    &["space", "interchange"],
    &["search"],
    &["exact", "verify", "relax"],
    &["report"],
    &["reconcile"],
    &["paper"],
    &["study"],
    &["cli"],
];

/// The rooms within `reconcile`, in the same order.
const STOREYS_OF_RECONCILE: &[&[&str]] = &[
    &["readings"],
    &["forward"],
    &["model"],
    &["fit"],
    &["select"],
    &["verdict"],
    &["positions", "records"],
    &["found"],
    &["long"],
    &["analysis", "predict", "starter"],
    &["ruling"],
    &["together", "predict_files"],
];

/// What modules below `folder` use in a room above their own or next to it. `storeys` are the rooms of `folder` from
/// the ground up.
fn upward_arrows(folder: &[&str], storeys: &[&[&str]]) -> Vec<String> {
    let storey = |room: &str| storeys.iter().position(|rooms| rooms.contains(&room));
    let room_in = |module: &Module| {
        let inside = module.iter().zip(folder).all(|(name, of_folder)| name == of_folder);
        inside.then(|| module.get(folder.len()).cloned()).flatten()
    };
    let mut found = Vec::new();
    for (from, to) in Crate::read(&src()).uses() {
        let Some(room) = room_in(&from) else { continue };
        let Some(here) = storey(&room) else {
            found.push(format!("{}: the room \"{room}\" has no storey", from.join("::")));
            continue;
        };
        for (target, names) in to {
            let Some(other) = room_in(&target).filter(|other| *other != room) else { continue };
            if storey(&other).is_none_or(|there| there >= here) {
                found.push(format!("{} knows {}: {names:?}", from.join("::"), target.join("::")));
            }
        }
    }
    found
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

#[test]
fn no_room_knows_a_room_above_it_or_next_to_it() {
    assert!(Crate::read(&src()).modules().count() > 200, "the sources are not where this test looks");
    let found = upward_arrows(&[], STOREYS);
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn no_room_of_reconcile_knows_a_room_above_it_or_next_to_it() {
    let found = upward_arrows(&["reconcile"], STOREYS_OF_RECONCILE);
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn the_verifier_knows_nothing_of_the_search_that_it_checks() {
    let may_know = ["verify", "pareto", "catalog", "arm", "mechanics"];
    let uses = Crate::read(&src()).uses();
    let of_verifier = uses.iter().filter(|(from, _)| from.first().is_some_and(|room| room == "verify"));
    let targets = of_verifier.flat_map(|(from, to)| to.keys().map(move |target| (from, target)));
    let others: Vec<String> = targets
        .filter(|(_, target)| target.first().is_some_and(|room| !may_know.contains(&room.as_str())))
        .map(|(from, target)| format!("{} knows {}", from.join("::"), target.join("::")))
        .collect();
    assert!(others.is_empty(), "{}", others.join("\n"));
}

#[test]
fn no_files_use_each_other_in_a_circle() {
    let uses = Crate::read(&src()).uses();
    let tied = |circle: &Vec<Module>| {
        let inside = |from: &Module| {
            let to = uses.get(from).into_iter().flatten().filter(|(to, _)| circle.contains(to));
            to.map(|(to, names)| format!("  {} -> {}: {names:?}\n", from.join("::"), to.join("::")))
                .collect::<String>()
        };
        format!("{} files:\n{}", circle.len(), circle.iter().map(inside).collect::<String>())
    };
    let found = circles(&uses);
    assert!(
        found.is_empty(),
        "circles of files: {}\n{}",
        found.len(),
        found.iter().map(tied).collect::<String>()
    );
}

#[test]
fn a_circle_through_a_re_export_is_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("written");
    write("lib.rs", "mod a;\nmod b;\npub use a::One;\n");
    write(
        "a.rs",
        "pub struct One;\nfn f() { crate::b::g(); }\n#[cfg(test)]\nmod tests { use crate::b::h; }\n",
    );
    write("b.rs", "pub fn g() {}\npub fn h() {}\n");
    assert_eq!(circles(&Crate::read(folder.path()).uses()), Vec::<Vec<Module>>::new());
    write("b.rs", "use crate::One;\npub fn g() {}\npub fn h(_: One) {}\n");
    let circle = vec![vec!["a".to_string()], vec!["b".to_string()]];
    assert_eq!(circles(&Crate::read(folder.path()).uses()), vec![circle]);
}

#[test]
fn the_ground_floors_print_nothing_and_read_no_files() {
    // these rooms are mathematics: what they say, others print
    for room in ["pareto", "mechanics", "sizing", "space", "search", "exact", "verify", "relax"] {
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

/// Most lines of a file.
const MOST_OF_FILE: usize = 600;
/// Most lines of a function of `src`.
const MOST_OF_FUNCTION: usize = 60;

/// The first line of every function, and its number of lines. A function ends with a brace that is indented as far as
/// its first line.
fn functions(text: &str) -> Vec<(&str, usize)> {
    let lines: Vec<&str> = text.lines().collect();
    let is_head = |line: &str| {
        let words = line.trim_start().split_once("fn ").map(|(words, _)| words);
        let may_stand =
            |word: &str| ["pub", "const", "unsafe", "extern"].contains(&word) || word.starts_with("pub(");
        words.is_some_and(|words| words.split_whitespace().all(may_stand))
    };
    let length = |at: usize| {
        let indentation = lines[at].len() - lines[at].trim_start().len();
        let last = format!("{}}}", " ".repeat(indentation));
        let is_one_line = lines[at].ends_with(['}', ';']);
        let more = if is_one_line { Some(0) } else { lines[at..].iter().position(|line| *line == last) };
        more.map(|more| more + 1)
    };
    let heads = (0..lines.len()).filter(|at| is_head(lines[*at]));
    heads.filter_map(|at| Some((lines[at].trim(), length(at)?))).collect()
}

#[test]
fn files_and_functions_are_short() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut long = Vec::new();
    for folder in ["src", "tests", "benches", "python/src"] {
        let mut files = Vec::new();
        source_files(&root.join(folder), &mut files);
        for file in files {
            let text = fs::read_to_string(&file).expect("a source file");
            let lines = text.lines().count();
            if lines > MOST_OF_FILE {
                long.push(format!("{}: {lines} lines", file.display()));
            }
            let is_long = |(_, lines): &(&str, usize)| *lines > MOST_OF_FUNCTION && folder == "src";
            let functions = functions(&text).into_iter().filter(is_long);
            long.extend(functions.map(|(head, lines)| format!("{}: {head} {lines} lines", file.display())));
        }
    }
    assert!(long.is_empty(), "{}", long.join("\n"));
    let body = "let a = 1;\n".repeat(61);
    let text = format!("impl A {{\n    pub(super) fn long() {{\n{body}    }}\n    fn short() {{}}\n}}\n");
    assert_eq!(functions(&text), [("pub(super) fn long() {", 63), ("fn short() {}", 1)]);
}
