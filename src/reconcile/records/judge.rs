//! Judges the records of one joint: which effects are found, which are absent, and about which the records say nothing.
//! The errors of the models are those on held-out blocks, which are blocks of time that were left out of a fit.

use super::blocks::Fitted;
use super::compliance::{ERROR_OF_UNKNOWN_SIZE, GRAVITY_OR_ERROR, compliance};
use super::curve::{Curve, LEAST_TWIST_CHANGE, Law, TORSION_CURVE, curve};
use super::friction::{Friction, friction, load_nm};
use super::intervals::{attenuated, covering, excludes_zero, half, is_positive, widened};
use super::other_cause::{OtherCause, other_cause};
use super::ringing::{joined, swings};
use super::signals::JointRows;
use super::twist::{Group, TwistModel, fill};
use super::wave::Wave;
use crate::arm::effect::{hysteresis, lost_motion};
use crate::reconcile::model::estimate::Estimate;
use crate::reconcile::readings::record::Record;
use crate::reconcile::verdict::joint_record::{JointRecord, State, Stated, Step, Traced};

/// Number of blocks of time into which the records of a joint are divided if each block is then long enough (see
/// [`LONG_BLOCK`]).
const BLOCKS: usize = 30;
/// Smallest number of blocks of time into which the records of a joint are divided, even if the blocks are then short.
const FEWEST_BLOCKS: usize = 10;
/// The number of blocks is chosen so that a block lasts at least this many times the correlation time of the errors.
/// [`FEWEST_BLOCKS`] goes first.
const LONG_BLOCK: f64 = 3.0;
/// Smallest half width of an interval of friction, as a fraction of the value, because the friction of a joint is
/// never constant.
const LEAST_FRICTION_PART: f64 = 0.01;
/// Smallest half width of an interval of a parameter of a torsion law, as a fraction of the value, because no gear
/// follows a law exactly.
const LEAST_LAW_PART: f64 = 0.05;
/// Smallest half width of the interval of a time shift, as a fraction of the time between rows.
const LEAST_STEP_PART: f64 = 0.01;
/// Approximate number of points in the picture of twist against torque.
const POINTS: usize = 600;
/// Transmission errors once and twice a turn of the output can be told apart only if the joint turns through at least
/// this angle \[rad\].
const TELLING_RANGE_RAD: f64 = 2.0;

/// Judges one joint from all records. `None` if no record has the angles on both sides of its gear, or a fit is
/// impossible.
pub(crate) fn judge(records: &[Record], joint: &str) -> Option<JointRecord> {
    let wave = Wave::find(records, joint);
    let rows = gathered(records, joint, BLOCKS, &wave)?;
    let model = TwistModel::find(&rows)?;
    let readings = rows.known_rows() as f64 / model.rows_per_reading / LONG_BLOCK;
    let blocks = (readings as usize).clamp(FEWEST_BLOCKS, BLOCKS);
    if blocks >= BLOCKS {
        return Some(Judged::new(&rows, &model, records).conclude());
    }
    let rows = gathered(records, joint, blocks, &wave)?;
    let model = TwistModel::find(&rows)?;
    Some(Judged::new(&rows, &model, records).conclude())
}

/// Rows of the joint from all records, with the torque of the load if the torque of the motor is recorded. `None` if no
/// record has the angles on both sides of the gear.
fn gathered(records: &[Record], joint: &str, blocks: usize, wave: &Wave) -> Option<JointRows> {
    let mut rows = JointRows::gather(records, joint, blocks, wave)?;
    if let Some(load_nm) = load_nm(&rows, records) {
        rows.take_load(&load_nm);
    }
    Some(rows)
}

/// Everything that the results for one joint are made of.
struct Judged<'a> {
    rows: &'a JointRows,
    model: &'a TwistModel<'a>,
    records: &'a [Record],
    friction: Option<Friction>,
    /// Smallest possible ratio of the fitted compliance to the true one, from 0 to 1 (see
    /// [`TwistModel::least_attenuation`]).
    least: f64,
    compliance: Stated,
    curve: Option<Curve>,
    /// A cause outside the library that explains the records better than the transmission error of the output in the
    /// model; `None` if there is no such error or cause.
    other_cause: Option<OtherCause>,
}

impl<'a> Judged<'a> {
    fn new(rows: &'a JointRows, model: &'a TwistModel<'a>, records: &'a [Record]) -> Self {
        let friction = balanced(rows, model, records);
        let least = model.least_attenuation(friction.map_or(1.0, |f| f.left_share_of_twist));
        let compliance = compliance(model, friction.map_or(1.0, |f| f.left_share), least);
        let is_found = compliance.state == State::Found && Curve::applies(model);
        let curve = if is_found { curve(model, friction.as_ref()) } else { None };
        let other_cause = other_cause(model);
        Self { rows, model, records, friction, least, compliance, curve, other_cause }
    }

    /// The last fit of the twist: the one with torsion laws if any was found, otherwise the linear one.
    fn fitted(&self) -> &Fitted {
        self.curve.as_ref().map_or(&self.model.fitted, |c| &c.fitted)
    }

    /// Result for the compliance of the joint, given as a stiffness with its interval.
    ///
    /// If hysteresis or lost motion was found, the value comes from the fit with these laws. The linear fit would take
    /// a part of them for compliance. The interval covers both fits if the model has a transmission error of the
    /// output, or if a law is not certain.
    ///
    /// The value of the linear fit stays if a torsion curve was found, because the segments of the curve are stated
    /// separately. It also stays if the compliance may be zero in the fit with laws.
    fn compliance_beside_laws(&self) -> Stated {
        let laws = self.curve.iter().flat_map(|c| &c.laws);
        let is_changed = !laws.clone().any(|l| matches!(l, Law::Segments(..))) && laws.count() > 0;
        let c = attenuated(self.fitted().coefficient(self.model.places.torque()), self.least);
        let c = widened(c, LEAST_LAW_PART * c.value.abs());
        let (Some(low), Some(high)) = (c.low.filter(|low| is_changed && *low > 0.0), c.high) else {
            return self.compliance.clone();
        };
        let mut stiffness = Estimate { value: 1.0 / c.value, low: Some(1.0 / high), high: Some(1.0 / low) };
        let is_sure = self
            .curve
            .iter()
            .all(|c| c.laws.iter().all(|l| law_stated(c, *l, self.model).state == State::Found));
        let linear = self.compliance.parameters.first().and_then(|(_, list)| list.first());
        if let Some(linear) = linear.filter(|_| !is_sure || self.model.groups.contains(&Group::Output)) {
            stiffness.low = stiffness.low.zip(linear.low).map(|(a, b)| a.min(b));
            stiffness.high = stiffness.high.zip(linear.high).map(|(a, b)| a.max(b));
        }
        let parameters = vec![("stiffness_nm_per_rad".into(), vec![stiffness])];
        Stated { parameters, ..self.compliance.clone() }
    }

    /// All results for the joint, as [`JointRecord`] lists them.
    fn conclude(self) -> JointRecord {
        let mut stated = vec![self.time_shift(), self.compliance_beside_laws()];
        stated.extend(self.laws());
        stated.extend(self.frictions());
        let output_error = self.output_error();
        let undecided = self.undecided(&output_error);
        stated.push(output_error);
        stated.push(self.input_error());
        stated.push(self.first_mode());
        let fitted = self.fitted();
        let (low, high) = self.rows.range_rad();
        let further = self.curve.iter().flat_map(|c| c.steps.iter());
        let steps = self.model.steps.iter().chain(further);
        JointRecord {
            joint: self.rows.joint.clone(),
            rotor_is_stated: self.rows.rotor_inertia_kgm2.is_some(),
            rows: self.rows.known_rows(),
            effective_rows: self.rows.known_rows() as f64 / self.model.rows_per_reading,
            blocks: self.rows.blocks,
            range_rad: high - low,
            noise_rad: self.rows.noise_rad(),
            averaged_noise_rad: self.rows.averaged_noise_rad(),
            before_rad: self.model.steps.first().map_or(0.0, |s| s.1),
            unshifted_rad: self.unshifted_rad(),
            after_rad: fitted.held_out_rms(),
            steps: steps.map(|(added, rad)| Step { added: added.clone(), held_out_rad: *rad }).collect(),
            trace: self.trace(),
            remarks: self.remarks(),
            undecided,
            unnamed: self.other_cause.as_ref().map(|c| c.sentence(&self.model.fitted)),
            stated,
        }
    }

    /// Root mean square error of the twist on held-out blocks \[rad\], if only an offset and the time shift are fitted.
    /// The time shift is left out if the model has none.
    fn unshifted_rad(&self) -> f64 {
        let shift: Vec<Group> = self.model.groups.iter().copied().filter(|g| *g == Group::Shift).collect();
        self.model.fit(&shift).map_or(0.0, |f| f.held_out_rms())
    }

    /// Lower and upper limit, from 0 to 1, of the fraction of Coulomb friction that acts on the motor's side of the
    /// spring. Friction on this side makes a loop of twist against torque. The fraction is 1 if the loop is as wide as
    /// the whole friction can make it. The limits are 0 and 1 if the friction is not determined.
    fn motor_part(&self) -> (f64, f64) {
        let p = self.model.places;
        let Some(f) = self.friction.filter(|f| f.clearly[0] && is_positive(&f.coulomb_nm)) else {
            return (0.0, 1.0);
        };
        let total = f.coulomb_nm;
        if self.curve.as_ref().is_some_and(|c| c.held.is_some() && !c.laws.is_empty()) {
            return ((1.0 - half(&total) / total.value).clamp(0.0, 1.0), 1.0);
        }
        let part = self.fitted().estimate(|c| -c(p.sense()) / c(p.torque()) / total.value);
        let spread = half(&total) / total.value;
        let ends = (part.low.unwrap_or(0.0) - spread, part.high.unwrap_or(1.0) + spread);
        (ends.0.clamp(0.0, 1.0), ends.1.clamp(0.0, 1.0))
    }

    /// Result for the time shift. Viscous friction between motor and spring has the same signal as a time shift: both
    /// are proportional to the speed. The balance of torques tells how much of the fitted coefficient is due to
    /// friction.
    fn time_shift(&self) -> Stated {
        let p = self.model.places;
        let fitted = self.fitted();
        let plain = match self.model.groups.contains(&Group::Shift) {
            true => fitted.coefficient(p.shift()),
            false => {
                let all = [self.model.groups.as_slice(), &[Group::Shift]].concat();
                match self.model.fit(&all) {
                    Some(fit) => fit.coefficient(p.shift()),
                    None => return Stated::none(Group::Shift.what(), State::NotIdentified, "nothing moves"),
                }
            }
        };
        let (shift, words) = self.with_friction(plain);
        let shift = widened(shift, LEAST_STEP_PART * self.rows.step_s);
        let is_shown = self.model.groups.contains(&Group::Shift) && excludes_zero(&shift);
        let is_clear = is_shown && self.is_material(shift.value);
        let absent = match is_shown {
            true => {
                "a shift changes the twist by less than 2 %: friction or a loop of another form could do the same"
            }
            false => "held-out blocks are not predicted better with a shift, or friction explains it as well",
        };
        let state = if is_clear { State::Found } else { State::Absent };
        Stated::one(Group::Shift.what(), state, "seconds", shift, if is_clear { &words } else { absent })
    }

    /// Whether a time shift of `shift_s` \[s\] changes the twist by more than the fraction [`LEAST_TWIST_CHANGE`] of
    /// its root mean square. A smaller change could have another cause: friction, hysteresis or lost motion that does
    /// not follow its formula.
    fn is_material(&self, shift_s: f64) -> bool {
        let size_rad = shift_s.abs() * self.rows.rms_speed_rad_s();
        let before_rad = self.model.steps.first().map_or(0.0, |s| s.1);
        size_rad > LEAST_TWIST_CHANGE * before_rad
    }

    /// The time shift \[s\] corrected for viscous friction, and a sentence on the correction. `plain` is the time shift
    /// of the fit, which is too small by the compliance times the viscous friction. The interval covers this correction
    /// for every compliance within its interval. If the viscous friction is not determined, the value is not corrected,
    /// and its interval is widened to both sides by the largest possible correction.
    fn with_friction(&self, plain: Estimate) -> (Estimate, String) {
        let c = self.bounded_compliance();
        let Some(f) = self.friction.filter(|f| f.is_possible && is_positive(&f.viscous_nms_per_rad)) else {
            let Some(f) = self.friction else { return (plain, String::new()) };
            // a viscous friction that is not determined may have any value whose torque stays below the largest torque
            // of the motor
            let most = |e: &Estimate| e.low.unwrap_or(0.0).abs().max(e.high.unwrap_or(0.0).abs());
            let reach = most(&c) * most(&f.viscous_nms_per_rad).min(f.most_viscous_nms_per_rad);
            let words = format!(
                "viscous friction, which is not determined, may count for up to {:.2} ms of it",
                1e3 * reach
            );
            return (widened(plain, half(&plain) + reach), words);
        };
        let is_known = is_positive(&c);
        let compliance = if is_known { c.value } else { 0.0 };
        let mut most_compliant = c.high.unwrap_or(0.0).max(0.0);
        // a negative fitted compliance is no upper bound of the true one
        if self.compliance.state != State::Found && c.value <= 0.0 {
            most_compliant = most_compliant.max(self.model.largest_compliance());
        }
        let (least, most) = match self.motor_part() {
            // if a part of Coulomb friction is certainly behind the spring, any part of the viscous friction may be
            // there too
            (least, most) if is_known && most >= 1.0 => (least, most),
            _ => (0.0, 1.0),
        };
        let viscous = f.viscous_nms_per_rad;
        let by_friction = |part: f64| part * compliance * viscous.value;
        let spread = |part: f64| {
            let (by_viscous, by_compliance) =
                (compliance * half(&viscous), (most_compliant - compliance) * viscous.value);
            libm::hypot(half(&plain), part * libm::hypot(by_viscous, by_compliance))
        };
        let value = plain.value + by_friction(most);
        let out = Estimate {
            value,
            low: Some((plain.value + by_friction(least) - spread(least)).min(value - spread(most))),
            high: Some(value + spread(most)),
        };
        let words = format!(
            "viscous friction counts for {:.2} ms of it ({:.2} ms if a part of the friction sits behind the spring)",
            1e3 * by_friction(most),
            1e3 * by_friction(least)
        );
        (out, words)
    }

    /// Compliance of the last fit \[rad/(N m)\] without the twist of torsion laws. Its interval is widened because
    /// noise of the torque makes the fitted value too small, but not beyond the largest compliance that the recorded
    /// twist allows.
    fn bounded_compliance(&self) -> Estimate {
        let fitted = self.fitted().coefficient(self.model.places.torque());
        let bound = self.model.largest_compliance();
        let noisy = attenuated(fitted, self.least);
        Estimate {
            value: fitted.value,
            low: fitted.low.zip(noisy.low).map(|(fitted, noisy)| noisy.max(fitted.min(-bound))),
            high: fitted.high.zip(noisy.high).map(|(fitted, noisy)| noisy.min(fitted.max(bound))),
        }
    }

    /// Results for the torsion curve, hysteresis and lost motion.
    fn laws(&self) -> Vec<Stated> {
        let all = [TORSION_CURVE, hysteresis::KIND.name, lost_motion::KIND.name];
        let Some(curve) = &self.curve else {
            return all
                .map(|w| Stated::none(w, State::NotIdentified, "compliance is not identified"))
                .to_vec();
        };
        let state = |what: &'static str| {
            if let Some(law) = curve.laws.iter().find(|l| l.what() == what) {
                return law_stated(curve, *law, self.model);
            }
            if let Some((_, reason)) = curve.refused.iter().find(|(w, _)| *w == what) {
                return Stated::none(what, State::Refused, *reason);
            }
            Stated::none(what, State::Absent, "held-out blocks are not predicted better with it")
        };
        all.map(state).to_vec()
    }

    /// Results for Coulomb friction, viscous friction and load-dependent friction.
    fn frictions(&self) -> Vec<Stated> {
        let names = ["coulomb_friction", "viscous_friction", "load_friction"];
        let Some(f) = self.friction else {
            let words = if self.rows.has_torque { "nothing moves" } else { "the torque is not recorded" };
            return names.map(|n| Stated::none(n, State::NotIdentified, words)).to_vec();
        };
        let one = |what, name, estimate: Estimate, clearly: bool| {
            let estimate = widened(estimate, LEAST_FRICTION_PART * estimate.value.abs());
            if clearly && is_positive(&estimate) {
                return Stated::one(what, State::Found, name, estimate, "");
            }
            if clearly && estimate.high.is_some_and(|h| h < 0.0) {
                let words =
                    "the best value drives the motion: the load of the joint is not what is assumed of it";
                return Stated::one(what, State::Refused, name, estimate, words);
            }
            let why = if is_positive(&estimate) {
                "held-out blocks are as good without it"
            } else {
                "the interval contains zero"
            };
            Stated::one(what, State::NotIdentified, name, estimate, why)
        };
        let load = match f.load_part {
            Some(part) => Stated::one(names[2], State::Found, "nm_per_nm", part, ""),
            None => Stated::none(names[2], State::Absent, "held-out blocks are not predicted better with it"),
        };
        vec![
            one(names[0], "torque_nm", f.coulomb_nm, f.clearly[0]),
            one(names[1], "nms_per_rad", f.viscous_nms_per_rad, f.clearly[1]),
            load,
        ]
    }

    /// Result for the transmission error of the output. This effect is defined as the link's angle minus the motor's
    /// angle. The twist has the opposite sign, so the coefficients are negated.
    fn output_error(&self) -> Stated {
        let what = Group::Output.what();
        let beside = self.model.error_or_gravity.as_ref();
        if !self.model.groups.contains(&Group::Output) {
            return match beside.filter(|b| b.is_doubtful) {
                Some(_) => Stated::none(what, State::NotIdentified, GRAVITY_OR_ERROR),
                None => Stated::none(what, State::Absent, "held-out blocks are not predicted better with it"),
            };
        }
        if let Some(cause) = &self.other_cause {
            return Stated::none(what, State::NotIdentified, cause.sentence(&self.model.fitted));
        }
        let (low, high) = self.rows.range_rad();
        let columns = self.model.places.output();
        let at_ends = self.errors_at_ends();
        let fits: Vec<&Fitted> =
            [Some(&self.model.fitted), beside.filter(|b| b.shows || b.is_held).map(|b| &b.at_compliance)]
                .into_iter()
                .flatten()
                .chain(&at_ends)
                .collect();
        // the compliance of the fit without the transmission error may be the true one, so the interval covers the
        // error fitted at this compliance too
        let both =
            |of: &dyn Fn(&Fitted) -> Estimate| fits[1..].iter().fold(of(fits[0]), |a, f| covering(a, of(f)));
        let size = both(&|fitted| error_size(fitted, columns, low, high, 1.0));
        let mut each: Vec<Estimate> = columns.map(|c| both(&|fitted| fitted.estimate(|of| -of(c)))).to_vec();
        let size = widen_error(size, &mut each);
        let mut words = String::new();
        if high - low < TELLING_RANGE_RAD {
            each.iter_mut().for_each(|e| (e.low, e.high) = (None, None));
            words = format!(
                "the joint turned through {:.0} deg only: once and twice a turn cannot be told apart; over that range the \
                 error is what is given from peak to peak",
                (high - low).to_degrees()
            );
        }
        error_stated(what, size, each, words)
    }

    /// Fits of the transmission error of the output at both ends of the interval of the compliance, if the rotor's
    /// inertia is not stated. A larger compliance explains more of the twist that varies with the angle, and leaves
    /// less for the transmission error. Empty if the inertia is stated or the compliance has no value.
    fn errors_at_ends(&self) -> Vec<Fitted> {
        let stiffness = self.compliance.parameters.first().and_then(|(_, list)| list.first());
        let Some(k) = stiffness.filter(|_| self.rows.rotor_inertia_kgm2.is_none()) else { return Vec::new() };
        let ends = [k.low, k.high].into_iter().flatten();
        ends.filter_map(|k| self.model.with_compliance(1.0 / k)).collect()
    }

    /// Result for the transmission error of the input, with the sign of [`Judged::output_error`].
    fn input_error(&self) -> Stated {
        let what = Group::Input.what();
        let Some(ratio) = self.rows.ratio.filter(|n| *n > 1.0) else {
            return Stated::none(what, State::NotIdentified, "the ratio is not stated in campaign.json");
        };
        if !self.model.groups.contains(&Group::Input) {
            return Stated::none(what, State::Absent, "held-out blocks are not predicted better with it");
        }
        let columns = self.model.places.input();
        let size = error_size(&self.model.fitted, columns, 0.0, std::f64::consts::TAU / ratio, ratio);
        let mut each = columns.map(|c| self.model.fitted.estimate(|of| -of(c))).to_vec();
        let size = widen_error(size, &mut each);
        error_stated(what, size, each, String::new())
    }

    /// Result for the frequency of free vibration while the motor stands still.
    fn first_mode(&self) -> Stated {
        let found = self.records.iter().flat_map(|r| {
            let own = r.joints.iter().filter(|j| j.joint == self.rows.joint && !j.link_rad.is_empty());
            own.flat_map(|j| swings(&r.t_s, &j.motor_rad, &j.link_rad)).collect::<Vec<_>>()
        });
        let found: Vec<_> = found.collect();
        match joined(&found) {
            Some(r) => {
                let words = format!(
                    "damping {:.2} % of critical, from {} stretch(es) in which the motor rests",
                    100.0 * r.damping,
                    r.stretches
                );
                Stated::one("first_mode", State::Found, "frequency_hz", r.frequency_hz, &words)
            }
            None => Stated::none("first_mode", State::Absent, "no free ringing while the motor rests"),
        }
    }

    /// Sentences on what the records leave open. If there are any, the joint does not count as settled, even if little
    /// error is left. `output_error` is the result for the transmission error of the output. Empty if nothing is open.
    fn undecided(&self, output_error: &Stated) -> Vec<String> {
        let mut out = Vec::new();
        let is_needed = self.model.groups.contains(&Group::Output) && self.other_cause.is_none();
        if is_needed && output_error.state == State::NotIdentified {
            out.push(ERROR_OF_UNKNOWN_SIZE.into());
        }
        if self.model.error_or_gravity.as_ref().is_some_and(|b| b.is_doubtful) {
            out.push(GRAVITY_OR_ERROR.into());
        }
        if let Some((law, rms_rad)) = self.curve.as_ref().and_then(|c| c.hidden) {
            out.push(format!(
                "with a {} {:.4} instead of {:.4} mrad of the twist would be left, but held-out blocks do not show it clearly: a longer \
                 record, or one with larger torques, may",
                law.replace('_', " "),
                1e3 * rms_rad,
                1e3 * self.fitted().held_out_rms()
            ));
        }
        out
    }

    /// Remarks for the reader: a law that predicts as well as the chosen one, and a torque that may have the wrong
    /// sign.
    fn remarks(&self) -> Vec<String> {
        let mut out = Vec::new();
        if let Some(competing) = self.curve.as_ref().and_then(|c| c.competing) {
            out.push(format!(
                "held-out blocks cannot tell the law of the twist from {}",
                competing.replace('_', " ")
            ));
        }
        let refused = self.model.fitted.value(self.model.places.torque()) < 0.0;
        if refused && self.compliance.state == State::Refused {
            out.push("the link runs ahead of the motor as the torque grows: is the sign of the torque that of the angles?".into());
        }
        out
    }

    /// Points for the picture of twist against torque, from about [`POINTS`] rows. Each has the twist as recorded, the
    /// twist with everything but the spring and its friction removed, and the twist of the model.
    fn trace(&self) -> Vec<Traced> {
        let model = self.model;
        let p = model.places;
        let mut row = vec![0.0; p.further() + 1];
        let fitted = self.curve.as_ref().map_or(&model.fitted, |c| &c.fitted);
        let record = |i: usize| self.rows.samples[i].record;
        let spring = self.curve.as_ref().map(|c| (c.spring_twist_rad(p, record), &c.spring_nm));
        let elastic = [p.torque(), p.sense(), p.load_sense(), p.acceleration(), p.rate()];
        let every = (self.rows.samples.len() / POINTS).max(1);
        let mut out = Vec::new();
        for i in (0..self.rows.samples.len()).step_by(every) {
            row.fill(0.0);
            if self.rows.samples[i].rests || !fill(self.rows, i, model.shift_s, &mut row) {
                continue;
            }
            let part = |c: &usize| row[*c] * fitted.value(*c);
            let linear: f64 = elastic.iter().map(part).sum();
            let others: f64 = model.fitted.columns.iter().filter(|c| !elastic.contains(c)).map(part).sum();
            let y = row[row.len() - 1];
            let offset = row[..p.records].iter().zip(0..).map(|(x, c)| x * fitted.value(c)).sum::<f64>();
            let (torque_nm, model_rad) = match &spring {
                Some((twist, torque)) => (torque[i], twist[i]),
                None => (self.rows.samples[i].torque_nm, linear),
            };
            out.push(Traced { torque_nm, before_rad: y - offset, after_rad: y - others, model_rad });
        }
        out
    }
}

/// Friction of a joint from the balance of torques, with the delay of the link's readings removed. The delay that the
/// fit of the twist gives is too small by the effect of viscous friction, so friction and delay are improved in turn.
/// `None` if the torque is not recorded or a fit is impossible.
fn balanced(rows: &JointRows, model: &TwistModel, records: &[Record]) -> Option<Friction> {
    const ROUNDS: usize = 5;
    let compliance = model.fitted.value(model.places.torque()).max(0.0);
    let mut out = friction(rows, records, model.shift_s)?;
    for _ in 1..ROUNDS {
        let is_sure = out.clearly[1] && is_positive(&out.viscous_nms_per_rad);
        let hidden_s = if is_sure { compliance * out.viscous_nms_per_rad.value } else { 0.0 };
        out = friction(rows, records, model.shift_s + hidden_s)?;
    }
    Some(out)
}

/// Transmission error from peak to peak \[rad\] according to the fit `fitted`, over the angles of the output from `low`
/// to `high` \[rad\]. `columns` are the indices of its columns: sine and cosine of the angle times `ratio`, then of
/// twice that. `ratio` is 1 for the output and the gear ratio for the input.
fn error_size(fitted: &Fitted, columns: [usize; 4], low: f64, high: f64, ratio: f64) -> Estimate {
    const STEPS: usize = 60;
    fitted.estimate(|c| {
        let ends = (f64::INFINITY, f64::NEG_INFINITY);
        let (least, most) = (0..=STEPS).fold(ends, |(least, most), i| {
            let (sin, cos) = libm::sincos(ratio * (low + (high - low) * i as f64 / STEPS as f64));
            let shapes = [sin, cos, 2.0 * sin * cos, cos * cos - sin * sin];
            let error: f64 = shapes.iter().zip(columns).map(|(s, k)| s * c(k)).sum();
            (least.min(error), most.max(error))
        });
        most - least
    })
}

/// Result for a transmission error named `what`: its size from peak to peak and its four amplitudes. It is not
/// identified if the interval of its size contains zero: the records then do not tell it from its absence.
fn error_stated(what: &'static str, size: Estimate, each: Vec<Estimate>, words: String) -> Stated {
    let is_shown = is_positive(&size);
    let parameters = vec![("peak_to_peak_rad".into(), vec![size]), ("sin_cos_sin2_cos2_rad".into(), each)];
    match is_shown {
        true => Stated { what, state: State::Found, parameters, words },
        false => {
            let words = "the interval of its size contains zero".into();
            Stated { what, state: State::NotIdentified, parameters, words }
        }
    }
}

/// Widens the interval of the size of a transmission error (from peak to peak) and the intervals of its amplitudes.
/// Their half widths become at least [`LEAST_LAW_PART`] of the size and of the largest amplitude. There are two
/// reasons: no gear has waves of these orders only, and the link does not follow fast waves. Every amplitude is widened
/// by the same amount, because a small error of the phase changes it by a fraction of the largest one.
fn widen_error(size: Estimate, amplitudes: &mut [Estimate]) -> Estimate {
    let largest_rad = amplitudes.iter().fold(0.0f64, |m, e| m.max(e.value.abs()));
    for amplitude in amplitudes {
        *amplitude = widened(*amplitude, LEAST_LAW_PART * largest_rad);
    }
    widened(size, LEAST_LAW_PART * size.value)
}

/// Result for a torsion law that was found: its parameters with widened intervals. It is not identified if the interval
/// of one of them contains zero.
fn law_stated(curve: &Curve, law: Law, model: &TwistModel) -> Stated {
    let wide = |e: &Estimate| widened(*e, LEAST_LAW_PART * e.value.abs());
    let parameters: Vec<(String, Vec<Estimate>)> = curve
        .parameters(law, model.places)
        .into_iter()
        .map(|(name, list)| (name, list.iter().map(wide).collect()))
        .collect();
    // every parameter (size, torque, stiffness) must be positive over its whole interval
    let is_bounded = parameters.iter().flat_map(|(_, list)| list).all(is_positive);
    let state = if is_bounded { State::Found } else { State::NotIdentified };
    let words = match (is_bounded, law) {
        (true, _) => "",
        (false, Law::Segments(..)) => "the interval of a stiffness or of a torque of the curve contains zero",
        (false, _) => "the interval of its size or of its torque contains zero",
    };
    Stated { what: law.what(), state, parameters, words: words.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_whose_size_may_be_zero_is_not_found() {
        let of = |low| Estimate { value: 1.78e-4, low: Some(low), high: Some(2.19e-2) };
        let state = |low| error_stated("transmission_error", of(low), Vec::new(), String::new()).state;
        assert_eq!([state(-2.46e-4), state(6.3e-5)], [State::NotIdentified, State::Found]);
    }
}
