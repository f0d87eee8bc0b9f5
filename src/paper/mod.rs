//! The paper, reproduced: its table and its three figures, every number computed.
//!
//! | study | what it answers |
//! |---|---|
//! | `paper-table1` | each number the paper gets from its Table 1 beside ours: the reading that gives it, the exact frame's value, the reason for a difference; and what the conclusions' remedies would leave |
//! | `fig2-metals` | deflection against weight per length of three metals |
//! | `fig3-wall-or-width` | whether a kilogram belongs into wall or outer dimensions |
//! | `fig4-composites` | composites against the best metal |
//!
//! The paper's equations are written down as printed ([`equations`], [`coupled`]) and separately from the
//! general mechanics, so that each checks the other.

pub mod arm;
pub mod claim;
pub mod coupled;
pub mod equations;
pub mod figures;
pub(crate) mod modes_rows;
pub mod parts;
pub mod remedies;
pub mod rows;
pub(crate) mod statics_rows;
pub mod table1;
pub mod third_spring;
pub(crate) mod torque_rows;

use crate::catalog::Catalogs;

/// The names of the paper's studies.
pub const NAMES: [&str; 4] = ["paper-table1", "fig2-metals", "fig3-wall-or-width", "fig4-composites"];

/// What a paper study gives.
#[derive(Debug, Clone, PartialEq)]
pub struct PaperStudyOutput {
    /// Files to write: name and content. `summary.md` is among them.
    pub files: Vec<(String, Vec<u8>)>,
    /// What to print.
    pub terminal: String,
}

impl PaperStudyOutput {
    /// Adds a text file.
    pub(crate) fn file(&mut self, name: &str, content: String) {
        self.files.push((name.to_string(), content.into_bytes()));
    }
}

/// Why a paper study could not run.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PaperError {
    /// No paper study has this name.
    #[error("\"{name}\" is not a study of the paper; choose one of: {}", NAMES.join(", "))]
    UnknownStudy {
        /// Name as given.
        name: String,
    },
    /// A part the paper names is not in the catalogs, or lacks a figure.
    #[error(
        "the catalogs have no {kind} \"{name}\", which this study needs; run with the built-in catalogs, or add it"
    )]
    Missing {
        /// What is missing.
        kind: &'static str,
        /// Its name.
        name: String,
    },
}

/// Runs a study of the paper.
///
/// # Errors
/// The name is not in [`NAMES`], or the catalogs lack a part the paper names.
pub fn run(name: &str, catalogs: &Catalogs) -> Result<PaperStudyOutput, PaperError> {
    match name {
        "paper-table1" => table1::run(catalogs),
        "fig2-metals" => figures::fig2::run(catalogs),
        "fig3-wall-or-width" => figures::fig3::run(catalogs),
        "fig4-composites" => figures::fig4::run(catalogs),
        _ => Err(PaperError::UnknownStudy { name: name.to_string() }),
    }
}
