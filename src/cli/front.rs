//! `armwright front check`: is a finished front correct and complete?

use super::design::open_results;
use super::exit::{Answer, Exit};
use super::failure::Failure;
use super::finished::catalogs_hash;
use super::log::Log;
use super::manifest::{FRONT, STUDY, hash};
use super::result_folder::{settle, unfinished_in};
use super::results::TextFile;
use super::stop::stopped_by_signal;
use super::time_limit::time_limit;
use super::unfinished::Unfinished;
use crate::catalog::Catalogs;
use crate::input::json::Document;
use crate::report::certificate::gap_words;
use crate::report::front_table::FrontTable;
use crate::report::words::{TERMINAL, wrap};
use crate::study::check::{Claim, Completeness, resume_check};
use crate::study::definition::Study;
use crate::study::read::read_study;
use crate::study::ties;
use clap::{Args, Subcommand};
use serde_json::{Value, json};
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Works on a finished front.
#[derive(Debug, Args)]
#[command(after_help = "Example: armwright front check results/compare-materials")]
pub(crate) struct FrontArgs {
    #[command(subcommand)]
    verb: FrontVerb,
}

#[derive(Debug, Subcommand)]
enum FrontVerb {
    /// Verify a front: every row, rows against each other, and whether designs are missing
    ///
    /// The check works out from the study and the catalogs which drives hold, and looks for missing designs by
    /// bounds of its own. It shares with the search the reader of studies and catalogs, and the full model that
    /// judges a single design (docs/exact.md). The last line says whether these bounds sufficed, or why the exact
    /// search's were used. For a front with a gap the gap is checked: for every design some row must be
    /// worse by no more than the gap in each objective. A check that was stopped goes on with the same command.
    Check(CheckArgs),
}

#[derive(Debug, Args)]
struct CheckArgs {
    /// Result folder of a study
    results: PathBuf,
    /// Stop looking for missing designs after so many seconds, and say so. If a check that was stopped goes on, the
    /// time that it took before counts too
    #[arg(long, value_name = "SECONDS", value_parser = time_limit)]
    time_limit: Option<Duration>,
}

/// Runs `armwright front check` and returns the text to print.
pub(super) fn run(args: &FrontArgs, catalogs: &Catalogs, log: Log) -> Result<Answer, Failure> {
    let FrontVerb::Check(args) = &args.verb;
    let results = open_results(&args.results, catalogs)?;
    let run = &results.run;
    let TextFile { path, text } = results.text(STUDY)?;
    let study = read_study(Document::parse(&path, &text)?, catalogs)?;
    refuse_beyond_bounds(&study)?;
    let front = args.results.join(FRONT);
    let front_csv = results.with_todays_ids(FRONT)?;
    let table = FrontTable::parse(&front, &front_csv).map_err(|e| Failure::File(e.to_string()))?;
    let mut faults = differences_from_run(run, &text, &table);
    let gap = claimed_gap(run);
    let ties_listed = run["ties_listed"].as_bool().unwrap_or(true);
    let stop = stopped_by_signal();
    // a result without this file has no ties
    let ties_csv = match results.is_there(ties::FILE) {
        true => results.with_todays_ids(ties::FILE)?,
        false => Vec::new(),
    };
    let claim = Claim { table: &table, gap, ties_listed, ties_csv: &ties_csv };
    let path = unfinished_in(&args.results, "check");
    let search = json!({
        "study_hash": hash(text.as_bytes()),
        "catalogs_hash": catalogs_hash(catalogs),
        "tool_version": env!("CARGO_PKG_VERSION"),
        "flags": {"check": hash(&[&front_csv[..], claim.ties_csv].concat()), "gap": gap, "ties_listed": ties_listed},
    });
    let unfinished = Unfinished::open_or_begin(&path, &search, log)?;
    let deadline = args.time_limit.map(|limit| unfinished.started() + limit);
    let check = resume_check(&study, catalogs, &claim, (stop, deadline), Some(unfinished.resume()))
        .map_err(|_| unfinished.damaged())?;
    if stop.load(Ordering::Relaxed) {
        let words = "stopped before the check was done; the same command goes on from there";
        return Err(Failure::Interrupted(words.into()));
    }
    settle(&path)?;
    faults.extend(check.faults);
    if faults.is_empty() {
        let rows = check.rows;
        let completeness = completeness_words(&check.completeness);
        let words =
            format!("{rows} designs agree with the model, and none dominates another; {completeness}");
        let exit = if check.completeness.is_ok() { Exit::Done } else { Exit::Unsettled };
        return Ok(Answer { text: wrap(&words, TERMINAL, ""), exit });
    }
    Err(Failure::Check(format!("{}:\n  {}", args.results.display(), faults.join("\n  "))))
}

/// Refuses a study that the bounds of the check do not cover.
fn refuse_beyond_bounds(study: &Study) -> Result<(), Failure> {
    match study.space.beyond_bounds() {
        Some(what) => Err(Failure::Usage(format!(
            "the study \"{}\" has {what}, which the bounds of this check do not cover; `armwright design` and \
             `armwright analyze --cases` compute a row again",
            study.name
        ))),
        None => Ok(()),
    }
}

/// Faults of a result whose files do not agree with its `run.json`. `run` is the content of this file, `text` is that
/// of `study.json`, and `table` is the front.
fn differences_from_run(run: &Value, text: &str, table: &FrontTable) -> Vec<String> {
    let mut faults = Vec::new();
    if run["study_hash"].as_str() != Some(hash(text.as_bytes()).as_str()) {
        faults.push("study.json is not the study that was run".to_string());
    }
    if run["front_size"].as_u64() != Some(table.rows.len() as u64) {
        faults.push(format!(
            "front.csv has {} designs, run.json says {}",
            table.rows.len(),
            run["front_size"]
        ));
    }
    faults
}

/// The gap that a run claims for its front, as a fraction: 0 claims that no design is missing, `None` claims nothing.
fn claimed_gap(run: &Value) -> Option<f64> {
    match run["status"].as_str() {
        Some("certified" | "complete") => Some(run["gap"].as_f64().unwrap_or(0.0)),
        _ => run["gap"].as_f64(),
    }
}

/// Words that say whether designs are missing and how it was proved, or why it was not settled.
fn completeness_words(completeness: &Result<Completeness, String>) -> String {
    match completeness {
        Ok(Completeness { boxes, gap, by_exact_search }) => {
            let what = if *gap > 0.0 { gap_words(*gap) } else { "no design is missing".into() };
            let how = match by_exact_search {
                None => "by bounds that the exact search does not use".into(),
                Some(why) => format!("by the exact search's own bounds; of others: {why}"),
            };
            format!("{what} ({boxes} boxes, {how})")
        }
        Err(why) => format!("it was not settled whether a design is missing: {why}"),
    }
}
