//! The limits that every design must meet.

use crate::pareto::objectives::Objectives;

/// Limits that every design must meet. `None` stands for no limit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Constraints {
    /// Largest allowed tip deflection \[m\].
    pub tip_deflection_max_m: Option<f64>,
    /// Largest allowed mass \[kg\].
    pub mass_max_kg: Option<f64>,
    /// Smallest allowed lowest mode \[Hz\].
    pub lowest_mode_min_hz: Option<f64>,
    /// Servo loop with whose bandwidth the lowest mode is compared.
    pub servo: Option<Servo>,
    /// Smallest ratio of strength to stress in the links at peak load.
    pub stress_safety_factor_min: Option<f64>,
    /// Largest ratio of flat width (or diameter) to wall thickness. It protects the walls from local buckling.
    pub wall_slenderness_max: Option<f64>,
    /// Largest cost of the material of the links \[EUR\]. If this limit is set, a material of unknown cost is
    /// refused.
    pub material_cost_max_eur: Option<f64>,
}

/// A servo loop. The lowest mode must be at least `ratio` times its bandwidth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Servo {
    /// Bandwidth of the servo loop \[Hz\].
    pub bandwidth_hz: f64,
    /// Smallest allowed ratio of the lowest mode to the bandwidth.
    pub ratio: f64,
}

impl Constraints {
    /// Whether the objectives `o` of a design break the limits on deflection, on mass and on the lowest mode, in this
    /// order.
    pub fn broken(&self, o: &Objectives) -> [bool; 3] {
        [
            self.tip_deflection_max_m.is_some_and(|max| o.tip_deflection_m > max),
            self.mass_max_kg.is_some_and(|max| o.mass_kg > max),
            o.lowest_mode_hz < self.required_mode_hz(),
        ]
    }

    /// The smallest lowest mode that a design may have \[Hz\]: the larger of the stated limit and the limit from the
    /// servo loop.
    pub fn required_mode_hz(&self) -> f64 {
        let servo = self.servo.map_or(0.0, |s| s.bandwidth_hz * s.ratio);
        self.lowest_mode_min_hz.unwrap_or(0.0).max(servo)
    }
}
