//! Says in words which units a factor on the readings of a channel may come from.
//!
//! The tip moves in proportion to the force or the payload, so a load in another unit multiplies the readings, as a
//! gain of the instrument does. The readings alone cannot tell the two causes from each other. But a factor that equals
//! a factor between two units is seldom a gain.

use crate::arm::effect::channel::Channel;
use crate::arm::effect::sensor_gain;
use crate::arm::effect::wrong_unit::{self, UnitSlip};
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::model::candidates::possible_slips;
use crate::reconcile::model::estimate::Finding;
use crate::reconcile::verdict::outcome::NextTest;

/// Largest difference between the logarithms of a found factor and of the factor between two units. A calibrated
/// stiffness can make up for a difference of a few per cent.
const NEAR: f64 = 0.06;
/// A gain that differs from 1 by at most this is taken as the gain of an instrument.
const USUAL_GAIN: f64 = 0.25;

/// What the description of a next test adds if a column seems to be in another unit.
const OF_NEXT_TEST: &str = "; the loads are in the unit of the campaign's columns";

/// The effects, with a single factor on the readings of each channel: a gain that was found together with a wrong unit
/// is multiplied by the factor of the unit, and the unit is not listed. The readings show the product only, so neither
/// factor means anything by itself. (The corrected arm has both.)
pub(crate) fn joined(effects: Vec<Finding>) -> Vec<Finding> {
    let is_at = |f: &Finding, name: &str, at: &str| f.effect == name && f.at == at;
    let factor =
        |f: &Finding| f.parameters.first().and_then(|(_, list)| list.first()).map_or(1.0, |e| e.value);
    let of_unit = |at: &str| -> f64 {
        effects.iter().filter(|f| is_at(f, wrong_unit::KIND.name, at)).map(factor).product()
    };
    let has_gain = |at: &str| effects.iter().any(|f| is_at(f, sensor_gain::KIND.name, at));
    let in_total = |finding: &Finding| match finding.effect == sensor_gain::KIND.name {
        true => finding.times(of_unit(&finding.at)),
        false => finding.clone(),
    };
    let is_kept = |f: &&Finding| !(f.effect == wrong_unit::KIND.name && has_gain(&f.at));
    effects.iter().filter(is_kept).map(in_total).collect()
}

/// The [`sentences`] on the effects. If there are any, the descriptions of the next tests say in which unit their loads
/// are.
pub(crate) fn note(forward: &Forward, effects: &[Finding], next_tests: &mut [NextTest]) -> Vec<String> {
    let sentences = sentences(forward, effects);
    if !sentences.is_empty() {
        next_tests.iter_mut().for_each(|test| test.description.push_str(OF_NEXT_TEST));
    }
    sentences
}

/// A sentence for each factor on the readings of a channel that one of the `effects` found, if it is near a factor
/// between two units, or outside the range that the gain of an instrument may have. The sentence names all units whose
/// factor is near.
fn sentences(forward: &Forward, effects: &[Finding]) -> Vec<String> {
    let is_factor =
        |f: &&Finding| [wrong_unit::KIND.name, sensor_gain::KIND.name].contains(&f.effect.as_str());
    let of = |finding: &Finding| {
        let channel = Channel::from_word(&finding.at)?;
        let factor = finding.parameters.first()?.1.first()?.value;
        sentence(&finding.label(), factor, &possible_slips(forward, channel))
    };
    joined(effects.to_vec()).iter().filter(is_factor).filter_map(of).collect()
}

fn sentence(label: &str, factor: f64, slips: &[&UnitSlip]) -> Option<String> {
    if (1.0 - USUAL_GAIN..=1.0 + USUAL_GAIN).contains(&factor) {
        return None;
    }
    let apart = |unit: &&&UnitSlip| libm::log(factor / unit.factor).abs();
    let near = slips.iter().filter(|unit| apart(unit) < NEAR);
    let causes: Vec<String> = near
        .map(|unit| format!("{} ({})", unit.cause, crate::report::number::significant(unit.factor, 4)))
        .collect();
    let is_of_instrument = sensor_gain::KIND.parameter("gain").is_some_and(|gain| gain.allows(factor));
    match (causes.is_empty(), is_of_instrument) {
        (false, _) => Some(format!(
            "the factor of {label} is near that between two units: {}. Check these columns first",
            causes.join(", or ")
        )),
        (true, true) => None,
        (true, false) => Some(format!(
            "the factor of {label}, {} in total, is that of no instrument and of no unit that is known here. Check the \
             units of readings and loads first",
            crate::report::number::significant(factor, 4)
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reconcile::model::estimate::Estimate;

    fn said(factor: f64) -> Option<String> {
        let slips: Vec<&UnitSlip> =
            wrong_unit::SLIPS.iter().filter(|unit| unit.is_of(Channel::Static)).collect();
        sentence("sensor_gain@static", factor, &slips)
    }

    #[test]
    fn a_factor_near_that_between_two_units_is_named_as_each_of_them() {
        let kgf = said(9.9).expect("named");
        assert!(kgf.contains("forces in kgf in a column of N (9.807)") && kgf.contains("tenths"), "{kgf}");
        assert!(said(0.4544).expect("named").contains("payloads in pounds"));
        let thousandth = said(0.001).expect("named");
        assert!(thousandth.contains("metres") && thousandth.contains("payloads in grams"), "{thousandth}");
        assert_eq!(said(1.04), None, "the gain of an instrument");
        assert_eq!(said(1.7), None);
        assert!(said(650.0).expect("said").contains("no unit that is known"));
    }

    fn found(effect: &str, at: &str, value: f64) -> Finding {
        let one = Estimate { value, low: Some(0.9 * value), high: Some(1.1 * value) };
        Finding {
            effect: effect.into(),
            at: at.into(),
            parameters: vec![("factor".into(), vec![one])],
            indistinguishable_from: Vec::new(),
        }
    }

    #[test]
    fn a_unit_and_a_gain_of_one_channel_are_one_factor() {
        let pair = vec![found("wrong_unit", "static", 40.0), found("sensor_gain", "static", 2.5)];
        let apart = vec![found("sensor_gain", "modal", 1.2), found("wrong_unit", "windup", 60.0)];
        let total = joined([pair, apart.clone()].concat());
        assert_eq!(total[0].label(), "sensor_gain@static");
        let gain = &total[0].parameters[0].1[0];
        assert_eq!((gain.value, gain.low, gain.high), (100.0, Some(90.0), Some(110.0)));
        assert_eq!(total[1..], apart);
    }
}
