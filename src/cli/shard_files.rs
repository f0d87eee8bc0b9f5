//! The files of a shard: where they are, and how they are read back.

use super::failure::Failure;
use super::manifest::{SHARD, STUDY, has_manifest, hash, is_as_written};
use crate::exact::outcome::FoundInShard;
use crate::search::sweep::Shard;
use crate::study::definition::Study;
use crate::study::exact_shards::fronts_of;
use crate::study::shards::read_found;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Name of the file with the candidates that a shard found.
pub(super) const CANDIDATES: &str = "candidates.csv";

/// Keys in which all shards of one search agree.
pub(super) const COMMON: [&str; 5] =
    ["tool_version", "study_hash", "catalogs_hash", "flags", "designs_total"];

/// The folder of a shard. `shards` is the folder that contains the folders of all shards of the search.
pub(super) fn folder_of(shards: &Path, shard: Shard) -> PathBuf {
    shards.join(format!("{}-of-{}", shard.number, shard.of))
}

/// Reads what a shard of an exact search found, with one entry for each of its fronts.
///
/// # Errors
/// The file or the manifest is not one that this program writes.
pub(super) fn read_candidates_of(
    dir: &Path,
    manifest: &Value,
    study: &Study,
) -> Result<Vec<FoundInShard>, Failure> {
    let fronts = fronts_of(&study.space, manifest["flags"]["gap"].as_f64().unwrap_or_default()).len();
    let file = dir.join(CANDIDATES);
    let text = fs_err::read_to_string(&file).map_err(|e| Failure::File(e.to_string()))?;
    let mut found = read_found(&text, fronts)
        .map_err(|line| Failure::File(format!("{}:{line}: no candidate", file.display())))?;
    for (at, found) in found.iter_mut().enumerate() {
        let facts = &manifest["fronts"][at];
        let fault = || Failure::File(format!("{}: fronts, no subtrees or counts", dir.join(SHARD).display()));
        let subtrees = facts["subtrees"].as_array().ok_or_else(fault)?;
        found.subtrees = subtrees.iter().filter_map(Value::as_str).map(String::from).collect();
        found.designs_evaluated = facts["designs_evaluated"].as_u64().ok_or_else(fault)?;
        found.boxes = facts["boxes"].as_u64().ok_or_else(fault)?;
        found.gap = facts["gap"].as_f64();
    }
    Ok(found)
}

/// The folders of all shards that are found: those among `folders` that are shards, and those inside the other folders.
///
/// # Errors
/// A folder cannot be read, or none has a shard.
pub(super) fn shards_in_all(folders: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
    let mut all = Vec::new();
    for folder in folders {
        let inside = shards_in(folder, MOST_LEVELS)?;
        if inside.is_empty() {
            return Err(Failure::File(format!(
                "{} has no shard, which is a folder with {SHARD}; `armwright run STUDY --shard 1/4` makes one",
                folder.display()
            )));
        }
        all.extend(inside);
    }
    Ok(all)
}

/// Number of levels of subfolders that are searched for shards.
pub(super) const MOST_LEVELS: usize = 3;

/// The folders of the shards in `folder`, in the order of their names. If `folder` is itself a shard, it is the only
/// one. `depth` is the number of levels of subfolders that are searched.
pub(super) fn shards_in(folder: &Path, depth: usize) -> Result<Vec<PathBuf>, Failure> {
    if has_manifest(folder, SHARD) {
        return Ok(vec![folder.to_path_buf()]);
    }
    let mut out = Vec::new();
    for folder in folders_inside(folder)?.iter().filter(|_| depth > 0) {
        out.extend(shards_in(folder, depth - 1)?);
    }
    Ok(out)
}

/// The folders in a folder, in the order of their names.
///
/// # Errors
/// The folder cannot be read.
pub(super) fn folders_inside(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    if !folder.is_dir() {
        let hint = "give a folder with shards; `armwright run STUDY --shard 1/4` makes one";
        return Err(Failure::File(format!("{} is no folder; {hint}", folder.display())));
    }
    let entries = fs_err::read_dir(folder).map_err(|e| Failure::File(e.to_string()))?;
    let mut inside: Vec<PathBuf> =
        entries.flatten().map(|entry| entry.path()).filter(|p| p.is_dir()).collect();
    inside.sort();
    Ok(inside)
}

/// Reads the manifest of a shard and checks that its files are those that it names.
///
/// # Errors
/// A file is missing, is no manifest, or has other bytes.
pub(super) fn read_manifest(dir: &Path) -> Result<Value, Failure> {
    let path = dir.join(SHARD);
    let text = fs_err::read_to_string(&path).map_err(|e| Failure::File(e.to_string()))?;
    let manifest: Value =
        serde_json::from_str(&text).map_err(|e| Failure::File(format!("{}: {e}", path.display())))?;
    if !is_as_written(&manifest) {
        return Err(Failure::Check(format!(
            "{} is not what was written: run the shard again",
            path.display()
        )));
    }
    for name in [CANDIDATES, STUDY] {
        let file = dir.join(name);
        let bytes = fs_err::read(&file).map_err(|e| Failure::File(e.to_string()))?;
        if manifest["files"][name].as_str() != Some(&hash(&bytes)) {
            return Err(Failure::Check(format!(
                "{} is not the file that {} was written with: run the shard again",
                file.display(),
                path.display()
            )));
        }
    }
    Ok(manifest)
}
