//! `armwright predict`: adds the model's value to every reading.

use super::failure::Failure;
use super::result_folder::complete;
use super::write::{say, write_file};
use crate::arm::effect::channel::Channel;
use crate::arm::file::read_arm;
use crate::catalog::Catalogs;
use crate::input::json::{Faults, InputError};
use crate::reconcile::predict::{predict, unplaced};
use crate::reconcile::readings::campaign::{Statement, read_statement};
use crate::reconcile::readings::placement::Placed;
use crate::reconcile::readings::placement::Placement;
use crate::reconcile::readings::source::Source;
use crate::reconcile::readings::table::Table;
use crate::report::whole_file::folder_of;
use clap::Args;
use serde_json::Value;
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
    /// The campaign.json that says how they were taken.
    #[arg(long, value_name = "FILE")]
    pub campaign: PathBuf,
    /// File to write; default: standard output.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

fn json_of(file: &Path) -> Value {
    let text = std::fs::read_to_string(file).unwrap_or_default();
    serde_json::from_str(&text).unwrap_or_default()
}

fn placed(file: &Path, catalogs: &Catalogs) -> Result<Placed, Failure> {
    let arm = read_arm(file, catalogs)?;
    if let Some(fault) = arm.tilt_fault(&file.display().to_string()) {
        return Err(InputError::from(Faults(vec![fault])).into());
    }
    Ok(Placed { arm, placement: Placement::from_json(&json_of(file)) })
}

/// The other arms on the same trunk: those named in the corrected arm's provenance, or else in the campaign.
fn other_arms(args: &PredictArgs, statement: &Statement) -> Vec<PathBuf> {
    let folder = |file: &Path| file.parent().map(Path::to_path_buf).unwrap_or_default();
    let corrected = json_of(&args.arm);
    match corrected["provenance"]["other_arms"].as_array() {
        Some(names) => {
            names.iter().filter_map(Value::as_str).map(|name| folder(&args.arm).join(name)).collect()
        }
        None => statement.other_arm_files.iter().map(|name| folder(&args.campaign).join(name)).collect(),
    }
}

/// The readings, with the names of columns that `campaign.json` states for a file of this name, or else for a file
/// with these columns.
fn table(file: &Path, statement: &Statement) -> Result<Table, Failure> {
    let sources = Channel::ALL.map(|channel| statement.source(channel));
    let is_named = |source: &&Source| source.file.as_ref().is_some_and(|named| file.ends_with(named));
    if let Some(source) = sources.iter().find(is_named) {
        return Ok(Table::read_from(file, source)?);
    }
    let table = Table::read_from(file, &Source::default())?;
    let has_all = |source: &&Source| source.columns.iter().all(|(_, shown)| table.columns.contains(shown));
    match sources.iter().filter(|source| !source.columns.is_empty()).find(has_all) {
        Some(Source { columns, .. }) => {
            let source = Source { columns: columns.clone(), ..Source::default() };
            Ok(Table::read_from(file, &source)?)
        }
        None => Ok(table),
    }
}

/// The readings with the columns of the model, or the name of the file they were written to.
///
/// # Errors
/// All faults of the input files, or a file that cannot be written.
pub(crate) fn run(args: &PredictArgs, catalogs: &Catalogs) -> Result<String, Failure> {
    complete(&folder_of(&args.arm))?;
    let statement = read_statement(&args.campaign)?;
    let mut arms = vec![placed(&args.arm, catalogs)?];
    for file in other_arms(args, &statement) {
        arms.push(placed(&file, catalogs)?);
    }
    let text = predict(&arms, &statement, table(&args.readings, &statement)?)?;
    let remark = unplaced(&arms, &table(&args.readings, &statement)?);
    let remark = remark.map_or(String::new(), |remark| format!("{remark}.\n"));
    let Some(out) = &args.out else {
        // the readings are the output; what is said about them must not be among them
        say(&remark);
        return Ok(text);
    };
    let others = other_arms(args, &statement);
    let inputs = [&args.arm, &args.readings, &args.campaign].into_iter().chain(&others);
    let inputs: Vec<&Path> = inputs.map(PathBuf::as_path).collect();
    write_file(out, text.as_bytes(), &inputs)?;
    Ok(format!("{remark}written to {}\n", out.display()))
}
