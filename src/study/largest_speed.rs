//! The largest speed at which an arm holds the payloads of its study with its drives unchanged.
//!
//! The speed of the tip and every speed that a joint states grow by one factor. The times of the cycle stay as they
//! are, so accelerations grow by the same factor. A stated deceleration in an emergency stop and a duty that a joint
//! states in numbers do not change.

use super::overload::{Overload, overload};
use super::window::largest_held;
use crate::catalog::Catalogs;
use crate::sizing::stated::StatedDuty;
use crate::space::design_space::{DesignSpace, DriveChoice, SpacePiece};
use crate::space::problem::ArmProblem;
use serde_json::{Value, json};

/// The largest speed at which the drives hold the payloads of the study.
#[derive(Debug, Clone, PartialEq)]
pub struct LargestSpeed {
    /// Ratio of the largest speed to the speed that the study asks for, the same for the tip and for every joint.
    pub factor: f64,
    /// The study's speed of the tip times this ratio \[m/s\]. `None` if every joint has a speed of its own, so that none
    /// follows from the speed of the tip.
    pub tip_speed_m_s: Option<f64>,
    /// The joints for which the study states a speed, base to tip, with their speeds at this ratio.
    pub own_speeds: Vec<OwnSpeed>,
    /// Name of the joint that fails beyond this speed.
    pub joint: String,
    /// Label of the check that fails beyond this speed.
    pub check: String,
}

/// The speed of a joint for which the study states a speed.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnSpeed {
    /// Name of the joint.
    pub joint: String,
    /// Speed \[rad/s\], or \[m/s\] of a rail.
    pub speed: f64,
    /// Whether the joint is a rail.
    pub slides: bool,
}

impl LargestSpeed {
    pub(super) fn to_json(&self) -> Value {
        let own = |own: &OwnSpeed| {
            let key = if own.slides { "max_speed_m_s" } else { "max_speed_rad_s" };
            json!({"joint": own.joint, key: own.speed})
        };
        let own_speeds: Vec<Value> = self.own_speeds.iter().map(own).collect();
        json!({"factor": self.factor, "tip_speed_m_s": self.tip_speed_m_s, "own_speeds": own_speeds,
            "joint": self.joint, "check": self.check})
    }
}

/// The largest speed at which the design with these options holds the study's payloads in all sizing cases; `None` if
/// it does not hold them even at the study's speed, if no speed is too large, or if duties in numbers state all speeds.
pub(super) fn largest_speed(
    problem: &ArmProblem,
    options: &[u32],
    catalogs: &Catalogs,
) -> Option<LargestSpeed> {
    let (space, options) = with_these_drives(problem, options);
    let follows_the_tip = space.pieces.iter().any(follows_the_tip);
    if !follows_the_tip && space.pieces.iter().all(|piece| own_speed(piece).is_none()) {
        return None;
    }
    let too_fast = |factor: f64| overload(&hastened(&space, factor), catalogs, &options, &space.sizing_cases);
    if too_fast(1.0).is_some() {
        return None;
    }
    let (factor, Overload { piece, check }) = largest_held(1.0, &too_fast)?;
    Some(LargestSpeed {
        factor,
        tip_speed_m_s: follows_the_tip.then_some(factor * space.motion.tip_speed_m_s),
        own_speeds: hastened(&space, factor).pieces.iter().filter_map(own_speed).collect(),
        joint: piece,
        check,
    })
}

/// The speed that the study states for a joint or a rail, or the fastest phase of the joint's duty if that is faster.
/// `None` if the study states no speed, or for any other piece.
fn own_speed(piece: &SpacePiece) -> Option<OwnSpeed> {
    let (speed, slides) = match piece {
        SpacePiece::Joint(joint) => {
            let of_duty = joint.duty.as_ref().map_or(0.0, StatedDuty::fastest_rad_s);
            (joint.max_speed_rad_s?.max(of_duty), false)
        }
        SpacePiece::Prismatic(rail) => (rail.max_speed_m_s?, true),
        SpacePiece::Link(_) | SpacePiece::Choice(_) => return None,
    };
    Some(OwnSpeed { joint: piece.name().to_string(), speed, slides })
}

/// Whether the speed of a joint follows from the study's speed of the tip. It does not where the joint turns with
/// another one, or where the study states its speed or its duty.
fn follows_the_tip(piece: &SpacePiece) -> bool {
    match piece {
        SpacePiece::Joint(joint) => {
            joint.coupled.is_none() && joint.duty.is_none() && joint.max_speed_rad_s.is_none()
        }
        SpacePiece::Prismatic(rail) => rail.max_speed_m_s.is_none(),
        SpacePiece::Link(_) | SpacePiece::Choice(_) => false,
    }
}

/// A copy of the problem's space in which each joint may have only its drive in `options`, and the options of the same
/// design in this copy. The number of a drive in its table changes with the speed, because the table leaves out drives
/// that would turn too fast. In the copy each table has at most one drive, so its number does not change.
pub(super) fn with_these_drives(problem: &ArmProblem, options: &[u32]) -> (DesignSpace, Vec<u32>) {
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
            SpacePiece::Prismatic(rail) => rail.max_speed_m_s.as_mut(),
            SpacePiece::Link(_) | SpacePiece::Choice(_) => None,
        };
        own.into_iter().for_each(|speed| *speed *= factor);
    }
    out
}
