//! Which drive each joint needs (Eqs 7-12).
//!
//! This layer knows nothing of arms: given what a joint is asked for, it says which pairs of gear and
//! motor hold. The walk over an arm from its tip inward stands on top of it.
//!
//! - [`MotionRequirement`]: what the study asks of the tip; [`JointMotion`]: what that asks of a joint.
//! - [`JointDemand`]: the torques on the joint, from static torque and outboard inertia.
//! - [`Drive`]: a gear and a motor; [`Check`]: one limit of one part against one demand.
//! - [`DriveLimits`]: all checks of a drive under a fixed motion, reduced to five thresholds.
//! - [`DriveTable`]: every legal drive of a joint, sorted by mass; first fit, all fits, reasons.
//! - [`JointSizingRow`]: the numbers of one joint for the table on paper.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | T, T_lin, T_rot | static, linear and rotary torque (7, 8, 11) | N m |
//! | t_a, a | ramp time; tip acceleration v / t_a | s; m/s² |
//! | ω, α | speed and acceleration of the joint, output side | rad/s, rad/s² |
//! | N, η | reduction ratio; efficiency of the gear | - |
//! | J_in | rotor and wave generator, motor side (9) | kg m² |
//!
//! *Sides.* The paper's n_j is the motor's speed, so its J θ̈ is a motor-side torque; referred to the
//! joint it is N times as large. Every name here says which side it is on: `input` and `motor` for the
//! fast side, `output` or nothing for the joint.
//!
//! *Validity.* Efficiency is the catalog's single figure (rated torque, 2000 rpm input), used for holding
//! too, where friction would in truth help the motor. Motors have no torque-speed curve in the catalog:
//! the peak is taken as available up to the largest speed.

pub(crate) mod check;
pub(crate) mod demand;
pub(crate) mod drive;
pub(crate) mod duty;
pub(crate) mod eight;
pub(crate) mod explain;
pub(crate) mod limits;
pub(crate) mod requirement;
pub(crate) mod select;
pub(crate) mod sheet;
#[cfg(test)]
pub(crate) mod testing;

pub use check::{Check, CheckKind, CheckState, all_hold, binding, checks, gear_checks, motor_checks};
pub use demand::{
    JointDemand, JointMotion, LinearReading, cubic_mean_cubed_nm3, linear_torque_nm, stop_torque_nm,
};
pub use drive::{
    Drive, MissingFigure, motor_torque_nm, reference_life_h, rotary_torque_motor_nm, rotary_torque_output_nm,
};
pub use duty::{DutyCycle, MeanTorqueWeights, Phase, PhaseKind};
pub use explain::{RejectedPart, Rejection, Relaxation, RelaxationKind, Shortfall};
pub use limits::{DriveLimits, Obstacle};
pub use requirement::{MotionRequirement, RequirementError};
pub use select::{DriveFilter, DriveTable};
pub use sheet::{JointSizingRow, render_rows};

/// One revolution a minute in rad/s.
const RAD_S_PER_RPM: f64 = std::f64::consts::PI / 30.0;

/// Speed in rpm, the vendors' unit.
pub fn rpm_from_rad_s(speed_rad_s: f64) -> f64 {
    speed_rad_s / RAD_S_PER_RPM
}
