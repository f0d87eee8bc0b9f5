//! Finds readings that are in another unit than the file states, while their standard deviations are in the stated
//! unit.
//!
//! A column that was multiplied by 25.4 has 25.4 times the noise. With the declared standard deviations no model fits
//! such readings, not even one with the right factor. So the confusion of units is found only after the standard
//! deviations are enlarged by the same factor.

use super::stats::median;
use crate::arm::effect::channel::Channel;
use crate::arm::effect::wrong_unit::{self, UnitColumn, UnitSlip};
use crate::reconcile::forward::coefficients::Coefficients;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::model::parameters::Candidate;
use crate::reconcile::readings::components::{DISPLACEMENT, FEWEST_ALIKE};
use std::collections::BTreeSet;

/// Largest difference between the logarithm of the ratio of readings to nominal predictions and the logarithm of the
/// factor between two units. It is wide, because an effect that is still missing changes the ratio.
const UNIT_TOLERANCE: f64 = 0.25;

/// A suspicion that the declared standard deviations of a channel are too small by a factor, because its readings are
/// in another unit than stated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stretch {
    channel: Channel,
    factor: f64,
}

impl Stretch {
    /// Whether one of the `effects` is the confusion of units that this suspicion is about.
    pub(crate) fn is_among(&self, effects: &[&Candidate]) -> bool {
        effects
            .iter()
            .any(|effect| effect.kind.name == wrong_unit::KIND.name && effect.at == self.channel.word())
    }

    /// Sentence that states the factor by which the standard deviations of the channel are enlarged.
    pub(crate) fn sentence(&self) -> String {
        let Self { channel, factor } = self;
        let (channel, factor) = (channel.word(), crate::report::number::significant(*factor, 4));
        format!(
            "the noise of the {channel} readings is about {factor} times what is declared, as the readings themselves are: their standard deviations are taken to be {factor} times those of the file"
        )
    }
}

/// The channels in which a confusion of units is likely. Two conditions must hold. The ratio of the readings to the
/// predictions of the nominal arm is about the factor between two units. The median residual of the best model, whose
/// coefficients are `best`, is larger than the declared standard deviation times the root of this factor.
pub(crate) fn stretches(forward: &Forward, best: &Coefficients) -> Vec<Stretch> {
    let nominal = forward.predict(&forward.coefficients(&forward.nominal));
    let predicted = forward.predict(best);
    let of_channel = |channel: Channel| {
        let range = forward.range(channel);
        let own = &forward.data[range.clone()];
        let (both, square) = own
            .iter()
            .zip(&nominal[range.clone()])
            .fold((0.0, 0.0), |(both, square), (d, model)| (both + d.value * model, square + model * model));
        // least-squares factor between readings and nominal model
        let ratio = both / square;
        // only units of the reading itself count, because a load in another unit does not change the noise
        let is_of = |unit: &&UnitSlip| unit.is_of(channel) && unit.column == UnitColumn::Reading;
        let units = wrong_unit::SLIPS.iter().filter(is_of);
        let slips = units.map(|unit| unit.factor).filter(|factor| *factor > 1.0);
        let factor = slips.min_by(|a, b| {
            let apart = |factor: &f64| libm::log(ratio / factor).abs();
            apart(a).total_cmp(&apart(b))
        })?;
        let misses = own.iter().zip(&predicted[range]).map(|(d, model)| ((d.value - model) / d.sigma).abs());
        let is_slip = square > 0.0 && ratio > 0.0 && libm::log(ratio / factor).abs() < UNIT_TOLERANCE;
        (is_slip && median(misses.collect()) > factor.sqrt()).then_some(Stretch { channel, factor })
    };
    [Channel::Static, Channel::Modal, Channel::Windup].into_iter().filter_map(of_channel).collect()
}

/// Reversed signs are suspected if the cosine of the angle between the vector of all readings of one component and
/// the vector of their predictions is below this.
const OPPOSITE_COSINE: f64 = -0.9;
/// Reversed signs are reported only if reversing them divides the root mean square difference between the readings
/// and the nominal arm by at least this factor.
const LEAST_IMPROVEMENT: f64 = 3.0;

/// Sentences on static readings that seem to follow another convention than the columns state: another sign, or another
/// unit.
pub(crate) fn other_conventions(forward: &Forward) -> Vec<String> {
    [other_signs(forward), other_units(forward)].concat()
}

/// One sentence for each component of the displacement whose readings seem to have the opposite sign. An example is a
/// dial gauge that reads positive when its plunger is pushed in.
fn other_signs(forward: &Forward) -> Vec<String> {
    let nominal = forward.predict(&forward.coefficients(&forward.nominal));
    let range = forward.range(Channel::Static);
    let of_component = |c: usize| {
        let own = range.clone().filter(|i| forward.data[*i].component == c);
        let own: Vec<(f64, f64)> = own.map(|i| (forward.data[i].value, nominal[i])).collect();
        let sum = |of: fn(&(f64, f64)) -> f64| own.iter().map(of).sum::<f64>();
        let cosine = sum(|(d, m)| d * m) / (sum(|(d, _)| d * d) * sum(|(_, m)| m * m)).sqrt();
        let nearer = (sum(|(d, m)| (d - m).powi(2)) / sum(|(d, m)| (d + m).powi(2))).sqrt();
        (own.len() >= FEWEST_ALIKE && cosine < OPPOSITE_COSINE && nearer > LEAST_IMPROVEMENT).then(|| {
            format!(
                "{} is {} times nearer to the arm as given with the other sign: does the instrument count the other way? \
                 It was taken as it is",
                DISPLACEMENT.values[c],
                crate::report::number::significant(nearer, 2)
            )
        })
    };
    (0..3).filter_map(of_component).collect()
}

/// Displacements are taken for positions if they are this many times the largest displacement of the nominal arm.
const LIKE_POSITIONS: f64 = 20.0;
/// Positions of the tip in the rows of a file are nearly the same if the largest is at most this many times the smallest.
const NEARLY_THE_SAME: f64 = 1.3;

/// Sentence which asks whether the static readings are positions of the tip rather than its displacements: those of a
/// component are nearly the same in all rows, and far larger than any displacement of the nominal arm. `None` if none is.
pub(crate) fn like_positions(forward: &Forward) -> Option<String> {
    let nominal = forward.predict(&forward.coefficients(&forward.nominal));
    let range = forward.range(Channel::Static);
    let largest = nominal[range.clone()].iter().fold(0.0f64, |m, d| m.max(d.abs()));
    let of_component = |c: usize| {
        let own: Vec<f64> = range
            .clone()
            .filter(|i| forward.data[*i].component == c)
            .map(|i| forward.data[i].value)
            .collect();
        let least = own.iter().fold(f64::INFINITY, |m, d| m.min(d.abs()));
        let one_sided = own.iter().all(|d| *d > 0.0) || own.iter().all(|d| *d < 0.0);
        let greatest = own.iter().fold(0.0f64, |m, d| m.max(d.abs()));
        // displacements in another unit follow the load, and are not nearly the same in every row
        let is_same = greatest < NEARLY_THE_SAME * least;
        let is_far = own.len() >= FEWEST_ALIKE && one_sided && least > LIKE_POSITIONS * largest;
        (is_far && is_same).then(|| (DISPLACEMENT.values[c], median(own)))
    };
    let (column, value) = (0..3).find_map(of_component)?;
    Some(format!(
        "{column} is about {} mm in every row, and the arm as given moves by at most {} mm: are these positions of the \
         tip? {column} is the displacement from the reference state, so subtract the reading there, or write positions.csv",
        crate::report::number::significant(value, 3),
        crate::report::number::significant(largest, 2)
    ))
}

/// Least-squares factor between readings and their predictions for the nominal arm. Each of the `pairs` has a reading
/// and its prediction. `None` if there are too few readings, or if the factor is not positive.
fn ratio(pairs: &[(f64, f64)]) -> Option<f64> {
    let sum = |of: fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>();
    let ratio = sum(|(d, m)| d * m) / sum(|(_, m)| m * m);
    (pairs.len() >= FEWEST_ALIKE && ratio > 0.0 && ratio.is_finite()).then_some(ratio)
}

/// The confusion of units, among `slips`, by whose factor the readings seem to be off. `pairs` and `ratio` are those of
/// [`ratio()`]. `None` if no factor is near `ratio`, or if the nearest one does not bring the readings at least
/// [`LEAST_IMPROVEMENT`] times nearer to the nominal arm.
fn seeming_slip<'s>(pairs: &[(f64, f64)], ratio: f64, slips: &[&'s UnitSlip]) -> Option<&'s UnitSlip> {
    let sum = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>();
    let apart = |unit: &UnitSlip| libm::log(ratio / unit.factor).abs();
    let nearest = slips.iter().copied().min_by(|a, b| apart(a).total_cmp(&apart(b)))?;
    let misfit = |factor: f64| sum(&|(d, m)| (d - factor * m).powi(2)).sqrt();
    let is_near = apart(nearest) < UNIT_TOLERANCE && misfit(1.0) > LEAST_IMPROVEMENT * misfit(nearest.factor);
    is_near.then_some(nearest)
}

/// One sentence for each component of the displacement whose readings seem to be in another unit while the other static
/// readings are not. If all static readings are in another unit, the effect `wrong_unit`
/// describes it.
fn other_units(forward: &Forward) -> Vec<String> {
    let nominal = forward.predict(&forward.coefficients(&forward.nominal));
    let pairs = |own: &[usize]| -> Vec<(f64, f64)> {
        own.iter().map(|&i| (forward.data[i].value, nominal[i])).collect()
    };
    let is_reading = |unit: &&UnitSlip| unit.is_of(Channel::Static) && unit.column == UnitColumn::Reading;
    let slips: Vec<&UnitSlip> = wrong_unit::SLIPS.iter().filter(is_reading).collect();
    let range = forward.range(Channel::Static);
    let of_component =
        |c: usize| -> Vec<usize> { range.clone().filter(|i| forward.data[*i].component == c).collect() };
    let found = (0..3).filter_map(|component| {
        let (what, own) = (DISPLACEMENT.values[component], of_component(component));
        // a set, because a campaign may have 100,000 rows
        let own_set: BTreeSet<usize> = own.iter().copied().collect();
        let rest: Vec<usize> = range.clone().filter(|i| !own_set.contains(i)).collect();
        let (of_own, of_rest) = (ratio(&pairs(&own))?, ratio(&pairs(&rest))?);
        // if the rest is off by the same factor, nothing is special about this part
        if libm::log(of_own / of_rest).abs() < UNIT_TOLERANCE {
            return None;
        }
        let unit = seeming_slip(&pairs(&own), of_own, &slips)?;
        let factor = crate::report::number::significant(of_own, 3);
        Some(format!(
            "{what} is about {factor} times what the arm as given says: {}? It was taken as it is",
            unit.cause
        ))
    });
    found.collect()
}

/// Multiplies the declared standard deviations of the channels named in `stretches` by their factors.
pub(crate) fn stretch(forward: &mut Forward, stretches: &[Stretch]) {
    for Stretch { channel, factor } in stretches {
        let range = forward.range(*channel);
        forward.data[range].iter_mut().for_each(|datum| datum.sigma *= factor);
    }
}
