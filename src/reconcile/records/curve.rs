//! Nonlinear torsion laws of a joint, in addition to a constant compliance: three segments, lost motion and hysteresis.
//!
//! A torsion law gives the twist as a function of the spring torque. This is the motor's torque at the output without
//! friction and without the torque that accelerates the rotor. The friction comes from the balance of torques, and the
//! rotor's inertia from the linear fit of the twist.
//!
//! In the model of the twist, a law is a few columns. They depend on the spring torque and on torques of the law: break
//! points, a closing torque or a half width `r`. The law's torques are first tried on a grid, and the best grid point
//! is improved by Gauss-Newton steps. The derivatives of the twist with respect to the law's torques are columns too,
//! so that the intervals contain the uncertainty of these torques. The columns at the spring torque `T` are
//!
//! - three segments: `clip(T, T1)` and `clip(T, T2)` in addition to `T`, with slopes that fall;
//! - lost motion: `tanh(T / T_c)`;
//! - hysteresis: `s - T`, where the state `s` follows `T` and stays within `r` of it.

use super::blocks::{Blocks, Fitted};
use super::friction::Friction;
use super::intervals::{covering, half, is_positive, widened};
use super::signals::Sample;
use super::twist::{CLEARLY, Group, Places, TwistModel, columns, fill, fill_known};
use crate::arm::effect::{hysteresis, lost_motion};
use crate::reconcile::model::estimate::Estimate;
use std::ops::Range;

/// Break points T1 and T2 that are tried, as fractions of the largest spring torque.
const BREAKS: [f64; 11] = [0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];
/// Closing torques T_c of lost motion that are tried, as fractions of the largest spring torque.
const CLOSING: [f64; 6] = [0.01, 0.02, 0.05, 0.1, 0.2, 0.4];
/// Half widths of a hysteresis (torques) that are tried, as fractions of the largest spring torque.
const PLAYS: [f64; 8] = [0.005, 0.01, 0.02, 0.04, 0.07, 0.12, 0.2, 0.3];
/// A law is accepted only if it predicts held-out blocks better by this many standard errors. The number is larger than
/// for a single column, because the law is the best one of a whole grid.
const CLEARLY_OF_GRID: f64 = 3.0;
/// A law is accepted only if it changes the twist by more than this fraction of the twist's root mean square. A smaller
/// change may be an error of the model of friction, which is simple.
pub(super) const LEAST_TWIST_CHANGE: f64 = 0.02;
/// A law whose improvement is not clear, because a few blocks have most of the error, may still be in the record. It is
/// reported as hidden if it lowers the root mean square error on held-out blocks to less than this fraction.
const HIDDEN: f64 = 0.5;
/// The two break points count as one if the gap between their intervals is at most this fraction of the second.
const ONE_BREAK: f64 = 0.2;
/// Number of Gauss-Newton steps that improve the torques of the laws.
const ROUNDS: usize = 5;
/// Largest change of a torque of a law in one Gauss-Newton step, as a fraction of this torque.
const LARGEST_STEP: f64 = 0.3;

/// A torsion law, with the torques at which it changes \[N m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Law {
    /// Three segments with the break points T1 and T2, `T1 < T2`.
    Segments(f64, f64),
    /// Lost motion (clearance) with the torque at which it closes.
    LostMotion(f64),
    /// Hysteresis with its half width, as a torque.
    Play(f64),
}

/// The torsion laws that the twist of a joint needs, and the fit of the twist that contains them.
#[derive(Clone)]
pub(crate) struct Curve {
    /// The laws in the order in which they were found.
    pub laws: Vec<Law>,
    /// Names of laws that were refused because their best coefficients are physically impossible, each with the reason.
    pub refused: Vec<(&'static str, &'static str)>,
    /// Name of another law that predicts held-out blocks about as well as a chosen one; `None` if there is none.
    pub competing: Option<&'static str>,
    /// Name of a law that may be hidden in the record (see [`HIDDEN`]), and the root mean square error on held-out
    /// blocks with it \[rad\]; `None` if there is none.
    pub hidden: Option<(&'static str, f64)>,
    /// Fit of the twist by the linear model and the columns of all laws.
    pub fitted: Fitted,
    /// Root mean square error of the twist on held-out blocks after each law was added \[rad\], with the law's name.
    pub steps: Vec<(String, f64)>,
    first: usize,
    /// Torque of the spring (the motor's torque without friction and rotor inertia), one per row \[N m\].
    pub spring_nm: Vec<f64>,
    /// Friction that is held at a known value in all fits with a law; `None` if the friction is free in these fits.
    pub held: Option<Held>,
}

/// Name of a torsion curve with three segments in `verdict.json`.
pub(crate) const TORSION_CURVE: &str = "torsion_curve";

impl Law {
    /// Name of the law in `verdict.json`.
    pub(crate) fn what(self) -> &'static str {
        match self {
            Law::Segments(..) => TORSION_CURVE,
            Law::LostMotion(_) => lost_motion::KIND.name,
            Law::Play(_) => hysteresis::KIND.name,
        }
    }

    /// Number of the law's torques that are fitted: two for three segments, otherwise one.
    fn torques(self) -> usize {
        if matches!(self, Law::Segments(..)) { 2 } else { 1 }
    }

    /// The four columns of the law at the spring torque `t` \[N m\]: two functions of `t` (shapes, see the head of this
    /// file), then their derivatives with respect to the law's torques. A law with a single torque has zeros in the
    /// place of the second shape and derivative. `drag` is the state `s` of the hysteresis \[N m\], for the law's half
    /// width and for one that is larger by the fraction [`WIDER`]. Other laws do not use it.
    fn columns(self, t: f64, drag: [f64; 2]) -> [f64; 4] {
        let beyond = |edge: f64| if t.abs() > edge { t.signum() } else { 0.0 };
        match self {
            Law::Segments(a, b) => [t.clamp(-a, a), t.clamp(-b, b), beyond(a), beyond(b)],
            Law::LostMotion(closing) => {
                let tanh = libm::tanh(t / closing);
                [tanh, 0.0, -t / closing.powi(2) * (1.0 - tanh * tanh), 0.0]
            }
            Law::Play(width) => [drag[0] - t, 0.0, (drag[1] - drag[0]) / (WIDER * width), 0.0],
        }
    }

    /// The law with its torques changed by `step` \[N m\], each by at most [`LARGEST_STEP`] of itself. Break points
    /// that would change their order stay as they are.
    fn moved(self, step: [f64; 2]) -> Self {
        let by = |torque: f64, step: f64| torque + step.clamp(-LARGEST_STEP * torque, LARGEST_STEP * torque);
        match self {
            Law::Segments(a, b) => {
                let (a, b) = (by(a, step[0]), by(b, step[1]));
                if a < b { Law::Segments(a, b) } else { self }
            }
            Law::LostMotion(c) => Law::LostMotion(by(c, step[0])),
            Law::Play(w) => Law::Play(by(w, step[0])),
        }
    }
}

/// Relative change of the half width of a hysteresis in the difference quotient that gives its derivative.
const WIDER: f64 = 0.01;

/// State `s` of a hysteresis with the half width `width` at each row \[N m\]: of all values within `width` of the
/// spring torque, the one that is nearest to the state of the row before. `record` gives the record of a row. In every
/// record the state starts at the spring torque of the first row.
fn dragged(spring_nm: &[f64], record: impl Fn(usize) -> usize, width: f64) -> Vec<f64> {
    let mut state = f64::NAN;
    let mut of = usize::MAX;
    let drag = |(i, t): (usize, &f64)| {
        if record(i) != of {
            (state, of) = (*t, record(i));
        }
        state = state.clamp(t - width, t + width);
        state
    };
    spring_nm.iter().enumerate().map(drag).collect()
}

/// Torque of the spring at each row \[N m\]: the motor's torque without friction and without the torque that
/// accelerates the rotor. The friction comes from the balance of torques `friction` where it is certain. Otherwise it
/// comes from the fit `fitted` of the twist, which may take a hysteresis for friction.
pub(crate) fn spring_torque(model: &TwistModel, fitted: &Fitted, friction: Option<&Friction>) -> Vec<f64> {
    let p = model.places;
    let of_twist = |column: usize| fitted.value(column) / fitted.value(p.torque());
    let sure = |k: usize, of: fn(&Friction) -> Estimate| {
        friction.filter(|f| f.clearly[k] && is_positive(&of(f))).map(|f| of(f).value)
    };
    let coulomb_nm = sure(0, |f| f.coulomb_nm);
    let viscous_nms_per_rad = sure(1, |f| f.viscous_nms_per_rad).unwrap_or(0.0);
    let [sense, load_part] = match coulomb_nm.zip(friction) {
        Some((coulomb_nm, f)) => [-coulomb_nm, -f.load_part.map_or(0.0, |part| part.value)],
        None => [of_twist(p.sense()), of_twist(p.load_sense())],
    };
    // in a fit without laws, the rate of the torque may describe a part of a hysteresis loop; it is then not used
    let has_laws = fitted.columns.iter().any(|c| *c >= p.further());
    let rate = if has_laws || coulomb_nm.is_none() { of_twist(p.rate()) } else { 0.0 };
    let inertia = of_twist(p.acceleration());
    let parts = [(p.torque(), 1.0), (p.acceleration(), inertia), (p.sense(), sense)];
    let parts = [parts.as_slice(), &[(p.load_sense(), load_part), (p.rate(), rate)]].concat();
    let mut row = vec![0.0; p.further() + 1];
    let torque_nm = |i: usize| {
        row.fill(0.0);
        fill(model.rows, i, model.shift_s, &mut row);
        let sum: f64 = parts.iter().map(|(column, factor)| row[*column] * factor).sum();
        sum - viscous_nms_per_rad * model.rows.samples[i].speed_rad_s
    };
    let mut out: Vec<f64> = (0..model.rows.samples.len()).map(torque_nm).collect();
    bridge(model, &mut out);
    out
}

/// Replaces the torque of the spring `spring_nm` \[N m\] at rows where friction is not known. Otherwise errors there
/// would stay in the state of a hysteresis and reach later rows. The new value is the torque of the load, which is
/// known without friction, plus an interpolated difference. It is the difference between spring torque and load torque
/// at the nearest known rows before and after.
fn bridge(model: &TwistModel, spring_nm: &mut [f64]) {
    let samples = &model.rows.samples;
    let mut row = 0;
    while row < samples.len() {
        let end = (row..samples.len()).find(|i| samples[*i].is_known()).unwrap_or(samples.len());
        if end > row {
            bridge_one(samples, row..end, spring_nm);
        }
        row = end + 1;
    }
}

/// Does what [`bridge`] says for the rows `gap`, none of which is known. Only known rows of the same record count.
fn bridge_one(samples: &[Sample], gap: Range<usize>, spring_nm: &mut [f64]) {
    let more = |i: usize| spring_nm[i] - samples[i].load_nm;
    let before = gap.start.checked_sub(1).map(|i| (samples[i].record, more(i)));
    let after = (gap.end < samples.len()).then(|| (samples[gap.end].record, more(gap.end)));
    let length = (gap.end - gap.start + 1) as f64;
    for i in gap.clone() {
        let own = |end: Option<(usize, f64)>| end.filter(|(r, _)| *r == samples[i].record).map(|(_, x)| x);
        let part = (i - gap.start + 1) as f64 / length;
        let more_nm = match (own(before), own(after)) {
            (Some(a), Some(b)) => a + part * (b - a),
            (Some(one), None) | (None, Some(one)) => one,
            (None, None) => continue,
        };
        spring_nm[i] = samples[i].load_nm + more_nm;
    }
}

/// Coulomb friction \[N m\], half of the width of its interval \[N m\], and friction torque for each newton metre of
/// load \[-\], all from the balance of torques.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Held {
    coulomb_nm: f64,
    spread_nm: f64,
    load_part: f64,
}

/// Friction that is held at the value of the balance of torques in all fits with a law. It is held if the linear fit of
/// the twist gives more friction on the motor's side than there is in all, because this fit then takes the loop of a
/// hysteresis for friction. `None` otherwise, also if the balance does not determine the friction.
fn held(model: &TwistModel, friction: Option<&Friction>) -> Option<Held> {
    let f = friction.filter(|f| f.clearly[0] && is_positive(&f.coulomb_nm))?;
    let out = Held {
        coulomb_nm: f.coulomb_nm.value,
        spread_nm: half(&f.coulomb_nm),
        load_part: f.load_part.map_or(0.0, |part| part.value),
    };
    let samples = &model.rows.samples;
    let mean_load_nm = samples.iter().map(|s| s.load_nm.abs()).sum::<f64>() / samples.len() as f64;
    let (p, fitted) = (model.places, &model.fitted);
    let of_twist = |c: usize| -fitted.value(c) / fitted.value(p.torque());
    let asked_nm = of_twist(p.sense()) + of_twist(p.load_sense()) * mean_load_nm;
    (asked_nm > out.coulomb_nm + out.load_part * mean_load_nm).then_some(out)
}

/// Finds up to two torsion laws beyond a single compliance, one after the other, each of which predicts held-out blocks
/// clearly better. The result has no laws if there are none. `None` if a fit is impossible.
pub(crate) fn curve(model: &TwistModel, friction: Option<&Friction>) -> Option<Curve> {
    let spring_nm = spring_torque(model, &model.fitted, friction);
    let (p, held) = (model.places, held(model, friction));
    let first = p.further();
    let is_free = |c: &usize| held.is_none() || ![p.sense(), p.load_sense()].contains(c);
    let own: Vec<usize> = columns(model.rows, &model.groups).into_iter().filter(is_free).collect();
    let mut out = Curve {
        laws: Vec::new(),
        refused: Vec::new(),
        competing: None,
        hidden: None,
        fitted: model.fitted.clone(),
        steps: Vec::new(),
        first,
        spring_nm,
        held,
    };
    let largest_nm = out.spring_nm.iter().fold(0.0f64, |m, t| m.max(t.abs()));
    for _ in 0..2 {
        let tried = out.best_of_grids(model, &own, largest_nm)?;
        let (at, torque) = (out.laws.len(), model.places.torque());
        let is_clear =
            |fit: &Fitted| fit.better_than(&out.fitted) > CLEARLY_OF_GRID || fit.halves(&out.fitted);
        let reason = |(law, fit): &(Law, Fitted)| impossible(fit, *law, first, at, torque);
        let clear: Vec<&(Law, Fitted)> = tried.iter().filter(|(_, fit)| is_clear(fit)).collect();
        let Some(best) = clear.first() else {
            let likely = tried.iter().find(|law| reason(law).is_none());
            let rms_rad = likely.map(|(law, fit)| (law.what(), fit.held_out_rms()));
            out.hidden = rms_rad.filter(|(_, rms_rad)| *rms_rad < HIDDEN * out.fitted.held_out_rms());
            break;
        };
        if !is_material(&best.1, best.0, first + 4 * at, &out.spring_nm, torque) {
            break;
        }
        if let Some(reason) = reason(best) {
            out.refused.push((best.0.what(), reason));
            break;
        }
        // laws are compared after their torques and the rotor's inertia have been improved
        let possible = clear.iter().filter(|law| reason(law).is_none()).map(|(law, _)| *law);
        let mut with: Vec<Curve> = possible.filter_map(|law| out.with(model, &own, law, friction)).collect();
        with.sort_by(|a, b| a.fitted.held_out_rms().total_cmp(&b.fitted.held_out_rms()));
        let others = with.split_off(with.len().min(1));
        let Some(next) = with.pop() else { break };
        let is_equal = |other: &&Curve| next.fitted.better_than(&other.fitted) < CLEARLY;
        let competing = out.competing.or(others.iter().find(is_equal).and_then(Curve::last));
        out = Curve { competing, ..next };
    }
    Some(out)
}

/// Whether a law changes the twist by more than [`LEAST_TWIST_CHANGE`] of the twist's root mean square. `at` is the
/// first column of the law, and `torque` the column whose coefficient is the compliance.
fn is_material(fit: &Fitted, law: Law, at: usize, spring_nm: &[f64], torque: usize) -> bool {
    let squares: f64 = spring_nm.iter().map(|t| t * t).sum();
    let twist_rad = fit.value(torque).abs() * (squares / spring_nm.len() as f64).sqrt();
    let size_rad = match law {
        Law::Segments(a, b) => fit.value(at).abs() * a + fit.value(at + 1).abs() * b,
        Law::LostMotion(_) => fit.value(at).abs(),
        Law::Play(width) => fit.value(at).abs() * width,
    };
    size_rad > LEAST_TWIST_CHANGE * twist_rad
}

/// Reason why the fitted coefficients of `law` are physically impossible; `None` if they are possible. `first` is the
/// index of the first column of all laws, and `before` the number of laws in front of `law`. `torque` is the index of
/// the column whose coefficient is the compliance.
fn impossible(fit: &Fitted, law: Law, first: usize, before: usize, torque: usize) -> Option<&'static str> {
    let size = fit.value(first + 4 * before);
    let second = fit.value(first + 4 * before + 1);
    let end = fit.value(torque);
    match law {
        Law::Play(_) if size <= 0.0 => Some(
            "the best value has the wrong sign: the twist would lead a reversal of torque, and play can only lag",
        ),
        Law::LostMotion(_) if size <= 0.0 => {
            Some("the best value is negative: the joint is stiffer near zero torque")
        }
        Law::Segments(..) if size < 0.0 || second < 0.0 || end <= 0.0 => {
            Some("the joint softens as the torque grows, and a gear stiffens")
        }
        _ => None,
    }
}

impl Curve {
    /// For each kind of law that was not found yet, the law of its grid that predicts held-out blocks best. Each is
    /// fitted together with the laws found before. `own` are the columns of the linear model, and `largest_nm` is the
    /// largest spring torque \[N m\]. The results are sorted by the error on held-out blocks, the smallest first.
    fn best_of_grids(
        &self,
        model: &TwistModel,
        own: &[usize],
        largest_nm: f64,
    ) -> Option<Vec<(Law, Fitted)>> {
        let has = |what: &str| self.laws.iter().any(|l| l.what() == what);
        let is_shaped = has(TORSION_CURVE) || has(lost_motion::KIND.name);
        let mut grids: Vec<Vec<Law>> = Vec::new();
        if !is_shaped {
            let pairs =
                BREAKS.iter().enumerate().flat_map(|(i, a)| BREAKS[i + 1..].iter().map(move |b| (*a, *b)));
            grids.push(pairs.map(|(a, b)| Law::Segments(a * largest_nm, b * largest_nm)).collect());
            grids.push(CLOSING.iter().map(|c| Law::LostMotion(c * largest_nm)).collect());
        }
        if !has(hysteresis::KIND.name) {
            grids.push(PLAYS.iter().map(|w| Law::Play(w * largest_nm)).collect());
        }
        let mut out: Vec<(Law, Fitted)> = Vec::new();
        for grid in grids {
            let single = self.singles(&grid);
            let laws = [self.laws.as_slice(), &single].concat();
            let fitted =
                |columns: &[usize], sums: &Blocks, target| sums.fit(columns, target, |c| model.prior(c));
            let (sums, target) = self.sums(model, &laws);
            let known = self.laws.len();
            let old: Vec<usize> = (0..known).flat_map(|i| self.law_columns(i, self.laws[i])).collect();
            let tried = grid.iter().filter_map(|law| {
                let new = self.shapes_of(*law, known, &single);
                Some((*law, fitted(&[own, &old, &new].concat(), &sums, target)?))
            });
            let torque = model.places.torque();
            // segments that stiffen as the torque grows are preferred: with the wrong rotor inertia of a fit without
            // the curve, the best segments may soften
            let softens = |(law, fit): &(Law, Fitted)| {
                let at = self.shapes_of(*law, known, &single);
                matches!(law, Law::Segments(..))
                    && (fit.value(torque) <= 0.0 || at.iter().any(|c| fit.value(*c) < 0.0))
            };
            let order = |law: &(Law, Fitted)| (softens(law), law.1.held_out_rms());
            let best =
                tried.min_by(|a, b| order(a).0.cmp(&order(b).0).then(order(a).1.total_cmp(&order(b).1)));
            let Some((law, _)) = best else { continue };
            // fitted again without the rest of the grid: the columns of the law then follow those of the earlier laws
            let laws = [self.laws.as_slice(), &[law]].concat();
            let (sums, target) = self.sums(model, &laws);
            let new = &self.law_columns(known, law)[..law.torques()];
            out.extend(fitted(&[own, &old, new].concat(), &sums, target).map(|fit| (law, fit)));
        }
        out.sort_by(|a, b| a.1.held_out_rms().total_cmp(&b.1.held_out_rms()));
        Some(out)
    }

    /// The laws of `grid`, so divided that each has a single torque, without repetitions. A pair of break points
    /// becomes one law for each break point. All pairs of the grid then share these columns.
    fn singles(&self, grid: &[Law]) -> Vec<Law> {
        let mut out: Vec<Law> = Vec::new();
        for law in grid {
            let one = match *law {
                Law::Segments(a, b) => vec![Law::Segments(a, a), Law::Segments(b, b)],
                other => vec![other],
            };
            for law in one {
                if !out.contains(&law) {
                    out.push(law);
                }
            }
        }
        out
    }

    /// Indices of the columns of the shapes of `law` in the sums that contain `known` earlier laws and then the laws
    /// `singles`.
    fn shapes_of(&self, law: Law, known: usize, singles: &[Law]) -> Vec<usize> {
        let place = |law: Law| singles.iter().position(|s| *s == law).map(|i| self.first + 4 * (known + i));
        match law {
            Law::Segments(a, b) => {
                [place(Law::Segments(a, a)), place(Law::Segments(b, b))].into_iter().flatten().collect()
            }
            other => place(other).into_iter().collect(),
        }
    }

    /// Indices of the columns of `law` if it has the index `place` among the laws: its shapes first, then the
    /// derivatives.
    fn law_columns(&self, place: usize, law: Law) -> Vec<usize> {
        let at = self.first + 4 * place;
        let n = law.torques();
        (at..at + n).chain(at + 2..at + 2 + n).collect()
    }

    /// Sums of the products of every two columns, block by block, with four columns for each of the `laws`. The second
    /// value is the index of the column of the recorded twist.
    fn sums(&self, model: &TwistModel, laws: &[Law]) -> (Blocks, usize) {
        let record = |i: usize| model.rows.samples[i].record;
        let plays: Vec<Option<[Vec<f64>; 2]>> = laws
            .iter()
            .map(|law| match law {
                Law::Play(w) => Some([*w, w * (1.0 + WIDER)].map(|w| dragged(&self.spring_nm, record, w))),
                _ => None,
            })
            .collect();
        let target = self.first + 4 * laws.len();
        let sums = model.rows.sums(target + 1, |i, _, row| {
            if !fill_known(model.rows, i, model.shift_s, row) {
                return false;
            }
            if let Some(held) = self.held {
                let p = model.places;
                row[p.torque()] -= held.coulomb_nm * row[p.sense()] + held.load_part * row[p.load_sense()];
            }
            for (k, law) in laws.iter().enumerate() {
                let drag = plays[k].as_ref().map_or([0.0; 2], |p| [p[0][i], p[1][i]]);
                let at = self.first + 4 * k;
                row[at..at + 4].copy_from_slice(&law.columns(self.spring_nm[i], drag));
            }
            true
        });
        (sums, target)
    }

    /// Name of the law that was found last; `None` if there is none.
    fn last(&self) -> Option<&'static str> {
        self.laws.last().map(|law| law.what())
    }

    /// The laws of this curve and `law`, with all torques improved. The spring torque is computed again while the fit
    /// improves, because a fit that lacks a law has a wrong rotor inertia. `None` if a fit is impossible.
    fn with(
        &self,
        model: &TwistModel,
        own: &[usize],
        law: Law,
        friction: Option<&Friction>,
    ) -> Option<Curve> {
        const ROUNDS: usize = 10;
        const STILL_BETTER: f64 = 0.99;
        let (laws, fitted) = self.improved(model, own, [self.laws.as_slice(), &[law]].concat())?;
        let mut out = Curve { laws, fitted, ..self.clone() };
        for _ in 0..ROUNDS {
            let spring_nm = spring_torque(model, &out.fitted, friction);
            let mut next = Curve { spring_nm, ..out.clone() };
            (next.laws, next.fitted) = next.improved(model, own, out.laws.clone())?;
            if next.fitted.squares > STILL_BETTER * out.fitted.squares {
                break;
            }
            out = next;
        }
        out.steps.push((law.what().replace('_', " "), out.fitted.held_out_rms()));
        Some(out)
    }

    /// Improves the torques of all `laws` together by [`ROUNDS`] Gauss-Newton steps. Returns the laws with the smallest
    /// sum of squared errors, and their fit by the columns `own` of the linear model and by all columns of the laws.
    fn improved(&self, model: &TwistModel, own: &[usize], mut laws: Vec<Law>) -> Option<(Vec<Law>, Fitted)> {
        let mut best: Option<(Vec<Law>, Fitted)> = None;
        for _ in 0..ROUNDS {
            let (sums, target) = self.sums(model, &laws);
            let extra = laws.iter().enumerate().flat_map(|(i, l)| self.law_columns(i, *l));
            let all: Vec<usize> = own.iter().copied().chain(extra).collect();
            let fit = sums.fit(&all, target, |c| model.prior(c))?;
            let step = |i: usize, k: usize| {
                let at = self.first + 4 * i;
                let size = fit.value(at + k);
                if size == 0.0 { 0.0 } else { fit.value(at + 2 + k) / size }
            };
            let next: Vec<Law> =
                laws.iter().enumerate().map(|(i, l)| l.moved([step(i, 0), step(i, 1)])).collect();
            let is_better = best.as_ref().is_none_or(|(_, b)| fit.squares <= b.squares * (1.0 + 1e-9));
            if is_better {
                best = Some((laws.clone(), fit));
            }
            laws = next;
        }
        best
    }

    /// Parameters of the law `law` with their 95 % intervals, named as in `verdict.json`; empty if the law was not
    /// found.
    pub(crate) fn parameters(&self, law: Law, places: Places) -> Vec<(String, Vec<Estimate>)> {
        let Some(place) = self.laws.iter().position(|l| *l == law) else { return Vec::new() };
        let at = self.first + 4 * place;
        let named = |name: &str, estimate: Estimate| (name.to_string(), vec![estimate]);
        let torque = places.torque();
        match law {
            Law::Segments(t1, t2) if self.has_one_break(place, [t1, t2]) => self.one_break(place, t1, torque),
            Law::Segments(t1, t2) => vec![
                named("k1_nm_per_rad", self.fitted.estimate(|c| 1.0 / (c(torque) + c(at) + c(at + 1)))),
                named("k2_nm_per_rad", self.fitted.estimate(|c| 1.0 / (c(torque) + c(at + 1)))),
                named("k3_nm_per_rad", self.fitted.estimate(|c| 1.0 / c(torque))),
                named("t1_nm", self.fitted.estimate(|c| t1 + c(at + 2) / c(at))),
                named("t2_nm", self.fitted.estimate(|c| t2 + c(at + 3) / c(at + 1))),
            ],
            Law::LostMotion(closing) => vec![
                named("half_width_rad", self.fitted.coefficient(at)),
                named("torque_nm", self.fitted.estimate(|c| closing + c(at + 2) / c(at))),
            ],
            Law::Play(width) => {
                // a friction that is held too large makes the hysteresis too narrow by as much
                let by_friction = self.held.map_or(0.0, |h| h.spread_nm * self.fitted.value(torque));
                let size = self.fitted.estimate(|c| c(at) * width + c(at + 2));
                vec![named("half_width_rad", widened(size, libm::hypot(half(&size), by_friction)))]
            }
        }
    }

    /// Both break points of three segments with their 95 % intervals \[N m\]. `place` is the index of the law, and
    /// `torques_nm` are its break points in the fit.
    fn breaks(&self, place: usize, torques_nm: [f64; 2]) -> [Estimate; 2] {
        let at = self.first + 4 * place;
        [0, 1].map(|k| self.fitted.estimate(|c| torques_nm[k] + c(at + 2 + k) / c(at + k)))
    }

    /// Whether only one break point can be told, because the interval of the first reaches the interval of the second
    /// within a margin. The known rows then do not reach the third segment.
    fn has_one_break(&self, place: usize, torques_nm: [f64; 2]) -> bool {
        let [first, second] = self.breaks(place, torques_nm);
        let margin = ONE_BREAK * torques_nm[1];
        first.high.zip(second.low).is_none_or(|(high, low)| high + margin >= low)
    }

    /// Parameters of a torsion curve whose third segment, at least as stiff as the second, begins beyond the largest
    /// torque of the record. `t1` is the first break point \[N m\], and `place` and `torque` are the indices of the law
    /// and of the column of the torque.
    fn one_break(&self, place: usize, t1: f64, torque: usize) -> Vec<(String, Vec<Estimate>)> {
        let at = self.first + 4 * place;
        let (Law::Segments(_, t2), known) = (self.laws[place], self.spring_nm.iter()) else {
            return Vec::new();
        };
        let largest_nm = known.fold(0.0f64, |m, t| m.max(t.abs()));
        let [first, second] = self.breaks(place, [t1, t2]);
        let upper = self.fitted.estimate(|c| 1.0 / c(torque));
        let start = covering(first, second);
        vec![
            ("k1_nm_per_rad".into(), vec![self.fitted.estimate(|c| 1.0 / (c(torque) + c(at) + c(at + 1)))]),
            ("k2_nm_per_rad".into(), vec![upper]),
            ("k3_nm_per_rad".into(), vec![Estimate { high: None, ..upper }]),
            ("t1_nm".into(), vec![start]),
            ("t2_nm".into(), vec![Estimate { value: largest_nm, low: start.low, high: None }]),
        ]
    }

    /// Twist of the spring according to the model, one per row \[rad\]: the compliance times the spring torque, plus
    /// the twist of all laws. `records` gives the index of the record of a row.
    pub(crate) fn spring_twist_rad(&self, places: Places, records: impl Fn(usize) -> usize) -> Vec<f64> {
        let compliance = self.fitted.value(places.torque());
        let mut out: Vec<f64> = self.spring_nm.iter().map(|t| compliance * t).collect();
        for (k, law) in self.laws.iter().enumerate() {
            let drag = match law {
                Law::Play(w) => dragged(&self.spring_nm, &records, *w),
                _ => vec![0.0; out.len()],
            };
            let at = self.first + 4 * k;
            for (i, twist) in out.iter_mut().enumerate() {
                let shape = law.columns(self.spring_nm[i], [drag[i]; 2]);
                *twist += shape[0] * self.fitted.value(at) + shape[1] * self.fitted.value(at + 1);
            }
        }
        out
    }

    /// Whether the model of the twist contains a compliance. Torsion laws are sought only in such a model.
    pub(crate) fn applies(model: &TwistModel) -> bool {
        model.groups.contains(&Group::Compliance)
    }
}
