//! Settings that decide when the verifier searches box by box and when region by region.

/// Settings of the search for missing designs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// A space of more designs than this is searched region by region.
    pub regions_from: u128,
    /// A region is searched box by box as soon as it has at most this many designs.
    pub boxes_to: f64,
    /// Relative step of the grid on which the front is thinned before regions are computed: only one of the designs in
    /// each cell of the grid is used. With a step of 0 all designs are used.
    pub apart: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { regions_from: 100_000_000_000_000, boxes_to: 1e5, apart: 0.0 }
    }
}
