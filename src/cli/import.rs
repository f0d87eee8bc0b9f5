//! `armwright import`: makes an arm file of a robot that a URDF file describes.

use super::failure::Failure;
use super::finished::pretty;
use super::own_files::write_own;
use crate::catalog::Catalogs;
use crate::input::json::{Document, read_text};
use crate::interchange::given::{blank, read_given};
use crate::interchange::import::Robot;
use clap::Args;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Makes an arm file of a robot in a URDF file: of the joints and links from its root to a tip.
#[derive(Debug, Args)]
#[command(after_help = "Example: armwright import ur5e.urdf --tip tool0 --out ur5e\n         \
                        armwright analyze ur5e/arm.json --pose-deg 0,-90,90,0,0,0 --payload-kg 5\n\n\
                        Writes arm.json and import.json (what was lumped, guessed and left rigid; ranges and limits). A URDF says nothing of \
                        stiffness: without --stiffness every joint is rigid, and stiffness.json with all joints is written to be filled \
                        in; one that has values is kept. Expand xacro files first.")]
pub(crate) struct ImportArgs {
    /// URDF file
    file: PathBuf,
    /// Link where the arm ends, such as the flange or the tool
    #[arg(long, value_name = "LINK")]
    tip: String,
    /// Stiffness of the joints (JSON): {"joints": {"NAME": {"stiffness_nm_per_rad": 2e4}}}; the keys are those of
    /// joints in arm files: one of stiffness_nm_per_rad, windup and gear, and also motor and bearing
    #[arg(long, value_name = "FILE")]
    stiffness: Option<PathBuf>,
    /// Folder for arm.json and import.json
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// Name of the file with the stiffness of all joints, which an import without one writes to be filled in.
const STIFFNESS: &str = "stiffness.json";

/// Whether a file has a value other than null, which a user must have written into it. A file that is no JSON counts as
/// having one.
fn holds_values(path: &Path) -> bool {
    fn has_value(value: &Value) -> bool {
        match value {
            Value::Null => false,
            Value::Array(items) => items.iter().any(has_value),
            Value::Object(map) => map.values().any(has_value),
            _ => true,
        }
    }
    let Ok(bytes) = std::fs::read(path) else { return false };
    serde_json::from_slice(&bytes).map_or(true, |value| has_value(&value))
}

/// Runs `armwright import`: writes the files, and returns the text to print.
pub(super) fn run(args: &ImportArgs, catalogs: &Catalogs) -> Result<String, Failure> {
    let file = args.file.display().to_string();
    let text = read_text(&args.file)?;
    let robot = Robot::read(&file, &text, &args.tip)?;
    let given = match &args.stiffness {
        Some(path) => read_given(Document::read(path)?, &robot.joints(), catalogs)?,
        None => Vec::new(),
    };
    let (arm, report) = robot.arm(&given)?;
    let mut files = vec![
        ("arm.json".to_string(), pretty(&arm.to_json())),
        ("import.json".to_string(), pretty(&report.to_json())),
    ];
    let stiffness = args.out.join(STIFFNESS);
    let is_kept = args.stiffness.is_none() && holds_values(&stiffness);
    if args.stiffness.is_none() && !is_kept {
        files.push((STIFFNESS.into(), pretty(&blank(&robot.joints()))));
    }
    let inputs: Vec<_> =
        [Some(args.file.as_path()), args.stiffness.as_deref()].into_iter().flatten().collect();
    write_own(&args.out, &files, &inputs)?;
    let out = args.out.display();
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    let stiffness = stiffness.display();
    let next = match &args.stiffness {
        None if is_kept => {
            format!(
                "{stiffness} has values and was kept, but not read: import again with --stiffness {stiffness} to use them\n"
            )
        }
        None => {
            format!("fill in {stiffness} and import again with --stiffness to have deflections and modes\n")
        }
        Some(_) => String::new(),
    };
    Ok(format!(
        "{}written to {out}: {}\n{next}try: armwright analyze {}\n",
        report.to_text(),
        names.join(", "),
        args.out.join("arm.json").display()
    ))
}
