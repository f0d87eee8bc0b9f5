//! Files that a verb writes outside of results: it replaces its own files, and no others.
//!
//! A file is a verb's own in three cases: it has the content that the verb would write; it is unchanged since the
//! program wrote it, by the list that the folder keeps (`.armwright/written.json`); or its content shows that the
//! program wrote it ([`write_recognized`]).

use super::failure::Failure;
use super::links::{has_strange_parent, is_there, refuse_link};
use super::manifest::hash;
use super::stop::together;
use super::write::write_all;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;

/// Name of the list of files in a folder that the program wrote, each with a hash of its content.
const LIST: &str = ".armwright/written.json";

/// Writes files into a folder and adds them to its list.
///
/// # Errors
/// A file cannot be written, is one of the `inputs`, belongs to a result, or would replace a file that is not on the
/// list or was changed since.
pub(super) fn write_own(folder: &Path, files: &[(String, Vec<u8>)], inputs: &[&Path]) -> Result<(), Failure> {
    refuse_link(&folder.join(".armwright"))?;
    let listed = listed(folder);
    write_recognized(folder, files, inputs, |name, there| listed.get(name) == Some(&hash(there)))?;
    let new = files.iter().map(|(name, bytes)| (name.clone(), hash(bytes)));
    let list: BTreeMap<String, String> = listed.clone().into_iter().chain(new).collect();
    let text = format!("{:#}\n", json!({"schema_version": 1, "files": list}));
    write_all(folder, &[(LIST.into(), text.into_bytes())], &[])
}

/// Writes files into a folder. `is_own` takes the name and the content of an existing file, and says whether it may be
/// replaced.
///
/// # Errors
/// A file cannot be written, is one of the `inputs`, belongs to a result, or would replace another file with other
/// content.
pub(super) fn write_recognized(
    folder: &Path,
    files: &[(String, Vec<u8>)],
    inputs: &[&Path],
    is_own: impl Fn(&str, &[u8]) -> bool,
) -> Result<(), Failure> {
    let is_foreign = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        let may_be_replaced = || match path.is_file().then(|| std::fs::read(&path)) {
            Some(Ok(there)) => there == bytes || is_own(name, &there),
            _ => false,
        };
        has_strange_parent(folder, name) || is_there(&path) && !may_be_replaced()
    };
    super::write::refuse_overwriting(
        &files.iter().map(|(name, _)| folder.join(name)).collect::<Vec<_>>(),
        inputs,
    )?;
    let foreign: Vec<&str> =
        files.iter().filter(|(name, bytes)| is_foreign(name, bytes)).map(|(name, _)| name.as_str()).collect();
    if foreign.is_empty() {
        return together(|| write_all(folder, files, inputs));
    }
    Err(Failure::Usage(format!(
        "{} has files that this command did not write, or that were changed since, and that it would replace: {}; move \
         them, or choose another place with --out",
        folder.display(),
        foreign.join(", ")
    )))
}

/// The files on the list of a folder, with their hashes; none if there is no list.
fn listed(folder: &Path) -> BTreeMap<String, String> {
    let text = std::fs::read_to_string(folder.join(LIST)).unwrap_or_default();
    let list: Value = serde_json::from_str(&text).unwrap_or_default();
    let files = list["files"].as_object().into_iter().flatten();
    files.filter_map(|(name, hash)| Some((name.clone(), hash.as_str()?.to_string()))).collect()
}
