//! Friction from the balance of torques: the motor's torque is the torque of the load plus friction.
//!
//! `T_m = T_0 + J a_m + I a_l + A sin q_l + B cos q_l + (coupling with other joints) + (F_c + f |T_l|) sgn w + F_v w`
//!
//! All quantities are at the output of the gear. `T_m` is the torque of the motor and `T_l` the torque of the load \[N
//! m\], `a_m` and `a_l` are the accelerations of motor and link \[rad/s²\], `q_l` is the angle of the link \[rad\], and
//! `w` the speed of the motor \[rad/s\]. All other letters are coefficients that are fitted: `T_0` is an offset for
//! each record, `J` and `I` are inertias, `A` and `B` stand for gravity, `F_c` is Coulomb friction, `f` friction in
//! proportion to the load, and `F_v` viscous friction. Sine and cosine of `2 q_l` are fitted too.
//!
//! The load of a joint also depends on the position and motion of the other joints. The motion of each other joint adds
//! a group of columns to the fit, if the fit then predicts held-out blocks better (blocks of time that were left out of
//! a fit). The torque of the load `T_l`, which the gear carries, is the sum of all terms of the load except the rotor's
//! inertia. It is first computed from a fit without load-dependent friction, and then from fits with it.

use super::blocks::Fitted;
use super::intervals::is_positive;
use super::known::TURNING;
use super::signals::{JointRows, Sample};
use super::smooth::{averaged, slope, smooth};
use super::twist::CLEARLY;
use crate::reconcile::model::estimate::Estimate;
use crate::reconcile::readings::record::Record;

/// Number of columns of the load of the joint itself, which come after the offsets of the records: accelerations of
/// motor and link, sine and cosine of the link's angle, and of twice this angle.
const OWN_LOAD: usize = 6;
/// Number of columns of friction: sign of the speed, speed, and sign of the speed times the magnitude of the load. They
/// come after the load of the joint itself.
const FRICTION: usize = 3;
/// The link's acceleration is added to the balance of torques if held-out blocks are then predicted better by more than
/// this many standard errors. The number is smaller than for other columns, because the inertia of the link certainly
/// exists and adds one column only.
const SLIGHTLY: f64 = 1.0;
/// Number of columns that the motion of one other joint adds to the balance of torques: its acceleration, the square of
/// its speed, and sine and cosine of its angle and of the sum and the difference of both joints' angles.
const OTHER: usize = 8;

/// Largest number of fits that find the load-dependent friction. Each uses the torque of the load from the fit before.
const LOAD_ROUNDS: usize = 4;

/// Friction of a joint, referred to the output of its gear, with 95 % intervals.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Friction {
    /// Coulomb friction \[N m\].
    pub coulomb_nm: Estimate,
    /// Viscous friction \[N m s/rad\].
    pub viscous_nms_per_rad: Estimate,
    /// Friction torque for each newton metre of load torque \[-\]; `None` if held-out blocks are not predicted better
    /// with it.
    pub load_part: Option<Estimate>,
    /// Whether the model predicts held-out blocks clearly better with Coulomb friction (first) and with viscous
    /// friction (second).
    pub clearly: [bool; 2],
    /// Whether the torque of the viscous friction at the largest speed is below the largest torque of the motor. If it
    /// is not, the fit has taken a part of the load for friction.
    pub is_possible: bool,
    /// Upper bound of the viscous friction: the largest torque of the motor divided by the largest speed \[N m s/rad\].
    pub most_viscous_nms_per_rad: f64,
    /// Fraction of the variance of the motor's torque, from 0 to 1, that neither load nor friction explains, over the
    /// rows of the balance of torques.
    pub left_share: f64,
    /// The same fraction as `left_share`, but over the rows that enter the fit of the twist.
    pub left_share_of_twist: f64,
}

/// Sine of the angle, and cosine minus 1. Both are zero at zero angle so that they do not compete with the offset of a
/// record.
fn wave(angle_rad: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(angle_rad);
    [sin, cos - 1.0]
}

/// Angle \[rad\], speed \[rad/s\] and acceleration \[rad/s²\] of another joint, one entry for each sample of the joint
/// that is judged. `None` near ends and gaps, where smoothing gives no value.
type Motion = Vec<Option<[f64; 3]>>;

/// The balance of torques of one joint, as columns for a fit. The columns are, in this order: an offset for each
/// record, the load of the joint itself, friction, the motion of each joint in `others`, and the motor's torque, which
/// is the target.
struct Balance<'a> {
    rows: &'a JointRows,
    shift_s: f64,
    others: Vec<Motion>,
    load_nm: Vec<f64>,
    used: Used,
}

/// Which rows enter the fits of the balance of torques.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Used {
    /// Rows without a jump of the torque and away from reversals. Near a reversal the friction is not known.
    Sure,
    /// Rows that enter the fit of the twist.
    OfTwist,
}

impl Balance<'_> {
    /// Indices of the columns of friction: Coulomb, viscous, and in proportion to the load.
    fn friction(&self) -> [usize; FRICTION] {
        std::array::from_fn(|i| self.rows.record_count() + OWN_LOAD + i)
    }

    /// Indices of the columns of the motion of another joint. `joint` is its index in `others`.
    fn other(&self, joint: usize) -> Vec<usize> {
        let first = self.rows.record_count() + OWN_LOAD + FRICTION + OTHER * joint;
        (first..first + OTHER).collect()
    }

    /// Index of the column of the link's acceleration.
    fn link(&self) -> usize {
        self.rows.record_count() + 1
    }

    /// Indices of the columns of the offsets and of the load of the joint itself, without the link's acceleration.
    fn load(&self) -> Vec<usize> {
        (0..self.rows.record_count() + OWN_LOAD).filter(|c| *c != self.link()).collect()
    }

    /// Groups of columns that are added to the load only if the model predicts held-out blocks better with them: first
    /// the link's own acceleration alone, then one group for the motion of each other joint.
    fn candidates(&self) -> Vec<Vec<usize>> {
        let others = (0..self.others.len()).map(|k| self.other(k));
        std::iter::once(vec![self.link()]).chain(others).collect()
    }

    /// Index of the column of the motor's torque, which a fit explains.
    fn target(&self) -> usize {
        self.rows.record_count() + OWN_LOAD + FRICTION + OTHER * self.others.len()
    }

    /// Writes the columns of the sample with index `i` into `row` \[SI units\]. Returns whether the row is used.
    fn fill(&self, i: usize, sample: &Sample, row: &mut [f64]) -> bool {
        let is_used = match self.used {
            Used::Sure => !sample.rests && !sample.jumps && (sample.sense.abs() - 1.0).abs() <= TURNING,
            Used::OfTwist => sample.is_known(),
        };
        is_used && self.fill_any(i, sample, row)
    }

    /// Writes the columns of a row, whether [`Used`] admits the row or not. Returns whether all of them are known.
    fn fill_any(&self, i: usize, sample: &Sample, row: &mut [f64]) -> bool {
        let read = self.rows.link(sample, self.shift_s).zip(self.rows.accelerations(sample, self.shift_s));
        let Some(([q, _], [of_motor, of_link])) = read else { return false };
        let first = self.rows.record_count();
        let w = sample.speed_rad_s;
        row[sample.record] = 1.0;
        let [[sin, cos], [sin2, cos2]] = [wave(q), wave(2.0 * q)];
        let own = [of_motor, of_link, sin, cos, sin2, cos2];
        row[first..first + OWN_LOAD].copy_from_slice(&own);
        let [sense, speed, load] = self.friction();
        row[sense] = sample.sense;
        row[speed] = w;
        row[load] = sample.sense * self.load_nm[i].abs();
        for (k, motion) in self.others.iter().enumerate() {
            let Some([angle, other_speed, acceleration]) = motion[i] else { return false };
            let first = self.other(k)[0];
            let waves = [wave(angle), wave(q + angle), wave(q - angle)];
            row[first..first + 2].copy_from_slice(&[acceleration, other_speed.powi(2)]);
            row[first + 2..first + OTHER].copy_from_slice(waves.as_flattened());
        }
        let last = row.len() - 1;
        row[last] = sample.torque_nm;
        true
    }

    /// Torque of the load that the gear carries at each row according to the fit `fitted` \[N m\]: the sum of all terms
    /// except friction and the torque that accelerates the rotor. If the link's acceleration is in the fit, the term of
    /// the motor's acceleration is the rotor's and is left out. Otherwise this term contains the inertia of rotor and
    /// link, and only the stated inertia of the rotor is subtracted.
    fn load_of(&self, fitted: &Fitted) -> Vec<f64> {
        let motor = self.rows.record_count();
        let mut apart = self.friction().to_vec();
        let mut rotor_kgm2 = self.rows.rotor_inertia_kgm2.unwrap_or_default();
        if fitted.columns.contains(&self.link()) {
            apart.push(motor);
            rotor_kgm2 = 0.0;
        }
        let mut row = vec![0.0; self.target() + 1];
        let rows = self.rows.samples.iter().enumerate();
        rows.map(|(i, sample)| {
            row.fill(0.0);
            self.fill_any(i, sample, &mut row);
            let parts = fitted.columns.iter().zip(&fitted.values).filter(|(c, _)| !apart.contains(c));
            parts.map(|(c, v)| row[*c] * v).sum::<f64>() - rotor_kgm2 * row[motor]
        })
        .collect()
    }

    /// Fit of the motor's torque without load-dependent friction. Those [`Balance::candidates`] are added that improve
    /// the prediction of held-out blocks. `None` if a fit is impossible.
    fn without_load_friction(&self) -> Option<Fitted> {
        let target = self.target();
        let sums = self.rows.sums(target + 1, |i, s, row| self.fill(i, s, row));
        let [sense, speed, _] = self.friction();
        let mut columns = [self.load(), vec![sense, speed]].concat();
        let mut best = sums.fit(&columns, target, |_| None)?;
        let mut left = self.candidates();
        loop {
            let tried = left.iter().enumerate().filter_map(|(k, group)| {
                let more = [columns.as_slice(), group].concat();
                Some((k, sums.fit(&more, target, |_| None)?))
            });
            let asked = |k: usize| if left[k].len() == 1 { SLIGHTLY } else { CLEARLY };
            let better = tried.filter(|(k, fit)| fit.better_than(&best) > asked(*k));
            let rms = |fit: &Fitted| fit.held_out_rms();
            let Some((k, fit)) = better.min_by(|a, b| rms(&a.1).total_cmp(&rms(&b.1))) else { break };
            columns.extend(left.remove(k));
            best = fit;
        }
        Some(best)
    }

    /// Fraction of the variance of the motor's torque, from 0 to 1, that a fit by the columns with the indices
    /// `columns` leaves unexplained.
    fn left_share(&self, columns: &[usize]) -> f64 {
        let target = self.target();
        let sums = self.rows.sums(target + 1, |i, s, row| self.fill(i, s, row));
        let offsets: Vec<usize> = (0..self.rows.record_count()).collect();
        let others: Vec<usize> = columns.iter().copied().filter(|c| !offsets.contains(c)).collect();
        sums.own_share(target, &offsets, &others)
    }
}

/// Motion of each other joint at the samples of this joint. A joint that is missing in one of the records of this joint
/// is left out.
fn motions(rows: &JointRows, records: &[Record]) -> Vec<Motion> {
    let own: Vec<&Record> = records
        .iter()
        .filter(|r| r.joints.iter().any(|j| j.joint == rows.joint && !j.link_rad.is_empty()))
        .collect();
    let Some(first) = own.first() else { return Vec::new() };
    let names = first.joints.iter().map(|j| &j.joint).filter(|name| **name != rows.joint);
    let in_all = names.filter(|name| own.iter().all(|r| r.joints.iter().any(|j| j.joint == **name)));
    in_all
        .map(|name| {
            let signals = own.iter().filter_map(|r| Some((r, r.joints.iter().find(|j| j.joint == *name)?)));
            let smoothed: Vec<[Vec<f64>; 3]> = signals
                .enumerate()
                .map(|(k, (r, j))| motion_of(&r.t_s, &j.motor_rad, rows.half(k)))
                .collect();
            let at = |s: &Sample| {
                let m = smoothed.get(s.record)?.each_ref().map(|x| x[s.row]);
                m.iter().all(|x| !x.is_nan()).then_some(m)
            };
            rows.samples.iter().map(at).collect()
        })
        .collect()
}

/// Angle \[rad\], speed \[rad/s\] and acceleration \[rad/s²\] of a joint, one list each with one value per row. They
/// are averaged over a window that reaches `half` rows to either side.
fn motion_of(t_s: &[f64], motor_rad: &[f64], half: usize) -> [Vec<f64>; 3] {
    let ([angle_rad], _) = averaged(t_s, half, [motor_rad]);
    let speed_rad_s = slope(t_s, &angle_rad);
    [angle_rad, speed_rad_s, smooth(t_s, motor_rad, half).curvature]
}

/// Torque of the load that the gear of a joint carries, one per row \[N m\], from the balance of torques. A delay of
/// the link's readings changes this torque little and is ignored. `None` if the torque is not recorded or a fit is
/// impossible.
pub(crate) fn load_nm(rows: &JointRows, records: &[Record]) -> Option<Vec<f64>> {
    let balance = balance(rows, records, 0.0)?;
    let best = balance.without_load_friction()?;
    Some(balance.load_of(&best))
}

/// The balance of torques of a joint, with the load torque `load_nm` still zero. `shift_s` is the delay of the link's
/// readings \[s\]. `None` if the torque is not recorded.
fn balance<'a>(rows: &'a JointRows, records: &[Record], shift_s: f64) -> Option<Balance<'a>> {
    let load_nm = vec![0.0; rows.samples.len()];
    let others = rows.has_torque.then(|| motions(rows, records))?;
    Some(Balance { rows, shift_s, others, load_nm, used: Used::Sure })
}

/// Finds the friction of a joint from the balance of its torques. `shift_s` is the delay of the link's readings
/// \[s\]. `None` if the torque is not recorded or a fit is impossible.
pub(crate) fn friction(rows: &JointRows, records: &[Record], shift_s: f64) -> Option<Friction> {
    let mut balance = balance(rows, records, shift_s)?;
    let best = balance.without_load_friction()?;
    let (target, [sense, speed, load_sense]) = (balance.target(), balance.friction());
    let (mut sums, mut chosen) = (rows.sums(target + 1, |i, s, row| balance.fill(i, s, row)), best);
    let with = [chosen.columns.as_slice(), &[load_sense]].concat();
    let mut has_load = false;
    for _ in 0..LOAD_ROUNDS {
        balance.load_nm = balance.load_of(&chosen);
        let next = rows.sums(target + 1, |i, s, row| balance.fill(i, s, row));
        let with_load = next.fit(&with, target, |_| None)?;
        let is_clear = with_load.better_than(&chosen) > CLEARLY;
        let grows_with_load = has_load || (is_clear && is_positive(&with_load.coefficient(load_sense)));
        if !grows_with_load {
            break;
        }
        (sums, chosen, has_load) = (next, with_load, true);
    }
    let fit = |columns: &[usize]| sums.fit(columns, target, |_| None);
    let without = |column: usize| {
        let others: Vec<usize> = chosen.columns.iter().copied().filter(|c| *c != column).collect();
        fit(&others).is_some_and(|other| chosen.better_than(&other) > CLEARLY || chosen.halves(&other))
    };
    // a viscous torque above the largest torque of the motor is a load that the fit has taken for friction
    let largest_nm = rows.samples.iter().fold(0.0f64, |m, s| m.max(s.torque_nm.abs()));
    let fastest = rows.samples.iter().fold(0.0f64, |m, s| m.max(s.speed_rad_s.abs()));
    let is_possible = chosen.value(speed) * fastest < largest_nm;
    let left_share = balance.left_share(&chosen.columns);
    balance.used = Used::OfTwist;
    balance.load_nm = balance.load_of(&chosen);
    Some(Friction {
        coulomb_nm: chosen.coefficient(sense),
        viscous_nms_per_rad: chosen.coefficient(speed),
        load_part: has_load.then(|| chosen.coefficient(load_sense)),
        clearly: [without(sense), without(speed) && is_possible],
        is_possible,
        most_viscous_nms_per_rad: largest_nm / fastest.max(1e-12),
        left_share,
        left_share_of_twist: balance.left_share(&chosen.columns),
    })
}
