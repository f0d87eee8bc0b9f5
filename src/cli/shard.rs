//! `armwright run STUDY --shard M/N`: visits one part of a study's designs. It writes the candidates that it found,
//! with a manifest, for `armwright merge`.

use super::asked::Asked;
use super::exit::{Answer, Exit};
use super::failure::Failure;
use super::finished::{catalogs_hash, pretty};
use super::manifest::SHARD;
use super::progress::Watch;
use super::search::{With, stopped_by_signal};
use crate::search::sweep::{Shard, Status};
use crate::study::outcome::sweep_shard;
use crate::study::shards::candidates_csv;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// Name of the file with the candidates of a shard.
pub(super) const CANDIDATES: &str = "candidates.csv";
/// Name of the file with the study of a shard.
pub(super) const STUDY: &str = "study.json";

/// Keys of `shard.json` that must be equal in all shards of one search.
pub(super) const COMMON: [&str; 5] =
    ["tool_version", "study_hash", "catalogs_hash", "flags", "designs_total"];

/// Reads the number of a shard and the number of all shards, as `M/N`.
pub(super) fn shard_of(text: &str) -> Result<Shard, String> {
    let fault = || "a part and the number of parts, such as 2/16, with 1 for the first part".to_string();
    let (number, of) = text.split_once('/').ok_or_else(fault)?;
    let [number, of] = [number, of].map(|word| word.trim().parse::<u32>());
    match (number, of) {
        (Ok(number), Ok(of)) if (1..=of).contains(&number) && of <= MOST_SHARDS => Ok(Shard { number, of }),
        _ => Err(fault()),
    }
}

/// Largest number of shards. With more of them there would be more files than work.
pub(super) const MOST_SHARDS: u32 = 100_000;

/// The folder of a shard inside the folder of all shards.
pub(super) fn folder_of(shards: &Path, shard: Shard) -> PathBuf {
    shards.join(format!("{}-of-{}", shard.number, shard.of))
}

/// Visits the designs of a shard. `words` are the words of the command line that give the study, its limits and the
/// catalogs.
///
/// # Errors
/// The shard cannot be visited or written, or the user stops the program.
pub(super) fn run_shard(
    asked: &Asked,
    shard: Shard,
    words: Vec<String>,
    with: &With,
) -> Result<Answer, Failure> {
    let Asked { study, text, .. } = asked;
    let designs_total = with.how.check_exhaustive(study, with.catalogs)?;
    let mut manifest = json!({
        "schema_version": 1,
        "study": study.name,
        "tool_version": env!("CARGO_PKG_VERSION"),
        "study_hash": blake3::hash(text.as_bytes()).to_hex().to_string(),
        "catalogs_hash": catalogs_hash(with.catalogs),
        "flags": {"search": "exhaustive"},
        "designs_total": designs_total as u64,
        "shard": [shard.number, shard.of],
        "command": words,
    });
    if let Some(words) = already_done(with.dir, &manifest) {
        return Ok(words.into());
    }
    let flags = json!({"search": "exhaustive", "shard": [shard.number, shard.of]});
    let (stop, unfinished) = (stopped_by_signal(), with.go_on(asked, flags)?);
    let started = unfinished.started();
    let watch = |total: u128, visited: &(dyn Fn() -> u64 + Sync), finished: &AtomicBool| {
        Watch::new(started, with.record, with.log).designs(total, visited, finished);
    };
    let (swept, range) = sweep_shard(study, with.catalogs, shard, stop, unfinished.resume(), watch)
        .map_err(|_| unfinished.damaged())?;
    if swept.status == Status::Interrupted {
        return Err(Failure::Interrupted(format!(
            "shard {}/{} was stopped; nothing was written, the same command goes on from there",
            shard.number, shard.of
        )));
    }
    let files = [(CANDIDATES, candidates_csv(&swept)), (STUDY, text.clone())];
    let elapsed_s = started.elapsed().as_secs_f64();
    let more = json!({
        "range": [range.start as u64, range.end as u64],
        "designs_evaluated": swept.designs_evaluated,
        "candidates": swept.front.len(),
        "proved": true,
        "elapsed_s": elapsed_s,
        "threads": rayon::current_num_threads(),
        "platform": format!("{}-{}", std::env::consts::OS, std::env::consts::ARCH),
    });
    for (key, value) in more.as_object().into_iter().flatten() {
        manifest[key] = value.clone();
    }
    let mut written: Vec<(String, Vec<u8>)> =
        files.into_iter().map(|(name, text)| (name.to_string(), text.into_bytes())).collect();
    // the manifest lists the other files with their hashes and is written last, so that its presence shows that the
    // shard is complete
    written.push((SHARD.into(), pretty(&manifest)));
    (with.keep)(&written)?;
    let text = format!(
        "shard {}/{}: {} designs, {} candidates of the front, in {elapsed_s:.1} s\nwritten to {}: {CANDIDATES}, {STUDY}, \
         {SHARD}\n",
        shard.number,
        shard.of,
        range.end - range.start,
        swept.front.len(),
        with.dir.display()
    );
    Ok(Answer { text, exit: Exit::Done })
}

/// If the folder has the same shard already, complete and from the same inputs: a sentence that says so. Otherwise
/// `None`. `manifest` describes the shard that is asked for.
fn already_done(dir: &Path, manifest: &Value) -> Option<String> {
    let done = read_manifest(dir).ok()?;
    let same = |key: &str| done[key] == manifest[key];
    (COMMON.iter().all(|key| same(key)) && same("shard")).then(|| {
        format!("{} has this shard already, whole and from the same study and catalogs\n", dir.display())
    })
}

pub(super) fn hash_of(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

/// Reads the manifest of a shard, and checks that its files are unchanged.
///
/// # Errors
/// A file is missing, the manifest is not one, or a file has changed.
pub(super) fn read_manifest(dir: &Path) -> Result<Value, Failure> {
    let path = dir.join(SHARD);
    let text = fs_err::read_to_string(&path).map_err(|e| Failure::File(e.to_string()))?;
    let manifest: Value =
        serde_json::from_str(&text).map_err(|e| Failure::File(format!("{}: {e}", path.display())))?;
    for name in [CANDIDATES, STUDY] {
        let file = dir.join(name);
        let bytes = fs_err::read(&file).map_err(|e| Failure::File(e.to_string()))?;
        if manifest["files"][name].as_str() != Some(&hash_of(&bytes)) {
            return Err(Failure::Check(format!(
                "{} is not the file that {} was written with: run the shard again",
                file.display(),
                path.display()
            )));
        }
    }
    Ok(manifest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shard_is_a_part_of_so_many() {
        assert_eq!(shard_of("2/16"), Ok(Shard { number: 2, of: 16 }));
        for text in ["0/4", "5/4", "1", "1/0", "a/b", "-1/4", "1/4294967295", ""] {
            assert!(shard_of(text).is_err(), "{text}");
        }
    }
}
