//! Rows of a record at which torque or friction is not known. These rows enter no fit of the twist.
//!
//! - While a joint rests, friction may have any torque up to that of Coulomb friction.
//! - While a joint reverses, friction changes its sign at a moment that is not known.
//! - Where the torque jumps between two rows, its average over a window is uncertain by the jump times half a row. Such
//!   jumps occur where a planned motion has corners, for example where a trapezoid of the speed begins to slow down.
//!   They all lie at the same place between two rows, because the controller begins each piece of the motion at one of
//!   its cycles. The error then has the same sign at all jumps and does not average out.

use crate::reconcile::fit::stats::{MEDIAN_OF_NORMAL, median};

/// A joint rests where the magnitude of the smoothed sign of its speed stays below this value for longer than one
/// averaging window. At a reversal it stays below this value for only about half of a window.
const RESTING: f64 = 0.5;
/// A rest begins and ends where the magnitude of the smoothed sign of the speed passes this value.
const MOVING: f64 = 0.98;
/// Rows at rest are left out of the fits only if at least this fraction of the rows of the record remains.
const LEAST_MOVING_PART: f64 = 0.2;
/// A joint reverses at rows where the magnitude of the smoothed sign of its speed differs from one by more than this.
/// At a reversal the smoothed sign changes slowly, but friction changes at once. With these rows a fit would give too
/// large a Coulomb friction.
pub(super) const TURNING: f64 = 0.05;
/// Rows at reversals are left out of the fits only if at least this fraction of the moving rows remains.
const LEAST_KNOWN_PART: f64 = 0.6;
/// Rows at jumps of the torque are left out of the fits only if at least this fraction of the rows remains. A planned
/// motion has few jumps. A torque that jumps more often is noisy; its jumps have both signs and average out.
const LEAST_STEADY_PART: f64 = 0.85;
/// The torque jumps where a step from row to row differs from the mean of the steps before and after it by more than
/// this many standard deviations of such differences. The standard deviation is estimated from the median of their
/// magnitudes.
const JUMP: f64 = 6.0;
/// A jump of the torque below this fraction of the standard deviation of the torque is left in the fit.
const LEAST_JUMP_PART: f64 = 0.02;

/// Whether the joint rests, row by row. While the joint rests, its friction may have any value of either sign up to the
/// Coulomb friction, whatever the sign of the speed is. `sense` is the smoothed sign of the speed, and `half` the half
/// width of its window \[rows\]. A reversal does not count as a rest. All `false` if the joint moves in fewer than
/// [`LEAST_MOVING_PART`] of the rows.
pub(super) fn rests(sense: &[f64], half: usize) -> Vec<bool> {
    let mut out = vec![false; sense.len()];
    let mut row = 0;
    while row < sense.len() {
        // a value near an end or a gap of the record is NaN, and every comparison with it is false
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

/// Whether the joint reverses, row by row. `sense` is the smoothed sign of the speed, and `rests` tells at which rows
/// the joint rests. All `false` if fewer than [`LEAST_KNOWN_PART`] of the moving rows would remain.
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

/// Whether the torque jumps within the window of a row, which reaches `half` rows to either side, row by row. All
/// `false` if fewer than [`LEAST_STEADY_PART`] of the rows would remain.
pub(super) fn at_jumps(torque_nm: &[f64], half: usize) -> Vec<bool> {
    let mut out = vec![false; torque_nm.len()];
    let excess: Vec<f64> =
        torque_nm.windows(4).map(|t| (t[2] - t[1]) - 0.5 * ((t[1] - t[0]) + (t[3] - t[2]))).collect();
    let usual_nm = median(excess.iter().map(|e| e.abs()).collect()) / MEDIAN_OF_NORMAL;
    let least_nm = (JUMP * usual_nm).max(LEAST_JUMP_PART * deviation(torque_nm));
    for (i, _) in excess.iter().enumerate().filter(|(_, e)| e.abs() > least_nm) {
        // the jump is between the rows i + 1 and i + 2; the slope of the average uses one more row on either side
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
