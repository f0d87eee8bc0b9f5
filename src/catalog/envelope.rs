//! The room a part takes: its outer size and the hollow through it.

/// Outer size of a part \[m\]. `None` is a figure the catalog does not give: that side is not checked.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Envelope {
    /// Outer diameter \[m\]; the side of a square flange.
    pub outer_diameter_m: Option<f64>,
    /// Length along the axis of rotation, without the shaft \[m\].
    pub length_m: Option<f64>,
    /// Diameter of the passage along the axis \[m\]; zero is a part without one.
    pub hollow_bore_m: Option<f64>,
}
