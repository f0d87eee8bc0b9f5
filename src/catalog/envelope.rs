//! The space that a part takes: its outer size and the bore through it.

/// Outer size of a part \[m\]. `None` means that the catalog does not give the size, which is then not checked.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Envelope {
    /// Outer diameter \[m\]; for a square flange, the length of its side; `None` if unknown.
    pub outer_diameter_m: Option<f64>,
    /// Length along the axis of rotation, without the shaft \[m\]; `None` if unknown.
    pub length_m: Option<f64>,
    /// Diameter of the passage along the axis \[m\]; zero if the part has none; `None` if unknown.
    pub hollow_bore_m: Option<f64>,
}
