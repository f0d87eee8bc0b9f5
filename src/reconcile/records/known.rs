//! Rows of a record at which torque or friction is not known, and which enter no fit of the twist.
//!
//! - While a joint rests, friction may hold any torque up to that of Coulomb friction.
//! - While it reverses, friction changes its sign somewhere, and no formula says where.
//! - Where the torque jumps between two rows, its average over a window is uncertain by the jump times half a row. A
//!   motion that is planned with corners, such as a trapezoid of the speed, has such jumps. All of them are at the same
//!   place between the rows, because the controller begins each piece at one of its cycles. The error then has one sign
//!   and does not average out.

use crate::reconcile::fit::stats::{MEDIAN_OF_NORMAL, median};

/// A joint rests at rows where the magnitude of the smoothed sign of its speed stays below this for longer than the
/// window of the torque. At a reversal it stays below this for about half of the window.
const RESTING: f64 = 0.5;
/// A rest ends where the magnitude of the smoothed sign of the speed reaches this again.
const MOVING: f64 = 0.98;
/// Rows at rest are left out only where at least this fraction of the record's rows is left.
const LEAST_MOVING_PART: f64 = 0.2;
/// A joint reverses at rows where the magnitude of the smoothed sign of its speed differs from one by more than this.
/// The smoothed sign changes slowly there and friction does not, so with these rows Coulomb friction would come out too
/// large.
pub(super) const TURNING: f64 = 0.05;
/// Rows of reversals are left out only where at least this fraction of the moving rows is left.
const LEAST_KNOWN_PART: f64 = 0.6;
/// Rows at jumps are left out only where at least this fraction of the rows is left. A planned motion has few jumps. A
/// torque that jumps in more rows is noisy; its jumps have both signs and average out.
const LEAST_STEADY_PART: f64 = 0.85;
/// The torque jumps where a step from row to row differs from the mean of the steps before and after it by more than
/// this many standard deviations of such differences. The standard deviation is estimated from their median.
const JUMP: f64 = 6.0;
/// A jump below this fraction of the standard deviation of the torque is left in the fit.
const LEAST_JUMP_PART: f64 = 0.02;

/// Whether the joint rests, row by row. Friction is not known while the joint rests: it may hold any torque of either
/// sign, up to that of Coulomb friction, whatever the sign of the speed is. `sense` is the smoothed sign of the speed,
/// and `half` the half width of its window \[rows\]. A reversal is no rest. Nothing rests in a record that hardly
/// moves.
pub(super) fn rests(sense: &[f64], half: usize) -> Vec<bool> {
    let mut out = vec![false; sense.len()];
    let mut row = 0;
    while row < sense.len() {
        // a value near an end or a gap is NaN and compares as neither
        let run = sense[row..].iter().take_while(|s| s.abs() < RESTING).count();
        if run > 2 * half + 1 {
            // the smoothed sign differs from the sign up to half a window before and after the rest
            let before = sense[..row].iter().rev().take_while(|s| s.abs() < MOVING).count().max(half);
            let after = sense[row + run..].iter().take_while(|s| s.abs() < MOVING).count().max(half);
            let end = (row + run + after).min(sense.len());
            out[row.saturating_sub(before)..end].fill(true);
        }
        row += run.max(1);
    }
    let moving = out.iter().filter(|rests| !**rests).count();
    if (moving as f64) < LEAST_MOVING_PART * sense.len() as f64 { vec![false; sense.len()] } else { out }
}

/// Whether the joint reverses, row by row; `rests` tells at which rows it rests. No row if too few would be left.
pub(super) fn turning(sense: &[f64], rests: &[bool]) -> Vec<bool> {
    let turns = |s: &f64| (s.abs() - 1.0).abs() > TURNING;
    let moves = |s: &f64, rests: &bool| !*rests && !s.is_nan();
    let moving = sense.iter().zip(rests).filter(|(s, rests)| moves(s, rests));
    let (left, all) =
        moving.fold((0usize, 0usize), |(left, all), (s, _)| (left + usize::from(!turns(s)), all + 1));
    match (left as f64) < LEAST_KNOWN_PART * all as f64 {
        true => vec![false; sense.len()],
        false => sense.iter().map(turns).collect(),
    }
}

/// Whether the window of a row, `half` rows to either side, has a jump of the torque. No row if too few would be left.
pub(super) fn at_jumps(torque_nm: &[f64], half: usize) -> Vec<bool> {
    let mut out = vec![false; torque_nm.len()];
    let excess: Vec<f64> =
        torque_nm.windows(4).map(|t| (t[2] - t[1]) - 0.5 * ((t[1] - t[0]) + (t[3] - t[2]))).collect();
    let usual_nm = median(excess.iter().map(|e| e.abs()).collect()) / MEDIAN_OF_NORMAL;
    let least_nm = (JUMP * usual_nm).max(LEAST_JUMP_PART * deviation(torque_nm));
    for (i, _) in excess.iter().enumerate().filter(|(_, e)| e.abs() > least_nm) {
        // between the rows i + 1 and i + 2; the slope of the average reaches one row further
        let end = (i + half + 4).min(out.len());
        out[i.saturating_sub(half)..end].fill(true);
    }
    let left = out.iter().filter(|jumps| !**jumps).count();
    if (left as f64) < LEAST_STEADY_PART * out.len() as f64 { vec![false; out.len()] } else { out }
}

/// Standard deviation of a signal, in its unit.
fn deviation(x: &[f64]) -> f64 {
    let count = x.len().max(1) as f64;
    let mean = x.iter().sum::<f64>() / count;
    (x.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jump_of_the_torque_leaves_out_the_windows_that_have_it() {
        let torque: Vec<f64> =
            (0..400).map(|i| libm::sin(0.02 * i as f64) + if i >= 200 { 0.5 } else { 0.0 }).collect();
        let out = at_jumps(&torque, 8);
        // the step is between the rows 199 and 200
        assert!(out[190..210].iter().all(|jumps| *jumps), "{out:?}");
        assert!(!out[180..188].contains(&true) && !out[212..220].contains(&true));
        let smooth: Vec<f64> = (0..400).map(|i| libm::sin(0.02 * i as f64)).collect();
        assert!(!at_jumps(&smooth, 8).contains(&true));
    }

    #[test]
    fn a_record_that_only_reverses_keeps_its_rows() {
        let rests = vec![false; 100];
        let fast: Vec<f64> = (0..100).map(|i| if i < 90 { 1.0 } else { 0.3 }).collect();
        assert_eq!(turning(&fast, &rests).iter().filter(|turns| **turns).count(), 10);
        assert!(!turning(&[0.5; 100], &rests).contains(&true));
    }
}
