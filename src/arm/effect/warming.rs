//! Warming: how the moduli of the links change while an arm is tested, with its temperature or with the order of the
//! tests, and how joints soften with the order of the tests.

/// When a reading was taken, as row and temperature.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Moment {
    /// Row of the reading in its file, counted from 0.
    pub row: usize,
    /// Temperature of the arm \[°C\]; `None` if it was not measured.
    pub temperature_c: Option<f64>,
}

/// Temperature at which moduli have their nominal values \[°C\].
pub(crate) const DRAWN_AT_C: f64 = 20.0;
/// Smallest factor on a modulus or a compliance. A law that is extrapolated far beyond its readings must not make the
/// factor zero or negative.
const LEAST_FACTOR: f64 = 0.05;

/// How the compliance of a joint changes in the course of the tests of one channel: a gear warms up, bolts work loose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Softening {
    /// Change of the factor on the compliance that is approached after many rows; positive if the joint becomes softer.
    pub change: f64,
    /// Number of rows after which 63 % of this change is reached.
    pub rows: f64,
    /// Fraction of the change reached by a row that is already present when the reference of its displacement is read: 1
    /// if the reference is read just before the displacement, 0 if it was read before all tests.
    pub reference: f64,
}

impl Softening {
    /// Factor on the compliance of the joint in a row of the channel's file, counted from 0.
    pub fn factor(&self, row: usize) -> f64 {
        (1.0 + self.change * done(row, self.rows)).max(LEAST_FACTOR)
    }

    /// Factor on the compliance of the joint when the reference of the displacement in row `row` was read.
    pub fn reference_factor(&self, row: usize) -> f64 {
        (1.0 + self.change * self.reference * done(row, self.rows)).max(LEAST_FACTOR)
    }
}

/// Part of a change that is reached in the row `row`, if 63 % of the change is reached after `rows` rows.
fn done(row: usize, rows: f64) -> f64 {
    1.0 - libm::exp(-(row as f64) / rows)
}

/// How the moduli of all links change.
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
        (1.0 + self.per_k * warmer_k + self.change * done(when.row, self.rows)).max(LEAST_FACTOR)
    }
}
