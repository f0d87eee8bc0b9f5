//! Drives that no objective distinguishes.
//!
//! Deflection, mass and modes depend on a drive only through its mass, its torsion curve and the tilt of its bearing.
//! Gears of one size have the same curve and tilt for several ratios and in several series. So the drives of one mass,
//! one curve and one tilt form a **kind**, which is a single option of the search. A kind can carry a demand if any of
//! its drives can.
//!
//! A design of kinds stands for every design whose joints have drives of these kinds, each able to carry its
//! joint's demand. The demand depends only on the masses outboard, which are the same for all of them, so
//! each joint chooses its drive independently of the others.

use crate::space::slot::SizedJoint;

/// Whether tied drives, which are the drives of one kind, are one option of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ties {
    /// One option for each kind.
    Merged,
    /// One option for each drive.
    Separate,
}

/// The drives of a joint, kind by kind, in ascending order. The first drive of a kind gives the kind its number.
pub(super) struct Kinds(Vec<Vec<u32>>);

impl Kinds {
    /// The kinds of a joint's drives.
    pub(super) fn of(sized: &SizedJoint, ties: Ties) -> Self {
        Self(match ties {
            Ties::Merged => sized.kinds(),
            Ties::Separate => (0..sized.table.len() as u32).map(|drive| vec![drive]).collect(),
        })
    }

    /// The drives of each kind.
    pub(super) fn iter(&self) -> impl Iterator<Item = &[u32]> {
        self.0.iter().map(Vec::as_slice)
    }

    /// The drives of the kind with this number.
    pub(super) fn drives(&self, first: u32) -> &[u32] {
        self.0.binary_search_by_key(&first, |kind| kind[0]).map_or(&[], |at| &self.0[at])
    }

    /// The drives of some kinds, ascending.
    pub(super) fn drives_of(&self, firsts: &[u32]) -> Vec<u32> {
        let mut drives: Vec<u32> = firsts.iter().flat_map(|first| self.drives(*first)).copied().collect();
        drives.sort_unstable();
        drives
    }
}
