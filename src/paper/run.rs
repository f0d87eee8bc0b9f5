//! Runs a study of the paper by its name.

use super::figures::{fig2, fig3, fig4};
use super::output::{PaperError, PaperStudyOutput};
use super::table1;
use crate::catalog::Catalogs;

/// Runs the study of the paper with this name.
///
/// # Errors
/// The name is not in `NAMES`, or the catalogs lack a part that the paper names.
pub fn run(name: &str, catalogs: &Catalogs) -> Result<PaperStudyOutput, PaperError> {
    match name {
        "paper-table1" => table1::run(catalogs),
        "fig2-metals" => fig2::run(catalogs),
        "fig3-wall-or-width" => fig3::run(catalogs),
        "fig4-composites" => fig4::run(catalogs),
        _ => Err(PaperError::UnknownStudy { name: name.to_string() }),
    }
}
