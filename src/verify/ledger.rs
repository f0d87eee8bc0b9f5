//! The finished branches of a search, so that a later process need not search them again.
//!
//! The search divides its boxes (sets of designs) and regions (designs below a mass, below a deflection and above a
//! frequency) into halves. A branch is one such half with everything into which it is divided further. It is named by
//! the halves that lead to it. The result of a branch does not depend on the other branches. So a search that is
//! continued has the same result as one that was never stopped.

use super::halt::{Found, Halt};
use super::parts_box::Design;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Greatest number of halvings after which a branch is still recorded by itself. A deeper branch is recorded only as a
/// part of the branch that contains it.
const MOST_HALVINGS: u32 = 16;

/// A function that saves the state of a search, if a save is due. It gets a function that makes the state, and calls it
/// only in this case.
pub type Keep<'s> = dyn Fn(&dyn Fn() -> Vec<u8>) + Sync + 's;

/// The finished branches of a search. By default there are none, and no state is saved.
#[derive(Default)]
pub struct Ledger<'s> {
    keep: Option<&'s Keep<'s>>,
    done: Mutex<Done>,
    /// Locked by the thread that saves a state, so that two threads do not save at the same time.
    keeping: Mutex<()>,
}

/// The state that is saved: the number of boxes that were bounded in each finished branch, and the single designs found
/// so far.
#[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
struct Done {
    boxes: BTreeMap<u32, u64>,
    designs: BTreeSet<Design>,
}

/// A branch: the digits of this number in base 2, after the leading one, are the halves that lead to it. Zero stands
/// for a branch that is not recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Branch(u32);

impl Branch {
    pub(super) const ROOT: Self = Self(1);
    pub(super) const DEEP: Self = Self(0);

    /// The two halves of this branch.
    pub(super) fn halves(self) -> [Self; 2] {
        match self.0 {
            0 => [Self::DEEP; 2],
            deep if deep >> MOST_HALVINGS > 0 => [Self::DEEP; 2],
            name => [Self(2 * name), Self(2 * name + 1)],
        }
    }
}

impl<'s> Ledger<'s> {
    /// Goes on from the state that an earlier process saved, if there is one.
    ///
    /// # Errors
    /// A message if the bytes are not a saved state.
    pub fn resumed(from: Option<&[u8]>, keep: &'s Keep<'s>) -> Result<Self, String> {
        let done = from.map(postcard::from_bytes).transpose().map_err(|e| e.to_string())?;
        let done = Mutex::new(done.unwrap_or_default());
        Ok(Self { keep: Some(keep), done, keeping: Mutex::default() })
    }

    fn done(&self) -> MutexGuard<'_, Done> {
        self.done.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The single designs that an earlier process found.
    pub(super) fn designs(&self) -> BTreeSet<Design> {
        self.done().designs.clone()
    }

    /// The numbers of boxes that were bounded and left open in a branch. If the branch is not finished already,
    /// `explore` searches it now. A branch that is then finished is recorded, and the state is saved if a save is due.
    pub(super) fn of(&self, branch: Branch, halt: &Halt, explore: impl FnOnce() -> Found) -> Found {
        let Some(keep) = self.keep.filter(|_| branch != Branch::DEEP) else { return explore() };
        if let Some(&boxes) = self.done().boxes.get(&branch.0) {
            return Found { boxes, open: 0 };
        }
        let found = explore();
        // A search that ended early may not have searched the whole branch, so the branch is not recorded as finished.
        if found.open == 0 && !halt.stopped() {
            let mut done = self.done();
            for half in branch.halves() {
                done.boxes.remove(&half.0);
            }
            done.boxes.insert(branch.0, found.boxes);
            drop(done);
            if let Ok(_alone) = self.keeping.try_lock() {
                keep(&|| self.bytes(halt));
            }
        }
        found
    }

    /// The bytes of the state. The finished branches are read first and the designs after them, so that the designs
    /// found in every finished branch are included.
    fn bytes(&self, halt: &Halt) -> Vec<u8> {
        let boxes = self.done().boxes.clone();
        let designs = halt.designs.lock().unwrap_or_else(PoisonError::into_inner).clone();
        postcard::to_stdvec(&Done { boxes, designs }).expect("numbers can be written to memory")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::AtomicBool;

    #[test]
    fn branches_have_names_of_their_own_down_to_a_depth() {
        let mut level = vec![Branch::ROOT];
        let mut all = BTreeSet::new();
        for _ in 0..=MOST_HALVINGS {
            all.extend(level.iter().map(|branch| branch.0));
            level = level.into_iter().flat_map(Branch::halves).collect();
        }
        assert_eq!(all.len(), (1 << (MOST_HALVINGS + 1)) - 1);
        assert!(level.iter().all(|branch| *branch == Branch::DEEP));
    }

    #[test]
    fn a_branch_that_is_done_is_not_explored_again_and_one_that_was_stopped_is() {
        let stop = AtomicBool::new(false);
        let halt =
            Halt { stop: &stop, deadline: None, designs: Default::default(), count: Default::default() };
        let kept = Mutex::new(Vec::new());
        let keep = |state: &dyn Fn() -> Vec<u8>| *kept.lock().expect("alone") = state();
        let keep: &Keep = &keep;
        let [a, b] = Branch::ROOT.halves();
        let ledger = Ledger::resumed(None, keep).expect("nothing");
        assert_eq!(ledger.of(a, &halt, || Found { boxes: 7, open: 0 }).boxes, 7);
        assert_eq!(ledger.of(b, &halt, || Found { boxes: 1, open: 1 }).open, 1);
        let state = kept.lock().expect("alone").clone();
        let again = Ledger::resumed(Some(&state), keep).expect("a state");
        assert_eq!(again.of(a, &halt, || panic!("explored again")).boxes, 7);
        assert_eq!(again.of(b, &halt, || Found { boxes: 9, open: 0 }).boxes, 9);
        assert!(Ledger::resumed(Some(&state[..1]), keep).is_err(), "a torn state");
    }
}
