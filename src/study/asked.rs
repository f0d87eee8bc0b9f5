//! A study that is asked for, with the corrections of a measured arm.

use super::definition::Study;
use super::effects::{Correction, apply_corrections, left_out};
use super::read::read_study;
use super::refusal::Refusal;
use crate::arm::Arm;
use crate::arm::file::read_arm_document;
use crate::catalog::Catalogs;
use crate::input::json::{Document, Faults};
use serde_json::Value;

/// A study to be searched.
pub struct Asked {
    /// The study as it was read, with the corrections that apply.
    pub study: Study,
    /// Text of the study's file.
    pub text: String,
    /// Corrections of a measured arm, both those that apply to the study and those that do not.
    pub corrections: Vec<Correction>,
}

impl Asked {
    /// A study as its file states it. `text` is the text of the file.
    pub fn as_stated(study: Study, text: String) -> Self {
        Self { corrections: left_out(&study), study, text }
    }

    /// A study with the effects and calibrated values of an arm file, such as the `arm.corrected.json` of a
    /// reconciliation. `text` is the text of the study's file.
    ///
    /// # Errors
    /// The arm file or the corrected study is faulty, or no effect and no calibrated value of the arm applies to the
    /// study.
    pub fn corrected_by(
        arm_file: Document,
        study: &Study,
        text: &str,
        catalogs: &Catalogs,
    ) -> Result<Self, Refusal> {
        let name = arm_file.file().to_string();
        let calibrated = calibrated(arm_file.root().value());
        let arm = read_arm_document(arm_file, catalogs)?;
        let asked = Self::corrected(study, text, &arm, &calibrated, catalogs)?;
        if asked.corrections.iter().any(|c| c.applied) {
            return Ok(asked);
        }
        let why = match asked.corrections.as_slice() {
            [] => "it has no effects; a reconciliation writes arm.corrected.json with those it finds".into(),
            none => {
                let lines = none.iter().map(|c| format!("\n  {}: {}", c.what, c.words));
                format!("none of its effects and calibrated values applies{}", lines.collect::<String>())
            }
        };
        Err(Refusal::Unknown(format!("{name} changes nothing in the study \"{}\": {why}", study.name)))
    }

    /// A study with the effects of `arm` and the calibrated values `calibrated` (name and factor each). `text` is the
    /// text of the study's file.
    ///
    /// # Errors
    /// The corrected study is faulty.
    pub(crate) fn corrected(
        study: &Study,
        text: &str,
        arm: &Arm,
        calibrated: &[(String, f64)],
        catalogs: &Catalogs,
    ) -> Result<Self, Faults> {
        let file = Document::parse(&study.name, text)?;
        let corrected = apply_corrections(file.root().value(), study, arm, calibrated);
        let text = format!("{:#}\n", corrected.file);
        let name = format!("{} with effects", study.name);
        let study = read_study(Document::parse(&name, &text)?, catalogs)?;
        Ok(Self { study, text, corrections: corrected.corrections })
    }
}

/// Name and factor of each calibrated value, from the provenance of an arm file.
fn calibrated(file: &Value) -> Vec<(String, f64)> {
    let list = file["provenance"]["calibrated"].as_array().map_or(&[][..], Vec::as_slice);
    list.iter().filter_map(|c| Some((c["value"].as_str()?.to_string(), c["factor"].as_f64()?))).collect()
}
