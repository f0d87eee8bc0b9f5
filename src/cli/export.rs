//! `armwright export`: writes an arm or a design as files for other programs.

use super::design::resolve_design;
use super::failure::Failure;
use super::own_files::write_own;
use super::pose_flags::PoseArgs;
use super::values::{choice, non_negative, numbers};
use super::wrong_kind::refuse_other_kind;
use crate::arm::file::read_arm;
use crate::arm::load::{LoadCase, Payload, read_load_cases};
use crate::arm::{Arm, JointModel, LinkModel};
use crate::catalog::Catalogs;
use crate::input::json::Document;
use crate::interchange::export::Format;
use crate::interchange::request::{ExportRequest, Exported, MOST_PIECES};
use crate::report::number::percent;
use clap::Args;
use nalgebra::Vector3;
use std::path::{Path, PathBuf};

/// Writes an arm, or a design of a result, for another program: CalculiX (finite elements), MuJoCo (MJCF), URDF, or as
/// JSON, CSV or a bill of materials.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: armwright export results/light-arm#x3k9 --to calculix --out fe && cd fe && ccx static && ccx modes\n         \
                        armwright export arm.json --pose-deg 0,-30,60 --payload-kg 5 --to mjcf --out sim\n         \
                        armwright export results/light-arm#x3k9 --to bom --out purchase\n\n\
                        export.json says what the files leave out, with its share of the tip's deflection, and what the other program must \
                        find. Torsion curves become numbers at the loads of one case: of a design the case that deflects most, unless \
                        --case names another."
)]
pub(crate) struct ExportArgs {
    /// Arm file, or a result folder and a design_id from its front.csv with # between them
    #[arg(value_name = "ARM|RESULTS#ID")]
    source: String,
    /// Form: calculix, mjcf, urdf, json, csv or bom
    #[arg(long, value_name = "FORM", value_parser = choice::<Format>(), hide_possible_values = true)]
    to: Format,
    /// Folder for the files
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Cases of an arm file (JSON), as analyze reads them
    #[arg(long, value_name = "FILE", conflicts_with_all = ["pose_deg", "pose", "payload_kg", "payload_cg_m"])]
    cases: Option<PathBuf>,
    /// Name of the case
    #[arg(long, value_name = "NAME")]
    case: Option<String>,
    #[command(flatten)]
    pose: PoseArgs,
    /// Payload of an arm file [kg]
    #[arg(long, default_value_t = 0.0, allow_hyphen_values = true, value_parser = non_negative)]
    payload_kg: f64,
    /// Payload centre of gravity from the tip, last frame [m]
    #[arg(long, value_name = "X,Y,Z", default_value = "0,0,0", allow_hyphen_values = true, value_parser = numbers::<3>)]
    payload_cg_m: [f64; 3],
    /// Cut every flexible link into N parts with springs between them (mjcf); without it links are rigid
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=i64::from(MOST_PIECES)))]
    flexible: Option<u16>,
    /// Give joints the backlash of their gears as a deadband (mjcf)
    #[arg(long)]
    backlash: bool,
}

/// Runs `armwright export`: writes the files, and returns the text to print.
pub(super) fn run(args: &ExportArgs, catalogs: &Catalogs) -> Result<String, Failure> {
    let Source { arm, cases, inputs } = source(args, catalogs)?;
    let request = ExportRequest {
        arm: &arm,
        cases: &cases,
        case: args.case.as_deref(),
        format: args.to,
        pieces_per_link: args.flexible,
        backlash: args.backlash,
    };
    let exported = request.answer(catalogs).map_err(Failure::Usage)?;
    let inputs: Vec<&Path> = inputs.iter().map(PathBuf::as_path).collect();
    write_own(&args.out, &exported.files, &inputs)?;
    let names: Vec<&str> = exported.files.iter().map(|(name, _)| name.as_str()).collect();
    Ok(format!(
        "{}, case \"{}\"\n{}written to {}: {}\n",
        arm.name,
        exported.case,
        said(&exported),
        args.out.display(),
        names.join(", ")
    ))
}

/// The text about an export: what the files leave out, each with its part of the tip deflection, and the notes.
fn said(exported: &Exported) -> String {
    let left_out = exported.left_out.iter().map(|left| {
        format!(
            "  left out: {} at {} ({} of the deflection): {}\n",
            left.what,
            left.at,
            percent(100.0 * left.tip_share, 2),
            left.why
        )
    });
    let notes = exported.notes.iter().map(|note| format!("  {note}\n"));
    left_out.chain(notes).collect()
}

/// The arm that is exported, and its load cases.
struct Source {
    arm: Arm,
    cases: Vec<LoadCase>,
    /// The files from which arm and cases were read.
    inputs: Vec<PathBuf>,
}

fn source(args: &ExportArgs, catalogs: &Catalogs) -> Result<Source, Failure> {
    let path = PathBuf::from(&args.source);
    if let (false, Some((folder, id))) = (path.is_file(), args.source.rsplit_once('#')) {
        if args.cases.is_some() || args.pose.is_given() || args.payload_kg != 0.0 {
            return Err(Failure::Usage(
                "a design has the cases of its study: choose one with --case NAME".into(),
            ));
        }
        let design = resolve_design(Path::new(folder), id, catalogs)?;
        return Ok(Source { arm: design.arm, cases: design.cases, inputs: Vec::new() });
    }
    if path.is_dir() {
        let hint = "add # and a design_id from its front.csv";
        return Err(Failure::Usage(format!("{} is a folder: {hint}", args.source)));
    }
    refuse_other_kind(&path, "arm")?;
    let arm = read_arm(&path, catalogs)?;
    let mut inputs = vec![path];
    let cases = match &args.cases {
        Some(file) => {
            inputs.push(file.clone());
            refuse_other_kind(file, "cases")?;
            read_load_cases(Document::read(file)?, &arm.driven_joints())?
        }
        None => vec![case_of_flags(args, &arm)?],
    };
    Ok(Source { arm, cases, inputs })
}

fn case_of_flags(args: &ExportArgs, arm: &Arm) -> Result<LoadCase, Failure> {
    Ok(LoadCase {
        name: "case".into(),
        pose_deg: args.pose.entries(&arm.driven_joints())?,
        payload: Payload { mass_kg: args.payload_kg, cg_m: args.payload_cg_m.into(), ..Payload::default() },
        tip_force_n: Vector3::zeros(),
        tip_moment_nm: Vector3::zeros(),
        links: LinkModel::default(),
        joints: JointModel::default(),
        water: None,
    })
}
