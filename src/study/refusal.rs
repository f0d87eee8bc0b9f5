//! Why a question about a study has no answer.

use crate::input::json::{Faults, InputError};

/// Why a question about a study has no answer. The words say what to try.
#[derive(Debug, thiserror::Error)]
pub enum Refusal {
    /// A study, design or joint of this name is not known, or what is asked for does not suit the study.
    #[error("{0}")]
    Unknown(String),
    /// A file cannot be read.
    #[error("{0}")]
    Unreadable(String),
    /// A file is faulty; all faults at once.
    #[error(transparent)]
    Faulty(Faults),
    /// There is nothing to choose from.
    #[error("{0}")]
    EmptySpace(String),
    /// No design meets what is asked.
    #[error("{0}")]
    Infeasible(String),
}

impl From<Faults> for Refusal {
    fn from(faults: Faults) -> Self {
        Self::Faulty(faults)
    }
}

impl From<InputError> for Refusal {
    fn from(error: InputError) -> Self {
        match error {
            InputError::Faulty(faults) => Self::Faulty(faults),
            unreadable @ InputError::Unreadable { .. } => Self::Unreadable(unreadable.to_string()),
        }
    }
}
