//! The ways in which the convention of a file of positions can differ from the required one: another unit, a frame
//! whose axes are swapped or left-handed, joint angles of another sign or zero, columns of two joints that are swapped,
//! and columns that have the sum or the difference of two joints' angles.

use super::fitted::Sample;
use super::pose::Pose;
use super::tree::Tree;
use crate::arm::structure::{JointAngle, Piece};
use crate::reconcile::readings::campaign::PositionsSpec;
use nalgebra::Vector3;
use std::f64::consts::{FRAC_PI_2, PI};

/// Units other than the millimetre, each with its length \[mm\].
pub(super) const UNITS: [(&str, f64); 4] =
    [("metres", 1e3), ("micrometres", 1e-3), ("centimetres", 10.0), ("inches", 25.4)];

/// One way in which the convention of a file can differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Change {
    /// Positions are in another unit, given by its index in [`UNITS`].
    Unit(usize),
    /// For each axis of the frame, the index of the coordinate of the file that lies along it, and whether its sign
    /// is reversed.
    Axes([(usize, bool); 3]),
    /// One axis of the instrument's frame points the other way, so that the frame is left-handed.
    LeftHanded,
    /// The angles of the joint with this index have the other sign.
    Sign(usize),
    /// The zero of the joint with this index is elsewhere: this angle \[rad\] must be added to the joint's angles.
    Zero(usize, f64),
    /// The columns of the joints with these two indices are swapped.
    Swapped(usize, usize),
    /// The joint with the first index turns by the sum of its own column and the column of the second joint, as if
    /// their axes were coupled. With `true` it turns by the difference of the two columns.
    Coupled(usize, usize, bool),
}

const COORDINATES: [&str; 3] = ["x_mm", "y_mm", "z_mm"];

impl Change {
    /// Whether this change and `other` concern the same unit, axes or joint, so that one replaces the other.
    pub(super) fn replaces(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Unit(_), Self::Unit(_)) | (Self::Axes(_), Self::Axes(_)) => true,
            (Self::Zero(a, _), Self::Zero(b, _)) => a == b,
            (Self::Coupled(a, to, _), Self::Coupled(b, other_to, _)) => (a, to) == (b, other_to),
            (a, b) => a == b,
        }
    }

    /// The sample (a measured position), converted on the assumption that the file was written by this convention.
    pub(super) fn applied(&self, mut sample: Sample) -> Sample {
        match *self {
            Self::Unit(unit) => sample.measured_m *= UNITS[unit].1,
            Self::Axes(axes) => {
                let sign = |(_, is_other): (usize, bool)| if is_other { -1.0 } else { 1.0 };
                let (at_m, precision) = (sample.measured_m, sample.precision);
                sample.measured_m = Vector3::from(axes.map(|axis| sign(axis) * at_m[axis.0]));
                sample.precision = Vector3::from(axes.map(|axis| precision[axis.0]));
            }
            Self::LeftHanded => sample.measured_m.z *= -1.0,
            Self::Sign(_) | Self::Zero(..) | Self::Swapped(..) | Self::Coupled(..) => {
                let mut angles_rad = sample.pose.angles_rad();
                self.turn(&mut angles_rad);
                sample.pose = Pose::new(&angles_rad);
            }
        }
        sample
    }

    /// Converts the angles of the driven joints \[rad\].
    fn turn(&self, angles_rad: &mut [f64]) {
        match *self {
            Self::Sign(j) => angles_rad[j] *= -1.0,
            Self::Zero(j, by) => angles_rad[j] += by,
            Self::Swapped(a, b) => angles_rad.swap(a, b),
            Self::Coupled(j, to, is_less) => {
                angles_rad[j] += if is_less { -1.0 } else { 1.0 } * angles_rad[to]
            }
            Self::Unit(_) | Self::Axes(_) | Self::LeftHanded => {}
        }
    }

    pub(super) fn words(&self, driven: &[String]) -> String {
        match *self {
            Self::Unit(unit) => format!("the positions are in {}", UNITS[unit].0),
            Self::Axes(axes) => {
                let axis = |(c, is_other): (usize, bool)| {
                    format!("{}{}", if is_other { "-" } else { "" }, COORDINATES[c])
                };
                format!("the frame's x, y, z are {} of the file", axes.map(axis).join(", "))
            }
            Self::LeftHanded => {
                "the instrument's frame is left-handed (two axes are swapped, or one has the other sign)"
                    .into()
            }
            Self::Sign(j) => format!("the angles of {} have the other sign", driven[j]),
            Self::Zero(j, by) => {
                format!("{:.0} degrees are added to the angles of {}", by.to_degrees(), driven[j])
            }
            Self::Swapped(a, b) => format!("the columns of {} and {} are swapped", driven[a], driven[b]),
            Self::Coupled(j, to, is_less) => {
                let (own, other) = (&driven[j], &driven[to]);
                let how = if is_less { "less" } else { "plus" };
                format!("{own} turns by the column of {own} {how} the column of {other} (coupled axes)")
            }
        }
    }
}

/// The changes of convention that are tried for the arms of `tree`. If the base placement is free, the fit itself turns
/// the frame, so only a left-handed frame is tried. The zero of a joint is not tried if other free numbers turn the arm
/// in the same way.
pub(super) fn changes(spec: &PositionsSpec, tree: &Tree) -> Vec<Change> {
    let joints = tree.driven.len();
    let mut out: Vec<Change> = (0..UNITS.len()).map(Change::Unit).collect();
    match spec.base_placement {
        true => out.push(Change::LeftHanded),
        false => out.extend(other_axes()),
    }
    out.extend((0..joints).map(Change::Sign));
    let seen = (0..joints).filter(|&j| !is_zero_unseen(spec, tree, j));
    out.extend(seen.flat_map(|j| [FRAC_PI_2, -FRAC_PI_2, PI].map(|by| Change::Zero(j, by))));
    out.extend((0..joints).flat_map(|a| (a + 1..joints).map(move |b| Change::Swapped(a, b))));
    let next = (1..joints).flat_map(|j| [(j, j - 1), (j - 1, j)]);
    out.extend(next.flat_map(|(j, to)| [false, true].map(|is_less| Change::Coupled(j, to, is_less))));
    out
}

/// Whether the zero of the driven joint with index `driven` cannot be seen, because other numbers that are free turn the
/// arm in the same way: the base's placement for the first joint of all arms, the tool's offset for the last joint of an
/// arm.
fn is_zero_unseen(spec: &PositionsSpec, tree: &Tree, driven: usize) -> bool {
    let angle = |piece: usize| match &tree.pieces[piece] {
        Piece::Joint(joint) => Some(&joint.angle),
        _ => None,
    };
    let is_own = |piece: &usize| matches!(angle(*piece), Some(JointAngle::Driven(j)) if *j == driven);
    let follows = |piece: &usize| matches!(angle(*piece), Some(JointAngle::Coupled(terms)) if terms.iter().any(|(j, _)| *j == driven));
    let joints = |arm: &Vec<usize>| arm.iter().copied().filter(|&p| angle(p).is_some()).collect::<Vec<_>>();
    let arms: Vec<Vec<usize>> = tree.arms.iter().map(joints).collect();
    if arms.iter().flatten().any(follows) {
        return false;
    }
    let is_first = arms.iter().all(|arm| arm.first().is_some_and(is_own));
    let is_last = arms.iter().filter(|arm| arm.iter().any(is_own)).all(|arm| arm.last().is_some_and(is_own));
    (spec.base_placement && is_first) || (spec.tool_offset && is_last)
}

/// All pairs of the changes `all` that concern the sign or the zero of two different joints.
pub(super) fn pairs(all: &[Change]) -> Vec<Vec<Change>> {
    let joint = |change: &Change| match change {
        Change::Sign(j) | Change::Zero(j, _) => Some(*j),
        _ => None,
    };
    let of_two = |a: &Change, b: &Change| joint(a).zip(joint(b)).is_some_and(|(a, b)| a < b);
    let with = |a: &Change| all.iter().filter(|b| of_two(a, b)).map(|b| vec![*a, *b]).collect::<Vec<_>>();
    all.iter().flat_map(with).collect()
}

/// The 47 ways to permute and reverse the axes of a frame, other than leaving it as it is.
fn other_axes() -> Vec<Change> {
    const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    let signed = ORDERS.iter().flat_map(|order| {
        (0..8).map(move |signs| Change::Axes([0, 1, 2].map(|c| (order[c], (signs >> c) & 1 == 1))))
    });
    signed.skip(1).collect()
}
