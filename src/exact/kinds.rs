//! Sets of drives with the same effect on all objectives.
//!
//! Deflection, mass and modes depend on a drive only through its mass, its torsion curve and the tilt of its bearing.
//! Gears of one size have the same curve and tilt for several ratios and in several series. So the drives of one mass,
//! one curve and one tilt form a **kind**, which is a single option of the search. A kind can carry a demand if any of
//! its drives can.
//!
//! A design of kinds stands for all designs whose joints have drives of these kinds, if each drive can carry the demand
//! on its joint. The demand depends only on the masses outboard. They are the same for all drives of a kind, so the
//! drive of each joint can be chosen independently.

use crate::space::slot::SizedJoint;

/// Whether the drives of one kind (tied drives) are a single option of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ties {
    /// All drives of a kind are one option.
    Merged,
    /// Every drive is an option, whatever its kind is.
    Separate,
}

/// The drives of a joint, grouped by kind. Drives and kinds are in ascending order. The number of the first drive of a
/// kind is also the number of the kind.
pub(super) struct Kinds(Vec<Vec<u32>>);

impl Kinds {
    /// Groups the drives of a joint into kinds. `ties` tells whether drives of equal mass, curve and tilt form one
    /// kind, or each drive a kind of its own.
    pub(super) fn of(sized: &SizedJoint, ties: Ties) -> Self {
        Self(match ties {
            Ties::Merged => sized.kinds(),
            Ties::Separate => (0..sized.table.len() as u32).map(|drive| vec![drive]).collect(),
        })
    }

    /// For each kind, the numbers of its drives.
    pub(super) fn iter(&self) -> impl Iterator<Item = &[u32]> {
        self.0.iter().map(Vec::as_slice)
    }

    /// The drives of the kind with this number; empty if there is no such kind.
    pub(super) fn drives(&self, first: u32) -> &[u32] {
        self.0.binary_search_by_key(&first, |kind| kind[0]).map_or(&[], |at| &self.0[at])
    }

    /// The drives of the kinds with the numbers `firsts`, ascending.
    pub(super) fn drives_of(&self, firsts: &[u32]) -> Vec<u32> {
        let mut drives: Vec<u32> = firsts.iter().flat_map(|first| self.drives(*first)).copied().collect();
        drives.sort_unstable();
        drives
    }
}
