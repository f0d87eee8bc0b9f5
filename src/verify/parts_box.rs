//! Boxes: sets of designs that have one set of options for each level.

use serde::{Deserialize, Serialize};

/// The piece whose part a level chooses. Joints and tubes are each counted from base to tip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Place {
    /// The level chooses the drive of this joint.
    Joint(usize),
    /// The level chooses the tube of this link.
    Tube(usize),
}

/// A box: for every level, tip first, the index of a node in the level's option tree. Its members are all designs
/// whose options are below these nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct PartsBox(pub(super) Vec<u32>);

/// Options of one level that no objective tells apart.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct Choice {
    /// Indices of the options. Those that pass their checks in spite of any rounding come first.
    pub options: Vec<u32>,
    /// Whether the first option passes its checks in spite of any rounding.
    pub one_holds: bool,
}

/// A design, or several that no objective tells apart: the options at each level, tip first.
pub(super) type Design = Vec<Choice>;
