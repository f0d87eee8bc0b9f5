//! Reads the files that a prediction needs, and adds the predictions of the model to the readings.

use super::predict::{predict, unplaced};
use super::readings::campaign::{MOST_READINGS, Statement, read_statement};
use super::readings::placement::{Placed, Placement};
use super::readings::source::{DEFAULT_FILES, Source};
use super::readings::table::Table;
use crate::arm::effect::channel::Channel;
use crate::arm::file::read_arm;
use crate::catalog::Catalogs;
use crate::input::json::{Faults, InputError};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// The input files of a prediction.
#[derive(Debug, Clone, Copy)]
pub struct Files<'a> {
    /// Path of the arm file, corrected or not.
    pub arm: &'a Path,
    /// Path of the file of readings, of any channel: static, modal, windup or positions.
    pub readings: &'a Path,
    /// Path of the `campaign.json` that states how the readings were taken.
    pub campaign: &'a Path,
}

/// Readings with predictions.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// The readings as CSV text, with columns of predictions added.
    pub csv: String,
    /// A remark on the prediction, for example on rows that belong to no known session; `None` if there is none.
    pub remark: Option<String>,
    /// Paths of the arm files of other arms on the same trunk, which were read too.
    pub other_arms: Vec<PathBuf>,
    /// Paths of all arm files and files of readings that the campaign may have, whether they exist and were needed or
    /// not.
    pub of_campaign: Vec<PathBuf>,
}

/// Adds the model's prediction to every row of the file of readings.
///
/// # Errors
/// A file cannot be read, or files have faults. The error then lists all faults of the files.
pub fn predict_files(files: &Files, catalogs: &Catalogs) -> Result<Prediction, InputError> {
    let statement = read_statement(files.campaign)?;
    let other_arms = other_arms(files, &statement);
    let mut arms = vec![placed(files.arm, catalogs)?];
    for file in &other_arms {
        arms.push(placed(file, catalogs)?);
    }
    let mut readings = table(files.readings, &statement)?;
    readings.refuse_more_than(MOST_READINGS);
    let csv = predict(&arms, &statement, readings)?;
    let remark = unplaced(&arms, &table(files.readings, &statement)?);
    let of_campaign = of_campaign(files.campaign, &statement);
    Ok(Prediction { csv, remark, other_arms, of_campaign })
}

/// Paths of the arm files and files of readings that the campaign may have. `campaign` is the path of its
/// `campaign.json`, and `statement` the content.
fn of_campaign(campaign: &Path, statement: &Statement) -> Vec<PathBuf> {
    let folder = campaign.parent().unwrap_or(Path::new(""));
    let named = Channel::ALL.into_iter().filter_map(|channel| statement.source(channel).file);
    let arms = std::iter::once(&statement.arm_file).chain(&statement.other_arm_files).cloned();
    let readings = DEFAULT_FILES.map(String::from).into_iter().chain(named).chain(["record.csv".into()]);
    arms.chain(readings).map(|name| folder.join(name)).collect()
}

/// Content of a JSON file; null if the file cannot be read or is not JSON.
fn json_of(file: &Path) -> Value {
    let text = std::fs::read_to_string(file).unwrap_or_default();
    serde_json::from_str(&text).unwrap_or_default()
}

/// Reads an arm file, and the placement of the arm that its provenance states.
fn placed(file: &Path, catalogs: &Catalogs) -> Result<Placed, InputError> {
    let arm = read_arm(file, catalogs)?;
    if let Some(fault) = arm.tilt_fault(&file.display().to_string()) {
        return Err(Faults(vec![fault]).into());
    }
    Ok(Placed { arm, placement: Placement::from_json(&json_of(file)) })
}

/// Paths of the other arms on the same trunk. The provenance of a corrected arm names them. If the arm file has no such
/// list, they are the arms that `campaign.json` names.
fn other_arms(files: &Files, statement: &Statement) -> Vec<PathBuf> {
    let folder = |file: &Path| file.parent().map(Path::to_path_buf).unwrap_or_default();
    let corrected = json_of(files.arm);
    match corrected["provenance"]["other_arms"].as_array() {
        Some(names) => {
            names.iter().filter_map(Value::as_str).map(|name| folder(files.arm).join(name)).collect()
        }
        None => statement.other_arm_files.iter().map(|name| folder(files.campaign).join(name)).collect(),
    }
}

/// Reads the table of readings from `file`. In `campaign.json`, users may state other names for the columns of a
/// channel. These names are used in two cases: `campaign.json` names this file for the channel, or the file has all
/// columns with these names.
///
/// # Errors
/// The file cannot be read.
fn table(file: &Path, statement: &Statement) -> Result<Table, InputError> {
    let sources = Channel::ALL.map(|channel| statement.source(channel));
    let is_named = |source: &&Source| source.file.as_ref().is_some_and(|named| file.ends_with(named));
    if let Some(source) = sources.iter().find(is_named) {
        return Table::read_from(file, source);
    }
    let table = Table::read_from(file, &Source::default())?;
    let has_all = |source: &&Source| source.columns.iter().all(|(_, shown)| table.columns.contains(shown));
    match sources.iter().filter(|source| !source.columns.is_empty()).find(has_all) {
        Some(Source { columns, .. }) => {
            let source = Source { columns: columns.clone(), ..Source::default() };
            Table::read_from(file, &source)
        }
        None => Ok(table),
    }
}
