//! `armwright predict`: the model's value beside every reading.

use super::Failure;
use crate::arm::read_arm;
use crate::catalog::Catalogs;
use crate::reconcile::campaign::read_statement;
use crate::reconcile::predict::predict;
use crate::reconcile::table::Table;
use clap::Args;
use std::path::PathBuf;

/// Arguments of `predict`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  armwright predict results/may/arm.corrected.json campaigns/june/static.csv \
    --campaign campaigns/june/campaign.json --out june.csv\n\nThe kind of readings is known by their columns. \
    Effects of the payload and of the measuring channels are used here too."
)]
pub struct PredictArgs {
    /// Arm file, corrected or not.
    #[arg(value_name = "ARM")]
    pub arm: PathBuf,
    /// Readings: a static, modal, windup or positions file.
    #[arg(value_name = "READINGS")]
    pub readings: PathBuf,
    /// The campaign.json that says how they were taken.
    #[arg(long, value_name = "FILE")]
    pub campaign: PathBuf,
    /// File to write; default: standard output.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// The readings with the model's columns, or where they were written.
///
/// # Errors
/// All faults of the input files, or a file that cannot be written.
pub fn run(args: &PredictArgs, catalogs: &Catalogs) -> Result<String, Failure> {
    let statement = read_statement(&args.campaign)?;
    let arm = read_arm(&args.arm, catalogs)?;
    let text = predict(&arm, &statement, Table::read(&args.readings)?)?;
    let Some(out) = &args.out else { return Ok(text) };
    if let Some(folder) = out.parent().filter(|f| !f.as_os_str().is_empty()) {
        fs_err::create_dir_all(folder).map_err(|e| Failure::file(folder, "create", &e))?;
    }
    fs_err::write(out, text).map_err(|e| Failure::file(out, "write", &e))?;
    Ok(format!("written to {}\n", out.display()))
}
