//! Names of the files that hold corrected arms.

use crate::arm::Arm;
use crate::report::file_names::file_names;

/// File of the first corrected arm.
pub(crate) const CORRECTED_FILE: &str = "arm.corrected.json";

/// Files of the further corrected arms, in their order.
pub(crate) fn corrected_files(others: &[Arm]) -> Vec<String> {
    // the file of the first arm is always called `arm`, not by the arm's name
    let names = std::iter::once("arm").chain(others.iter().map(|arm| arm.name.as_str()));
    file_names(names).iter().skip(1).map(|name| format!("{name}.corrected.json")).collect()
}
