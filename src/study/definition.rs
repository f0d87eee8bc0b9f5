//! What a study is.

use crate::space::design_space::DesignSpace;

/// A study: a named question about an arm.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// Name.
    pub name: String,
    /// The question in a sentence.
    pub question: String,
    /// What may be chosen, and what the arm must do.
    pub space: DesignSpace,
    /// An exact search ends when for every design of the study some listed one is worse by at most this fraction in each
    /// objective.
    pub gap: f64,
    /// Options left out because a rating that a check needs is unknown, in words.
    pub not_checked: Vec<String>,
    /// What a reader of the result should know of the question, in sentences.
    pub remarks: Vec<String>,
}
