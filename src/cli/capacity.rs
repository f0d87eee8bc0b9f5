//! `armwright capacity`: finds the largest payload of a study's arm or of an arm file.

use super::failure::Failure;
use crate::arm::file::read_arm;
use crate::arm::load::read_load_cases;
use crate::catalog::Catalogs;
use crate::input::json::Document;
use crate::report::number::fixed;
use crate::report::whole_file::folder_of;
use crate::report::words::{TERMINAL, wrap};
use crate::study::arm_capacity::{arm_capacity, has_rated_bearings, limits_of_parts, read_limits};
use crate::study::capacity::{Capacity, Limit, capacity_of};
use crate::study::load::load_study;
use clap::Args;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Finds the largest payload that an arm holds with the drives it has, in every sizing pose and in all of them
/// together, and names the joint and the check that limit it.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: armwright capacity light-arm\n         armwright capacity my-study.json --design 2f --json\n         \
                        armwright capacity ur5e/arm.json --cases poses.json\n\n\
                        The drives are those of the design at the study's own payload; the payload keeps its centre and moments. Of an arm \
                        file, which says nothing of motion, the static torques are judged: by the limits of --limits, or of import.json beside \
                        it, or by the catalog's gears and motors that it names. Output bearings are judged at rest by their ratings."
)]
pub(crate) struct CapacityArgs {
    /// A built-in study, a study file or an arm file
    study: String,
    /// Take the links and drives of this design_id; without it, links of median mass and the lightest drives
    #[arg(long, value_name = "ID")]
    design: Option<String>,
    /// Poses of an arm file, as analyze reads them; without it all angles are zero
    #[arg(long, value_name = "FILE", conflicts_with = "design")]
    cases: Option<PathBuf>,
    /// Largest torques of the joints of an arm file (JSON): {"joints": [{"name": "j1", "max_torque_nm": 87}]}
    #[arg(long, value_name = "FILE", conflicts_with = "design")]
    limits: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Runs `armwright capacity` and returns the text to print.
pub(super) fn run(args: &CapacityArgs, catalogs: &Catalogs) -> Result<String, Failure> {
    if is_arm_file(&args.study) {
        return of_arm(args, catalogs);
    }
    if args.cases.is_some() || args.limits.is_some() {
        let words = "--cases and --limits are for arm files; a study has its own poses and drives";
        return Err(Failure::Usage(words.into()));
    }
    let (study, _) = load_study(&args.study, catalogs)?;
    Ok(said(args, &study.name, &capacity_of(&study, args.design.as_deref(), catalogs)?, &study.remarks))
}

/// The capacity as text or JSON, with the remarks that a reader should know.
fn said(args: &CapacityArgs, name: &str, found: &Capacity, remarks: &[String]) -> String {
    if args.json {
        let mut json = found.to_json();
        json["remarks"] = json!(remarks);
        return serde_json::to_string_pretty(&json).expect("numbers and strings serialize");
    }
    let lines: String = remarks.iter().map(|words| wrap(words, TERMINAL, "")).collect();
    let above = if lines.is_empty() { "" } else { "\n" };
    format!("{}{above}{lines}", to_text(name, found))
}

/// The remark on the capacity of an arm file that says what is checked and what is not.
const AT_REST: &str = "Judged are torques and output bearings at rest, as far as their ratings are known. Motion, heat and strength are not checked.";

/// Whether the file at `path` is an arm file. It then has a chain and, in contrast to a study file, no poses.
fn is_arm_file(path: &str) -> bool {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let file: Value = serde_json::from_str(&text).unwrap_or_default();
    file["chain"].is_array() && file["poses"].is_null()
}

/// The largest payload of an arm file at rest. The torques of the joints are compared with the limits that the user
/// gives. If the user gives none, the limits are those of an import.json in the same folder. If this file is missing
/// too, they are those of the gears and motors that the arm file names.
fn of_arm(args: &CapacityArgs, catalogs: &Catalogs) -> Result<String, Failure> {
    if args.design.is_some() {
        return Err(Failure::Usage(format!("{} is an arm file; --design is for studies", args.study)));
    }
    let path = Path::new(&args.study);
    let arm = read_arm(path, catalogs)?;
    let joints = arm.driven_joint_names();
    let cases = match &args.cases {
        Some(file) => read_load_cases(Document::read(file)?, &arm.driven_joints())?,
        None => {
            let zero = json!([{"name": "every joint at zero", "pose": {}}]).to_string();
            read_load_cases(Document::parse("zero", &zero)?, &arm.driven_joints())?
        }
    };
    let beside = folder_of(path).join("import.json");
    let limits = match &args.limits {
        Some(file) => read_limits(Document::read(file)?)?,
        None if beside.is_file() => read_limits(Document::read(&beside)?)?,
        None => limits_of_parts(&arm, catalogs),
    };
    if limits.is_empty() && !has_rated_bearings(&arm) {
        return Err(Failure::Usage(format!(
            "nothing is known of the torques that the joints of {} may bear: give --limits FILE with {{\"joints\": [{{\"name\": \"{}\", \
             \"max_torque_nm\": 87}}]}}, or name gears and motors of the catalogs in the arm file",
            args.study,
            joints.first().copied().unwrap_or("j1")
        )));
    }
    Ok(said(args, &arm.name, &arm_capacity(&arm, &cases, &limits), &[AT_REST.to_string()]))
}

fn kilograms(limit: &Limit) -> String {
    if limit.payload_kg.is_finite() { fixed(limit.payload_kg, 3) } else { "no limit".into() }
}

fn to_text(name: &str, found: &Capacity) -> String {
    let mut out = match found.limit.payload_kg.is_finite() {
        true => format!(
            "{name} holds {} kg in all of its poses; more is too much for {} (check: {}), first in the pose {}\n",
            kilograms(&found.limit),
            found.limit.piece,
            found.limit.check,
            found.pose
        ),
        false => format!("{name}: nothing limits the payload\n"),
    };
    let _ =
        writeln!(out, "\n{:>8}  {:>10}  {:<14}  {:<22}  pose", "reach m", "payload kg", "ends at", "check");
    for at in &found.table {
        let _ = writeln!(
            out,
            "{:>8}  {:>10}  {:<14}  {:<22}  {}",
            fixed(at.reach_m, 3),
            kilograms(&at.limit),
            at.limit.piece,
            at.limit.check,
            at.pose
        );
    }
    out
}
