//! Sizing: which drive each joint needs (Eqs 7-12 of docs/model.md, from the paper named there).
//!
//! This module knows nothing of arms. For the demand on a joint it finds the pairs of gear and motor that pass every
//! check. The walk over an arm from tip to base is in [`space`](crate::space), which uses this module.
//!
//! - [`MotionRequirement`] is the motion that a study asks of the tip, [`JointMotion`] the motion that follows for a
//!   joint.
//! - [`JointDemand`] has the torques on the joint, which follow from static torque and outboard inertia.
//! - [`Drive`] is a gear and a motor, [`Check`] compares one limit of one part with one demand.
//! - [`MotorHeat`] compares the motor's torque over the cycle with its continuous torque; [`StatedDuty`] is a duty
//!   cycle given in numbers.
//! - [`DriveLimits`] has all checks of a drive under a fixed motion, reduced to thresholds.
//! - [`DriveTable`] has every drive of a joint that the study allows, sorted by mass. It finds the lightest drive or
//!   all drives that meet a demand, and says why a part was rejected.
//! - [`JointSizingRow`] has the numbers of one joint for the sizing table.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | T, T_lin, T_rot | static, linear and rotary torque (Eqs 7, 8, 11) | N m |
//! | t_a, a | ramp time; tip acceleration v / t_a | s; m/s² |
//! | ω, α | speed and acceleration of the joint, output side | rad/s, rad/s² |
//! | N, η | reduction ratio; efficiency of the gear | - |
//! | J_in | rotor and wave generator, motor side (Eq 9) | kg m² |
//!
//! *Sides.* The paper's n_j is the speed of the motor, so its J θ̈ is a torque on the motor's side. Referred to the
//! joint it is N times as large. Every name states its side: `input` and `motor` for the fast side, `output` or nothing
//! for the joint.
//!
//! *Validity.* The efficiency is a single number of the catalog, for rated torque and 2000 rpm at the input. It is
//! also used for holding at rest, where friction in reality helps the motor. A motor may have no torque-speed
//! curve in the catalog. Its peak torque is then taken as available up to the largest speed. Its continuous torque is
//! taken as falling with constant power beyond the rated speed.

pub(crate) mod bearing;
pub(crate) mod bearing_advice;
pub(crate) mod bearing_checks;
pub(crate) mod check;
pub(crate) mod checks;
pub(crate) mod demand;
pub(crate) mod drive;
pub(crate) mod duty;
pub(crate) mod eight;
pub(crate) mod explain;
pub(crate) mod fit;
pub(crate) mod fit_checks;
pub(crate) mod heat;
pub(crate) mod limits;
pub(crate) mod missing;
mod motor_curve;
pub(crate) mod motor_stop;
pub(crate) mod rail;
pub(crate) mod requirement;
pub(crate) mod select;
pub(crate) mod sheet;
mod sheet_json;
pub(crate) mod stated;
#[cfg(test)]
pub(crate) mod testing;

pub use bearing::{BearingDemand, BearingLimits, BearingLoad};
pub use bearing_checks::{BlankRatings, bearing_margin};
pub use check::{Check, CheckKind, CheckState};
pub use checks::{all_hold, binding, checks, gear_checks, motor_checks};
pub use demand::{
    JointDemand, JointMotion, LinearReading, Stop, cubic_mean_cubed_nm3, linear_torque_nm, stop_torque_nm,
};
pub use drive::{
    Drive, MissingRating, critical_rpm, motor_torque_nm, rotary_torque_motor_nm, rotary_torque_output_nm,
};
pub use duty::{DutyCycle, HeatWeights, MeanTorqueWeights, Phase, PhaseKind};
pub use explain::{RejectedPart, Rejection, Relaxation, RelaxationKind, Shortfall};
pub use fit::{DriveWidths, FitRequirement, LinkRoom, MotorPlace};
pub use heat::MotorHeat;
pub use limits::{DriveLimits, Obstacle};
pub use rail::{Ends, Rack, Screw};
pub use requirement::{MotionRequirement, RequirementError};
pub use select::{DriveFilter, DriveTable};
pub use sheet::{JointSizingRow, render_rows};
pub use stated::{StatedDemand, StatedDuty, StatedHeat, StatedPhase};

/// 1 rpm in rad/s.
const RAD_S_PER_RPM: f64 = std::f64::consts::PI / 30.0;

/// Converts a speed from rad/s to rpm, the unit of the vendors.
pub fn rpm_from_rad_s(speed_rad_s: f64) -> f64 {
    speed_rad_s / RAD_S_PER_RPM
}
