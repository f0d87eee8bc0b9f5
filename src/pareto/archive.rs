//! Archive: a table that rejects dominated designs within a few nanoseconds.
//!
//! The table is over mass and deflection. Each cell stores the highest lowest mode among the designs entered so far
//! whose mass and deflection are at most those of the cell. Both scales divide each octave (factor of two) into equal
//! steps, which are the leading bits of a floating-point number. The map from numbers to steps is monotone and exact,
//! and needs no logarithm.
//!
//! A design is entered at the next grid point above its mass and deflection. It is looked up at the next grid point
//! below them. Its frequency is rounded down on entry. The table therefore rejects a design only if another one
//! dominates it. Designs that it lets through are filtered exactly later, so the result does not depend on the
//! order of entries.

use super::objectives::Objectives;
use std::sync::atomic::{AtomicU32, Ordering};

/// Range of masses in powers of two: 8 g to 131 t. Nothing outside of the range is rejected.
const MASS_OCTAVES: (i32, i32) = (-7, 17);
/// Range of deflections in powers of two: 0.1 um to 16 m.
const DEFLECTION_OCTAVES: (i32, i32) = (-23, 4);
/// Smallest relative difference between the lowest modes of a rejected design and of the design that dominates it.
/// It is far above the rounding errors of the search's fast model, from which the numbers of the table come.
const MODE_MARGIN: f64 = 1e-5;

/// The table of best frequencies. All threads share it.
pub(crate) struct Archive {
    /// Number of leading mantissa bits that determine the cell of a number.
    bits: u32,
    columns: usize,
    /// Best frequency of each cell \[Hz\], as the bits of an `f32`. Positive floats are ordered like their bits.
    best_hz: Vec<AtomicU32>,
}

impl Archive {
    /// An empty table with `2^bits` steps in each octave.
    pub(crate) fn new(bits: u32) -> Self {
        let cells = |(low, high): (i32, i32)| ((high - low) as usize) << bits;
        let columns = cells(DEFLECTION_OCTAVES);
        let all = cells(MASS_OCTAVES) * columns;
        Self { bits, columns, best_hz: (0..all).map(|_| AtomicU32::new(0)).collect() }
    }

    /// Whether a design that was entered before surely dominates a design with the objectives `o`.
    #[inline]
    pub(crate) fn rejects(&self, o: &Objectives) -> bool {
        self.bar_hz(o.mass_kg, o.tip_deflection_m) > o.lowest_mode_hz
    }

    /// The bar \[Hz\]. A design of this mass and deflection whose lowest mode is below the bar is surely dominated
    /// by a design that was entered before. The bar is 0 if no such design was entered.
    #[inline]
    pub(crate) fn bar_hz(&self, mass_kg: f64, tip_deflection_m: f64) -> f64 {
        let (row, column) = (
            self.corner(mass_kg, MASS_OCTAVES, Corner::Below),
            self.corner(tip_deflection_m, DEFLECTION_OCTAVES, Corner::Below),
        );
        let (Some(row), Some(column)) = (row, column) else { return 0.0 };
        let best = f32::from_bits(self.best_hz[row * self.columns + column].load(Ordering::Relaxed));
        f64::from(best) * (1.0 - MODE_MARGIN)
    }

    /// Enters a design. If two threads write one cell at the same time, the better entry may be lost. The table
    /// then rejects fewer designs than it could, but never more.
    pub(crate) fn enter(&self, o: &Objectives) {
        let (row, column) = (
            self.corner(o.mass_kg, MASS_OCTAVES, Corner::Above),
            self.corner(o.tip_deflection_m, DEFLECTION_OCTAVES, Corner::Above),
        );
        let (Some(row), Some(column)) = (row, column) else { return };
        let hz = round_down(o.lowest_mode_hz);
        // If a cell has as high a mode already, all cells of larger mass and deflection have one too, and none of them
        // changes.
        for cells in self.best_hz.chunks(self.columns).skip(row) {
            let worse = |cell: &&AtomicU32| cell.load(Ordering::Relaxed) < hz;
            let mut entered = false;
            for cell in cells[column..].iter().take_while(worse) {
                cell.store(hz, Ordering::Relaxed);
                entered = true;
            }
            if !entered {
                return;
            }
        }
    }

    /// The index of the grid step next to the positive number `x`. With `Corner::Below` it is the step at or below `x`,
    /// with `Corner::Above` the step at or above it. `low` and `high` are the ends of the scale in powers of two.
    /// `None` if `x` is outside of the scale.
    #[inline]
    fn corner(&self, x: f64, (low, high): (i32, i32), side: Corner) -> Option<usize> {
        let shift = f64::MANTISSA_DIGITS - 1 - self.bits;
        let up = match side {
            Corner::Below => 0,
            Corner::Above => (1u64 << shift) - 1,
        };
        let step = |octave: i32| ((1023 + octave) as u64) << self.bits;
        let place = (x.to_bits() + up) >> shift;
        (x >= 0.0 && place >= step(low) && place < step(high)).then(|| (place - step(low)) as usize)
    }
}

/// The direction in which a design's mass and deflection are rounded to a step of the scale.
#[derive(Clone, Copy)]
enum Corner {
    Below,
    Above,
}

/// The bits of the largest `f32` that is not above a positive number. The bits of positive numbers, read as
/// integers, are in the same order as the numbers.
fn round_down(x: f64) -> u32 {
    let near = x as f32;
    let bits = near.to_bits();
    if f64::from(near) > x { bits - 1 } else { bits }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn design(mass_kg: f64, tip_deflection_m: f64, lowest_mode_hz: f64) -> Objectives {
        Objectives { tip_deflection_m, mass_kg, lowest_mode_hz }
    }

    #[test]
    fn it_rejects_only_what_an_entry_beats() {
        let archive = Archive::new(6);
        archive.enter(&design(50.0, 1e-3, 15.0));
        assert!(archive.rejects(&design(60.0, 1.2e-3, 14.9)));
        assert!(!archive.rejects(&design(60.0, 1.2e-3, 15.1)));
        assert!(!archive.rejects(&design(49.0, 1.2e-3, 14.0)));
        assert!(!archive.rejects(&design(50.0, 1e-3, 15.0)));
    }

    #[test]
    fn later_entries_only_add() {
        let archive = Archive::new(2);
        archive.enter(&design(50.0, 1e-3, 15.0));
        archive.enter(&design(20.0, 1e-4, 12.0));
        assert!(archive.rejects(&design(90.0, 1e-2, 14.0)));
        assert!(archive.rejects(&design(30.0, 3e-4, 11.0)));
        assert!(!archive.rejects(&design(30.0, 3e-4, 13.0)));
    }
}
