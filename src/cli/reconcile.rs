//! `armwright reconcile`: where model and measurement disagree, what is missing, and what that changes.

use super::exit::{Answer, Exit};
use super::failure::Failure;
use super::log::Log;
use super::rerun::{Rerun, rerun};
use super::search::SearchArgs;
use super::write::write_all;
use crate::catalog::Catalogs;
use crate::reconcile::readings::campaign::Campaign;
use crate::reconcile::together::reconcile;
use crate::reconcile::verdict::outcome::Outcome;
use crate::reconcile::verdict::page::campaign_page;
use crate::report::words::{TERMINAL, wrap};
use clap::Args;
use serde_json::Value;
use std::path::{Path, PathBuf};

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
    every design of either front under both models, and verdict.json says under \"study\" which picks change.")]
pub(crate) struct ReconcileArgs {
    /// Folder of a campaign: campaign.json, arm.json and any of static.csv, modal.csv, windup.csv,
    /// positions.csv, record.csv. Several campaigns of one arm are reconciled together.
    #[arg(required = true, value_name = "CAMPAIGN")]
    pub campaigns: Vec<PathBuf>,
    /// A built-in study or a study file to run again with the corrected arm; effects apply to the joints and
    /// links of the same name.
    #[arg(long, value_name = "STUDY")]
    pub study: Option<String>,
    /// Applies to each of the study's two runs.
    #[command(flatten)]
    pub how: SearchArgs,
    /// Folder to write into, made with its parents; default: `results/<campaign>`.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Reads, reconciles and writes; returns the outcome and the text to print.
///
/// # Errors
/// All faults of the input files, or a file that cannot be written.
pub(crate) fn run(
    args: &ReconcileArgs,
    catalogs: &Catalogs,
    overlay: Option<&Path>,
    log: Log,
) -> Result<(Outcome, Answer), Failure> {
    match &args.study {
        // a study that does not read, or a search that does not suit it, fails now and not after the fits
        Some(study) => drop(args.how.check(&super::asked::load_study(study, catalogs)?.0, catalogs)?),
        None if !args.how.is_default() => {
            return Err(Failure::Usage("--search and --time-limit are for the runs of --study".into()));
        }
        None => {}
    }
    let mut read = Vec::new();
    for folder in &args.campaigns {
        read.push(Campaign::read(folder, catalogs)?);
    }
    let first = read.remove(0);
    let campaign = first.join(read).map_err(Failure::Usage)?;
    let out = args.out.clone().unwrap_or_else(|| Path::new("results").join(&campaign.statement.name));
    let outcome = reconcile(&campaign);
    let mut files: Vec<(String, Vec<u8>)> =
        outcome.files().into_iter().map(|(name, text)| (name, text.into_bytes())).collect();
    let page = campaign_page(&campaign, &outcome);
    files.extend(page.page().into_files());
    write_all(&out, &files)?;
    let mut text = format!("{}{}", narrow(&outcome.to_text()), page.terminal());
    let mut exit = Exit::Done;
    if let Some(study) = &args.study {
        let rerun = rerun(&outcome, (study, &args.how), catalogs, overlay, &out, log)?;
        text.push_str(&rerun.text);
        exit = rerun.exit;
        add(&mut files, &outcome, rerun);
        write_all(&out, &files)?;
    }
    text.push_str(&format!("written to {}\n", out.display()));
    Ok((outcome, Answer { text, exit }))
}

/// Adds the result of the second run of the study to the verdict, and its table to the files.
fn add(files: &mut Vec<(String, Vec<u8>)>, outcome: &Outcome, rerun: Rerun) {
    for (name, bytes) in files.iter_mut() {
        match name.as_str() {
            "verdict.json" => {
                let mut verdict: Value = outcome.to_json();
                verdict["study"] = rerun.json.clone();
                *bytes = format!("{verdict:#}\n").into_bytes();
            }
            "verdict.txt" => bytes.extend(rerun.text.as_bytes()),
            _ => {}
        }
    }
    files.extend(rerun.csv.map(|csv| ("study_changes.csv".to_string(), csv.into_bytes())));
}

/// Breaks lines at 80 columns; continued lines keep the indent. Tables are not touched.
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
