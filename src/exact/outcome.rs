//! The result of an exact search.

use crate::search::sweep::Candidate;
use serde::{Deserialize, Serialize};

/// The findings of one shard, the part of a space that one process searches. Of designs that differ only in drives of
/// equal mass, torsion curve and bearing stiffness (ties), it has one.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct FoundInShard {
    /// The subtrees of the space that were searched. A subtree is named by the halves that lead to it from the box of
    /// all designs, such as `0110`. The name of the box of all designs is empty.
    pub subtrees: Vec<String>,
    /// Number of designs whose three objectives were computed.
    pub designs_evaluated: u64,
    /// Number of boxes bounded.
    pub boxes: u64,
    /// Number of boxes or regions that were still open when the search was stopped.
    pub boxes_open: u64,
    /// The gap that was proved for the designs of the subtrees (relative); `None` if no gap was proved.
    pub gap: Option<f64>,
    /// The designs found that no other of them dominates.
    pub decided: Vec<Candidate>,
    /// Designs for which rounding leaves open whether a part carries its demand. The full model judges them.
    pub undecided: Vec<Candidate>,
}

/// The result of the search.
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
    /// Whether the front lists all ties, that is, every design that differs from another only in drives of equal mass,
    /// torsion curve and bearing stiffness. `false` if there are too many; then one design of each set of ties is
    /// listed.
    pub ties_listed: bool,
}
