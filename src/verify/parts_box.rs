//! A set of designs: one set of options for each level.

use serde::{Deserialize, Serialize};

/// The piece whose part a level chooses. Joints and tubes are each counted from base to tip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Place {
    /// A joint's drive.
    Joint(usize),
    /// A link's tube.
    Tube(usize),
}

/// A box: for every level, tip first, a node of the level's tree. Its members are all designs whose options are below
/// these nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct PartsBox(pub(super) Vec<u32>);

/// Options of one level that no objective tells apart.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct Choice {
    /// Numbers of the options. Those that hold whatever rounding does come first.
    pub options: Vec<u32>,
    /// Whether the first option surely holds.
    pub one_holds: bool,
}

/// A design, or several that no objective tells apart: the choice at each level, tip first.
pub(super) type Design = Vec<Choice>;
