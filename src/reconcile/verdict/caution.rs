//! Checks before an effect is named: whether effects cancel each other, whether the size of an effect may be zero, and
//! whether calibrated values are outside their tolerance.

use super::outcome::Calibrated;
use crate::arm::effect::entry::Effect;
use crate::arm::effect::kind::Place;
use crate::arm::structure::Piece;
use crate::reconcile::fit::descent::Fit;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::model::estimate::Interval;
use crate::reconcile::model::parameters::{Candidate, FreeParameter};
use crate::reconcile::readings::campaign::Campaign;

/// Two places are neighbours if they are at most this many elements of the chain apart, such as two joints with a link
/// between them.
const NEIGHBOUR_DISTANCE: usize = 2;
/// Tolerance of a calibrated factor, as a multiple of the standard deviation of the factor's logarithm.
const TOLERANCE_SIGMAS: f64 = 2.0;
/// A calibrated factor is called improbable if fewer than one in this many faultless parts deviate so far.
const RARE_PARTS: f64 = 200.0;
/// If fewer than one in this many faultless parts have such a calibrated factor, tolerance is not taken as its cause. A
/// campaign calibrates some fifteen factors, so that one faultless arm in two hundred has such a part.
const IMPOSSIBLE_PARTS: f64 = 3e3;

/// Sentence that two effects of the model have opposite signs at neighbouring places; `None` if there are no such
/// effects. Only two effects of the same kind, or two masses, are compared. Each then cancels a part of the other.
/// Together they describe one effect that is at another place, or that is present in one kind of test only.
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
        alike
            && by * other < 0.0
            && distance(forward, effects[i], effects[j]).is_some_and(|d| d <= NEIGHBOUR_DISTANCE)
    };
    let (i, j) = pairs.into_iter().find(is_opposed)?;
    Some(format!(
        "the best effects, {} and {}, have opposite signs at neighbouring places: together they describe one thing \
         that is elsewhere, or that is there in one kind of test only",
        effects[i].label(),
        effects[j].label()
    ))
}

/// Distance between the places of the effects `a` and `b`, as a number of elements of the chain; `None` if a place is
/// not in the chain. The payload is taken to be at the end of the chain.
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

/// Indices of the effects of the model `fit` whose 95 % interval contains the size at which the effect is absent.
/// `ends` are the intervals of the parameters of all effects, in the order of the model.
pub(crate) fn may_be_absent(fit: &Fit, ends: &[Interval]) -> Vec<usize> {
    let mut at = 0;
    let mut out = Vec::new();
    for (i, effect) in fit.model.effects.iter().enumerate() {
        let own = effect.free_parameters.iter().zip(&ends[at..]);
        let sizes: Vec<bool> = own.filter_map(|(parameter, ends)| parameter.may_be_absent(ends)).collect();
        at += effect.free_parameters.len();
        // this is decided only for a single size: a vector may differ from zero although the interval of each component
        // contains zero
        if sizes == [true] {
            out.push(i);
        }
    }
    out
}

/// Sentence on the parameters of effects whose interval has an end that the readings do not bound; `None` if there are
/// none.
pub(crate) fn unbounded(fit: &Fit, ends: &[Interval]) -> Option<String> {
    let labels =
        fit.model.effects.iter().flat_map(|effect| vec![effect.label(); effect.free_parameters.len()]);
    let numbers = fit.model.free_parameters().zip(ends).zip(labels);
    let is_limit = |parameter: &FreeParameter, end: Option<f64>| end.is_some_and(|u| parameter.is_limit(u));
    let unbounded = numbers
        .filter(|((parameter, ends), _)| is_limit(parameter, ends.low) || is_limit(parameter, ends.high))
        .map(|((parameter, _), label)| format!("{} of {label}", parameter.name));
    let unbounded: Vec<String> = unbounded.collect();
    (!unbounded.is_empty()).then(|| {
        format!(
            "the readings do not bound one side of {}: the end is that of what a part can be",
            unbounded.join(", ")
        )
    })
}

/// Sentence on the calibrated factors that are outside their tolerance; `None` if there are none. `deviations` has, for
/// each factor, the standard deviation of its logarithm that follows from the tolerance.
pub(crate) fn beyond_tolerance(
    deviations: impl Iterator<Item = f64>,
    calibrated: &[Calibrated],
) -> Option<String> {
    let beyond = deviations.zip(calibrated).filter_map(|(sd, of)| {
        let one_in = one_in(sd, of);
        let words = format!("{}; {})", departure_words(sd, of), rarity_words(one_in));
        ((of.factor.value - 1.0).abs() > TOLERANCE_SIGMAS * sd).then_some((one_in, words))
    });
    let (rarity, beyond): (Vec<f64>, Vec<String>) = beyond.unzip();
    let doubt = match rarity.iter().any(|one_in| *one_in > RARE_PARTS) {
        true => {
            ". So far off is seldom a matter of tolerance: the part may be another than the arm file says, or \
             something else deflects or has mass there that these readings do not tell from it"
        }
        false => "",
    };
    (!beyond.is_empty()).then(|| format!("calibration leaves the tolerance: {}{doubt}", beyond.join(", ")))
}

/// Sentence that a model explains the readings only with a calibrated factor that no faultless part has. `None` if
/// there is no such factor. `effects` is the label of the model's effects, empty without any. `deviations` has, for
/// each factor, the standard deviation of its logarithm that follows from the tolerance.
pub(crate) fn impossible_calibration(
    campaign: &Campaign,
    effects: &str,
    deviations: impl Iterator<Item = f64>,
    calibrated: &[Calibrated],
) -> Option<String> {
    let words = rare_words(deviations, calibrated);
    if words.is_empty() {
        return None;
    }
    let stated: Vec<String> = campaign.arm.effects.iter().map(Effect::label).collect();
    let stated = match stated.is_empty() {
        true => String::new(),
        false => format!(", or the arm lacks an effect that its file states ({})", stated.join(", ")),
    };
    let explained = match effects {
        "" => "calibration explains".to_string(),
        named => format!("{named} and calibration explain"),
    };
    Some(format!(
        "{explained} the readings, but only with factors that less than one honest part in three thousand has: {words}. The \
         part is another than the arm file says, something else deflects or has mass there{stated}"
    ))
}

/// The calibrated factors that are rarer than [`IMPOSSIBLE_PARTS`], in words; empty if there are none. `deviations` has,
/// for each factor, the standard deviation of its logarithm that follows from the tolerance.
pub(crate) fn rare_words(deviations: impl Iterator<Item = f64>, calibrated: &[Calibrated]) -> String {
    let rare = deviations.zip(calibrated).filter(|(sd, of)| one_in(*sd, of) > IMPOSSIBLE_PARTS);
    let words =
        rare.map(|(sd, of)| format!("{}; {})", departure_words(sd, of), rarity_words(one_in(sd, of))));
    words.collect::<Vec<_>>().join(", ")
}

/// Whether a calibrated factor is rarer than [`IMPOSSIBLE_PARTS`]. `deviation` is the deviation of its logarithm
/// from nominal, in standard deviations of the tolerance.
pub(crate) fn is_rare(deviation: f64) -> bool {
    honest_parts_for_one(deviation) > IMPOSSIBLE_PARTS
}

/// Whether one of several calibrated factors is rare ([`is_rare`]).
pub(crate) fn has_rare(deviations: &[f64]) -> bool {
    deviations.iter().any(|deviation| is_rare(*deviation))
}

/// A calibrated factor, its deviation from nominal and its tolerance, in words. The caller adds the closing bracket.
/// `sd` is the standard deviation of its logarithm that follows from the tolerance.
fn departure_words(sd: f64, of: &Calibrated) -> String {
    let (part, tolerance) = (of.factor.value - 1.0, TOLERANCE_SIGMAS * sd);
    format!("{} by {:+.1} % (tolerance {:.1} %", of.name, 100.0 * part, 100.0 * tolerance)
}

/// The number n such that one in n faultless parts deviates from nominal at least as far as a calibrated factor. `sd`
/// is the standard deviation of its logarithm that follows from the tolerance.
fn one_in(sd: f64, of: &Calibrated) -> f64 {
    honest_parts_for_one(libm::log(of.factor.value) / sd)
}

/// Largest number of faultless parts that is printed. Rarer deviations of real parts do not follow a normal
/// distribution.
const MOST_PARTS: f64 = 1e12;

/// How rare a calibrated factor is, in words.
fn rarity_words(one_in: f64) -> String {
    match one_in < MOST_PARTS {
        true => format!("one honest part in {one_in:.0}"),
        false => "less than one honest part in 1e12".into(),
    }
}

/// The number n such that one in n faultless parts deviates from nominal by at least `deviations` standard
/// deviations.
fn honest_parts_for_one(deviations: f64) -> f64 {
    1.0 / libm::erfc(deviations.abs() / std::f64::consts::SQRT_2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_honest_part_in_twenty_leaves_its_tolerance_and_one_in_370_leaves_it_by_half() {
        // the normal distribution: 4.55 % beyond two standard deviations, 0.27 % beyond three
        assert!((honest_parts_for_one(-2.0) - 1.0 / 0.0455).abs() < 0.05);
        assert!((honest_parts_for_one(3.0) - 370.4).abs() < 0.1);
    }

    #[test]
    fn a_part_is_rare_beyond_the_deviation_that_one_in_three_thousand_has() {
        // the normal distribution: 1/3000 beyond 3.588 standard deviations
        assert!(has_rare(&[0.0, -3.60]) && !has_rare(&[3.57, -3.57]));
    }
}
