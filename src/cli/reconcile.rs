//! `armwright reconcile`: where model and measurement disagree, and what is missing.

use super::{Failure, write_all};
use crate::catalog::Catalogs;
use crate::reconcile::{Campaign, Outcome, reconcile};
use clap::Args;
use std::path::{Path, PathBuf};

/// Arguments of `reconcile`.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  armwright reconcile campaigns/may --out results/may\n\n\
    Writes verdict.json, verdict.txt, arm.corrected.json and residuals.csv. The verdict is one of no_gap, \
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
    let files: Vec<(String, Vec<u8>)> =
        outcome.files().into_iter().map(|(name, text)| (name, text.into_bytes())).collect();
    write_all(&out, &files)?;
    let text = format!("{}written to {}\n", outcome.to_text(), out.display());
    Ok((outcome, text))
}
