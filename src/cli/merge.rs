//! `armwright merge` and `armwright status`: join the shards of a search into its front, and list the shards that are
//! found.

use super::exit::Answer;
use super::failure::Failure;
use super::finished::{Finished, FoundExactly, Visited, Written, catalogs_hash, count};
use super::manifest::{RUN, SHARD, STUDY};
use super::result_folder::ResultFolder;
use super::run::planned;
use super::setup::Setup;
use super::shard_files::{
    CANDIDATES, COMMON, MOST_LEVELS, folder_of, read_candidates_of, read_manifest, shards_in, shards_in_all,
};
use super::stop::{refuse_if_stopped, stopped_by_signal};
use super::supplements::SupplementArgs;
use super::unfinished_shards::{Begun, begun_in};
use crate::catalog::Catalogs;
use crate::exact::outcome::FoundInShard;
use crate::input::json::Document;
use crate::report::file_names::folder_name;
use crate::search::sweep::{Shard, Status};
use crate::space::problem::ArmProblem;
use crate::study::asked::Asked;
use crate::study::definition::Study;
use crate::study::diagnose::why_infeasible;
use crate::study::exact_shards::joined_exactly;
use crate::study::outcome::{ExactStudy, Extent, judge_swept};
use crate::study::read::read_study;
use crate::study::shards::{Swept, gaps, joined, read_candidates};
use clap::Args;
use serde_json::Value;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Joins the shards of a search into its front. All shards must have the same study, catalogs, flags and version of
/// armwright. Together they must cover every design. If shards are missing, the commands that make them are listed. The
/// result is the same as that of a search on one machine.
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

/// Lists the shards in a folder: those that are finished, running or stopped, and the commands that make the missing
/// ones. The exit code is 0 even if shards are missing. Merge then ends with exit code 10 and writes nothing.
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
    /// Numbers of the designs that the shard visited; `None` if its search was exact.
    range: Option<Range<u128>>,
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
pub(super) fn merge(args: &MergeArgs, setup: Setup) -> Result<Answer, Failure> {
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
    let (asked, elapsed_s) = shards.asked(setup.catalogs)?;
    let dir = args.out.clone().unwrap_or_else(|| Path::new("results").join(folder_name(&asked.study.name)));
    let joining = Joining { asked: &asked, elapsed_s, setup, dir: &dir, args };
    let written = if shards.is_exact() { joining.exact(&shards)? } else { joining.exhaustive(&shards)? };
    let text = format!(
        "{}\n{} shards joined; written to {}\n{}",
        written.terminal,
        shards.of,
        dir.display(),
        written.timing
    );
    Ok(Answer { text, exit: written.exit })
}

/// Everything that is needed to join shards, except the shards themselves.
struct Joining<'a> {
    asked: &'a Asked,
    /// Sum of the times that the shards took \[s\].
    elapsed_s: f64,
    setup: Setup<'a>,
    dir: &'a Path,
    args: &'a MergeArgs,
}

impl Joining<'_> {
    /// Joins the shards of an exhaustive search, which visits every design.
    fn exhaustive(&self, shards: &Shards) -> Result<Written, Failure> {
        let Self { asked, elapsed_s, setup, dir, .. } = *self;
        let study = &asked.study;
        shards.refuse_gaps()?;
        let swept = shards.swept(study)?;
        let problem = ArmProblem::new(&study.space, setup.catalogs);
        let outcome = judge_swept(study, &problem, joined(swept, shards.designs_total));
        self.refuse_nothing(outcome.sweep.status)?;
        let visited = Visited { problem: &problem, outcome: &outcome, elapsed_s };
        self.keep(&Finished::visit(asked, visited, dir, setup))
    }

    /// Joins the shards of an exact search.
    fn exact(&self, shards: &Shards) -> Result<Written, Failure> {
        let Self { asked: Asked { study, text, corrections }, elapsed_s, setup, dir, args } = *self;
        let catalogs = setup.catalogs;
        let extent = Extent { deadline: None, gap: shards.gap(), near: args.supplements.slack() };
        let found = shards.found(study)?;
        let found = joined_exactly(study, catalogs, &found, stopped_by_signal(), extent);
        refuse_if_stopped()?;
        let found = found
            .map_err(|why| Failure::Check(format!("the shards do not cover the designs once: {why}")))?;
        self.refuse_nothing(found.outcome.sweep.status)?;
        let ExactStudy { study: part, outcome, boxes, gap, near, ties_listed } = &found;
        self.keep(&Finished {
            study: part,
            text,
            corrections,
            problem: &ArmProblem::new(&part.space, catalogs),
            whole: &study.space,
            outcome,
            near: near.as_ref(),
            exact: Some(FoundExactly { boxes: *boxes, gap: *gap, ties_listed: *ties_listed }),
            elapsed_s,
            setup,
            dir,
        })
    }

    /// Fails if no design meets the limits of the study. The error says why.
    fn refuse_nothing(&self, status: Status) -> Result<(), Failure> {
        let why = || why_infeasible(&self.asked.study, self.setup.catalogs, stopped_by_signal(), None);
        if status == Status::Infeasible { Err(Failure::Infeasible(why())) } else { Ok(()) }
    }

    fn keep(&self, finished: &Finished) -> Result<Written, Failure> {
        refuse_if_stopped()?;
        let folder = ResultFolder::open(self.dir, RUN, &planned(&self.asked.study))?;
        let written =
            finished.keep(&self.args.supplements, stopped_by_signal(), &|files| folder.publish(files))?;
        Ok(written.after_search(self.setup.log))
    }
}

/// Runs `armwright status` and returns the text to print.
pub(super) fn status(args: &StatusArgs) -> Result<String, Failure> {
    let (mut finished, mut begun) = (Vec::new(), Vec::new());
    for folder in &args.shards {
        let here = begun_in(folder, MOST_LEVELS)?;
        if here.is_empty() || !shards_in(folder, MOST_LEVELS)?.is_empty() {
            finished.push(folder.clone());
        }
        begun.extend(here);
    }
    let lines: String = begun.iter().map(Begun::to_text).collect();
    if finished.is_empty() {
        return Ok(format!("no shard is finished yet\n{lines}"));
    }
    let shards = Shards::read(&finished)?;
    let mut out = format!(
        "{} of {} shards of {} designs\n",
        shards.by_number.len(),
        shards.of,
        count(shards.designs_total)
    );
    for found in shards.by_number.values() {
        let part = match &found.range {
            Some(Range { start, end }) => format!("designs {start} to {end}"),
            None => format!("{} boxes", found.manifest["boxes"]),
        };
        out.push_str(&format!(
            "{:>6}/{}  {part}, {} evaluated, {:.1} s  {}\n",
            found.shard.number,
            found.shard.of,
            found.manifest["designs_evaluated"],
            found.manifest["elapsed_s"].as_f64().unwrap_or_default(),
            found.dir.display()
        ));
    }
    out.push_str(&lines);
    let running: Vec<Shard> = begun.iter().filter(|b| b.is_running).map(|b| b.shard).collect();
    let is_running = |number: u32| running.contains(&Shard { number, of: shards.of });
    let missing = shards.missing_but(is_running);
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
        let all: Vec<Found> =
            shards_in_all(folders)?.into_iter().map(Found::read).collect::<Result<_, _>>()?;
        let first = all.first().ok_or_else(|| Failure::Internal("no shard".into()))?;
        let faults: Vec<String> = all.iter().flat_map(|other| first.unlike(other)).collect();
        if !faults.is_empty() {
            return Err(Failure::Check(format!(
                "the shards are not of one search\n  {}",
                faults.join("\n  ")
            )));
        }
        let designs_total = first.manifest["designs_total"].as_f64().unwrap_or_default() as u128;
        let of = first.shard.of;
        // if two folders have the same shard, only one of them is used; the check above made sure that they agree
        let by_number = all.into_iter().map(|found| (found.shard.number, found)).collect();
        Ok(Self { by_number, of, designs_total })
    }

    /// The commands that compute the missing shards.
    fn missing(&self) -> Vec<String> {
        self.missing_but(|_| false)
    }

    /// The commands that compute the missing shards, without those whose number `is_left_out`.
    fn missing_but(&self, is_left_out: impl Fn(u32) -> bool) -> Vec<String> {
        let Some(like) = self.by_number.values().next() else { return Vec::new() };
        let is_missing = |number: &u32| !self.by_number.contains_key(number) && !is_left_out(*number);
        let numbers = (1..=self.of).filter(is_missing);
        numbers.map(|number| like.command_of(number)).collect()
    }

    /// Fails unless the shards cover every design exactly once.
    fn refuse_gaps(&self) -> Result<(), Failure> {
        let ranges = self.by_number.values().filter_map(|found| found.range.clone()).collect();
        match gaps(ranges, self.designs_total) {
            (missing, None) if missing.is_empty() => Ok(()),
            (missing, shared) => {
                let in_none = missing.iter().map(|r| format!("designs {} to {} are in none", r.start, r.end));
                let in_two = shared.iter().map(|design| format!("design {design} is in two"));
                Err(Failure::Check(format!(
                    "the shards do not cover the {} designs once: {}",
                    self.designs_total,
                    in_none.chain(in_two).collect::<Vec<_>>().join(", ")
                )))
            }
        }
    }

    /// The study that the shards searched, and the sum of the times that they took \[s\].
    fn asked(&self, catalogs: &Catalogs) -> Result<(Asked, f64), Failure> {
        let first = self.by_number.values().next().ok_or_else(|| Failure::Internal("no shard".into()))?;
        let elapsed_s = |found: &Found| found.manifest["elapsed_s"].as_f64().unwrap_or_default();
        Ok((first.study(catalogs)?, self.by_number.values().map(elapsed_s).sum()))
    }

    /// The result of each shard of an exhaustive search.
    fn swept(&self, study: &Study) -> Result<Vec<Swept>, Failure> {
        let materials = study.space.material_names().len();
        self.by_number.values().map(|found| found.swept(materials)).collect()
    }

    /// The result of each shard of an exact search, with one entry for each of its fronts.
    fn found(&self, study: &Study) -> Result<Vec<Vec<FoundInShard>>, Failure> {
        let read = |found: &Found| read_candidates_of(&found.dir, &found.manifest, study);
        self.by_number.values().map(read).collect()
    }

    /// The flag `key` of the search, which is the same in all shards; null if there is no such flag.
    fn flag(&self, key: &str) -> &Value {
        self.by_number.values().next().map_or(&Value::Null, |found| &found.manifest["flags"][key])
    }

    /// Whether the shards are of an exact search.
    fn is_exact(&self) -> bool {
        self.flag("search") == "exact"
    }

    /// The gap that the user asked for in an exact search, as a fraction; 0 for an exhaustive search.
    fn gap(&self) -> f64 {
        self.flag("gap").as_f64().unwrap_or_default()
    }
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
        let shard = shard.filter(|_| range.is_some() || manifest["fronts"].is_array()).ok_or_else(fault)?;
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

    /// The command that computes another shard of the search of this shard: the one with the number `number`.
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
        Ok(Asked::as_stated(study, text))
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
