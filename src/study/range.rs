//! How far the joints of a study turn: reading the ranges, holding the poses to them, and saying them.

use crate::input::json::{Node, Object};
use crate::report::number::shortest;
use crate::report::words::and;
use crate::space::design_space::{Case, DesignSpace, SpaceJoint, SpacePiece};

/// The range of a joint whose range is not stated \[deg\]: a full turn.
pub(crate) const NOT_STATED_DEG: [f64; 2] = [-180.0, 180.0];

/// Reads a range, which is the smallest and the largest angle of a joint \[deg\].
pub(super) fn read_range(node: &Node) -> Option<[f64; 2]> {
    match node.numbers::<2>()? {
        [low, high] if low < high => Some([low, high]),
        [low, high] => node.fault(
            format!("= [{}, {}] is no range", shortest(low), shortest(high)),
            "give the smaller angle first, in degrees, such as [-90, 120]",
        ),
    }
}

/// Reports every angle of a pose beyond the range of its joint as a fault. Nothing is checked if the chain or the
/// cases could not be read.
pub(super) fn check_poses(root: &Object, chain: Option<&[SpacePiece]>, cases: Option<&[Case]>) -> Option<()> {
    let (Some(chain), Some(cases)) = (chain, cases) else { return Some(()) };
    let joints: Vec<&SpaceJoint> = joints(chain).collect();
    // the first environment has the poses in the order of the file
    let poses = root.required("poses")?.array()?;
    let mut sound = Some(());
    for (pose, case) in poses.iter().zip(cases) {
        for (joint, &angle_deg) in joints.iter().zip(&case.pose_deg) {
            let Some([low, high]) = joint.range_deg else { continue };
            if !(low..=high).contains(&angle_deg) {
                sound = pose.fault_below(
                    "pose_deg",
                    format!(
                        "turns {} to {} deg in pose \"{}\", beyond its range_deg of {}",
                        joint.name,
                        shortest(angle_deg),
                        case.name,
                        from_to([low, high])
                    ),
                    "widen the range of this joint, or change the pose",
                );
            }
        }
    }
    sound
}

/// The ranges of a study's joints in words, joints of the same range together.
pub(crate) fn range_words(space: &DesignSpace) -> Vec<String> {
    let mut groups: Vec<(Option<[f64; 2]>, Vec<&str>)> = Vec::new();
    for joint in joints(&space.pieces) {
        match groups.iter_mut().find(|(range, _)| *range == joint.range_deg) {
            Some((_, names)) => names.push(&joint.name),
            None => groups.push((joint.range_deg, vec![&joint.name])),
        }
    }
    let words = |(range, names): (Option<[f64; 2]>, Vec<&str>)| match range {
        Some(range) => format!("{}: {} deg", and(&names), from_to(range)),
        None => format!("{}: range not stated: +-180 deg", and(&names)),
    };
    groups.into_iter().map(words).collect()
}

/// The range of each joint, base to tip \[deg\], that of a full turn where none is stated.
pub(crate) fn ranges_deg(space: &DesignSpace) -> Vec<[f64; 2]> {
    joints(&space.pieces).map(|joint| joint.range_deg.unwrap_or(NOT_STATED_DEG)).collect()
}

/// The driven joints, each of which has an angle in every pose.
fn joints(pieces: &[SpacePiece]) -> impl Iterator<Item = &SpaceJoint> {
    pieces.iter().filter_map(|piece| match piece {
        SpacePiece::Joint(joint) if joint.coupled.is_none() => Some(joint),
        _ => None,
    })
}

fn from_to([low, high]: [f64; 2]) -> String {
    format!("{} to {}", shortest(low), shortest(high))
}
