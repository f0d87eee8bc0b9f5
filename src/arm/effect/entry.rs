//! One entry of the list `effects` in an arm file, and how it is applied to an arm.

use super::catalogue::kind;
use super::channel::Channel;
use super::empirical;
use super::kind::{Kind, Parameter, Scope};
use super::subject::Subject;
use serde_json::Value;

/// The word with which files write the value `number` of a parameter. Only the choice of a channel is written as a
/// word; `None` for all other parameters.
pub(crate) fn word_of(effect: &str, parameter: &str, number: f64) -> Option<&'static str> {
    let kind = kind(effect)?;
    let parameters = (kind.parameters)(*kind.places.first()?);
    let is_channel = parameters.iter().any(|p| p.name == parameter && p.is_channel);
    is_channel.then(|| Channel::ALL.get(number as usize).map(|c| c.word())).flatten()
}

/// One effect of an arm, as its file names it.
#[derive(Debug, Clone, PartialEq)]
pub struct Effect {
    /// Name of the effect, such as `bearing_tilt`.
    pub effect: String,
    /// Place of the effect: the name of a joint or a link, `base`, `payload`, `arm`, or a channel.
    pub at: String,
    /// Parameters by name. A vector parameter has several numbers.
    pub parameters: Vec<(String, Vec<f64>)>,
    /// Where the values of the parameters come from: the key `source`, exactly as the file has it; `None` if the file
    /// states no source.
    pub source: Option<Value>,
}

impl Effect {
    /// The description of the effect; `None` if no effect has this name.
    pub fn kind(&self) -> Option<&'static Kind> {
        kind(&self.effect)
    }

    /// The values of all `parameters` of the effect in one list, in their order. A parameter that the file leaves out
    /// has its default value.
    pub fn numbers(&self, parameters: &[Parameter]) -> Vec<f64> {
        parameters.iter().flat_map(|p| self.parameter(p)).collect()
    }

    fn parameter(&self, parameter: &Parameter) -> Vec<f64> {
        match self.parameters.iter().find(|(name, _)| name == parameter.name) {
            Some((_, numbers)) => numbers.clone(),
            None => vec![parameter.default.unwrap_or_default(); parameter.count],
        }
    }

    /// Name and place of the effect, for messages.
    pub fn label(&self) -> String {
        format!("{} at {}", self.effect, self.at)
    }

    /// Whether the effect changes how a link bends. Such an effect does nothing if links are taken as rigid.
    pub fn is_of_bending(&self) -> bool {
        self.kind().is_some_and(|k| k.traits.changes_bending)
    }

    /// Whether the effect describes the test and not the product. Every effect at a channel describes the test. So does
    /// a law of a joint that only says how the joint changed in the course of the tests.
    pub fn is_of_test(&self) -> bool {
        self.kind().is_some_and(|k| k.scope == Scope::Test)
            || Channel::from_word(&self.at).is_some()
            || (self.effect == empirical::KIND.name && empirical::is_of_tests_alone(&self.parameters))
    }
}

impl Subject {
    /// Applies an effect to the arm under test. The effect has been checked for faults before; an effect with an
    /// unknown name does nothing.
    pub fn apply(&mut self, effect: &Effect) {
        let Some(kind) = effect.kind() else { return };
        let place = self.structure.place(&effect.at, kind.places).unwrap_or(kind.places[0]);
        (kind.apply)(&effect.numbers((kind.parameters)(place)), &effect.at, self);
    }
}
