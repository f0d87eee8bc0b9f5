//! `armwright predict`: adds the value that the model predicts to every reading.

use super::failure::Failure;
use super::log::Log;
use super::own_files::write_recognized;
use super::result_folder::complete;
use super::wrong_kind::refuse_other_kind;
use crate::catalog::Catalogs;
use crate::reconcile::predict_files::{Files, predict_files};
use crate::report::whole_file::folder_of;
use clap::Args;
use std::path::{Path, PathBuf};

/// Arguments of `predict`.
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  armwright predict results/may/arm.corrected.json campaigns/june/static.csv \
    --campaign campaigns/june/campaign.json --out june.csv\n\nThe kind of readings is known by their columns. \
    Effects of the payload and of the measuring channels are used here too. A corrected arm finds the other arms \
    on its trunk beside itself; those of a nominal arm are the campaign's `other_arms`."
)]
pub(crate) struct PredictArgs {
    /// Arm file, corrected or not.
    #[arg(value_name = "ARM")]
    pub arm: PathBuf,
    /// Readings: a static, modal, windup or positions file.
    #[arg(value_name = "READINGS")]
    pub readings: PathBuf,
    /// The campaign.json that says how the readings were taken.
    #[arg(long, value_name = "FILE")]
    pub campaign: PathBuf,
    /// File to write; default: standard output. An earlier prediction is replaced, any other file is not.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// Runs `armwright predict`. Returns the readings with the columns of the model, or the name of the file to which
/// they were written.
///
/// # Errors
/// The input files have faults, or a file cannot be written.
pub(crate) fn run(args: &PredictArgs, catalogs: &Catalogs, log: Log) -> Result<String, Failure> {
    complete(&folder_of(&args.arm))?;
    refuse_other_kind(&args.arm, "arm")?;
    let files = Files { arm: &args.arm, readings: &args.readings, campaign: &args.campaign };
    let found = predict_files(&files, catalogs)?;
    let Some(out) = &args.out else {
        // the readings are the output, so the remark must go elsewhere: to standard error
        found.remark.iter().for_each(|remark| log.note(&format!("{remark}.")));
        return Ok(found.csv);
    };
    let inputs = [&args.arm, &args.readings, &args.campaign].into_iter();
    let inputs = inputs.chain(&found.other_arms).chain(&found.of_campaign);
    let inputs: Vec<&Path> = inputs.map(PathBuf::as_path).collect();
    let name = out.file_name().map(|name| name.to_string_lossy().into_owned());
    let name = name.ok_or_else(|| Failure::Usage(format!("{} is no name of a file", out.display())))?;
    // an earlier prediction begins with the same columns; a file of readings lacks the columns of the model and is not
    // replaced
    let header = found.csv.lines().next().unwrap_or_default();
    let is_prediction = |_: &str, there: &[u8]| there.starts_with(format!("{header}\n").as_bytes());
    write_recognized(&folder_of(out), &[(name, found.csv.clone().into_bytes())], &inputs, is_prediction)?;
    let remark = found.remark.map_or(String::new(), |remark| format!("{remark}.\n"));
    Ok(format!("{remark}written to {}\n", out.display()))
}
