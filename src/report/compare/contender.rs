//! Contenders: the fronts of a comparison.

use crate::report::front_table::FrontTable;

/// A front that takes part in a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct Contender {
    /// Name of the material or of the result to which the front belongs.
    pub label: String,
    /// Designs of the front.
    pub front: FrontTable,
    /// Whether the front is only a reference and cannot win. This is the front of all materials mixed.
    pub reference: bool,
}

impl Contender {
    /// A front that can win.
    pub fn new(label: &str, front: FrontTable) -> Self {
        Self { label: label.to_string(), front, reference: false }
    }
}
