//! How many standard deviations a hidden effect changes the readings by, so that one knows whether any method could
//! find it.

use armwright::reconcile::Campaign;
use armwright::reconcile::fit::descent::{Effort, fit};
use armwright::reconcile::fit::noise::Noise;
use armwright::reconcile::forward::Forward;
use armwright::reconcile::model::calibration::Nuisance;
use armwright::reconcile::model::candidates::candidates;
use armwright::reconcile::model::parameters::{Candidate, Model};
use serde_json::Value;

/// By how many standard deviations readings without noise depart from the best that calibration within
/// tolerance can do without a hidden effect, the others being known: of several effects the least; `None`
/// if the library does not have one of them.
pub fn detectable_sigmas(campaign: &Campaign, hidden: &[Value]) -> Option<f64> {
    let mut forward = Forward::new(campaign);
    let nuisance = Nuisance::new(&campaign.arm, &campaign.statement.tolerance);
    let library = candidates(&forward);
    let effects: Vec<&Candidate> = hidden.iter().map(|h| candidate(&library, h)).collect::<Option<_>>()?;
    let mut u = vec![0.0; nuisance.numbers.len()];
    for (effect, key) in effects.iter().zip(hidden) {
        u.extend(effect.free_parameters.iter().enumerate().map(|(i, parameter)| {
            let stated = key.get(parameter.name).or_else(|| key["parameters"].get(parameter.name));
            let number = stated.and_then(|v| v.get(parameter.component).unwrap_or(v).as_f64());
            // a number of a set that the key leaves out is zero
            let is_left_out = effect.kind.traits.variants.len() > 1;
            let otherwise = if is_left_out { 0.0 } else { effect.starts[0][i] };
            number.map_or(otherwise, |value| parameter.u(value))
        }));
    }
    let truth = Model { effects, ..Model::baseline(&nuisance) };
    let seen = forward.predict(&truth.coefficients(&forward, &u));
    forward.data.iter_mut().zip(seen).for_each(|(datum, value)| datum.value = value);
    let weights = Noise::default().weights(&forward);
    let departure = |i: usize| {
        let model = truth.without(i);
        let mut start = u.clone();
        let first = truth.first_parameter(i);
        start.drain(first..first + truth.effects[i].free_parameters.len());
        fit(&forward, &model, &start, &weights, Effort::default()).point.objective.sqrt()
    };
    let least = (0..truth.effects.len()).map(departure).fold(f64::INFINITY, f64::min);
    Some(if least.is_finite() { least } else { 0.0 })
}

/// The candidate of a hidden effect: of several sets of parameters, the one with most.
fn candidate<'a>(library: &'a [Candidate], hidden: &Value) -> Option<&'a Candidate> {
    let channel = hidden["parameters"]["channel"].as_str();
    let is_own = |c: &&Candidate| {
        c.kind.name == hidden["effect"]
            && c.at == hidden["at"]
            && channel.is_none_or(|channel| c.label().ends_with(&format!("({channel})")))
    };
    library.iter().filter(is_own).max_by_key(|c| c.free_parameters.len())
}
