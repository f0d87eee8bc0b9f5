//! Ranges of the joints of a study: reads them, checks the poses against them, and describes them in words.

use crate::arm::pose::{DrivenJoint, Motion};
use crate::input::json::{Node, Object};
use crate::report::number::shortest;
use crate::report::words::and;
use crate::space::design_space::{Case, DesignSpace, SpacePiece};

/// The range of a revolute joint that states none \[deg\]: a full turn.
pub(crate) const NOT_STATED_DEG: [f64; 2] = [-180.0, 180.0];

/// Reads a range: smallest and largest angle of a joint \[deg\], or smallest and largest travel \[mm\]. Returns `None`
/// after recording a fault.
pub(super) fn read_range(node: &Node) -> Option<[f64; 2]> {
    match node.numbers::<2>()? {
        [low, high] if low < high => Some([low, high]),
        [low, high] => node.fault(
            format!("= [{}, {}] is no range", shortest(low), shortest(high)),
            "give the smaller end first, such as \"range_deg\": [-90, 120] or \"range_mm\": [0, 800]",
        ),
    }
}

/// A driven joint of a study with its range.
struct Ranged<'s> {
    name: &'s str,
    motion: Motion,
    /// Smallest and largest entry in a pose \[deg or mm\]; `None` if it is not stated.
    range: Option<[f64; 2]>,
}

/// Reports a fault for every angle or travel of a pose outside the range of its joint. Nothing is checked if the chain
/// or the cases could not be read. Returns `None` after recording a fault.
pub(super) fn check_poses(root: &Object, chain: Option<&[SpacePiece]>, cases: Option<&[Case]>) -> Option<()> {
    let (Some(chain), Some(cases)) = (chain, cases) else { return Some(()) };
    let joints: Vec<Ranged> = joints(chain).collect();
    // the cases of the first environment have the order of the poses in the file
    let poses = root.required("poses")?.array()?;
    let mut sound = Some(());
    for (pose, case) in poses.iter().zip(cases) {
        let field = if pose.value().get("pose").is_some() { "pose" } else { "pose_deg" };
        for (joint, &entry) in joints.iter().zip(&case.pose_deg) {
            let Some([low, high]) = joint.range else { continue };
            if !(low..=high).contains(&entry) {
                let moves = match joint.motion {
                    Motion::Turns => "turns",
                    Motion::Slides => "moves",
                };
                let (name, unit) = (joint.name, joint.motion.unit());
                sound = pose.fault_below(
                    field,
                    format!(
                        "{moves} {name} to {} {unit} in pose \"{}\", beyond its range_{unit} of {}",
                        shortest(entry),
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

/// The ranges of a study's joints in words. Joints with the same range are named together.
pub(crate) fn range_words(space: &DesignSpace) -> Vec<String> {
    type Group<'s> = ((Motion, Option<[f64; 2]>), Vec<&'s str>);
    let mut groups: Vec<Group> = Vec::new();
    for joint in joints(&space.pieces) {
        let key = (joint.motion, joint.range);
        match groups.iter_mut().find(|(known, _)| *known == key) {
            Some((_, names)) => names.push(joint.name),
            None => groups.push((key, vec![joint.name])),
        }
    }
    let words = |((motion, range), names): Group| match (motion, range) {
        (_, Some(range)) => format!("{}: {} {}", and(&names), from_to(range), motion.unit()),
        (Motion::Turns, None) => format!("{}: range not stated: +-180 deg", and(&names)),
        (Motion::Slides, None) => format!("{}: range not stated: the travels of the poses", and(&names)),
    };
    groups.into_iter().map(words).collect()
}

/// The range of each driven joint, base to tip \[deg or mm\]. If none is stated, it is a full turn for a revolute
/// joint, and the span of the travels in the study's poses for a prismatic joint.
pub(crate) fn ranges(space: &DesignSpace) -> Vec<[f64; 2]> {
    let travels = |entry: usize| {
        let of = space.cases.iter().filter_map(|case| case.pose_deg.get(entry));
        of.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], mm| [low.min(*mm), high.max(*mm)])
    };
    let range = |(entry, joint): (usize, Ranged)| match (joint.range, joint.motion) {
        (Some(range), _) => range,
        (None, Motion::Turns) => NOT_STATED_DEG,
        (None, Motion::Slides) => travels(entry),
    };
    joints(&space.pieces).enumerate().map(range).collect()
}

/// The driven joints, base to tip, with the kind of motion, and whether the study states their ranges.
pub(crate) fn stated_ranges(space: &DesignSpace) -> Vec<(DrivenJoint, bool)> {
    let stated = |joint: Ranged| {
        (DrivenJoint { name: joint.name.into(), motion: joint.motion }, joint.range.is_some())
    };
    joints(&space.pieces).map(stated).collect()
}

fn joints(pieces: &[SpacePiece]) -> impl Iterator<Item = Ranged<'_>> {
    pieces.iter().filter_map(|piece| match piece {
        SpacePiece::Joint(joint) if joint.coupled.is_none() => {
            Some(Ranged { name: &joint.name, motion: Motion::Turns, range: joint.range_deg })
        }
        SpacePiece::Prismatic(slide) => {
            Some(Ranged { name: &slide.joint.name, motion: Motion::Slides, range: slide.range_mm })
        }
        _ => None,
    })
}

fn from_to([low, high]: [f64; 2]) -> String {
    format!("{} to {}", shortest(low), shortest(high))
}
