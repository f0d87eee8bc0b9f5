//! Link materials.

use super::Provenance;
use std::fmt;

/// Classes of materials, as in the column `class`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MaterialClass {
    /// Metals and alloys.
    Metal,
    /// Fibre composites with a polymer matrix.
    Composite,
    /// Metal-matrix composites.
    MetalMatrix,
    /// Polymers, including printed and filled polymers.
    Polymer,
    /// Wood and wood products.
    Wood,
    /// Any other material.
    Other,
}

impl MaterialClass {
    /// Words of the column `class`.
    pub const WORDS: [&'static str; 7] =
        ["metal", "composite", "metal-matrix", "polymer", "wood", "other", "MMC"];

    /// The class that a word means; `None` if it is not one of [`Self::WORDS`]. `MMC` and `metal-matrix` mean the same.
    pub fn from_word(word: &str) -> Option<Self> {
        use MaterialClass::{Composite, Metal, MetalMatrix, Other, Polymer, Wood};
        let classes = [Metal, Composite, MetalMatrix, Polymer, Wood, Other, MetalMatrix];
        Self::WORDS.iter().position(|w| w.eq_ignore_ascii_case(word)).map(|place| classes[place])
    }

    /// A warning about time-dependent behaviour under constant load, which the model leaves out. `None` for classes
    /// without such behaviour at room temperature.
    pub fn caution(self) -> Option<&'static str> {
        match self {
            MaterialClass::Metal | MaterialClass::Composite | MaterialClass::MetalMatrix => None,
            MaterialClass::Polymer => Some(
                "it creeps, and its modulus falls with time under load and with temperature (of a printed part also with \
                 direction and infill)",
            ),
            MaterialClass::Wood => Some(
                "it creeps, and its modulus depends on time under load, on moisture and on the direction of the grain",
            ),
            MaterialClass::Other => Some("it may creep, and its modulus may depend on time under load"),
        }
    }
}

impl fmt::Display for MaterialClass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(Self::WORDS[*self as usize])
    }
}

/// One material. `None` means that the catalog does not give the number.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Name of the material, which is unique in the catalog.
    pub name: String,
    /// Class of the material.
    pub class: MaterialClass,
    /// Young's modulus along the link \[Pa\].
    pub youngs_modulus_pa: f64,
    /// Shear modulus \[Pa\]; for unidirectional composites it is G12, the shear modulus along and across the fibres;
    /// `None` if unknown.
    pub shear_modulus_pa: Option<f64>,
    /// Density \[kg/m³\].
    pub density_kg_m3: f64,
    /// Poisson's ratio; `None` if unknown.
    pub poisson: Option<f64>,
    /// Yield strength of a metal, or tensile strength of a composite \[Pa\]; `None` if unknown.
    pub strength_pa: Option<f64>,
    /// Compressive strength along the link \[Pa\]; `None` if it equals the tensile strength or is unknown.
    pub compressive_strength_pa: Option<f64>,
    /// Shear strength of a link that is twisted \[Pa\]; for unidirectional composites it is the in-plane shear strength of
    /// a layer; `None` if unknown. In an isotropic material it follows from `strength_pa`.
    pub shear_strength_pa: Option<f64>,
    /// Kind of strength that `strength_pa` states.
    pub strength_kind: String,
    /// Cost of the raw material \[EUR/kg\]; `None` if unknown.
    pub cost_eur_per_kg: Option<f64>,
    /// Behaviour in sea water and in air, in words.
    pub corrosion_note: String,
    /// Whether all fibres run along the link. The torsion and shear properties are then the properties of a single
    /// layer of fibres.
    pub unidirectional: bool,
    /// Source of the row.
    pub provenance: Provenance,
}

/// Shear modulus G = E/2(1+ν) \[Pa\] of an isotropic material with this Young's modulus \[Pa\] and Poisson's ratio.
pub(crate) fn isotropic_shear_modulus_pa(youngs_modulus_pa: f64, poisson: f64) -> f64 {
    youngs_modulus_pa / (2.0 * (1.0 + poisson))
}
