//! The first piece of a complete arm that a load overloads, with the drives unchanged.

use super::problem::{ArmProblem, Partial};
use super::slot::Slot;
use crate::catalog::Catalogs;
use crate::sizing::check::{Check, CheckState};
use crate::sizing::checks::{binding, checks};

impl ArmProblem<'_> {
    /// Finds the first piece from the tip that is overloaded in one of `cases`. The arm has these `options`, one for
    /// each slot (piece of the arm, tip first). Drives that the study gives by name are checked too, as far as their
    /// ratings in `catalogs` are known. Returns the number of the piece (base to tip) and the check that its drive
    /// fails. The check is `None` for a link whose stress is too high, and for a drive of which no check can be made.
    /// The result is `None` if no piece is overloaded.
    pub(crate) fn overload(
        &self,
        options: &[u32],
        cases: &[usize],
        catalogs: &Catalogs,
    ) -> Option<(usize, Option<Check>)> {
        let mut partial = self.empty();
        for (slot, &option) in options.iter().enumerate() {
            let Slot::Sized(sized) = &self.slots()[slot] else {
                if let Some(fails) = self.fixed_overload(cases, &partial, slot, catalogs) {
                    return Some((self.piece_of_slot(slot), Some(fails)));
                }
                if !self.add(slot, option, &mut partial) {
                    return Some((self.piece_of_slot(slot), None));
                }
                continue;
            };
            let (index, motion) = (option as usize, sized.table.motion());
            let demand = self.demand_in(cases, &partial, slot, Some(motion));
            if !sized.table.holds(index, &demand) {
                let drive = sized.table.drive_or_illegal(index);
                let check = drive.and_then(|drive| binding(&checks(&drive, motion, &demand)).cloned());
                return Some((self.piece_of_slot(slot), check));
            }
            self.add_drive(slot, sized, index, &mut partial);
        }
        None
    }

    /// The check with the smallest margin that the given drive of the joint in `slot` fails in some of the cases;
    /// `None` if it fails none, or if there is no such drive. A check that needs a blank rating is left out.
    pub(super) fn fixed_overload(
        &self,
        cases: &[usize],
        outboard: &Partial,
        slot: usize,
        catalogs: &Catalogs,
    ) -> Option<Check> {
        // Slots of effects and bearings have no drive.
        self.piece_in_slot(slot)?;
        let fixed = self.fixed_drive(self.piece_of_slot(slot), catalogs)?;
        let mut failed =
            checks(&fixed.drive, &fixed.motion, &self.fixed_demand_in(cases, outboard, slot, &fixed));
        failed.retain(|check| check.state == CheckState::Fails);
        binding(&failed).copied()
    }
}
