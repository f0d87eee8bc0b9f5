//! The first piece of a complete arm that a load overloads, with the drives unchanged.

use super::design_space::SpacePiece;
use super::guide::guide_load;
use super::problem::{ArmProblem, Partial};
use super::slot::Slot;
use crate::arm::load::LoadCase;
use crate::catalog::Catalogs;
use crate::sizing::check::{Check, CheckState};
use crate::sizing::checks::{binding, checks};

/// Why a piece of an arm is overloaded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Fails {
    /// Its drive or its output bearing fails this check.
    Check(Check),
    /// Its drive does not hold, and no check of it could be made.
    Drive,
    /// The stress of the link is too high.
    Stress,
    /// The guide of the rail does not hold its load at rest.
    GuideAtRest,
    /// The guide of the rail does not hold its load in an emergency stop of its own travel.
    GuideInStop,
}

impl Fails {
    /// The check that fails, in words.
    pub(crate) fn label(&self) -> &'static str {
        match self {
            Fails::Check(check) => check.kind.label(),
            Fails::Drive => "drive",
            Fails::Stress => "link stress",
            Fails::GuideAtRest => "guide at rest",
            Fails::GuideInStop => "guide in a stop",
        }
    }
}

impl ArmProblem<'_> {
    /// Finds the first piece from the tip that is overloaded in one of `cases`. The arm has these `options`, one for
    /// each slot (piece of the arm, tip first). Drives that the study gives by name are checked too, as far as their
    /// ratings in `catalogs` are known, and so are bearings and guides that the study states; guides come last. Returns
    /// the number of the piece (base to tip) and why it fails. `None` if no piece is overloaded.
    pub(crate) fn overload(
        &self,
        options: &[u32],
        cases: &[usize],
        catalogs: &Catalogs,
    ) -> Option<(usize, Fails)> {
        let mut partial = self.empty();
        for (slot, &option) in options.iter().enumerate() {
            let piece = self.piece_of_slot(slot);
            let Slot::Sized(sized) = &self.slots()[slot] else {
                if let Some(fails) = self.given_overload(cases, &partial, slot, catalogs) {
                    return Some((piece, Fails::Check(fails)));
                }
                let of_tube = self.given_tube_stress(cases, &partial, slot);
                let least = self.space().constraints.stress_safety_factor_min;
                if least.zip(of_tube).is_some_and(|(least, ratio)| ratio * least > 1.0) {
                    return Some((piece, Fails::Stress));
                }
                if !self.add(slot, option, &mut partial) {
                    return Some((piece, Fails::Stress));
                }
                continue;
            };
            let (index, motion) = (option as usize, sized.table.motion());
            let demand = self.demand_in(cases, &partial, slot, Some(motion));
            if !sized.table.holds(index, &demand) {
                let drive = sized.table.drive_or_illegal(index);
                let check = drive.and_then(|drive| binding(&checks(&drive, motion, &demand)).copied());
                return Some((piece, check.map_or(Fails::Drive, Fails::Check)));
            }
            self.add_drive(slot, sized, index, &mut partial);
        }
        self.guide_overload(cases, &partial)
    }

    /// The check with the smallest margin that a given joint fails in some of the cases: of its drive if this comes from
    /// the catalogs, and of the bearing that the study states. `None` if it fails none, or if nothing of it is known. A
    /// check that needs a blank rating is left out.
    fn given_overload(
        &self,
        cases: &[usize],
        outboard: &Partial,
        slot: usize,
        catalogs: &Catalogs,
    ) -> Option<Check> {
        // the slots of effects and bearings have no drive
        self.piece_in_slot(slot)?;
        let fixed = self.fixed_drive(self.piece_of_slot(slot), catalogs);
        let of_drive = fixed.map(|fixed| {
            checks(&fixed.drive, &fixed.motion, &self.fixed_demand_in(cases, outboard, slot, &fixed))
        });
        let of_bearing = self.stated_bearing_checks(cases, outboard, slot, catalogs);
        let mut failed: Vec<Check> = of_drive.into_iter().flatten().collect();
        failed.extend(of_bearing.into_iter().flatten());
        failed.retain(|check| check.state == CheckState::Fails);
        binding(&failed).copied()
    }

    /// The first rail, base to tip, whose guide holds less than its load in one of `cases`, at rest or in an emergency
    /// stop of its own travel. `complete` is the whole arm. A guide of which the study does not state what it holds is
    /// left out.
    fn guide_overload(&self, cases: &[usize], complete: &Partial) -> Option<(usize, Fails)> {
        let rails = self.space().pieces.iter().enumerate().filter_map(|(piece, what)| match what {
            SpacePiece::Prismatic(rail) if rail.joint.guide.limits.is_stated() => Some((piece, rail)),
            _ => None,
        });
        let mut rails = rails.peekable();
        rails.peek()?;
        let arm = self.arm_of(complete)?;
        let space = self.space();
        let loaded: Vec<LoadCase> = cases.iter().map(|&case| space.load_case(&space.cases[case])).collect();
        rails.find_map(|(piece, rail)| {
            let limits = &rail.joint.guide.limits;
            let fails_at = |acceleration_m_s2: f64| {
                loaded.iter().any(|case| {
                    let load = guide_load(&arm, case, &rail.joint.name, acceleration_m_s2);
                    load.and_then(|load| limits.part_used(&load.force_n, &load.moment_nm)) > Some(1.0)
                })
            };
            let stop_m_s2 = rail.stop_m_s2(&space.motion);
            if fails_at(0.0) {
                return Some((piece, Fails::GuideAtRest));
            }
            (fails_at(-stop_m_s2) || fails_at(stop_m_s2)).then_some((piece, Fails::GuideInStop))
        })
    }
}
