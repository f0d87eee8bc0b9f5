//! Slopes of joint laws, and of a base that lifts off, at the working point of a modal test. Jumps of a slope can be
//! smoothed, so that a descent can pass them.

use crate::arm::base_lift::BaseLift;
use crate::arm::joint_law::{Curve, JointLaw};

/// Slope of the tilt of a base whose feet lift off, at the moment `moment_nm` \[rad/(N m)\]. The slope jumps at
/// lift-off, and the jump is smoothed over `width` \[ln of the moment\]; 0 leaves it sharp.
pub(super) fn lifted_tangent(lift: &BaseLift, moment_nm: f64, width: f64) -> f64 {
    if width == 0.0 {
        return lift.tangent_compliance_rad_per_nm(moment_nm);
    }
    let beyond = libm::log(moment_nm.abs().max(1e-12) / lift.preload_nm) / width;
    0.5 * (1.0 + libm::tanh(beyond)) / lift.stiffness_nm_per_rad
}

/// Slope of a joint's torsion law at the torque `torque_nm` \[rad/(N m)\]. The jumps of slope of a gear's curve are
/// smoothed over `width` \[ln of the torque\]; 0 leaves them sharp.
pub(super) fn tangent(law: &JointLaw, torque_nm: f64, width: f64) -> f64 {
    let Curve::Windup(w) = law.curve else { return law.tangent_compliance_rad_per_nm(torque_nm) };
    if width == 0.0 {
        return law.tangent_compliance_rad_per_nm(torque_nm);
    }
    let beyond = |t: f64| 0.5 * (1.0 + libm::tanh(libm::log((torque_nm.abs().max(1e-12)) / t) / width));
    let segments = w.segments();
    let [c1, c2, c3] = segments.map(|s| 1.0 / s.stiffness_nm_per_rad);
    let smooth = c1 + (c2 - c1) * beyond(segments[0].to_nm) + (c3 - c2) * beyond(segments[1].to_nm);
    let sharp = law.curve.tangent_compliance_rad_per_nm(torque_nm);
    law.tangent_compliance_rad_per_nm(torque_nm) - sharp + smooth
}
