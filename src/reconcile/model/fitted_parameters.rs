//! The parameters of a fitted effect, as a finding states them.

use super::estimate::{Estimate, Interval};
use super::parameters::{Candidate, Number};

/// The parameters of the effect `effect`, fitted to `u`, with their intervals `ends`, one per fitted number. A
/// component of a vector that was not fitted has its stated value and no ends of an interval.
pub(crate) fn fitted_parameters(
    effect: &Candidate,
    u: &[f64],
    ends: &[Interval],
) -> Vec<(String, Vec<Estimate>)> {
    let mut free = effect.free_parameters.iter().zip(effect.free_values(u)).zip(ends);
    let mut out: Vec<(String, Vec<Estimate>)> = Vec::new();
    for (name, number) in effect.named_numbers() {
        let estimate = match number {
            Number::Free => {
                let Some(((parameter, value), interval)) = free.next() else { continue };
                parameter.estimate(value, interval)
            }
            Number::Stated(value) => Estimate { value, low: None, high: None },
        };
        match out.iter_mut().find(|(known, _)| known == name) {
            Some((_, list)) => list.push(estimate),
            None => out.push((name.to_string(), vec![estimate])),
        }
    }
    out.retain(|(name, _)| effect.free_parameters.iter().any(|parameter| parameter.name == name));
    let stated = |value: f64| Estimate { value, low: Some(value), high: Some(value) };
    out.extend(effect.words().into_iter().map(|(name, number, _)| (name.to_string(), vec![stated(number)])));
    if effect.free_parameters.is_empty() {
        out.push(("factor".into(), effect.numbers(&[]).into_iter().map(stated).collect()));
    }
    out
}
