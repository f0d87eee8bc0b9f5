//! The study that the user asks a verb to search, with the text of its file and with corrections of a measured arm.

use crate::study::definition::Study;
use crate::study::effects::Correction;

/// A study to be searched.
pub(super) struct Asked {
    /// The study as it was read, with the corrections that apply.
    pub study: Study,
    /// Text of the study's file.
    pub text: String,
    /// Corrections of a measured arm, both those that apply to the study and those that do not.
    pub corrections: Vec<Correction>,
}
