//! The largest speed at which an arm holds the payloads of its study with its drives unchanged.
//!
//! The speed of the tip and every speed that a joint states grow by one factor. The times of the cycle stay as they
//! are, so accelerations grow by the same factor. A stated deceleration in an emergency stop and a duty that a joint
//! states in numbers do not change.

use super::overload::{Overload, overload};
use super::window::largest_held;
use crate::catalog::Catalogs;
use crate::space::design_space::{DesignSpace, DriveChoice, SpacePiece};
use crate::space::problem::ArmProblem;
use serde_json::{Value, json};

/// The largest speed at which the drives hold the payloads of the study.
#[derive(Debug, Clone, PartialEq)]
pub struct LargestSpeed {
    /// Ratio of the largest speed to the speed that the study asks for, the same for the tip and for every joint.
    pub factor: f64,
    /// The study's speed of the tip times this ratio \[m/s\].
    pub tip_speed_m_s: f64,
    /// Name of the joint that fails beyond this speed.
    pub joint: String,
    /// Label of the check that fails beyond this speed.
    pub check: String,
}

impl LargestSpeed {
    pub(super) fn to_json(&self) -> Value {
        json!({"factor": self.factor, "tip_speed_m_s": self.tip_speed_m_s, "joint": self.joint, "check": self.check})
    }
}

/// The largest speed at which the design with these options holds the study's payloads in all sizing cases; `None` if
/// it does not hold them even at the study's speed, or if no speed is too large.
pub(super) fn largest_speed(
    problem: &ArmProblem,
    options: &[u32],
    catalogs: &Catalogs,
) -> Option<LargestSpeed> {
    let (space, options) = with_these_drives(problem, options);
    let too_fast = |factor: f64| overload(&hastened(&space, factor), catalogs, &options, &space.sizing_cases);
    if too_fast(1.0).is_some() {
        return None;
    }
    let (factor, Overload { piece, check }) = largest_held(1.0, &too_fast)?;
    Some(LargestSpeed { factor, tip_speed_m_s: factor * space.motion.tip_speed_m_s, joint: piece, check })
}

/// A copy of the problem's space in which each joint may have only its drive in `options`, and the options of the same
/// design in this copy. The number of a drive in its table changes with the speed, because the table leaves out drives
/// that would turn too fast. In the copy each table has at most one drive, so its number does not change.
fn with_these_drives(problem: &ArmProblem, options: &[u32]) -> (DesignSpace, Vec<u32>) {
    let (mut space, mut pinned) = (problem.space().clone(), options.to_vec());
    // slots of effects and bearings are left out, because they have no drive
    for (slot, &option) in
        options.iter().enumerate().filter(|(slot, _)| problem.piece_in_slot(*slot).is_some())
    {
        let piece = problem.piece_of_slot(slot);
        let Some(sized) = problem.sized_joint(piece) else { continue };
        let drive = sized.table.drive(option as usize);
        pinned[slot] = 0;
        match &mut space.pieces[piece] {
            SpacePiece::Joint(joint) => match &mut joint.drive {
                DriveChoice::FirstFit(filter) | DriveChoice::AllFits(filter) => *filter = filter.only(&drive),
                DriveChoice::Given { .. } => {}
            },
            SpacePiece::Prismatic(joint) => {
                if let Some(rail) = &mut joint.drive {
                    rail.gears.retain(|gear| gear.id == drive.gear.id);
                    rail.motors.motor_ids = Some(vec![drive.motor.id.clone()]);
                }
            }
            SpacePiece::Link(_) | SpacePiece::Choice(_) => {}
        }
    }
    (space, pinned)
}

/// The space with every speed that its study asks for multiplied by `factor`.
fn hastened(space: &DesignSpace, factor: f64) -> DesignSpace {
    let mut out = space.clone();
    out.motion.tip_speed_m_s *= factor;
    for piece in &mut out.pieces {
        let own = match piece {
            SpacePiece::Joint(joint) => joint.max_speed_rad_s.as_mut(),
            SpacePiece::Prismatic(joint) => {
                joint.drive.as_mut().and_then(|drive| drive.max_speed_m_s.as_mut())
            }
            SpacePiece::Link(_) | SpacePiece::Choice(_) => None,
        };
        own.into_iter().for_each(|speed| *speed *= factor);
    }
    out
}
