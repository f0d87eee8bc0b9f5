//! Why a verb failed.

use super::exit::Exit;
use crate::input::json::{Faults, InputError};
use crate::study::refusal::Refusal;
use std::path::Path;

/// Why a verb failed. Each reason has its own exit code.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// An internal error, which should not happen.
    #[error("{0}")]
    Internal(String),
    /// The command line is wrong.
    #[error("{0}")]
    Usage(String),
    /// An input file has faults.
    #[error(transparent)]
    Input(Faults),
    /// A catalog has faults.
    #[error("in the catalogs, {0}")]
    Catalog(Faults),
    /// The design space has no designs.
    #[error("{0}")]
    EmptySpace(String),
    /// No design meets the limits.
    #[error("{0}")]
    Infeasible(String),
    /// A file cannot be read or written.
    #[error("{0}")]
    File(String),
    /// The user stopped the run.
    #[error("{0}")]
    Interrupted(String),
    /// A check failed: a result is wrong, or two results differ.
    #[error("{0}")]
    Check(String),
    /// Another process is writing the folder of results.
    #[error("{0}")]
    Locked(String),
    /// A time limit ended the run before any design was found.
    #[error("{0}")]
    Partial(String),
}

impl Failure {
    /// The exit status with which the program ends after this failure.
    pub fn exit(&self) -> Exit {
        match self {
            Failure::Internal(_) => Exit::Internal,
            Failure::Usage(_) => Exit::Usage,
            Failure::Input(_) => Exit::Input,
            Failure::Catalog(_) => Exit::Catalog,
            Failure::EmptySpace(_) => Exit::EmptySpace,
            Failure::Infeasible(_) => Exit::Infeasible,
            Failure::File(_) => Exit::File,
            Failure::Interrupted(_) => Exit::Interrupted,
            Failure::Check(_) => Exit::CheckFailed,
            Failure::Locked(_) => Exit::Locked,
            Failure::Partial(_) => Exit::Partial,
        }
    }

    /// The exit code of the process.
    pub fn exit_code(&self) -> u8 {
        self.exit().code()
    }

    /// The failure if the catalogs cannot be read or have faults.
    pub(super) fn catalog(error: InputError) -> Self {
        match error {
            InputError::Faulty(faults) => Failure::Catalog(faults),
            unreadable => Failure::File(unreadable.to_string()),
        }
    }

    pub(super) fn file(path: &Path, doing: &str, source: &std::io::Error) -> Self {
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

impl From<Refusal> for Failure {
    fn from(refusal: Refusal) -> Self {
        match refusal {
            Refusal::Unknown(words) => Failure::Usage(words),
            Refusal::Unreadable(words) => Failure::File(words),
            Refusal::Faulty(faults) => Failure::Input(faults),
            Refusal::EmptySpace(words) => Failure::EmptySpace(words),
            Refusal::Infeasible(words) => Failure::Infeasible(words),
        }
    }
}

impl From<Faults> for Failure {
    fn from(faults: Faults) -> Self {
        Failure::Input(faults)
    }
}
