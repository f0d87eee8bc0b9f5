//! A local upper bound of a front. Every design that no design of the front dominates lies below at least one such
//! bound.

use super::bound::{IdealPoint, ROUNDING};
use super::modes::eigenvalue_of;

/// A local upper bound: a mass, a deflection and a frequency. A design is below it if its mass and its deflection are
/// at most, and its lowest mode is at least, these values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct UpperBound {
    pub mass_kg: f64,
    pub tip_m: f64,
    pub hz: f64,
}

impl UpperBound {
    /// The upper bound that excludes nothing: every design lies below it.
    pub(super) const OPEN: Self = Self { mass_kg: f64::INFINITY, tip_m: f64::INFINITY, hz: 0.0 };

    /// Whether a design with the mass and the deflection of the ideal point `ideal` can lie below this bound.
    pub(super) fn is_in_reach_of(&self, ideal: &IdealPoint) -> bool {
        let most = 1.0 + ROUNDING;
        ideal.mass_kg <= self.mass_kg * most && ideal.tip_m <= self.tip_m * most
    }

    /// Eigenvalue of the bound's frequency, `(2 π f)²` \[1/s²\].
    pub(super) fn eigenvalue(&self) -> f64 {
        eigenvalue_of(self.hz)
    }

    /// The smallest upper bound that covers this bound and `other`.
    pub(super) fn join(&self, other: &Self) -> Self {
        Self {
            mass_kg: self.mass_kg.max(other.mass_kg),
            tip_m: self.tip_m.max(other.tip_m),
            hz: self.hz.min(other.hz),
        }
    }

    /// Whether every design below this bound is also below the bound `other`.
    pub(super) fn is_within(&self, other: &Self) -> bool {
        self.mass_kg <= other.mass_kg && self.tip_m <= other.tip_m && self.hz >= other.hz
    }

    /// Whether `row`, the objectives of a design of the front, dominates a part of the region below this bound.
    pub(super) fn is_cut_by(&self, row: &UpperBound) -> bool {
        row.mass_kg < self.mass_kg && row.tip_m < self.tip_m && row.hz > self.hz
    }

    /// Three bounds that together cover what a design of the front leaves undominated below this bound. `row` are the
    /// objectives of this design. Each of the three limits one objective to the value that this design has.
    pub(super) fn left_by(&self, row: &UpperBound) -> [Self; 3] {
        [
            Self { mass_kg: row.mass_kg, ..*self },
            Self { tip_m: row.tip_m, ..*self },
            Self { hz: row.hz, ..*self },
        ]
    }

    pub(super) fn numbers(&self) -> [f64; 3] {
        [self.mass_kg, self.tip_m, self.hz]
    }
}
