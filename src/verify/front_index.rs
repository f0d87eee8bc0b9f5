//! An index of a front that tells up to which frequency a design of known mass and deflection is dominated.

use crate::pareto::objectives::Objectives;

/// Relative difference up to which two values of an objective count as equal.
const EQUAL_WITHIN: f64 = 1e-9;
/// Relative margin by which a design of the front must be better in at least one objective to dominate a design or a
/// whole box of designs. With this margin, rounding cannot decide.
const BETTER_BY: f64 = 1e-7;

/// The designs of a front, sorted by mass, in a form in which the highest frequency among the designs up to a given
/// mass and deflection is found quickly. `blocks` is a Fenwick tree with positions counted from 1. The block at
/// position `i` consists of the last `i & -i` designs up to the `i`-th. It lists their deflections in ascending order.
/// Each deflection is stored with the highest frequency among the designs of the block that deflect at most as far.
pub(super) struct FrontIndex {
    masses_kg: Vec<f64>,
    blocks: Vec<Vec<(f64, f64)>>,
}

impl FrontIndex {
    /// Builds the index of a front's designs.
    pub(super) fn new(front: &[Objectives]) -> Self {
        let mut rows = front.to_vec();
        rows.sort_by(|a, b| a.mass_kg.total_cmp(&b.mass_kg));
        let block = |end: usize| {
            let size = end & end.wrapping_neg();
            let mut block: Vec<(f64, f64)> =
                rows[end - size..end].iter().map(|r| (r.tip_deflection_m, r.lowest_mode_hz)).collect();
            block.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut highest = 0.0f64;
            for (_, hz) in &mut block {
                highest = highest.max(*hz);
                *hz = highest;
            }
            block
        };
        Self {
            masses_kg: rows.iter().map(|row| row.mass_kg).collect(),
            blocks: (1..=rows.len()).map(block).collect(),
        }
    }

    /// Highest frequency \[Hz\] among the designs of the front with at most this mass and at most this deflection;
    /// zero if there is none.
    fn highest_hz(&self, mass_kg: f64, tip_m: f64) -> f64 {
        let mut end = self.masses_kg.partition_point(|row| *row <= mass_kg);
        let mut highest = 0.0f64;
        while end > 0 {
            let block = &self.blocks[end - 1];
            let below = block.partition_point(|(row, _)| *row <= tip_m);
            highest = highest.max(below.checked_sub(1).map_or(0.0, |last| block[last].1));
            end &= end - 1;
        }
        highest
    }

    /// Highest frequency \[Hz\] up to which a design of this mass and this deflection is dominated by a design of the
    /// front. The dominating design is no worse in all three objectives, with ties counted in its favour, and better in
    /// one. Zero if the design is dominated at no frequency.
    pub(super) fn beaten_up_to_hz(&self, mass_kg: f64, tip_m: f64) -> f64 {
        let lighter = self.highest_hz(mass_kg * (1.0 - BETTER_BY), tip_m * (1.0 + EQUAL_WITHIN));
        let stiffer = self.highest_hz(mass_kg * (1.0 + EQUAL_WITHIN), tip_m * (1.0 - BETTER_BY));
        let as_good = self.highest_hz(mass_kg * (1.0 + EQUAL_WITHIN), tip_m * (1.0 + EQUAL_WITHIN));
        (lighter.max(stiffer) * (1.0 + EQUAL_WITHIN)).max(as_good * (1.0 - BETTER_BY))
    }

    /// Whether some design of the front dominates `design`.
    pub(super) fn beats(&self, design: &Objectives) -> bool {
        design.lowest_mode_hz <= self.beaten_up_to_hz(design.mass_kg, design.tip_deflection_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(count: u32) -> Vec<Objectives> {
        let number = |i: u32, factor: u32| f64::from(i * factor % 31) + 1.0;
        (0..count)
            .map(|i| Objectives {
                mass_kg: number(i, 7),
                tip_deflection_m: number(i, 11),
                lowest_mode_hz: number(i, 17),
            })
            .collect()
    }

    #[test]
    fn the_highest_frequency_is_that_of_a_look_at_every_row() {
        for count in [0, 1, 2, 7, 8, 30] {
            let rows = rows(count);
            let front_index = FrontIndex::new(&rows);
            for (mass_kg, tip_m) in (0..34).flat_map(|m| (0..34).map(move |t| (f64::from(m), f64::from(t)))) {
                let no_worse = rows.iter().filter(|r| r.mass_kg <= mass_kg && r.tip_deflection_m <= tip_m);
                let highest = no_worse.map(|r| r.lowest_mode_hz).fold(0.0, f64::max);
                assert_eq!(front_index.highest_hz(mass_kg, tip_m), highest, "{count} {mass_kg} {tip_m}");
            }
        }
    }

    #[test]
    fn a_row_does_not_beat_its_equal_but_what_is_a_little_worse() {
        let row = Objectives { mass_kg: 20.0, tip_deflection_m: 1e-3, lowest_mode_hz: 9.0 };
        let front_index = FrontIndex::new(&[row]);
        assert!(!front_index.beats(&row));
        let tie = 1.0 - 5e-10;
        assert!(!front_index.beats(&Objectives { mass_kg: 20.0 * tie, ..row }));
        assert!(front_index.beats(&Objectives { mass_kg: 20.0 * tie, lowest_mode_hz: 8.99, ..row }));
        assert!(!front_index.beats(&Objectives { mass_kg: 19.99, lowest_mode_hz: 8.99, ..row }));
        assert!(front_index.beats(&Objectives { tip_deflection_m: 1.001e-3, ..row }));
    }
}
