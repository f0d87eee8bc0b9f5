//! Checks of a drive that the study gives.
//!
//! These checks are for information and exclude no design. A given part may have blank ratings. A check that needs a
//! blank rating is reported as not checked.

use super::design_space::{DriveChoice, SpacePiece};
use super::problem::{ArmProblem, Partial};
use super::station::reaches_m;
use crate::catalog::Catalogs;
use crate::catalog::gear::GearMass;
use crate::sizing::demand::{JointDemand, JointMotion};
use crate::sizing::drive::Drive;

/// A given drive whose gear and motor are in the catalogs.
#[derive(Debug, Clone, Copy)]
pub struct FixedDrive<'c> {
    /// Gear and motor of the drive.
    pub drive: Drive<'c>,
    /// Mass of the drive that the study states \[kg\]. The catalog may have another.
    pub mass_kg: f64,
    /// The motion that the study asks of the joint.
    pub motion: JointMotion,
}

impl ArmProblem<'_> {
    /// The given drive of piece number `piece` (base to tip); `None` unless the study names a gear and a motor that
    /// are both in the catalogs.
    pub fn fixed_drive<'c>(&self, piece: usize, catalogs: &'c Catalogs) -> Option<FixedDrive<'c>> {
        let space = self.space();
        let SpacePiece::Joint(joint) = &space.pieces[piece] else { return None };
        let DriveChoice::Given { gear: Some(gear), motor: Some(motor), mass_kg, .. } = &joint.drive else {
            return None;
        };
        let sizing = space.sizing_cases.iter().map(|&i| &space.cases[i]);
        let joints_before =
            space.pieces[..piece].iter().filter(|p| matches!(p, SpacePiece::Joint(_))).count();
        let reach_m = reaches_m(space, sizing)[joints_before];
        let (gear, motor) = (catalogs.gear(gear).ok()?, catalogs.motor(motor).ok()?);
        // the study states a single mass for the drive; it shows which of the two masses of the gear was used
        let set_mass_kg = gear.mass_component_set_kg.zip(motor.mass_kg).map(|(g, m)| g + m);
        let gear_mass = match set_mass_kg.is_some_and(|m| (m - mass_kg).abs() < 1e-9) {
            true => GearMass::ComponentSet,
            false => GearMass::HousedUnit,
        };
        Some(FixedDrive {
            drive: Drive {
                gear,
                motor,
                gear_mass,
                bearing: joint.bearing,
                extras: joint.extras,
                stage: joint.stages.before,
            },
            mass_kg: *mass_kg,
            motion: joint.motion(&space.motion, reach_m),
        })
    }

    /// Demand on the joint in `slot`, whose drive the study gives. `outboard` is the arm outboard of the joint, and
    /// `motion` the motion that the study asks of it.
    pub fn fixed_demand(&self, outboard: &Partial, slot: usize, motion: &JointMotion) -> JointDemand {
        self.demand(outboard, slot, Some(motion))
    }
}
