//! Every reader of input gets files that were changed at random. None may panic or hang, and every exit code must be in
//! the table of exit codes.
//!
//! The changes are those of a fuzzer: bits, spans, lines, numbers at the limits of what can be written, and whole
//! values of JSON. They are the same in every run. `ARMWRIGHT_MUTATIONS=20000` sets the number of changed files for
//! each reader, and `ARMWRIGHT_MUTATIONS_FROM=7` the first seed.

use armwright::catalog::Catalogs;
use armwright::command_line::{Cli, run};
use armwright::reconcile::Campaign;
use armwright::search::SweepState;
use clap::Parser;
use serde_json::{Value, json};
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Mutations of each reader, if nothing is said.
const DEFAULT: u64 = 50;
/// A file that takes longer hangs the program, as far as a user can tell. A debug build beside others is slow.
const LONGEST: Duration = Duration::from_secs(20);

fn from_env(name: &str, default: u64) -> u64 {
    std::env::var(name).ok().and_then(|n| n.parse().ok()).unwrap_or(default)
}

/// Numbers that look random (Steele, Lea and Flood, "Fast splittable pseudorandom number generators", 2014).
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Below `n`, which is not 0.
    fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    fn of<'a, T: ?Sized>(&mut self, items: &[&'a T]) -> &'a T {
        items[self.below(items.len())]
    }
}

/// Texts that stand where a number or a word was.
const ODD: [&str; 24] = [
    "",
    "0",
    "-0",
    "-1",
    "1e308",
    "-1e308",
    "1e-320",
    "1e999",
    "nan",
    "inf",
    "null",
    "true",
    "18446744073709551616",
    "340282366920938463463374607431768211456",
    "0.1.2",
    "1,2",
    "\u{202e}x",
    "\u{0}",
    "=1+1",
    "..",
    "[]",
    "{}",
    "\"",
    "e",
];

/// A file with a random change or a few of them.
fn changed(file: &[u8], dice: &mut Dice) -> Vec<u8> {
    let mut out = file.to_vec();
    let json = serde_json::from_slice::<Value>(file).ok();
    for _ in 0..=dice.below(3) {
        match (dice.below(3), &json) {
            (0 | 1, Some(_)) => {
                if let Ok(mut value) = serde_json::from_slice::<Value>(&out) {
                    change_value(&mut value, dice);
                    out = value.to_string().into_bytes();
                }
            }
            (0 | 1, None) => change_words(&mut out, dice),
            _ => change_bytes(&mut out, dice),
        }
    }
    out
}

/// Changes bytes: a bit, a span that is dropped, doubled or moved, an end that is cut off, bytes that are no text.
fn change_bytes(bytes: &mut Vec<u8>, dice: &mut Dice) {
    if bytes.is_empty() {
        return bytes.extend(b"x");
    }
    let at = dice.below(bytes.len());
    let end = (at + 1 + dice.below(40)).min(bytes.len());
    match dice.below(7) {
        0 => bytes[at] ^= 1 << dice.below(8),
        1 => drop(bytes.drain(at..end)),
        2 => {
            let span = bytes[at..end].to_vec();
            let times = 1 + dice.below(50);
            bytes.splice(at..at, span.repeat(times));
        }
        3 => bytes.truncate(at),
        4 => drop(bytes.splice(at..at, [0xff, 0xfe, 0x00, 0xef, 0xbb, 0xbf])),
        5 => {
            drop(bytes.splice(
                at..at,
                dice.of(&["[", "{\"a\":", "\"\n", ",,,", "\r", ";"]).repeat(300).into_bytes(),
            ))
        }
        _ => {
            let odd = dice.of(&ODD);
            bytes.splice(at..end, odd.bytes());
        }
    }
}

/// Changes cells or lines of a table.
fn change_words(bytes: &mut Vec<u8>, dice: &mut Dice) {
    let text = String::from_utf8_lossy(bytes).into_owned();
    let mut lines: Vec<String> = text.lines().map(String::from).collect();
    if lines.is_empty() {
        return;
    }
    let (at, other) = (dice.below(lines.len()), dice.below(lines.len()));
    match dice.below(5) {
        0 => lines.swap(at, other),
        1 => drop(lines.remove(at)),
        2 => lines.insert(other, lines[at].clone()),
        3 => lines[at] = lines[other].clone(),
        _ => {
            let mut cells: Vec<&str> = lines[at].split(',').collect();
            let cell = dice.below(cells.len());
            cells[cell] = dice.of(&ODD);
            lines[at] = cells.join(",");
        }
    }
    *bytes = (lines.join("\n") + "\n").into_bytes();
}

/// Changes one value somewhere in a document.
fn change_value(value: &mut Value, dice: &mut Dice) {
    let donor = value.clone();
    let deeper = dice.below(6) > 0;
    match value {
        Value::Object(map) if deeper && !map.is_empty() => {
            let keys: Vec<String> = map.keys().cloned().collect();
            let key = &keys[dice.below(keys.len())];
            match dice.below(12) {
                0 => drop(map.remove(key)),
                1 => {
                    let moved = map.remove(key).unwrap_or_default();
                    map.insert(format!("{key}x"), moved);
                }
                _ => change_value(&mut map[key], dice),
            }
        }
        Value::Array(items) if deeper && !items.is_empty() => {
            let at = dice.below(items.len());
            match dice.below(8) {
                0 => drop(items.remove(at)),
                1 => items.insert(at, items[at].clone()),
                _ => change_value(&mut items[at], dice),
            }
        }
        _ => {
            let odd = dice.of(&ODD);
            *value = match dice.below(5) {
                0 => serde_json::from_str(odd).unwrap_or_default(),
                1 => Value::from(odd),
                2 => Value::from([-1.0, 0.0, 1e308, 5e-324, 1e15, 0.5, 1e6][dice.below(7)]),
                3 => Value::from(vec![donor; 1 + dice.below(3)]),
                _ => [Value::Null, Value::Bool(true), Value::from(-7), Value::from("j2")][dice.below(4)]
                    .clone(),
            };
        }
    }
}

/// Gives a reader changed versions of a file in a folder. `read` says why it failed if that is no answer at all.
fn every_change(what: &str, folder: &Path, file: &str, read: impl Fn(&Path) -> Result<(), String>) {
    changes(from_env("ARMWRIGHT_MUTATIONS", DEFAULT), what, folder, file, read);
}

/// The same with so many changes.
fn changes(count: u64, what: &str, folder: &Path, file: &str, read: impl Fn(&Path) -> Result<(), String>) {
    let from = from_env("ARMWRIGHT_MUTATIONS_FROM", 1);
    let path = folder.join(file);
    let sound = fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    read(folder).unwrap_or_else(|why| panic!("{what}: the file as it is: {why}"));
    let (mut faults, mut slowest) = (Vec::new(), Duration::ZERO);
    for seed in from..from + count {
        fs::write(&path, changed(&sound, &mut Dice(seed))).expect("written");
        let begun = Instant::now();
        let answer = catch_unwind(AssertUnwindSafe(|| read(folder)));
        let took = begun.elapsed();
        slowest = slowest.max(took);
        match answer {
            Ok(Ok(())) if took <= LONGEST => {}
            Ok(Ok(())) => faults.push(format!("seed {seed}: {took:?}")),
            Ok(Err(why)) => faults.push(format!("seed {seed}: {why}")),
            Err(_) => faults.push(format!("seed {seed}: a panic")),
        }
    }
    fs::write(&path, sound).expect("written");
    eprintln!("{what}: {count} changes, the slowest {slowest:?}");
    assert!(faults.is_empty(), "{what}, {file}:\n{}", faults.join("\n"));
}

/// Runs a command line in this process. An internal error is no answer.
fn answers(words: &[&str]) -> Result<(), String> {
    let cli = Cli::try_parse_from([&["armwright"], words].concat()).map_err(|e| e.to_string())?;
    match run(cli) {
        Err(failure) if failure.exit_code() == 1 => Err(failure.to_string()),
        _ => Ok(()),
    }
}

fn source(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// A copy of some files of the repository in a folder of its own.
fn copy_of(files: &[&str]) -> tempfile::TempDir {
    let here = tempfile::tempdir().expect("a folder");
    for file in files {
        let from = source(file);
        fs::copy(&from, here.path().join(from.file_name().expect("a name"))).expect("copied");
    }
    here
}

fn word(path: &Path) -> &str {
    path.to_str().expect("a name")
}

#[test]
fn a_changed_arm_file_is_read_or_refused() {
    let here = copy_of(&["examples/measured-arm/arm.json", "tests/data/frozen/39n20/cases.json"]);
    every_change("arm file", here.path(), "arm.json", |here| {
        answers(&["analyze", word(&here.join("arm.json")), "--json"])
    });
    let here = copy_of(&["tests/data/frozen/39n20/arm.json", "tests/data/frozen/39n20/cases.json"]);
    every_change("cases", here.path(), "cases.json", |here| {
        answers(&["analyze", word(&here.join("arm.json")), "--cases", word(&here.join("cases.json"))])
    });
}

#[test]
fn a_changed_study_is_read_or_refused() {
    for study in ["examples/bench-arm.json", "studies/underwater-arm.json"] {
        let here = copy_of(&[study]);
        let file = study.rsplit('/').next().expect("a name");
        every_change(study, here.path(), file, |here| answers(&["size", word(&here.join(file))]));
    }
}

#[test]
fn a_changed_catalog_is_read_or_refused() {
    for name in
        ["gears.csv", "motors.csv", "materials.csv", "profiles.csv", "actuators.csv", "motor_curves.csv"]
    {
        let here = tempfile::tempdir().expect("a folder");
        let text = fs::read_to_string(source("catalogs").join(name)).expect("a catalog");
        let rows: Vec<&str> = text.lines().take(12).collect();
        fs::write(here.path().join(name), rows.join("\n") + "\n").expect("written");
        every_change(name, here.path(), name, |here| {
            let _ = Catalogs::load(Some(here));
            Ok(())
        });
    }
}

#[test]
fn a_changed_campaign_is_read_or_refused() {
    let measured = ["arm.json", "campaign.json", "static.csv", "modal.csv", "windup.csv"];
    let measured = measured.map(|file| format!("examples/measured-arm/{file}"));
    let positions = ["arm.json", "campaign.json", "positions.csv"];
    let positions =
        positions.map(|file| format!("tests/data/positions_other_simulator/parallel-axes/{file}"));
    let catalogs = Catalogs::builtin();
    let read = |here: &Path| {
        let _ = Campaign::read(here, &catalogs);
        Ok(())
    };
    for files in [&measured[..], &positions[..]] {
        let here = copy_of(&files.iter().map(String::as_str).collect::<Vec<_>>());
        for file in &files[1..] {
            let file = file.rsplit('/').next().expect("a name");
            every_change(file, here.path(), file, read);
        }
    }
}

#[test]
fn a_changed_record_or_spreadsheet_is_read_or_refused() {
    let catalogs = Catalogs::builtin();
    let read = |here: &Path| {
        let _ = Campaign::read(here, &catalogs);
        Ok(())
    };
    let folder = "tests/data/records/kuka_kr300";
    let here = copy_of(&[&format!("{folder}/arm.json"), &format!("{folder}/campaign.json")]);
    let other = fs::read(source(folder).join("record_b.csv")).expect("a record");
    fs::write(here.path().join("record_b.csv"), other).expect("written");
    // a few rows are enough to be read
    let text = fs::read_to_string(source(folder).join("record_a.csv")).expect("a record");
    let rows: Vec<&str> = text.lines().take(60).collect();
    fs::write(here.path().join("record_a.csv"), rows.join("\n") + "\n").expect("written");
    every_change("record", here.path(), "record_a.csv", read);
    for sheet in ["gauge.xlsx", "gauge.ods"] {
        let folder = "tests/data/dial_gauge/full_conn";
        let here = copy_of(&[
            &format!("{folder}/arm.json"),
            &format!("{folder}/campaign.json"),
            &format!("tests/data/spreadsheets/{sheet}"),
        ]);
        let campaign = here.path().join("campaign.json");
        let mut stated: Value =
            serde_json::from_slice(&fs::read(&campaign).expect("a campaign")).expect("JSON");
        stated["files"] = json!({"static": {"file": sheet, "sheet": "May", "header_row": 3}});
        stated["columns"] = json!({"static": {
            "test": "No", "q_j2_deg": "Shoulder", "q_j3_deg": "Elbow", "payload_kg": "Mass", "dz_mm": "Gauge 1",
            "sigma_mm": "Gauge sd"
        }});
        fs::write(&campaign, stated.to_string()).expect("written");
        every_change(sheet, here.path(), sheet, read);
    }
}

#[test]
fn a_changed_result_is_read_or_refused() {
    let here = tempfile::tempdir().expect("a folder");
    let study = here.path().join("study.json");
    fs::write(&study, crate::whole_results::study("small", 3.0)).expect("written");
    let out = here.path().join("out");
    answers(&["run", word(&study), "--out", word(&out)]).expect("it runs");
    let design = word(&here.path().join("design")).to_string();
    // a reader looks again for half a second before it says that files do not belong together
    let fewer = from_env("ARMWRIGHT_MUTATIONS", DEFAULT) / 5;
    changes(fewer, "run.json", &out, "run.json", |out| {
        answers(&["design", word(out), "x0", "--out", &design])
    });
    let parts = here.path().join("parts");
    let part = parts.join("1-of-1");
    answers(&["run", word(&study), "--shard", "1/1", "--out", word(&part)]).expect("it runs");
    let joined = word(&here.path().join("joined")).to_string();
    every_change("shard.json", &part, "shard.json", |_| {
        answers(&["merge", word(&parts), "--out", &joined]).and(answers(&["status", word(&parts)]))
    });
    // the list of the files agrees with what was changed, so that the candidates are read
    every_change("candidates.csv", &part, "candidates.csv", |part| {
        let manifest = part.join("shard.json");
        let mut list: Value = serde_json::from_slice(&fs::read(&manifest).expect("a list")).expect("JSON");
        let bytes = fs::read(part.join("candidates.csv")).expect("candidates");
        list["files"]["candidates.csv"] = Value::from(blake3::hash(&bytes).to_hex().to_string());
        fs::write(&manifest, list.to_string()).expect("written");
        answers(&["merge", word(&parts), "--out", &joined])
    });
}

#[test]
fn a_changed_state_of_a_search_is_read_or_refused() {
    let here = tempfile::tempdir().expect("a folder");
    let study = here.path().join("study.json");
    fs::write(&study, crate::whole_results::study("small", 3.0)).expect("written");
    let out = here.path().join("out");
    let state = out.join(".armwright");
    fs::create_dir_all(&state).expect("made");
    fs::write(state.join("search.unfinished"), b"{\"elapsed_s\": 1, \"hash\": \"\"}\n\x01\x02")
        .expect("written");
    every_change("state", &state, "search.unfinished", |_| {
        answers(&["run", word(&study), "--search", "exhaustive", "--out", word(&out)])
    });
    let bytes = SweepState::default().to_bytes();
    fs::write(state.join("bytes"), [&bytes[..], &[1, 2, 3]].concat()).expect("written");
    every_change("bytes of a state", &state, "bytes", |state| {
        let _ = SweepState::from_bytes(&fs::read(state.join("bytes")).expect("bytes"));
        Ok(())
    });
}
