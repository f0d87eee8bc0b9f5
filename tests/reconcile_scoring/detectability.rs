//! How well a hidden effect could be seen at all, whoever looks.

use armwright::reconcile::Campaign;
use armwright::reconcile::fit::{Effort, fit};
use armwright::reconcile::forward::Forward;
use armwright::reconcile::model::{Candidate, Model, Nuisance, candidates};
use armwright::reconcile::noise::Noise;
use serde_json::Value;

/// By how many standard deviations readings without noise depart from the best that calibration within
/// tolerance can do without the hidden effects; `None` if the library does not have one of them.
pub fn detectable_sigmas(campaign: &Campaign, hidden: &[Value]) -> Option<f64> {
    let mut forward = Forward::new(campaign);
    let nuisance = Nuisance::new(&campaign.arm, &campaign.statement.tolerance);
    let library = candidates(&forward);
    let effects: Vec<&Candidate> = hidden
        .iter()
        .map(|h| library.iter().find(|c| c.kind.name == h["effect"] && c.at == h["at"]))
        .collect::<Option<_>>()?;
    let mut u = vec![0.0; nuisance.numbers.len()];
    for (effect, key) in effects.iter().zip(hidden) {
        u.extend(effect.knobs.iter().enumerate().map(|(i, knob)| {
            let stated = key.get(knob.name).or_else(|| key["parameters"].get(knob.name));
            let number = stated.and_then(|v| v.get(knob.component).unwrap_or(v).as_f64());
            number.map_or(effect.starts[0][i], |value| knob.u(value))
        }));
    }
    let truth = Model { effects, ..Model::bare(&nuisance) };
    let seen = forward.predict(&truth.coefficients(&forward, &u));
    forward.data.iter_mut().zip(seen).for_each(|(datum, value)| datum.value = value);
    let weights = Noise::default().weights(&forward);
    let bare = Model::bare(&nuisance);
    let without = fit(&forward, &bare, &vec![0.0; bare.len()], &weights, Effort::default());
    Some(without.point.objective.sqrt())
}
