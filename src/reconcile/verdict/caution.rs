//! What must be said before an effect is believed: effects that cancel each other, sizes that may be nothing, and parts
//! that calibration takes out of their tolerance.

use super::outcome::Calibrated;
use crate::arm::effect::kind::Place;
use crate::arm::structure::Piece;
use crate::reconcile::fit::descent::Fit;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::model::estimate::Interval;
use crate::reconcile::model::parameters::{Candidate, FreeParameter};

/// Places are neighbours if they are at most this many elements of the chain apart: two joints with a link between them.
const NEAR: usize = 2;
/// The tolerance of a calibrated factor in standard deviations of its logarithm.
const TOLERANCE: f64 = 2.0;

/// Says that two effects of one kind, or two masses, have opposite signs at neighbouring places, if two do. Each takes back
/// what the other adds, so that together they describe one thing that is elsewhere, or that is there in one kind of test
/// only.
pub(crate) fn opposed(forward: &Forward, fit: &Fit) -> Option<String> {
    let effects = &fit.model.effects;
    let size = |i: usize| -> Option<(&FreeParameter, f64)> {
        let [parameter] = effects[i].free_parameters.as_slice() else { return None };
        let u = fit.point.u[fit.model.first_parameter(i)];
        Some((parameter, parameter.departure(u)?))
    };
    let pairs = (0..effects.len()).flat_map(|i| (i + 1..effects.len()).map(move |j| (i, j)));
    let is_opposed = |&(i, j): &(usize, usize)| {
        let (Some((a, by)), Some((b, other))) = (size(i), size(j)) else { return false };
        let is_mass = |p: &FreeParameter| p.name.contains("kg");
        let alike = effects[i].kind.name == effects[j].kind.name || (is_mass(a) && is_mass(b));
        alike && by * other < 0.0 && distance(forward, effects[i], effects[j]).is_some_and(|d| d <= NEAR)
    };
    let (i, j) = pairs.into_iter().find(is_opposed)?;
    Some(format!(
        "the best effects, {} and {}, have opposite signs at neighbouring places: together they describe one thing \
         that is elsewhere, or that is there in one kind of test only",
        effects[i].label(),
        effects[j].label()
    ))
}

/// Number of elements of the chain from one effect's place to another's. The payload is the end of the chain.
fn distance(forward: &Forward, a: &Candidate, b: &Candidate) -> Option<usize> {
    let structure = &forward.nominal.structure;
    let at = |candidate: &Candidate| {
        let named = |piece: &Piece| piece.name() == candidate.at;
        match structure.place(&candidate.at, candidate.kind.places) {
            Some(Place::Payload) => Some(structure.pieces.len()),
            _ => structure.pieces.iter().position(named),
        }
    };
    Some(at(a)?.abs_diff(at(b)?))
}

/// The effects, by index, whose 95 % interval contains the size at which they are absent. `ends` holds the intervals of
/// all parameters of all effects, in order.
pub(crate) fn may_be_absent(fit: &Fit, ends: &[Interval]) -> Vec<usize> {
    let mut at = 0;
    let mut out = Vec::new();
    for (i, effect) in fit.model.effects.iter().enumerate() {
        let own = effect.free_parameters.iter().zip(&ends[at..]);
        let sizes: Vec<bool> = own.filter_map(|(parameter, ends)| parameter.may_be_absent(ends)).collect();
        at += effect.free_parameters.len();
        // a vector may differ from zero although each of its components alone may be zero
        if sizes == [true] {
            out.push(i);
        }
    }
    out
}

/// Says which calibrated factors leave the tolerance, if any do.
pub(crate) fn beyond_tolerance(fit: &Fit, calibrated: &[Calibrated]) -> Option<String> {
    let numbers = fit.model.nuisance.numbers.iter().zip(calibrated);
    let beyond = numbers.filter_map(|((_, sd), calibrated)| {
        let (part, tolerance) = (calibrated.factor.value - 1.0, TOLERANCE * sd);
        (part.abs() > tolerance).then(|| {
            format!("{} by {:+.1} % (tolerance {:.1} %)", calibrated.name, 100.0 * part, 100.0 * tolerance)
        })
    });
    let beyond: Vec<String> = beyond.collect();
    (!beyond.is_empty()).then(|| {
        format!("calibration leaves the tolerance, as one honest part in twenty does: {}", beyond.join(", "))
    })
}
