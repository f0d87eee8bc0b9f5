//! Laws without a name as effects of a model. This file lists the candidates; [`added_laws`](super::added_laws) adds
//! them to a model.
//!
//! [`unnamed`](super::unnamed) tests with a linearized model whether a law competes with named effects. Here a law is
//! an effect of the arm, so that a corrected arm can contain it. The laws are:
//!
//! - a further twist of a joint as a polynomial of its torque;
//! - a housing or a base that tilts about two axes, with a compliance of its own for each;
//! - a joint whose stiffness changes with the order of the tests;
//! - a joint that stands at another angle than stated, or that twists under the torques of its neighbours;
//! - readings that are a nonlinear function of the true value, or that have a gain of their own in each direction;
//! - displacement readings in which each direction also shows a part of the other directions;
//! - loads that act otherwise than stated, or that move the readings wherever the tip is;
//! - a base that turned, an instrument that moved, or a payload that slipped, once in the course of the tests.

use super::event_rows;
use crate::arm::effect::channel::Channel;
use crate::arm::effect::empirical::{
    BASE_TURN, BASE_TURN_ROWS, BEND, EVEN_TWIST, FORCE_PART, GAIN, GRIP, KIND, LEAN, LOAD_PLAY,
    LOAD_PLAY_TORQUE, MIX, NEIGHBOUR_TWIST, ODD_TWIST, PAYLOAD_PULL, REMAINING, SHIFT, SLIP, SOFTENING,
    SOFTENING_REFERENCE, SOFTENING_ROWS, SWAY, ZERO,
};
use crate::arm::effect::kind::{Absent, Parameter, Scale};
use crate::arm::structure::Piece;
use crate::arm::{BASE, PAYLOAD};
use crate::reconcile::fit::descent::Fit;
use crate::reconcile::fit::weights::Weights;
use crate::reconcile::forward::prepared::Forward;
use crate::reconcile::forward::statics::LoadedBy;
use crate::reconcile::model::candidates::largest_torque_nm;
use crate::reconcile::model::parameters::Number::{Free, Stated};
use crate::reconcile::model::parameters::{Candidate, FreeParameter, LARGEST_COMPLIANCE, Number};
use std::ops::Range;

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
/// Largest error of the zero of an angle that is sought \[rad\].
const LARGEST_ZERO_RAD: f64 = 0.35;
/// Usual error of the zero of an angle \[rad\].
const USUAL_ZERO_RAD: f64 = 0.01;
/// Largest displacement of a payload's centre of gravity that is sought \[m\].
const LARGEST_SLIP_M: f64 = 1.0;
/// Usual displacement of a payload's centre of gravity \[m\].
const USUAL_SLIP_M: f64 = 0.01;

/// Indices of parameters in the list of numbers of a law of a joint.
const IN_JOINT: Joint = Joint {
    odd: 0..2,
    even: 2..4,
    torque: 4,
    softening: 5,
    lean: 10..12,
    zero: 12..13,
    neighbours: 13,
    play: 15..17,
};
/// Indices of the rows of the static and of the modal tests in the list of numbers of a slip of the payload.
const ROWS_OF_SLIP: [usize; 2] = [3, 5];
/// Places of parameters among the numbers of a law of displacements.
const IN_STATIC: Static = Static {
    bend: 0..2,
    scale: 2,
    gain: 3..6,
    turn: 6..9,
    from_row: 9,
    mix: 10,
    shift: 16..19,
    file: 19,
    force: 20,
    pull: 21,
    sway: 23..26,
    grip: 26,
    remaining: 29,
    rows: 30,
};

/// For a law of a joint: the index of each parameter in the list of the law's numbers.
struct Joint {
    odd: Range<usize>,
    even: Range<usize>,
    torque: usize,
    /// The first of five numbers: change and rows in the static tests, change and rows in the modal tests, and the part
    /// of the change that the reference has.
    softening: usize,
    lean: Range<usize>,
    zero: Range<usize>,
    /// The first of two numbers: compliance under the torque of the inboard neighbour, and of the outboard one.
    neighbours: usize,
    play: Range<usize>,
}

/// For a law of displacements: the index of each parameter in the list of the law's numbers. A law of another channel
/// has the first three parameters only.
struct Static {
    bend: Range<usize>,
    scale: usize,
    gain: Range<usize>,
    turn: Range<usize>,
    from_row: usize,
    /// The first of six numbers: for each direction, the parts of the two other directions.
    mix: usize,
    shift: Range<usize>,
    file: usize,
    force: usize,
    /// The first of two.
    pull: usize,
    sway: Range<usize>,
    /// The first of three.
    grip: usize,
    remaining: usize,
    /// In how many rows the base turns or the instrument moves.
    rows: usize,
}

/// The numbers of a law of a joint. Those with the indices `free` are fitted; the others have values at which they have
/// no effect. `torque_nm` is the largest torque on the joint.
fn of_joint(torque_nm: f64, free: impl IntoIterator<Item = usize>) -> Vec<Number> {
    let mut out = vec![Stated(0.0); IN_JOINT.play.end];
    // files do not take a torque of zero
    [IN_JOINT.torque, IN_JOINT.play.start + 1].iter().for_each(|own| out[*own] = Stated(torque_nm.max(1e-6)));
    // the numbers of rows, and the part of the change that the reference has
    [1, 3, 4].iter().for_each(|own| out[IN_JOINT.softening + own] = Stated(1.0));
    free.into_iter().for_each(|index| out[index] = Free);
    out
}

/// The numbers of a law of a channel. Those with the indices `free` are fitted; the others have values at which they
/// have no effect.
fn of_channel(channel: Channel, free: impl IntoIterator<Item = usize>) -> Vec<Number> {
    let mut out = vec![Stated(0.0); IN_STATIC.rows + 1];
    out[IN_STATIC.scale] = Stated(1.0);
    out[IN_STATIC.gain].fill(Stated(1.0));
    out[IN_STATIC.from_row] = Stated(1.0);
    free.into_iter().for_each(|index| out[index] = Free);
    // only displacements show that something moved or that directions mix
    if channel != Channel::Static {
        out.truncate(IN_STATIC.gain.end);
    }
    out
}

/// Every law at every place where the readings could show it. `baseline` is the best fit with calibration alone. Its
/// residuals show at which row the base could have turned, the instrument moved or the payload slipped.
pub(crate) fn laws(forward: &Forward, baseline: &Fit, weights: &Weights) -> Vec<Candidate> {
    let nominal = forward.coefficients(&forward.nominal);
    let torques_nm: Vec<f64> =
        forward.layout.joints.iter().map(|slot| largest_torque_nm(forward, &slot.name)).collect();
    let largest = torques_nm.iter().copied().fold(0.0, f64::max);
    let mut out = Vec::new();
    let joints = forward.layout.joints.iter().zip(&nominal.laws).zip(torques_nm);
    // a law at a joint that has the name of the base could not be written to a file, because there the name means the
    // base
    for ((slot, law), torque_nm) in joints.filter(|((slot, _), _)| slot.name != BASE) {
        out.extend(housing(forward, &slot.name, torque_nm));
        out.extend(zero(forward, &slot.name, torque_nm));
        if !law.is_rigid() && torque_nm > UNLOADED_SHARE * largest {
            out.extend(twists(&slot.name, torque_nm, law.angle_rad(torque_nm).abs()));
            out.extend(load_play(forward, &slot.name, torque_nm, law.angle_rad(torque_nm).abs()));
            out.extend((0..SOFTENING_IN.len()).filter_map(|c| softening(forward, &slot.name, torque_nm, c)));
        }
    }
    out.extend((0..forward.layout.joints.len()).filter_map(|joint| neighbours(forward, joint)));
    for channel in [Channel::Static, Channel::Modal, Channel::Windup] {
        let sizes = forward.data[forward.range(channel)].iter().map(|d| d.value.abs());
        let largest = sizes.fold(0.0, f64::max);
        if largest > 0.0 {
            out.extend(readings(forward, channel, largest));
        }
    }
    out.extend(mixing(forward));
    out.extend(loads(forward));
    out.extend(lean(forward));
    out.extend(events(forward, baseline, weights));
    out.extend([BASE_TURN, SHIFT].into_iter().filter_map(|name| moving(forward, name)));
    out
}

/// The laws of events that happened once in the course of the tests, each at the row where it explains most.
fn events(forward: &Forward, baseline: &Fit, weights: &Weights) -> Vec<Candidate> {
    let (starts, rows) = (event_rows::pose_starts(forward), event_rows::static_rows(forward));
    let turn = event_rows::of_turn(forward, baseline, weights, &starts);
    let shift = event_rows::of_shift(forward, baseline, weights, &rows);
    let turn = turn.map(|row| moved_once(forward, row, BASE_TURN));
    let shift = shift.map(|row| moved_once(forward, row, SHIFT));
    let slip = slip(forward, event_rows::of_slip(forward, baseline, weights));
    turn.into_iter().chain(shift).chain(slip).collect()
}

/// The candidate for a joint angle whose zero is off. `None` for a passive joint.
fn zero(forward: &Forward, joint: &str, torque_nm: f64) -> Option<Candidate> {
    let is_driven = forward.nominal.structure.joints().any(|j| j.name == joint && j.is_driven());
    let angle = Parameter::number(ZERO, -LARGEST_ZERO_RAD, LARGEST_ZERO_RAD, USUAL_ZERO_RAD, Scale::Linear);
    let numbers = of_joint(torque_nm, IN_JOINT.zero);
    is_driven.then(|| Candidate { numbers, ..law(joint, angle, 0.0) })
}

/// The candidate for a joint that also twists under the torques of its neighbours in the static tests. The usual size
/// is the largest compliance of the joint and its neighbours. `None` if all of these are rigid, if the joint has the
/// name of the base, or if there are no displacements.
fn neighbours(forward: &Forward, joint: usize) -> Option<Candidate> {
    let (joints, laws) = (&forward.layout.joints, forward.coefficients(&forward.nominal).laws);
    let sides = [joint.checked_sub(1), (joint + 1 < joints.len()).then_some(joint + 1)];
    let near = sides.iter().flatten().chain([&joint]);
    let compliances = near.map(|j| laws[*j].tangent_compliance_rad_per_nm(0.0));
    let usual = compliances.fold(0.0, f64::max);
    let name = &joints[joint].name;
    if usual == 0.0 || name == BASE || forward.range(Channel::Static).is_empty() {
        return None;
    }
    let most = LARGEST_TWIST * usual;
    let twist =
        Parameter { count: 2, ..Parameter::number(NEIGHBOUR_TWIST, -most, most, usual, Scale::Linear) };
    let mut candidate = law(name, twist, 0.0);
    candidate.free_parameters.retain(|free| sides[free.component].is_some());
    candidate.starts = vec![candidate.free_parameters.iter().map(|free| free.u(0.0)).collect()];
    let free = candidate.free_parameters.iter().map(|free| IN_JOINT.neighbours + free.component);
    let torque_nm = largest_torque_nm(forward, name);
    candidate.numbers = of_joint(torque_nm, free);
    (!candidate.free_parameters.is_empty()).then_some(candidate)
}

/// The candidate for play of a joint that can close in both directions from the unloaded arm. `torque_nm` is the
/// largest torque on the joint, and `twist_rad` its twist under this torque. `None` if there are no displacements.
fn load_play(forward: &Forward, joint: &str, torque_nm: f64, twist_rad: f64) -> Option<Candidate> {
    let most = LARGEST_TWIST * twist_rad;
    let size = Parameter::number(LOAD_PLAY, -most, most, twist_rad, Scale::Linear);
    let pace = Parameter::number(LOAD_PLAY_TORQUE, 1e-9, 1e9, torque_nm, Scale::Log);
    let [low, high] = [1e-3, 1.0].map(|part| libm::log(part * torque_nm));
    let free_parameters =
        vec![FreeParameter::new(&size, 0, 1.0), FreeParameter::new(&pace, 0, 1.0).within(low, high)];
    let starts = [0.02, 0.2].map(|part| vec![0.1, libm::log(part * torque_nm)]).to_vec();
    let numbers = of_joint(torque_nm, IN_JOINT.play);
    let candidate =
        Candidate { kind: &KIND, at: joint.into(), free_parameters, numbers, starts, twins: Vec::new() };
    (!forward.range(Channel::Static).is_empty()).then_some(candidate)
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
    let first = IN_JOINT.softening + 2 * channel;
    let mut numbers = of_joint(torque_nm, [first, first + 1]);
    let paces = SOFTENED_AFTER.map(|part| libm::log((part * rows).max(1.0)));
    let mut starts = paces.map(|pace| vec![1.0, pace]).to_vec();
    if SOFTENING_IN[channel] == Channel::Static {
        let reference =
            Parameter::number(SOFTENING_REFERENCE, 0.0, 1.0, 1.0, Scale::Linear).absent(Absent::Never);
        free_parameters.push(FreeParameter::new(&reference, 0, 1.0));
        numbers[IN_JOINT.softening + 4] = Free;
        starts = starts
            .iter()
            .flat_map(|start| [0.1, 0.9].map(|part| [start.as_slice(), &[part]].concat()))
            .collect();
    }
    Some(Candidate { kind: &KIND, at: joint.into(), free_parameters, numbers, starts, twins: Vec::new() })
}

/// The candidate for displacement readings in which each direction also shows a part of the other directions. `None` if
/// there are no displacements.
fn mixing(forward: &Forward) -> Option<Candidate> {
    let statics = &forward.data[forward.range(Channel::Static)];
    let is_measured = measured(forward);
    let part = Parameter { count: 6, ..Parameter::number(MIX, -0.5, 0.5, 0.05, Scale::Linear) };
    let of_component = [0, 0, 1, 1, 2, 2].map(|component| is_measured[component]);
    let candidate = of_displacements(part, 0.0, IN_STATIC.mix, &of_component);
    (!statics.is_empty()).then_some(candidate)
}

/// The candidates for loads that act otherwise than stated, or that move the readings wherever the tip is: forces that are
/// larger than stated, payloads that do not pull straight down, a base or an instrument that shifts under the load.
fn loads(forward: &Forward) -> Vec<Candidate> {
    let statics = &forward.data[forward.range(Channel::Static)];
    let largest_mm = statics.iter().map(|datum| datum.value.abs()).fold(0.0, f64::max);
    let nominal = forward.coefficients(&forward.nominal);
    let forces = forward.statics.iter().map(|pose| pose.largest_force_n(&forward.layout, &nominal));
    let largest_n = forces.fold(0.0, f64::max);
    let loaded =
        |by: fn(LoadedBy) -> bool| forward.statics.iter().flat_map(|p| p.loaded_by()).any(|(_, l)| by(l));
    let [payload, force] = [loaded(|by| by.payload), loaded(|by| by.force)];
    let mut out = Vec::new();
    // forces alone that are all larger are a gain of the readings
    if payload && force {
        let part = Parameter::number(FORCE_PART, -0.5, 1.0, 0.05, Scale::Linear);
        out.push(of_displacements(part, 0.0, IN_STATIC.force, &[true]));
    }
    if payload {
        let pull = Parameter { count: 2, ..Parameter::number(PAYLOAD_PULL, -0.3, 0.3, 0.02, Scale::Linear) };
        out.push(of_displacements(pull, 0.0, IN_STATIC.pull, &[true; 2]));
        let (usual, most) = (0.05 * largest_n, 2.0 * largest_n);
        let grip = Parameter { count: 3, ..Parameter::number(GRIP, -most, most, usual, Scale::Linear) };
        out.push(of_displacements(grip, 0.0, IN_STATIC.grip, &[true; 3]));
    }
    if forward.statics.iter().any(|pose| pose.count() > 1) {
        let part = Parameter::number(REMAINING, -0.9, 0.9, 0.1, Scale::Linear);
        out.push(of_displacements(part, 0.0, IN_STATIC.remaining, &[true]));
    }
    if largest_n > 0.0 {
        let (usual, most) = (0.1 * largest_mm / largest_n, 10.0 * largest_mm / largest_n);
        let sway = Parameter { count: 3, ..Parameter::number(SWAY, -most, most, usual, Scale::Linear) };
        out.push(of_displacements(sway, 0.0, IN_STATIC.sway.start, &measured(forward)));
    }
    out
}

/// For each direction of the displacements, whether it was measured.
fn measured(forward: &Forward) -> [bool; 3] {
    let statics = &forward.data[forward.range(Channel::Static)];
    [0, 1, 2].map(|component| statics.iter().any(|datum| datum.component == component))
}

/// The candidate for a law of the displacements with those components of the vector `parameter` that `is_seen` tells. The
/// others are `absent`, with which the law changes nothing. `first` is the place of the vector among the numbers of the law.
fn of_displacements(parameter: Parameter, absent: f64, first: usize, is_seen: &[bool]) -> Candidate {
    let mut candidate = law(Channel::Static.word(), parameter, absent);
    candidate.free_parameters.retain(|free| is_seen[free.component]);
    candidate.starts = vec![candidate.free_parameters.iter().map(|free| free.u(absent)).collect()];
    let free = candidate.free_parameters.iter().map(|free| first + free.component);
    candidate.numbers = of_channel(Channel::Static, free);
    candidate
}

/// The candidate for a base that tilts about world x and about world y with a compliance of its own for each. `None` if
/// no joint is compliant, or if a piece of the arm has the name of the base.
fn lean(forward: &Forward) -> Option<Candidate> {
    let is_free = forward.nominal.structure.pieces.iter().all(|piece| piece.name() != BASE);
    leaning(forward, BASE, vec![Free; 2]).filter(|_| is_free)
}

/// The candidate for the housing of a joint that tilts about two axes with a compliance of its own for each. `None` if
/// no joint is compliant. `None` also for a vertical joint that stands on the base, because [`lean`] then describes the
/// same tilts.
fn housing(forward: &Forward, joint: &str, torque_nm: f64) -> Option<Candidate> {
    let turns_on_the_base = forward.nominal.structure.pieces.first().is_some_and(|piece| match piece {
        Piece::Joint(first) => first.name == joint && first.axis.z.abs() > 1.0 - 1e-12,
        _ => false,
    });
    leaning(forward, joint, of_joint(torque_nm, IN_JOINT.lean)).filter(|_| !turns_on_the_base)
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

/// The candidate for a base that turned ([`BASE_TURN`]) or an instrument that moved ([`SHIFT`]) just before the row
/// `from_row` of the displacements, counted from 0.
fn moved_once(forward: &Forward, from_row: usize, name: &'static str) -> Candidate {
    let is_turn = name == BASE_TURN;
    let largest_mm =
        forward.data[forward.range(Channel::Static)].iter().map(|d| d.value.abs()).fold(0.0, f64::max);
    let (most, usual) = if is_turn { (0.1, 1e-4) } else { (10.0 * largest_mm, 0.1 * largest_mm) };
    let moved = Parameter { count: 3, ..Parameter::number(name, -most, most, usual, Scale::Linear) };
    let is_measured = measured(forward);
    // a turn about an axis moves nothing along this axis
    let is_seen = [0, 1, 2].map(|k| match is_turn {
        true => is_measured[(k + 1) % 3] || is_measured[(k + 2) % 3],
        false => is_measured[k],
    });
    let first = if is_turn { IN_STATIC.turn.start } else { IN_STATIC.shift.start };
    let mut candidate = of_displacements(moved, 0.0, first, &is_seen);
    candidate.numbers[IN_STATIC.from_row] = Stated((from_row + 1) as f64);
    candidate.numbers[IN_STATIC.file] = Stated(forward.files[0] as f64);
    candidate
}

/// The candidate for a base that turns ([`BASE_TURN`]) or an instrument that moves ([`SHIFT`]) more and more in the course of
/// the static tests. As with a joint that softens, it begins anew in another file.
fn moving(forward: &Forward, name: &'static str) -> Option<Candidate> {
    let rows = forward.data[forward.range(Channel::Static)].iter().map(|datum| datum.row + 1).max()? as f64;
    let mut candidate = moved_once(forward, 0, name);
    let pace = Parameter::number(BASE_TURN_ROWS, 0.1, 1e6, rows, Scale::Log);
    let sizes = candidate.free_parameters.len();
    candidate
        .free_parameters
        .push(FreeParameter::new(&pace, 0, 1.0).within(libm::log(0.1), libm::log(3.0 * rows)));
    candidate.numbers[IN_STATIC.file] = Stated(0.0);
    candidate.numbers[IN_STATIC.rows] = Free;
    let paces = [SOFTENED_AFTER[0], SOFTENED_AFTER[1], 2.0].map(|part| libm::log((part * rows).max(1.0)));
    candidate.starts = paces.map(|pace| [vec![0.1; sizes], vec![pace]].concat()).to_vec();
    (sizes > 0).then_some(candidate)
}

/// The candidate for a payload that slipped just before the `rows` of the static and of the modal tests, counted from
/// 0; A row is `None` if the payload did not slip in these tests. The result is `None` if the payload did not slip in
/// the static tests, if there is no payload, or if a joint has the name of the payload.
fn slip(forward: &Forward, rows: [Option<usize>; 2]) -> Option<Candidate> {
    let is_free = forward.nominal.structure.joints().all(|joint| joint.name != PAYLOAD);
    let offset = Parameter {
        count: 3,
        ..Parameter::number(SLIP, -LARGEST_SLIP_M, LARGEST_SLIP_M, USUAL_SLIP_M, Scale::Linear)
    };
    let event = |(row, file): (Option<usize>, usize)| match row {
        Some(row) => [Stated((row + 1) as f64), Stated(file as f64)],
        None => [Stated(0.0); 2],
    };
    let events = rows.into_iter().zip(forward.files).flat_map(event);
    let numbers = [Free; 3].into_iter().chain(events).collect();
    let is_seen = rows[0].is_some() && forward.largest_payload_kg > 0.0;
    (is_free && is_seen).then(|| Candidate { numbers, ..law(PAYLOAD, offset, 0.0) })
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
        Some(BASE_TURN | SHIFT) if is_gradual(candidate) => {
            "it may be ground, a stand or a link that warms up or settles while the tests are made"
        }
        Some(BASE_TURN) => "it may be a base that slipped on its bolts, or an instrument that was touched",
        Some(SHIFT) => "it may be an instrument or its stand that was touched",
        Some(SLIP) => "it may be a payload that slipped in its clamp, or that was mounted anew",
        Some(ZERO) => {
            "it may be an encoder whose zero was set elsewhere, or a joint that was mounted turned; of a first joint that is \
             vertical, also an instrument that is turned about it"
        }
        Some(LOAD_PLAY) => {
            "it may be play that the unloaded arm leaves open to both sides, or a servo that holds the joint only within a band"
        }
        Some(NEIGHBOUR_TWIST) => {
            "it may be a housing or a belt that both joints load, or a servo that gives way to its neighbour"
        }
        Some(BEND) => {
            "it may be an instrument that is not straight, or a displacement too large for a straight law"
        }
        Some(MIX) => "it may be an instrument that is turned, or whose axes are not square",
        Some(FORCE_PART) => "it may be a force gauge that reads wrong, or the friction of a pulley",
        Some(PAYLOAD_PULL) => "it may be an arm that is out of level",
        Some(GRIP) => "it may be a hose or a cable that pulls wherever the gripper holds something",
        Some(REMAINING) => {
            "it may be friction, play or a gauge that sticks: a part of the deflection before remains"
        }
        Some(SWAY) => "it may be a base or a stand that shifts under the load, or a floor that both stand on",
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
        Some(BASE_TURN) if is_gradual(candidate) => {
            format!("a base that turns in the course of the {at} readings")
        }
        Some(SHIFT) if is_gradual(candidate) => {
            format!("an instrument that moves in the course of the {at} readings")
        }
        Some(BASE_TURN) => {
            format!(
                "a base that turned before row {} of the {at} readings",
                stated(candidate, IN_STATIC.from_row)
            )
        }
        Some(SHIFT) => {
            format!(
                "an instrument that moved before row {} of the {at} readings",
                stated(candidate, IN_STATIC.from_row)
            )
        }
        Some(SLIP) => slip_in_words(candidate),
        Some(ZERO) => format!("an angle of {at} whose zero is off"),
        Some(LOAD_PLAY) => format!("a play of {at} that opens from the unloaded arm to both sides"),
        Some(NEIGHBOUR_TWIST) => format!("a twist of {at} under the torques of its neighbours"),
        Some(BEND) => format!("{at} readings that bend"),
        Some(MIX) => format!("{at} readings that mix the directions"),
        Some(FORCE_PART) => "tip forces that are a factor of what is stated".into(),
        Some(PAYLOAD_PULL) => "payloads that do not pull straight down".into(),
        Some(GRIP) => "a force on the tip, in the last frame, wherever there is a payload".into(),
        Some(REMAINING) => format!("{at} readings that keep a part of the deflection before"),
        Some(SWAY) => format!("{at} readings that follow the load wherever the tip is"),
        _ => format!("{at} readings with a gain of their own in each direction"),
    }
}

/// Whether what moved came more and more and not at once.
fn is_gradual(candidate: &Candidate) -> bool {
    candidate.free_parameters.iter().any(|free| free.name == BASE_TURN_ROWS)
}

/// The number with the index `index` of a candidate; 0 if it is fitted.
fn stated(candidate: &Candidate, index: usize) -> f64 {
    match candidate.numbers.get(index) {
        Some(Stated(number)) => *number,
        _ => 0.0,
    }
}

fn slip_in_words(candidate: &Candidate) -> String {
    let [statics, modal] = ROWS_OF_SLIP.map(|index| stated(candidate, index));
    let place = match modal {
        0.0 => format!("row {statics} of the static readings"),
        1.0 => format!("row {statics} of the static readings, and before the modal readings"),
        _ => format!("row {statics} of the static and row {modal} of the modal readings"),
    };
    format!("a payload whose centre of gravity moved before {place}")
}

/// Two laws of a joint as candidates: a further twist that is an odd function of the joint's torque, and one that is an
/// even function. `torque_nm` is the largest torque on the joint, and `twist_rad` its twist under this torque.
fn twists(joint: &str, torque_nm: f64, twist_rad: f64) -> [Candidate; 2] {
    let most = LARGEST_TWIST * twist_rad;
    let sized =
        |name| Parameter { count: 2, ..Parameter::number(name, -most, most, twist_rad, Scale::Linear) };
    let odd = law(joint, sized(ODD_TWIST), 0.0);
    let even = law(joint, sized(EVEN_TWIST), 0.0);
    [
        Candidate { numbers: of_joint(torque_nm, IN_JOINT.odd), ..odd },
        Candidate { numbers: of_joint(torque_nm, IN_JOINT.even), ..even },
    ]
}

/// The laws of a channel's readings as candidates: a nonlinear characteristic, and a gain for each direction if the
/// channel has three components. `largest` is the largest reading, in its unit.
fn readings(forward: &Forward, channel: Channel, largest: f64) -> Vec<Candidate> {
    let bend = Parameter { count: 2, ..Parameter::number(BEND, -1.0, 1.0, 0.1, Scale::Linear) };
    let bent = law(channel.word(), bend, 0.0);
    let mut numbers = of_channel(channel, IN_STATIC.bend);
    numbers[IN_STATIC.scale] = Stated(largest);
    let mut out = vec![Candidate { numbers, ..bent }];
    if channel.components() == 3 {
        let gain = Parameter::vector(GAIN, 0.5, 2.0, 1.0).absent(Absent::AtOne);
        out.push(of_displacements(gain, 1.0, IN_STATIC.gain.start, &measured(forward)));
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
