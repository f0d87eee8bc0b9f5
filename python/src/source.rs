//! Where an arm, cases or a study come from: a file, a name, or the text of a Python object.

use crate::errors;
use armwright::arm::{ARM_FILE, Arm, read_arm_document};
use armwright::catalog::Catalogs;
use armwright::input::{Document, Fault, Faults, FileKind, Kind, read_text};
use armwright::study::{STUDY_FILE, Study, is_arm_file, load_study, names, read_study};
use pyo3::prelude::*;
use std::path::Path;

/// A name or path, or the text of a Python object with the name it has in messages.
#[derive(FromPyObject)]
pub(crate) struct Source(String, Option<String>);

impl Source {
    /// The JSON document.
    pub(crate) fn document(&self) -> PyResult<Document> {
        match &self.1 {
            Some(text) => Document::parse(&self.0, text).map_err(errors::faults),
            None => Document::read(Path::new(&self.0)).map_err(errors::input),
        }
    }

    /// The arm of a file or text.
    pub(crate) fn arm(&self, catalogs: &Catalogs) -> PyResult<Arm> {
        read_arm_document(self.arm_document()?, catalogs).map_err(errors::faults)
    }

    /// The document of an arm file, and not of a study.
    pub(crate) fn arm_document(&self) -> PyResult<Document> {
        let document = self.document()?;
        if is_rather(&document, &STUDY_FILE, &ARM_FILE) {
            let hint = "run, size and capacity take it; front.arm(id) is the arm of a design that was found";
            return Err(other_kind(&document, "a study, and an arm is asked for", hint));
        }
        Ok(document)
    }

    /// Whether this is an arm file, and no study.
    pub(crate) fn is_arm(&self) -> bool {
        self.document().is_ok_and(|document| is_arm_file(&document))
    }

    /// The file of this name in the folder of this file, if it is there.
    pub(crate) fn beside(&self, name: &str) -> Option<Self> {
        let path = self.1.is_none().then(|| Path::new(&self.0).with_file_name(name))?;
        path.is_file().then(|| Self(path.to_string_lossy().into_owned(), None))
    }

    /// The name or path.
    pub(crate) fn name(&self) -> &str {
        &self.0
    }

    /// The text of the file.
    pub(crate) fn text(&self) -> PyResult<String> {
        match &self.1 {
            Some(text) => Ok(text.clone()),
            None => read_text(Path::new(&self.0)).map_err(errors::input),
        }
    }

    /// The study of a name, file or text, and its text.
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

/// The one fault of a document of another kind.
fn other_kind(document: &Document, words: &str, hint: &str) -> PyErr {
    errors::faults(Faults(vec![Fault {
        file: document.file().to_string(),
        line: None,
        field: String::new(),
        problem: format!("is {words}"),
        hint: hint.into(),
    }]))
}
