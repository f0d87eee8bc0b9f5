//! One entry of an arm file's `effects`, and how it is applied to an arm.

use super::catalogue::kind;
use super::channel::Channel;
use super::empirical;
use super::kind::{Kind, Parameter, Scope};
use super::subject::Subject;
use serde_json::Value;

/// The word that files have for a number of an effect's parameter; `None` if they have the number itself.
pub(crate) fn word_of(effect: &str, parameter: &str, number: f64) -> Option<&'static str> {
    let kind = kind(effect)?;
    let parameters = (kind.parameters)(*kind.places.first()?);
    let is_channel = parameters.iter().any(|p| p.name == parameter && p.is_channel);
    is_channel.then(|| Channel::ALL.get(number as usize).map(|c| c.word())).flatten()
}

/// One effect of an arm, as its file names it.
#[derive(Debug, Clone, PartialEq)]
pub struct Effect {
    /// Name, e.g. `bearing_tilt`.
    pub effect: String,
    /// The place: a joint, a link, `base`, `payload`, `arm` or a channel.
    pub at: String,
    /// Parameters by name; a vector parameter has several numbers.
    pub parameters: Vec<(String, Vec<f64>)>,
    /// Where the values come from, kept as written.
    pub source: Option<Value>,
}

impl Effect {
    /// What is known of its kind; `None` if no effect has this name.
    pub fn kind(&self) -> Option<&'static Kind> {
        kind(&self.effect)
    }

    /// All numbers in the order of the kind's parameters, with defaults for those left out.
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

    /// Whether it changes how a link bends. Such an effect does nothing where links are held rigid.
    pub fn is_of_bending(&self) -> bool {
        self.kind().is_some_and(|k| k.traits.changes_bending)
    }

    /// Whether the effect describes the test and not the product. Whatever sits at a channel does, and a law of a joint that
    /// only says how the joint changed in the course of the tests.
    pub fn is_of_test(&self) -> bool {
        self.kind().is_some_and(|k| k.scope == Scope::Test)
            || Channel::from_word(&self.at).is_some()
            || (self.effect == empirical::KIND.name && empirical::is_of_tests_alone(&self.parameters))
    }
}

impl Subject {
    /// Applies an effect that has been validated. An unknown effect does nothing.
    pub fn apply(&mut self, effect: &Effect) {
        let Some(kind) = effect.kind() else { return };
        let place = self.structure.place(&effect.at, kind.places).unwrap_or(kind.places[0]);
        (kind.apply)(&effect.numbers((kind.parameters)(place)), &effect.at, self);
    }
}
