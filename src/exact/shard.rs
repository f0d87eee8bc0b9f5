//! Shards of an exact search: subtrees of the space, each searched by itself.
//!
//! The box of all designs is halved, and its halves again, until there are enough boxes. The box with the most designs
//! is halved first, always at its level with the most options. The subtrees thus depend on the space alone, and every
//! process makes the same subtrees. They are dealt to the shards in turn. The name of a subtree lists the halves that
//! lead to it. The names of some subtrees therefore tell whether these subtrees together contain every design exactly
//! once ([`refuse_holes`]).
//!
//! A shard prunes only designs that are infeasible or dominated. The dominating design was found by the shard or given
//! to it, or has a lighter drive and may lie in any subtree (`dominance.rs`). So the findings of all shards together
//! contain every design of the front. Dominated designs are then removed by the same rule as in a search by one
//! process, and the fronts are equal.

use super::bound::DesignBox;
use super::outcome::{ExactOutcome, FoundInShard};
use super::problem::Problem;
use super::run::Exact;
use super::search_state::{Findings, SearchState, nondominated};
use crate::search::sweep::Shard;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Number of subtrees of each shard in a search by boxes. With several small subtrees in each shard, no single shard
/// gets all the hard subtrees.
const SUBTREES_PER_SHARD: usize = 8;
/// Number of subtrees of each shard in a search by regions. It is one, because the search of each subtree goes through
/// all regions.
const SUBTREES_BY_REGIONS: usize = 1;
/// Greatest length of the name of a subtree, which is the number of halvings that lead to it. No space needs as many
/// halvings.
const LONGEST_NAME: usize = 256;

impl<'p> Exact<'p> {
    /// Searches the shard for the front of all designs, or for the front of the designs of one material. `given` are
    /// earlier findings of the same study, from any part of the space. They prune boxes, and the result includes them.
    pub fn found(&self, material_index: Option<usize>, given: &[FoundInShard]) -> FoundInShard {
        let mut state = SearchState::toward(self.only);
        for FoundInShard { decided, undecided, .. } in given {
            state.learn(Findings {
                kept: decided.clone(),
                undecided: undecided.clone(),
                ..Findings::default()
            });
        }
        let live = material_index.is_none().then_some(&self.live);
        self.search_part(self.space_of(material_index).as_ref(), (state, given.is_empty()), live)
    }

    /// The result of a search whose shards have the findings `shards`. Their subtrees must contain every design exactly
    /// once ([`refuse_holes`]).
    pub fn joined(&self, material_index: Option<usize>, shards: &[FoundInShard]) -> ExactOutcome {
        let all = |of: fn(&FoundInShard) -> &Vec<_>| shards.iter().flat_map(of).copied().collect();
        let sum = |of: fn(&FoundInShard) -> u64| shards.iter().map(of).sum();
        let mut undecided: Vec<_> = all(|found| &found.undecided);
        undecided.sort_unstable_by_key(|candidate| candidate.number);
        undecided.dedup_by_key(|candidate| candidate.number);
        let gaps: Option<Vec<f64>> = shards.iter().map(|found| found.gap).collect();
        let found = FoundInShard {
            subtrees: Vec::new(),
            designs_evaluated: sum(|found| found.designs_evaluated),
            boxes: sum(|found| found.boxes),
            boxes_open: sum(|found| found.boxes_open),
            gap: gaps.and_then(|gaps| gaps.into_iter().reduce(f64::max)),
            decided: nondominated(all(|found| &found.decided)),
            undecided,
        };
        self.listed(self.space_of(material_index).as_ref(), found)
    }

    /// The subtrees of this search: their names and boxes.
    pub(super) fn subtrees(&self, whole: &Problem, by_regions: bool) -> (Vec<String>, Vec<DesignBox>) {
        let Shard { number, of } = self.shard;
        let each = if by_regions { SUBTREES_BY_REGIONS } else { SUBTREES_PER_SHARD };
        let most = if self.shard == Shard::WHOLE { 1 } else { of as usize * each };
        let dealt = whole.divided(most).into_iter().skip(number as usize - 1).step_by(of as usize);
        dealt.unzip()
    }
}

impl Problem<'_> {
    /// Disjoint boxes that together contain every design, each with its name and sorted by name. There are at most
    /// `most` of them. The largest box is halved first.
    fn divided(&self, most: usize) -> Vec<(String, DesignBox)> {
        let size = |design_box: &DesignBox| self.members(design_box).to_bits();
        let root = self.root();
        let mut open = BinaryHeap::from([(size(&root), Reverse(String::new()), root)]);
        let mut single = Vec::new();
        while open.len() + single.len() < most {
            let Some((_, Reverse(name), design_box)) = open.pop() else { break };
            let Some(halves) = self.halved(&design_box) else {
                single.push((name, design_box));
                continue;
            };
            open.extend(
                halves
                    .into_iter()
                    .zip(["0", "1"])
                    .map(|(half, end)| (size(&half), Reverse(format!("{name}{end}")), half)),
            );
        }
        single.extend(open.into_iter().map(|(_, Reverse(name), design_box)| (name, design_box)));
        single.sort_unstable();
        single
    }

    /// The halves of a box at its level with the most options. `None` for a box of one design.
    fn halved(&self, design_box: &DesignBox) -> Option<[DesignBox; 2]> {
        let options = |level: &usize| (self.members_at(design_box, *level), Reverse(*level));
        let level = (0..design_box.len()).max_by_key(options)?;
        let halves = self.halves(design_box, level)?;
        Some(halves.map(|half| {
            let mut design_box = design_box.clone();
            design_box[level] = half;
            design_box
        }))
    }
}

/// Checks that some subtrees of one space, given by their names, together contain every design exactly once.
///
/// # Errors
/// A sentence that names a subtree that is missing, that is listed twice, or that lies in another one.
pub fn refuse_holes(mut subtrees: Vec<&str>) -> Result<(), String> {
    subtrees.sort_unstable();
    match subtrees.iter().find(|name| name.len() > LONGEST_NAME) {
        Some(name) => Err(format!("\"{}...\" is no subtree", &name[..8])),
        None => holds_all("", &subtrees),
    }
}

/// Checks that the subtrees `below` together contain every design of the subtree `name` exactly once. They are sorted,
/// and their names begin with `name`.
fn holds_all(name: &str, below: &[&str]) -> Result<(), String> {
    match below {
        [] => Err(format!("subtree \"{name}\" is in none of them")),
        [only] if *only == name => Ok(()),
        [first, ..] if *first == name => {
            Err(format!("the designs of subtree \"{}\" are in two of them", below[1]))
        }
        _ => {
            let zero = format!("{name}0");
            let middle = below.partition_point(|of| of.starts_with(&zero));
            holds_all(&zero, &below[..middle])?;
            holds_all(&format!("{name}1"), &below[middle..])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subtrees_that_lack_designs_or_share_some_are_told() {
        assert_eq!(refuse_holes(vec![""]), Ok(()));
        assert_eq!(refuse_holes(vec!["10", "0", "11"]), Ok(()));
        let fault = |subtrees: &[&str]| refuse_holes(subtrees.to_vec()).expect_err("a fault");
        assert!(fault(&[]).contains("\"\" is in none"));
        assert!(fault(&["0", "11"]).contains("\"10\" is in none"));
        assert!(fault(&["0", "1", "1"]).contains("\"1\" are in two"));
        assert!(fault(&["0", "01", "1"]).contains("\"01\" are in two"));
        assert!(fault(&["0", "x"]).contains("\"1\" is in none") || fault(&["0", "x"]).contains("\"10\""));
    }
}
