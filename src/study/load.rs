//! Loads a study by its name or from its file, and refuses studies with nothing to choose from.

use super::definition::Study;
use super::diagnose::{empty_pieces, too_large};
use super::named::named;
use super::read::read_study;
use super::refusal::Refusal;
use crate::catalog::Catalogs;
use crate::input::json::{Document, InputError, read_text};
use std::path::Path;

/// The text of a study.
struct StudyText {
    /// Name of the study in messages.
    title: String,
    text: String,
}

/// The text of the study `name`, built in or from a file.
fn study_text(name: &str) -> Result<StudyText, Refusal> {
    if let Some(text) = named(name) {
        return Ok(StudyText { title: format!("{name} (built in)"), text: text.to_string() });
    }
    let path = Path::new(name);
    if crate::paper::names::NAMES.contains(&name) {
        let words = "is a study of the paper, which is computed without a search: `armwright run` has it, no other verb";
        return Err(Refusal::Unknown(format!("{name} {words}")));
    }
    match read_text(path) {
        Ok(text) => Ok(StudyText { title: name.to_string(), text }),
        Err(_) if !name.contains(['/', '.']) && !path.is_dir() => {
            let known = crate::study::names();
            let near = crate::input::json::closest(name, &known)
                .map_or(String::new(), |n| format!("; did you mean {n}?"));
            Err(Refusal::Unknown(format!("no study is called \"{name}\"{near}; known: {}", known.join(", "))))
        }
        Err(InputError::Faulty(faults)) => Err(Refusal::Faulty(faults)),
        Err(error) => Err(Refusal::Unreadable(error.to_string())),
    }
}

/// Reads a study by its name or from its file. Returns the study and its text.
///
/// # Errors
/// [`Refusal::Unknown`] if `name` is neither a built-in study nor a file, [`Refusal::Unreadable`] if the file cannot
/// be read, or [`Refusal::Faulty`] with all of its faults.
pub fn load_study(name: &str, catalogs: &Catalogs) -> Result<(Study, String), Refusal> {
    let StudyText { title, text } = study_text(name)?;
    Ok((read_study(Document::parse(&title, &text)?, catalogs)?, text))
}

/// Refuses a study that leaves values of springs or counterweights open, because its space has the first choice alone.
fn refuse_choices(study: &Study) -> Result<(), Refusal> {
    match study.balance_choices {
        1 => Ok(()),
        choices => Err(Refusal::Unknown(format!(
            "the study \"{}\" leaves {choices} choices of springs and counterweights open, which `armwright run` without \
             --shard searches one by one; here, state one value in place of each list, or give the study.json of one choice \
             from the folder of its results",
            study.name
        ))),
    }
}

/// Refuses a study in which some link or joint has nothing to choose from, which is too large, or which leaves values
/// of springs or counterweights open. It is called before designs are built.
///
/// # Errors
/// [`Refusal::EmptySpace`] with every link and joint without options; [`Refusal::Unknown`] with the limit on size
/// that is exceeded, or with the number of choices that are open.
pub fn refuse_empty(study: &Study, catalogs: &Catalogs) -> Result<(), Refusal> {
    refuse_choices(study)?;
    if let Some(why) = too_large(&study.space, catalogs) {
        return Err(Refusal::Unknown(format!("the study \"{}\": {why}", study.name)));
    }
    match empty_pieces(&study.space, catalogs).as_slice() {
        [] => Ok(()),
        pieces => Err(Refusal::EmptySpace(format!(
            "the study \"{}\" has nothing to choose from\n  {}",
            study.name,
            pieces.join("\n  ")
        ))),
    }
}
