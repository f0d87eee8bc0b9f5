//! Hollow profiles one can buy.

use super::Provenance;
use std::fmt;

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

impl ProfileShape {
    /// Words of the column `shape`.
    pub const WORDS: [&'static str; 3] = ["square", "rectangular", "round"];

    /// The shape a word means.
    pub fn from_word(word: &str) -> Option<Self> {
        let shapes = [ProfileShape::Square, ProfileShape::Rectangular, ProfileShape::Round];
        Self::WORDS.iter().position(|w| w.eq_ignore_ascii_case(word)).map(|place| shapes[place])
    }
}

impl fmt::Display for ProfileShape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(Self::WORDS[*self as usize])
    }
}

impl Profile {
    /// Words of the column `material_family`. `steel` is structural steel; stainless steel is sold in other
    /// sizes and is a family of its own.
    pub const MATERIAL_FAMILIES: [&'static str; 5] =
        ["steel", "aluminium", "titanium", "composite", "stainless"];
}

/// One hollow profile. Corner radii are kept for information; mechanics uses sharp corners.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Designation; unique within a material family.
    pub designation: String,
    /// Shape.
    pub shape: ProfileShape,
    /// One of [`Self::MATERIAL_FAMILIES`]: the family of materials it is sold in.
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
