//! Reasons why a question about a study has no answer.

use crate::input::json::{Faults, InputError};

/// The reason why a question about a study has no answer. The message says what to try.
#[derive(Debug, thiserror::Error)]
pub enum Refusal {
    /// No study, design or joint has this name, or the request does not suit the study.
    #[error("{0}")]
    Unknown(String),
    /// A file cannot be read.
    #[error("{0}")]
    Unreadable(String),
    /// A file is faulty. The message lists all of its faults.
    #[error(transparent)]
    Faulty(Faults),
    /// Some link or joint of the study has nothing to choose from.
    #[error("{0}")]
    EmptySpace(String),
    /// No design meets the requirements.
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
