//! The command line: one file a verb. A verb returns the text it prints; [`print()`] is the one place
//! that writes to standard output.

pub(crate) mod analyze;
pub(crate) mod beside;
pub(crate) mod carry;
pub mod catalog;
pub mod compare;
pub(crate) mod design;
pub(crate) mod finished;
pub(crate) mod front;
pub mod predict;
pub(crate) mod progress;
pub mod reconcile;
pub(crate) mod rerun;
pub(crate) mod run;
pub(crate) mod search;
pub(crate) mod size;

use crate::arm::Words;
use crate::catalog::Catalogs;
use crate::input::json::{Faults, InputError};
use clap::{Parser, Subcommand};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Sizes high-precision robot arms and finds their Pareto-optimal designs.
#[derive(Debug, Parser)]
#[command(
    name = "armwright",
    version,
    max_term_width = 100,
    after_help = "Exit codes: 0 done; 1 internal error; 2 wrong usage; 3 faulty input file; 4 faulty catalog; \
                  5 empty design space; 6 infeasible; 7 file cannot be read or written; 8 interrupted; \
                  9 a check failed.\n\nStart with: armwright run compare-materials"
)]
pub struct Cli {
    /// Folder of your own catalog rows (gears.csv, motors.csv, materials.csv, profiles.csv), laid over the
    /// built-in ones.
    #[arg(long, global = true, value_name = "DIR")]
    catalogs: Option<PathBuf>,
    /// Worker threads; the default is one per core. Results do not depend on it.
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// List the built-in studies
    Studies,
    /// Run a study: find its Pareto front and write it
    Run(run::RunArgs),
    /// Size every joint of a study's arm, joint 6 to joint 1
    Size(size::SizeArgs),
    /// Statics, modes and response of an arm file
    Analyze(analyze::AnalyzeArgs),
    /// Take a design out of a result as an arm file
    Design(design::DesignArgs),
    /// Check a finished front
    Front(front::FrontArgs),
    /// Put fronts side by side: materials of one study, or several studies
    Compare(compare::CompareArgs),
    /// Find where an arm and its measurements disagree and which physics is missing
    Reconcile(reconcile::ReconcileArgs),
    /// Write the model's value beside every reading of a file
    Predict(predict::PredictArgs),
    /// Check the catalogs, or list what is in them
    Catalog(catalog::CatalogArgs),
}

/// Why a verb failed; each reason has an exit code of its own.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// Something that should not happen.
    #[error("{0}")]
    Internal(String),
    /// A word on the command line that is not known.
    #[error("{0}")]
    Usage(String),
    /// An input file is wrong.
    #[error(transparent)]
    Input(Faults),
    /// A catalog is wrong.
    #[error("in the catalogs, {0}")]
    Catalog(Faults),
    /// There is nothing to choose from.
    #[error("{0}")]
    EmptySpace(String),
    /// No design meets what is asked.
    #[error("{0}")]
    Infeasible(String),
    /// A file cannot be read or written.
    #[error("{0}")]
    File(String),
    /// Stopped by the user.
    #[error("{0}")]
    Interrupted(String),
    /// A check found a difference.
    #[error("{0}")]
    Check(String),
}

impl Failure {
    /// The process exit code.
    pub fn exit_code(&self) -> u8 {
        match self {
            Failure::Internal(_) => 1,
            Failure::Usage(_) => 2,
            Failure::Input(_) => 3,
            Failure::Catalog(_) => 4,
            Failure::EmptySpace(_) => 5,
            Failure::Infeasible(_) => 6,
            Failure::File(_) => 7,
            Failure::Interrupted(_) => 8,
            Failure::Check(_) => 9,
        }
    }

    /// Why the catalogs cannot be used.
    fn catalog(error: InputError) -> Self {
        match error {
            InputError::Faulty(faults) => Failure::Catalog(faults),
            unreadable => Failure::File(unreadable.to_string()),
        }
    }

    fn file(path: &Path, doing: &str, source: &std::io::Error) -> Self {
        Failure::File(format!("cannot {doing} {}: {source}", path.display()))
    }
}

impl From<InputError> for Failure {
    fn from(error: InputError) -> Self {
        match error {
            InputError::Unreadable { .. } => Failure::File(error.to_string()),
            InputError::Faulty(faults) => Failure::Input(faults),
        }
    }
}

impl From<crate::catalog::lookup::PartError> for Failure {
    fn from(error: crate::catalog::lookup::PartError) -> Self {
        Failure::Usage(error.to_string())
    }
}

impl From<Faults> for Failure {
    fn from(faults: Faults) -> Self {
        Failure::Input(faults)
    }
}

/// Writes a verb's text to standard output; a closed pipe is no error.
pub fn print(text: &str) {
    let mut out = std::io::stdout().lock();
    let _ = out.write_all(text.as_bytes());
    if !text.is_empty() && !text.ends_with('\n') {
        let _ = out.write_all(b"\n");
    }
}

/// Stack of a worker \[bytes\]: regions of an exact search nest, and a worker that waits takes up others' meanwhile.
const STACK: usize = 64 << 20;

/// Carries out a command line.
///
/// # Errors
/// See [`Failure`].
pub fn run(cli: Cli) -> Result<String, Failure> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(cli.threads.map_or(0, Into::into))
        .stack_size(STACK)
        .build_global()
        .map_err(|e| Failure::Internal(e.to_string()))?;
    let overlay = cli.catalogs.as_deref();
    let catalogs = Catalogs::load(overlay).map_err(Failure::catalog);
    match cli.verb {
        Verb::Catalog(args) => catalog::run(&args, overlay),
        Verb::Studies => Ok(crate::study::list()),
        Verb::Run(args) => run::run(&args, &catalogs?, overlay),
        Verb::Size(args) => size::run(&args, &catalogs?),
        Verb::Compare(args) => compare::run(&args),
        Verb::Analyze(args) => analyze::run(&args, &catalogs?),
        Verb::Design(args) => design::run(&args, &catalogs?),
        Verb::Front(args) => front::run(&args, &catalogs?),
        Verb::Reconcile(args) => reconcile::run(&args, &catalogs?, overlay).map(|(_, text)| text),
        Verb::Predict(args) => predict::run(&args, &catalogs?),
    }
}

/// Comma-separated numbers, as many as asked.
fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let list = number_list(text)?;
    list.try_into()
        .map_err(|list: Vec<f64>| format!("{} numbers given, {N} needed, separated by commas", list.len()))
}

/// Comma-separated finite numbers.
fn number_list(text: &str) -> Result<Vec<f64>, String> {
    text.split(',')
        .map(|cell| match cell.trim().parse::<f64>() {
            Ok(x) if x.is_finite() => Ok(x),
            _ => Err(format!("\"{cell}\" is not a finite number")),
        })
        .collect()
}

/// One of the words of a choice.
fn choice<T: Words>(text: &str) -> Result<T, String> {
    T::from_word(text).ok_or_else(|| format!("choose one of: {}", T::words()))
}

/// A path in a folder's files written all at once: temporary files first, then renamed.
pub(crate) fn write_all(dir: &Path, files: &[(String, Vec<u8>)]) -> Result<(), Failure> {
    fs_err::create_dir_all(dir).map_err(|e| Failure::file(dir, "create", &e))?;
    let mut staged = Vec::with_capacity(files.len());
    for (name, bytes) in files {
        let path = dir.join(name);
        let folder = path.parent().unwrap_or(dir);
        fs_err::create_dir_all(folder).map_err(|e| Failure::file(folder, "create", &e))?;
        let mut file =
            tempfile::NamedTempFile::new_in(folder).map_err(|e| Failure::file(dir, "write in", &e))?;
        file.write_all(bytes).map_err(|e| Failure::file(dir, "write in", &e))?;
        staged.push((file, path));
    }
    for (file, path) in staged {
        file.persist(&path).map_err(|e| Failure::file(&path, "write", &e.error))?;
        make_readable(&path);
    }
    Ok(())
}

/// Temporary files are private to their owner; results are not.
#[cfg(unix)]
fn make_readable(path: &Path) {
    use std::os::unix::fs::PermissionsExt;
    let _ = std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o644));
}

#[cfg(not(unix))]
fn make_readable(_: &Path) {}
