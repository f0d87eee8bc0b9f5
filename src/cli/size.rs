//! `armwright size`: sizes the drive of every joint from the tip inward, and says why other drives were
//! rejected.

use super::failure::Failure;
use super::log::Log;
use super::own_files::write_own;
use super::wrong_kind::study_of;
use crate::catalog::Catalogs;
use crate::report::tube::section_size;
use crate::report::words::{TERMINAL, wrap};
use crate::sizing::bearing::{BearingDemand, BearingLoad};
use crate::sizing::demand::JointDemand;
use crate::sizing::fit::LinkRoom;
use crate::sizing::select::DriveTable;
use crate::sizing::sheet::render_rows;
use crate::space::design_space::SpacePiece;
use crate::space::problem::ArmProblem;
use crate::study::chosen::{Sizing, chosen_design, sizing_in, why_not_held};
use crate::study::definition::Study;
use clap::Args;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Sizes every joint of a study's arm from the tip inward: torques (Eqs 7-12), speed, the chosen gear and
/// motor, the binding check, margin, life, and the mass that the next joint inward carries.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: armwright size light-arm\n         armwright size compare-materials --explain j2\n\n\
                        Open links take the section of median mass unless --design names one."
)]
pub(crate) struct SizeArgs {
    /// A built-in study or a study file
    study: String,
    /// Take the links (and chosen drives) of this design_id
    #[arg(long, value_name = "ID")]
    design: Option<String>,
    /// Say for every part why it was rejected for this joint
    #[arg(long, value_name = "JOINT")]
    explain: Option<String>,
    /// List every drive that is strong enough for this joint, lightest first
    #[arg(long, value_name = "JOINT")]
    all_fits: Option<String>,
    /// Folder for sizing.json and sizing.txt
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print JSON; what is left out of the numbers is said on standard error
    #[arg(long)]
    json: bool,
}

/// Runs `armwright size` and returns the text to print.
pub(super) fn run(args: &SizeArgs, catalogs: &Catalogs, log: Log) -> Result<String, Failure> {
    let (study, _) = study_of(&args.study, catalogs)?;
    let (space, chosen) = chosen_design(&study, args.design.as_deref(), catalogs)?;
    let problem = ArmProblem::new(&space, catalogs);
    let paragraphs = |remarks: &[String]| -> String {
        let lines: String = remarks.iter().map(|words| wrap(words, TERMINAL, "")).collect();
        if lines.is_empty() { lines } else { format!("\n{lines}") }
    };
    let remarks = paragraphs(&study.remarks);
    if let Some(joint) = &args.explain {
        let (table, demand) = at_joint(&problem, &chosen, joint, catalogs)?;
        return Ok(explain(joint, table, &demand) + &remarks);
    }
    if let Some(joint) = &args.all_fits {
        let (table, demand) = at_joint(&problem, &chosen, joint, catalogs)?;
        return Ok(all_fits(joint, table, &demand) + &remarks);
    }
    let Sizing { rows, remarks: said } = sizing_in(&study, &problem, &chosen, catalogs)?;
    let remarks = paragraphs(&said);
    let text = format!(
        "{}{}{remarks}",
        heading(&study, &problem, &chosen, args.design.is_none()),
        render_rows(&rows)
    );
    let json = serde_json::to_string_pretty(&rows).expect("rows of numbers and strings serialize");
    if let Some(dir) = &args.out {
        let files = [("sizing.json", &json), ("sizing.txt", &text)];
        write_own(
            dir,
            &files.map(|(name, text)| (name.to_string(), text.as_bytes().to_vec())),
            &[Path::new(&args.study)],
        )?;
    }
    if args.json {
        // the JSON list of the joints has no place for these remarks, so they are printed on standard error
        said.iter().for_each(|words| log.note(&wrap(words, TERMINAL, "")));
        return Ok(json);
    }
    Ok(text)
}

/// The first lines of the table: the motion that is asked for, and the sections of the open links. `is_trial` is true
/// if no design is named. The sections are then those of median mass, and the lines say so.
fn heading(study: &Study, problem: &ArmProblem, chosen: &[u32], is_trial: bool) -> String {
    let trial = if is_trial { " (trial: median mass of its options)" } else { "" };
    let motion = &study.space.motion;
    let mut out = format!(
        "{}: tip {} m/s in {} s, life {} h, sized over {} cases\n",
        study.name,
        motion.tip_speed_m_s,
        motion.ramp_time_s,
        motion.life_h,
        study.space.sizing_cases.len()
    );
    let Some(parts) = problem.parts(chosen) else { return out };
    for (piece, part) in study.space.pieces.iter().zip(parts) {
        if let (SpacePiece::Choice(choice), crate::space::design::Part::Link(option)) = (piece, part) {
            let size = section_size(&option.section);
            let _ = writeln!(out, "link {}: {}, {size}{trial}", choice.name, option.material_name);
        }
    }
    out
}

/// The drives from which the joint named `joint` chooses, and what the design with the options `chosen` demands of them. The
/// design is built from the tip as far as this joint.
///
/// # Errors
/// The study has no such joint, the arm outboard of it breaks a limit, or its drive is given.
fn at_joint<'p, 'c>(
    problem: &'p ArmProblem<'c>,
    chosen: &[u32],
    joint: &str,
    catalogs: &Catalogs,
) -> Result<(&'p DriveTable<'c>, JointDemand), Failure> {
    let is_joint = |p: &&SpacePiece| matches!(p, SpacePiece::Joint(_) | SpacePiece::Prismatic(_));
    let pieces = &problem.space().pieces;
    let unknown = || {
        let names: Vec<&str> = pieces.iter().filter(is_joint).map(SpacePiece::name).collect();
        Failure::Usage(format!("the study has no joint \"{joint}\"; its joints are: {}", names.join(", ")))
    };
    let given = || Failure::Usage(format!("joint {joint} has a given drive: there is nothing to choose"));
    let piece = pieces.iter().position(|p| is_joint(&p) && p.name() == joint).ok_or_else(unknown)?;
    let mut found = None;
    let walked = problem.walk(chosen, |slot, outboard| {
        if problem.piece_of_slot(slot) == piece {
            found = Some((slot, outboard.clone()));
        }
    });
    let (slot, outboard) = match (found, walked) {
        (Some(found), _) => found,
        (None, Err(slot)) => return Err(why_not_held(problem, chosen, slot, catalogs).into()),
        (None, Ok(_)) => return Err(Failure::Internal(format!("joint \"{joint}\" was not met on the way"))),
    };
    let sized = problem.sized_joint(piece).ok_or_else(given)?;
    Ok((&sized.table, problem.demand_at(&outboard, slot)))
}

fn explain(joint: &str, table: &DriveTable, demand: &JointDemand) -> String {
    let mut out = format!("{}\n{}", demand_line(joint, demand, table), bearing_line(joint, &demand.bearing));
    for rejection in table.explain(demand) {
        let _ = writeln!(out, "{rejection}");
    }
    for words in table.explain_bearings(demand) {
        let _ = writeln!(out, "{words}");
    }
    out
}

/// Heading of the column with the mass of the joint with each drive. It includes the extras, because they depend on the
/// drive.
const MASS: &str = "mass kg (with extras)";

fn all_fits(joint: &str, table: &DriveTable, demand: &JointDemand) -> String {
    let mut out = format!("{}\n", demand_line(joint, demand, table));
    let slides = table.gears().iter().any(|gear| gear.kind.slides());
    let stiffness = if slides { "N/m" } else { "K2 Nm/rad" };
    // a gear of which only K1 is known has a straight torsion curve, and its K1 is marked as such
    let straight = if slides { "" } else { "K1 " };
    let _ = writeln!(out, "{MASS:>21}  {stiffness:>14}  drive");
    for index in table.all_fits(demand) {
        let drive = table.drive(index);
        let k2 = match (drive.gear.k2_nm_per_rad, drive.gear.single_slope_nm_per_rad()) {
            (Some(k2), _) => format!("{k2:.0}"),
            (None, Some(k1)) => format!("{straight}{k1:.0}"),
            (None, None) => "unknown".into(),
        };
        let _ = writeln!(out, "{:>21.3}  {k2:>14}  {}", table.mass_kg(index), drive.name());
    }
    out
}

fn demand_line(joint: &str, demand: &JointDemand, table: &DriveTable) -> String {
    let slides = table.gears().iter().any(|gear| gear.kind.slides());
    let (unit, speed_unit) = if slides { ("N", "m/s") } else { ("N m", "rad/s") };
    format!(
        "joint {joint}: static {:.1} {unit}, linear {:.1} {unit}, peak {:.1} {unit}, stop {:.1} {unit}, mean {:.1} {unit}, \
         {:.2} {speed_unit}; {} drives are fast enough{}, {} hold{}",
        demand.static_torque_nm,
        demand.linear_torque_nm,
        demand.peak_torque_nm(),
        demand.stop_torque_nm,
        demand.mean_torque_nm(),
        table.motion().speed_rad_s,
        table.len(),
        if table.motion().fit.is_asked() { " and go into the joint" } else { "" },
        table.all_fits(demand).count(),
        room_words(&demand.room)
    )
}

/// The space that the link leaves for gear and motor, in words; empty if the study does not limit their sizes.
fn room_words(room: &LinkRoom) -> String {
    let part = |part: &str, m: f64| match m.is_finite() {
        true => format!("; the link leaves {:.1} mm to the {part}", m * 1e3),
        false => String::new(),
    };
    let round = room.motor_m == room.square_m;
    let motors = match round {
        true => part("motor", room.motor_m),
        false => part("motor", room.motor_m) + &part("side of a square motor", room.square_m),
    };
    part("gear", room.gear_m) + &motors
}

/// A line with the loads on the output bearing of a joint: at rest, in a ramp and in a stop. Empty if there are none.
fn bearing_line(joint: &str, demand: &BearingDemand) -> String {
    if demand.is_zero() {
        return String::new();
    }
    let words = |load: &BearingLoad| {
        let [moment_nm, radial_n, axial_n] = [load.moment_nm, load.radial_n, load.axial_n];
        format!("{moment_nm:.1} N m, {radial_n:.0} N across and {axial_n:.0} N along the axis")
    };
    format!(
        "joint {joint}, output bearing: at rest {}; in a ramp {}; in a stop {}\n",
        words(&demand.at_rest),
        words(&demand.running),
        words(&demand.in_stop)
    )
}
