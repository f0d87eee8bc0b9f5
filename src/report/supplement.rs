//! What goes with a front beyond its own table: a list, its words and its facts, in one shape for all of them.

use super::section::PageSection;
use serde_json::Value;

/// One addition to a result: designs near the front, ties, the front under scatter. Each part may be absent.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Supplement {
    /// Name and content of its file, beside `front.csv`.
    pub file: Option<(&'static str, Vec<u8>)>,
    /// Its section of `summary.md`.
    pub markdown: String,
    /// Its section of the page.
    pub section: Option<PageSection>,
    /// Its key in `run.json` and what stands there.
    pub run: Option<(&'static str, Value)>,
    /// Its paragraph for the terminal.
    pub terminal: String,
}

impl Supplement {
    /// A fact for `run.json` alone: there is nothing to list.
    pub fn fact(key: &'static str, value: Value) -> Self {
        Self { run: Some((key, value)), ..Self::default() }
    }
}
