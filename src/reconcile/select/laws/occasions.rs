//! The occasion of a reading: when it was taken, after which loads, in which pose and at which temperature.

use crate::arm::effect::channel::Channel;
use crate::arm::effect::warming::DRAWN_AT_C;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::readings::campaign::Campaign;
use crate::reconcile::readings::rows::StaticRow;

/// The occasion of one reading.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Occasion {
    /// Fraction of the rows of the file that were taken before this reading.
    pub part: f64,
    /// Number of rows of the same pose that stand directly before this reading.
    pub rows_in_pose: usize,
    /// Whether the load was being taken off.
    pub is_unloading: bool,
    /// Temperature above the one for which the arm was drawn \[K\]; `None` if it was not measured.
    pub warmer_k: Option<f64>,
}

/// The occasion of every reading, in the order of the data.
pub(super) fn occasions(campaign: &Campaign, forward: &Forward) -> Vec<Occasion> {
    let warmer_k = |temperature_c: Option<f64>| temperature_c.map(|c| c - DRAWN_AT_C);
    let (rows, modal, bench) = (&campaign.statics, &campaign.modal, &campaign.windup);
    let kept = rows_in_pose(rows.iter().map(|row| row.pose_deg.as_slice()));
    let is_unloading = unloading(rows, &kept);
    let of = |(i, datum): (usize, &crate::reconcile::forward::datum::Datum)| match datum.channel {
        Channel::Static => Occasion {
            part: part(datum.index, rows.len()),
            rows_in_pose: kept[datum.index],
            is_unloading: is_unloading[datum.index],
            warmer_k: warmer_k(rows[datum.index].temperature_c),
        },
        Channel::Modal => {
            let row = i - forward.starts[1];
            let warmer_k = warmer_k(modal[row].temperature_c);
            Occasion { part: part(row, modal.len()), warmer_k, ..Occasion::default() }
        }
        _ => {
            let is_unloading = bench[i - forward.starts[2]].branch == "unloading";
            Occasion { is_unloading, ..Occasion::default() }
        }
    };
    forward.data.iter().enumerate().map(of).collect()
}

/// Fraction of the `count` rows of a file that were taken before the row with the index `row`.
pub(super) fn part(row: usize, count: usize) -> f64 {
    row as f64 / count as f64
}

/// For each row, how many rows with the same pose stand directly before it.
fn rows_in_pose<'a>(poses: impl Iterator<Item = &'a [f64]>) -> Vec<usize> {
    let mut last: Option<(&[f64], usize)> = None;
    poses
        .map(|pose| {
            let count = last.filter(|(before, _)| *before == pose).map_or(0, |(_, count)| count + 1);
            last = Some((pose, count));
            count
        })
        .collect()
}

/// For each row, whether the load was being taken off: as the file says or, where no row of it says so, by whether the
/// row before in the same pose had a larger load. `kept` are the rows of the same pose that stand directly before.
fn unloading(rows: &[StaticRow], kept: &[usize]) -> Vec<bool> {
    if rows.iter().any(|row| row.branch == "unloading") {
        return rows.iter().map(|row| row.branch == "unloading").collect();
    }
    let load = |row: &StaticRow| (row.payload.mass_kg, row.force_n.norm());
    let is_less = |now: (f64, f64), before: (f64, f64)| {
        now.0 <= before.0 && now.1 <= before.1 * (1.0 + 1e-9) && now != before
    };
    (0..rows.len()).map(|r| kept[r] > 0 && is_less(load(&rows[r]), load(&rows[r - 1]))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_one_pose_are_counted_from_its_first_row() {
        let poses: [&[f64]; 6] = [&[0.0], &[0.0], &[0.0], &[1.0], &[0.0], &[0.0]];
        assert_eq!(rows_in_pose(poses.into_iter()), [0, 1, 2, 0, 0, 1]);
    }
}
