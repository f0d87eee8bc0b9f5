//! Files as they come in: JSON documents and tables, every fault kept with file, line, field and hint.

pub(crate) mod csv;
pub(crate) mod duplicates;
pub(crate) mod json;
pub(crate) mod lines;
pub(crate) mod path;

pub use json::*;
