//! Finds out which kind of file or folder something is, and finds all its faults.

use super::check_kinds::{kind_of, missing_keys, table_of};
use super::exit::{Answer, Exit};
use super::failure::Failure;
use super::manifest::{MANIFESTS, RUN, has_manifest, hash, is_as_written, listed};
use super::result_folder::complete;
use crate::arm::{Arm, DrivenJoint, Motion, read_arm, read_arm_document, read_load_cases};
use crate::catalog::Catalogs;
use crate::catalog::schema::CatalogFile;
use crate::input::json::{Document, Fault, Faults, InputError};
use crate::interchange::given::{MovingJoint, read_given};
use crate::interchange::urdf_file::read_urdf;
use crate::reconcile::Campaign;
use crate::reconcile::readings::record_spec::DEFAULT_FILE as DEFAULT_RECORD;
use crate::reconcile::readings::source::DEFAULT_FILES;
use crate::report::whole_file::folder_of;
use crate::study::load_limits::check_limits;
use crate::study::read_study;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// The findings on one file or folder.
struct Found {
    /// Path of the file or folder.
    place: PathBuf,
    /// Kind of the file or folder in words, such as "study".
    what: &'static str,
    /// `Ok` if the file or folder has no faults, else the reason why it is not sound.
    outcome: Result<(), Problem>,
}

/// Why a file or folder is not sound.
enum Problem {
    /// An input file has faults.
    Faulty(Faults),
    /// The files of a result differ from those that were written.
    Changed(String),
    /// Files of a result are missing, because the user stopped the program or because a file could not be made.
    Incomplete(String),
    /// A file cannot be read.
    Unreadable(String),
}

/// Reports the kind of each file or folder, and all faults of all of them.
pub(super) fn report(files: &[PathBuf], as_json: bool, catalogs: &Catalogs) -> Answer {
    let mut found: Vec<Found> = Vec::new();
    for file in files {
        let place = unit_of(file);
        if !found.iter().any(|other| other.place == place) {
            found.push(look(place, catalogs));
        }
    }
    let text = match as_json {
        true => format!("{:#}\n", Value::Array(found.iter().map(Found::to_json).collect())),
        false => found.iter().map(Found::to_text).collect(),
    };
    Answer { text, exit: exit_of(&found) }
}

/// The exit code for the most serious problem among the files and folders in `found`.
fn exit_of(found: &[Found]) -> Exit {
    let has = |is: fn(&Problem) -> bool| found.iter().any(|f| f.outcome.as_ref().err().is_some_and(is));
    if has(|p| matches!(p, Problem::Faulty(_))) {
        Exit::Input
    } else if has(|p| matches!(p, Problem::Changed(_) | Problem::Incomplete(_))) {
        Exit::CheckFailed
    } else if has(|p| matches!(p, Problem::Unreadable(_))) {
        Exit::File
    } else {
        Exit::Done
    }
}

/// The folder or file that must be read as a whole to check `file`. If `file` is a reading of a campaign, a file of a
/// catalog or a file of a result, it is the folder of the campaign, catalog or result. Otherwise it is the file itself.
fn unit_of(file: &Path) -> PathBuf {
    let name = file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let folder = folder_of(file);
    let is_catalog = CatalogFile::ALL.iter().any(|catalog| catalog.file_name() == name);
    let is_usual = DEFAULT_FILES.contains(&name.as_str()) || name == DEFAULT_RECORD;
    let statement = read_json(&folder.join("campaign.json"));
    let is_reading = !name.ends_with(".json")
        && statement.is_some_and(|statement| is_usual || is_named(&statement, &name));
    let is_result = MANIFESTS.iter().any(|manifest| {
        name == *manifest
            || read_json(&folder.join(manifest))
                .and_then(|m| listed(&m))
                .is_some_and(|l| l.contains_key(&name))
    });
    let of_folder = is_catalog || is_reading || is_result || name == "campaign.json";
    if of_folder && file.is_file() { folder } else { file.to_path_buf() }
}

/// Whether the statement of a campaign names the file `name` anywhere.
fn is_named(statement: &Value, name: &str) -> bool {
    match statement {
        Value::String(text) => text == name,
        Value::Array(list) => list.iter().any(|value| is_named(value, name)),
        Value::Object(keys) => keys.values().any(|value| is_named(value, name)),
        _ => false,
    }
}

fn read_json(path: &Path) -> Option<Value> {
    serde_json::from_str(&std::fs::read_to_string(path).ok()?).ok()
}

fn look(place: PathBuf, catalogs: &Catalogs) -> Found {
    // if a process was stopped while it wrote a result, the result is completed first, as in every function that reads
    // results
    if place.is_dir()
        && let Err(failure) = complete(&place)
    {
        return Found { place, what: "unknown", outcome: Err(Problem::Unreadable(failure.to_string())) };
    }
    let (what, outcome) =
        if place.is_dir() { look_at_folder(&place, catalogs) } else { look_at_file(&place, catalogs) };
    Found { place, what, outcome }
}

type Look = (&'static str, Result<(), Problem>);

fn look_at_folder(folder: &Path, catalogs: &Catalogs) -> Look {
    let has = |name: &str| folder.join(name).is_file();
    if let Some(manifest) = MANIFESTS.into_iter().find(|name| has(name)) {
        return (result_words(manifest), whole_result(folder, manifest, catalogs));
    }
    if has("campaign.json") {
        return ("campaign", Campaign::read(folder, catalogs).map(drop).map_err(Problem::from));
    }
    if CatalogFile::ALL.iter().any(|file| has(file.file_name())) {
        return ("catalogs", Catalogs::load(Some(folder)).map(drop).map_err(Problem::from));
    }
    // the order matters: an export of an arm file has an arm.json too
    if let Some(name) = ["export.json", "study.json", "arm.json"].into_iter().find(|name| has(name)) {
        let (what, outcome) = look_at_file(&folder.join(name), catalogs);
        return (what, outcome);
    }
    let hint = "give a folder with arm.json, study.json, campaign.json, export.json, run.json or verdict.json, or with catalog \
                files; or single files";
    ("unknown", Err(unknown(folder, "is a folder of nothing that is known", hint)))
}

fn look_at_file(path: &Path, catalogs: &Catalogs) -> Look {
    if path.extension().is_some_and(|end| end == "urdf") {
        return ("robot", check_urdf(path));
    }
    let document = match Document::read(path) {
        Ok(document) => document,
        Err(InputError::Faulty(_))
            if let Some(table) = std::fs::read_to_string(path).ok().and_then(|text| table_of(&text)) =>
        {
            return (table, Ok(()));
        }
        Err(InputError::Faulty(_)) if path.extension().is_some_and(|e| e != "json") => {
            let hint = "tables are checked with the folder of their campaign, catalog or result";
            return ("unknown", Err(unknown(path, "is no JSON file", hint)));
        }
        Err(error) => return ("unknown", Err(error.into())),
    };
    match kind_of(document.root().value()) {
        Some("arm") => ("arm", read_arm_document(document, catalogs).map(drop).map_err(Problem::Faulty)),
        Some("cases") => ("cases", check_cases(document, path, catalogs)),
        Some("study") => ("study", read_study(document, catalogs).map(drop).map_err(Problem::Faulty)),
        Some("stiffness") => ("stiffness of an import", check_stiffness(document, path, catalogs)),
        Some("limits") => ("limits of joints", check_limits(document).map_err(Problem::Faulty)),
        Some(written @ ("choices" | "export" | "import" | "run" | "shard" | "verdict")) => {
            (written, check_written(written, path, &document))
        }
        Some(_) => {
            let hint = "call it campaign.json, in a folder with its arm and its readings";
            ("campaign", Err(unknown(path, "is the statement of a campaign, outside of one", hint)))
        }
        None => {
            let hint = "`armwright schema` lists the kinds of files and `armwright schema KIND` their keys";
            ("unknown", Err(unknown(path, "has no key of a file that is known", hint)))
        }
    }
}

/// Checks that a file that the program wrote has all of its keys.
fn check_written(kind: &str, path: &Path, document: &Document) -> Result<(), Problem> {
    let missing = missing_keys(kind, document.root().value());
    match missing.is_empty() {
        true => Ok(()),
        false => {
            let problem = format!("is {kind}.json without {}", missing.join(", "));
            Err(unknown(path, &problem, "write it anew with the program"))
        }
    }
}

/// Checks a URDF file.
fn check_urdf(path: &Path) -> Result<(), Problem> {
    let text = fs_err::read_to_string(path).map_err(|e| Problem::Unreadable(e.to_string()))?;
    read_urdf(&path.display().to_string(), &text).map(drop).map_err(Problem::Faulty)
}

/// Checks a stiffness file against the `arm.json` in the same folder. If there is none, a joint slides if the file
/// states a stiffness along its travel.
fn check_stiffness(document: Document, path: &Path, catalogs: &Catalogs) -> Result<(), Problem> {
    let near = folder_of(path).join("arm.json");
    let stated: Vec<(String, bool)> = match near.is_file() {
        true => {
            let arm = read_arm(&near, catalogs)?;
            let turning = arm.joints().map(|joint| (joint.name.clone(), false));
            turning.chain(arm.prismatics().map(|joint| (joint.name.clone(), true))).collect()
        }
        false => {
            let joints = document.root().value()["joints"].as_object().cloned().unwrap_or_default();
            let slides = |joint: &Value| joint.get("stiffness_n_per_m").is_some();
            joints.iter().map(|(name, joint)| (name.clone(), slides(joint))).collect()
        }
    };
    let joints: Vec<MovingJoint> =
        stated.iter().map(|(name, slides)| MovingJoint { name, slides: *slides }).collect();
    read_given(document, &joints, catalogs).map(drop).map_err(Problem::Faulty)
}

/// Checks the cases file `document` against the arm file `arm.json` in the same folder. If there is none, the poses are
/// only compared with the first pose: all must have entries for the same joints.
fn check_cases(document: Document, path: &Path, catalogs: &Catalogs) -> Result<(), Problem> {
    let beside = folder_of(path).join("arm.json");
    let arm: Option<Arm> = if beside.is_file() { Some(read_arm(&beside, catalogs)?) } else { None };
    let joints: Vec<DrivenJoint> = match &arm {
        Some(arm) => arm.driven_joints(),
        None => joints_of_first_pose(&document),
    };
    read_load_cases(document, &joints).map(drop).map_err(Problem::Faulty)
}

/// The joints for which the first pose has entries. They are used if there is no arm file that names the joints.
fn joints_of_first_pose(document: &Document) -> Vec<DrivenJoint> {
    let root = document.root();
    let first = &root.value()[0];
    if let Some(entries) = first["pose"].as_object() {
        let joint = |key: &String| {
            let slides = key.strip_suffix("_mm").map(|name| (name, Motion::Slides));
            let (name, motion) = slides.or(key.strip_suffix("_deg").map(|name| (name, Motion::Turns)))?;
            Some(DrivenJoint { name: name.into(), motion })
        };
        return entries.keys().filter_map(joint).collect();
    }
    let angles = first["pose_deg"].as_array().map_or(0, Vec::len);
    (1..=angles).map(|i| DrivenJoint::turning(&format!("joint {i}"))).collect()
}

fn result_words(manifest: &str) -> &'static str {
    match manifest {
        RUN => "result of a study",
        super::manifest::VERDICT => "result of a campaign",
        super::manifest::CHOICES => "result of a study, choice by choice",
        _ => "shard of a search",
    }
}

/// Checks that the files of a result still have the hashes that the file `manifest` lists. Returns the content of this
/// file.
fn unchanged(folder: &Path, manifest: &str) -> Result<Value, Problem> {
    let path = folder.join(manifest);
    if !has_manifest(folder, manifest) {
        return Err(Problem::Incomplete(format!("{manifest} is empty")));
    }
    let text = std::fs::read_to_string(&path).map_err(|e| Problem::Unreadable(e.to_string()))?;
    let value: Value =
        serde_json::from_str(&text).map_err(|e| Problem::Changed(format!("{manifest} is not JSON: {e}")))?;
    let Some(files) = listed(&value) else {
        return Err(Problem::Changed(format!("{manifest} lists no files, as of a version before 0.2")));
    };
    let edited = (!is_as_written(&value)).then(|| format!("{manifest} is not what was written"));
    let wrong: Vec<String> = edited
        .into_iter()
        .chain(files.iter().filter_map(|(name, expected)| match std::fs::read(folder.join(name)) {
            Ok(bytes) if hash(&bytes) == *expected => None,
            Ok(_) => Some(format!("{name} is not what was written")),
            Err(e) => Some(format!("{name}: {e}")),
        }))
        .collect();
    if wrong.is_empty() { Ok(value) } else { Err(Problem::Changed(wrong.join("\n  "))) }
}

/// Checks that the files of a result are those that were written, that its arms can be read, and that nothing is
/// missing in it or in the runs that are folders in it.
fn whole_result(folder: &Path, manifest: &str, catalogs: &Catalogs) -> Result<(), Problem> {
    let written = unchanged(folder, manifest)?;
    whole(&written)?;
    arms_are_sound(folder, &written, catalogs)?;
    let mut folders = vec![folder.to_path_buf(), folder.join("study")];
    folders.retain(|folder| folder.is_dir());
    for outer in folders {
        let inside = std::fs::read_dir(&outer).map_err(|e| Problem::Unreadable(e.to_string()))?;
        let mut runs: Vec<PathBuf> = inside.filter_map(|entry| Some(entry.ok()?.path())).collect();
        runs.sort();
        for run in runs.iter().filter(|run| run.join(RUN).is_file()) {
            whole(&unchanged(run, RUN)?)?;
        }
    }
    Ok(())
}

/// Reads the arms among the files that the manifest `written` lists, as `analyze` reads them.
fn arms_are_sound(folder: &Path, written: &Value, catalogs: &Catalogs) -> Result<(), Problem> {
    let names = listed(written).unwrap_or_default();
    let mut faults = Vec::new();
    for name in names.keys().filter(|name| name.ends_with(".json")) {
        let Ok(document) = Document::read(&folder.join(name)) else { continue };
        if kind_of(document.root().value()) == Some("arm")
            && let Err(Faults(found)) = read_arm_document(document, catalogs)
        {
            faults.extend(found);
        }
    }
    if faults.is_empty() { Ok(()) } else { Err(Problem::Faulty(Faults(faults))) }
}

/// Checks that nothing is missing in the result of a study whose `run.json` is `written`.
fn whole(written: &Value) -> Result<(), Problem> {
    let missing = written["not_written"].as_array().into_iter().flatten();
    let missing: Vec<&str> = missing.filter_map(Value::as_str).collect();
    match missing.is_empty() {
        true => Ok(()),
        false => Err(Problem::Incomplete(format!("not written: {}", missing.join("\n  not written: ")))),
    }
}

fn unknown(path: &Path, problem: &str, hint: &str) -> Problem {
    Problem::Faulty(Faults(vec![Fault {
        file: path.display().to_string(),
        line: None,
        field: String::new(),
        problem: problem.into(),
        hint: hint.into(),
    }]))
}

impl From<InputError> for Problem {
    fn from(error: InputError) -> Self {
        match Failure::from(error) {
            Failure::Input(faults) => Problem::Faulty(faults),
            unreadable => Problem::Unreadable(unreadable.to_string()),
        }
    }
}

impl Found {
    fn to_text(&self) -> String {
        let head = format!("{}: {}", self.place.display(), self.what);
        match &self.outcome {
            Ok(()) => format!("{head}, sound\n"),
            Err(Problem::Faulty(Faults(faults))) => {
                let count =
                    if faults.len() == 1 { "1 fault".into() } else { format!("{} faults", faults.len()) };
                let lines: String = faults.iter().map(|fault| format!("  {fault}\n")).collect();
                format!("{head}, {count}\n{lines}")
            }
            Err(Problem::Changed(what)) => format!("{head}, changed\n  {what}\n"),
            Err(Problem::Incomplete(what)) => {
                format!("{head}, incomplete\n  {what}\n  the command that made it makes the rest\n")
            }
            Err(Problem::Unreadable(why)) => format!("{head}, cannot be read\n  {why}\n"),
        }
    }

    fn to_json(&self) -> Value {
        let fault = |f: &Fault| json!({"file": f.file, "line": f.line, "field": f.field, "problem": f.problem, "hint": f.hint});
        let (state, faults) = match &self.outcome {
            Ok(()) => ("sound", Vec::new()),
            Err(Problem::Faulty(Faults(faults))) => ("faulty", faults.iter().map(fault).collect()),
            Err(Problem::Changed(what)) => ("changed", vec![json!({"problem": what})]),
            Err(Problem::Incomplete(what)) => ("incomplete", vec![json!({"problem": what})]),
            Err(Problem::Unreadable(why)) => ("unreadable", vec![json!({"problem": why})]),
        };
        json!({"path": self.place.display().to_string(), "kind": self.what, "state": state, "faults": faults})
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A result of a campaign whose corrected arm has play that closes over the torque `torque_nm`.
    fn result_with(torque_nm: f64) -> tempfile::TempDir {
        let folder = tempfile::tempdir().expect("temporary folder");
        let arm = json!({
            "chain": [{"type": "joint", "name": "j1", "axis": [0, 1, 0], "stiffness_nm_per_rad": 50},
                      {"type": "link", "name": "l1", "vector_m": [0.3, 0, 0], "mass_kg": 0.2}],
            "effects": [{"effect": "lost_motion", "at": "j1",
                         "parameters": {"half_width_rad": 0.01, "torque_nm": torque_nm}}],
        });
        let arm = arm.to_string();
        std::fs::write(folder.path().join("arm.corrected.json"), &arm).expect("written");
        let verdict = json!({"files": {"arm.corrected.json": hash(arm.as_bytes())}});
        std::fs::write(folder.path().join("verdict.json"), verdict.to_string()).expect("written");
        folder
    }

    #[test]
    fn a_corrected_arm_is_read_as_analyze_reads_it() {
        let check = |torque_nm: f64| {
            let folder = result_with(torque_nm);
            let file = unit_of(&folder.path().join("arm.corrected.json"));
            look(file, &Catalogs::default()).to_text()
        };
        assert!(check(-1.0).contains("effects[0].parameters.torque_nm"), "{}", check(-1.0));
        assert!(check(0.0107).contains("sound"), "a small arm: {}", check(0.0107));
    }

    #[test]
    fn a_record_is_checked_with_its_campaign() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("written");
        write("campaign.json", r#"{"records": [{"file": "axis2.csv"}]}"#);
        for name in ["record.csv", "axis2.csv", "notes.csv"] {
            write(name, "t_s,j1_motor_deg\n");
            let unit = unit_of(&folder.path().join(name));
            assert_eq!(unit == folder.path(), name != "notes.csv", "{name}");
        }
    }
}
