//! A model to fit: the calibration that tolerance allows, always free, and a list of effects.

use super::campaign::Tolerance;
use super::expected::Sizes;
use super::forward::{Coefficients, Forward};
use super::interval::Interval;
use super::verdict::Estimate;
use crate::arm::effect::{Channel, Effect, KINDS, Kind, Parameter, Place, Scale, Subject, fits_nominal};
use crate::arm::{Arm, Curve, Element, LinkBody, Piece};

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
    fn new(parameter: &Parameter, component: usize, joint_stiffness: f64) -> Self {
        let expected = parameter.prior;
        let (low, high) = (parameter.low, parameter.high);
        let absent_is_zero = !matches!(parameter.name, "k1_nm_per_rad" | "k2_nm_per_rad" | "k3_nm_per_rad");
        let (reference, (low, high), expected, absent) = match parameter.scale {
            Scale::Linear => {
                let size = parameter.typical.abs().max(1e-12);
                let by_size = |(a, b): (f64, f64)| (a / size, b / size);
                let absent = match parameter.name {
                    "added_mass_coefficient" => None,
                    "gain" => Some(1.0 / size),
                    _ => Some(0.0),
                };
                (size, by_size((low, high)), by_size(expected), absent)
            }
            Scale::Stiffness if absent_is_zero => {
                (joint_stiffness, (expected.0, expected.1.max(SOFTEST)), expected, Some(0.0))
            }
            Scale::Stiffness => (joint_stiffness, expected, expected, None),
            Scale::Reciprocal => (1.0, (1.0 / high, 1.0 / low), expected, Some(1.0)),
            Scale::Log => (1.0, (low.ln(), high.ln()), (expected.0.ln(), expected.1.ln()), None),
        };
        let (scale, not_below) = (parameter.scale, parameter.not_below);
        Self { name: parameter.name, component, scale, reference, low, high, not_below, absent, expected }
    }

    /// The same number within these limits of `u`, all of which is expected.
    fn within(self, low: f64, high: f64) -> Self {
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
    fixed: Vec<f64>,
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

/// Every effect at every place of this arm that the campaign's channels could show.
pub fn candidates(forward: &Forward) -> Vec<Candidate> {
    let structure = &forward.nominal.structure;
    let sizes = Sizes::of(forward);
    let mut out = Vec::new();
    for kind in KINDS.iter().filter(|k| {
        !matches!(k.name, "outlier" | "time_shift" | "wrong_unit" | "frame_compliance" | "transmission_error")
    }) {
        for place in kind.places {
            for at in structure.places(*place) {
                if fits_nominal(kind, *place, &at, structure) && channel_is_read(forward, *place) {
                    out.push(candidate(forward, &sizes, kind, *place, at));
                }
            }
        }
    }
    merge_twins(forward, &mut out);
    out.extend(unit_slips(forward));
    out
}

/// The tilt of a vertical first joint at the origin is the tilt of the base: one candidate for both.
fn merge_twins(forward: &Forward, candidates: &mut Vec<Candidate>) {
    let Some(Piece::Joint(first)) = forward.nominal.structure.pieces.first() else { return };
    if first.axis.z.abs() < 1.0 - 1e-12 {
        return;
    }
    let name = first.name.clone();
    candidates.retain(|c| !(c.kind.name == "bearing_tilt" && c.at == name));
    if let Some(base) = candidates.iter_mut().find(|c| c.kind.name == "base_compliance") {
        base.twins.push(("bearing_tilt".into(), name));
    }
}

fn channel_is_read(forward: &Forward, place: Place) -> bool {
    match place {
        Place::Channel(channel) => !forward.range(channel).is_empty(),
        _ => true,
    }
}

fn candidate(forward: &Forward, sizes: &Sizes, kind: &'static Kind, place: Place, at: String) -> Candidate {
    let reference = match kind.name {
        "soft_windup" => middle_stiffness(forward, &at),
        _ => reference_stiffness(forward, &at),
    };
    let mut knobs = Vec::new();
    let mut fixed = Vec::new();
    for parameter in (kind.parameters)(place) {
        match parameter.default {
            None => {
                let parameter = &of_size(kind, parameter, sizes);
                knobs.extend((0..parameter.count).map(|c| Knob::new(parameter, c, reference)));
            }
            Some(default) if parameter.name == "payload_density_kg_m3" && default > 0.0 => {
                fixed.push(forward.payload_density_kg_m3)
            }
            Some(default) => fixed.push(default),
        }
    }
    let torque = largest_torque_nm(forward, &at).max(1.0);
    for knob in &mut knobs {
        let parts = match knob.name {
            "t1_nm" => (0.02, 1.0),
            "t2_nm" => (0.05, 1.5),
            "torque_nm" => (0.003, 1.0),
            _ => continue,
        };
        // a law that changes where no torque of the campaign reaches cannot be told from another
        *knob = knob.clone().within((parts.0 * torque).ln(), (parts.1 * torque).ln());
    }
    if let Some(least_kg) = lightest_kg(forward, kind, &at) {
        // a share is left, for nothing swings without a mass
        knobs[0].low = knobs[0].low.max(-0.999 * least_kg / knobs[0].value(1.0));
    }
    let starts = starts(kind, torque, torque / reference, &knobs);
    Candidate { kind, at, knobs, fixed, starts, twins: Vec::new() }
}

/// The mass that an effect takes from, if it can take mass away: a joint's own, the lightest payload's \[kg\].
fn lightest_kg(forward: &Forward, kind: &Kind, at: &str) -> Option<f64> {
    match kind.name {
        "extra_mass" => forward.nominal.structure.joints().find(|j| j.name == at).map(|j| j.mass_kg),
        "payload_mass_error" => Some(forward.lightest_payload_kg),
        _ => None,
    }
}

/// The parameter over a wider range where the arm or its readings are large.
fn of_size(kind: &Kind, parameter: &Parameter, sizes: &Sizes) -> Parameter {
    let Some(size) = sizes.expected(kind.name, parameter.name) else { return *parameter };
    let wider = (size / parameter.prior.1).max(1.0);
    let prior = (parameter.prior.0 * wider, parameter.prior.1 * wider);
    Parameter { prior, low: parameter.low * wider, high: parameter.high * wider, ..*parameter }
}

/// Stiffness that compliances are measured by: the joint's own, else the first joint's.
fn reference_stiffness(forward: &Forward, at: &str) -> f64 {
    let joints: Vec<_> = forward.nominal.structure.joints().collect();
    let own = joints.iter().find(|j| j.name == at);
    let first = joints.iter().find(|j| !j.law.is_rigid());
    own.filter(|j| !j.law.is_rigid())
        .or(first.copied().as_ref())
        .map_or(1e5, |j| 1.0 / j.law.tangent_compliance_rad_per_nm(0.0))
}

/// The middle slope of a joint's curve, which is what a gear is known by \[N m/rad\].
fn middle_stiffness(forward: &Forward, at: &str) -> f64 {
    let own = forward.nominal.structure.joints().find(|j| j.name == at);
    match own.map(|joint| joint.law.curve) {
        Some(Curve::Windup(windup)) => windup.k2_nm_per_rad,
        _ => reference_stiffness(forward, at),
    }
}

/// Break points of a gear's curve to start from, as parts of the largest torque.
const BREAKS: [(f64, f64); 8] = [
    (0.08, 0.25),
    (0.08, 0.6),
    (0.15, 0.4),
    (0.15, 0.75),
    (0.25, 0.5),
    (0.25, 0.85),
    (0.4, 0.65),
    (0.5, 0.85),
];

/// Half widths of friction play to start from, by the largest twist of the joint \[rad\]: where the play is as wide as the
/// twist the joint does not move, and a descent sees no slope.
fn friction_starts_rad(twist_rad: f64) -> impl Iterator<Item = f64> {
    const WIDEST: f64 = 0.3;
    let usual = [0.25e-4, 1e-4, 3e-4].into_iter().filter(move |h| *h < WIDEST * twist_rad);
    [0.01, 0.06].into_iter().map(move |part| part * twist_rad).chain(usual)
}

fn starts(kind: &Kind, torque: f64, twist_rad: f64, knobs: &[Knob]) -> Vec<Vec<f64>> {
    match kind.name {
        "connection_compliance" | "bearing_tilt" | "base_compliance" => vec![vec![0.1], vec![0.5]],
        "joint_compliance" => vec![vec![0.5], vec![2.0]],
        "modulus_error" => vec![vec![1.1], vec![1.4]],
        "soft_windup" => {
            BREAKS.iter().map(|(a, b)| vec![1.4, 1.0, 0.85, (a * torque).ln(), (b * torque).ln()]).collect()
        }
        "lost_motion" => [0.03, 0.1, 0.3].iter().map(|part| vec![1.0, (part * torque).ln()]).collect(),
        "sensor_gain" => vec![vec![1.0 / knobs[0].value(1.0)]],
        "hysteresis" => friction_starts_rad(twist_rad).map(|h| vec![knobs[0].u(h)]).collect(),
        "extra_mass" => vec![vec![0.5], vec![2.0]],
        "immersion" => vec![vec![1.0, 1.0]],
        "payload_cg_error" => vec![vec![0.0; 3]],
        "sensor_bias" | "drift" => vec![vec![0.0; knobs.len()]],
        _ => vec![vec![1.0; knobs.len()]],
    }
}

/// Largest torque a joint sees in the campaign, bench included \[N m\].
fn largest_torque_nm(forward: &Forward, at: &str) -> f64 {
    let Some(j) = forward.layout.joints.iter().position(|s| s.name == at) else { return 0.0 };
    let nominal = forward.coefficients(&forward.nominal);
    let statics = forward.statics.iter().flat_map(|p| p.torques_nm(&forward.layout, &nominal));
    let modal = forward.modal.iter().map(|t| t.torques_nm(&forward.layout, &nominal));
    let bench = forward.bench_torques_nm(j);
    statics.chain(modal).map(|t| t[j].abs()).chain(bench).fold(0.0, f64::max)
}

/// A unit slip is a gain that is known exactly: no number to fit.
fn unit_slips(forward: &Forward) -> Vec<Candidate> {
    let kind = crate::arm::effect::kind("wrong_unit").expect("registered");
    let channels = Channel::ALL.into_iter().filter(|c| !forward.range(*c).is_empty());
    channels
        .flat_map(|channel| {
            crate::arm::effect::UNIT_SLIPS.iter().map(move |(factor, _)| Candidate {
                kind,
                at: channel.word().into(),
                knobs: Vec::new(),
                fixed: vec![*factor],
                starts: vec![Vec::new()],
                twins: Vec::new(),
            })
        })
        .collect()
}
