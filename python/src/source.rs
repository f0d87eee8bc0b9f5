//! Where the input of a call comes from, such as an arm, cases or a study: a file, a name, or the text of a Python
//! object.

use crate::errors;
use armwright::arm::{ARM_FILE, Arm, read_arm_document};
use armwright::catalog::Catalogs;
use armwright::input::{Document, Fault, Faults, FileKind, Kind, read_text};
use armwright::study::{STUDY_FILE, Study, is_arm_file, load_study, names, read_study};
use pyo3::prelude::*;
use std::path::Path;

/// An input of a call. The first value is a name or a path, and the second is `None`. For a Python object, the second
/// value is its text, and the first is the name that messages use for it.
#[derive(FromPyObject)]
pub(crate) struct Source(String, Option<String>);

impl Source {
    /// Reads the input as a JSON document.
    pub(crate) fn document(&self) -> PyResult<Document> {
        match &self.1 {
            Some(text) => Document::parse(&self.0, text).map_err(errors::faults),
            None => Document::read(Path::new(&self.0)).map_err(errors::input),
        }
    }

    /// Reads the input as an arm.
    pub(crate) fn arm(&self, catalogs: &Catalogs) -> PyResult<Arm> {
        read_arm_document(self.arm_document()?, catalogs).map_err(errors::faults)
    }

    /// Reads the input as the JSON document of an arm. A study is an error with a hint.
    pub(crate) fn arm_document(&self) -> PyResult<Document> {
        let document = self.document()?;
        if is_rather(&document, &STUDY_FILE, &ARM_FILE) {
            let hint = "run, size and capacity take it; front.arm(id) is the arm of a design that was found";
            return Err(other_kind(&document, "a study, and an arm is asked for", hint));
        }
        Ok(document)
    }

    /// Whether the input is an arm and not a study. `false` if it cannot be read.
    pub(crate) fn is_arm(&self) -> bool {
        self.document().is_ok_and(|document| is_arm_file(&document))
    }

    /// The file with the name `name` in the folder of this file. `None` if there is no such file, or if the input is no
    /// file.
    pub(crate) fn beside(&self, name: &str) -> Option<Self> {
        let path = self.1.is_none().then(|| Path::new(&self.0).with_file_name(name))?;
        path.is_file().then(|| Self(path.to_string_lossy().into_owned(), None))
    }

    /// The name or path of the input, for messages.
    pub(crate) fn name(&self) -> &str {
        &self.0
    }

    /// The text of the input.
    pub(crate) fn text(&self) -> PyResult<String> {
        match &self.1 {
            Some(text) => Ok(text.clone()),
            None => read_text(Path::new(&self.0)).map_err(errors::input),
        }
    }

    /// Reads the input as a study: one that is built in by its name, or a file, or a text. Returns the study and its
    /// text. An arm is an error with a hint.
    pub(crate) fn study(&self, catalogs: &Catalogs) -> PyResult<(Study, String)> {
        let is_named = self.1.is_none() && names().contains(&self.0.as_str());
        if !is_named
            && let Ok(document) = self.document()
            && is_rather(&document, &ARM_FILE, &STUDY_FILE)
        {
            let hint = "analyze and capacity take it";
            return Err(other_kind(&document, "an arm, and a study is asked for", hint));
        }
        match &self.1 {
            Some(text) => {
                let study = read_study(self.document()?, catalogs).map_err(errors::faults)?;
                Ok((study, text.clone()))
            }
            None => load_study(&self.0, catalogs).map_err(errors::refused),
        }
    }
}

/// Whether a document has more keys of files of the kind `other` than of the kind `asked`.
fn is_rather(document: &Document, other: &FileKind, asked: &FileKind) -> bool {
    let root = document.root();
    let keys_of = |kind: &FileKind| match kind.root {
        Kind::Object(shape) => shape.keys.iter().filter(|key| root.value().get(key.name).is_some()).count(),
        _ => 0,
    };
    keys_of(other) > keys_of(asked)
}

/// An `InputError` for a document of another kind than the one that is needed. `words` say what it is.
fn other_kind(document: &Document, words: &str, hint: &str) -> PyErr {
    errors::faults(Faults(vec![Fault {
        file: document.file().to_string(),
        line: None,
        field: String::new(),
        problem: format!("is {words}"),
        hint: hint.into(),
    }]))
}
