//! The study that a verb is asked for, read from its text, with the corrections of a measured arm.

use crate::study::definition::Study;
use crate::study::effects::Correction;

/// A study to be searched.
pub(super) struct Asked {
    /// The study.
    pub study: Study,
    /// Its file's text.
    pub text: String,
    /// The corrections of a measured arm: which apply to the study and which do not.
    pub corrections: Vec<Correction>,
}
