//! `armwright check`: the kind and all faults of files, or whether two folders of results are the same.

use super::check_files;
use super::check_same::same;
use super::exit::Answer;
use super::failure::Failure;
use crate::catalog::Catalogs;
use clap::Args;
use std::path::PathBuf;

/// Arguments of `check`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  armwright check study.json arm.json campaigns/may my-parts\n  \
    armwright check results/compare-materials\n  \
    armwright check --same results/monday results/tuesday\n\n\
    Says of each file or folder what it is, and reports all faults of all of them: arms, cases, studies, campaigns, catalogs, \
    URDF files, the files of imports and exports, and folders of any of them or of results. What belongs together is read together: readings with their campaign, cases with the arm.json in \
    their folder, a catalog with its folder, a stiffness file with the arm.json in its folder. The files of a result are compared with the hashes in it. The exit code is 3 if \
    a file has a fault, 9 if a result is not what was written or is incomplete, 7 if a file cannot be read.\n\n\
    --same compares two folders of results, with the folders in them, byte by byte. It ignores:\n  \
    elapsed_s, designs_per_s, threads, platform, files and manifest_hash of run.json and shard.json;\n  \
    files and manifest_hash of verdict.json;\n  \
    the marked timing of summary.md and report.html, and the folder's own name in the commands there.\n\
    Shards are compared if the folder has nothing else. The exit code is 9 if the folders differ, 7 if there is nothing to compare.")]
pub(crate) struct CheckArgs {
    /// Files and folders
    #[arg(value_name = "FILE", required_unless_present = "same", conflicts_with = "same")]
    files: Vec<PathBuf>,
    /// Print the findings as JSON
    #[arg(long, conflicts_with = "same")]
    json: bool,
    /// Two folders of results
    #[arg(long, num_args = 2, value_names = ["A", "B"])]
    same: Option<Vec<PathBuf>>,
}

/// Runs `armwright check` and returns the text to print.
///
/// # Errors
/// The two folders of results are not the same, or one cannot be read.
pub(super) fn run(args: &CheckArgs, catalogs: &Catalogs) -> Result<Answer, Failure> {
    match args.same.as_deref() {
        Some([a, b]) => same(a, b).map(Answer::from),
        Some(_) => Err(Failure::Usage("--same takes two folders".into())),
        None => Ok(check_files::report(&args.files, args.json, catalogs)),
    }
}
