//! The functions of the package that answer quickly, and `reconcile`, which may take long. The search for the front of
//! a study is in `run`.

use crate::catalogs::Catalogs;
use crate::conduct::{pooled, workers};
use crate::errors;
use crate::source::Source;
use armwright::arm::Words;
use armwright::arm::read_load_cases;
use armwright::interchange::{ExportRequest, Format, import_urdf};
use armwright::reconcile::predict_files::{Files, predict_files};
use armwright::reconcile::{Campaign, Outcome};
use armwright::report::analysis::{Analysis, Harmonic};
use armwright::study::{
    arm_of_design, arm_remarks, capacity_of, capacity_of_arm, ignored_words, named, names, sizing_of,
};
use pyo3::prelude::*;
use serde_json::Value;
use std::path::PathBuf;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// A harmonic load at the tip: amplitude of the force \[N\], damping ratio \[-\], and frequencies \[Hz\].
type HarmonicOf = ([f64; 3], f64, Vec<f64>);

/// Results of an analysis: a JSON list with one entry for each case, the same results as text for each case, and
/// remarks on all of them.
type Analyzed = (String, Vec<String>, Vec<String>);

#[pyfunction]
pub(crate) fn analyze(
    py: Python<'_>,
    catalogs: &Catalogs,
    arm: Source,
    cases: Source,
    modes: usize,
    harmonic: Option<HarmonicOf>,
) -> PyResult<Analyzed> {
    let arm = arm.arm(&catalogs.parts)?;
    let cases = read_load_cases(cases.document()?, &arm.driven_joints()).map_err(errors::faults)?;
    let harmonic = harmonic.map(|(force_n, damping, frequencies_hz)| Harmonic {
        force_n: force_n.into(),
        damping,
        frequencies_hz,
    });
    pooled(py, || {
        let solve = |case| Analysis::of(&arm, case, modes, harmonic.as_ref());
        let solved: Vec<Analysis> = cases.into_iter().map(solve).collect();
        let ignored = ignored_words(&arm).map_or(String::new(), |words| format!("  {words}\n"));
        let json = Value::Array(solved.iter().map(|one| one.to_json(&arm)).collect()).to_string();
        let texts = solved.iter().map(|one| one.to_text(&arm) + &ignored).collect();
        (json, texts, arm_remarks(&arm, &catalogs.parts))
    })
}

#[pyfunction]
pub(crate) fn driven_joints(catalogs: &Catalogs, arm: Source) -> PyResult<Vec<String>> {
    let arm = arm.arm(&catalogs.parts)?;
    Ok(arm.driven_joint_names().into_iter().map(String::from).collect())
}

/// Sizes the drives of a study: for the design with the identifier `design`, or with links of median mass if it is
/// `None`. Returns the rows of the sizing as JSON text, and remarks on them.
#[pyfunction]
pub(crate) fn size(
    py: Python<'_>,
    catalogs: &Catalogs,
    study: Source,
    design: Option<&str>,
) -> PyResult<(String, Vec<String>)> {
    let parts = &catalogs.parts;
    let (study, _) = pooled(py, || study.study(parts))??;
    let sizing = pooled(py, || sizing_of(&study, design, parts))?.map_err(errors::refused)?;
    Ok((serde_json::to_string(&sizing.rows).map_err(errors::usage)?, sizing.remarks))
}

/// Finds the largest payload. `asked` is a study or an arm. `design` is the identifier of a design of the study; with
/// `None`, links have median mass and drives are the lightest. `cases` and `limits` are for an arm only. If an arm file
/// has an `import.json` in its folder and `limits` is `None`, the limits are read from there. Returns JSON text.
#[pyfunction]
pub(crate) fn capacity(
    py: Python<'_>,
    catalogs: &Catalogs,
    asked: Source,
    design: Option<&str>,
    cases: Option<Source>,
    limits: Option<Source>,
) -> PyResult<String> {
    let parts = &catalogs.parts;
    if asked.is_arm() {
        if design.is_some() {
            return Err(errors::usage("this is an arm; a design is one of a study"));
        }
        let arm = asked.arm(parts)?;
        let limits = limits.or_else(|| asked.beside("import.json"));
        let [cases, limits] = [cases, limits].map(|source| source.map(|s| s.document()).transpose());
        let (cases, limits) = (cases?, limits?);
        let found = pooled(py, || capacity_of_arm(&arm, cases, limits, parts))?.map_err(errors::refused)?;
        return Ok(found.to_json().to_string());
    }
    if cases.is_some() || limits.is_some() {
        return Err(errors::usage("cases and limits are for arms; a study has its own poses and drives"));
    }
    let (study, _) = pooled(py, || asked.study(parts))??;
    let found = pooled(py, || capacity_of(&study, design, parts))?.map_err(errors::refused)?;
    let mut json = found.to_json();
    json["remarks"] = found.remarks.iter().chain(&study.remarks).cloned().collect();
    Ok(json.to_string())
}

/// Returns the arm of the design with the identifier `id`, and the cases in which the study judges it, both as JSON
/// text.
#[pyfunction]
pub(crate) fn design(
    py: Python<'_>,
    catalogs: &Catalogs,
    study: Source,
    id: &str,
) -> PyResult<(String, String)> {
    let parts = &catalogs.parts;
    let (study, _) = pooled(py, || study.study(parts))??;
    let (arm, cases) = pooled(py, || arm_of_design(&study, id, parts))?.map_err(errors::refused)?;
    let cases: Vec<Value> = cases.iter().map(|case| case.to_json(&arm.driven_joints())).collect();
    Ok((arm.to_json().to_string(), Value::Array(cases).to_string()))
}

/// The result of an export: the name of the exported case, and name and content of each file.
type ExportedFiles = (String, Vec<(String, Vec<u8>)>);

/// Exports an arm in one case for another program. `to` is the name of the format. `case` is the name of the case;
/// `cases` are those to choose from.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "they are those of the Python function")]
pub(crate) fn export(
    py: Python<'_>,
    catalogs: &Catalogs,
    arm: Source,
    cases: Source,
    to: &str,
    case: Option<&str>,
    pieces_per_link: Option<u16>,
    backlash: bool,
) -> PyResult<ExportedFiles> {
    let unknown = || errors::usage(format!("to is \"{to}\": give one of {}", Format::words()));
    let format = Format::from_word(to).ok_or_else(unknown)?;
    let arm = arm.arm(&catalogs.parts)?;
    let cases = read_load_cases(cases.document()?, &arm.driven_joints()).map_err(errors::faults)?;
    let request = ExportRequest { arm: &arm, cases: &cases, case, format, pieces_per_link, backlash };
    let exported = pooled(py, || request.answer(&catalogs.parts))?.map_err(errors::usage)?;
    Ok((exported.case, exported.files))
}

/// Imports a robot from a URDF file: the chain from the root of the robot to the link `tip`. `stiffness` is an optional
/// file with the stiffnesses, which a URDF file lacks. Returns the arm as JSON text, and a report on what was imported
/// and what was left out.
#[pyfunction]
pub(crate) fn from_urdf(
    catalogs: &Catalogs,
    robot: Source,
    tip: &str,
    stiffness: Option<Source>,
) -> PyResult<(String, String)> {
    let stiffness = stiffness.map(|source| source.document()).transpose()?;
    let made = import_urdf(robot.name(), &robot.text()?, tip, stiffness, &catalogs.parts);
    let (arm, report) = made.map_err(errors::faults)?;
    Ok((arm.to_json().to_string(), report.to_string()))
}

/// Reproduces the study of the paper with the name `name`. Returns name and content of each file.
#[pyfunction]
pub(crate) fn paper(py: Python<'_>, catalogs: &Catalogs, name: &str) -> PyResult<Vec<(String, String)>> {
    let output = pooled(py, || armwright::paper::run(name, &catalogs.parts))?.map_err(errors::usage)?;
    let text = |(name, bytes): (String, Vec<u8>)| (name, String::from_utf8_lossy(&bytes).into_owned());
    Ok(output.files.into_iter().map(text).collect())
}

#[pyfunction]
pub(crate) fn study_names() -> Vec<&'static str> {
    names()
}

#[pyfunction]
pub(crate) fn study_text(name: &str) -> Option<&'static str> {
    named(name)
}

/// The result of `reconcile`: the verdict as JSON and as text, the corrected arm as JSON, the residuals as CSV, and
/// name and content of each file of the result.
type Reconciled = (String, String, String, String, Vec<(String, String)>);

#[pyfunction]
pub(crate) fn reconcile(
    py: Python<'_>,
    catalogs: &Catalogs,
    campaigns: Vec<PathBuf>,
) -> PyResult<Reconciled> {
    let mut read = Vec::new();
    for folder in &campaigns {
        let campaign = pooled(py, || Campaign::read(folder, &catalogs.parts))?;
        read.push(campaign.map_err(errors::input)?);
    }
    if read.is_empty() {
        return Err(errors::usage("give the folder of a campaign"));
    }
    let first = read.remove(0);
    let campaign = first.join(read).map_err(errors::usage)?;
    let pool = workers(0)?;
    let outcome = interruptible(py, move || pool.install(|| armwright::reconcile::reconcile(&campaign)))?;
    Ok((
        outcome.to_json().to_string(),
        outcome.to_text(),
        outcome.corrected_json().to_string(),
        outcome.residuals_csv(),
        outcome.files(),
    ))
}

/// Runs `work` on another thread and returns its outcome. This thread checks for signals every 50 ms. After Ctrl-C the
/// function returns the exception at once. The work cannot be stopped and continues on its thread; its outcome is then
/// dropped.
fn interruptible(py: Python<'_>, work: impl FnOnce() -> Outcome + Send + 'static) -> PyResult<Outcome> {
    let (done, ended) = channel();
    let worker = std::thread::spawn(move || {
        // sending fails if the caller was interrupted and no longer waits; this is no error
        let _ = done.send(work());
    });
    let ended = std::sync::Mutex::new(ended);
    loop {
        let wait = || match ended.lock() {
            Ok(ended) => ended.recv_timeout(Duration::from_millis(50)),
            Err(_) => Err(RecvTimeoutError::Disconnected),
        };
        match py.detach(wait) {
            Ok(outcome) => return Ok(outcome),
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
            Err(RecvTimeoutError::Disconnected) => {
                let panic = worker.join().err().unwrap_or_else(|| Box::new("no outcome"));
                std::panic::resume_unwind(panic)
            }
        }
    }
}

/// Adds the predictions of the model to a file of readings. `arm` and `campaign` are the paths of the arm file and of
/// `campaign.json`. Returns the readings as CSV text with the added columns, and a remark if there is one.
#[pyfunction]
pub(crate) fn predict(
    py: Python<'_>,
    catalogs: &Catalogs,
    arm: PathBuf,
    readings: PathBuf,
    campaign: PathBuf,
) -> PyResult<(String, Option<String>)> {
    let files = Files { arm: &arm, readings: &readings, campaign: &campaign };
    let found = pooled(py, || predict_files(&files, &catalogs.parts))?.map_err(errors::input)?;
    Ok((found.csv, found.remark))
}
