//! `armwright reconcile`: where model and measurement disagree, and what is missing.

use super::{Failure, write_all};
use crate::catalog::Catalogs;
use crate::reconcile::page::campaign_page;
use crate::reconcile::{Campaign, Outcome, reconcile};
use crate::report::compare::text::wrap;
use clap::Args;
use std::path::{Path, PathBuf};

/// Arguments of `reconcile`.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  armwright reconcile campaigns/may --out results/may\n\n\
    Writes verdict.json, verdict.txt, arm.corrected.json, residuals.csv, and report.html with its pictures in plots/. The verdict is one of no_gap, \
    explained, unexplained, insufficient_data; all four are answers, exit code 0.")]
pub struct ReconcileArgs {
    /// Folder of a campaign: campaign.json, arm.json and any of static.csv, modal.csv, windup.csv,
    /// positions.csv. Several campaigns of one arm are reconciled together.
    #[arg(required = true, value_name = "CAMPAIGN")]
    pub campaigns: Vec<PathBuf>,
    /// Folder to write into, made with its parents; default: `results/<campaign>`.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Reads, reconciles and writes; returns the outcome and the text to print.
///
/// # Errors
/// All faults of the input files, or a file that cannot be written.
pub fn run(args: &ReconcileArgs, catalogs: &Catalogs) -> Result<(Outcome, String), Failure> {
    let mut read = Vec::new();
    for folder in &args.campaigns {
        read.push(Campaign::read(folder, catalogs)?);
    }
    let first = read.remove(0);
    let campaign = first.join(read).map_err(Failure::Usage)?;
    let out = args.out.clone().unwrap_or_else(|| Path::new("results").join(&campaign.statement.name));
    let outcome = reconcile(&campaign);
    let mut files: Vec<(String, Vec<u8>)> =
        outcome.files().into_iter().map(|(name, text)| (name.to_string(), text.into_bytes())).collect();
    let page = campaign_page(&campaign, &outcome);
    files.extend(page.page().into_files());
    write_all(&out, &files)?;
    let text = format!("{}{}written to {}\n", narrow(&outcome.to_text()), page.terminal(), out.display());
    Ok((outcome, text))
}

/// Lines of at most 80 columns, those broken indented like what they belong to.
fn narrow(text: &str) -> String {
    let line = |line: &str| {
        let lead: String = line.chars().take_while(|c| *c == ' ').collect();
        wrap(line, 80, &lead)
    };
    text.lines().map(line).collect()
}
