//! `empirical`: a law without a name, as it was found in readings.
//!
//! - At a joint it is one of six laws: a further twist that is a polynomial of the torque; a tilt of the housing that
//!   differs about two axes; a compliance that changes in the course of the tests; a twist under the torques of its
//!   neighbours; play that opens from the unloaded arm; an angle whose zero is off.
//! - At the base it is a tilt that differs about x and y.
//! - At the payload it is a centre of gravity that moved once between two rows.
//! - At a channel it is one of eleven laws: a nonlinearity; a gain for each direction; a rotation of the base or a motion of
//!   the instrument between two rows; axes that each show a part of the other directions; forces that are larger than stated;
//!   payloads that do not pull straight down; displacements that follow the load wherever the tip is; a force of the gripper
//!   wherever there is a payload; displacements that remain; a base or an instrument that moves more and more.

use super::channel::Channel;
use super::kind::{Kind, Parameter, Place, Scale, Scope, Traits};
use super::setup::{Event, LoadTwist, Slipped, Turned};
use super::subject::Subject;
use super::warming::Softening;
use crate::arm::joint_law::FurtherTwist;
use nalgebra::{Matrix3, Vector3};

/// Name of the parameter with the coefficients of a joint's further angle of torsion, for the terms that change sign
/// with the torque.
pub(crate) const ODD_TWIST: &str = "odd_twist_rad";
/// Name of the parameter with the coefficients of a joint's further angle of torsion, for the terms that do not change
/// sign with the torque.
pub(crate) const EVEN_TWIST: &str = "even_twist_rad";
/// Name of the parameter with the reference torque of the coefficients [`ODD_TWIST`] and [`EVEN_TWIST`]. At this torque
/// the further angle is the sum of all coefficients.
pub(crate) const TORQUE: &str = "torque_nm";
/// Names of the parameters with the change of a joint's compliance: in the course of the static tests, and in the
/// course of the modal tests.
pub(crate) const SOFTENING: [&str; 2] = ["static_softening", "modal_softening"];
/// Names of the parameters with the number of rows after which 63 % of each change in [`SOFTENING`] is reached.
pub(crate) const SOFTENING_ROWS: [&str; 2] = ["static_softening_rows", "modal_softening_rows"];
/// Name of the parameter with the fraction of the change in the static tests that is already present when the reference
/// of a displacement is read.
pub(crate) const SOFTENING_REFERENCE: &str = "static_softening_reference";
/// Name of the parameter with the two coefficients of the nonlinearity of readings.
pub(crate) const BEND: &str = "bend";
/// Name of the parameter with the reading at which the coefficients [`BEND`] are the relative deviation from a straight
/// line.
pub(crate) const BEND_SCALE: &str = "bend_scale";
/// Name of the parameter with a factor on the reading for each direction.
pub(crate) const GAIN: &str = "gain";
/// Name of the parameter with the further tilt per moment: of the base about world x and about world y, or of a joint
/// about two axes of its housing.
pub(crate) const LEAN: &str = "tilt_rad_per_nm";
/// Name of the parameter with the rotation by which the base turned once between two rows.
pub(crate) const BASE_TURN: &str = "base_turn_rad";
/// Name of the parameter with the first row after the base turned, counted from 1.
pub(crate) const BASE_TURN_ROW: &str = "base_turn_from_row";

/// Name of the parameter with the parts of the other directions that the reading in each direction shows: of y and z in
/// x, of x and z in y, of x and y in z.
pub(crate) const MIX: &str = "mix";

/// Name of the parameter with the true angle of a joint minus the stated one, in every static and modal test.
pub(crate) const ZERO: &str = "zero_rad";
/// Name of the parameter with the twist of a joint per torque of the next joint inboard, and per torque of the next joint
/// outboard, in static tests.
pub(crate) const NEIGHBOUR_TWIST: &str = "neighbour_twist_rad_per_nm";
/// Name of the parameter with the further twist of a joint under a large torque of the load, in static tests.
pub(crate) const LOAD_PLAY: &str = "load_play_rad";
/// Name of the parameter with the torque of the load at which 76 % of [`LOAD_PLAY`] is reached.
pub(crate) const LOAD_PLAY_TORQUE: &str = "load_play_nm";
/// Name of the parameter with the part of a stated force on the tip by which the force is larger.
pub(crate) const FORCE_PART: &str = "force_part";
/// Name of the parameter with the horizontal pull of a payload along world x and y, as a part of its weight.
pub(crate) const PAYLOAD_PULL: &str = "payload_pull";
/// Name of the parameter with the displacement in each direction per force of the load in this direction.
pub(crate) const SWAY: &str = "sway_mm_per_n";
/// Name of the parameter with the force on the tip in every load case with a payload, in the last frame.
pub(crate) const GRIP: &str = "grip_n";
/// Name of the parameter with the part of the displacement of the load before, in the same pose, that remains.
pub(crate) const REMAINING: &str = "remaining_part";
/// Name of the parameter with the number of rows in which 63 % of a turn of the base or a motion of the instrument came.
pub(crate) const BASE_TURN_ROWS: &str = "base_turn_rows";
/// Name of the parameter with the displacement by which the instrument moved once between two rows.
pub(crate) const SHIFT: &str = "shift_mm";
/// Name of the parameter with the mark of the file in which the base turned or the instrument moved.
pub(crate) const BASE_TURN_FILE: &str = "base_turn_file";
/// Name of the parameter with the displacement of a payload's centre of gravity between two rows, in the last frame.
pub(crate) const SLIP: &str = "slip_m";
/// Names of the parameters with the first row after a payload slipped, counted from 1: in the static tests, and in the
/// modal tests; 0 if it did not slip in these tests.
pub(crate) const SLIP_ROW: [&str; 2] = ["static_slip_from_row", "modal_slip_from_row"];
/// Names of the parameters with the marks of the files in which the payload slipped.
pub(crate) const SLIP_FILE: [&str; 2] = ["static_slip_file", "modal_slip_file"];

const OF_JOINT: &[Parameter] = &[
    optional(ODD_TWIST, 2, -0.1, 0.1, 0.0),
    optional(EVEN_TWIST, 2, -0.1, 0.1, 0.0),
    optional(TORQUE, 1, 1e-6, 1e9, 1.0),
    optional(SOFTENING[0], 1, -0.9, 10.0, 0.0),
    optional(SOFTENING_ROWS[0], 1, 0.1, 1e6, 1.0),
    optional(SOFTENING[1], 1, -0.9, 10.0, 0.0),
    optional(SOFTENING_ROWS[1], 1, 0.1, 1e6, 1.0),
    optional(SOFTENING_REFERENCE, 1, 0.0, 1.0, 1.0),
    optional(LEAN, 2, 0.0, 1.0, 0.0),
    optional(ZERO, 1, -0.5, 0.5, 0.0),
    optional(NEIGHBOUR_TWIST, 2, -1.0, 1.0, 0.0),
    optional(LOAD_PLAY, 1, -0.1, 0.1, 0.0),
    optional(LOAD_PLAY_TORQUE, 1, 1e-9, 1e9, 1.0),
];

const OF_CHANNEL: &[Parameter] = &[
    optional(BEND, 2, -10.0, 10.0, 0.0),
    optional(BEND_SCALE, 1, 1e-9, 1e9, 1.0),
    optional(GAIN, 3, 0.01, 100.0, 1.0),
];

const OF_BASE: &[Parameter] = &[optional(LEAN, 2, 0.0, 1.0, 0.0)];

const OF_PAYLOAD: &[Parameter] = &[
    optional(SLIP, 3, -10.0, 10.0, 0.0),
    optional(SLIP_ROW[0], 1, 0.0, 1e9, 0.0),
    optional(SLIP_FILE[0], 1, 0.0, 1e9, 0.0),
    optional(SLIP_ROW[1], 1, 0.0, 1e9, 0.0),
    optional(SLIP_FILE[1], 1, 0.0, 1e9, 0.0),
];

const OF_STATIC: &[Parameter] = &[
    OF_CHANNEL[0],
    OF_CHANNEL[1],
    OF_CHANNEL[2],
    optional(BASE_TURN, 3, -0.1, 0.1, 0.0),
    optional(BASE_TURN_ROW, 1, 1.0, 1e9, 1.0),
    optional(MIX, 6, -2.0, 2.0, 0.0),
    optional(SHIFT, 3, -1e4, 1e4, 0.0),
    optional(BASE_TURN_FILE, 1, 0.0, 1e9, 0.0),
    optional(FORCE_PART, 1, -0.9, 10.0, 0.0),
    optional(PAYLOAD_PULL, 2, -1.0, 1.0, 0.0),
    optional(SWAY, 3, -1e4, 1e4, 0.0),
    optional(GRIP, 3, -1e6, 1e6, 0.0),
    optional(REMAINING, 1, -1.0, 1.0, 0.0),
    optional(BASE_TURN_ROWS, 1, 0.0, 1e6, 0.0),
];

/// A parameter of `count` numbers that a file may leave out. Each number is then `default`, with which the effect
/// changes nothing.
const fn optional(name: &'static str, count: usize, low: f64, high: f64, default: f64) -> Parameter {
    let number = Parameter::number(name, low, high, default, Scale::Linear);
    Parameter { count, default: Some(default), ..number }
}

/// Entry of this effect in the list of all effects: its name, places, parameters, and how it changes an arm.
pub(crate) const KIND: Kind = Kind {
    name: "empirical",
    summary: "a law without a name, as found in readings: a further twist of a joint, a reading that bends, or something that moved in the tests",
    scope: Scope::Product,
    places: &[
        Place::Joint,
        Place::Base,
        Place::Payload,
        Place::Channel(Channel::Static),
        Place::Channel(Channel::Modal),
        Place::Channel(Channel::Windup),
    ],
    parameters: |place| match place {
        Place::Joint => OF_JOINT,
        Place::Base => OF_BASE,
        Place::Payload => OF_PAYLOAD,
        Place::Channel(Channel::Static) => OF_STATIC,
        _ => OF_CHANNEL,
    },
    apply,
    traits: Traits { is_sought: false, in_bounds: false, ..Traits::USUAL },
};

/// Whether a law of a joint or of the base with these parameters describes the tests and not the product. It does if it
/// has neither a further twist nor a further tilt.
pub(crate) fn is_of_tests_alone(parameters: &[(String, Vec<f64>)]) -> bool {
    let is_twist = |(name, numbers): &(String, Vec<f64>)| {
        [ODD_TWIST, EVEN_TWIST, LEAN].contains(&name.as_str()) && numbers.iter().any(|x| *x != 0.0)
    };
    !parameters.iter().any(is_twist)
}

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    match *numbers {
        [about_x, about_y] => {
            subject.structure.base_frame.0 += Matrix3::from_diagonal(&Vector3::new(about_x, about_y, 0.0));
        }
        [x, y, z, ref events @ ..] if events.len() == 4 => slip(Vector3::new(x, y, z), events, subject),
        _ if subject.structure.joint_mut(at).is_some() => apply_to_joint(numbers, at, subject),
        _ => apply_to_channel(numbers, at, subject),
    }
}

/// Moves the payload's centre of gravity by `offset_m`. The four numbers are row and mark of the file of the static tests,
/// and row and mark of the file of the modal tests.
fn slip(offset_m: Vector3<f64>, events: &[f64], subject: &mut Subject) {
    for (channel, own) in [Channel::Static, Channel::Modal].into_iter().zip(events.chunks_exact(2)) {
        let event = Event::of_file(own[0], own[1]);
        let slipped = event.map(|event| Slipped { offset_m, event });
        subject.setups[channel as usize].slipped.extend(slipped);
    }
}

fn apply_to_joint(numbers: &[f64], at: &str, subject: &mut Subject) {
    let [a, b, c, d, torque_nm, ref softening @ .., first, second, zero_rad, x, y, play_rad, play_nm] =
        *numbers
    else {
        return;
    };
    if let Some(joint) = subject.structure.joint_mut(at) {
        joint.lean_rad_per_nm = [joint.lean_rad_per_nm[0] + first, joint.lean_rad_per_nm[1] + second];
        if [a, b, c, d] != [0.0; 4] {
            let twist = FurtherTwist { odd_rad: [a, b], even_rad: [c, d], torque_nm };
            joint.law.further = Some(added(joint.law.further, twist));
        }
    }
    soften(softening, at, subject);
    if zero_rad != 0.0 {
        subject.zeros_rad.push((at.into(), zero_rad));
    }
    if [x, y, play_rad] != [0.0; 3] {
        let twist = LoadTwist { neighbours_rad_per_nm: [x, y], play_rad, play_nm };
        subject.setups[Channel::Static as usize].load_twists.push((at.into(), twist));
    }
}

fn apply_to_channel(numbers: &[f64], at: &str, subject: &mut Subject) {
    let Some(reading) = subject.channel_mut(at) else { return };
    let [a, b, bend_scale, x, y, z, ref of_static @ ..] = numbers[..] else { return };
    // a channel may have two laws, one with a nonlinearity and one with gains, and both act; so a law without a
    // nonlinearity must not erase the nonlinearity of the other law
    if [a, b] != [0.0; 2] {
        (reading.bend, reading.bend_scale) = ([a, b], bend_scale);
    }
    reading.gain.iter_mut().zip([x, y, z]).for_each(|(own, gain)| *own *= gain);
    let [x, y, z, from_row, xy, xz, yx, yz, zx, zy, dx, dy, dz, file, ref loads @ ..] = of_static[..] else {
        return;
    };
    reading.mix += Matrix3::new(0.0, xy, xz, yx, 0.0, yz, zx, zy, 0.0);
    let (turn_rad, shift_m) = (Vector3::new(x, y, z), Vector3::new(dx, dy, dz) / 1e3);
    let happened = (turn_rad, shift_m) != (Vector3::zeros(), Vector3::zeros());
    let event = Event::of_file(from_row.max(1.0), file).filter(|_| happened);
    let [force_part, along_x, along_y, sx, sy, sz, gx, gy, gz, remaining, rows] = loads[..] else { return };
    let Some(setup) = subject.setup_mut(at) else { return };
    setup.turned.extend(event.map(|event| Turned { turn_rad, shift_m, event, rows }));
    let loading = &mut setup.loading;
    loading.force_part += force_part;
    loading.payload_pull = [loading.payload_pull[0] + along_x, loading.payload_pull[1] + along_y];
    loading.sway_m_per_n += Vector3::new(sx, sy, sz) / 1e3;
    loading.grip_n += Vector3::new(gx, gy, gz);
    loading.remaining += remaining;
}

/// Makes the compliance of the joint `at` change in the course of the static and of the modal tests. The five
/// `numbers` are change and number of rows for the static tests, change and number of rows for the modal tests, and the
/// part of the static change that is present when references are read.
fn soften(numbers: &[f64], at: &str, subject: &mut Subject) {
    let [static_change, static_rows, modal_change, modal_rows, reference] = *numbers else { return };
    for (channel, change, rows) in
        [(Channel::Static, static_change, static_rows), (Channel::Modal, modal_change, modal_rows)]
    {
        if change != 0.0 {
            let own = &mut subject.setups[channel as usize].softening;
            // a joint has at most one law of change with the order of the tests, so a later law replaces an earlier one
            own.retain(|(joint, _)| joint != at);
            own.push((at.into(), Softening { change, rows, reference }));
        }
    }
}

/// The sum of the further angle of torsion `before`, if there is one, and `twist`. The result has the larger of both
/// reference torques, beyond which it is continued as a straight line.
fn added(before: Option<FurtherTwist>, twist: FurtherTwist) -> FurtherTwist {
    let Some(mut before) = before else { return twist };
    let mut twist = twist;
    if before.torque_nm > twist.torque_nm {
        std::mem::swap(&mut before, &mut twist);
    }
    let ratio = twist.torque_nm / before.torque_nm;
    let sum = |own: [f64; 2], other: [f64; 2], powers: [i32; 2]| {
        [own[0] + other[0] * ratio.powi(powers[0]), own[1] + other[1] * ratio.powi(powers[1])]
    };
    FurtherTwist {
        odd_rad: sum(twist.odd_rad, before.odd_rad, [2, 3]),
        even_rad: sum(twist.even_rad, before.even_rad, [1, 2]),
        torque_nm: twist.torque_nm,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers of a law of a joint: a further twist, and a tilt of the housing. All others change nothing.
    fn of_joint(twist: [f64; 5], lean: [f64; 2]) -> Vec<f64> {
        let [softening, further] = [[0.0, 1.0, 0.0, 1.0, 1.0], [0.0, 0.0, 0.0, 0.0, 1.0]];
        let out = [&twist[..], &softening, &lean, &further].concat();
        assert_eq!(out.len(), OF_JOINT.iter().map(|parameter| parameter.count).sum::<usize>());
        out
    }

    #[test]
    fn two_laws_of_one_joint_add_up_whatever_their_torques() {
        let mut subject = super::super::validate::testing::two_link_subject();
        let twist = |odd_rad, even_rad, torque_nm| FurtherTwist { odd_rad, even_rad, torque_nm };
        let (first, second) =
            (twist([1e-4, -2e-5], [3e-5, 1e-5], 20.0), twist([0.0, 4e-5], [0.0, 2e-5], 50.0));
        apply(&of_joint([1e-4, -2e-5, 3e-5, 1e-5, 20.0], [0.0; 2]), "j1", &mut subject);
        apply(&of_joint([0.0, 4e-5, 0.0, 2e-5, 50.0], [0.0; 2]), "j1", &mut subject);
        let law = subject.structure.joint_mut("j1").expect("j1").law;
        for torque_nm in [-20.0, -10.0, 5.0, 15.0] {
            let sum = first.angle_rad(torque_nm) + second.angle_rad(torque_nm);
            assert!((law.angle_rad(torque_nm) - torque_nm / 1e5 - sum).abs() < 1e-15, "{torque_nm}");
        }
    }

    #[test]
    fn a_law_is_of_the_tests_alone_unless_something_twists_or_tilts_further() {
        let with = |name: &str, numbers: &[f64]| vec![(name.to_owned(), numbers.to_vec())];
        assert!(is_of_tests_alone(&with(SOFTENING[0], &[0.1])));
        assert!(is_of_tests_alone(&with(LEAN, &[0.0, 0.0])));
        assert!(!is_of_tests_alone(&with(LEAN, &[1e-6, 0.0])));
        assert!(!is_of_tests_alone(&with(ODD_TWIST, &[0.0, 1e-5])));
    }

    #[test]
    fn a_housing_tilts_about_axes_that_turn_with_what_carries_it() {
        use crate::arm::LinkModel;
        use crate::arm::load::Payload;
        use std::f64::consts::FRAC_PI_2;
        let share_of = |lean: [f64; 2]| {
            let mut subject = super::super::validate::testing::two_link_subject();
            apply(&of_joint([0.0, 0.0, 0.0, 0.0, 1.0], lean), "j2", &mut subject);
            subject.structure.gravity_m_s2 = 0.0;
            let chain = crate::mechanics::chain::Chain::new(&subject.structure, LinkModel::Rigid);
            // j1 has turned the upper arm into the direction of world y; the forearm hangs down from j2
            let force_n = Vector3::new(10.0, 0.0, 0.0);
            let posed = chain.pose_rad(&[FRAC_PI_2, FRAC_PI_2], &Payload::default(), force_n);
            posed.statics().shares_m.iter().find(|(name, _)| name == "j2.bearing").expect("share").1
        };
        // j2 turns about y. The two axes perpendicular to it are -z and -x of the upper arm. The x axis of the upper
        // arm points along world y now. The force of 10 N at the end of the 0.5 m long forearm is a moment of 5 N m
        // about it, and the tilt moves the tip by the angle times 0.5 m.
        let along = share_of([0.0, 1e-5]);
        assert!((along - Vector3::new(2.5e-5, 0.0, 0.0)).norm() < 1e-15, "{along}");
        // a tilt about the other axis, along which the forearm hangs, does not move the tip
        assert!(share_of([1e-5, 0.0]).norm() < 1e-15);
    }

    #[test]
    fn an_axis_shows_a_part_of_the_others() {
        let mut subject = super::super::validate::testing::two_link_subject();
        let plain = [0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        let mixing = [&plain[..], &[0.01, 0.02, 0.03, 0.04, 0.05, 0.06], &[0.0; 15]].concat();
        apply(&mixing, "static", &mut subject);
        let reading = &subject.channels[Channel::Static as usize];
        let seen = reading.along_own_axes(&Vector3::new(1.0, 10.0, 100.0));
        let expected = Vector3::new(1.0 + 0.1 + 2.0, 10.0 + 0.03 + 4.0, 100.0 + 0.05 + 0.6);
        assert!((seen - expected).norm() < 1e-12, "{seen}");
        assert!(subject.setups[Channel::Static as usize].turned.is_empty());
    }

    #[test]
    fn an_event_is_of_the_file_in_which_it_happened() {
        let mut subject = super::super::validate::testing::two_link_subject();
        let offset_m = Vector3::new(0.01, 0.0, -0.02);
        apply(&[0.01, 0.0, -0.02, 5.0, 12.0, 0.0, 0.0], "payload", &mut subject);
        let [statics, modal] = [Channel::Static, Channel::Modal].map(|c| subject.setups[c as usize].clone());
        assert!(modal.slipped.is_empty());
        assert_eq!([3, 4, 11].map(|row| statics.slip_m(row)), [Vector3::zeros(), offset_m, offset_m]);
        for (file, count) in [(12, 1), (11, 0)] {
            let mut of_file = statics.clone();
            of_file.keep_events_of(file);
            assert_eq!(of_file.slipped.len(), count, "the file {file}");
        }
        assert!(Event { from_row: 4, file: 0 }.is_in(7));
    }

    #[test]
    fn the_zero_of_a_driven_joint_turns_its_entry_of_a_pose() {
        let mut subject = super::super::validate::testing::two_link_subject();
        let zero = |rad: f64| [[0.0; 4].as_slice(), &[1.0], &[0.0; 2], &[rad, 0.0, 0.0, 0.0, 1.0]].concat();
        apply(&zero(0.03), "j2", &mut subject);
        apply(&zero(-0.01), "j2", &mut subject);
        let standing = subject.standing_rad(vec![0.5, 1.0]);
        assert!(standing[0] == 0.5 && (standing[1] - 1.02).abs() < 1e-15, "{standing:?}");
    }

    #[test]
    fn a_reading_bends_and_has_a_gain_in_each_direction() {
        let mut subject = super::super::validate::testing::two_link_subject();
        apply(&[0.1, 0.02, 2.0, 1.0, 1.0, 1.0], "static", &mut subject);
        apply(&[0.0, 0.0, 1.0, 1.0, 1.1, 0.9], "static", &mut subject);
        let reading = &subject.channels[Channel::Static as usize];
        // the scale is 2 mm: a reading of 2 mm deviates from a straight line by 12 %
        assert!(
            (reading.of(2.0, 0, 0) - 2.24).abs() < 1e-12 && (reading.of(-2.0, 0, 0) + 2.24).abs() < 1e-12
        );
        let straight = 0.9 * 1.0;
        let bent = straight * (0.1 * straight / 2.0 + 0.02 * straight * straight / 4.0);
        assert!((reading.of(1.0, 2, 0) - straight - bent).abs() < 1e-12);
    }
}
