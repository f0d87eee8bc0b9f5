//! The definition of a study.

use crate::space::design_space::DesignSpace;

/// A study: a named question about an arm.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// Name of the study.
    pub name: String,
    /// The question of the study in one sentence.
    pub question: String,
    /// The choices that the study leaves open, and the requirements on the arm.
    pub space: DesignSpace,
    /// The gap at which an exact search may end: for every design of the study, some listed design is worse by at
    /// most this fraction in each objective.
    pub gap: f64,
    /// Indices of the cases whose pose states a payload of its own.
    pub own_payloads: Vec<usize>,
    /// Number of choices of springs and counterweights that the study leaves open; 1 if it states one value for each
    /// number. The space has the first choice. [`balance_choices`](super::balance_choices) lists all of them.
    pub balance_choices: usize,
    /// Messages on options that were left out because a rating that a check needs is blank.
    pub not_checked: Vec<String>,
    /// Remarks on the question that a reader of the result should know, as sentences.
    pub remarks: Vec<String>,
}
