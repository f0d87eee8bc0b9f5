//! What a design is judged by.

/// What a design is judged by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Objectives {
    /// Largest displacement of the tip over the study's cases \[m\].
    pub tip_deflection_m: f64,
    /// Mass of all links and drives \[kg\].
    pub mass_kg: f64,
    /// Smallest first natural frequency over the cases \[Hz\].
    pub lowest_mode_hz: f64,
}

impl Objectives {
    /// Better by a factor in each.
    pub(crate) fn better_by(&self, factor: f64) -> Self {
        Self {
            tip_deflection_m: self.tip_deflection_m / factor,
            mass_kg: self.mass_kg / factor,
            lowest_mode_hz: self.lowest_mode_hz * factor,
        }
    }

    /// As three numbers to be made small.
    pub fn minimized(&self) -> [f64; 3] {
        [self.mass_kg, self.tip_deflection_m, -self.lowest_mode_hz]
    }
}
