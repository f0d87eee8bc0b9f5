//! The stress in the links at peak load.

use super::arm::Chosen;
use super::study::{Pose, Posed, Study};

/// Strength over the largest stress of all links in all poses; none if no link has a section.
pub fn stress_safety_factor(_study: &Study, _poses: &[(&Pose, Posed)], _chain: &[Chosen]) -> Option<f64> {
    None
}
