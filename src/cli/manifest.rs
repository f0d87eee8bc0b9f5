//! The manifest of a result: a list of its files with a hash of each. It is the key `files` of `run.json`,
//! `verdict.json`, `shard.json` or `choices.json`. This file is written after all others, so that its presence shows
//! that the result is complete.

use super::failure::Failure;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::path::{Component, Path};

/// Name of the file that lists the files of a study's result.
pub(super) const RUN: &str = "run.json";
/// Name of the file that lists the files of a campaign's result.
pub(super) const VERDICT: &str = "verdict.json";
/// Name of the file that lists the files of a shard of a search.
pub(super) const SHARD: &str = "shard.json";
/// Name of the file that lists the files of a study that was searched choice by choice.
pub(super) const CHOICES: &str = "choices.json";
/// Name of the table of the designs on a front.
pub(super) const FRONT: &str = "front.csv";
/// Name of the copy of the study in its result.
pub(super) const STUDY: &str = "study.json";
/// Name of the picture of a front.
pub(super) const PICTURE: &str = "front.svg";
/// Name of the summary of a result in words.
pub(super) const SUMMARY: &str = "summary.md";
/// Name of the page of a result.
pub(super) const PAGE: &str = "report.html";
/// Keys of [`RUN`] and [`SHARD`] that differ from run to run: times and the machine.
pub(super) const OF_A_RUN: [&str; 4] = ["elapsed_s", "designs_per_s", "threads", "platform"];
/// Names of all files that may have a manifest.
pub(super) const MANIFESTS: [&str; 4] = [RUN, VERDICT, SHARD, CHOICES];
/// Key of the hash of the other keys of a manifest, but for those of [`OF_A_RUN`].
pub(super) const OWN_HASH: &str = "manifest_hash";

/// Names and contents of files. The names are relative to a folder of results.
pub(super) type Files = Vec<(String, Vec<u8>)>;

/// The files in a folder that belong to an earlier result.
pub(super) enum Earlier {
    /// There is no earlier result.
    Nothing,
    /// Nothing says which files are those of the result: it is from an early version that listed no files, or the
    /// manifest lost its contents. Every file with the name of a result file may be replaced.
    Unlisted,
    /// The listed files, each with its hash.
    Listed(BTreeMap<String, String>),
}

impl Earlier {
    /// The earlier result in a folder. `manifest` is the name of the file that lists its files.
    ///
    /// # Errors
    /// The manifest exists, but cannot be read.
    pub(super) fn read(folder: &Path, manifest: &str) -> Result<Self, Failure> {
        let path = folder.join(manifest);
        let text = match std::fs::read_to_string(&path) {
            Ok(text) => text,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(Earlier::Nothing),
            Err(e) => return Err(Failure::file(&path, "read", &e)),
        };
        if is_empty(text.as_bytes()) {
            return Ok(Earlier::Unlisted);
        }
        let value: Value = serde_json::from_str(&text).unwrap_or_default();
        let is_ours = ["study", "verdict"].iter().any(|key| value.get(key).is_some());
        Ok(match (is_ours, listed(&value)) {
            (true, Some(listed)) => Earlier::Listed(listed),
            (true, None) => Earlier::Unlisted,
            (false, _) => Earlier::Nothing,
        })
    }

    /// Whether a file of this name belongs to the earlier result. `manifest` is the name of the file that lists the
    /// others, and belongs to the result as well.
    pub(super) fn has(&self, name: &str, manifest: &str) -> bool {
        match self {
            Earlier::Nothing => false,
            Earlier::Unlisted => true,
            Earlier::Listed(files) => name == manifest || files.contains_key(name),
        }
    }

    /// The names of the files of the earlier result that are listed.
    pub(super) fn names(&self) -> impl Iterator<Item = &String> {
        let listed = match self {
            Earlier::Listed(files) => Some(files.keys()),
            _ => None,
        };
        listed.into_iter().flatten()
    }
}

/// The files that `manifest` lists, with their hashes; `None` if it has no list. Names that lead out of the folder are
/// left out, so that no file outside of it is touched.
pub(super) fn listed(manifest: &Value) -> Option<BTreeMap<String, String>> {
    let files = manifest.get("files")?.as_object()?;
    let listed = files.iter().filter(|(name, _)| stays_inside(name));
    Some(listed.map(|(name, hash)| (name.clone(), hash.as_str().unwrap_or_default().to_string())).collect())
}

/// Whether the folder has a manifest of this name with contents. A power failure can leave an empty file. A manifest that
/// cannot be read counts as one with contents, so that its reader says why.
pub(super) fn has_manifest(folder: &Path, manifest: &str) -> bool {
    match std::fs::read(folder.join(manifest)) {
        Ok(bytes) => !is_empty(&bytes),
        Err(e) => e.kind() != std::io::ErrorKind::NotFound,
    }
}

/// Whether a file has no contents: no byte, or only bytes that are zero, as after a power failure.
fn is_empty(bytes: &[u8]) -> bool {
    bytes.iter().all(|byte| *byte == 0)
}

/// Whether a manifest still says what was written. A manifest of an early version without a hash of its own counts as
/// unchanged.
pub(super) fn is_as_written(manifest: &Value) -> bool {
    let Some(keys) = manifest.as_object() else { return false };
    keys.get(OWN_HASH).is_none_or(|written| written.as_str() == Some(&own_hash(keys)))
}

/// Hash of the keys of a manifest that are the same in every run.
fn own_hash(keys: &Map<String, Value>) -> String {
    let varies = |key: &str| key == OWN_HASH || OF_A_RUN.contains(&key);
    let kept = keys.iter().filter(|(key, _)| !varies(key)).map(|(key, value)| (key.clone(), value.clone()));
    hash(Value::Object(kept.collect()).to_string().as_bytes())
}

/// Whether a relative name stays inside its folder.
fn stays_inside(name: &str) -> bool {
    !name.is_empty() && Path::new(name).components().all(|part| matches!(part, Component::Normal(_)))
}

/// A hash of the contents of a file, by which the file is recognized.
pub(super) fn hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

/// The reason, in words, why the file `name` of the result was not written: a file of this name exists that is not part
/// of a result, and it must not be overwritten.
pub(super) fn another_stands(name: &str) -> String {
    format!("{name}: a file that is no part of the result stands there")
}

/// The files of a result, with two lists and a hash added to the file named `manifest`, which comes last: `files` has the
/// hashes of the others. `not_written` says what is missing: what `manifest` says already, and the files named `taken`, in
/// whose places files stand that are no part of the result. The hash is that of the manifest itself.
///
/// # Errors
/// The manifest is not among the files, or it is not a JSON object.
pub(super) fn sealed(mut files: Files, manifest: &str, taken: &[String]) -> Result<Files, Failure> {
    let internal = || Failure::Internal(format!("{manifest} cannot list the files of the result"));
    let at = files.iter().position(|(name, _)| name == manifest).ok_or_else(internal)?;
    let (name, bytes) = files.remove(at);
    let mut value: Value = serde_json::from_slice(&bytes).map_err(|_| internal())?;
    let list: Map<String, Value> =
        files.iter().map(|(name, bytes)| (name.clone(), Value::String(hash(bytes)))).collect();
    let keys = value.as_object_mut().ok_or_else(internal)?;
    keys.insert("files".into(), Value::Object(list));
    let missing =
        keys.entry("not_written").or_insert_with(|| json!([])).as_array_mut().ok_or_else(internal)?;
    missing.extend(taken.iter().map(|name| another_stands(name).into()));
    let own = own_hash(keys);
    keys.insert(OWN_HASH.into(), own.into());
    let mut text = serde_json::to_vec_pretty(&value).map_err(|_| internal())?;
    // if the manifest ended in a line break before, it does so again
    text.extend(bytes.last().filter(|last| **last == b'\n'));
    files.push((name, text));
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_manifest_knows_when_it_was_edited() {
        let run = json!({"study": "s", "front_size": 12, "gap": 0.02, "elapsed_s": 1.5});
        let files = vec![("front.csv".into(), b"id".to_vec()), (RUN.into(), run.to_string().into_bytes())];
        let whole = sealed(files, RUN, &[]).expect("an object");
        let (_, bytes) = whole.last().expect("the manifest");
        let written: Value = serde_json::from_slice(bytes).expect("JSON");
        assert!(is_as_written(&written), "{written}");
        let with = |key: &str, value: Value| {
            let mut edited = written.clone();
            edited[key] = value;
            edited
        };
        assert!(!is_as_written(&with("front_size", json!(13))));
        assert!(!is_as_written(&with("more", json!(1))));
        // what differs from run to run is not a part of the hash
        assert!(is_as_written(&with("elapsed_s", json!(2.5))));
    }

    #[test]
    fn a_list_never_names_a_file_outside_its_folder() {
        let list = json!({"files": {"front.csv": "a", "plots/x.svg": "b", "../x": "c", "/etc/x": "d", "a/../../x": "e", "": "f"}});
        assert_eq!(
            listed(&list).expect("a list").into_keys().collect::<Vec<_>>(),
            ["front.csv", "plots/x.svg"]
        );
    }
}
