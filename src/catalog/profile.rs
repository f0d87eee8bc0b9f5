//! Hollow profiles one can buy.

use super::Provenance;

/// Shape of a hollow profile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ProfileShape {
    /// Square tube.
    Square,
    /// Rectangular tube.
    Rectangular,
    /// Round tube.
    Round,
}

/// One hollow profile. Corner radii are kept for information; mechanics uses sharp corners.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Designation; unique within a material family.
    pub designation: String,
    /// Shape.
    pub shape: ProfileShape,
    /// `steel` or `aluminium`: the family of materials it is sold in.
    pub material_family: String,
    /// Outer width (diameter of a round tube) \[m\].
    pub width_m: f64,
    /// Outer height (diameter of a round tube) \[m\].
    pub height_m: f64,
    /// Wall thickness \[m\].
    pub wall_m: f64,
    /// Outer corner radius \[m\].
    pub corner_radius_m: Option<f64>,
    /// Printed cross-section area \[m²\].
    pub area_m2: Option<f64>,
    /// Printed second moment of area about the horizontal axis \[m⁴\].
    pub second_moment_m4: Option<f64>,
    /// Printed mass per length \[kg/m\].
    pub mass_per_length_kg_m: Option<f64>,
    /// Where the row comes from.
    pub provenance: Provenance,
}
