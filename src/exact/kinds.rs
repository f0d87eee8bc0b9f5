//! Drives that no objective tells apart.
//!
//! Deflection, mass and modes see a drive's mass and torsion curve and nothing else, and gears of one size have the same
//! curve for several ratios, and in several series. So the drives of one mass and one curve are a **kind**: one option of
//! the search, which holds what any of its drives holds. A design of kinds stands for all designs whose joints have drives
//! of these kinds, each able to hold what its joint is asked for. That depends on the masses outboard alone, which are the
//! same for all of them: every joint may choose whatever the others choose.

use crate::space::slot::SizedJoint;

/// Whether drives of a kind are one option of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ties {
    Merged,
    Separate,
}

/// The drives of a joint by kinds, ascending; the first of each is the kind's number.
pub(super) struct Kinds(Vec<Vec<u32>>);

impl Kinds {
    pub fn of(sized: &SizedJoint, ties: Ties) -> Self {
        Self(match ties {
            Ties::Merged => sized.kinds(),
            Ties::Separate => (0..sized.table.len() as u32).map(|drive| vec![drive]).collect(),
        })
    }

    pub fn iter(&self) -> impl Iterator<Item = &[u32]> {
        self.0.iter().map(Vec::as_slice)
    }

    /// The drives of a kind.
    pub fn drives(&self, first: u32) -> &[u32] {
        self.0.binary_search_by_key(&first, |kind| kind[0]).map_or(&[], |at| &self.0[at])
    }

    /// The drives of some kinds, ascending.
    pub fn drives_of(&self, firsts: &[u32]) -> Vec<u32> {
        let mut drives: Vec<u32> = firsts.iter().flat_map(|first| self.drives(*first)).copied().collect();
        drives.sort_unstable();
        drives
    }
}
