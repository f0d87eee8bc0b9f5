//! `armwright design`: writes a design of a result as an arm file and its cases.

use super::failure::Failure;
use super::finished::{catalogs_hash, pretty};
use super::version::refuse_earlier;
use super::write::write_all;
use crate::catalog::Catalogs;
use crate::input::json::Document;
use crate::space::design::{full_objectives, number_of};
use crate::space::problem::ArmProblem;
use crate::study::read::read_study;
use clap::Args;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Writes a design of a result as an arm file, with every part resolved to numbers, and the cases in which it
/// was judged. `analyze` reproduces its objectives from both files.
#[derive(Debug, Args)]
#[command(after_help = "Example: armwright design results/compare-materials 3k9 --out my-arm\n         \
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

/// Executes the verb.
pub(super) fn run(args: &DesignArgs, catalogs: &Catalogs) -> Result<String, Failure> {
    check_catalogs(&args.results, catalogs)?;
    let study = read_study(Document::read(&args.results.join("study.json"))?, catalogs)?;
    let unknown = || {
        Failure::Usage(format!(
            "{} has no design \"{}\": take a design_id from its front.csv",
            args.results.display(),
            args.id
        ))
    };
    let number = number_of(&args.id).ok_or_else(unknown)?;
    let space = study.space.excerpt(catalogs, &[number]).ok_or_else(unknown)?;
    let problem = ArmProblem::new(&space, catalogs);
    let chosen = problem.options_of_whole(number).ok_or_else(unknown)?;
    let mut arm = problem.arm(&chosen).ok_or_else(unknown)?;
    arm.name = format!("{} {}", study.name, args.id);
    let cases = problem.load_cases();
    let objectives = full_objectives(&arm, &cases);
    let dir = args.out.clone().unwrap_or_else(|| args.results.join(format!("design-{}", args.id)));
    let cases: Vec<Value> = cases.iter().map(crate::arm::load::LoadCase::to_json).collect();
    write_all(
        &dir,
        &[("arm.json".into(), pretty(&arm.to_json())), ("cases.json".into(), pretty(&json!(cases)))],
    )?;
    Ok(format!(
        "design {} of {}: tip deflection {:.4} mm, mass {:.3} kg, lowest mode {:.3} Hz\n\
         written to {}: arm.json, cases.json\n\
         try: armwright analyze {} --cases {}\n",
        args.id,
        study.name,
        objectives.tip_deflection_m * 1e3,
        objectives.mass_kg,
        objectives.lowest_mode_hz,
        dir.display(),
        dir.join("arm.json").display(),
        dir.join("cases.json").display()
    ))
}

/// Reads the facts of a result's run. Fails if an earlier version made the result, or if it was made with other
/// catalogs, because an id would then name another design.
pub(super) fn check_catalogs(results: &Path, catalogs: &Catalogs) -> Result<Value, Failure> {
    let path = results.join("run.json");
    let text = fs_err::read_to_string(&path).map_err(|e| Failure::File(e.to_string()))?;
    let run: Value =
        serde_json::from_str(&text).map_err(|e| Failure::File(format!("{}: {e}", path.display())))?;
    refuse_earlier(&path, &run)?;
    if run["catalogs_hash"].as_str() == Some(&catalogs_hash(catalogs)) {
        return Ok(run);
    }
    let hint = match run["catalogs"].as_str() {
        Some(folder) => format!("it used --catalogs {folder}; give the same folder, unchanged"),
        None => "it used the built-in catalogs of another version; run the study again".into(),
    };
    Err(Failure::Check(format!("{} was made with other catalogs: {hint}", results.display())))
}
