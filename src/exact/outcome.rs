//! The result of an exact search.

use crate::search::sweep::Candidate;
use serde::{Deserialize, Serialize};

/// The result of an exact search: the front, and how far it is proved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ExactOutcome {
    /// Number of designs in the space.
    pub designs_total: u128,
    /// Number of designs whose three objectives were computed one by one.
    pub designs_evaluated: u64,
    /// Number of boxes whose bound was computed.
    pub boxes: u64,
    /// Number of boxes or regions that were still open when the search was stopped. It is 0 if the front is
    /// certified.
    pub boxes_open: u64,
    /// Gap of the front: for every design of the space, some design of the front is worse by at most this fraction in
    /// each objective. After a complete search it is the gap that was asked for, 0 for the whole front. `None` if
    /// nothing is proved.
    pub gap: Option<f64>,
    /// The designs found that no other design dominates.
    pub front: Vec<Candidate>,
    /// Whether the front lists all ties, that is, every design that differs from another only in drives of equal mass
    /// and curve. `false` if there are too many; then one design of each set of ties is listed.
    pub ties_listed: bool,
}
