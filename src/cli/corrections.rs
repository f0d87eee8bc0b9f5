//! A measured arm's corrections in a study: read from an arm file, and said in words.

use super::asked::Asked;
use super::failure::Failure;
use crate::arm::Arm;
use crate::arm::file::read_arm_document;
use crate::catalog::Catalogs;
use crate::input::json::Document;
use crate::report::words::wrap;
use crate::study::definition::Study;
use crate::study::effects::{Carried, carry_over};
use crate::study::read::read_study;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;

/// Width of the terminal's text.
const COLUMNS: usize = 80;

/// A study with what carries over to it from an arm file.
///
/// # Errors
/// The file cannot be read, or nothing of it carries over.
pub(super) fn from_arm_file(
    path: &Path,
    study: &Study,
    text: &str,
    catalogs: &Catalogs,
) -> Result<Asked, Failure> {
    let name = path.display().to_string();
    let arm_text = fs_err::read_to_string(path).map_err(|e| Failure::File(e.to_string()))?;
    let arm = read_arm_document(Document::parse(&name, &arm_text)?, catalogs)?;
    let file: Value = serde_json::from_str(&arm_text).map_err(|e| Failure::File(format!("{name}: {e}")))?;
    let asked = corrected(study, text, &arm, &calibrated(&file), catalogs)?;
    if asked.carried.iter().any(|c| c.carried) {
        return Ok(asked);
    }
    let why = match asked.carried.as_slice() {
        [] => "it has no effects; `armwright reconcile` writes arm.corrected.json with those it finds".into(),
        _ => format!("nothing of it carries over\n{}", to_text(&asked.carried)),
    };
    Err(Failure::Usage(format!("{name} changes nothing in the study \"{}\": {why}", study.name)))
}

/// A study with what carries over to it from a measured arm and its calibrated values.
///
/// # Errors
/// The corrected study does not read.
pub(super) fn corrected(
    study: &Study,
    text: &str,
    arm: &Arm,
    calibrated: &[(String, f64)],
    catalogs: &Catalogs,
) -> Result<Asked, Failure> {
    let file: Value = serde_json::from_str(text).map_err(|e| Failure::Internal(e.to_string()))?;
    let corrected = carry_over(&file, study, arm, calibrated);
    let text = format!("{:#}\n", corrected.file);
    let name = format!("{} with effects", study.name);
    let study = read_study(Document::parse(&name, &text)?, catalogs)?;
    Ok(Asked { study, text, carried: corrected.carried })
}

/// Name and factor of the values that the provenance of an arm file says were calibrated.
fn calibrated(file: &Value) -> Vec<(String, f64)> {
    let list = file["provenance"]["calibrated"].as_array().map_or(&[][..], Vec::as_slice);
    list.iter().filter_map(|c| Some((c["value"].as_str()?.to_string(), c["factor"].as_f64()?))).collect()
}

/// What carries over and what does not, a line a reason; empty if there is nothing to say.
pub(super) fn to_text(carried: &[Carried]) -> String {
    let mut out = String::new();
    for (taken, head) in [(true, "carried over"), (false, "not carried over")] {
        let mut lines: Vec<(&str, Vec<&str>)> = Vec::new();
        for c in carried.iter().filter(|c| c.carried == taken) {
            match lines.iter_mut().find(|(words, _)| *words == c.words) {
                Some((_, what)) => what.push(&c.what),
                None => lines.push((&c.words, vec![&c.what])),
            }
        }
        if !lines.is_empty() {
            let _ = writeln!(out, "\n{head}:");
        }
        for (words, what) in lines {
            out.push_str(&wrap(&format!("{}: {words}", what.join(", ")), COLUMNS, "  "));
        }
    }
    out
}

/// The same for programs.
pub(super) fn to_json(carried: &[Carried]) -> Value {
    carried.iter().map(|c| json!({"what": c.what, "carried": c.carried, "words": c.words})).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lines_are_broken_and_indented_at_80_columns() {
        let carried =
            |what: &str, words: &str| Carried { what: what.into(), carried: false, words: words.into() };
        let words = "the study chooses this joint's gear, so that what was measured of another gear says nothing of it";
        let text = to_text(&[carried("j2.stiffness", words), carried("j3.stiffness", words)]);
        assert!(text.lines().all(|l| l.chars().count() <= COLUMNS), "{text}");
        assert_eq!(text.matches("says nothing of it").count(), 1, "{text}");
        assert!(text.lines().skip(2).all(|l| l.starts_with("  ")), "{text}");
    }
}
