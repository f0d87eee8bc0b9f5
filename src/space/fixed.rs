//! Checks of a drive that the study gives.
//!
//! These checks are for information and exclude no design. A given part may have blank ratings. A check that needs a
//! blank rating is reported as not checked.

use super::design_space::{DriveChoice, SpaceJoint, SpacePiece};
use super::problem::{ArmProblem, Partial};
use super::station::reaches_m;
use crate::arm::bearing::BearingSource;
use crate::arm::transmission::Stage;
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
    /// The motion at the output of the gear. It is the motion that the study asks of the joint or, if stages lie
    /// between gear and joint, this motion times their ratio.
    pub motion: JointMotion,
    /// The motion that the study asks of the joint.
    joint_motion: JointMotion,
    /// The stages between gear and joint.
    after: Stage,
}

impl FixedDrive<'_> {
    /// Torque at the joint for each newton metre at the output of the gear: ratio times efficiency of the stages
    /// between both.
    pub(crate) fn gain_after_gear(&self) -> f64 {
        self.after.ratio * self.after.efficiency
    }
}

impl ArmProblem<'_> {
    /// The given drive of piece number `piece` (base to tip); `None` unless the study names a gear of the
    /// catalogs and, if this is no actuator, a motor of the catalogs.
    pub fn fixed_drive<'c>(&self, piece: usize, catalogs: &'c Catalogs) -> Option<FixedDrive<'c>> {
        let space = self.space();
        let SpacePiece::Joint(joint) = &space.pieces[piece] else { return None };
        let DriveChoice::Given { mass_kg, .. } = &joint.drive else { return None };
        let (gear, motor) = joint.drive.named_parts(catalogs)?;
        // The study states a single mass for the drive. This mass shows whether the gear is counted with the mass of a
        // component set or of a housed unit.
        let set_mass_kg = gear.mass_component_set_kg.zip(motor.mass_kg).map(|(g, m)| g + m);
        let gear_mass = match set_mass_kg.is_some_and(|m| (m - mass_kg).abs() < 1e-9) {
            true => GearMass::ComponentSet,
            false => GearMass::HousedUnit,
        };
        let (joint_motion, after) = (self.motion_of(piece, joint), joint.stages.after);
        // With a stage behind the gear, the bearing of the gear is not the bearing of the joint.
        let bearing = if after == Stage::NONE { joint.bearing } else { BearingSource::Stated(None) };
        Some(FixedDrive {
            drive: Drive {
                gear,
                motor,
                gear_mass,
                bearing,
                extras: joint.extras,
                stage: joint.stages.before,
            },
            mass_kg: *mass_kg,
            motion: joint_motion.before(&after),
            joint_motion,
            after,
        })
    }

    /// The motion that the study asks of `joint`, which is piece number `piece` (base to tip).
    pub(super) fn motion_of(&self, piece: usize, joint: &SpaceJoint) -> JointMotion {
        let space = self.space();
        let sizing = space.sizing_cases.iter().map(|&i| &space.cases[i]);
        let joints_before =
            space.pieces[..piece].iter().filter(|p| matches!(p, SpacePiece::Joint(_))).count();
        joint.motion(&space.motion, reaches_m(space, sizing)[joints_before])
    }

    /// Demand on the given drive of the joint in `slot` (the number of its place in the arm), at the output of its
    /// gear. `outboard` is the arm outboard of the joint.
    pub fn fixed_demand(&self, outboard: &Partial, slot: usize, fixed: &FixedDrive) -> JointDemand {
        self.fixed_demand_in(&self.space().sizing_cases, outboard, slot, fixed)
    }

    /// Demand on the given drive of the joint in `slot` over the given cases.
    pub(super) fn fixed_demand_in(
        &self,
        cases: &[usize],
        outboard: &Partial,
        slot: usize,
        fixed: &FixedDrive,
    ) -> JointDemand {
        let at_joint = self.demand_in(cases, outboard, slot, Some(&fixed.joint_motion));
        at_joint.before(&fixed.after, &fixed.motion)
    }
}
