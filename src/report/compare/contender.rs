//! A front that takes part in a comparison.

use crate::report::front_table::FrontTable;

/// A front that takes part in a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct Contender {
    /// Name of the material or of the result.
    pub label: String,
    /// Its designs.
    pub front: FrontTable,
    /// Whether it is only a reference and cannot win: the front of all materials mixed.
    pub reference: bool,
}

impl Contender {
    /// A front that competes.
    pub fn new(label: &str, front: FrontTable) -> Self {
        Self { label: label.to_string(), front, reference: false }
    }
}
