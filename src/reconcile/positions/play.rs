//! Play in joints, as absolute positions show it. A joint turns by its half width `h` in the direction of its torque,
//! and by less where the torque is small: `h tanh(T/T_c)`.
//!
//! For a given torque scale `T_c` the half width enters the model like a compliance. So the scale is chosen out of a
//! few, and the half width is fitted.

use super::fitted::Sample;
use super::loads::CompliantPlace;
use crate::arm::effect::kind::ElasticRotation;
use crate::arm::effect::lost_motion;

/// Torque scales `T_c` that are tried, as fractions of the largest torque on the joint.
const PARTS: [f64; 5] = [0.01, 0.03, 0.08, 0.2, 0.5];
/// Adds candidates for play to the given `candidates`: five, one for each torque scale that is tried, in each joint
/// that has a candidate about its axis.
pub(crate) fn with_play(mut candidates: Vec<CompliantPlace>, samples: &[Sample]) -> Vec<CompliantPlace> {
    let is_joint = |c: &usize| candidates[*c].rotation == ElasticRotation::AboutAxis;
    let largest_nm = |c: usize| samples.iter().map(|s| s.deflection.lever(c).1.abs()).fold(0.0, f64::max);
    let joints: Vec<(String, f64)> =
        (0..candidates.len()).filter(is_joint).map(|c| (candidates[c].at.clone(), largest_nm(c))).collect();
    // a joint whose torque is zero up to rounding has no torque scale
    for (at, largest_nm) in joints.into_iter().filter(|(_, largest_nm)| *largest_nm > 1e-6) {
        candidates.extend(PARTS.map(|part| CompliantPlace {
            effect: lost_motion::KIND.name,
            rotation: ElasticRotation::AboutAxis,
            at: at.clone(),
            play_nm: Some(part * largest_nm),
        }));
    }
    candidates
}
