//! `armwright reconcile`: where model and measurements disagree, which physics is missing, and what that changes in a
//! study.

use super::exit::{Answer, Exit};
use super::extra_files::{ExtraFiles, say_missing, say_taken};
use super::failure::Failure;
use super::finished::catalogs_hash;
use super::log::Log;
use super::manifest::{Files, PAGE, VERDICT, hash, is_as_written, listed};
use super::rerun::{Again, CHANGES, Rerun, rerun};
use super::result_folder::ResultFolder;
use super::search::SearchArgs;
use super::setup::Setup;
use super::stop::unless_stopped;
use super::write::refuse_inputs;
use super::wrong_kind::{refuse_no_campaign, study_of};
use crate::catalog::Catalogs;
use crate::reconcile::readings::campaign::Campaign;
use crate::reconcile::together::reconcile;
use crate::reconcile::verdict::files::{CORRECTED_FILE, corrected_files};
use crate::reconcile::verdict::outcome::Outcome;
use crate::reconcile::verdict::page::campaign_page;
use crate::report::file_names::folder_name;
use crate::report::words::{TERMINAL, wrap};
use clap::Args;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Arguments of `reconcile`.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  armwright reconcile campaigns/may --out results/may\n  \
    armwright reconcile campaigns/may --study compare-materials --out results/may\n  \
    armwright reconcile campaigns/may --study full-catalog --time-limit 60\n\n\
    Writes verdict.json, verdict.txt, arm.corrected.json, residuals.csv, and report.html with its pictures in \
    plots/. The verdict is no_gap, explained, unexplained or insufficient_data; the exit code is 0 for all \
    four.\n\n\
    With --study and the verdict explained, the study is run without and with the effects that were found: \
    study/nominal and study/corrected are results as `armwright run` writes them, study_changes.csv has \
    every design of either front under both models, and verdict.json says under \"study\" which picks change. \
    If one of the models finds no design, the exit code is 6; the verdict is written all the same.")]
pub(crate) struct ReconcileArgs {
    /// Folder of a campaign: campaign.json, arm.json and any of static.csv, modal.csv, windup.csv,
    /// positions.csv, record.csv. Several campaigns of one arm are reconciled together.
    #[arg(required = true, value_name = "CAMPAIGN")]
    pub campaigns: Vec<PathBuf>,
    /// A built-in study or a study file to run again with the corrected arm; effects apply to the joints and
    /// links of the same name.
    #[arg(long, value_name = "STUDY")]
    pub study: Option<String>,
    /// Search options, which apply to each of the study's two runs.
    #[command(flatten)]
    pub how: SearchArgs,
    /// Folder to write into, made with its parents; default: `results/<campaign>`.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Reads a campaign, finds the verdict and writes it. If the folder already has a verdict from the same readings, arm,
/// catalogs and version, this verdict is used again. So a script over many campaigns can be repeated after it was
/// stopped.
///
/// # Errors
/// The input files have faults, or a file cannot be written.
pub(crate) fn run(args: &ReconcileArgs, setup: Setup) -> Result<Answer, Failure> {
    let Setup { catalogs, log, .. } = setup;
    match &args.study {
        // a study that has faults or cannot be searched in this way fails at once, and not after the fits
        Some(study) => drop(args.how.check(&study_of(study, catalogs)?.0, catalogs)?),
        None if !args.how.is_default() => {
            return Err(Failure::Usage("--search and --time-limit are for the runs of --study".into()));
        }
        None => {}
    }
    let mut read = Vec::new();
    for folder in &args.campaigns {
        refuse_no_campaign(folder)?;
        read.push(Campaign::read(folder, catalogs)?);
    }
    let mut inputs: Vec<PathBuf> = read.iter().flat_map(Campaign::input_files).collect();
    inputs.extend(args.study.iter().map(PathBuf::from));
    let first = read.remove(0);
    let campaign = first.join(read).map_err(Failure::Usage)?;
    let folder = folder_name(&campaign.statement.name);
    let out = args.out.clone().unwrap_or_else(|| Path::new("results").join(folder));
    let planned = planned(args, &campaign, catalogs)?;
    refuse_inputs(&planned.iter().map(|name| out.join(name)).collect::<Vec<_>>(), &inputs)?;
    let folder = ResultFolder::open(&out, VERDICT, &planned)?;
    let hash_of_catalogs = catalogs_hash(catalogs);
    if args.study.is_none()
        && !args.how.is_fresh()
        && let Some(text) = kept_before(&out, &campaign, &hash_of_catalogs)
    {
        return Ok(text.into());
    }
    let campaign = Arc::new(campaign);
    let fitted = Arc::clone(&campaign);
    let outcome = unless_stopped(move || reconcile(&fitted))?;
    let (mut files, terminal) = keep(&campaign, &outcome, &hash_of_catalogs, &folder, log)?;
    let mut text = format!("{}{terminal}", narrow(&outcome.to_text()));
    let mut exit = Exit::Done;
    if let Some(study) = &args.study {
        let keep = |more: &[(String, Vec<u8>)]| folder.publish(&[&files, more].concat());
        let again = Again { study, how: &args.how, dir: &out, keep: &keep };
        let rerun = rerun(&outcome, &again, setup)?;
        folder.settle(Ok(rerun.exit))?;
        text.push_str(&rerun.text);
        exit = rerun.exit;
        add(&mut files, rerun);
        let left_out = folder.publish(&files)?;
        say_taken(&left_out, log);
    }
    text.push_str(&format!("written to {}\n", out.display()));
    Ok(Answer { text, exit })
}

/// The text of the verdict that the folder `out` has already. `None` unless the verdict is from this campaign with
/// these catalogs and this version, and all of its files are unchanged.
fn kept_before(out: &Path, campaign: &Campaign, hash_of_catalogs: &str) -> Option<String> {
    let verdict: Value = serde_json::from_slice(&std::fs::read(out.join(VERDICT)).ok()?).ok()?;
    let same = verdict["campaign_blake3"] == campaign.hash.as_str()
        && verdict["catalogs_hash"] == hash_of_catalogs
        && verdict["tool_version"] == env!("CARGO_PKG_VERSION")
        && verdict.get("study").is_none()
        && is_as_written(&verdict);
    let is_there = |(name, listed): (&String, &String)| {
        std::fs::read(out.join(name)).is_ok_and(|bytes| hash(&bytes) == *listed)
    };
    let has_all = verdict[NOT_WRITTEN].as_array().is_some_and(Vec::is_empty);
    let is_whole = |files: &BTreeMap<String, String>| has_all && files.iter().all(is_there);
    let files = listed(&verdict).filter(|files| same && is_whole(files))?;
    let text = files.contains_key(TEXT).then(|| std::fs::read_to_string(out.join(TEXT)).ok())??;
    let out = out.display();
    Some(format!(
        "{}{out} has this verdict already, of the same files; --fresh works it out anew\n",
        narrow(&text)
    ))
}

/// Key of the verdict under which stands what could not be written.
const NOT_WRITTEN: &str = "not_written";
/// Name of the file with the verdict as text.
const TEXT: &str = "verdict.txt";

/// Names of the files that will be written, as far as they are known before the fits.
fn planned(args: &ReconcileArgs, campaign: &Campaign, catalogs: &Catalogs) -> Result<Vec<String>, Failure> {
    let always = [VERDICT, TEXT, CORRECTED_FILE, "residuals.csv", PAGE];
    let mut out: Vec<String> = always.into_iter().map(String::from).collect();
    out.extend(corrected_files(&campaign.other_arms));
    if let Some(study) = &args.study {
        let of_run = super::run::planned(&study_of(study, catalogs)?.0);
        let place = |folder: &'static str| of_run.iter().map(move |name| format!("study/{folder}/{name}"));
        out.extend(place("nominal").chain(place("corrected")));
        out.push(CHANGES.into());
    }
    Ok(out)
}

/// Writes the verdict, and then the page. Returns all files and a text for the terminal. If the page cannot be made, it
/// is left out with a warning, and the verdict stays.
fn keep(
    campaign: &Campaign,
    outcome: &Outcome,
    hash_of_catalogs: &str,
    folder: &ResultFolder,
    log: Log,
) -> Result<(Files, String), Failure> {
    let texts = outcome.files().into_iter().map(|(name, text)| (name, text.into_bytes()));
    let mut files: Files = texts.collect();
    change_verdict(&mut files, "catalogs_hash", hash_of_catalogs.into());
    change_verdict(&mut files, NOT_WRITTEN, json!([PAGE]));
    let mut left_out = folder.publish(&files)?;
    let mut extra = ExtraFiles::default();
    let page = extra.make("report.html and plots", || {
        let page = campaign_page(campaign, outcome);
        (page.page().into_files(), page.terminal())
    });
    let (of_page, terminal) = page.unwrap_or_default();
    change_verdict(&mut files, NOT_WRITTEN, json!(extra.missing));
    match folder.publish(&[files.clone(), of_page.clone()].concat()) {
        Ok(names) => {
            files.extend(of_page);
            left_out = names;
        }
        Err(e) => {
            extra.missing.push(format!("the page: {e}"));
            change_verdict(&mut files, NOT_WRITTEN, json!(extra.missing));
        }
    }
    say_missing(&extra.missing_with(&left_out), log);
    Ok((files, terminal))
}

/// Adds the results of `rerun`, the two runs of the study, to the verdict, and their files to `files`.
fn add(files: &mut Files, rerun: Rerun) {
    change_verdict(files, "study", rerun.json);
    let texts = files.iter_mut().filter(|(name, _)| name == TEXT);
    texts.for_each(|(_, bytes)| bytes.extend(rerun.text.as_bytes()));
    files.extend(rerun.files);
}

/// Sets the key `key` of `verdict.json`, which is one of `files`, to `value`.
fn change_verdict(files: &mut Files, key: &str, value: Value) {
    for (_, bytes) in files.iter_mut().filter(|(name, _)| name == VERDICT) {
        let mut verdict: Value = serde_json::from_slice(bytes).expect("it was written as JSON");
        verdict[key] = value.clone();
        *bytes = format!("{verdict:#}\n").into_bytes();
    }
}

/// Breaks the lines of a text at 80 columns. Continued lines have the same indent. Shorter lines, such as
/// those of tables, stay as they are.
fn narrow(text: &str) -> String {
    let line = |line: &str| {
        if line.chars().count() <= TERMINAL {
            return format!("{line}\n");
        }
        let lead: String = line.chars().take_while(|c| *c == ' ').collect();
        wrap(line, TERMINAL, &lead)
    };
    text.lines().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::narrow;

    #[test]
    fn tables_keep_their_columns_and_long_lines_are_broken() {
        let row = "  geometry                                     0.031    0.037    0.036    0.060\n";
        assert_eq!(narrow(row), row);
        let long = format!("  {}", "word ".repeat(20));
        assert!(narrow(&long).lines().all(|l| l.len() <= 80 && l.starts_with("  word")));
    }
}
