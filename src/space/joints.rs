//! The joints of a space with the drives of the catalogs tabulated.
//!
//! Neither the limits of a study nor the sections of its links change which drives a joint may have. Most of the time
//! in which a small problem is made goes into these tables, so all problems that are made from one study share them.

use super::design_space::{DesignSpace, SpacePiece};
use super::slot::{Slot, joint_slot, rail_slot};
use super::station::reaches_m;
use crate::catalog::Catalogs;
use std::sync::Arc;

/// One entry for each piece of a space, base to tip: the slot (place in the arm, counted from the tip) of a joint, with
/// the table of its drives; `None` for a link.
#[derive(Clone)]
pub(crate) struct TabulatedJoints<'c>(Arc<[Option<Slot<'c>>]>);

impl<'c> TabulatedJoints<'c> {
    /// Tabulates the drives of every joint.
    pub(crate) fn new(space: &'c DesignSpace, catalogs: &'c Catalogs) -> Self {
        let sizing = space.sizing_cases.iter().map(|&i| &space.cases[i]);
        let mut reaches_m = reaches_m(space, sizing).into_iter();
        let slot = |piece: &'c SpacePiece| match piece {
            SpacePiece::Joint(joint) => {
                Some(joint_slot(space, joint, reaches_m.next().unwrap_or_default(), catalogs))
            }
            SpacePiece::Prismatic(slide) => Some(rail_slot(space, slide, catalogs)),
            SpacePiece::Link(_) | SpacePiece::Choice(_) => None,
        };
        Self(space.pieces.iter().map(slot).collect())
    }

    /// The slot of the joint that is piece number `piece`, base to tip; `None` if this piece is a link.
    pub(crate) fn get(&self, piece: usize) -> Option<&Slot<'c>> {
        self.0.get(piece)?.as_ref()
    }

    /// A new slot for the joint that is piece number `piece`. It shares the table of drives with the slot that
    /// [`get`](Self::get) returns.
    pub(crate) fn slot(&self, piece: usize) -> Option<Slot<'c>> {
        match self.get(piece)? {
            Slot::Given { law, mass_kg } => Some(Slot::Given { law: *law, mass_kg: *mass_kg }),
            Slot::Sized(sized) => Some(Slot::Sized(Arc::clone(sized))),
            Slot::Bearing { .. } | Slot::Motor { .. } | Slot::Link { .. } | Slot::Offset { .. } => None,
        }
    }
}
