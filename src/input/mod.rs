//! Input: reading of JSON documents and tables. Every fault is recorded with its file, line, field and a hint.

pub(crate) mod csv;
pub(crate) mod duplicates;
pub(crate) mod encoding;
pub(crate) mod json;
pub(crate) mod key;
pub(crate) mod lines;
pub(crate) mod magnitude;
pub(crate) mod names;
pub(crate) mod path;
pub(crate) mod schema;
pub(crate) mod texts;

pub use json::*;
pub use key::{Key, Kind, Rule, Shape};
pub use schema::FileKind;
