//! The compliance of a joint from records: whether they identify it, and the stiffness with its interval.
//!
//! Gravity and a transmission error of the output both follow the angle of the joint. Where the records cannot tell the
//! two apart, the interval covers the fits with and without that error.

use super::intervals::{attenuated, covering, is_positive, widened};
use super::twist::{CLEARLY, Group, TwistModel};
use crate::reconcile::model::estimate::Estimate;
use crate::reconcile::verdict::joint_record::{State, Stated};

/// The compliance is identified if at least this fraction of the torque's variance is not explained by the joint's
/// own acceleration and friction. This remainder is what tells the compliance from rotor inertia and friction. See
/// also [`WELL_BALANCED`].
const OWN_SHARE: f64 = 0.1;
/// A fraction below [`OWN_SHARE`] is also enough if it is at least this many times the fraction of the torque's
/// variance that the balance of torques leaves unexplained. Friction then follows its formula closely.
const WELL_BALANCED: f64 = 20.0;
/// A compliance is not identified if the upper end of its interval is more than this many times the lower end.
const WIDE: f64 = 5.0;
/// Smallest half width of the interval of a compliance, as a fraction of the value, because the scale factors of
/// sensors are not known better.
const LEAST_PART: f64 = 5e-3;
/// Largest compliance in the presence of a transmission error, as a multiple of the compliance for a rotor without
/// inertia. A rotor with the inertia of its load gives this multiple, and no rotor is taken to have more inertia.
const MOST_ROTOR: f64 = 2.0;
/// Reason why a compliance or a transmission error is not identified: either of them alone explains the twist by
/// gravity.
pub(crate) const GRAVITY_OR_ERROR: &str = "the twist by gravity and a transmission error both follow the angle of the joint, and the rotor's inertia is not \
     stated: the records cannot tell them apart";

/// Result for the compliance of a joint: whether it is identified, and the stiffness with its interval. `left_share`
/// is the fraction of the torque's variance that the balance of torques leaves unexplained, and `least` that of
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
/// and friction. `None` if the model has no time shift, or if the difference is small.
fn softer_without_shift(model: &TwistModel, rad_per_nm: f64) -> Option<String> {
    let p = model.places;
    let plain = model.fit_with(&[p.offsets(), vec![p.torque()]].concat());
    let factor = plain.map_or(0.0, |f| f.value(p.torque())) / rad_per_nm;
    let is_said = model.groups.contains(&Group::Shift) && factor > 1.1;
    is_said.then(|| format!("without time shift and friction it would come out {factor:.1} times too soft"))
}

/// Sentence on a joint whose torque mostly serves its own motion. `share` is the fraction of the torque's variance that
/// does not, and `left_share` is the fraction that the balance of torques leaves unexplained.
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

/// The compliance `c` \[rad/(N m)\], with its interval widened for a transmission error of the output. It then covers
/// the fit with this error, and also the fit without the error if that fit shows the compliance.
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
        // with a rotor of zero inertia the compliance is smallest; with a rotor of the load's inertia it is twice as
        // large
        let most = |high: f64| high.max(MOST_ROTOR * with.high.unwrap_or(high));
        out.high = out.high.map(most);
    }
    out
}

/// The limits `low` and `high` of the compliance \[rad/(N m)\], widened so that they include the value without a
/// transmission error in the model, and a sentence on it. Gravity and a transmission error both vary with the joint's
/// angle and are hard to tell apart.
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

/// Stiffness with its interval \[N m/rad\], as a parameter, for a compliance `c` that is not identified. The upper
/// end is `None` where the compliance may be zero. Empty if the best compliance or its upper end is not positive.
fn open(c: &Estimate) -> Vec<(String, Vec<Estimate>)> {
    let stiffness = |c: Option<f64>| c.filter(|c| *c > 0.0 && c.is_finite()).map(|c| 1.0 / c);
    let Some(low) = stiffness(c.high) else { return Vec::new() };
    let value = if c.value > 0.0 { 1.0 / c.value } else { f64::MAX };
    if value == f64::MAX {
        return Vec::new();
    }
    vec![("stiffness_nm_per_rad".into(), vec![Estimate { value, low: Some(low), high: stiffness(c.low) }])]
}
