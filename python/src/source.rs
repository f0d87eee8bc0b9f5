//! Where an arm, cases or a study come from: a file, a name, or the text of a Python object.

use crate::errors;
use armwright::arm::{Arm, read_arm_document};
use armwright::catalog::Catalogs;
use armwright::input::Document;
use armwright::study::{Study, load_study, read_study};
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
        read_arm_document(self.document()?, catalogs).map_err(errors::faults)
    }

    /// The study of a name, file or text.
    pub(crate) fn study(&self, catalogs: &Catalogs) -> PyResult<Study> {
        match &self.1 {
            Some(_) => read_study(self.document()?, catalogs).map_err(errors::faults),
            None => load_study(&self.0, catalogs).map(|(study, _)| study).map_err(errors::refused),
        }
    }
}
