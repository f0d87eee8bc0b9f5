//! Names of the files with the corrected arms.

use crate::arm::Arm;
use crate::report::file_names::file_names;

/// Name of the file of the first corrected arm.
pub(crate) const CORRECTED_FILE: &str = "arm.corrected.json";

/// Names of the files of the other corrected arms, in the order of the arms.
pub(crate) fn corrected_files(others: &[Arm]) -> Vec<String> {
    // the file of the first arm is always called `arm`, not by the arm's name
    let names = std::iter::once("arm").chain(others.iter().map(|arm| arm.name.as_str()));
    file_names(names).iter().skip(1).map(|name| format!("{name}.corrected.json")).collect()
}
