//! Names of the files that hold corrected arms.

use crate::arm::Arm;

/// File of the first corrected arm.
pub(crate) const CORRECTED_FILE: &str = "arm.corrected.json";

/// File of a further corrected arm.
pub(crate) fn corrected_file(arm: &Arm) -> String {
    format!("{}.corrected.json", arm.name)
}
