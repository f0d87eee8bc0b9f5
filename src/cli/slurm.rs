//! `armwright slurm`: a script that runs a study as an array of shards on a Slurm cluster and joins them.

use super::failure::Failure;
use super::merge::shell_word;
use super::shard::MOST_SHARDS;
use crate::catalog::Catalogs;
use crate::report::file_names::file_name;
use crate::study::load::{load_study, refuse_empty};
use clap::Args;
use std::path::{Path, PathBuf};

/// Prints a shell script that submits a study as an array of shards, and a job that joins them when all are done. A shard
/// that fails can be submitted again by itself (`armwright status`), and the script can be run again: shards that are
/// there are not swept twice.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: armwright slurm my-study.json --shards 64 --cpus 8 > submit.sh\n         sh submit.sh"
)]
pub(crate) struct SlurmArgs {
    /// A built-in study or a study file
    study: String,
    /// Number of shards
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_SHARDS)))]
    shards: u32,
    /// Processors of each shard
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1024))]
    cpus: u32,
    /// Folder for the results; shards go into the folder `shards` in it; default results/<study>
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Runs `armwright slurm` and returns the script.
pub(super) fn run(args: &SlurmArgs, catalogs: &Catalogs, overlay: Option<&Path>) -> Result<String, Failure> {
    let (study, _) = load_study(&args.study, catalogs)?;
    refuse_empty(&study, catalogs)?;
    let name = file_name(&study.name);
    let out = args.out.clone().unwrap_or_else(|| Path::new("results").join(&name));
    let out = shell_word(&out.display().to_string());
    let catalogs = overlay
        .map_or(String::new(), |dir| format!(" --catalogs {}", shell_word(&dir.display().to_string())));
    let (study, shards, cpus) = (shell_word(&args.study), args.shards, args.cpus);
    Ok(format!(
        r#"#!/bin/sh
# Submits {shards} shards of a study and a job that joins them. Run it in the folder from which the study is named.
# Each batch script ends in exec: signals reach armwright, and Slurm sees its exit code.
set -eu
shards=$(sbatch --parsable <<'SHARDS'
#!/bin/sh
#SBATCH --job-name={name}-shard
#SBATCH --array=1-{shards}
#SBATCH --ntasks=1
#SBATCH --cpus-per-task={cpus}
#SBATCH --output={name}-shard-%A_%a.log
exec armwright run {study}{catalogs} --shard "$SLURM_ARRAY_TASK_ID/{shards}" --threads {cpus} --out {out}/shards/"$SLURM_ARRAY_TASK_ID"-of-{shards}
SHARDS
)
merge=$(sbatch --parsable --dependency="afterok:$shards" --kill-on-invalid-dep=yes <<'MERGE'
#!/bin/sh
#SBATCH --job-name={name}-merge
#SBATCH --ntasks=1
#SBATCH --cpus-per-task={cpus}
#SBATCH --output={name}-merge-%j.log
exec armwright merge {out}/shards{catalogs} --threads {cpus} --out {out}
MERGE
)
echo "shards $shards, merge $merge"
"#
    ))
}
