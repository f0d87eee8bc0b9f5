//! Hollow profiles that can be bought.

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

    /// The shape that a word means; `None` if it is not one of [`Self::WORDS`].
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
    /// Words of the column `material_family`. `steel` is structural steel. Stainless steel is a family of its own,
    /// because it is sold in other sizes.
    pub const MATERIAL_FAMILIES: [&'static str; 5] =
        ["steel", "aluminium", "titanium", "composite", "stainless"];
}

/// One hollow profile. The mechanics takes its edges as sharp; the radii are stored for information only.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Designation, which is unique within a material family.
    pub designation: String,
    /// Shape of the profile.
    pub shape: ProfileShape,
    /// Family of materials in which the profile is sold: one of [`Self::MATERIAL_FAMILIES`].
    pub material_family: String,
    /// Outer width \[m\]; for a round tube, the diameter.
    pub width_m: f64,
    /// Outer height \[m\]; for a round tube, the diameter.
    pub height_m: f64,
    /// Wall thickness \[m\].
    pub wall_m: f64,
    /// Outer corner radius \[m\]; `None` if it is unknown.
    pub corner_radius_m: Option<f64>,
    /// Cross-section area as printed \[m²\]; `None` if it is unknown.
    pub area_m2: Option<f64>,
    /// Second moment of area about the horizontal axis as printed \[m⁴\]; `None` if it is unknown.
    pub second_moment_m4: Option<f64>,
    /// Mass per length as printed \[kg/m\]; `None` if it is unknown.
    pub mass_per_length_kg_m: Option<f64>,
    /// Source of the row.
    pub provenance: Provenance,
}
