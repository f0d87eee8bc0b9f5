//! Says in words which units a factor on the readings of a channel may come from.
//!
//! A load in another unit multiplies the readings as a gain of the instrument does: the tip moves in proportion to the
//! force or the payload. The readings alone cannot tell the two from each other, but a factor that is one between two
//! units is seldom a gain.

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
/// A gain nearer to 1 than this is that of an instrument.
const USUAL_GAIN: f64 = 0.3;

/// What the description of a next test adds if a column seems to be in another unit.
const OF_NEXT_TEST: &str = "; the loads are in the unit of the campaign's columns";

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
/// between two units. The sentence names all of these units.
fn sentences(forward: &Forward, effects: &[Finding]) -> Vec<String> {
    let is_factor =
        |f: &&Finding| [wrong_unit::KIND.name, sensor_gain::KIND.name].contains(&f.effect.as_str());
    let of = |finding: &Finding| {
        let channel = Channel::from_word(&finding.at)?;
        let factor = finding.parameters.first()?.1.first()?.value;
        sentence(&finding.label(), factor, &possible_slips(forward, channel))
    };
    effects.iter().filter(is_factor).filter_map(of).collect()
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
    (!causes.is_empty()).then(|| {
        format!(
            "the factor of {label} is near that between two units: {}. Check these columns first",
            causes.join(", or ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

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
    }
}
