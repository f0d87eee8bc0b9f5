//! `armwright merge` and `armwright status`: join the shards of a search into its front, and list the shards that are
//! there.

use super::asked::Asked;
use super::exit::{Answer, Exit};
use super::failure::Failure;
use super::finished::{Finished, catalogs_hash};
use super::manifest::{RUN, SHARD};
use super::result_folder::ResultFolder;
use super::run::planned;
use super::search::stopped_by_signal;
use super::shard::{CANDIDATES, COMMON, STUDY, folder_of, read_manifest};
use super::supplements::SupplementArgs;
use crate::catalog::Catalogs;
use crate::input::json::Document;
use crate::report::file_names::file_name;
use crate::search::sweep::{Shard, Status};
use crate::space::problem::ArmProblem;
use crate::study::diagnose::why_infeasible;
use crate::study::effects::left_out;
use crate::study::outcome::judge_swept;
use crate::study::read::read_study;
use crate::study::shards::{Swept, gaps, joined, read_candidates};
use clap::Args;
use serde_json::Value;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Joins the shards of a search into its front. They must be of one study, one version and the same catalogs, and cover
/// every design; what is missing is listed with the command that makes it. The result is that of one machine.
#[derive(Debug, Args)]
#[command(after_help = "Example: armwright run my-study.json --shard 1/2 --out parts/1-of-2\n         \
                  armwright run my-study.json --shard 2/2 --out parts/2-of-2\n         \
                  armwright merge parts --out results/my-study")]
pub(crate) struct MergeArgs {
    /// Folders of shards, or folders that have such folders in them
    #[arg(required = true, value_name = "SHARD|DIR")]
    shards: Vec<PathBuf>,
    /// Folder for the results; default results/<study>
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    supplements: SupplementArgs,
}

/// Lists the shards in a folder, and the commands that make those that are missing.
#[derive(Debug, Args)]
#[command(after_help = "Example: armwright status parts")]
pub(crate) struct StatusArgs {
    /// Folders of shards, or folders that have such folders in them
    #[arg(required = true, value_name = "DIR")]
    shards: Vec<PathBuf>,
}

/// A shard that was found in a folder.
struct Found {
    /// Folder of the shard.
    dir: PathBuf,
    /// Contents of `shard.json`.
    manifest: Value,
    /// Number of the shard, and number of all shards.
    shard: Shard,
    /// Numbers of the designs of the shard.
    range: Range<u128>,
}

/// All shards of one search that were found.
struct Shards {
    /// The shards by their numbers, counted from 1.
    by_number: BTreeMap<u32, Found>,
    /// Number of shards into which the search is divided.
    of: u32,
    /// Number of designs in the space.
    designs_total: u128,
}

/// Runs `armwright merge`: writes the result, and returns the text to print.
pub(super) fn merge(
    args: &MergeArgs,
    catalogs: &Catalogs,
    overlay: Option<&Path>,
) -> Result<Answer, Failure> {
    let shards = Shards::read(&args.shards)?;
    let missing = shards.missing();
    if !missing.is_empty() {
        return Err(Failure::Partial(format!(
            "{} of {} shards are missing; nothing was written. Run\n  {}",
            missing.len(),
            shards.of,
            missing.join("\n  ")
        )));
    }
    shards.refuse_gaps()?;
    let (asked, swept, elapsed_s) = shards.contents(catalogs)?;
    let study = &asked.study;
    let stop = stopped_by_signal();
    let problem = ArmProblem::new(&study.space, catalogs);
    let outcome = judge_swept(study, &problem, joined(swept, shards.designs_total));
    if outcome.sweep.status == Status::Infeasible {
        return Err(Failure::Infeasible(why_infeasible(study, catalogs, stop, None)));
    }
    let dir = args.out.clone().unwrap_or_else(|| Path::new("results").join(file_name(&study.name)));
    let finished = Finished::visit(&asked, (&problem, &outcome), elapsed_s, (catalogs, overlay), &dir);
    let folder = ResultFolder::open(&dir, RUN, &planned(study))?;
    let written = finished.keep(&args.supplements, stop, &|files| folder.publish(files))?;
    let text = format!(
        "{}\n{} shards joined; written to {}\n{}",
        written.terminal,
        shards.of,
        dir.display(),
        written.timing
    );
    Ok(Answer { text, exit: Exit::Done })
}

/// Runs `armwright status` and returns the text to print.
pub(super) fn status(args: &StatusArgs) -> Result<String, Failure> {
    let shards = Shards::read(&args.shards)?;
    let mut out =
        format!("{} of {} shards of {} designs\n", shards.by_number.len(), shards.of, shards.designs_total);
    for found in shards.by_number.values() {
        let Range { start, end } = found.range;
        out.push_str(&format!(
            "{:>6}/{}  designs {start} to {end}, {} evaluated, {:.1} s  {}\n",
            found.shard.number,
            found.shard.of,
            found.manifest["designs_evaluated"],
            found.manifest["elapsed_s"].as_f64().unwrap_or_default(),
            found.dir.display()
        ));
    }
    let missing = shards.missing();
    if !missing.is_empty() {
        out.push_str(&format!("missing; run\n  {}\n", missing.join("\n  ")));
    }
    Ok(out)
}

impl Shards {
    /// Finds the shards in some folders, and checks that they belong to one search.
    ///
    /// # Errors
    /// There are no shards, one is damaged, or they belong to different searches.
    fn read(folders: &[PathBuf]) -> Result<Self, Failure> {
        let mut all = Vec::new();
        for folder in folders {
            for dir in shards_in(folder, DEEPEST)? {
                all.push(Found::read(dir)?);
            }
        }
        let Some(first) = all.first() else {
            let names: Vec<String> = folders.iter().map(|folder| folder.display().to_string()).collect();
            return Err(Failure::File(format!(
                "{} has no shard, which is a folder with {SHARD}; `armwright run STUDY --shard 1/4` makes one",
                names.join(", ")
            )));
        };
        let faults: Vec<String> = all.iter().flat_map(|other| first.unlike(other)).collect();
        if !faults.is_empty() {
            return Err(Failure::Check(format!(
                "the shards are not of one search\n  {}",
                faults.join("\n  ")
            )));
        }
        let designs_total = first.manifest["designs_total"].as_u64().unwrap_or_default().into();
        let of = first.shard.of;
        // if two folders have the same shard, one of them is used; they were compared above
        let by_number = all.into_iter().map(|found| (found.shard.number, found)).collect();
        Ok(Self { by_number, of, designs_total })
    }

    /// The commands that compute the missing shards.
    fn missing(&self) -> Vec<String> {
        let Some(like) = self.by_number.values().next() else { return Vec::new() };
        let numbers = (1..=self.of).filter(|number| !self.by_number.contains_key(number));
        numbers.map(|number| like.command_of(number)).collect()
    }

    /// Fails unless the shards cover every design exactly once.
    fn refuse_gaps(&self) -> Result<(), Failure> {
        let ranges = self.by_number.values().map(|found| found.range.clone()).collect();
        match gaps(ranges, self.designs_total) {
            (missing, None) if missing.is_empty() => Ok(()),
            (missing, shared) => Err(Failure::Check(format!(
                "the shards do not cover the {} designs once: {missing:?} is in none, and design {shared:?} in two",
                self.designs_total
            ))),
        }
    }

    /// The study, what was found in each shard, and the sum of the times of all shards \[s\].
    fn contents(&self, catalogs: &Catalogs) -> Result<(Asked, Vec<Swept>, f64), Failure> {
        let mut asked: Option<Asked> = None;
        let (mut swept, mut elapsed_s) = (Vec::new(), 0.0);
        for found in self.by_number.values() {
            if asked.is_none() {
                asked = Some(found.study(catalogs)?);
            }
            let materials = asked.as_ref().map_or(0, |asked| asked.study.space.material_names().len());
            swept.push(found.swept(materials)?);
            elapsed_s += found.manifest["elapsed_s"].as_f64().unwrap_or_default();
        }
        let asked = asked.ok_or_else(|| Failure::Internal("no shard".into()))?;
        Ok((asked, swept, elapsed_s))
    }
}

/// Depth down to which folders are searched for shards.
const DEEPEST: usize = 3;

/// The folders of shards inside `folder`, in the order of their names, down to `depth` levels. If the folder is itself
/// a shard, it is the only entry.
fn shards_in(folder: &Path, depth: usize) -> Result<Vec<PathBuf>, Failure> {
    if folder.join(SHARD).is_file() {
        return Ok(vec![folder.to_path_buf()]);
    }
    let entries = fs_err::read_dir(folder).map_err(|e| Failure::File(e.to_string()))?;
    let mut inside: Vec<PathBuf> =
        entries.flatten().map(|entry| entry.path()).filter(|p| p.is_dir()).collect();
    inside.sort();
    let mut out = Vec::new();
    for folder in inside.iter().filter(|_| depth > 0) {
        out.extend(shards_in(folder, depth - 1)?);
    }
    Ok(out)
}

impl Found {
    fn read(dir: PathBuf) -> Result<Self, Failure> {
        let manifest = read_manifest(&dir)?;
        let pair = |key: &str| -> Option<[u64; 2]> {
            Some([manifest[key][0].as_u64()?, manifest[key][1].as_u64()?])
        };
        let shard = pair("shard").and_then(|[number, of]| {
            let [number, of] = [u32::try_from(number).ok()?, u32::try_from(of).ok()?];
            (1..=of).contains(&number).then_some(Shard { number, of })
        });
        let range = pair("range").map(|[start, end]| u128::from(start)..u128::from(end));
        let fault = || Failure::File(format!("{}: no shard or no range", dir.join(SHARD).display()));
        let (shard, range) = shard.zip(range).ok_or_else(fault)?;
        Ok(Self { dir, manifest, shard, range })
    }

    /// Differences between this shard and `other` that show that they belong to different searches, in words. Empty if
    /// both are of the same search.
    fn unlike(&self, other: &Self) -> Vec<String> {
        let (here, there) = (self.dir.display(), other.dir.display());
        let differs = |key: &&&str| self.manifest[**key] != other.manifest[**key];
        let mut out: Vec<String> = COMMON
            .iter()
            .filter(differs)
            .map(|key| {
                format!("{here} and {there}: {key} {} and {}", self.manifest[*key], other.manifest[*key])
            })
            .collect();
        if self.shard.of != other.shard.of {
            out.push(format!("{here} and {there}: one of {} and one of {}", self.shard.of, other.shard.of));
        }
        if self.shard == other.shard && self.manifest["files"] != other.manifest["files"] {
            out.push(format!("{here} and {there}: the same shard with other designs"));
        }
        out
    }

    /// The command that computes the shard with this number in the same search as this one.
    fn command_of(&self, number: u32) -> String {
        let words = self.manifest["command"].as_array().into_iter().flatten().filter_map(Value::as_str);
        let words: Vec<String> = words.map(shell_word).collect();
        let shards = self.dir.parent().unwrap_or(Path::new("."));
        let dir = folder_of(shards, Shard { number, of: self.shard.of });
        let dir = shell_word(&dir.display().to_string());
        format!("armwright {} --shard {number}/{} --out {dir}", words.join(" "), self.shard.of)
    }

    fn study(&self, catalogs: &Catalogs) -> Result<Asked, Failure> {
        if self.manifest["catalogs_hash"].as_str() != Some(&catalogs_hash(catalogs)) {
            return Err(Failure::Check(format!(
                "{} was made with other catalogs: give the same --catalogs, unchanged",
                self.dir.display()
            )));
        }
        let file = self.dir.join(STUDY);
        let text = fs_err::read_to_string(&file).map_err(|e| Failure::File(e.to_string()))?;
        let study = read_study(Document::parse(&file.display().to_string(), &text)?, catalogs)?;
        Ok(Asked { corrections: left_out(&study), study, text })
    }

    fn swept(&self, materials: usize) -> Result<Swept, Failure> {
        let file = self.dir.join(CANDIDATES);
        let text = fs_err::read_to_string(&file).map_err(|e| Failure::File(e.to_string()))?;
        let (front, groups) = read_candidates(&text, materials)
            .map_err(|line| Failure::File(format!("{}:{line}: no candidate", file.display())))?;
        let designs_evaluated = self.manifest["designs_evaluated"].as_u64().unwrap_or_default();
        Ok(Swept { designs_evaluated, front, groups })
    }
}

/// A word as it must be written in a POSIX shell to be read unchanged: in quotes if it has special characters.
pub(super) fn shell_word(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+%@".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.to_string(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::shell_word;

    #[test]
    fn a_shell_reads_a_word_back() {
        assert_eq!(shell_word("results/a-b.json"), "results/a-b.json");
        assert_eq!(shell_word("a b"), "'a b'");
        assert_eq!(shell_word("it's"), r"'it'\''s'");
        assert_eq!(shell_word("$(rm)"), "'$(rm)'");
    }
}
