//! All verbs: their names, and the functions that run them.

use super::exit::{Answer, Exit};
use super::failure::Failure;
use super::log::{Log, LogForm};
use super::setup::Setup;
use super::stop::listen;
use super::{
    analyze, capacity, catalog, check, compare, design, export, front, import, merge, new, predict,
    reconcile, schema, shell, size, slurm,
};
use crate::catalog::Catalogs;
use crate::exact::run::WORKER_STACK_BYTES;
use clap::{CommandFactory, Parser, Subcommand};
use std::path::PathBuf;

/// Sizes high-precision robot arms and finds their Pareto-optimal designs.
#[derive(Debug, Parser)]
#[command(
    name = "armwright",
    version,
    max_term_width = 100,
    after_help = Exit::help()
)]
pub struct Cli {
    /// Folder with your own catalog rows (gears.csv, gears_efficiency.csv, actuators.csv, motors.csv,
    /// motor_curves.csv, materials.csv, profiles.csv), added to the built-in ones; a row of the same name
    /// replaces the built-in one.
    #[arg(long, global = true, value_name = "DIR")]
    catalogs: Option<PathBuf>,
    /// Worker threads; the default is one per core. Results do not depend on it.
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    /// Say nothing on standard error but errors.
    #[arg(long, short, global = true)]
    quiet: bool,
    /// Form of progress and messages on standard error.
    #[arg(long, global = true, value_enum, value_name = "FORM", default_value = "text")]
    log: LogForm,
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// List the built-in studies
    Studies,
    /// Run a study: find its Pareto front and write it
    Run(super::run::RunArgs),
    /// Size every joint of a study's arm, from the tip inward
    Size(size::SizeArgs),
    /// Find the largest payload and speed that an arm holds
    Capacity(capacity::CapacityArgs),
    /// Compute statics, modes and response of an arm file
    Analyze(analyze::AnalyzeArgs),
    /// Write a design of a result as an arm file
    Design(design::DesignArgs),
    /// Write an arm or a design for CalculiX, MuJoCo, URDF, or as a bill of materials
    Export(export::ExportArgs),
    /// Make an arm file of a robot in a URDF file
    Import(import::ImportArgs),
    /// Check a finished front
    Front(front::FrontArgs),
    /// Compare fronts: the materials of one study, or several studies
    Compare(compare::CompareArgs),
    /// Join the shards of a search into its front
    Merge(merge::MergeArgs),
    /// List the shards of a search and what is missing
    Status(merge::StatusArgs),
    /// Print a script that runs a study as shards on a Slurm cluster
    Slurm(slurm::SlurmArgs),
    /// Say what files are, and all their faults; or compare two results
    Check(check::CheckArgs),
    /// Print the schema of a kind of file
    Schema(schema::SchemaArgs),
    /// Print the completions of a shell
    Completions(shell::CompletionsArgs),
    /// Write manual pages
    Man(shell::ManArgs),
    /// Start a study, an arm, parts of your own or a campaign of measurements
    New(new::NewArgs),
    /// Find where an arm and its measurements disagree and which physics is missing
    Reconcile(reconcile::ReconcileArgs),
    /// Write the model's value next to every reading of a file
    Predict(predict::PredictArgs),
    /// Check the catalogs, or list what is in them
    Catalog(catalog::CatalogArgs),
}

impl Verb {
    /// Whether the verb tests the flag that a signal sets, and stops by itself. False if it does not, although it
    /// writes files. `None` if it writes nothing, so that a signal may end it at any moment.
    fn stops(&self) -> Option<bool> {
        match self {
            Verb::Run(_) | Verb::Front(_) | Verb::Merge(_) | Verb::Reconcile(_) => Some(true),
            Verb::Size(_)
            | Verb::Compare(_)
            | Verb::Design(_)
            | Verb::Export(_)
            | Verb::Import(_)
            | Verb::Man(_)
            | Verb::New(_)
            | Verb::Predict(_) => Some(false),
            Verb::Studies
            | Verb::Capacity(_)
            | Verb::Analyze(_)
            | Verb::Status(_)
            | Verb::Slurm(_)
            | Verb::Check(_)
            | Verb::Schema(_)
            | Verb::Completions(_)
            | Verb::Catalog(_) => None,
        }
    }
}

impl Cli {
    /// The log for messages and progress, in the form that the user asks for.
    pub fn log(&self) -> Log {
        Log::new(self.log, self.quiet)
    }
}

/// Runs a command line and returns the answer to print.
///
/// # Errors
/// See [`Failure`].
pub fn run(cli: Cli) -> Result<Answer, Failure> {
    let workers = rayon::ThreadPoolBuilder::new()
        .num_threads(cli.threads.map_or(0, Into::into))
        .stack_size(WORKER_STACK_BYTES)
        .build_global();
    // If the process has run a command line before, it keeps its number of worker threads. Results do not depend on
    // this number. Therefore it is an error only if the user asks for a number that cannot be had.
    if let (Err(e), Some(_)) = (workers, cli.threads) {
        return Err(Failure::Internal(e.to_string()));
    }
    let log = cli.log();
    if let Some(looks) = cli.verb.stops() {
        listen(looks, log);
    }
    let overlay = cli.catalogs.as_deref();
    let catalogs = Catalogs::load(overlay).map_err(Failure::catalog);
    let text = match cli.verb {
        Verb::Run(args) => {
            return super::run::run(&args, Setup { catalogs: &catalogs?, overlay, log });
        }
        Verb::Front(args) => return front::run(&args, &catalogs?, log),
        Verb::Check(args) => return check::run(&args, &catalogs?),
        Verb::Completions(args) => Ok(shell::completions(&args, Cli::command())),
        Verb::Man(args) => shell::man(&args, Cli::command()),
        Verb::Schema(args) => schema::run(&args),
        Verb::Reconcile(args) => {
            return reconcile::run(&args, Setup { catalogs: &catalogs?, overlay, log });
        }
        Verb::Catalog(args) => catalog::run(&args, overlay),
        Verb::Studies => Ok(crate::study::list()),
        Verb::Size(args) => size::run(&args, &catalogs?, log),
        Verb::Merge(args) => {
            return merge::merge(&args, Setup { catalogs: &catalogs?, overlay, log });
        }
        Verb::Status(args) => merge::status(&args),
        Verb::Slurm(args) => slurm::run(&args, &catalogs?, overlay),
        Verb::Capacity(args) => capacity::run(&args, &catalogs?),
        Verb::Compare(args) => compare::run(&args),
        Verb::Analyze(args) => analyze::run(&args, &catalogs?),
        Verb::Design(args) => design::run(&args, &catalogs?),
        Verb::Import(args) => import::run(&args, &catalogs?),
        Verb::Export(args) => export::run(&args, &catalogs?),
        Verb::New(args) => new::run(&args, &catalogs?),
        Verb::Predict(args) => predict::run(&args, &catalogs?, log),
    };
    text.map(Answer::from)
}
