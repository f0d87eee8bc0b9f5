//! A set of designs: one set of options for each level.

/// The piece that a level chooses, base to tip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Place {
    /// A joint's drive.
    Joint(usize),
    /// A link's tube.
    Tube(usize),
}

/// A box: a node of every level's tree, tip first. Its members are all designs whose options are below these nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct PartsBox(pub(super) Vec<u32>);

/// Options of one level that no objective tells apart.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Choice {
    /// Their numbers, those first that hold whatever rounding does.
    pub options: Vec<u32>,
    /// Whether the first is one.
    pub one_holds: bool,
}

/// A design, or those that no objective tells apart: what each level may be, tip first.
pub(super) type Design = Vec<Choice>;
