//! Rejecting dominated designs in a few nanoseconds while millions of them stream by.
//!
//! A table over mass and deflection, both on a scale that halves each octave into equal steps (the
//! leading bits of the floating-point number: monotone, exact, and no logarithm), holds the best
//! frequency found so far at or below each cell. A design is entered at the next corner up and looked up
//! at the next corner down, its frequency rounded down on entry, so that the table never claims too
//! much: it only rejects designs that another one beats. What it lets through is filtered exactly later,
//! so the outcome does not depend on the order of entries.

use super::objectives::Objectives;
use std::sync::atomic::{AtomicU32, Ordering};

/// Range of the table in powers of two, outside of which nothing is rejected: 8 g to 131 t, 0.1 um to
/// 16 m.
const MASS_OCTAVES: (i32, i32) = (-7, 17);
const DEFLECTION_OCTAVES: (i32, i32) = (-23, 4);
/// A rejected design is slower than its rival by at least this part.
const MARGIN: f64 = 1e-5;

/// The table, shared by all threads.
pub struct Archive {
    /// Leading bits of the fraction that tell cells apart.
    bits: u32,
    columns: usize,
    best_hz: Vec<AtomicU32>,
}

impl Archive {
    /// A table of `2^bits` steps an octave.
    pub fn new(bits: u32) -> Self {
        let cells = |(low, high): (i32, i32)| ((high - low) as usize) << bits;
        let columns = cells(DEFLECTION_OCTAVES);
        let all = cells(MASS_OCTAVES) * columns;
        Self { bits, columns, best_hz: (0..all).map(|_| AtomicU32::new(0)).collect() }
    }

    /// Whether some design entered before is surely better.
    #[inline]
    pub fn rejects(&self, o: &Objectives) -> bool {
        self.bar_hz(o.mass_kg, o.tip_deflection_m) > o.lowest_mode_hz
    }

    /// The lowest mode \[Hz\] below which a design of this mass and deflection is surely beaten by one entered before.
    #[inline]
    pub fn bar_hz(&self, mass_kg: f64, tip_deflection_m: f64) -> f64 {
        let (row, column) = (
            self.corner(mass_kg, MASS_OCTAVES, Corner::Below),
            self.corner(tip_deflection_m, DEFLECTION_OCTAVES, Corner::Below),
        );
        let (Some(row), Some(column)) = (row, column) else { return 0.0 };
        let best = f32::from_bits(self.best_hz[row * self.columns + column].load(Ordering::Relaxed));
        f64::from(best) * (1.0 - MARGIN)
    }

    /// Enters a design. Two threads that write one cell at once may lose the better of the two; the table
    /// then rejects less than it could, never more.
    pub fn enter(&self, o: &Objectives) {
        let (row, column) = (
            self.corner(o.mass_kg, MASS_OCTAVES, Corner::Above),
            self.corner(o.tip_deflection_m, DEFLECTION_OCTAVES, Corner::Above),
        );
        let (Some(row), Some(column)) = (row, column) else { return };
        let hz = round_down(o.lowest_mode_hz);
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

    /// The step at or below, or at or above, a positive number.
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

/// Which corner of a cell.
#[derive(Clone, Copy)]
enum Corner {
    Below,
    Above,
}

/// The bits of the largest `f32` not above a positive number; their order is that of the numbers.
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
