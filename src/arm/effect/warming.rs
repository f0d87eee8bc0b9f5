//! Warming: change of the moduli of the links while an arm is tested, with its temperature or with the order of the
//! tests.

/// When a reading was taken, as row and temperature.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Moment {
    /// Row of the reading in its file, counted from 0.
    pub row: usize,
    /// Temperature of the arm \[°C\], if it was measured.
    pub temperature_c: Option<f64>,
}

/// Temperature at which moduli have their nominal values \[°C\].
pub(crate) const DRAWN_AT_C: f64 = 20.0;
/// Smallest factor on a modulus. It keeps moduli positive when a change is extrapolated far beyond its readings.
const LEAST: f64 = 0.05;

/// How the moduli of all links change in the course of the tests.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Warming {
    /// Change of the factor on the moduli per kelvin of temperature \[1/K\].
    pub per_k: f64,
    /// Change of the factor on the moduli that is approached after many rows; 0 means no change with the order of the
    /// tests.
    pub change: f64,
    /// Number of rows after which 63 % of `change` is reached.
    pub rows: f64,
}

impl Default for Warming {
    fn default() -> Self {
        Self { per_k: 0.0, change: 0.0, rows: 1.0 }
    }
}

impl Warming {
    /// Whether the moduli stay the same during all tests.
    pub fn is_none(&self) -> bool {
        self.per_k == 0.0 && self.change == 0.0
    }

    /// Factor on Young's modulus and the shear modulus at the time of a reading.
    pub fn factor(&self, when: &Moment) -> f64 {
        let warmer_k = when.temperature_c.map_or(0.0, |c| c - DRAWN_AT_C);
        let done = 1.0 - libm::exp(-(when.row as f64) / self.rows);
        (1.0 + self.per_k * warmer_k + self.change * done).max(LEAST)
    }
}
