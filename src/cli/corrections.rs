//! Applies the corrections of a measured arm to a study, and reports which of them apply. The corrections come from an
//! arm file or from a verdict.

use super::failure::Failure;
use super::result_folder::complete;
use super::wrong_kind::refuse_other_kind;
use crate::catalog::Catalogs;
use crate::input::json::Document;
use crate::report::whole_file::folder_of;
use crate::report::words::{TERMINAL, wrap};
use crate::study::asked::Asked;
use crate::study::definition::Study;
use crate::study::effects::Correction;
use std::fmt::Write;
use std::path::Path;

/// A study with the corrections of the arm file at `path` applied. `text` is the text of the study's file.
///
/// # Errors
/// The arm file cannot be read or is faulty, its folder is being written, or the corrected study is faulty. It is also
/// an error if no effect and no calibrated value of the arm file applies to the study.
pub(super) fn from_arm_file(
    path: &Path,
    study: &Study,
    text: &str,
    catalogs: &Catalogs,
) -> Result<Asked, Failure> {
    complete(&folder_of(path))?;
    refuse_other_kind(path, "arm")?;
    Ok(Asked::corrected_by(Document::read(path)?, study, text, catalogs)?)
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
