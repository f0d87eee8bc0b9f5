//! Rejecting dominated designs in a few nanoseconds while millions of them stream by.
//!
//! A table over (log mass, log deflection) holds the best frequency found so far at or below each
//! cell. A design is entered at the next corner up and looked up at the next corner down, its
//! frequency rounded down on entry, so that the table never claims too much: it only rejects designs
//! that another one beats. What it lets through is filtered exactly later, so the outcome does not
//! depend on the order of entries.

use super::Objectives;
use std::sync::atomic::{AtomicU32, Ordering};

/// Range of the table, outside of which nothing is rejected.
const MASS_KG: (f64, f64) = (1e-2, 1e5);
const DEFLECTION_M: (f64, f64) = (1e-7, 1e1);
/// A rejected design is slower than its rival by at least this part.
const MARGIN: f64 = 1e-5;

/// The table, shared by all threads.
pub struct Archive {
    cells: usize,
    best_hz: Vec<AtomicU32>,
}

impl Archive {
    /// A table of `cells` x `cells`.
    pub fn new(cells: usize) -> Self {
        Self { cells, best_hz: (0..cells * cells).map(|_| AtomicU32::new(0)).collect() }
    }

    /// Whether some design entered before is surely better.
    #[inline]
    pub fn rejects(&self, o: &Objectives) -> bool {
        let (Some(row), Some(column)) = (self.row(o).0, self.column(o).0) else { return false };
        let best = f32::from_bits(self.best_hz[row * self.cells + column].load(Ordering::Relaxed));
        f64::from(best) > o.lowest_mode_hz * (1.0 + MARGIN)
    }

    /// Enters a design.
    pub fn enter(&self, o: &Objectives) {
        let (Some(row), Some(column)) = (self.row(o).1, self.column(o).1) else { return };
        let hz = round_down(o.lowest_mode_hz);
        for r in row..self.cells {
            for (c, cell) in self.best_hz[r * self.cells..(r + 1) * self.cells][column..].iter().enumerate() {
                if cell.fetch_max(hz, Ordering::Relaxed) >= hz {
                    if c == 0 {
                        return;
                    }
                    break;
                }
            }
        }
    }

    fn row(&self, o: &Objectives) -> (Option<usize>, Option<usize>) {
        self.corners(o.mass_kg, MASS_KG)
    }

    fn column(&self, o: &Objectives) -> (Option<usize>, Option<usize>) {
        self.corners(o.tip_deflection_m, DEFLECTION_M)
    }

    /// The corners at or below and at or above a value.
    fn corners(&self, x: f64, (low, high): (f64, f64)) -> (Option<usize>, Option<usize>) {
        let place = (x / low).ln() / (high / low).ln() * self.cells as f64;
        let inside = |p: f64| (p >= 0.0 && p < self.cells as f64).then_some(p as usize);
        (inside((place - 1e-9).floor()), inside((place + 1e-9).ceil()))
    }
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
        let archive = Archive::new(512);
        archive.enter(&design(50.0, 1e-3, 15.0));
        assert!(archive.rejects(&design(60.0, 1.2e-3, 14.9)));
        assert!(!archive.rejects(&design(60.0, 1.2e-3, 15.1)));
        assert!(!archive.rejects(&design(49.0, 1.2e-3, 14.0)));
        assert!(!archive.rejects(&design(50.0, 1e-3, 15.0)));
    }

    #[test]
    fn later_entries_only_add() {
        let archive = Archive::new(64);
        archive.enter(&design(50.0, 1e-3, 15.0));
        archive.enter(&design(20.0, 1e-4, 12.0));
        assert!(archive.rejects(&design(90.0, 1e-2, 14.0)));
        assert!(archive.rejects(&design(30.0, 3e-4, 11.0)));
        assert!(!archive.rejects(&design(30.0, 3e-4, 13.0)));
    }
}
