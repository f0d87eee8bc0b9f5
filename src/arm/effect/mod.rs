//! Physics an arm has beyond its nominal model. An effect is a piece of the arm: it changes the
//! [`Structure`] that mechanics sees, so that statics, modes and search see it alike.
//!
//! Each effect has a file of its own here with a [`Kind`]: its name, where it can sit, its parameters
//! with unit, bounds and typical size, and what it does to a [`Subject`]. [`KINDS`] registers them all;
//! nothing else in the program lists effects. Effects of the payload or of a measuring channel describe
//! a test, not the product: only `predict` and `reconcile` use them.

pub(crate) mod base_compliance;
pub(crate) mod bearing_tilt;
pub(crate) mod connection_compliance;
pub(crate) mod drift;
pub(crate) mod extra_mass;
pub(crate) mod frame_compliance;
pub(crate) mod harness_mass;
pub(crate) mod hysteresis;
pub(crate) mod immersion;
pub(crate) mod joint_compliance;
pub(crate) mod link_flexibility;
pub(crate) mod lost_motion;
pub(crate) mod modulus_error;
pub(crate) mod outlier;
pub(crate) mod payload_cg_error;
pub(crate) mod payload_mass_error;
pub(crate) mod sensor_bias;
pub(crate) mod sensor_gain;
pub(crate) mod soft_windup;
pub(crate) mod time_shift;
pub(crate) mod transmission_error;
pub(crate) mod validate;
pub(crate) mod wrong_unit;

pub use transmission_error::{transmission_rad, transmission_waves};
pub use validate::{EffectFault, fits_nominal};
pub use wrong_unit::SLIPS as UNIT_SLIPS;

use super::structure::{JointAngle, JointPiece, LinkPiece, Piece, Structure};
use nalgebra::Vector3;
use serde_json::Value;

/// One effect of an arm, as its file names it.
#[derive(Debug, Clone, PartialEq)]
pub struct Effect {
    /// Name, e.g. `bearing_tilt`.
    pub effect: String,
    /// A joint, a link, `base`, `payload`, `arm` or a channel.
    pub at: String,
    /// Parameters by name; a vector parameter has several numbers.
    pub parameters: Vec<(String, Vec<f64>)>,
    /// Where the values come from, kept as written.
    pub source: Option<Value>,
}

/// What kind of place an effect sits at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// A joint, by name.
    Joint,
    /// A link, by name.
    Link,
    /// A link that is a tube, by name.
    Tube,
    /// `base`.
    Base,
    /// `payload`.
    Payload,
    /// `arm`.
    Arm,
    /// A channel: `static`, `modal`, `windup` or `positions`.
    Channel(Channel),
}

/// A kind of reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Channel {
    /// Tip displacement under load.
    Static,
    /// Natural frequencies.
    Modal,
    /// Torsion of one joint on a bench.
    Windup,
    /// Absolute positions.
    Positions,
}

/// What an effect belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scope {
    /// The product: every calculation sees it.
    Product,
    /// The test: only `predict` and `reconcile` see it.
    Test,
}

/// How a parameter is best searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// The number itself.
    Linear,
    /// A stiffness, through its compliance over that of the joint it sits at: 0 = effect absent.
    Stiffness,
    /// A factor on a stiffness, through its reciprocal.
    Reciprocal,
    /// The logarithm.
    Log,
}

/// A parameter of an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Name with unit, as files write it.
    pub name: &'static str,
    /// How many numbers: 1, or 3 for a vector.
    pub count: usize,
    /// Smallest sensible value.
    pub low: f64,
    /// Largest sensible value.
    pub high: f64,
    /// A typical value, where a fit starts.
    pub typical: f64,
    /// Where a fit expects it, every value as likely as another; a stiffness as the compliance over that
    /// of its joint, a reciprocal as `1/factor`.
    pub prior: (f64, f64),
    /// How it is searched.
    pub scale: Scale,
    /// The value when it is left out; such a parameter is stated, not fitted.
    pub default: Option<f64>,
    /// Another parameter that this one is not below.
    pub not_below: Option<&'static str>,
}

impl Parameter {
    /// A single number that must be given.
    pub const fn number(name: &'static str, low: f64, high: f64, typical: f64, scale: Scale) -> Self {
        let prior = (low, high);
        Self { name, count: 1, low, high, typical, prior, scale, default: None, not_below: None }
    }

    /// The same parameter, expected within narrower limits.
    pub const fn expected(self, low: f64, high: f64) -> Self {
        Self { prior: (low, high), ..self }
    }

    /// The same parameter, not below another.
    pub const fn at_least(self, other: &'static str) -> Self {
        Self { not_below: Some(other), ..self }
    }

    /// Three numbers that must be given.
    pub const fn vector(name: &'static str, low: f64, high: f64, typical: f64) -> Self {
        Self { count: 3, ..Self::number(name, low, high, typical, Scale::Linear) }
    }
}

/// What is known of an effect before any arm has it.
pub struct Kind {
    /// Name in files.
    pub name: &'static str,
    /// One line on what it is.
    pub summary: &'static str,
    /// Product or test.
    pub scope: Scope,
    /// Where it can sit.
    pub places: &'static [Place],
    /// Its parameters at such a place.
    pub parameters: fn(Place) -> &'static [Parameter],
    /// Puts it into the subject: the numbers of all parameters in order, and the place's name.
    pub apply: fn(&[f64], &str, &mut Subject),
}

/// Every effect, in the order of the documentation.
pub static KINDS: [&Kind; 22] = [
    &connection_compliance::KIND,
    &soft_windup::KIND,
    &lost_motion::KIND,
    &hysteresis::KIND,
    &bearing_tilt::KIND,
    &base_compliance::KIND,
    &frame_compliance::KIND,
    &payload_mass_error::KIND,
    &payload_cg_error::KIND,
    &extra_mass::KIND,
    &harness_mass::KIND,
    &modulus_error::KIND,
    &immersion::KIND,
    &joint_compliance::KIND,
    &link_flexibility::KIND,
    &transmission_error::KIND,
    &sensor_gain::KIND,
    &sensor_bias::KIND,
    &drift::KIND,
    &outlier::KIND,
    &wrong_unit::KIND,
    &time_shift::KIND,
];

/// The kind of an effect by its name.
pub fn kind(name: &str) -> Option<&'static Kind> {
    KINDS.iter().copied().find(|k| k.name == name)
}

/// An arm under test: the product, and how the test deviates from its description.
#[derive(Debug, Clone, PartialEq)]
pub struct Subject {
    /// The product.
    pub structure: Structure,
    /// True less stated mass, wherever a payload is stated \[kg\].
    pub payload_delta_kg: f64,
    /// True less stated centre of gravity, last frame \[m\].
    pub payload_offset_m: Vector3<f64>,
    /// How unevenly joints turn: joint, sine and cosine once and twice a turn \[rad\].
    pub transmissions_rad: Vec<(String, [f64; 4])>,
    /// How each channel reads.
    pub channels: [Reading; 4],
}

/// How a channel turns truth into a reading: `factor truth + bias + drift (row - 1)`, in the unit of
/// its file.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Factor on the truth.
    pub factor: f64,
    /// Constant; only the first number counts for scalar channels.
    pub bias: [f64; 3],
    /// Change per row of the file.
    pub drift_per_row: [f64; 3],
    /// Rows that are gross errors, from 1.
    pub outlier_rows: Vec<usize>,
}

impl Default for Reading {
    fn default() -> Self {
        Self { factor: 1.0, bias: [0.0; 3], drift_per_row: [0.0; 3], outlier_rows: Vec::new() }
    }
}

impl Reading {
    /// What the channel shows for a true value: `component` 0-2, `row` from 0.
    pub fn of(&self, truth: f64, component: usize, row: usize) -> f64 {
        self.factor * truth + self.bias[component] + self.drift_per_row[component] * row as f64
    }
}

impl Channel {
    /// Every channel.
    pub const ALL: [Channel; 4] = [Channel::Static, Channel::Modal, Channel::Windup, Channel::Positions];

    /// The word in files.
    pub fn word(self) -> &'static str {
        match self {
            Channel::Static => "static",
            Channel::Modal => "modal",
            Channel::Windup => "windup",
            Channel::Positions => "positions",
        }
    }

    /// The channel of a word.
    pub fn from_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|c| c.word() == word)
    }

    /// How many numbers a reading of the channel has.
    pub fn components(self) -> usize {
        match self {
            Channel::Static | Channel::Positions => 3,
            Channel::Modal | Channel::Windup => 1,
        }
    }
}

impl Subject {
    /// A test that goes as described.
    pub fn new(structure: Structure) -> Self {
        Self {
            structure,
            payload_delta_kg: 0.0,
            payload_offset_m: Vector3::zeros(),
            transmissions_rad: Vec::new(),
            channels: std::array::from_fn(|_| Reading::default()),
        }
    }

    /// Applies an effect that has been validated; an unknown one does nothing.
    pub fn apply(&mut self, effect: &Effect) {
        let Some(kind) = kind(&effect.effect) else { return };
        let place = self.structure.place(&effect.at, kind.places).unwrap_or(kind.places[0]);
        (kind.apply)(&effect.numbers((kind.parameters)(place)), &effect.at, self);
    }

    /// The angles to which driven joints turn when these are asked for.
    pub fn turned_rad(&self, pose_rad: &[f64]) -> Vec<f64> {
        let mut out = pose_rad.to_vec();
        for (name, waves_rad) in &self.transmissions_rad {
            let joint = self.structure.joints().find(|j| j.name == *name);
            if let Some(JointAngle::Driven(i)) = joint.map(|j| &j.angle) {
                out[*i] += transmission_rad(waves_rad, pose_rad[*i]);
            }
        }
        out
    }

    /// How a channel reads.
    pub fn channel_mut(&mut self, at: &str) -> Option<&mut Reading> {
        Channel::from_word(at).map(|c| &mut self.channels[c as usize])
    }
}

impl Effect {
    /// All numbers in the order of the kind's parameters, defaults filled in.
    pub fn numbers(&self, parameters: &[Parameter]) -> Vec<f64> {
        parameters.iter().flat_map(|p| self.parameter(p)).collect()
    }

    fn parameter(&self, parameter: &Parameter) -> Vec<f64> {
        match self.parameters.iter().find(|(name, _)| name == parameter.name) {
            Some((_, numbers)) => numbers.clone(),
            None => vec![parameter.default.unwrap_or_default(); parameter.count],
        }
    }

    /// Its name and place, for people.
    pub fn label(&self) -> String {
        format!("{} at {}", self.effect, self.at)
    }

    /// Whether it changes how a link bends: nothing where links are held rigid.
    pub fn is_of_bending(&self) -> bool {
        matches!(self.effect.as_str(), "modulus_error" | "link_flexibility")
    }

    /// Whether the effect describes the test and not the product.
    pub fn is_of_test(&self) -> bool {
        kind(&self.effect).is_some_and(|k| k.scope == Scope::Test)
    }
}

impl Structure {
    /// Which of the allowed kinds of place a name is, if any.
    pub fn place(&self, at: &str, allowed: &[Place]) -> Option<Place> {
        allowed.iter().copied().find(|place| match place {
            Place::Joint => self.joints().any(|j| j.name == at),
            Place::Link => self.links().any(|l| l.name == at),
            Place::Tube => self.links().any(|l| l.name == at && l.beam.is_some()),
            Place::Base => at == "base",
            Place::Payload => at == "payload",
            Place::Arm => at == "arm",
            Place::Channel(channel) => at == channel.word(),
        })
    }

    /// The names of a kind of place in this arm.
    pub fn places(&self, place: Place) -> Vec<String> {
        match place {
            Place::Joint => self.joints().map(|j| j.name.clone()).collect(),
            Place::Link => self.links().map(|l| l.name.clone()).collect(),
            Place::Tube => self.links().filter(|l| l.beam.is_some()).map(|l| l.name.clone()).collect(),
            Place::Base => vec!["base".into()],
            Place::Payload => vec!["payload".into()],
            Place::Arm => vec!["arm".into()],
            Place::Channel(channel) => vec![channel.word().into()],
        }
    }

    /// The joints, base to tip.
    pub fn joints(&self) -> impl Iterator<Item = &JointPiece> {
        self.pieces.iter().filter_map(|p| match p {
            Piece::Joint(joint) => Some(joint),
            Piece::Link(_) => None,
        })
    }

    /// The links, base to tip.
    pub fn links(&self) -> impl Iterator<Item = &LinkPiece> {
        self.pieces.iter().filter_map(|p| match p {
            Piece::Link(link) => Some(link),
            Piece::Joint(_) => None,
        })
    }

    /// A joint by name.
    pub fn joint_mut(&mut self, name: &str) -> Option<&mut JointPiece> {
        self.pieces.iter_mut().find_map(|p| match p {
            Piece::Joint(joint) if joint.name == name => Some(joint),
            _ => None,
        })
    }

    /// A link by name.
    pub fn link_mut(&mut self, name: &str) -> Option<&mut LinkPiece> {
        self.pieces.iter_mut().find_map(|p| match p {
            Piece::Link(link) if link.name == name => Some(link),
            _ => None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_has_a_name_of_its_own_a_place_and_a_page() {
        for (i, kind) in KINDS.iter().enumerate() {
            assert!(KINDS[..i].iter().all(|k| k.name != kind.name));
            assert!(!kind.places.is_empty() && !kind.summary.is_empty());
            let page = format!("{}/docs/effects/{}.md", env!("CARGO_MANIFEST_DIR"), kind.name);
            assert!(std::path::Path::new(&page).exists(), "{page} is missing");
            for place in kind.places {
                for p in (kind.parameters)(*place) {
                    assert!(p.low <= p.typical && p.typical <= p.high, "{} {}", kind.name, p.name);
                }
            }
        }
    }
}
