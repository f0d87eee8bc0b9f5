//! What a study is.

use crate::space::design_space::DesignSpace;

/// A study: a named question about an arm.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// Name.
    pub name: String,
    /// The question in a sentence.
    pub question: String,
    /// What there is to choose and what it is asked to do.
    pub space: DesignSpace,
    /// By what part in all three objectives at once a design may beat every one listed when an exact search is content.
    pub gap: f64,
    /// Options left out because a figure that a check needs is unknown, in words.
    pub not_checked: Vec<String>,
}
