//! `armwright new`: starts a folder whose files the user then fills in.

use super::failure::Failure;
use super::starter_files::{ARM, PAGE, PARTS, STUDY, filled};
use super::write::write_all;
use super::wrong_kind::refuse_other_kind;
use crate::arm::file::read_arm;
use crate::catalog::Catalogs;
use crate::reconcile::starter;
use clap::{Args, Subcommand};
use std::path::{Path, PathBuf};

/// Arguments of `new`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  armwright new study --out lift\n  armwright new arm --out my-arm\n  \
    armwright new parts --out my-parts\n  armwright new campaign arm.json --out campaigns/may")]
pub(crate) struct NewArgs {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Start a study: study.json, which runs as it is, and a page that explains each block
    #[command(after_help = "Example: armwright new study --out lift")]
    Study(FolderArgs),
    /// Start an arm: arm.json and cases.json, and a page that explains each block
    #[command(after_help = "Example: armwright new arm --out my-arm")]
    Arm(FolderArgs),
    /// Start parts of your own: catalog files with an example row each, and a page that explains them
    #[command(after_help = "Example: armwright new parts --out my-parts")]
    Parts(FolderArgs),
    /// Start a campaign of measurements: the tables to fill in for an arm, and what to measure
    Campaign(CampaignArgs),
}

/// Arguments of `new study`, `new arm` and `new parts`.
#[derive(Debug, Args)]
struct FolderArgs {
    /// New folder, made with its parents; its name is the name of the study or arm. Nothing that is there is
    /// overwritten.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
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

/// Writes the files of a new study, arm, catalog folder or campaign, and returns a text that says what to do next.
///
/// # Errors
/// The arm file has faults, the folder already has one of the files, or a file cannot be written.
pub(crate) fn run(args: &NewArgs, catalogs: &Catalogs) -> Result<String, Failure> {
    match &args.what {
        What::Study(args) => start(STUDY, &args.out, "armwright run", "study.json"),
        What::Arm(args) => start(ARM, &args.out, "armwright analyze", "arm.json"),
        What::Parts(args) => start(PARTS, &args.out, "armwright check", ""),
        What::Campaign(args) => campaign(args, catalogs),
    }
}

/// Writes the files of a new study, arm or catalog folder.
fn start(
    texts: &'static [(&'static str, &'static str)],
    out: &Path,
    verb: &str,
    file: &str,
) -> Result<String, Failure> {
    write_new(out, &filled(texts, &name_of(out), &out.display().to_string()), &[])?;
    let (shown, what) = (out.display(), if file.is_empty() { out.to_path_buf() } else { out.join(file) });
    Ok(format!(
        "written to {shown}\n\nRead {}, and run: {verb} {}\n",
        out.join(PAGE).display(),
        what.display()
    ))
}

fn campaign(args: &CampaignArgs, catalogs: &Catalogs) -> Result<String, Failure> {
    refuse_other_kind(&args.arm, "arm")?;
    let arm = read_arm(&args.arm, catalogs)?;
    let arm_text = fs_err::read(&args.arm).map_err(|e| Failure::file(&args.arm, "read", &e))?;
    let mut files = vec![("arm.json".to_string(), arm_text)];
    let texts = starter::files(&arm, &name_of(&args.out));
    files.extend(texts.into_iter().map(|(name, text)| (name, text.into_bytes())));
    write_new(&args.out, &files, &[&args.arm])?;
    let out = args.out.display();
    Ok(format!(
        "written to {out}\n\nRead {}, fill in the tables, and run: armwright reconcile {out}\n",
        args.out.join(starter::PAGE).display()
    ))
}

/// Writes files into a folder. Fails if one of them exists already.
fn write_new(out: &Path, files: &[(String, Vec<u8>)], inputs: &[&Path]) -> Result<(), Failure> {
    match files.iter().find(|(name, _)| out.join(name).exists()) {
        Some((name, _)) => {
            let there = out.join(name);
            Err(Failure::Usage(format!("{} is there already: choose another folder", there.display())))
        }
        None => write_all(out, files, inputs),
    }
}

/// The name of the new study, arm or campaign: the name of its folder.
fn name_of(folder: &Path) -> String {
    folder.file_name().map_or("new".into(), |name| name.to_string_lossy().into_owned())
}
