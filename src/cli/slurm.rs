//! `armwright slurm`: a script that runs a study as an array of shards on a Slurm cluster and joins them.

use super::failure::Failure;
use super::merge::shell_word;
use super::search::{SearchArgs, part_or_none};
use super::shard::MOST_SHARDS;
use super::wrong_kind::study_of;
use crate::catalog::Catalogs;
use crate::report::file_names::folder_name;
use crate::study::load::refuse_empty;
use crate::study::search_method::SearchMethod;
use crate::study::tolerance::part;
use clap::Args;
use std::path::{Path, PathBuf};

/// Prints a shell script that submits a study as an array of shards, and a job that joins them when all are done. A
/// shard that fails can be submitted again by itself (`armwright status`), and the script can be run again: shards that
/// are there are not swept twice.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: armwright slurm my-study.json --shards 64 --cpus 8 > submit.sh\n         sh submit.sh"
)]
pub(crate) struct SlurmArgs {
    /// A built-in study or a study file
    study: String,
    /// Number of shards. Slurm refuses arrays of more than MaxArraySize - 1 tasks, which is 1000 unless slurm.conf says
    /// otherwise; the script of a larger one says so
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_SHARDS)))]
    shards: u32,
    /// How the front is searched for. Default: exact with --gap, else exhaustive
    #[arg(long, value_enum)]
    search: Option<SearchMethod>,
    /// End the exact search at this gap, such as 1%, as in `armwright run`
    #[arg(long, value_name = "PERCENT", value_parser = part_or_none)]
    gap: Option<f64>,
    /// Before the shards of an exact search, submit a job that searches the whole study to this gap, such as 10%; the
    /// shards begin with what it found
    #[arg(long, value_name = "PERCENT", value_parser = part)]
    gap_first: Option<f64>,
    /// Processors of each shard
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1024))]
    cpus: u32,
    /// Folder for the results; shards go into the folder `shards` in it; default results/<study>
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Runs `armwright slurm` and returns the script.
pub(super) fn run(args: &SlurmArgs, catalogs: &Catalogs, overlay: Option<&Path>) -> Result<String, Failure> {
    let (study, _) = study_of(&args.study, catalogs)?;
    refuse_empty(&study, catalogs)?;
    let (method, _) = SearchArgs::asking_for(args.search, args.gap).check_shard(&study, catalogs)?;
    if method == SearchMethod::Exhaustive && args.gap_first.is_some() {
        return Err(Failure::Usage("--gap-first goes with --search exact".into()));
    }
    let name = folder_name(&study.name);
    let out = args.out.clone().unwrap_or_else(|| Path::new("results").join(&name));
    let out = shell_word(&out.display().to_string());
    let catalogs = overlay
        .map_or(String::new(), |dir| format!(" --catalogs {}", shell_word(&dir.display().to_string())));
    let (study, shards, cpus) = (shell_word(&args.study), args.shards, args.cpus);
    let job = |kind: &str, log: &str, more: &str, command: &str| {
        format!(
            "#!/bin/sh\n#SBATCH --job-name={name}-{kind}\n{more}#SBATCH --ntasks=1\n#SBATCH --cpus-per-task={cpus}\n\
             #SBATCH --output={name}-{kind}-{log}.log\nexec armwright {command}"
        )
    };
    let search = words_of(args.search, args.gap);
    let limit = if shards > MOST_TASKS { array_words(shards) } else { String::new() };
    let (mut first, mut after, mut told, mut incumbents) = Default::default();
    if let Some(gap) = args.gap_first {
        let wide = words_of(Some(SearchMethod::Exact), Some(gap));
        let command =
            format!("run {study}{catalogs}{wide} --shard 1/1 --threads {cpus} --out {out}/incumbents");
        first =
            format!("first=$(sbatch --parsable <<'FIRST'\n{}\nFIRST\n)\n", job("first", "%j", "", &command));
        (after, told) = (" --dependency=\"afterok:$first\" --kill-on-invalid-dep=yes", "first $first, ");
        incumbents = format!(" --incumbents {out}/incumbents");
    }
    let shard = job(
        "shard",
        "%A_%a",
        &format!("#SBATCH --array=1-{shards}\n"),
        &format!(
            "run {study}{catalogs}{search}{incumbents} --shard \"$SLURM_ARRAY_TASK_ID/{shards}\" --threads {cpus} --out \
             {out}/shards/\"$SLURM_ARRAY_TASK_ID\"-of-{shards}"
        ),
    );
    let merge = job("merge", "%j", "", &format!("merge {out}/shards{catalogs} --threads {cpus} --out {out}"));
    Ok(format!(
        r#"#!/bin/sh
# Submits {shards} shards of a study and a job that joins them. Run it in the folder from which the study is named.
# Each batch script ends in exec: signals reach armwright, and Slurm sees its exit code.
{limit}set -eu
{first}shards=$(sbatch --parsable{after} <<'SHARDS'
{shard}
SHARDS
)
merge=$(sbatch --parsable --dependency="afterok:$shards" --kill-on-invalid-dep=yes <<'MERGE'
{merge}
MERGE
)
echo "{told}shards $shards, merge $merge"
"#
    ))
}

/// The largest number of tasks in an array if `slurm.conf` does not set `MaxArraySize`. The setting is one more than
/// the largest index of a task, and its default is 1001 (<https://slurm.schedmd.com/slurm.conf.html>).
const MOST_TASKS: u32 = 1000;

/// Lines of a script that say which setting of Slurm its array needs.
fn array_words(shards: u32) -> String {
    let least = shards + 1;
    format!(
        "# Slurm must allow an array of so many tasks: MaxArraySize of at least {least}, where the default is 1001. It says\n\
         # what it has with: scontrol show config | grep MaxArraySize\n"
    )
}

/// The words that ask for a search, each with a blank before it.
fn words_of(search: Option<SearchMethod>, gap: Option<f64>) -> String {
    let words = SearchArgs::asking_for(search, gap).words();
    words.iter().map(|word| format!(" {word}")).collect()
}
