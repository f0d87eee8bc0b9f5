//! `armwright capacity`: the largest payload of a study's arm.

use super::failure::Failure;
use crate::catalog::Catalogs;
use crate::report::number::fixed;
use crate::study::capacity::{Capacity, Limit, capacity_of};
use crate::study::load::load_study;
use clap::Args;
use serde_json::Value;
use std::fmt::Write;

/// Finds the largest payload that an arm holds with the drives it has, in every sizing pose and in all of them together, and
/// says which joint and which check ends it.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: armwright capacity light-arm\n         armwright capacity my-study.json --design 2f --json\n\n\
                        The drives are those of the design at the study's own payload; the payload keeps its centre and moments."
)]
pub(crate) struct CapacityArgs {
    /// A built-in study or a study file
    study: String,
    /// Take the links and drives of this design_id; without it, links of median mass and the lightest drives
    #[arg(long, value_name = "ID")]
    design: Option<String>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Executes the verb.
pub(super) fn run(args: &CapacityArgs, catalogs: &Catalogs) -> Result<String, Failure> {
    let loaded = load_study(&args.study, catalogs).map_err(Failure::from);
    let (study, _) = loaded.map_err(|failure| of_arm_file(args, failure))?;
    let found = capacity_of(&study, args.design.as_deref(), catalogs)?;
    Ok(match args.json {
        true => serde_json::to_string_pretty(&found.to_json()).expect("numbers and strings serialize"),
        false => to_text(&study.name, &found),
    })
}

/// What is said if the file is an arm and no study: it has neither a motion nor poses.
fn of_arm_file(args: &CapacityArgs, failure: Failure) -> Failure {
    let text = fs_err::read_to_string(&args.study).unwrap_or_default();
    let file: Value = serde_json::from_str(&text).unwrap_or_default();
    match file["chain"].is_array() && file["poses"].is_null() {
        true => Failure::Usage(format!(
            "{} is an arm file, which says nothing of motion, duty and poses; give the study that it comes from, with --design ID",
            args.study
        )),
        false => failure,
    }
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
        false => format!("{name}: no drive of the study limits the payload\n"),
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
