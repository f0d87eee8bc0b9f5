//! The three objectives of a design.

use serde::{Deserialize, Serialize};

/// The three objectives by which a design is judged.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Objectives {
    /// Tip deflection: the largest displacement of the tip over the judged cases \[m\].
    pub tip_deflection_m: f64,
    /// Mass of all links and drives \[kg\].
    pub mass_kg: f64,
    /// Lowest mode: the smallest natural frequency over the judged cases \[Hz\].
    pub lowest_mode_hz: f64,
}

/// One of the objectives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Objective {
    /// Tip deflection; smaller is better.
    TipDeflection,
    /// Mass; smaller is better.
    Mass,
    /// Lowest mode; higher is better.
    LowestMode,
}

impl Objective {
    /// The objective as a positive number to be minimized: deflection \[m\], mass \[kg\], or period \[s\] of the lowest
    /// mode.
    pub fn cost(self, o: &Objectives) -> f64 {
        match self {
            Self::TipDeflection => o.tip_deflection_m,
            Self::Mass => o.mass_kg,
            Self::LowestMode => o.lowest_mode_hz.recip(),
        }
    }
}

impl Objectives {
    /// The objectives of a hypothetical design that is better in all three by `factor`: mass and deflection divided by
    /// it, lowest mode multiplied by it.
    pub(crate) fn better_by(&self, factor: f64) -> Self {
        Self {
            tip_deflection_m: self.tip_deflection_m / factor,
            mass_kg: self.mass_kg / factor,
            lowest_mode_hz: self.lowest_mode_hz * factor,
        }
    }

    /// The objectives as three numbers to be minimized: mass, deflection, negative mode.
    pub fn minimized(&self) -> [f64; 3] {
        [self.mass_kg, self.tip_deflection_m, -self.lowest_mode_hz]
    }
}
