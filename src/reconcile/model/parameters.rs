//! A model to fit: the calibration that tolerance allows, always free, and a list of effects.

use super::estimate::Estimate;
use super::estimate::Interval;
use crate::arm::effect::entry::Effect;
use crate::arm::effect::kind::{Absent, Kind, Parameter, Place, Scale};
use crate::arm::effect::subject::Subject;
use crate::arm::joint_law::Curve;
use crate::arm::structure::Piece;
use crate::arm::{Arm, Element, LinkBody};
use crate::reconcile::forward::coefficients::Coefficients;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::readings::campaign::Tolerance;

/// One fitted number of an effect: `u` is what the fit moves, near 1 in size.
#[derive(Debug, Clone, PartialEq)]
pub struct Knob {
    /// Name of the parameter.
    pub name: &'static str,
    /// Component of a vector parameter.
    pub component: usize,
    scale: Scale,
    /// Value of `u = 1` for linear scales; the stiffness whose compliance is 1 for stiffnesses.
    reference: f64,
    /// Smallest `u`.
    pub low: f64,
    /// Largest `u`.
    pub high: f64,
    /// Another number of the effect that this one is not below.
    not_below: Option<&'static str>,
    /// The `u` at which the effect is absent; `None` where the number says how and not how much.
    absent: Option<f64>,
    /// Within what `u` is expected.
    expected: (f64, f64),
}

/// Part of the prior's width below which sizes of an effect are equally likely.
const SMALL: f64 = 0.01;

/// Compliance of a connection, bearing or base up to which one is looked for, in that of the joint.
const SOFTEST: f64 = 100.0;

/// A stiffness no reading can tell from rigid \[N m/rad\].
const RIGID_NM_PER_RAD: f64 = 1e15;

impl Knob {
    /// A component of a parameter; compliances are measured by that of a joint \[N m/rad\].
    pub(crate) fn new(parameter: &Parameter, component: usize, joint_stiffness: f64) -> Self {
        let expected = parameter.prior;
        let (low, high) = (parameter.low, parameter.high);
        let (reference, (low, high), expected, absent) = match parameter.scale {
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
            Scale::Stiffness => (joint_stiffness, (expected.0, expected.1.max(SOFTEST)), expected, Some(0.0)),
            Scale::Reciprocal => (1.0, (1.0 / high, 1.0 / low), expected, Some(1.0)),
            Scale::Log => (1.0, (low.ln(), high.ln()), (expected.0.ln(), expected.1.ln()), None),
        };
        let (scale, not_below) = (parameter.scale, parameter.not_below);
        Self { name: parameter.name, component, scale, reference, low, high, not_below, absent, expected }
    }

    /// The same number within these limits of `u`, all of which is expected.
    pub(crate) fn within(self, low: f64, high: f64) -> Self {
        Self { low, high, expected: (low, high), ..self }
    }

    /// How far a number is beyond what is expected, in the width of that.
    pub fn beyond_expected(&self, u: f64) -> f64 {
        let (low, high) = self.expected;
        (u - high).max(low - u).max(0.0) / (high - low)
    }

    /// The parameter's value.
    pub fn value(&self, u: f64) -> f64 {
        match self.scale {
            Scale::Linear => u * self.reference,
            Scale::Stiffness if u <= self.reference / RIGID_NM_PER_RAD => RIGID_NM_PER_RAD,
            Scale::Stiffness => self.reference / u,
            Scale::Reciprocal => 1.0 / u,
            Scale::Log => u.exp(),
        }
    }

    /// The `u` of a value.
    pub fn u(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => value / self.reference,
            Scale::Stiffness => self.reference / value,
            Scale::Reciprocal => 1.0 / value,
            Scale::Log => value.ln(),
        }
    }

    /// A fitted value with the interval of its `u`.
    pub fn estimate(&self, value: f64, interval: &Interval) -> Estimate {
        let (low, high) = match self.reversed() {
            true => (interval.high, interval.low),
            false => (interval.low, interval.high),
        };
        Estimate { value, low: low.map(|u| self.value(u)), high: high.map(|u| self.value(u)) }
    }

    /// Whether the value falls when `u` rises.
    pub fn reversed(&self) -> bool {
        matches!(self.scale, Scale::Stiffness | Scale::Reciprocal)
    }

    /// Whether `u` stands for an absent effect or no bound at all at this end.
    pub fn unbounded(&self, u: f64) -> bool {
        self.scale == Scale::Stiffness && u <= 1e-6
    }

    /// Whether the effect is as large as is looked for.
    fn is_at_its_limit(&self, u: f64) -> bool {
        let near = 1e-6 * (self.high - self.low);
        let ends = [self.low, self.high]
            .into_iter()
            .filter(|end| self.absent.is_some_and(|a| (end - a).abs() > near));
        ends.into_iter().any(|end| (u - end).abs() <= near)
    }

    /// Width of the prior about a value: one over its density there. The size of an effect may be of any
    /// order of magnitude, so small sizes are as likely as large ones, decade by decade up to what a part can be;
    /// what only says how it acts is equally likely anywhere within what is expected.
    pub fn width(&self, u: f64) -> f64 {
        let range = self.expected.1 - self.expected.0;
        let Some(absent) = self.absent else { return range };
        let small = SMALL * range;
        let decades = |end: f64| ((end - absent).abs() / small).ln_1p();
        (decades(self.low) + decades(self.high)) * ((u - absent).abs() + small)
    }
}

/// An effect at a place, as a candidate.
#[derive(Clone)]
pub struct Candidate {
    /// Its kind.
    pub kind: &'static Kind,
    /// Its place.
    pub at: String,
    /// Its fitted numbers.
    pub knobs: Vec<Knob>,
    /// Numbers that are stated and not fitted, after the fitted ones.
    pub(crate) fixed: Vec<f64>,
    /// Where fits start.
    pub starts: Vec<Vec<f64>>,
    /// Effects that are the same thing in this arm by construction: name and place.
    pub twins: Vec<(String, String)>,
}

impl Candidate {
    /// What it is called in reports.
    pub fn label(&self) -> String {
        format!("{}@{}", self.kind.name, self.at)
    }

    /// The same effect with starts in every corner of what a vector can be, for few readings.
    pub fn from_corners(mut self) -> Self {
        self.starts.extend(corners(&self.knobs));
        self
    }

    /// Numbers of all parameters in the kind's order, those that keep an order in it.
    pub fn numbers(&self, u: &[f64]) -> Vec<f64> {
        let mut out: Vec<f64> = self.knobs.iter().zip(u).map(|(k, u)| k.value(*u)).collect();
        for (i, knob) in self.knobs.iter().enumerate() {
            if let Some(least) = self.knobs.iter().position(|k| Some(k.name) == knob.not_below) {
                out[i] = out[i].max(out[least]);
            }
        }
        out.extend(&self.fixed);
        out
    }

    /// The effect as an arm file has it.
    pub fn effect(&self, u: &[f64], place: Place) -> Effect {
        let numbers = self.numbers(u);
        let mut rest = numbers.as_slice();
        let parameters = (self.kind.parameters)(place)
            .iter()
            .map(|p| {
                let (own, others) = rest.split_at(p.count.min(rest.len()));
                rest = others;
                (p.name.to_string(), own.to_vec())
            })
            .collect();
        Effect { effect: self.kind.name.into(), at: self.at.clone(), parameters, source: None }
    }
}

/// Starts for the components of a vector, a fifth of the way from nothing to each corner of their range:
/// with nothing everywhere a descent may see no slope.
fn corners(knobs: &[Knob]) -> Vec<Vec<f64>> {
    if knobs.len() < 2 || knobs.iter().any(|k| k.name != knobs[0].name) {
        return Vec::new();
    }
    let end = |k: &Knob, up: bool| 0.2 * if up { k.high } else { k.low };
    let corner = |bits: usize| knobs.iter().enumerate().map(|(i, k)| end(k, bits >> i & 1 == 1)).collect();
    (0..1 << knobs.len()).map(corner).collect()
}

/// One calibrated number.
#[derive(Debug, Clone, PartialEq)]
pub enum Calibration {
    /// Stiffness of a joint: a factor.
    Stiffness(String),
    /// E and G of a material: a factor, with the links that have it.
    Modulus(String, Vec<String>),
    /// Mass of a joint: a factor.
    Mass(String),
}

/// Calibrated numbers with the standard deviation of ln of each factor.
#[derive(Debug, Clone)]
pub struct Nuisance {
    /// The numbers.
    pub numbers: Vec<(Calibration, f64)>,
}

impl Nuisance {
    /// What tolerance leaves open: half the 95 % limit is one standard deviation.
    pub fn new(arm: &Arm, tolerance: &Tolerance) -> Self {
        let mut numbers = Vec::new();
        let joints = || arm.joints();
        if tolerance.joint_stiffness > 0.0 {
            numbers.extend(
                joints()
                    .filter(|j| j.curve != Curve::Rigid)
                    .map(|j| (Calibration::Stiffness(j.name.clone()), tolerance.joint_stiffness / 2.0)),
            );
        }
        if tolerance.modulus > 0.0 {
            for (material, links) in materials(arm) {
                numbers.push((Calibration::Modulus(material, links), tolerance.modulus / 2.0));
            }
        }
        if tolerance.joint_mass > 0.0 {
            numbers.extend(
                joints()
                    .filter(|j| j.mass_kg > 0.0)
                    .map(|j| (Calibration::Mass(j.name.clone()), tolerance.joint_mass / 2.0)),
            );
        }
        Self { numbers }
    }

    /// Factor of a calibrated number.
    pub fn factor(&self, index: usize, u: f64) -> f64 {
        (u * self.numbers[index].1).exp()
    }

    fn apply(&self, u: &[f64], subject: &mut Subject) {
        let structure = &mut subject.structure;
        for (index, (calibration, _)) in self.numbers.iter().enumerate() {
            let factor = self.factor(index, u[index]);
            match calibration {
                Calibration::Stiffness(name) => {
                    if let Some(joint) = structure.joint_mut(name) {
                        joint.law.curve = joint.law.curve.stiffened(factor);
                    }
                }
                Calibration::Mass(name) => {
                    if let Some(joint) = structure.joint_mut(name) {
                        joint.mass_kg *= factor;
                    }
                }
                Calibration::Modulus(_, links) => {
                    for piece in &mut structure.pieces {
                        if let Piece::Link(link) = piece
                            && links.contains(&link.name)
                            && let Some(beam) = &mut link.beam
                        {
                            beam.material.youngs_modulus_pa *= factor;
                            beam.material.shear_modulus_pa *= factor;
                        }
                    }
                }
            }
        }
    }
}

fn materials(arm: &Arm) -> Vec<(String, Vec<String>)> {
    let mut out: Vec<(String, Vec<String>)> = Vec::new();
    for element in &arm.chain {
        let Element::Link(link) = element else { continue };
        let LinkBody::Tube { material_name, .. } = &link.body else { continue };
        match out.iter_mut().find(|(name, _)| name == material_name) {
            Some((_, links)) => links.push(link.name.clone()),
            None => out.push((material_name.clone(), vec![link.name.clone()])),
        }
    }
    out
}

/// A model: calibration and effects. Its parameter vector is the calibration first, then each
/// effect's knobs.
#[derive(Clone)]
pub struct Model<'a> {
    /// Calibration.
    pub nuisance: &'a Nuisance,
    /// Effects.
    pub effects: Vec<&'a Candidate>,
    /// Smoothing of break points in the frequencies.
    pub smoothing: f64,
    /// Parameters that are held.
    pub held: Vec<(usize, f64)>,
}

impl<'a> Model<'a> {
    /// Calibration only.
    pub fn bare(nuisance: &'a Nuisance) -> Self {
        Self { nuisance, effects: Vec::new(), smoothing: 0.0, held: Vec::new() }
    }

    /// A model of some of the candidates, by their indices.
    pub fn of(nuisance: &'a Nuisance, candidates: &'a [Candidate], effects: &[usize]) -> Self {
        Self { effects: effects.iter().map(|&i| &candidates[i]).collect(), ..Self::bare(nuisance) }
    }

    /// The same model with one more effect.
    pub fn with(&self, effect: &'a Candidate) -> Self {
        let mut out = self.clone();
        out.effects.push(effect);
        out
    }

    /// The same model without an effect.
    pub fn without(&self, index: usize) -> Self {
        let mut out = self.clone();
        out.effects.remove(index);
        out
    }

    /// Where in the parameter vector the break points of gear curves are.
    pub fn break_points(&self) -> Vec<usize> {
        let first = self.calibrated();
        let knobs = self.knobs().enumerate();
        knobs.filter(|(_, k)| k.name == "t1_nm" || k.name == "t2_nm").map(|(i, _)| first + i).collect()
    }

    /// The parameter that a parameter is not below, if there is one.
    fn floor(&self, index: usize) -> Option<usize> {
        let mut first = self.calibrated();
        for effect in &self.effects {
            if let Some(knob) = index.checked_sub(first).and_then(|i| effect.knobs.get(i)) {
                return Some(first + effect.knobs.iter().position(|k| Some(k.name) == knob.not_below)?);
            }
            first += effect.knobs.len();
        }
        None
    }

    /// Whether a parameter is no higher than the one that it is not below: as far down as it acts.
    pub fn rests(&self, index: usize, u: &[f64]) -> bool {
        self.floor(index).is_some_and(|least| u[index] <= u[least])
    }

    /// Brings parameters into the order they keep. Out of it a number acts on nothing, and a descent that has let
    /// it go there never finds it again.
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

    /// Number of parameters.
    pub fn len(&self) -> usize {
        self.calibrated() + self.knobs().count()
    }

    /// Whether nothing is free.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of calibrated parameters.
    pub fn calibrated(&self) -> usize {
        self.nuisance.numbers.len()
    }

    /// The knobs of all effects.
    pub fn knobs(&self) -> impl Iterator<Item = &'a Knob> + '_ {
        self.effects.iter().flat_map(|e| e.knobs.iter())
    }

    /// Where an effect's knobs begin in the parameter vector.
    pub fn first_knob(&self, effect: usize) -> usize {
        self.calibrated() + self.effects[..effect].iter().map(|e| e.knobs.len()).sum::<usize>()
    }

    /// Whether a size of an effect is as large as is looked for.
    pub fn is_at_a_limit(&self, u: &[f64]) -> bool {
        self.knobs().zip(&u[self.calibrated()..]).any(|(knob, u)| knob.is_at_its_limit(*u))
    }

    /// Smallest and largest value of a parameter.
    pub fn bounds(&self, index: usize) -> (f64, f64) {
        if let Some((_, value)) = self.held.iter().find(|(held, _)| *held == index) {
            return (*value, *value);
        }
        match index.checked_sub(self.calibrated()) {
            None => (-8.0, 8.0),
            Some(i) => self.knobs().nth(i).map_or((0.0, 0.0), |k| (k.low, k.high)),
        }
    }

    /// The arm under test with these parameters.
    pub fn subject(&self, forward: &Forward, u: &[f64]) -> Subject {
        let mut subject = forward.nominal.clone();
        self.nuisance.apply(u, &mut subject);
        let mut at = self.calibrated();
        for effect in &self.effects {
            let own = &u[at..at + effect.knobs.len()];
            (effect.kind.apply)(&effect.numbers(own), &effect.at, &mut subject);
            at += effect.knobs.len();
        }
        subject
    }

    /// The same, as numbers on the coordinates.
    pub fn coefficients(&self, forward: &Forward, u: &[f64]) -> Coefficients {
        let mut out = forward.coefficients(&self.subject(forward, u));
        out.smoothing = self.smoothing;
        out
    }

    /// What the model is called.
    pub fn label(&self) -> String {
        self.effects.iter().map(|e| e.label()).collect::<Vec<_>>().join(" + ")
    }
}
