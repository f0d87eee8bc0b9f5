//! `armwright new`: starts a folder to be filled in.

use super::failure::Failure;
use super::write::write_all;
use crate::arm::file::read_arm;
use crate::catalog::Catalogs;
use crate::reconcile::starter;
use clap::{Args, Subcommand};
use std::path::{Path, PathBuf};

/// Arguments of `new`.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  armwright new campaign arm.json --out campaigns/may")]
pub(crate) struct NewArgs {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Start a campaign of measurements: the tables to fill in for an arm, and what to measure
    Campaign(CampaignArgs),
}

/// Arguments of `new campaign`.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  armwright new campaign arm.json --out campaigns/may\n\n\
    Writes campaign.json with a note on each block, a copy of the arm file as arm.json, static.csv, modal.csv, \
    windup.csv and positions.csv with the columns of the arm's joints and no rows, and STARTER.md, which says what to \
    measure, in how many poses, and what each column is. Nothing that is there is overwritten.")]
struct CampaignArgs {
    /// Arm file of the arm to be measured.
    #[arg(value_name = "ARM")]
    arm: PathBuf,
    /// Folder of the new campaign, made with its parents; its name is the campaign's.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// Writes the folder, and says what to do next.
///
/// # Errors
/// All faults of the arm file, a folder that has one of the files, or one that cannot be written.
pub(crate) fn run(args: &NewArgs, catalogs: &Catalogs) -> Result<String, Failure> {
    let What::Campaign(args) = &args.what;
    let arm = read_arm(&args.arm, catalogs)?;
    let arm_text = fs_err::read(&args.arm).map_err(|e| Failure::file(&args.arm, "read", &e))?;
    let mut files = vec![("arm.json".to_string(), arm_text)];
    let texts = starter::files(&arm, &name_of(&args.out));
    files.extend(texts.into_iter().map(|(name, text)| (name, text.into_bytes())));
    if let Some((name, _)) = files.iter().find(|(name, _)| args.out.join(name).exists()) {
        let there = args.out.join(name);
        return Err(Failure::Usage(format!("{} is there already: choose another folder", there.display())));
    }
    write_all(&args.out, &files, &[&args.arm])?;
    let out = args.out.display();
    Ok(format!(
        "written to {out}\n\nRead {}, fill in the tables, and run: armwright reconcile {out}\n",
        args.out.join(starter::PAGE).display()
    ))
}

fn name_of(folder: &Path) -> String {
    folder.file_name().map_or("campaign".into(), |name| name.to_string_lossy().into_owned())
}
