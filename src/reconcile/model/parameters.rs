//! A model to fit: the calibration within tolerance, which is always free, and a list of effects.

use super::calibration::Nuisance;
use super::estimate::Estimate;
use super::estimate::Interval;
use crate::arm::effect::entry::{Effect, word_of};
use crate::arm::effect::kind::{Absent, Kind, Parameter, Place, Scale};
use crate::arm::effect::subject::Subject;
use crate::arm::{BASE, PAYLOAD};
use crate::reconcile::forward::coefficients::Coefficients;
use crate::reconcile::forward::prepared::Forward;

/// One fitted parameter of an effect. A fit changes the scaled parameter `u`, which is of the order of 1.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeParameter {
    /// Name of the parameter.
    pub name: &'static str,
    /// Index of the component, if the parameter is a vector; otherwise 0.
    pub component: usize,
    scale: Scale,
    /// Reference from which `u` is scaled. For linear scales it is the value of the parameter at `u = 1`. For
    /// stiffnesses it is the stiffness at `u = 1`, and `u` is proportional to the compliance.
    reference: f64,
    /// Smallest value of `u` in a fit.
    pub low: f64,
    /// Largest value of `u` in a fit.
    pub high: f64,
    /// Name of another parameter of the effect below which this one cannot lie.
    not_below: Option<&'static str>,
    /// The value of `u` at which the effect is absent; `None` if the parameter does not say how large the effect is,
    /// but only how it acts.
    absent: Option<f64>,
    /// Smallest and largest value of `u` that are expected before the readings are used (the range of the prior).
    expected: (f64, f64),
}

/// All sizes below this fraction of the width of the expected range have equal prior probability.
const SMALL_SIZE: f64 = 0.01;

/// Largest compliance that is sought in a connection, bearing or base. It is a multiple of the compliance of the joint,
/// or, for a base, of the first compliant joint.
pub(crate) const LARGEST_COMPLIANCE: f64 = 100.0;

/// Stiffness that stands for a rigid part \[N m/rad\]. No reading can tell it from an infinite one.
const RIGID_NM_PER_RAD: f64 = 1e15;

impl FreeParameter {
    /// The fitted parameter for one component of `parameter`. `joint_stiffness` is the reference from which `u` is
    /// scaled: a stiffness \[N m/rad\] for compliances, and the largest torque on the joint \[N m\] for a torque.
    pub(crate) fn new(parameter: &Parameter, component: usize, joint_stiffness: f64) -> Self {
        let expected = parameter.prior;
        let (low, high) = (parameter.low, parameter.high);
        let (reference, (low, high), expected, absent) = match parameter.scale {
            // a torque is sought up to twice its expected size
            Scale::Torque => (joint_stiffness, (2.0 * expected.0, 2.0 * expected.1), expected, Some(0.0)),
            Scale::Linear => {
                let size = parameter.typical.abs().max(1e-12);
                let by_size = |(a, b): (f64, f64)| (a / size, b / size);
                let absent = match parameter.absent {
                    Absent::AtZero => Some(0.0),
                    Absent::AtOne => Some(1.0 / size),
                    Absent::Never => None,
                };
                (size, by_size((low, high)), by_size(expected), absent)
            }
            Scale::Stiffness if parameter.absent == Absent::Never => {
                (joint_stiffness, expected, expected, None)
            }
            Scale::Stiffness => {
                (joint_stiffness, (expected.0, expected.1.max(LARGEST_COMPLIANCE)), expected, Some(0.0))
            }
            Scale::Reciprocal => (1.0, (1.0 / high, 1.0 / low), expected, Some(1.0)),
            Scale::Log => {
                (1.0, (libm::log(low), libm::log(high)), (libm::log(expected.0), libm::log(expected.1)), None)
            }
        };
        let (scale, not_below) = (parameter.scale, parameter.not_below);
        Self { name: parameter.name, component, scale, reference, low, high, not_below, absent, expected }
    }

    /// This parameter, limited to values of `u` from `low` to `high`. Every value in the range is equally expected.
    pub(crate) fn within(self, low: f64, high: f64) -> Self {
        Self { low, high, expected: (low, high), ..self }
    }

    /// This parameter, sought from the lower limit divided by `factor` to the upper limit times `factor`. Its expected
    /// range does not change.
    pub(crate) fn widened(self, factor: f64) -> Self {
        Self { low: self.low / factor, high: self.high * factor, ..self }
    }

    /// Limits the range to values that files may give, so that whatever a fit finds can be read again. A compliance may
    /// still be zero. The effect is then absent, and it is not written to a file.
    pub(crate) fn keep_readable(&mut self, parameter: &Parameter) {
        let (least, most) = parameter.readable();
        let (low, high) = match self.reversed() {
            true => (self.u(most), self.u(least)),
            false => (self.u(least), self.u(most)),
        };
        if !(self.scale == Scale::Stiffness && self.is_size()) {
            self.low = self.low.clamp(low, high);
        }
        self.high = self.high.clamp(low, high);
    }

    /// Distance of `u` from its expected range, divided by the width of the range; 0 inside the range.
    pub fn beyond_expected(&self, u: f64) -> f64 {
        let (low, high) = self.expected;
        (u - high).max(low - u).max(0.0) / (high - low)
    }

    /// Value of the parameter, in its unit, at `u`.
    pub fn value(&self, u: f64) -> f64 {
        match self.scale {
            Scale::Linear | Scale::Torque => u * self.reference,
            Scale::Stiffness if u <= self.reference / RIGID_NM_PER_RAD => RIGID_NM_PER_RAD,
            Scale::Stiffness => self.reference / u,
            Scale::Reciprocal => 1.0 / u,
            Scale::Log => libm::exp(u),
        }
    }

    /// The `u` at which the parameter has the value `value`, which is in the parameter's unit.
    pub fn u(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear | Scale::Torque => value / self.reference,
            Scale::Stiffness => self.reference / value,
            Scale::Reciprocal => 1.0 / value,
            Scale::Log => libm::log(value),
        }
    }

    /// The fitted value `value` with its interval in the unit of the parameter, converted from `interval`, which is
    /// in `u`.
    pub fn estimate(&self, value: f64, interval: &Interval) -> Estimate {
        let (low, high) = match self.reversed() {
            true => (interval.high, interval.low),
            false => (interval.low, interval.high),
        };
        Estimate { value, low: low.map(|u| self.value(u)), high: high.map(|u| self.value(u)) }
    }

    /// This interval, with each open end replaced by a limit of the parameter if the parameter only says how an effect
    /// acts. A torque is positive, and a gear's slopes lie in the range that is searched. An open end stays open if the
    /// parameter says how large the effect is, because such a parameter has no limit.
    pub(crate) fn closed(&self, interval: Interval) -> Interval {
        match self.scale {
            Scale::Stiffness if self.absent.is_none() => {
                Interval { low: interval.low.or(Some(self.low)), high: interval.high.or(Some(self.high)) }
            }
            Scale::Log => Interval { low: interval.low.or(Some(f64::NEG_INFINITY)), ..interval },
            _ => interval,
        }
    }

    /// Whether the end `u` of an interval is a limit by which `closed` replaces an open end.
    pub(crate) fn is_limit(&self, u: f64) -> bool {
        match self.scale {
            Scale::Stiffness if self.absent.is_none() => u <= self.low || u >= self.high,
            Scale::Log => u == f64::NEG_INFINITY,
            _ => false,
        }
    }

    /// Whether the value falls when `u` rises.
    pub fn reversed(&self) -> bool {
        matches!(self.scale, Scale::Stiffness | Scale::Reciprocal)
    }

    /// Whether the parameter says how large the effect is. If not, it only says how the effect acts.
    pub(crate) fn is_size(&self) -> bool {
        self.absent.is_some()
    }

    /// Whether `u` stands for an infinite stiffness, so that the effect is absent. An end of an interval at this `u` is
    /// no bound of the stiffness.
    pub fn unbounded(&self, u: f64) -> bool {
        self.scale == Scale::Stiffness && u <= 1e-6
    }

    /// Difference of `u` from its value for an absent effect; `None` if the parameter does not say how large the
    /// effect is.
    pub(crate) fn departure(&self, u: f64) -> Option<f64> {
        self.absent.map(|absent| u - absent)
    }

    /// The value of `u` for an effect whose size is multiplied by `part`: the difference of `u` from its value for an
    /// absent effect is multiplied. It is `u` itself if the parameter does not say how large the effect is.
    pub(crate) fn scaled(&self, u: f64, part: f64) -> f64 {
        self.absent.map_or(u, |absent| absent + part * (u - absent))
    }

    /// Whether the interval `ends` of `u` contains the value at which the effect is absent; `None` if the parameter
    /// does not say how large the effect is.
    pub(crate) fn may_be_absent(&self, ends: &Interval) -> Option<bool> {
        let absent = self.absent?;
        Some(ends.low.is_none_or(|low| low <= absent) && ends.high.is_none_or(|high| high >= absent))
    }

    /// Whether `u` is at an end of its range where the effect has the largest size that is sought.
    fn is_at_its_limit(&self, u: f64) -> bool {
        // the end where the effect is absent is no limit
        let near = 1e-6 * (self.high - self.low);
        let ends = [self.low, self.high]
            .into_iter()
            .filter(|end| self.absent.is_some_and(|a| (end - a).abs() > near));
        ends.into_iter().any(|end| (u - end).abs() <= near)
    }

    /// Width of the prior at a value of `u`: the reciprocal of the prior density at this value.
    ///
    /// The size of an effect may be of any order of magnitude. So each decade of sizes is equally likely, up to the
    /// largest size that a part can have. If the parameter only says how an effect acts, every value in its expected
    /// range is equally likely.
    pub fn width(&self, u: f64) -> f64 {
        let range = self.expected.1 - self.expected.0;
        let Some(absent) = self.absent else { return range };
        // a density that falls as 1/size, cut off near zero where it would diverge
        let small = SMALL_SIZE * range;
        let decades = |end: f64| libm::log1p((end - absent).abs() / small);
        (decades(self.low) + decades(self.high)) * ((u - absent).abs() + small)
    }
}

/// A number of a candidate effect: one component of one parameter, fitted or stated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Number {
    /// The number is fitted: it is the next of the candidate's free parameters.
    Free,
    /// The number has this stated value.
    Stated(f64),
}

/// A candidate: an effect at a place, with the parameters that are fitted.
#[derive(Clone)]
pub struct Candidate {
    /// The kind of effect.
    pub kind: &'static Kind,
    /// Place of the effect: the name of a joint or link, `base`, or a channel.
    pub at: String,
    /// Parameters of the effect that are fitted.
    pub free_parameters: Vec<FreeParameter>,
    /// All numbers of the effect, fitted or stated, in the order of its kind's parameters.
    pub(crate) numbers: Vec<Number>,
    /// Starting points of fits, each a list of `u`, one per free parameter.
    pub starts: Vec<Vec<f64>>,
    /// Name and place of effects that have exactly the same consequences in this arm.
    pub twins: Vec<(String, String)>,
}

impl Candidate {
    /// Label of the candidate in reports: `effect@place`, and the channel if the effect is limited to one.
    pub fn label(&self) -> String {
        let label = format!("{}@{}", self.kind.name, self.at);
        self.words().into_iter().fold(label, |label, (_, _, word)| format!("{label} ({word})"))
    }

    /// Every number of the effect with the name of its parameter, in the order of the kind's parameters.
    pub(crate) fn named_numbers(&self) -> Vec<(&'static str, Number)> {
        // an effect may have other parameters at the base, at the payload or in a channel
        let count = |place: Place| (self.kind.parameters)(place).iter().map(|p| p.count).sum::<usize>();
        let is_own = |place: &&Place| match place {
            Place::Channel(channel) => channel.word() == self.at,
            Place::Base => self.at == BASE && count(Place::Base) == self.numbers.len(),
            Place::Payload => self.at == PAYLOAD && count(Place::Payload) == self.numbers.len(),
            _ => false,
        };
        let place = self.kind.places.iter().find(is_own).or(self.kind.places.first());
        let Some(place) = place else { return Vec::new() };
        let names = (self.kind.parameters)(*place).iter().flat_map(|p| std::iter::repeat_n(p.name, p.count));
        names.zip(self.numbers.iter().copied()).collect()
    }

    /// The stated parameters that files write as words and not as numbers: for each, name of the parameter, number
    /// and word.
    pub(crate) fn words(&self) -> Vec<(&'static str, f64, &'static str)> {
        let word = |(name, number): (&'static str, Number)| match number {
            Number::Stated(number) => Some((name, number, word_of(self.kind.name, name, number)?)),
            Number::Free => None,
        };
        self.named_numbers().into_iter().filter_map(word).collect()
    }

    /// Whether this candidate and `other` are the same effect at the same place, with different parameters fitted.
    pub(crate) fn is_variant_of(&self, other: &Self) -> bool {
        self.kind.name == other.kind.name && self.at == other.at && self.words() == other.words()
    }

    /// This candidate with additional starting points, towards every vertex of the range of a vector parameter. They
    /// are used for campaigns with few readings, in which a single start may miss the minimum.
    pub fn from_corners(mut self) -> Self {
        self.starts.extend(corners(&self.free_parameters));
        self
    }

    /// Values of all parameters of the effect, in their units and in the order of its kind, with the fitted ones at
    /// `u`.
    pub fn numbers(&self, u: &[f64]) -> Vec<f64> {
        let mut free = self.free_values(u).into_iter();
        let number = |number: &Number| match number {
            Number::Free => free.next().unwrap_or_default(),
            Number::Stated(value) => *value,
        };
        let mut numbers: Vec<f64> = self.numbers.iter().map(number).collect();
        (self.kind.traits.bounded)(&mut numbers);
        numbers
    }

    /// Whether the effect is absent at `u`, because a stiffness that stands for it is as good as infinite.
    pub(crate) fn is_rigid(&self, u: &[f64]) -> bool {
        let of_stiffness =
            |(free, _): &(&FreeParameter, &f64)| free.scale == Scale::Stiffness && free.is_size();
        let mut sizes = self.free_parameters.iter().zip(u).filter(of_stiffness).peekable();
        sizes.peek().is_some() && sizes.all(|(free, u)| free.value(*u) >= RIGID_NM_PER_RAD)
    }

    /// Values of the fitted parameters at `u`, in their units. A parameter that must not be below another is raised
    /// to it.
    pub fn free_values(&self, u: &[f64]) -> Vec<f64> {
        let mut out: Vec<f64> = self.free_parameters.iter().zip(u).map(|(k, u)| k.value(*u)).collect();
        for (i, parameter) in self.free_parameters.iter().enumerate() {
            if let Some(least) = self.free_parameters.iter().position(|k| Some(k.name) == parameter.not_below)
            {
                out[i] = out[i].max(out[least]);
            }
        }
        out
    }

    /// The effect with the fitted parameters at `u`, in the form of an arm file. `place` is the kind of place and
    /// selects the list of parameters.
    pub fn effect(&self, u: &[f64], place: Place) -> Effect {
        let numbers = self.numbers(u);
        let mut rest = numbers.as_slice();
        let parameters = (self.kind.parameters)(place)
            .iter()
            .map(|p| {
                let (own, others) = rest.split_at(p.count.min(rest.len()));
                rest = others;
                // a stiffness beyond the range of files is as good as rigid, and other values may miss the range by
                // rounding
                (p.name.to_string(), own.iter().map(|x| p.nearest(*x)).collect())
            })
            .collect();
        Effect { effect: self.kind.name.into(), at: self.at.clone(), parameters, source: None }
    }
}

/// Starting points for the components of a vector, each a list of `u`: a fifth of the way from zero to each vertex of
/// the vector's range. They are needed because at zero a descent may see no slope. Empty if the parameters are not
/// components of one vector.
fn corners(free_parameters: &[FreeParameter]) -> Vec<Vec<f64>> {
    if free_parameters.len() < 2 || free_parameters.iter().any(|k| k.name != free_parameters[0].name) {
        return Vec::new();
    }
    let end = |k: &FreeParameter, up: bool| 0.2 * if up { k.high } else { k.low };
    let corner =
        |bits: usize| free_parameters.iter().enumerate().map(|(i, k)| end(k, bits >> i & 1 == 1)).collect();
    (0..1 << free_parameters.len()).map(corner).collect()
}

/// A model to fit: the calibration and a list of effects. Its parameter vector lists the calibrated parameters first,
/// then the fitted parameters of each effect.
#[derive(Clone)]
pub struct Model<'a> {
    /// Calibrated parameters.
    pub nuisance: &'a Nuisance,
    /// Effects of the model.
    pub effects: Vec<&'a Candidate>,
    /// Width over which the jumps of slope of gear curves are smoothed when frequencies are computed \[ln of the
    /// torque\]; 0 for no smoothing.
    pub smoothing: f64,
    /// Index and value of each parameter that is held fixed.
    pub held: Vec<(usize, f64)>,
}

impl<'a> Model<'a> {
    /// The baseline: a model with the calibrated parameters `nuisance` and no effect.
    pub fn baseline(nuisance: &'a Nuisance) -> Self {
        Self { nuisance, effects: Vec::new(), smoothing: 0.0, held: Vec::new() }
    }

    /// A model with the effects that have the indices `effects` in `candidates`.
    pub fn of(nuisance: &'a Nuisance, candidates: &'a [Candidate], effects: &[usize]) -> Self {
        Self { effects: effects.iter().map(|&i| &candidates[i]).collect(), ..Self::baseline(nuisance) }
    }

    /// This model with the effect `effect` added.
    pub fn with(&self, effect: &'a Candidate) -> Self {
        let mut out = self.clone();
        out.effects.push(effect);
        out
    }

    /// This model without the effect that has the index `index`.
    pub fn without(&self, index: usize) -> Self {
        let mut out = self.clone();
        out.effects.remove(index);
        out
    }

    /// Indices, in the parameter vector, of the break points (T1, T2) of gear curves.
    pub fn break_points(&self) -> Vec<usize> {
        let first = self.calibrated();
        let free_parameters = self.free_parameters().enumerate();
        free_parameters
            .filter(|(_, k)| k.name == "t1_nm" || k.name == "t2_nm")
            .map(|(i, _)| first + i)
            .collect()
    }

    /// Index of the parameter below which the parameter with index `index` cannot lie; `None` if there is no such
    /// limit.
    fn floor(&self, index: usize) -> Option<usize> {
        let mut first = self.calibrated();
        for effect in &self.effects {
            if let Some(parameter) = index.checked_sub(first).and_then(|i| effect.free_parameters.get(i)) {
                return Some(
                    first
                        + effect.free_parameters.iter().position(|k| Some(k.name) == parameter.not_below)?,
                );
            }
            first += effect.free_parameters.len();
        }
        None
    }

    /// Whether the parameter with index `index` is at its lower limit or below it, if another parameter is this limit.
    /// Lowering the parameter further would have no effect.
    pub fn rests(&self, index: usize, u: &[f64]) -> bool {
        self.floor(index).is_some_and(|least| u[index] <= u[least])
    }

    /// For some parameters, another parameter is the lower limit. This function raises each parameter that lies below
    /// its limit to the limit. Below the limit a parameter has no effect on the predictions, so a descent would see no
    /// slope and leave the parameter where it is. A parameter that is held fixed is not raised. Its limit is lowered to
    /// it instead.
    pub fn put_in_order(&self, u: &mut [f64]) {
        for index in self.calibrated()..u.len() {
            let Some(least) = self.floor(index).filter(|least| u[index] < u[*least]) else { continue };
            match self.is_held(index) {
                false => u[index] = u[least],
                true if !self.is_held(least) => u[least] = u[index],
                true => {}
            }
        }
    }

    fn is_held(&self, index: usize) -> bool {
        self.held.iter().any(|(held, _)| *held == index)
    }

    /// Number of parameters: calibrated ones and those of effects.
    pub fn len(&self) -> usize {
        self.calibrated() + self.free_parameters().count()
    }

    /// Whether the model has no parameters.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of calibrated parameters.
    pub fn calibrated(&self) -> usize {
        self.nuisance.numbers.len()
    }

    /// The fitted parameters of all effects, in the order of the parameter vector.
    pub fn free_parameters(&self) -> impl Iterator<Item = &'a FreeParameter> + '_ {
        self.effects.iter().flat_map(|e| e.free_parameters.iter())
    }

    /// Index, in the parameter vector, of the first parameter of the effect with index `effect`.
    pub fn first_parameter(&self, effect: usize) -> usize {
        self.calibrated() + self.effects[..effect].iter().map(|e| e.free_parameters.len()).sum::<usize>()
    }

    /// Whether some effect of the model has, at the parameters `u`, the largest size that is sought.
    pub fn is_at_a_limit(&self, u: &[f64]) -> bool {
        self.free_parameters()
            .zip(&u[self.calibrated()..])
            .any(|(parameter, u)| parameter.is_at_its_limit(*u))
    }

    /// Smallest and largest value of `u` for the parameter with index `index`. Both are equal for a parameter that is
    /// held fixed.
    pub fn bounds(&self, index: usize) -> (f64, f64) {
        if let Some((_, value)) = self.held.iter().find(|(held, _)| *held == index) {
            return (*value, *value);
        }
        match index.checked_sub(self.calibrated()) {
            // eight standard deviations of the tolerance: beyond any real part
            None => (-8.0, 8.0),
            Some(i) => self.free_parameters().nth(i).map_or((0.0, 0.0), |k| (k.low, k.high)),
        }
    }

    /// The arm under test (subject) with the parameters `u`: the nominal arm, calibrated and with the model's
    /// effects.
    pub fn subject(&self, forward: &Forward, u: &[f64]) -> Subject {
        let mut subject = forward.nominal.clone();
        self.nuisance.apply(u, &mut subject);
        let mut at = self.calibrated();
        for effect in &self.effects {
            let own = &u[at..at + effect.free_parameters.len()];
            (effect.kind.apply)(&effect.numbers(own), &effect.at, &mut subject);
            at += effect.free_parameters.len();
        }
        subject
    }

    /// The coefficients (compliances, joint laws and masses) of the arm with the parameters `u`.
    pub fn coefficients(&self, forward: &Forward, u: &[f64]) -> Coefficients {
        let mut out = forward.coefficients(&self.subject(forward, u));
        out.smoothing = self.smoothing;
        out
    }

    /// Label of the model: the labels of its effects joined by `+`.
    pub fn label(&self) -> String {
        self.effects.iter().map(|e| e.label()).collect::<Vec<_>>().join(" + ")
    }
}
