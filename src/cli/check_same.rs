//! Compares two folders of results, without the numbers that depend on the time and on the machine.

use super::failure::Failure;
use super::manifest::{CHOICES, MANIFESTS, OF_A_RUN, OWN_HASH, PAGE, RUN, SHARD, SUMMARY, VERDICT};
use super::result_folder::complete;
use crate::report::summary::TIMING;
use crate::report::whole_file::folder_of;
use minijinja::HtmlEscape;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Texts in summary.md and report.html that are followed by the name of the folder of results. The name is left out of
/// the comparison, because each result is in a folder of its own.
const COMMANDS: [&str; 5] =
    ["armwright design ", "armwright analyze ", "armwright compare ", "armwright front check ", " --cases "];

/// Keys with the hashes of the files of a result and of the manifest. They depend on the times in these files.
const OF_THE_FILES: [&str; 2] = ["files", OWN_HASH];

/// Compares the folders of results `a` and `b`. If both results are the same, returns a sentence that says so.
///
/// # Errors
/// The folders differ, with the names of the files that differ; or one of them cannot be read, or has no files.
pub(super) fn same(a: &Path, b: &Path) -> Result<String, Failure> {
    complete(a).and_then(|()| complete(b))?;
    let names = files_of(a)?;
    let others = files_of(b)?;
    for (folder, names) in [(a, &names), (b, &others)] {
        if names.is_empty() {
            return Err(Failure::File(format!("{} has no files to compare", folder.display())));
        }
    }
    let mut faults = Vec::new();
    for name in names.union(&others) {
        match (names.contains(name), others.contains(name)) {
            (true, false) => faults.push(format!("{name} is only in {}", a.display())),
            (false, true) => faults.push(format!("{name} is only in {}", b.display())),
            _ if neutral(a, name)? != neutral(b, name)? => faults.push(format!("{name} differs")),
            _ => {}
        }
    }
    match faults.is_empty() {
        true => Ok(format!("{} files are the same outside of the marked timings\n", names.len())),
        false => Err(Failure::Check(format!(
            "{} and {} are not the same\n  {}",
            a.display(),
            b.display(),
            faults.join("\n  ")
        ))),
    }
}

/// Names of all files of a folder and of the folders in it. Names that begin with a dot are left out. In a folder that
/// has a result, folders of shards are left out too, because each is a result by itself.
fn files_of(folder: &Path) -> Result<BTreeSet<String>, Failure> {
    let mut names = BTreeSet::new();
    let mut open = vec![PathBuf::new()];
    let is_result = MANIFESTS.iter().any(|manifest| folder.join(manifest).is_file());
    while let Some(inside) = open.pop() {
        let here = folder.join(&inside);
        for entry in fs_err::read_dir(&here).map_err(|e| Failure::File(e.to_string()))? {
            let entry = entry.map_err(|e| Failure::file(&here, "read", &e))?;
            let name = inside.join(entry.file_name());
            if entry.file_name().to_string_lossy().starts_with('.') {
                continue;
            }
            match entry.path().is_dir() {
                true if is_result && entry.path().join(SHARD).is_file() => {}
                true => open.push(name),
                false => drop(names.insert(name.to_string_lossy().into_owned())),
            }
        }
    }
    Ok(names)
}

/// The bytes of the file `name`, without the parts that depend on the time, the machine and the name of the folder.
fn neutral(folder: &Path, name: &str) -> Result<Vec<u8>, Failure> {
    let bytes = fs_err::read(folder.join(name)).map_err(|e| Failure::File(e.to_string()))?;
    let inside = folder_of(&folder.join(name));
    // the result of a campaign has results of studies in subfolders, so the last part of the name decides what the file
    // is
    Ok(match Path::new(name).file_name().and_then(|name| name.to_str()) {
        // the hashes of files that contain times differ from run to run as well
        Some(RUN | SHARD | CHOICES) => without_keys(bytes, &[&OF_A_RUN[..], &OF_THE_FILES].concat()),
        Some(VERDICT) => without_keys(bytes, &OF_THE_FILES),
        Some(SUMMARY | PAGE) => without_timing(bytes, typed_as(&inside).as_deref()),
        _ => bytes,
    })
}

fn without_keys(bytes: Vec<u8>, keys: &[&str]) -> Vec<u8> {
    let Ok(Value::Object(mut run)) = serde_json::from_slice(&bytes) else { return bytes };
    keys.iter().for_each(|key| drop(run.remove(*key)));
    Value::Object(run).to_string().into_bytes()
}

fn without_timing(bytes: Vec<u8>, folder: Option<&str>) -> Vec<u8> {
    let Ok(mut text) = String::from_utf8(bytes.clone()) else { return bytes };
    while let Some(start) = text.find(TIMING[0])
        && let Some(length) = text[start..].find(TIMING[1])
    {
        text.replace_range(start..start + length + TIMING[1].len(), "");
    }
    for folder in folder.into_iter().flat_map(|plain| [plain.to_string(), HtmlEscape(plain).to_string()]) {
        for command in COMMANDS {
            text = text.replace(&format!("{command}{folder}"), command);
        }
    }
    text.into_bytes()
}

/// The folder of results as the user typed it when the results were written, taken from a command in the summary.
/// `None` if the summary is missing or has no such command.
fn typed_as(folder: &Path) -> Option<String> {
    let summary = std::fs::read_to_string(folder.join(SUMMARY)).ok()?;
    summary.lines().find_map(|line| line.strip_prefix(COMMANDS[2])).map(String::from)
}
