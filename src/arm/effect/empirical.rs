//! `empirical`: a smooth function found in readings that no named effect explains. At a joint it is a further angle
//! of torsion, a polynomial of the torque. At a channel it is a nonlinear reading, or a factor of its own in each
//! direction.

use super::channel::Channel;
use super::kind::{Kind, Parameter, Place, Scale, Scope, Traits};
use super::subject::Subject;
use crate::arm::joint_law::FurtherTwist;

/// Parameter: coefficients of a joint's further angle of torsion that change sign with the torque.
pub(crate) const ODD_TWIST: &str = "odd_twist_rad";
/// Parameter: coefficients of a joint's further angle of torsion that do not change sign with the torque.
pub(crate) const EVEN_TWIST: &str = "even_twist_rad";
/// Parameter: reference torque of the coefficients of the further angle. At this torque the angle is the sum of all
/// coefficients.
pub(crate) const TORQUE: &str = "torque_nm";
/// Parameter: coefficients of the nonlinearity of a channel.
pub(crate) const BEND: &str = "bend";
/// Parameter: the reading at which the coefficients of the nonlinearity are the relative deviation from a straight
/// line.
pub(crate) const BEND_SCALE: &str = "bend_scale";
/// Parameter: a factor on the reading for each direction.
pub(crate) const GAIN: &str = "gain";

const OF_JOINT: &[Parameter] = &[
    optional(ODD_TWIST, 2, -0.1, 0.1, 0.0),
    optional(EVEN_TWIST, 2, -0.1, 0.1, 0.0),
    optional(TORQUE, 1, 1e-6, 1e9, 1.0),
];

const OF_CHANNEL: &[Parameter] = &[
    optional(BEND, 2, -10.0, 10.0, 0.0),
    optional(BEND_SCALE, 1, 1e-9, 1e9, 1.0),
    optional(GAIN, 3, 0.01, 100.0, 1.0),
];

/// A parameter of `count` numbers between `low` and `high` that may be left out. Left out, it has the value `default`,
/// which changes nothing.
const fn optional(name: &'static str, count: usize, low: f64, high: f64, default: f64) -> Parameter {
    let number = Parameter::number(name, low, high, default, Scale::Linear);
    Parameter { count, default: Some(default), ..number }
}

/// Description of the effect, for the list of all effects.
pub(crate) const KIND: Kind = Kind {
    name: "empirical",
    summary: "a law without a name, as found in readings: a further twist of a joint, or a reading that bends",
    scope: Scope::Product,
    places: &[
        Place::Joint,
        Place::Channel(Channel::Static),
        Place::Channel(Channel::Modal),
        Place::Channel(Channel::Windup),
    ],
    parameters: |place| if place == Place::Joint { OF_JOINT } else { OF_CHANNEL },
    apply,
    traits: Traits { is_sought: false, in_bounds: false, ..Traits::USUAL },
};

fn apply(numbers: &[f64], at: &str, subject: &mut Subject) {
    if let Some(joint) = subject.structure.joint_mut(at) {
        let [a, b, c, d, torque_nm] = numbers[..] else { return };
        joint.law.further =
            Some(added(joint.law.further, FurtherTwist { odd_rad: [a, b], even_rad: [c, d], torque_nm }));
    } else if let Some(reading) = subject.channel_mut(at) {
        let [a, b, bend_scale, x, y, z] = numbers[..] else { return };
        // one empirical effect may be nonlinear and another may have gains; both act if both are given
        if [a, b] != [0.0; 2] {
            (reading.bend, reading.bend_scale) = ([a, b], bend_scale);
        }
        reading.gain.iter_mut().zip([x, y, z]).for_each(|(own, gain)| *own *= gain);
    }
}

/// The sum of the further angle of torsion `before`, if there is one, and `twist`. The result has the reference torque
/// of `twist`.
fn added(before: Option<FurtherTwist>, twist: FurtherTwist) -> FurtherTwist {
    let Some(before) = before else { return twist };
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

    #[test]
    fn two_laws_of_one_joint_add_up_whatever_their_torques() {
        let mut subject = super::super::validate::testing::two_link_subject();
        let twist = |odd_rad, even_rad, torque_nm| FurtherTwist { odd_rad, even_rad, torque_nm };
        let (first, second) =
            (twist([1e-4, -2e-5], [3e-5, 1e-5], 20.0), twist([0.0, 4e-5], [0.0, 2e-5], 50.0));
        apply(&[1e-4, -2e-5, 3e-5, 1e-5, 20.0], "j1", &mut subject);
        apply(&[0.0, 4e-5, 0.0, 2e-5, 50.0], "j1", &mut subject);
        let law = subject.structure.joint_mut("j1").expect("j1").law;
        for torque_nm in [-70.0, -10.0, 5.0, 60.0] {
            let sum = first.angle_rad(torque_nm) + second.angle_rad(torque_nm);
            assert!((law.angle_rad(torque_nm) - torque_nm / 1e5 - sum).abs() < 1e-15, "{torque_nm}");
        }
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
