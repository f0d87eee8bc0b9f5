//! Laws without a name as effects of a model. They are found one after the other, each fitted in full together with all
//! others.
//!
//! [`unnamed`](super::unnamed) asks whether a law competes with named effects, with the model made linear. Here a law
//! becomes an effect of the arm, so that a corrected arm can have it. The laws are:
//!
//! - a further twist of a joint as a polynomial of its torque;
//! - a housing or a base that tilts about two axes, with a compliance of its own for each;
//! - a joint whose stiffness changes with the order of the tests;
//! - readings that are a nonlinear function of the true value, or that have a gain of their own in each direction;
//! - displacements of which each direction also shows a part of the others;
//! - a base that turned once in the course of the tests.

use super::search::{Scored, Search};
use crate::arm::BASE;
use crate::arm::effect::channel::Channel;
use crate::arm::effect::empirical::{
    BASE_TURN, BEND, EVEN_TWIST, GAIN, KIND, LEAN, MIX, ODD_TWIST, SOFTENING, SOFTENING_REFERENCE,
    SOFTENING_ROWS,
};
use crate::arm::effect::kind::{Absent, Parameter, Scale};
use crate::arm::structure::Piece;
use crate::reconcile::fit::descent::{Effort, Fit, Weights};
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::forward::statics::StaticPose;
use crate::reconcile::model::candidates::largest_torque_nm;
use crate::reconcile::model::parameters::Number::{Free, Stated};
use crate::reconcile::model::parameters::{Candidate, FreeParameter, LARGEST_COMPLIANCE, Number};
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

/// Largest number of laws without a name in one model.
const MOST_LAWS: usize = 3;
/// A law is accepted if the logarithm of the evidence, less the logarithm of the number of places where a law is
/// tried, rises by more than this.
const LEAST_GAIN: f64 = 2.0;
/// A joint is not tried if its largest torque is less than this fraction of the largest torque on any joint.
const UNLOADED_SHARE: f64 = 1e-3;
/// Largest size of a law of a joint (a further twist) that is sought, as a multiple of the joint's nominal twist at
/// its largest torque.
const LARGEST_TWIST: f64 = 3.0;

/// Channels in whose tests a joint may soften, in the order of their parameters.
const SOFTENING_IN: [Channel; 2] = [Channel::Static, Channel::Modal];
/// A joint softens by 63 % of its total within a number of rows that is fitted. Fits start from these values of this
/// number, as fractions of the rows of the file.
const SOFTENED_AFTER: [f64; 2] = [0.08, 0.5];
/// Place of the row of a base's turn among the numbers of a law of displacements.
const TURN_ROW: usize = 9;
/// Smallest number of poses that must come before a turn of the base, and of poses that must come after it.
const FEWEST_POSES: usize = 2;

/// Every law at every place where the readings could show it. `baseline` is the best fit with calibration alone. Its
/// residuals show at which row the base could have turned.
pub(crate) fn laws(forward: &Forward, baseline: &Fit, weights: &Weights) -> Vec<Candidate> {
    let nominal = forward.coefficients(&forward.nominal);
    let torques_nm: Vec<f64> =
        forward.layout.joints.iter().map(|slot| largest_torque_nm(forward, &slot.name)).collect();
    let largest = torques_nm.iter().copied().fold(0.0, f64::max);
    let mut out = Vec::new();
    let joints = forward.layout.joints.iter().zip(&nominal.laws).zip(torques_nm);
    // a law at a joint with the name of the base could not be written: the name means the base
    for ((slot, law), torque_nm) in joints.filter(|((slot, _), _)| slot.name != BASE) {
        out.extend(housing(forward, &slot.name, torque_nm));
        if !law.is_rigid() && torque_nm > UNLOADED_SHARE * largest {
            out.extend(twists(&slot.name, torque_nm, law.angle_rad(torque_nm).abs()));
            out.extend((0..SOFTENING_IN.len()).filter_map(|c| softening(forward, &slot.name, torque_nm, c)));
        }
    }
    for channel in [Channel::Static, Channel::Modal, Channel::Windup] {
        let sizes = forward.data[forward.range(channel)].iter().map(|d| d.value.abs());
        let largest = sizes.fold(0.0, f64::max);
        if largest > 0.0 {
            out.extend(readings(channel, largest));
        }
    }
    out.extend(mixing(forward));
    out.extend(lean(forward));
    out.extend(most_telling_row(forward, baseline, weights).map(base_turn));
    out
}

/// The candidate for a joint whose stiffness changes with the order of the tests of one channel. `channel` is the index
/// of this channel in [`SOFTENING_IN`]. `None` if the channel has no readings.
fn softening(forward: &Forward, joint: &str, torque_nm: f64, channel: usize) -> Option<Candidate> {
    let range = forward.range(SOFTENING_IN[channel]);
    let rows = forward.data[range].iter().map(|datum| datum.row + 1).max()? as f64;
    let size = Parameter::number(SOFTENING[channel], -0.8, 3.0, 0.3, Scale::Linear);
    let pace = Parameter::number(SOFTENING_ROWS[channel], 0.1, 1e6, rows, Scale::Log);
    let mut free_parameters = vec![
        FreeParameter::new(&size, 0, 1.0),
        FreeParameter::new(&pace, 0, 1.0).within(libm::log(0.1), libm::log(3.0 * rows)),
    ];
    let mut numbers = [vec![Stated(0.0); 4], vec![Stated(torque_nm)], steady(), upright()].concat();
    let first = 5 + 2 * channel;
    numbers[first..first + 2].fill(Free);
    let paces = SOFTENED_AFTER.map(|part| libm::log((part * rows).max(1.0)));
    let mut starts = paces.map(|pace| vec![1.0, pace]).to_vec();
    if SOFTENING_IN[channel] == Channel::Static {
        let reference =
            Parameter::number(SOFTENING_REFERENCE, 0.0, 1.0, 1.0, Scale::Linear).absent(Absent::Never);
        free_parameters.push(FreeParameter::new(&reference, 0, 1.0));
        numbers[9] = Free;
        starts = starts
            .iter()
            .flat_map(|start| [0.1, 0.9].map(|part| [start.as_slice(), &[part]].concat()))
            .collect();
    }
    Some(Candidate { kind: &KIND, at: joint.into(), free_parameters, numbers, starts, twins: Vec::new() })
}

/// The softening parameters of a joint that does not soften, as stated numbers.
fn steady() -> Vec<Number> {
    [0.0, 1.0, 0.0, 1.0, 1.0].map(Stated).to_vec()
}

/// The housing parameters of a joint whose housing does not tilt further, as stated numbers.
fn upright() -> Vec<Number> {
    vec![Stated(0.0); 2]
}

/// The candidate that each direction of the displacements also shows a part of the others. `None` if there are no
/// displacements.
fn mixing(forward: &Forward) -> Option<Candidate> {
    let statics = &forward.data[forward.range(Channel::Static)];
    let is_measured = |component: usize| statics.iter().any(|datum| datum.component == component);
    let part = Parameter { count: 6, ..Parameter::number(MIX, -0.5, 0.5, 0.05, Scale::Linear) };
    let of_component = [0, 0, 1, 1, 2, 2].map(is_measured);
    let numbers = of_component.map(|measured| if measured { Free } else { Stated(0.0) });
    let mut candidate = law(Channel::Static.word(), part, 0.0);
    candidate.free_parameters.retain(|free| of_component[free.component]);
    candidate.starts = vec![candidate.free_parameters.iter().map(|free| free.u(0.0)).collect()];
    candidate.numbers =
        [vec![Stated(0.0), Stated(0.0)], vec![Stated(1.0); 4], still(), numbers.to_vec()].concat();
    (!statics.is_empty()).then_some(candidate)
}

/// The numbers of a base that did not turn in the course of the displacements.
fn still() -> Vec<Number> {
    [0.0, 0.0, 0.0, 1.0].map(Stated).to_vec()
}

/// The numbers of an instrument whose directions do not mix.
fn square() -> Vec<Number> {
    vec![Stated(0.0); 6]
}

/// The candidate for a base that tilts about world x and about world y with a compliance of its own for each. `None` if
/// no joint is compliant, or if a piece of the arm has the name of the base.
fn lean(forward: &Forward) -> Option<Candidate> {
    let is_free = forward.nominal.structure.pieces.iter().all(|piece| piece.name() != BASE);
    leaning(forward, BASE, vec![Free; 2]).filter(|_| is_free)
}

/// The candidate for the housing of a joint that tilts about two axes with a compliance of its own for each. `None` if
/// no joint is compliant. `None` also for a vertical joint that stands on the base, because [`lean`] then describes the
/// same.
fn housing(forward: &Forward, joint: &str, torque_nm: f64) -> Option<Candidate> {
    let turns_on_the_base = forward.nominal.structure.pieces.first().is_some_and(|piece| match piece {
        Piece::Joint(first) => first.name == joint && first.axis.z.abs() > 1.0 - 1e-12,
        _ => false,
    });
    let untwisted = [vec![Stated(0.0); 4], vec![Stated(torque_nm)], steady()].concat();
    leaning(forward, joint, [untwisted, vec![Free; 2]].concat()).filter(|_| !turns_on_the_base)
}

/// A candidate for two tilts at a place. The usual size of both compliances is the compliance of the first compliant
/// joint.
/// `None` if no joint is compliant.
fn leaning(forward: &Forward, at: &str, numbers: Vec<Number>) -> Option<Candidate> {
    let laws = forward.coefficients(&forward.nominal).laws;
    let size = laws.iter().map(|law| law.tangent_compliance_rad_per_nm(0.0)).find(|c| *c > 0.0)?;
    let tilt = Parameter {
        count: 2,
        ..Parameter::number(LEAN, 0.0, LARGEST_COMPLIANCE * size, size, Scale::Linear)
    };
    let starts = vec![vec![0.1, 0.5], vec![0.5, 0.1]];
    Some(Candidate { numbers, starts, ..law(at, tilt, 0.0) })
}

/// The candidate for a base that turned just before the row `from_row` (counted from 0) of the displacements.
fn base_turn(from_row: usize) -> Candidate {
    let turn = Parameter { count: 3, ..Parameter::number(BASE_TURN, -0.1, 0.1, 1e-4, Scale::Linear) };
    let straight = vec![Stated(0.0), Stated(0.0), Stated(1.0), Stated(1.0), Stated(1.0), Stated(1.0)];
    let numbers = [straight, vec![Free; 3], vec![Stated((from_row + 1) as f64)], square()];
    Candidate { numbers: numbers.concat(), ..law(Channel::Static.word(), turn, 0.0) }
}

/// The first row of a pose, from 0, before which a turn of the base would explain most of the residuals of a fit.
/// `None` if there are too few poses.
fn most_telling_row(forward: &Forward, fit: &Fit, weights: &Weights) -> Option<usize> {
    let residuals = fit.residuals(forward, weights);
    // normal equations of the turn for each pose, in units of the rows' standard deviations
    let of_pose = |pose: &StaticPose| {
        let (mut a, mut b) = (Matrix3::zeros(), Vector3::zeros());
        let mut first = usize::MAX;
        for (component, datum) in (0..pose.count()).flat_map(|load| pose.measured(load)) {
            let moved = Vector3::ith(component, 1e3 * weights.inverse[datum]).cross(&pose.geometry.tip_m);
            let slope = -moved;
            a += slope * slope.transpose();
            b += slope * residuals[datum];
            first = first.min(forward.data[datum].row);
        }
        (first, a, b)
    };
    let mut poses: Vec<(usize, Matrix3<f64>, Vector3<f64>)> = forward.statics.iter().map(of_pose).collect();
    poses.sort_by_key(|(first, ..)| *first);
    let gain = |from: usize| {
        let (a, b) =
            poses[from..].iter().fold((Matrix3::zeros(), Vector3::zeros()), |(a, b), p| (a + p.1, b + p.2));
        a.cholesky().map(|a| (b.dot(&a.solve(&b)), poses[from].0))
    };
    let last = poses.len().saturating_sub(FEWEST_POSES);
    let gains = (FEWEST_POSES..=last).filter_map(gain);
    gains.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, row)| row).filter(|row| *row != usize::MAX)
}

/// Clause on the physical causes that a law without a name may have.
pub(crate) fn may_be(candidate: &Candidate) -> &'static str {
    match candidate.free_parameters.first().map(|free| free.name) {
        Some(ODD_TWIST) => "it may be a gear or a connection that stiffens or softens as it is loaded",
        Some(EVEN_TWIST) => {
            "it may be play, a preload, a cable or a spring: the twist differs between the senses of the torque"
        }
        Some(name) if SOFTENING.contains(&name) => {
            "it may be a gear that warms up or a connection that works loose; from the first rows on, a servo that holds the \
             joint otherwise in these tests"
        }
        Some(LEAN) if candidate.at == BASE => {
            "it may be a foot, a plate or a wall that is more compliant one way than the other"
        }
        Some(LEAN) => {
            "it may be a housing, a flange or a bearing that is more compliant one way than the other"
        }
        Some(BASE_TURN) => "it may be a base that slipped on its bolts, or an instrument that was touched",
        Some(BEND) => {
            "it may be an instrument that is not straight, or a displacement too large for a straight law"
        }
        Some(MIX) => "it may be an instrument that is turned, or whose axes are not square",
        _ => "it may be an instrument whose axes have gains of their own, or are not square",
    }
}

/// Description in words of the law that the candidate stands for.
pub(crate) fn in_words(candidate: &Candidate) -> String {
    let at = &candidate.at;
    match candidate.free_parameters.first().map(|free| free.name) {
        Some(ODD_TWIST) => format!("a further twist of {at} that is odd in its torque"),
        Some(EVEN_TWIST) => format!("a further twist of {at} that is even in its torque"),
        Some(name) if name == SOFTENING[0] => {
            format!("a stiffness of {at} that changes with the order of the static tests")
        }
        Some(name) if name == SOFTENING[1] => {
            format!("a stiffness of {at} that changes with the order of the modal tests")
        }
        Some(LEAN) if at == BASE => format!("a {at} that tilts about x and y unequally"),
        Some(LEAN) => format!("a housing of {at} that tilts about two axes unequally"),
        Some(BASE_TURN) => match candidate.numbers.get(TURN_ROW) {
            Some(Stated(row)) => format!("a base that turned before row {row} of the {at} readings"),
            _ => format!("a base that turned in the course of the {at} readings"),
        },
        Some(BEND) => format!("{at} readings that bend"),
        Some(MIX) => format!("{at} readings that mix the directions"),
        _ => format!("{at} readings with a gain of their own in each direction"),
    }
}

/// Adds laws without a name to the model `from`, one after the other, as long as each raises the score by more than
/// [`LEAST_GAIN`]. The laws are the candidates of `search` from the index `first` on. `None` if no law does.
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
/// [`LEAST_GAIN`].
fn next_law<'a>(search: &Search<'a>, first: usize, from: &Scored) -> Option<(Scored, Fit<'a>)> {
    let laws = (first..search.candidates.len()).filter(|law| !from.effects.contains(law));
    let starts: Vec<(usize, &Vec<f64>)> =
        laws.flat_map(|law| search.candidates[law].starts.iter().map(move |start| (law, start))).collect();
    let tried: Vec<Scored> = starts
        .into_par_iter()
        .map(|(law, start)| {
            let effects = [from.effects.as_slice(), &[law]].concat();
            let u = [from.u.as_slice(), start].concat();
            search.scored(&effects, &search.rough(&effects, &u))
        })
        .collect();
    let promising = tried.into_iter().max_by(|a, b| a.score.total_cmp(&b.score))?;
    let fit = search.fit(&promising.effects, &promising.u, Effort::default());
    let scored = search.scored(&promising.effects, &fit);
    (scored.score > from.score + LEAST_GAIN).then_some((scored, fit))
}

/// Two laws of a joint as candidates: a further twist that is an odd function of the joint's torque, and one that is an
/// even function. `torque_nm` is the largest torque on the joint, and `twist_rad` its twist under this torque.
fn twists(joint: &str, torque_nm: f64, twist_rad: f64) -> [Candidate; 2] {
    let most = LARGEST_TWIST * twist_rad;
    let sized =
        |name| Parameter { count: 2, ..Parameter::number(name, -most, most, twist_rad, Scale::Linear) };
    // the stiffness of the joint does not change in the course of the tests
    let with = |twist: [Number; 4]| [twist.as_slice(), &[Stated(torque_nm)], &steady(), &upright()].concat();
    let odd = law(joint, sized(ODD_TWIST), 0.0);
    let even = law(joint, sized(EVEN_TWIST), 0.0);
    [
        Candidate { numbers: with([Free, Free, Stated(0.0), Stated(0.0)]), ..odd },
        Candidate { numbers: with([Stated(0.0), Stated(0.0), Free, Free]), ..even },
    ]
}

/// The laws of a channel's readings as candidates: a nonlinear characteristic, and a gain for each direction if the
/// channel has three components. `largest` is the largest reading, in its unit.
fn readings(channel: Channel, largest: f64) -> Vec<Candidate> {
    // only displacements show that the base turned or that directions mix
    let of_static = if channel == Channel::Static { [still(), square()].concat() } else { Vec::new() };
    let bend = Parameter { count: 2, ..Parameter::number(BEND, -1.0, 1.0, 0.1, Scale::Linear) };
    let bent = law(channel.word(), bend, 0.0);
    let mut out = vec![Candidate {
        numbers: [vec![Free, Free, Stated(largest)], vec![Stated(1.0); 3], of_static.clone()].concat(),
        ..bent
    }];
    if channel.components() == 3 {
        let gain = Parameter::vector(GAIN, 0.5, 2.0, 1.0).absent(Absent::AtOne);
        let gains = law(channel.word(), gain, 1.0);
        out.push(Candidate {
            numbers: [vec![Stated(0.0), Stated(0.0), Stated(1.0)], vec![Free; 3], of_static].concat(),
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
