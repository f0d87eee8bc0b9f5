//! `armwright run STUDY --shard M/N`: searches one part of a study's designs. It writes the designs that it found and a
//! manifest, both for `armwright merge`.

use super::exit::{Answer, Exit};
use super::failure::Failure;
use super::finished::{catalogs_hash, count, pretty};
use super::manifest::{SHARD, STUDY, hash};
use super::progress::Watch;
use super::search::SearchSettings;
use super::shard_files::{CANDIDATES, COMMON, read_candidates_of, read_manifest, shards_in_all};
use super::stop::stopped_by_signal;
use crate::exact::Known;
use crate::exact::outcome::FoundInShard;
use crate::search::sweep::{Shard, Status};
use crate::study::asked::Asked;
use crate::study::definition::Study;
use crate::study::exact_shards::{exact_shard, fronts_of};
use crate::study::outcome::sweep_shard;
use crate::study::search_method::SearchMethod;
use crate::study::shards::{candidates_csv, found_csv};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// Reads a shard from the command line: `M/N`, the number of the part and the number of all parts.
pub(super) fn shard_of(text: &str) -> Result<Shard, String> {
    let fault = || {
        format!(
            "a part and the number of parts, such as 2/16, with 1 for the first part and at most {MOST_SHARDS} parts"
        )
    };
    let (number, of) = text.split_once('/').ok_or_else(fault)?;
    let [number, of] = [number, of].map(|word| word.trim().parse::<u32>());
    match (number, of) {
        (Ok(number), Ok(of)) if (1..=of).contains(&number) && of <= MOST_SHARDS => Ok(Shard { number, of }),
        _ => Err(fault()),
    }
}

/// Largest number of shards. More shards would each have too little work for the files that they write.
pub(super) const MOST_SHARDS: u32 = 100_000;

/// Searches a shard. `words` are the words of the command line that name the study, the limits, the catalogs and the
/// kind of search.
///
/// # Errors
/// The search does not suit the study, the shard cannot be written, or the user stops it.
pub(super) fn run_shard(
    asked: &Asked,
    shard: Shard,
    incumbents: &[PathBuf],
    words: Vec<String>,
    settings: &SearchSettings,
) -> Result<Answer, Failure> {
    let (method, designs_total) = settings.how.check_shard(&asked.study, settings.setup.catalogs)?;
    let flags = match method {
        SearchMethod::Exhaustive => json!({"search": "exhaustive"}),
        SearchMethod::Exact => json!({"search": "exact", "gap": settings.how.gap_of(&asked.study)}),
    };
    let mut manifest = json!({
        "schema_version": 1,
        "study": asked.study.name,
        "tool_version": env!("CARGO_PKG_VERSION"),
        "study_hash": hash(asked.text.as_bytes()),
        "catalogs_hash": catalogs_hash(settings.setup.catalogs),
        "flags": flags,
        "designs_total": count(designs_total),
        "shard": [shard.number, shard.of],
        "command": words,
    });
    if !settings.how.is_fresh()
        && let Some(words) = already_done(settings.dir, &manifest)
    {
        return Ok(words.into());
    }
    let (searched, elapsed_s) = match method {
        SearchMethod::Exhaustive if !incumbents.is_empty() => {
            return Err(Failure::Usage("--incumbents goes with --search exact".into()));
        }
        SearchMethod::Exhaustive => visit(asked, shard, settings)?,
        SearchMethod::Exact => {
            let given = Incumbents::read(incumbents, &manifest, &asked.study)?;
            search_exactly(asked, shard, &given, settings)?
        }
    };
    let of_this_run = json!({
        "proved": true,
        "elapsed_s": elapsed_s,
        "threads": rayon::current_num_threads(),
        "platform": format!("{}-{}", std::env::consts::OS, std::env::consts::ARCH),
    });
    for (key, value) in [&searched.facts, &of_this_run].into_iter().filter_map(Value::as_object).flatten() {
        manifest[key] = value.clone();
    }
    let text = searched.words(shard, elapsed_s, settings.dir);
    let mut files = vec![
        (CANDIDATES.to_string(), searched.candidates.into_bytes()),
        (STUDY.to_string(), asked.text.clone().into_bytes()),
    ];
    // the manifest lists the other files with their hashes and is written last: if it exists, the others are complete
    files.push((SHARD.into(), pretty(&manifest)));
    (settings.keep)(&files)?;
    Ok(Answer { text, exit: Exit::Done })
}

/// A shard that was searched.
struct Searched {
    /// The candidates that the shard found, as the text of a file.
    candidates: String,
    /// Entries of the manifest that describe the search.
    facts: Value,
}

impl Searched {
    /// A text for the terminal that says what was searched and which files were written.
    fn words(&self, shard: Shard, elapsed_s: f64, dir: &Path) -> String {
        let range = [0, 1].map(|end| self.facts["range"][end].as_u64());
        let what = match range {
            [Some(start), Some(end)] => format!("{} designs", end - start),
            _ => format!(
                "{} boxes, {} designs evaluated",
                self.facts["boxes"], self.facts["designs_evaluated"]
            ),
        };
        format!(
            "shard {}/{}: {what}, {} candidates of the front, in {elapsed_s:.1} s\nwritten to {}: {CANDIDATES}, {STUDY}, \
             {SHARD}\n",
            shard.number,
            shard.of,
            self.facts["candidates"],
            dir.display()
        )
    }
}

/// The failure of a shard that the user stopped. Nothing was written.
fn stopped(shard: Shard) -> Failure {
    Failure::Interrupted(format!(
        "shard {}/{} was stopped; nothing was written, the same command goes on from there",
        shard.number, shard.of
    ))
}

/// Visits the designs of a shard. Returns what was found, and the time that the search took \[s\].
fn visit(asked: &Asked, shard: Shard, settings: &SearchSettings) -> Result<(Searched, f64), Failure> {
    let flags = json!({"search": "exhaustive", "shard": [shard.number, shard.of]});
    let (stop, unfinished) = (stopped_by_signal(), settings.go_on(asked, flags)?);
    let started = unfinished.started();
    let watch = |total: u128, visited: &(dyn Fn() -> u64 + Sync), finished: &AtomicBool| {
        Watch::new(started, settings.record, settings.setup.log).designs(total, visited, finished);
    };
    let (swept, range) =
        sweep_shard(&asked.study, settings.setup.catalogs, shard, stop, unfinished.resume(), watch)
            .map_err(|_| unfinished.damaged())?;
    if swept.status == Status::Interrupted {
        return Err(stopped(shard));
    }
    let facts = json!({
        "range": [range.start as u64, range.end as u64],
        "designs_evaluated": swept.designs_evaluated,
        "candidates": swept.front.len(),
    });
    Ok((Searched { candidates: candidates_csv(&swept), facts }, started.elapsed().as_secs_f64()))
}

/// Searches the subtrees of a shard by the exact search. Returns what was found, and the time that the search took
/// \[s\].
fn search_exactly(
    asked: &Asked,
    shard: Shard,
    given: &Incumbents,
    settings: &SearchSettings,
) -> Result<(Searched, f64), Failure> {
    let gap = settings.how.gap_of(&asked.study);
    let flags = json!({
        "search": "exact", "gap": gap, "shard": [shard.number, shard.of], "incumbents": given.hashes,
    });
    let (stop, unfinished) = (stopped_by_signal(), settings.go_on(asked, flags)?);
    let started = unfinished.started();
    let watch = |known: &(dyn Fn() -> Known + Sync), finished: &AtomicBool| {
        Watch::new(started, settings.record, settings.setup.log).search(known, finished);
    };
    let study = (&asked.study, settings.setup.catalogs);
    let found = exact_shard(study, (shard, gap), &given.found, stop, unfinished.resume(), watch)
        .map_err(|_| unfinished.damaged())?;
    let is_whole = found.len() == fronts_of(&asked.study.space, gap).len();
    if !is_whole || found.iter().any(|found| found.boxes_open > 0) {
        return Err(stopped(shard));
    }
    let names = asked.study.space.material_names();
    let front = |(at, found): (usize, &FoundInShard)| {
        json!({
            "front": at.checked_sub(1).map_or("all", |material| &names[material]),
            "subtrees": found.subtrees,
            "designs_evaluated": found.designs_evaluated,
            "boxes": found.boxes,
            "gap": found.gap,
        })
    };
    let facts = json!({
        "fronts": found.iter().enumerate().map(front).collect::<Vec<_>>(),
        "designs_evaluated": found[0].designs_evaluated,
        "boxes": found[0].boxes,
        "candidates": found[0].decided.len() + found[0].undecided.len(),
    });
    Ok((Searched { candidates: found_csv(&found), facts }, started.elapsed().as_secs_f64()))
}

/// The candidates that shards of other exact searches of the study found.
struct Incumbents {
    found: Vec<Vec<FoundInShard>>,
    /// Hashes of the files with the candidates, one for each shard in `found`.
    hashes: Vec<Value>,
}

impl Incumbents {
    /// Reads shards of exact searches. Their gap and their number of shards may differ from those of the search that
    /// begins with their designs.
    ///
    /// # Errors
    /// A folder has no shard, or one of another study, other catalogs or another kind of search.
    fn read(folders: &[PathBuf], manifest: &Value, study: &Study) -> Result<Self, Failure> {
        let mut out = Self { found: Vec::new(), hashes: Vec::new() };
        for dir in shards_in_all(folders)? {
            let other = read_manifest(&dir)?;
            let differs = |key: &&&str| **key != "flags" && other[**key] != manifest[**key];
            let unlike: Vec<&str> = COMMON.iter().filter(differs).copied().collect();
            if !unlike.is_empty() || other["flags"]["search"] != json!("exact") {
                let what = if unlike.is_empty() { "search".into() } else { unlike.join(", ") };
                return Err(Failure::Check(format!(
                    "--incumbents {}: a shard with another {what}; give shards of exact searches of the same study",
                    dir.display()
                )));
            }
            out.found.push(read_candidates_of(&dir, &other, study)?);
            out.hashes.push(other["files"][CANDIDATES].clone());
        }
        Ok(out)
    }
}

/// A sentence that says that the folder already has the shard that `manifest` describes. `None` unless the shard in the
/// folder is complete and was made from the same inputs.
fn already_done(dir: &Path, manifest: &Value) -> Option<String> {
    let done = read_manifest(dir).ok()?;
    let same = |key: &str| done[key] == manifest[key];
    (COMMON.iter().all(|key| same(key)) && same("shard")).then(|| {
        format!("{} has this shard already, whole and from the same study and catalogs\n", dir.display())
    })
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
