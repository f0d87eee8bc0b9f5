//! The compliance of a joint from records: whether they identify it, and the stiffness with its interval.
//!
//! The twist by gravity and a transmission error of the output both vary with the angle of the joint. Where the records
//! cannot tell the two apart, the interval covers the fits with and without a transmission error.

use super::intervals::{attenuated, covering, is_positive, widened};
use super::twist::{CLEARLY, Group, TwistModel};
use crate::reconcile::model::estimate::Estimate;
use crate::reconcile::verdict::joint_record::{State, Stated};

/// Words on a transmission error that held-out blocks ask for and whose size may be zero.
pub(super) const ERROR_OF_UNKNOWN_SIZE: &str = "held-out blocks are predicted better with a transmission error whose size may be zero: a record over a larger range of \
     angles, or the rotor's inertia, would tell";

/// The compliance may be identified if at least this fraction of the torque's variance is independent of the joint's
/// own motion (see [`TwistModel::own_share_of_torque`]). This part of the torque tells the compliance from rotor
/// inertia and friction. See also [`WELL_BALANCED`].
const OWN_SHARE: f64 = 0.1;
/// A fraction below [`OWN_SHARE`] is enough too, if it is at least this many times the fraction of the torque's
/// variance that the balance of torques leaves unexplained. Load and friction then follow their formulas closely.
const WELL_BALANCED: f64 = 20.0;
/// A compliance is not identified if the upper end of its interval is more than this multiple of the lower end.
const WIDE: f64 = 5.0;
/// Smallest half width of the interval of a compliance, as a fraction of the value, because the scale factors of
/// sensors are not known better.
const LEAST_PART: f64 = 5e-3;
/// Upper bound of the compliance where a transmission error is in the model, as a multiple of the compliance for a
/// rotor without inertia. A rotor with the same inertia as its load, both referred to the output, gives this multiple.
/// Larger rotors are not considered.
const MOST_ROTOR: f64 = 2.0;
/// Words for the case that either a compliance under gravity or a transmission error alone explains the twist, so that
/// neither is identified.
pub(crate) const GRAVITY_OR_ERROR: &str = "the twist by gravity and a transmission error both follow the angle of the joint, and the rotor's inertia is not \
     stated: the records cannot tell them apart";

/// Result for the compliance of a joint: whether it is identified, and the stiffness with its interval. `left_share` is
/// the fraction of the torque's variance that the balance of torques leaves unexplained, and `least` the result of
/// [`TwistModel::least_attenuation`].
pub(super) fn compliance(model: &TwistModel, left_share: f64, least: f64) -> Stated {
    const WHAT: &str = "compliance";
    const NAME: &str = "stiffness_nm_per_rad";
    if !model.rows.has_torque {
        return Stated::none(WHAT, State::NotIdentified, "the torque is not recorded");
    }
    let share = model.own_share_of_torque();
    let c = attenuated(model.fitted.coefficient(model.places.torque()), least);
    if share < OWN_SHARE.min(WELL_BALANCED * left_share) {
        let words = insufficient(model, share, left_share);
        let parameters = open(&beside_gear_error(model, c));
        return Stated { parameters, ..Stated::none(WHAT, State::NotIdentified, words) };
    }
    if c.high.is_some_and(|high| high < 0.0) {
        return Stated::none(WHAT, State::Refused, "the twist falls as the torque grows");
    }
    let c = widened(c, LEAST_PART * c.value.abs());
    let has_error = model.groups.contains(&Group::Output);
    if model.error_or_gravity.as_ref().is_some_and(|b| b.is_doubtful || (has_error && b.is_held)) {
        let parameters = open(&beside_gear_error(model, c));
        return Stated { parameters, ..Stated::none(WHAT, State::NotIdentified, GRAVITY_OR_ERROR) };
    }
    let (low, high) = (c.low.unwrap_or(0.0), c.high.unwrap_or(f64::INFINITY));
    let is_wide = |low: f64, high: f64| low <= 0.0 || high / low > WIDE;
    let is_needless = model.gain(Group::Compliance) < CLEARLY;
    if is_wide(low, high) || is_needless {
        let words = match is_wide(low, high) {
            true => {
                "the interval of the compliance contains zero or spans a factor of more than 5: the record hardly loads the joint"
            }
            false => {
                "friction, inertia and transmission error explain the twist nearly as well without a compliance"
            }
        };
        let parameters = open(&beside_gear_error(model, c));
        return Stated { parameters, ..Stated::none(WHAT, State::NotIdentified, words) };
    }
    let (low, high, mut words) = with_gear_error(model, low, high);
    let both = beside_gear_error(model, Estimate { value: c.value, low: Some(low), high: Some(high) });
    let (low, high) = (both.low.unwrap_or(low), both.high.unwrap_or(high));
    if is_wide(low, high) {
        let c = Estimate { value: c.value, low: Some(low), high: Some(high) };
        return Stated { parameters: open(&c), ..Stated::none(WHAT, State::NotIdentified, GRAVITY_OR_ERROR) };
    }
    let stiffness = Estimate { value: 1.0 / c.value, low: Some(1.0 / high), high: Some(1.0 / low) };
    words.extend(softer_without_shift(model, c.value));
    Stated::one(WHAT, State::Found, NAME, stiffness, &words.join("; "))
}

/// A clause that says how many times too large the compliance `rad_per_nm` would come out in a model without time shift
/// and friction. `None` if the model has no time shift, or if this factor is at most 1.1.
fn softer_without_shift(model: &TwistModel, rad_per_nm: f64) -> Option<String> {
    let p = model.places;
    let plain = model.fit_with(&[p.offsets(), vec![p.torque()]].concat());
    let factor = plain.map_or(0.0, |f| f.value(p.torque())) / rad_per_nm;
    let is_said = model.groups.contains(&Group::Shift) && factor > 1.1;
    is_said.then(|| format!("without time shift and friction it would come out {factor:.1} times too soft"))
}

/// Sentence that says why the compliance of a joint is not identified: its own acceleration and friction explain nearly
/// all of the torque. `share` is the fraction of the torque's variance that they do not explain. `left_share` is the
/// fraction that the balance of torques leaves unexplained.
fn insufficient(model: &TwistModel, share: f64, left_share: f64) -> String {
    let is_stated = model.rows.rotor_inertia_kgm2.is_some();
    format!(
        "insufficient excitation: {:.0} % of the torque's variance is the joint's own acceleration and friction{}; {:.1} % are \
         explained by neither friction nor load, so that compliance cannot be told from them",
        100.0 * (1.0 - share),
        if is_stated { "" } else { " and the rotor's inertia is not stated" },
        100.0 * left_share
    )
}

/// The compliance `c` \[rad/(N m)\] with a wider interval, if a transmission error of the output is in the model or
/// remains possible. The interval then covers the fit with this error, and also the fit without it if that fit shows
/// the compliance. Otherwise `c` is unchanged.
fn beside_gear_error(model: &TwistModel, c: Estimate) -> Estimate {
    let Some(beside) = &model.error_or_gravity else { return c };
    if !beside.is_doubtful && !model.groups.contains(&Group::Output) {
        return c;
    }
    let torque = model.places.torque();
    let with = beside.with.coefficient(torque);
    let mut out = covering(c, with);
    if beside.shows {
        out = covering(out, beside.without.coefficient(torque));
    }
    if beside.is_held {
        // the compliance is smallest with a rotor of zero inertia, and twice as large with a rotor of the load's
        // inertia
        let most = |high: f64| high.max(MOST_ROTOR * with.high.unwrap_or(high));
        out.high = out.high.map(most);
    }
    out
}

/// The limits `low` and `high` of the compliance \[rad/(N m)\] and a remark. If the model has a transmission error of
/// the output, the limits are widened to cover the compliance of a fit without it. Without such an error, or if that
/// compliance may be zero, the limits are unchanged and there is no remark.
fn with_gear_error(model: &TwistModel, low: f64, high: f64) -> (f64, f64, Vec<String>) {
    if !model.groups.contains(&Group::Output) {
        return (low, high, Vec::new());
    }
    let others: Vec<Group> = model.groups.iter().copied().filter(|g| *g != Group::Output).collect();
    let without = model.fit(&others).map(|f| f.coefficient(model.places.torque()));
    let Some(c) = without.filter(is_positive) else { return (low, high, Vec::new()) };
    let words = format!(
        "{:.3e} Nm/rad without the transmission error, which turns with the joint as gravity does; the interval has both",
        1.0 / c.value
    );
    (low.min(c.low.unwrap_or(low)), high.max(c.high.unwrap_or(high)), vec![words])
}

/// Stiffness \[N m/rad\] for a compliance `c` that is not identified, as a named parameter with its interval. The upper
/// end of the interval is `None` where the compliance may be zero. Empty if the best compliance or its upper end is not
/// positive.
fn open(c: &Estimate) -> Vec<(String, Vec<Estimate>)> {
    let stiffness = |c: Option<f64>| c.filter(|c| *c > 0.0 && c.is_finite()).map(|c| 1.0 / c);
    let Some(low) = stiffness(c.high) else { return Vec::new() };
    let value = if c.value > 0.0 { 1.0 / c.value } else { f64::MAX };
    if value == f64::MAX {
        return Vec::new();
    }
    vec![("stiffness_nm_per_rad".into(), vec![Estimate { value, low: Some(low), high: stiffness(c.low) }])]
}
