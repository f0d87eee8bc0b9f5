//! Checks which joints may drive the passive joints of a study.

use crate::input::json::Node;
use crate::space::design_space::SpacePiece;

/// Checks that every passive joint is turned by driven joints inboard of it. Drives are sized from the tip inward, so
/// the torque that a linkage transfers to its driving joint must be known before this joint is sized. Returns `None`
/// after recording a fault.
pub(super) fn drivers_are_inboard(items: &[Node], pieces: &[SpacePiece]) -> Option<()> {
    let mut sound = Some(());
    let mut inboard: Vec<&str> = Vec::new();
    for (item, piece) in items.iter().zip(pieces) {
        let SpacePiece::Joint(joint) = piece else { continue };
        for (name, _) in joint.coupled.iter().flatten().filter(|(name, _)| !inboard.contains(&name.as_str()))
        {
            sound = item.fault(
                format!("is coupled to \"{name}\", which is no driven joint inboard of it"),
                &match inboard.as_slice() {
                    [] => "no driven joint stands inboard of it".to_string(),
                    names => format!("driven joints inboard of it: {}", names.join(", ")),
                },
            );
        }
        if joint.coupled.is_none() {
            inboard.push(&joint.name);
        }
    }
    sound
}
