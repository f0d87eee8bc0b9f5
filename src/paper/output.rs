//! The result of a study of the paper, and the errors that prevent a result.

use super::names::NAMES;

/// The result of one of the paper's studies.
#[derive(Debug, Clone, PartialEq)]
pub struct PaperStudyOutput {
    /// Files to write: name and content. `summary.md` is among them.
    pub files: Vec<(String, Vec<u8>)>,
    /// Text that the program prints on the terminal.
    pub terminal: String,
}

impl PaperStudyOutput {
    /// Adds a text file to the output.
    pub(crate) fn file(&mut self, name: &str, content: String) {
        self.files.push((name.to_string(), content.into_bytes()));
    }
}

/// Reason why a study of the paper could not run.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PaperError {
    /// No paper study has this name.
    #[error("\"{name}\" is not a study of the paper; choose one of: {}", NAMES.join(", "))]
    UnknownStudy {
        /// Name as the user gave it.
        name: String,
    },
    /// A part named in the paper is not in the catalogs, or lacks a rating.
    #[error(
        "the catalogs have no {kind} \"{name}\", which this study needs; run with the built-in catalogs, or add it"
    )]
    Missing {
        /// Kind of the missing part, such as "gear".
        kind: &'static str,
        /// Name of the missing part.
        name: String,
    },
}
