//! Shards that were begun and are not finished: their folders have a state or a writer, and no manifest yet.

use super::failure::Failure;
use super::manifest::{SHARD, has_manifest};
use super::result_folder::{is_being_written, unfinished_in};
use super::shard::shard_of;
use super::shard_files::folders_inside;
use crate::search::sweep::Shard;
use serde_json::Value;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

/// Largest number of bytes of the line of JSON at the beginning of a saved state.
const LONGEST_LINE: u64 = 1 << 20;

/// A shard that was begun and is not finished.
pub(super) struct Begun {
    /// Folder of the shard.
    pub dir: PathBuf,
    /// Number of the shard, and number of all shards.
    pub shard: Shard,
    /// Whether a process is at work on it now.
    pub is_running: bool,
}

/// The shards in `folder` and in the folders in it that were begun and are not finished, in the order of their names.
/// `depth` is the number of levels of subfolders that are searched.
///
/// # Errors
/// A folder cannot be read.
pub(super) fn begun_in(folder: &Path, depth: usize) -> Result<Vec<Begun>, Failure> {
    if has_manifest(folder, SHARD) {
        return Ok(Vec::new());
    }
    let state = unfinished_in(folder, "search");
    let is_running = is_being_written(folder);
    // if neither the saved state nor the name of the folder is that of a shard, the folders in it are searched
    let shard = shard_of_state(&state).or_else(|| shard_of_name(folder));
    if let Some(shard) = shard
        && (is_running || state.is_file())
    {
        return Ok(vec![Begun { dir: folder.to_path_buf(), shard, is_running }]);
    }
    let mut out = Vec::new();
    if depth > 0 {
        for inside in folders_inside(folder)? {
            out.extend(begun_in(&inside, depth - 1)?);
        }
    }
    Ok(out)
}

/// The shard whose state is saved in the file `state`; `None` if the file cannot be read or belongs to no shard.
fn shard_of_state(state: &Path) -> Option<Shard> {
    let mut line = String::new();
    BufReader::new(File::open(state).ok()?.take(LONGEST_LINE)).read_line(&mut line).ok()?;
    let head: Value = serde_json::from_str(&line).ok()?;
    let [number, of] = [0, 1].map(|at| head["flags"]["shard"][at].as_u64());
    shard_of(&format!("{}/{}", number?, of?)).ok()
}

/// The shard after which a folder is named, such as `2-of-16`; `None` if it has another name.
fn shard_of_name(folder: &Path) -> Option<Shard> {
    shard_of(&folder.file_name()?.to_str()?.replace("-of-", "/")).ok()
}

impl Begun {
    /// A line of the list of shards.
    pub(super) fn to_text(&self) -> String {
        let what = match self.is_running {
            true => "is running",
            false => "was stopped; the same command goes on from its state",
        };
        format!("{:>6}/{}  {what}  {}\n", self.shard.number, self.shard.of, self.dir.display())
    }
}
