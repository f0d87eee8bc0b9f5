//! `armwright design`: writes a design of a result as an arm file, with a cases file of the cases in which it was
//! judged.

use super::failure::Failure;
use super::finished::{catalogs_hash, pretty};
use super::manifest::STUDY;
use super::own_files::write_own;
use super::results::{Results, TextFile};
use crate::arm::Arm;
use crate::arm::load::LoadCase;
use crate::catalog::Catalogs;
use crate::input::json::Document;
use crate::report::file_names::file_name;
use crate::space::design::full_objectives;
use crate::study::chosen::arm_of_number;
use crate::study::read::read_study;
use clap::Args;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Writes a design of a result as an arm file, with every part resolved to numbers, and the cases in which it
/// was judged. `analyze` reproduces its objectives from both files.
#[derive(Debug, Args)]
#[command(after_help = "Example: armwright design results/compare-materials x3k9 --out my-arm\n         \
                        armwright analyze my-arm/arm.json --cases my-arm/cases.json")]
pub(crate) struct DesignArgs {
    /// Result folder of a study
    results: PathBuf,
    /// design_id from its front.csv
    id: String,
    /// Folder for arm.json and cases.json; default RESULTS/design-ID
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// A design of a result, with its arm and cases in numbers.
pub(super) struct ResolvedDesign {
    /// Name of the study to which the design belongs.
    pub study: String,
    /// The arm of the design.
    pub arm: Arm,
    /// The cases in which the design was judged.
    pub cases: Vec<LoadCase>,
}

/// The design with this id in a folder of results.
///
/// # Errors
/// The folder is not a complete result made with these catalogs, or it has no such design.
pub(super) fn resolve_design(
    folder: &Path,
    id: &str,
    catalogs: &Catalogs,
) -> Result<ResolvedDesign, Failure> {
    let results = open_results(folder, catalogs)?;
    let TextFile { path, text } = results.text(STUDY)?;
    let study = read_study(Document::parse(&path, &text)?, catalogs)?;
    let unknown = || {
        Failure::Usage(format!(
            "{} has no design \"{id}\": take a design_id from its front.csv",
            folder.display()
        ))
    };
    let number = results.number_of(id).ok_or_else(unknown)?;
    let (mut arm, cases) = arm_of_number(&study, number, catalogs).ok_or_else(unknown)?;
    arm.name = format!("{} {id}", study.name);
    Ok(ResolvedDesign { study: study.name, arm, cases })
}

/// Runs `armwright design`: writes the files, and returns the text to print.
pub(super) fn run(args: &DesignArgs, catalogs: &Catalogs) -> Result<String, Failure> {
    let ResolvedDesign { study, arm, cases } = resolve_design(&args.results, &args.id, catalogs)?;
    let objectives = full_objectives(&arm, &cases);
    let dir =
        args.out.clone().unwrap_or_else(|| args.results.join(format!("design-{}", file_name(&args.id))));
    let cases: Vec<Value> = cases.iter().map(|case| case.to_json(&arm.driven_joints())).collect();
    write_own(
        &dir,
        &[("arm.json".into(), pretty(&arm.to_json())), ("cases.json".into(), pretty(&json!(cases)))],
        &[],
    )?;
    Ok(format!(
        "design {} of {study}: tip deflection {:.4} mm, mass {:.3} kg, lowest mode {:.3} Hz\n\
         written to {}: arm.json, cases.json\n\
         try: armwright analyze {} --cases {}\n",
        args.id,
        objectives.tip_deflection_m * 1e3,
        objectives.mass_kg,
        objectives.lowest_mode_hz,
        dir.display(),
        dir.join("arm.json").display(),
        dir.join("cases.json").display()
    ))
}

/// Opens the result of a study. Fails if the folder is not a complete result. Fails also if an earlier version or
/// other catalogs were used, because the same id may then name another design.
pub(super) fn open_results(folder: &Path, catalogs: &Catalogs) -> Result<Results, Failure> {
    let results = Results::open(folder)?;
    let run = &results.run;
    if run["catalogs_hash"].as_str() == Some(&catalogs_hash(catalogs)) {
        return Ok(results);
    }
    let hint = match run["catalogs"].as_str() {
        Some(folder) => format!("it used --catalogs {folder}; give the same folder, unchanged"),
        None => "it used the built-in catalogs of another version; run the study again".into(),
    };
    Err(Failure::Check(format!("{} was made with other catalogs: {hint}", folder.display())))
}
