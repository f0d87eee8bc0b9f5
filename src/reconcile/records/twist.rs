//! Linear model of the twist of a joint, and the choice of its terms. The twist is the angle of torsion of the joint
//! \[rad\]. Each term of the model is a column, which has one value for each row of the records. A fit finds the
//! coefficients of the columns by least squares. A held-out block is a block of time that was left out of a fit, and is
//! then predicted by it.
//!
//! The recorded twist is the motor's angle minus the link's angle, `y = theta_m(t) - theta_l(t - s)`. Written as a sum,
//!
//! `y = offset + s w_l + c (T_m - J a - (F_c + f |T_l|) sgn w - F_v w) + e(q) + g(N q)`
//!
//! | symbol | what it is | unit |
//! |---|---|---|
//! | `w`, `w_l` | speeds of the motor (at the output) and of the link | rad/s |
//! | `a` | acceleration of the motor at the output | rad/s² |
//! | `q`, `N` | angle of the motor at the output, gear ratio | rad, 1 |
//! | `s` | time by which the link's reading is late | s |
//! | `c` | compliance | rad/(N m) |
//! | `T_m`, `T_l` | torque of the motor at the output; torque of the load, from the balance of torques | N m |
//! | `J` | inertia on the motor's side of the spring | kg m² |
//! | `F_c`, `f`, `F_v` | Coulomb, load-dependent and viscous friction on the motor's side | N m, 1, N m s/rad |
//! | `e`, `g` | transmission error once and twice a turn of the output and of the input | rad |
//!
//! The coefficients of `a` and `sgn w` are free, because neither the rotor's inertia nor the side of the spring on
//! which friction acts is known. The coefficient of the rate of `T_m` is also free: it represents a filter in the
//! torque sensor and damping in the spring. The coefficient of the speed is `s - c F_v`, because `w` and `w_l` are
//! nearly equal. A time shift and viscous friction therefore have the same signal in the twist. Only the balance of
//! torques (`friction`) separates them.

use super::blocks::{Blocks, Fitted, rows_per_reading};
use super::signals::{JointRows, waves_of};
use crate::arm::effect::{time_shift, transmission_error};

/// Prior standard deviation of each amplitude of a transmission error \[rad\].
const USUAL_ERROR_RAD: f64 = 1.5e-3;
/// A time shift or a compliance is named only if the model predicts held-out blocks better with it by more than this
/// many standard errors.
pub(crate) const CLEARLY: f64 = 2.0;
/// A transmission error, which has four columns, is named only if the model predicts held-out blocks better with it by
/// more than this many standard errors.
const CLEARLY_MANY: f64 = 2.5;
/// A transmission error of the output is named only if it lowers the root mean square error on held-out blocks to less
/// than this fraction of the error without it.
const LARGEST_ERROR_RATIO: f64 = 0.8;
/// A transmission error is not named if the fit without it has errors on held-out blocks below this multiple of the
/// noise of the sensors. Such errors count as noise.
const STILL_NOISE: f64 = 1.15;
/// Errors on held-out blocks at or above this multiple of the noise of the sensors are certainly more than noise.
const SURELY_MORE: f64 = 2.0;
/// Largest number of iterations in the search for the time shift.
const ROUNDS: usize = 12;

/// Indices of the columns of the model of the twist. The first columns are the offsets of the records: column `k` is 1
/// at the rows of record `k` and 0 elsewhere.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Places {
    /// Number of records of the joint. Each record has one offset, a constant that is added to the twist.
    pub records: usize,
}

impl Places {
    /// Index of the column of the link's speed. The coefficient of this column is the time shift \[s\].
    pub(crate) fn shift(self) -> usize {
        self.records
    }
    /// Index of the column of the motor's torque at the output \[N m\], less the torque that accelerates the rotor if
    /// the rotor's inertia is stated. The coefficient of this column is the compliance \[rad/(N m)\].
    pub(crate) fn torque(self) -> usize {
        self.records + 1
    }
    /// Index of the column of the motor's acceleration at the output \[rad/s²\]. The coefficient of this column is
    /// minus the compliance times the rotor's inertia.
    pub(crate) fn acceleration(self) -> usize {
        self.records + 2
    }
    /// Index of the column of the sign of the motor's speed \[-\]. The coefficient of this column is minus the
    /// compliance times the Coulomb friction on the motor's side \[rad\].
    pub(crate) fn sense(self) -> usize {
        self.records + 3
    }
    /// Index of the column of the sign of the motor's speed times the magnitude of the load's torque \[N m\]. This
    /// column represents friction that grows with the load.
    pub(crate) fn load_sense(self) -> usize {
        self.records + 4
    }
    /// Index of the column of the rate of change of the motor's torque \[N m/s\]. This column represents a filter of
    /// the torque sensor and damping in the spring.
    pub(crate) fn rate(self) -> usize {
        self.records + 5
    }
    /// Indices of the columns of the transmission error of the output: sine and cosine once a turn, then twice a
    /// turn.
    pub(crate) fn output(self) -> [usize; 4] {
        std::array::from_fn(|i| self.records + 6 + i)
    }
    /// Indices of the columns of the transmission error of the input (motor): sine and cosine once a turn, then twice
    /// a turn.
    pub(crate) fn input(self) -> [usize; 4] {
        std::array::from_fn(|i| self.records + 10 + i)
    }
    /// Index of the first column behind the columns of the linear model. The recorded twist, which a fit explains,
    /// stands there. If torsion laws are fitted, their columns begin there and the recorded twist follows them.
    pub(crate) fn further(self) -> usize {
        self.records + 14
    }
    /// Indices of the columns of the offsets of the records.
    pub(crate) fn offsets(self) -> Vec<usize> {
        (0..self.records).collect()
    }
}

/// A group of columns that can be added to the model of the twist.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Group {
    /// The time shift of the link's signal.
    Shift,
    /// Compliance, together with friction, the rate of the torque, and the rotor's inertia if it is not stated.
    Compliance,
    /// Transmission error once and twice a turn of the output.
    Output,
    /// Transmission error once and twice a turn of the input (motor).
    Input,
}

impl Group {
    /// Name of the group in `verdict.json`.
    pub(crate) fn what(self) -> &'static str {
        match self {
            Group::Shift => time_shift::KIND.name,
            Group::Compliance => "compliance",
            Group::Output => transmission_error::KIND.name,
            Group::Input => "input_transmission_error",
        }
    }

    /// Name of the group in [`TwistModel::steps`], the table of errors after each step.
    fn step(self) -> &'static str {
        match self {
            Group::Shift => "time shift",
            Group::Compliance => "torque, friction and inertia",
            Group::Output => "transmission error",
            Group::Input => "transmission error of the input",
        }
    }

    /// Whether the group is a transmission error, of the output or of the input.
    fn is_of_gear(self) -> bool {
        matches!(self, Group::Output | Group::Input)
    }

    /// Whether the group predicts held-out blocks so much better that it may be named. `with` is the fit with the
    /// columns of the group, and `without` is the fit without them.
    fn pays(self, with: &Fitted, without: &Fitted) -> bool {
        let clearly = with.better_than(without);
        match self {
            Group::Shift | Group::Compliance => clearly > CLEARLY,
            // the four sines and cosines can also fit small errors of the model of gravity, so a larger improvement is
            // required
            Group::Output => {
                clearly > CLEARLY_MANY && with.held_out_rms() < LARGEST_ERROR_RATIO * without.held_out_rms()
            }
            Group::Input => clearly > CLEARLY_MANY,
        }
    }
}

/// The fitted linear model of a joint's twist.
pub(crate) struct TwistModel<'a> {
    /// Rows of the joint.
    pub rows: &'a JointRows,
    /// Indices of the model's columns.
    pub places: Places,
    /// Time by which the link's signal is late \[s\]. The link's angle that belongs to the time `t` is read at `t +
    /// shift_s`. Between rows it comes from a Taylor series about the row nearest to this time.
    pub shift_s: f64,
    /// Sums of the products of every two columns, one matrix for each block of time. The last column is the recorded
    /// twist.
    pub sums: Blocks,
    /// Standard deviation of the error of an independent reading of the twist \[rad\]: the root mean square error of a
    /// row times the root of `rows_per_reading`.
    pub sigma_rad: f64,
    /// Groups of columns that the model contains in addition to the offsets.
    pub groups: Vec<Group>,
    /// Fit of the twist by the offsets and the columns of `groups`.
    pub fitted: Fitted,
    /// Number of rows that together have as much information as one independent reading. It is more than 1 because
    /// errors are autocorrelated.
    pub rows_per_reading: f64,
    /// Name of each step in the choice of groups, with the root mean square error of the twist on held-out blocks after
    /// the step \[rad\].
    pub steps: Vec<(String, f64)>,
    /// Fits that tell whether a transmission error of the output, gravity on the compliance, or both twist the joint.
    /// `None` if the rotor's inertia is stated, or if neither this error nor a compliance shows.
    pub error_or_gravity: Option<ErrorOrGravity>,
}

/// Fits that compare a transmission error of the output with the compliance of the joint, where the rotor's inertia is
/// not stated. Both can explain the same twist. Under gravity a compliant joint twists in proportion to sine and cosine
/// of its angle, and a transmission error once a turn has the same form.
///
/// A fit with the transmission error can therefore give a compliance near zero, and still predict as well as a fit with
/// the true compliance. The twist under the torque that accelerates the link is then left. The fit assigns it to the
/// acceleration of the motor, which gives a negative rotor inertia. Such a fit is recognised by this sign.
pub(crate) struct ErrorOrGravity {
    /// Fit without the transmission error of the output.
    pub without: Fitted,
    /// Fit with the transmission error, in which compliance, friction and rotor inertia have the values of the fit
    /// `without`.
    pub at_compliance: Fitted,
    /// Fit with the transmission error. If the best rotor inertia is negative, it is held at zero.
    pub with: Fitted,
    /// Whether the fit `without` predicts held-out blocks clearly better with a compliance than without one.
    pub shows: bool,
    /// Whether the rotor's inertia is negative in the best fit with the transmission error. If `shows` is `false`, the
    /// whole 95 % interval of the inertia must be negative.
    pub is_held: bool,
    /// Whether the records leave it open that the joint has a transmission error. The chosen model does not have one,
    /// but the fit `with` predicts held-out blocks clearly better than the fit `without`, whose errors are certainly
    /// more than noise.
    pub is_doubtful: bool,
}

/// Writes the columns of the sample with index `i`, and last the recorded twist, into `row`. The link's signal is read
/// as late by `shift_s` \[s\]. Returns `false` if the link has no reading at the later time.
pub(crate) fn fill(rows: &JointRows, i: usize, shift_s: f64, row: &mut [f64]) -> bool {
    let sample = &rows.samples[i];
    let (Some(twist), Some([acceleration, _])) =
        (rows.twist(sample, shift_s), rows.accelerations(sample, shift_s))
    else {
        return false;
    };
    let places = Places { records: rows.record_count() };
    row[sample.record] = 1.0;
    row[places.shift()] = twist.link_speed_rad_s;
    let rotor_nm = rows.rotor_inertia_kgm2.unwrap_or_default() * acceleration;
    row[places.torque()] = sample.torque_nm - rotor_nm;
    row[places.acceleration()] = acceleration;
    row[places.sense()] = sample.sense;
    row[places.load_sense()] = sample.load_sense_nm;
    row[places.rate()] = sample.torque_rate_nm_s;
    row[places.output()[0]..][..4].copy_from_slice(&waves_of(sample.angle_rad));
    row[places.input()[0]..][..4].copy_from_slice(&sample.input_waves);
    // the time shift is already removed from the twist; this line adds it again, so that the coefficient of the speed
    // is the whole time shift
    let last = row.len() - 1;
    row[last] = twist.twist_rad + shift_s * twist.link_speed_rad_s;
    true
}

/// Writes the columns of the sample with index `i` as [`fill`] does. Returns `false` also where torque or friction is
/// not known.
pub(crate) fn fill_known(rows: &JointRows, i: usize, shift_s: f64, row: &mut [f64]) -> bool {
    rows.samples[i].is_known() && fill(rows, i, shift_s, row)
}

/// Indices of the columns of the twist model that a fit uses: the constant offset of each record, then the columns of
/// the terms in `groups` (time shift, compliance with friction, transmission errors).
pub(crate) fn columns(rows: &JointRows, groups: &[Group]) -> Vec<usize> {
    let places = Places { records: rows.record_count() };
    let mut out = places.offsets();
    for group in groups {
        match group {
            Group::Shift => out.push(places.shift()),
            Group::Compliance => {
                out.extend([places.torque(), places.sense(), places.load_sense(), places.rate()]);
                // if the inertia of the rotor is stated, its torque is already subtracted in the column of the torque
                out.extend(rows.rotor_inertia_kgm2.is_none().then_some(places.acceleration()));
            }
            Group::Output => out.extend(places.output()),
            Group::Input => out.extend(places.input()),
        }
    }
    out
}

impl<'a> TwistModel<'a> {
    /// Finds the time shift and the groups of columns that the twist of a joint needs, and fits them. `None` if a fit
    /// is impossible.
    pub(crate) fn find(rows: &'a JointRows) -> Option<Self> {
        let places = Places { records: rows.record_count() };
        let shift_s = time_shift_s(rows)?;
        let sums = rows.sums(places.further() + 1, |i, _, row| fill_known(rows, i, shift_s, row));
        let smooth = if rows.has_torque { vec![Group::Shift, Group::Compliance] } else { vec![Group::Shift] };
        let target = places.further();
        let fitted = sums.fit(&columns(rows, &smooth), target, |_| None)?;
        let steps = Vec::new();
        let mut out = Self {
            rows,
            places,
            shift_s,
            sums,
            sigma_rad: 0.0,
            groups: smooth,
            fitted,
            rows_per_reading: 1.0,
            steps,
            error_or_gravity: None,
        };
        out.judge_errors();
        out.select()?;
        out.settle()?;
        Some(out)
    }

    /// Errors of the fit `self.fitted` (recorded minus modelled twist), one per known row \[rad\].
    pub(crate) fn errors(&self) -> Vec<f64> {
        let mut row = vec![0.0; self.places.further() + 1];
        let error = |i: usize| {
            row.fill(0.0);
            let is_filled = fill_known(self.rows, i, self.shift_s, &mut row);
            let modelled: f64 =
                self.fitted.columns.iter().zip(&self.fitted.values).map(|(c, v)| row[*c] * v).sum();
            is_filled.then(|| row[row.len() - 1] - modelled)
        };
        (0..self.rows.samples.len()).filter_map(error).collect()
    }

    /// Fits the chosen groups again, and decides again between transmission error and gravity. `None` if a fit is
    /// impossible. The reason for repeating the fit is the prior of a transmission error, which depends on the standard
    /// deviation `sigma_rad` of the fit before. During the choice of groups, `sigma_rad` comes from a fit without
    /// transmission errors. It is then too large, which makes the prior too narrow and the amplitudes too small. Each
    /// round uses the `sigma_rad` of the round before.
    fn settle(&mut self) -> Option<()> {
        const ROUNDS: usize = 3;
        for _ in 0..ROUNDS {
            self.judge_errors();
            self.fitted = self.fit(&self.groups)?;
            self.error_or_gravity = self.error_or_gravity();
            let held = self.error_or_gravity.as_ref().filter(|b| b.is_held);
            if let Some(beside) = held.filter(|_| self.groups.contains(&Group::Output)) {
                self.fitted = beside.with.clone();
            }
        }
        self.judge_errors();
        if let Some(last) = self.steps.last_mut() {
            last.1 = self.fitted.held_out_rms();
        }
        Some(())
    }

    /// Fraction of the variance of the motor's torque, from 0 to 1, that no other column of the fit explains. Only this
    /// part of the torque determines the compliance (Frisch and Waugh 1933).
    fn own_share_in_fit(&self) -> f64 {
        let p = self.places;
        let is_other = |c: &usize| *c != p.torque() && *c >= p.records;
        let others: Vec<usize> = self.fitted.columns.iter().copied().filter(is_other).collect();
        self.sums.own_share(p.torque(), &p.offsets(), &others)
    }

    /// Lower bound of the ratio of the fitted compliance to the true compliance, from 0 to 1. The recorded torque
    /// differs from the torque of the spring, and errors of a regressor make its coefficient too small. The result is
    /// the larger of two bounds:
    ///
    /// - one minus `left_share` divided by [`Self::own_share_in_fit`]. `left_share` is the fraction of the torque's
    ///   variance that the balance of torques leaves unexplained.
    /// - the square of the partial correlation of torque and twist. It is a bound because the true coefficient lies
    ///   between the coefficients of the regression and of the reverse regression (Frisch 1934).
    pub(crate) fn least_attenuation(&self, left_share: f64) -> f64 {
        let torque = self.places.torque();
        let others: Vec<usize> = self.fitted.columns.iter().copied().filter(|c| *c != torque).collect();
        let without = self.fit_with(&others).map_or(0.0, |f| f.squares);
        let by_twist = 1.0 - self.fitted.squares / without.max(1e-300);
        let by_balance = 1.0 - left_share / self.own_share_in_fit().max(1e-300);
        by_twist.max(by_balance).clamp(0.0, 1.0)
    }

    /// Computes `rows_per_reading` and `sigma_rad` from the errors of the fit `self.fitted`.
    fn judge_errors(&mut self) {
        self.rows_per_reading = rows_per_reading(&self.errors());
        let variance = self.fitted.squares / self.fitted.rows as f64;
        self.sigma_rad = (variance * self.rows_per_reading).sqrt();
    }

    /// Fits the twist by the offsets and the groups `groups`. Amplitudes of transmission errors have a prior. `None` if
    /// the fit is impossible.
    pub(crate) fn fit(&self, groups: &[Group]) -> Option<Fitted> {
        self.fit_with(&columns(self.rows, groups))
    }

    /// Fits the twist by the columns with the indices `columns`. Amplitudes of transmission errors have a prior. `None`
    /// if the fit is impossible.
    pub(crate) fn fit_with(&self, columns: &[usize]) -> Option<Fitted> {
        self.sums.fit(columns, self.places.further(), |c| self.prior(c))
    }

    /// Prior standard deviation of the coefficient of the column `column`, as a multiple of the standard deviation of
    /// an independent reading. `None` if the column has no prior. Only the columns of transmission errors have one.
    pub(crate) fn prior(&self, column: usize) -> Option<f64> {
        let errors = [self.places.output(), self.places.input()].concat();
        errors.contains(&column).then_some(USUAL_ERROR_RAD / self.sigma_rad.max(1e-12))
    }

    /// Groups that the records of this joint can show: the compliance needs a recorded torque, and the transmission
    /// error of the input needs a gear ratio above 1.
    fn candidates(&self) -> Vec<Group> {
        let all = [
            (Group::Shift, true),
            (Group::Compliance, self.rows.has_torque),
            (Group::Output, true),
            (Group::Input, self.rows.ratio.is_some_and(|n| n > 1.0)),
        ];
        all.into_iter().filter(|(_, possible)| *possible).map(|(group, _)| group).collect()
    }

    /// Chooses `groups` and fits them. In each step, the group with the best prediction of held-out blocks is added, as
    /// long as one predicts them clearly better. Then groups that have become unnecessary are removed. The compliance
    /// is always in the model if the torque is recorded, so that its uncertainty is part of the intervals. `None` if a
    /// fit is impossible.
    fn select(&mut self) -> Option<()> {
        let mut groups: Vec<Group> = Vec::new();
        let mut best = self.fit(&groups)?;
        self.steps = vec![("nothing but an offset".into(), best.held_out_rms())];
        loop {
            let left = self.candidates().into_iter().filter(|g| !groups.contains(g));
            let tried = left.filter_map(|g| Some((g, self.fit(&[groups.as_slice(), &[g]].concat())?)));
            let better = tried.filter(|(g, fit)| self.pays(*g, &groups, fit, &best));
            // gravity on a compliance has the same form as a transmission error, so groups without a transmission error
            // are tried first
            let order = |(group, fit): &(Group, Fitted)| (group.is_of_gear(), fit.held_out_rms());
            let next =
                better.min_by(|a, b| order(a).0.cmp(&order(b).0).then(order(a).1.total_cmp(&order(b).1)));
            match next {
                Some((group, fit)) => {
                    groups.push(group);
                    self.steps.push((group.step().into(), fit.held_out_rms()));
                    best = fit;
                }
                None if self.rows.has_torque && !groups.contains(&Group::Compliance) => {
                    groups.push(Group::Compliance);
                    best = self.fit(&groups)?;
                    self.steps.push((Group::Compliance.step().into(), best.held_out_rms()));
                }
                None => break,
            }
        }
        groups = self.thinned(groups, &mut best);
        (self.groups, self.fitted) = (groups, best);
        Some(())
    }

    /// Whether the group is to be named. `others` are the groups of the model without this group. `with` and `without`
    /// are the fits with and without it. A transmission error is not named if the fit without it leaves only the noise
    /// of the sensors. The reason is that its sines and cosines have no noise, so a fit prefers them to a noisy torque
    /// that varies with the angle, such as that of gravity. If the fit without a transmission error of the output shows
    /// the compliance, that error must also predict held-out blocks clearly better with the compliance held at this
    /// value.
    fn pays(&self, group: Group, others: &[Group], with: &Fitted, without: &Fitted) -> bool {
        if !group.pays(with, without) || (group.is_of_gear() && self.leaves_noise_only(without, STILL_NOISE))
        {
            return false;
        }
        if group != Group::Output || !self.shows_compliance(others, without) {
            return true;
        }
        self.at_compliance(others, without).is_some_and(|fit| group.pays(&fit, without))
    }

    /// Whether the root mean square error of a fit on held-out blocks is below `times` the noise of the averaged twist.
    /// The noise of the torque counts too, as a twist: multiplied by the compliance of the fit.
    fn leaves_noise_only(&self, fitted: &Fitted, times: f64) -> bool {
        let by_torque_rad = fitted.value(self.places.torque()) * self.rows.averaged_torque_noise_nm();
        fitted.held_out_rms() < times * libm::hypot(self.rows.averaged_noise_rad(), by_torque_rad)
    }

    /// Whether the fit `fitted` with the column groups `groups` predicts held-out blocks clearly better than a fit
    /// without the compliance. Always `false` if the rotor's inertia is stated or `groups` has no compliance.
    fn shows_compliance(&self, groups: &[Group], fitted: &Fitted) -> bool {
        let others: Vec<Group> = groups.iter().copied().filter(|g| *g != Group::Compliance).collect();
        self.rows.rotor_inertia_kgm2.is_none()
            && others.len() < groups.len()
            && self.fit(&others).is_some_and(|other| Group::Compliance.pays(fitted, &other))
    }

    /// Fit of the twist by the groups `groups` and a transmission error of the output. Compliance, friction and the
    /// rotor's inertia have the values of `without`, a fit without this error. `None` if a fit is impossible.
    fn at_compliance(&self, groups: &[Group], without: &Fitted) -> Option<Fitted> {
        let p = self.places;
        let elastic = [p.torque(), p.acceleration(), p.sense(), p.load_sense(), p.rate()];
        let target = p.further();
        let sums = self.rows.sums(target + 1, |i, _, row| {
            let is_filled = fill_known(self.rows, i, self.shift_s, row);
            let known: f64 = elastic.iter().map(|c| row[*c] * without.value(*c)).sum();
            row[target] -= known;
            is_filled
        });
        let free: Vec<Group> = groups.iter().copied().filter(|g| *g != Group::Compliance).collect();
        let free = [free.as_slice(), &[Group::Output]].concat();
        sums.fit(&columns(self.rows, &free), target, |c| self.prior(c))
    }

    /// Fit of the twist in which the compliance is `rad_per_nm` \[rad/(N m)\] and all other coefficients are free.
    /// `None` if a fit is impossible.
    pub(crate) fn with_compliance(&self, rad_per_nm: f64) -> Option<Fitted> {
        let (torque, target) = (self.places.torque(), self.places.further());
        let sums = self.rows.sums(target + 1, |i, _, row| {
            let is_filled = fill_known(self.rows, i, self.shift_s, row);
            row[target] -= rad_per_nm * row[torque];
            is_filled
        });
        let free: Vec<usize> = self.fitted.columns.iter().copied().filter(|c| *c != torque).collect();
        sums.fit(&free, target, |c| self.prior(c))
    }

    /// Compares a transmission error of the output with the compliance (see [`ErrorOrGravity`]). `None` if the rotor's
    /// inertia is stated, or if neither the error nor a compliance shows.
    fn error_or_gravity(&self) -> Option<ErrorOrGravity> {
        let others: Vec<Group> = self.groups.iter().copied().filter(|g| *g != Group::Output).collect();
        if !others.contains(&Group::Compliance) || self.rows.rotor_inertia_kgm2.is_some() {
            return None;
        }
        let without = self.fit(&others)?;
        let shows = self.shows_compliance(&others, &without);
        if !shows && !self.groups.contains(&Group::Output) {
            return None;
        }
        let all: Vec<Group> = others.iter().copied().chain([Group::Output]).collect();
        let mut with = self.fit(&all)?;
        // the coefficient of the acceleration is minus the compliance times the rotor's inertia
        let inertial = with.coefficient(self.places.acceleration());
        let is_held = if shows { inertial.value > 0.0 } else { inertial.low.is_some_and(|low| low > 0.0) };
        if inertial.value > 0.0 {
            let rest: Vec<usize> =
                with.columns.iter().copied().filter(|c| *c != self.places.acceleration()).collect();
            with = self.fit_with(&rest)?;
        }
        let at_compliance = self.at_compliance(&others, &without)?;
        let is_doubtful = !self.groups.contains(&Group::Output)
            && Group::Output.pays(&with, &without)
            && !self.leaves_noise_only(&without, SURELY_MORE);
        Some(ErrorOrGravity { without, at_compliance, with, shows, is_held, is_doubtful })
    }

    /// Upper bound of the compliance, whatever the friction is \[rad/(N m)\]. It is the twist that a time shift does
    /// not explain, divided by the torque that speed and Coulomb friction do not explain. Both are root mean squares,
    /// and the quotient is multiplied by a margin. Zero if a fit is impossible.
    pub(crate) fn largest_compliance(&self) -> f64 {
        const MARGIN: f64 = 1.5;
        let p = self.places;
        let free = [p.offsets(), vec![p.shift(), p.sense()]].concat();
        let loaded = self.sums.fit(&free, p.torque(), |_| None).map_or(0.0, |f| f.squares);
        let twisted = self.fit(&[Group::Shift]).map_or(0.0, |f| f.squares);
        if loaded > 0.0 { MARGIN * (twisted / loaded).sqrt() } else { 0.0 }
    }

    /// Removes a transmission error or the time shift from `groups` if the model without it predicts held-out blocks
    /// about as well. Returns the remaining groups, and stores their fit in `best`.
    fn thinned(&mut self, mut groups: Vec<Group>, best: &mut Fitted) -> Vec<Group> {
        for group in [Group::Input, Group::Output, Group::Shift] {
            let without: Vec<Group> = groups.iter().copied().filter(|g| *g != group).collect();
            if without.len() == groups.len() {
                continue;
            }
            if let Some(fit) = self.fit(&without).filter(|fit| !self.pays(group, &without, best, fit)) {
                self.steps.push((format!("without {}", group.step()), fit.held_out_rms()));
                (groups, *best) = (without, fit);
            }
        }
        groups
    }

    /// How clearly the model predicts held-out blocks better with the group than without it, in standard errors (see
    /// [`Fitted::better_than`]). 0 if a fit is impossible.
    pub(crate) fn gain(&self, group: Group) -> f64 {
        let others: Vec<Group> = self.groups.iter().copied().filter(|g| *g != group).collect();
        let all: Vec<Group> = others.iter().copied().chain([group]).collect();
        match (self.fit(&all), self.fit(&others)) {
            (Some(with), Some(without)) => with.better_than(&without),
            _ => 0.0,
        }
    }

    /// Fraction of the variance of the motor's torque, from 0 to 1, that is independent of other columns. It is the
    /// smaller of two fractions: the one that the joint's own motion (speed, its sign, and acceleration) does not
    /// explain, and the one that the other columns of the fit do not explain.
    pub(crate) fn own_share_of_torque(&self) -> f64 {
        let p = self.places;
        let mut own = vec![p.shift(), p.sense()];
        own.extend(self.rows.rotor_inertia_kgm2.is_none().then_some(p.acceleration()));
        self.sums.own_share(p.torque(), &p.offsets(), &own).min(self.own_share_in_fit())
    }
}

/// Time by which the link's signal is late \[s\], found by iteration: each fit reads the link's signal at the delay
/// found so far and gives a correction of the delay. `None` if a fit is impossible.
fn time_shift_s(rows: &JointRows) -> Option<f64> {
    let places = Places { records: rows.record_count() };
    let groups = if rows.has_torque { vec![Group::Shift, Group::Compliance] } else { vec![Group::Shift] };
    let target = places.further();
    let mut shift_s = 0.0;
    for _ in 0..ROUNDS {
        let sums = rows.sums(target + 1, |i, _, row| fill_known(rows, i, shift_s, row));
        let next_s = sums.fit(&columns(rows, &groups), target, |_| None)?.value(places.shift());
        let step_s = next_s - shift_s;
        shift_s = next_s;
        if step_s.abs() < 1e-3 * rows.step_s {
            return Some(shift_s);
        }
    }
    Some(shift_s)
}
