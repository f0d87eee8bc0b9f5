//! `armwright capacity`: finds the largest payload and speed of a study's arm, or the largest payload of an arm file.

use super::failure::Failure;
use crate::arm::file::read_arm;
use crate::catalog::Catalogs;
use crate::input::json::Document;
use crate::report::number::{fixed, significant};
use crate::report::whole_file::folder_of;
use crate::report::words::{TERMINAL, wrap};
use crate::study::arm_capacity::{capacity_of_arm, is_arm_file};
use crate::study::capacity::{AtPose, Capacity, capacity_of};
use crate::study::largest_speed::{LargestSpeed, OwnSpeed};
use crate::study::load::load_study;
use crate::study::window::{Limit, Window};
use clap::Args;
use serde_json::json;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Finds the largest payload that an arm holds with the drives it has, in every sizing pose and in all of them
/// together, and the largest speed with the payload of its study. Names the joint and the check that limit them.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: armwright capacity light-arm\n         armwright capacity my-study.json --design 2f --json\n         \
                        armwright capacity ur5e/arm.json --cases poses.json\n\n\
                        The drives are those of the design at the study's own payload; the payload keeps its centre and moments. Poses that \
                        state a payload of their own keep it. The largest speed is that of the tip with the study's payload, if the speed of some joint follows from it; joints are faster by \
                        the same factor, and the times of the cycle are those of the study. \
                        An arm with springs or counterweights may need a smallest payload, which is then named too.\n\n\
                        An arm file states no motion. Therefore only static torques are checked, and forces of prismatic joints. \
                        The limits come from --limits, else from import.json in its folder, else from the catalog's gears and motors. \
                        Output bearings and guides are judged at rest by their ratings, links by the strength of their material.\n\n\
                        The reach is the distance of the tip from the base: across gravity for an arm that stands or hangs (gravity along \
                        its z axis), the whole distance for any other, such as an arm on a wall."
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
    /// Largest torques of the joints of an arm file (JSON): {"joints": [{"name": "j1", "max_torque_nm": 87}]}; a
    /// prismatic joint has max_force_n
    #[arg(long, value_name = "FILE", conflicts_with = "design")]
    limits: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Runs `armwright capacity` and returns the text to print.
pub(super) fn run(args: &CapacityArgs, catalogs: &Catalogs) -> Result<String, Failure> {
    if is_arm(&args.study) {
        return of_arm(args, catalogs);
    }
    // read before the flags are judged: a file that cannot be parsed is neither a study nor an arm file
    let (study, _) = load_study(&args.study, catalogs)?;
    if args.cases.is_some() || args.limits.is_some() {
        let words = "--cases and --limits are for arm files; a study has its own poses and drives";
        return Err(Failure::Usage(words.into()));
    }
    let name = match &args.design {
        Some(id) => format!("{}, design {id},", study.name),
        None => study.name.clone(),
    };
    Ok(said(args, &name, &capacity_of(&study, args.design.as_deref(), catalogs)?, &study.remarks))
}

/// The capacity as text or JSON, with the remarks that a reader should know.
fn said(args: &CapacityArgs, name: &str, found: &Capacity, remarks: &[String]) -> String {
    let remarks: Vec<&String> = found.remarks.iter().chain(remarks).collect();
    if args.json {
        let mut json = found.to_json();
        json["remarks"] = json!(remarks);
        return serde_json::to_string_pretty(&json).expect("numbers and strings serialize");
    }
    let lines: String = remarks.iter().map(|words| wrap(words, TERMINAL, "")).collect();
    let above = if lines.is_empty() { "" } else { "\n" };
    format!("{}{above}{lines}", to_text(name, found))
}

/// Whether the file at `path` is an arm file.
fn is_arm(path: &str) -> bool {
    Document::read(Path::new(path)).is_ok_and(|document| is_arm_file(&document))
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
    let beside = folder_of(path).join("import.json");
    let limits = args.limits.as_deref().or(beside.is_file().then_some(&beside));
    let [cases, limits] = [args.cases.as_deref(), limits].map(|file| file.map(Document::read).transpose());
    Ok(said(args, &arm.name, &capacity_of_arm(&arm, cases?, limits?, catalogs)?, &[]))
}

/// The payload at the upper end of `window`, the range of payloads that an arm holds, as text: kilograms, "no limit",
/// or "none" if the arm holds no payload.
fn kilograms(window: &Window) -> String {
    match (window.holds(), window.most.payload_kg) {
        (false, _) => "none".into(),
        (true, most_kg) if most_kg.is_finite() => fixed(most_kg, 3),
        _ => "no limit".into(),
    }
}

/// The joint or link that fails beyond a limit, and the check that it fails, in words.
fn failing(limit: &Limit) -> String {
    format!("{} (check: {})", limit.piece, limit.check)
}

/// The first sentence: which payloads the arm holds in all poses, and what fails beyond them.
fn headline(name: &str, found: &Capacity) -> String {
    if found.window.holds() { held(name, found) } else { nothing_held(name, found) }
}

/// The words ", first in the pose NAME" for the end of a sentence. Empty if no pose is named.
fn first_in(pose: &str) -> String {
    if pose.is_empty() { String::new() } else { format!(", first in the pose {pose}") }
}

/// The words on payloads below the smallest one that the arm holds in all poses: "less than 2.000 kg is too little for
/// j2 (...), first in the pose down".
fn too_little(found: &Capacity) -> String {
    let least = &found.window.least;
    let (least_kg, joint) = (fixed(least.payload_kg, 3), failing(least));
    format!("less than {least_kg} kg is too little for {joint}{}", first_in(&found.least_pose))
}

/// The sentence for an arm that holds no payload in all poses: what is too much for one joint is too little for
/// another.
fn nothing_held(name: &str, found: &Capacity) -> String {
    let Window { least, most } = &found.window;
    let words = if least.payload_kg.is_finite() {
        let (most_kg, joint) = (fixed(most.payload_kg, 3), failing(most));
        format!(
            "{}; more than {most_kg} kg is too much for {joint}{}",
            too_little(found),
            first_in(&found.pose)
        )
    } else {
        format!(
            "without payload {} fails{}, and no payload helps",
            failing(least),
            first_in(&found.least_pose)
        )
    };
    format!("{name} holds no payload in all of its poses: {words}\n")
}

/// The sentence on the range of payloads that the arm holds in all poses, and on what fails at its ends.
fn held(name: &str, found: &Capacity) -> String {
    let Window { least, most } = &found.window;
    let too_much = format!("more is too much for {}{}", failing(most), first_in(&found.pose));
    let (least_kg, most_kg) = (fixed(least.payload_kg, 3), fixed(most.payload_kg, 3));
    let range = match (least.payload_kg > 0.0, most.payload_kg.is_finite()) {
        (false, false) => return format!("{name}: nothing limits the payload\n"),
        (false, true) => return format!("{name} holds {most_kg} kg in all of its poses; {too_much}\n"),
        (true, true) => format!("from {least_kg} to {most_kg} kg in all of its poses; {too_much}"),
        (true, false) => format!("{least_kg} kg and any larger payload in all of its poses"),
    };
    format!("{name} holds {range}\nIt does not hold the empty arm: {}\n", too_little(found))
}

fn to_text(name: &str, found: &Capacity) -> String {
    let mut out = headline(name, found);
    let ends = found.table.iter().map(|at| {
        let limit = if at.window.holds() { &at.window.most } else { &at.window.least };
        End { pose: at, kg: kilograms(&at.window), limit }
    });
    out.push_str(&table("payload kg", "ends at", &ends.collect::<Vec<_>>()));
    let needy = found.table.iter().filter(|at| at.window.least.payload_kg > 0.0).map(|at| {
        let least = &at.window.least;
        let least_kg = if at.window.holds() { fixed(least.payload_kg, 3) } else { "none".into() };
        End { pose: at, kg: least_kg, limit: least }
    });
    let needy: Vec<_> = needy.collect();
    if !needy.is_empty() {
        out.push_str(&table("least kg", "begins at", &needy));
    }
    out.extend(found.largest_speed.as_ref().map(fastest));
    out
}

/// The sentence on the largest speed with the payload of the study.
fn fastest(speed: &LargestSpeed) -> String {
    let own = |own: &OwnSpeed| {
        let unit = if own.slides { "m/s" } else { "rad/s" };
        format!("{} at {} {unit}", own.joint, significant(own.speed, 4))
    };
    let own: Vec<String> = speed.own_speeds.iter().map(own).collect();
    let own = own.join(", ");
    let factor = significant(speed.factor, 4);
    let how_fast = match speed.tip_speed_m_s {
        Some(tip_m_s) => {
            let own =
                if own.is_empty() { own } else { format!(" (and joints with a speed of their own: {own})") };
            format!(
                "the tip may move at {} m/s{own}, {factor} times what the study asks",
                significant(tip_m_s, 4)
            )
        }
        None => format!("joints may move {factor} times as fast as the study asks ({own})"),
    };
    let words = format!(
        "With the payload of the study {how_fast}, in ramps of the same duration; more is too fast for {} (check: {}).",
        speed.joint, speed.check
    );
    format!("\n{}", wrap(&words, TERMINAL, ""))
}

/// One end of the window of payloads in a pose.
struct End<'a> {
    pose: &'a AtPose,
    /// The payload at this end, in words.
    kg: String,
    /// The joint or link that fails beyond this end, and the check that it fails.
    limit: &'a Limit,
}

/// A table with one row for each pose: reach, payload at one end of the range that the arm holds, and what fails beyond
/// this end. `payload` and `end` are the headers of the payload and of the piece that fails.
fn table(payload: &str, end: &str, rows: &[End]) -> String {
    let widest = |head: &str, of: fn(&Limit) -> &str| {
        let widths = rows.iter().map(|row| of(row.limit).chars().count());
        widths.max().unwrap_or_default().max(head.len())
    };
    let (at, what) = (widest(end, |limit| &limit.piece), widest("check", |limit| &limit.check));
    let mut out = format!("\n{:>8}  {payload:>10}  {end:<at$}  {:<what$}  pose\n", "reach m", "check");
    for End { pose, kg, limit } in rows {
        let reach = fixed(pose.reach_m, 3);
        let _ = writeln!(
            out,
            "{reach:>8}  {kg:>10}  {:<at$}  {:<what$}  {}",
            limit.piece, limit.check, pose.pose
        );
    }
    out
}
