//! The list of the files of a result, with a hash of each: the key `files` of `run.json` or `verdict.json`, which is
//! written after all others.

use super::failure::Failure;
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::path::{Component, Path};

/// The file that lists the files of a study's result.
pub(super) const RUN: &str = "run.json";
/// The file that lists the files of a campaign's result.
pub(super) const VERDICT: &str = "verdict.json";
/// The file that lists the files of a shard of a search.
pub(super) const SHARD: &str = "shard.json";
/// Every such file.
pub(super) const MANIFESTS: [&str; 3] = [RUN, VERDICT, SHARD];

/// Files with their names relative to a folder of results.
pub(super) type Files = Vec<(String, Vec<u8>)>;

/// Which files of a folder belong to a result.
pub(super) enum Earlier {
    /// There is no result.
    Nothing,
    /// A result of a version that listed no files: whatever has the name of a result may be replaced.
    Unlisted,
    /// These files, with their hashes.
    Listed(BTreeMap<String, String>),
}

impl Earlier {
    /// The result in a folder whose files are listed in the file `manifest`.
    ///
    /// # Errors
    /// There is a file of that name that cannot be read.
    pub(super) fn read(folder: &Path, manifest: &str) -> Result<Self, Failure> {
        let path = folder.join(manifest);
        let text = match std::fs::read_to_string(&path) {
            Ok(text) => text,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(Earlier::Nothing),
            Err(e) => return Err(Failure::file(&path, "read", &e)),
        };
        let value: Value = serde_json::from_str(&text).unwrap_or_default();
        let is_ours = ["study", "verdict"].iter().any(|key| value.get(key).is_some());
        Ok(match (is_ours, listed(&value)) {
            (true, Some(listed)) => Earlier::Listed(listed),
            (true, None) => Earlier::Unlisted,
            (false, _) => Earlier::Nothing,
        })
    }

    /// Whether a file of this name belongs to the result.
    pub(super) fn has(&self, name: &str, manifest: &str) -> bool {
        match self {
            Earlier::Nothing => false,
            Earlier::Unlisted => true,
            Earlier::Listed(files) => name == manifest || files.contains_key(name),
        }
    }

    /// The listed names.
    pub(super) fn names(&self) -> impl Iterator<Item = &String> {
        let listed = match self {
            Earlier::Listed(files) => Some(files.keys()),
            _ => None,
        };
        listed.into_iter().flatten()
    }
}

/// The listed files with their hashes; `None` if there is no list. A name that leads out of the folder is left out.
pub(super) fn listed(manifest: &Value) -> Option<BTreeMap<String, String>> {
    let files = manifest.get("files")?.as_object()?;
    let listed = files.iter().filter(|(name, _)| stays_inside(name));
    Some(listed.map(|(name, hash)| (name.clone(), hash.as_str().unwrap_or_default().to_string())).collect())
}

/// Whether a name stays inside the folder that it is relative to.
fn stays_inside(name: &str) -> bool {
    !name.is_empty() && Path::new(name).components().all(|part| matches!(part, Component::Normal(_)))
}

/// The hash by which a file is recognized.
pub(super) fn hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

/// The files with the list of them in the file `manifest`, which comes last.
///
/// # Errors
/// The manifest is not among the files, or is no JSON object.
pub(super) fn sealed(mut files: Files, manifest: &str) -> Result<Files, Failure> {
    let internal = || Failure::Internal(format!("{manifest} cannot list the files of the result"));
    let at = files.iter().position(|(name, _)| name == manifest).ok_or_else(internal)?;
    let (name, bytes) = files.remove(at);
    let mut value: Value = serde_json::from_slice(&bytes).map_err(|_| internal())?;
    let list: Map<String, Value> =
        files.iter().map(|(name, bytes)| (name.clone(), Value::String(hash(bytes)))).collect();
    value.as_object_mut().ok_or_else(internal)?.insert("files".into(), Value::Object(list));
    let mut text = serde_json::to_vec_pretty(&value).map_err(|_| internal())?;
    // a file that ended in a line break still does
    text.extend(bytes.last().filter(|last| **last == b'\n'));
    files.push((name, text));
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_list_never_names_a_file_outside_its_folder() {
        let list = json!({"files": {"front.csv": "a", "plots/x.svg": "b", "../x": "c", "/etc/x": "d", "a/../../x": "e", "": "f"}});
        assert_eq!(
            listed(&list).expect("a list").into_keys().collect::<Vec<_>>(),
            ["front.csv", "plots/x.svg"]
        );
    }
}
