//! Applies the corrections of a measured arm to a study, and reports which of them apply. The corrections come from an
//! arm file or from a verdict.

use super::asked::Asked;
use super::failure::Failure;
use super::result_folder::complete;
use super::wrong_kind::refuse_other_kind;
use crate::arm::Arm;
use crate::arm::file::read_arm_document;
use crate::catalog::Catalogs;
use crate::input::json::Document;
use crate::report::whole_file::folder_of;
use crate::report::words::{TERMINAL, wrap};
use crate::study::definition::Study;
use crate::study::effects::{Correction, apply_corrections};
use crate::study::read::read_study;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;

/// A study with the corrections of the arm file at `path` applied. `text` is the text of the study's file.
///
/// # Errors
/// The file cannot be read, or no effect and no calibrated value of the arm file applies to the study.
pub(super) fn from_arm_file(
    path: &Path,
    study: &Study,
    text: &str,
    catalogs: &Catalogs,
) -> Result<Asked, Failure> {
    complete(&folder_of(path))?;
    refuse_other_kind(path, "arm")?;
    let name = path.display().to_string();
    let arm_text = fs_err::read_to_string(path).map_err(|e| Failure::File(e.to_string()))?;
    let arm = read_arm_document(Document::parse(&name, &arm_text)?, catalogs)?;
    let file: Value = serde_json::from_str(&arm_text).map_err(|e| Failure::File(format!("{name}: {e}")))?;
    let asked = corrected(study, text, &arm, &calibrated(&file), catalogs)?;
    if asked.corrections.iter().any(|c| c.applied) {
        return Ok(asked);
    }
    let why = match asked.corrections.as_slice() {
        [] => "it has no effects; `armwright reconcile` writes arm.corrected.json with those it finds".into(),
        _ => format!("none of its effects and calibrated values applies\n{}", to_text(&asked.corrections)),
    };
    Err(Failure::Usage(format!("{name} changes nothing in the study \"{}\": {why}", study.name)))
}

/// A study with the effects of `arm` and the calibrated values `calibrated` (name and factor each) applied. `text` is
/// the text of the study's file.
///
/// # Errors
/// The corrected study is faulty.
pub(super) fn corrected(
    study: &Study,
    text: &str,
    arm: &Arm,
    calibrated: &[(String, f64)],
    catalogs: &Catalogs,
) -> Result<Asked, Failure> {
    let file: Value = serde_json::from_str(text).map_err(|e| Failure::Internal(e.to_string()))?;
    let corrected = apply_corrections(&file, study, arm, calibrated);
    let text = format!("{:#}\n", corrected.file);
    let name = format!("{} with effects", study.name);
    let study = read_study(Document::parse(&name, &text)?, catalogs)?;
    Ok(Asked { study, text, corrections: corrected.corrections })
}

/// Name and factor of each calibrated value, from the provenance of an arm file.
fn calibrated(file: &Value) -> Vec<(String, f64)> {
    let list = file["provenance"]["calibrated"].as_array().map_or(&[][..], Vec::as_slice);
    list.iter().filter_map(|c| Some((c["value"].as_str()?.to_string(), c["factor"].as_f64()?))).collect()
}

/// A text that says which corrections were applied and which were not. Corrections with the same reason are in one
/// line. The text is empty if there are no corrections.
pub(super) fn to_text(corrections: &[Correction]) -> String {
    let mut out = String::new();
    for (applied, head) in [(true, "corrections applied"), (false, "corrections not applied")] {
        let mut lines: Vec<(&str, Vec<&str>)> = Vec::new();
        for c in corrections.iter().filter(|c| c.applied == applied) {
            match lines.iter_mut().find(|(words, _)| *words == c.words) {
                Some((_, what)) => what.push(&c.what),
                None => lines.push((&c.words, vec![&c.what])),
            }
        }
        if !lines.is_empty() {
            let _ = writeln!(out, "\n{head}:");
        }
        for (words, what) in lines {
            out.push_str(&wrap(&format!("{}: {words}", what.join(", ")), TERMINAL, "  "));
        }
    }
    out
}

/// The corrections as JSON: what each one is, whether it was applied, and why.
pub(super) fn to_json(corrections: &[Correction]) -> Value {
    corrections.iter().map(|c| json!({"what": c.what, "carried": c.applied, "words": c.words})).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lines_are_broken_and_indented_at_80_columns() {
        let left_out =
            |what: &str, words: &str| Correction { what: what.into(), applied: false, words: words.into() };
        let words = "the study chooses this joint's gear, so that what was measured of another gear says nothing of it";
        let text = to_text(&[left_out("j2.stiffness", words), left_out("j3.stiffness", words)]);
        assert!(text.lines().all(|l| l.chars().count() <= TERMINAL), "{text}");
        assert_eq!(text.matches("says nothing of it").count(), 1, "{text}");
        assert!(text.lines().skip(2).all(|l| l.starts_with("  ")), "{text}");
    }
}
