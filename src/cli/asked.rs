//! The study that a verb is asked for, read from its text, with the corrections of a measured arm.

use super::failure::Failure;
use crate::catalog::Catalogs;
use crate::input::json::Document;
use crate::study::definition::Study;
use crate::study::diagnose::{empty_pieces, too_large};
use crate::study::effects::Correction;
use crate::study::named;
use crate::study::read::read_study;
use std::path::Path;

/// A study to be searched.
pub(super) struct Asked {
    /// The study.
    pub study: Study,
    /// Its file's text.
    pub text: String,
    /// The corrections of a measured arm: which apply to the study and which do not.
    pub corrections: Vec<Correction>,
}

/// The text of a study and the name it goes by in messages.
pub(super) fn study_text(name: &str) -> Result<(String, String), Failure> {
    if let Some(text) = named(name) {
        return Ok((format!("{name} (built in)"), text.to_string()));
    }
    let path = Path::new(name);
    match fs_err::read_to_string(path) {
        Ok(text) => Ok((name.to_string(), text)),
        Err(_) if !name.contains(['/', '.']) => {
            let known = crate::study::names();
            let near = crate::input::json::closest(name, &known)
                .map_or(String::new(), |n| format!("; did you mean {n}?"));
            Err(Failure::Usage(format!("no study is called \"{name}\"{near}; known: {}", known.join(", "))))
        }
        Err(error) => Err(Failure::File(error.to_string())),
    }
}

/// Reads a study by name or file.
pub(super) fn load_study(name: &str, catalogs: &Catalogs) -> Result<(Study, String), Failure> {
    let (file, text) = study_text(name)?;
    Ok((read_study(Document::parse(&file, &text)?, catalogs)?, text))
}

/// Refuses a study with nothing to choose from at some link or joint, or with too much. Every verb that builds designs asks
/// here.
///
/// # Errors
/// [`Failure::EmptySpace`] with every such link and joint; [`Failure::Usage`] with the limit that is exceeded.
pub(super) fn refuse_empty(study: &Study, catalogs: &Catalogs) -> Result<(), Failure> {
    if let Some(why) = too_large(&study.space, catalogs) {
        return Err(Failure::Usage(format!("the study \"{}\": {why}", study.name)));
    }
    match empty_pieces(&study.space, catalogs).as_slice() {
        [] => Ok(()),
        pieces => Err(Failure::EmptySpace(format!(
            "the study \"{}\" has nothing to choose from\n  {}",
            study.name,
            pieces.join("\n  ")
        ))),
    }
}
