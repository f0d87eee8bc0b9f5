//! The form that all additions to a front have: a file, a section, facts.

use super::section::PageSection;
use serde_json::Value;

/// One addition to a result: near designs, ties, the front under scatter. Each part of it may be absent.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Supplement {
    /// Name and content of the file that is written next to `front.csv`; `None` if there is no file.
    pub file: Option<(&'static str, Vec<u8>)>,
    /// The section of `summary.md`. It is empty if there is none.
    pub markdown: String,
    /// The section of the page; `None` if the page has none.
    pub section: Option<PageSection>,
    /// Key and value that are added to `run.json`; `None` if nothing is added.
    pub run: Option<(&'static str, Value)>,
    /// The paragraph for the terminal. It is empty if there is none.
    pub terminal: String,
}

impl Supplement {
    /// An addition that consists of one entry of `run.json` and nothing else.
    pub fn fact(key: &'static str, value: Value) -> Self {
        Self { run: Some((key, value)), ..Self::default() }
    }
}
