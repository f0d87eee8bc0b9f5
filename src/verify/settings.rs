//! When the verifier goes from box to box, and when from region to region.

/// How to look for missing designs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// A space of more designs than this is searched region by region.
    pub regions_from: u128,
    /// A region with no more designs left than this is searched box by box.
    pub boxes_to: f64,
    /// Designs of the front that are closer to each other than this (relative) may stand for each other.
    pub apart: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { regions_from: 100_000_000_000_000, boxes_to: 1e5, apart: 0.0 }
    }
}
