//! Input files of another kind than a verb takes: what they are, and which verb takes them.

use super::check_kinds::{keys_of_kind, kind_of};
use super::failure::Failure;
use crate::catalog::Catalogs;
use crate::input::json::{Fault, Faults};
use crate::study::definition::Study;
use crate::study::load::load_study;
use serde_json::Value;
use std::path::Path;

/// Refuses a file that is more likely of another kind than `wanted` (`arm`, `study`, `cases`). It accepts a file that
/// cannot be read or is not JSON, because the function that reads the file reports this.
///
/// # Errors
/// One fault that says of which kind the file is and which verb takes it.
pub(super) fn refuse_other_kind(path: &Path, wanted: &str) -> Result<(), Failure> {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let Ok(value) = serde_json::from_str::<Value>(&text) else { return Ok(()) };
    let Some(kind) = kind_of(&value).filter(|kind| *kind != wanted) else { return Ok(()) };
    // a file that has at least as many keys of the wanted kind is accepted
    match kind == "cases" || keys_of_kind(kind, &value) > keys_of_kind(wanted, &value) {
        true => Err(Faults(vec![Fault {
            file: path.display().to_string(),
            line: None,
            field: String::new(),
            problem: format!("is {}, and this verb takes {}", with_article(kind), with_article(wanted)),
            hint: next_step(kind, path),
        }])
        .into()),
        false => Ok(()),
    }
}

/// A study by its name or from its file, with its text.
///
/// # Errors
/// The errors of [`load_study`]. Also an error if the file is of another kind.
pub(super) fn study_of(name: &str, catalogs: &Catalogs) -> Result<(Study, String), Failure> {
    refuse_other_kind(Path::new(name), "study")?;
    Ok(load_study(name, catalogs)?)
}

/// The kind of a file in words, with its article, for messages.
fn with_article(kind: &str) -> String {
    match kind {
        "arm" => "an arm file".into(),
        "study" => "a study".into(),
        "cases" => "a list of load cases".into(),
        "campaign" => "the campaign.json of a campaign".into(),
        "run" | "verdict" | "shard" | "choices" | "export" | "import" => {
            format!("the {kind}.json of a result")
        }
        kind => format!("a file of the kind {kind}"),
    }
}

/// Advice what to do with the file `path`, which is of the kind `kind`.
fn next_step(kind: &str, path: &Path) -> String {
    let file = path.display();
    match kind {
        "arm" => format!(
            "`armwright analyze {file}` takes it, and `armwright new campaign {file} --out DIR` starts a campaign of it"
        ),
        "study" => format!(
            "`armwright run {file}` searches it, `armwright size {file}` sizes its joints; `armwright design RESULTS ID` writes the arm file \
             of a design that was found"
        ),
        "cases" => format!("`armwright analyze ARM --cases {file}` takes it"),
        "campaign" => {
            let folder = crate::report::whole_file::folder_of(path);
            format!("`armwright reconcile {}` takes its folder", folder.display())
        }
        _ => format!("`armwright check {file}` says what it is"),
    }
}

/// Refuses what is no campaign: a folder without campaign.json, or a file of another kind outside of a campaign.
///
/// # Errors
/// A sentence that says what is there and how a campaign is started.
pub(super) fn refuse_no_campaign(path: &Path) -> Result<(), Failure> {
    let folder = if path.is_file() { crate::report::whole_file::folder_of(path) } else { path.to_path_buf() };
    if folder.join("campaign.json").exists() {
        return Ok(());
    }
    if path.is_file() {
        refuse_other_kind(path, "campaign")?;
    }
    let what = if folder.is_dir() { "has no campaign.json, so it is no campaign" } else { "is no folder" };
    let hint = "give the folder of a campaign; `armwright new campaign ARM.json --out DIR` starts one";
    Err(Failure::File(format!("{} {what}; {hint}", folder.display())))
}
