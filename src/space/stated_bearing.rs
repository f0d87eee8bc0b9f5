//! Checks of an output bearing that the study states at a joint whose drive does not come from the catalogs, or whose
//! gear sits at the motor. The drive of such a joint is not checked, but its bearing can be: the load and the ratings
//! are known.

use super::design_space::{SpaceJoint, SpacePiece};
use super::problem::{ArmProblem, Partial};
use crate::arm::transmission::Stage;
use crate::catalog::Catalogs;
use crate::sizing::bearing_checks::bearing_checks;
use crate::sizing::check::Check;

impl SpaceJoint {
    /// Whether the study states an output bearing of this joint that is checked without a drive: the drive is given
    /// without the names of gear and motor, or its gear sits at the motor. The bearing of a passive joint is not checked,
    /// because its speed is that of other joints.
    pub(crate) fn has_bearing_of_its_own(&self, catalogs: &Catalogs) -> bool {
        let is_of_drive = self.drive.named_parts(catalogs).is_some() && self.stages.after == Stage::NONE;
        let is_given = !self.drive.is_sized() && self.coupled.is_none();
        is_given && !is_of_drive && self.bearing.stated().is_some()
    }
}

impl ArmProblem<'_> {
    /// The checks of the bearing that the study states at the joint in `slot`, over the given cases: moment while
    /// running, static safety at rest and in a stop, life. `outboard` is the arm outboard of the joint. `None` if the
    /// joint has no such bearing ([`SpaceJoint::has_bearing_of_its_own`]).
    pub(crate) fn stated_bearing_checks(
        &self,
        cases: &[usize],
        outboard: &Partial,
        slot: usize,
        catalogs: &Catalogs,
    ) -> Option<[Check; 4]> {
        let SpacePiece::Joint(joint) = self.piece_in_slot(slot)? else { return None };
        let bearing = joint.bearing.stated().filter(|_| joint.has_bearing_of_its_own(catalogs))?;
        let motion = self.motion_of(self.piece_of_slot(slot), joint);
        let demand = self.demand_in(cases, outboard, slot, Some(&motion));
        Some(bearing_checks(&bearing, &motion, &demand.bearing))
    }
}
