//! Poses in words.

use super::number::shortest;
use crate::arm::pose::{DrivenJoint, any_slides};

/// A pose in words: `(0, -45, 90) deg`. If a joint of the arm slides, each joint is listed with its value and unit:
/// `rail 250 mm, j2 30 deg`.
pub(crate) fn pose_words(driven: &[DrivenJoint], pose: &[f64]) -> String {
    if !any_slides(driven) {
        let angles: Vec<String> = pose.iter().map(|angle| shortest(*angle)).collect();
        return format!("({}) deg", angles.join(", "));
    }
    let entries = driven.iter().zip(pose);
    let words =
        entries.map(|(joint, entry)| format!("{} {} {}", joint.name, shortest(*entry), joint.motion.unit()));
    words.collect::<Vec<_>>().join(", ")
}

/// A pose with degree signs, `0°, -45°, 90°`. If a joint of the arm slides, [`pose_words`] is used.
pub(crate) fn pose_signs(driven: &[DrivenJoint], pose: &[f64]) -> String {
    if any_slides(driven) {
        return pose_words(driven, pose);
    }
    pose.iter().map(|angle| format!("{}°", shortest(*angle))).collect::<Vec<_>>().join(", ")
}
