//! Laws without a name as effects of a model. They are found one after the other, each fitted in full together with all
//! others.
//!
//! [`unnamed`](super::unnamed) asks, with a linearized model, whether a law competes with named effects. Here a law
//! becomes an effect of the arm, so that a corrected arm can contain it. It is a further twist of a joint as a
//! polynomial of its torque, or a nonlinear characteristic or a separate gain in each direction of the readings of a
//! channel.

use super::search::{Scored, Search};
use crate::arm::effect::channel::Channel;
use crate::arm::effect::empirical::{BEND, EVEN_TWIST, GAIN, KIND, ODD_TWIST};
use crate::arm::effect::kind::{Absent, Parameter, Scale};
use crate::reconcile::fit::descent::{Effort, Fit};
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::model::candidates::largest_torque_nm;
use crate::reconcile::model::parameters::Number::{Free, Stated};
use crate::reconcile::model::parameters::{Candidate, FreeParameter};
use rayon::prelude::*;

/// Largest number of laws without a name in one model.
const MOST_LAWS: usize = 3;
/// A law is accepted if the logarithm of the evidence, less the logarithm of the number of places where a law is
/// tried, rises by more than this.
const BETTER: f64 = 2.0;
/// A joint is not tried if its largest torque is less than this fraction of the largest torque on any joint.
const UNLOADED: f64 = 1e-3;
/// Largest size of a law of a joint (a further twist) that is sought, as a multiple of the joint's nominal twist at
/// its largest torque.
const LARGEST: f64 = 3.0;

/// All laws without a name at every place where the readings could show them, as candidates.
pub(crate) fn laws(forward: &Forward) -> Vec<Candidate> {
    let nominal = forward.coefficients(&forward.nominal);
    let torques_nm: Vec<f64> =
        forward.layout.joints.iter().map(|slot| largest_torque_nm(forward, &slot.name)).collect();
    let largest = torques_nm.iter().copied().fold(0.0, f64::max);
    let mut out = Vec::new();
    for ((slot, law), torque_nm) in forward.layout.joints.iter().zip(&nominal.laws).zip(torques_nm) {
        if !law.is_rigid() && torque_nm > UNLOADED * largest {
            out.extend(twists(&slot.name, torque_nm, law.angle_rad(torque_nm).abs()));
        }
    }
    for channel in [Channel::Static, Channel::Modal, Channel::Windup] {
        let sizes = forward.data[forward.range(channel)].iter().map(|d| d.value.abs());
        let largest = sizes.fold(0.0, f64::max);
        if largest > 0.0 {
            out.extend(readings(channel, largest));
        }
    }
    out
}

/// Sentence on the possible physical causes of the law that the candidate stands for.
pub(crate) fn may_be(candidate: &Candidate) -> &'static str {
    match candidate.free_parameters.first().map(|free| free.name) {
        Some(ODD_TWIST) => "it may be a gear or a connection that stiffens or softens as it is loaded",
        Some(EVEN_TWIST) => {
            "it may be play, a preload, a cable or a spring: the twist differs between the senses of the torque"
        }
        Some(BEND) => {
            "it may be an instrument that is not straight, or a displacement too large for a straight law"
        }
        _ => "it may be an instrument whose axes have gains of their own, or are not square",
    }
}

/// Description in words of the law that the candidate stands for.
pub(crate) fn in_words(candidate: &Candidate) -> String {
    let at = &candidate.at;
    match candidate.free_parameters.first().map(|free| free.name) {
        Some(ODD_TWIST) => format!("a further twist of {at} that is odd in its torque"),
        Some(EVEN_TWIST) => format!("a further twist of {at} that is even in its torque"),
        Some(BEND) => format!("{at} readings that bend"),
        _ => format!("{at} readings with a gain of their own in each direction"),
    }
}

/// Adds laws without a name to the model `from`, one after the other, as long as each raises the score by more than
/// [`BETTER`]. The laws are the candidates of `search` from the index `first` on. `None` if no law does.
pub(crate) fn with_laws<'a>(search: &Search<'a>, first: usize, from: &Scored) -> Option<(Scored, Fit<'a>)> {
    let mut best: Option<(Scored, Fit)> = None;
    for _ in 0..MOST_LAWS {
        let here = best.as_ref().map_or(from, |(scored, _)| scored);
        let Some(next) = next_law(search, first, here) else { break };
        best = Some(next);
    }
    best
}

/// The fit of the model `from` with that law added which raises its score most; `None` if the rise is not more than
/// [`BETTER`].
fn next_law<'a>(search: &Search<'a>, first: usize, from: &Scored) -> Option<(Scored, Fit<'a>)> {
    let laws: Vec<usize> =
        (first..search.candidates.len()).filter(|law| !from.effects.contains(law)).collect();
    let tried: Vec<Scored> = laws
        .into_par_iter()
        .map(|law| {
            let effects = [from.effects.as_slice(), &[law]].concat();
            let u = [from.u.as_slice(), &search.candidates[law].starts[0]].concat();
            search.scored(&effects, &search.rough(&effects, &u))
        })
        .collect();
    let promising = tried.into_iter().max_by(|a, b| a.score.total_cmp(&b.score))?;
    let fit = search.fit(&promising.effects, &promising.u, Effort::default());
    let scored = search.scored(&promising.effects, &fit);
    (scored.score > from.score + BETTER).then_some((scored, fit))
}

/// Two laws of a joint as candidates: a further twist that is an odd function of the joint's torque, and one that is
/// an even function. `torque_nm` is the largest torque on the joint, and `twist_rad` its twist there.
fn twists(joint: &str, torque_nm: f64, twist_rad: f64) -> [Candidate; 2] {
    let most = LARGEST * twist_rad;
    let sized =
        |name| Parameter { count: 2, ..Parameter::number(name, -most, most, twist_rad, Scale::Linear) };
    let odd = law(joint, sized(ODD_TWIST), 0.0);
    let even = law(joint, sized(EVEN_TWIST), 0.0);
    [
        Candidate { numbers: vec![Free, Free, Stated(0.0), Stated(0.0), Stated(torque_nm)], ..odd },
        Candidate { numbers: vec![Stated(0.0), Stated(0.0), Free, Free, Stated(torque_nm)], ..even },
    ]
}

/// The laws of a channel's readings as candidates: a nonlinear characteristic, and a gain for each direction if the
/// channel has three components. `largest` is the largest reading, in its unit.
fn readings(channel: Channel, largest: f64) -> Vec<Candidate> {
    let bend = Parameter { count: 2, ..Parameter::number(BEND, -1.0, 1.0, 0.1, Scale::Linear) };
    let bent = law(channel.word(), bend, 0.0);
    let mut out = vec![Candidate {
        numbers: [vec![Free, Free, Stated(largest)], vec![Stated(1.0); 3]].concat(),
        ..bent
    }];
    if channel.components() == 3 {
        let gain = Parameter::vector(GAIN, 0.5, 2.0, 1.0).absent(Absent::AtOne);
        let gains = law(channel.word(), gain, 1.0);
        out.push(Candidate {
            numbers: [vec![Stated(0.0), Stated(0.0), Stated(1.0)], vec![Free; 3]].concat(),
            ..gains
        });
    }
    out
}

/// A candidate at the place `at` with one free parameter, which may be a vector. Its fits start at the value
/// `absent`, at which the law changes nothing. The caller sets `numbers`.
fn law(at: &str, parameter: Parameter, absent: f64) -> Candidate {
    let free = (0..parameter.count).map(|component| FreeParameter::new(&parameter, component, 1.0));
    let free_parameters: Vec<FreeParameter> = free.collect();
    let starts = vec![free_parameters.iter().map(|free| free.u(absent)).collect()];
    Candidate { kind: &KIND, at: at.into(), free_parameters, numbers: Vec::new(), starts, twins: Vec::new() }
}
