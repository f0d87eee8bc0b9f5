//! Staircase: the points that can still dominate others while a sweep moves along the first of three objectives.
//!
//! Points are taken in the order of their first objective. Of the points taken so far, only the points matter that no
//! other point dominates in the second and third objective. They form a staircase: the larger the second objective,
//! the smaller the third.
//!
//! All values of the second objective are known in advance, so a step is addressed by the rank of its second
//! objective. The steps are then a set of small integers, stored as bits: 64 ranks in a word, and one bit for each
//! word in the level above. Finding a neighbour or changing a step takes one word in each level. Together with
//! the two sorts that precede it, a sweep takes O(n log n) time (Kung, Luccio & Preparata 1975).

/// The steps of the staircase: ranks of the second objective, each with the third objective of its point.
pub(crate) struct Staircase {
    steps: RankSet,
    third: Vec<f64>,
}

impl Staircase {
    /// A staircase without steps, for a number of ranks.
    pub(crate) fn new(ranks: usize) -> Self {
        Self { steps: RankSet::new(ranks), third: vec![0.0; ranks] }
    }

    /// Smallest third objective among the points whose rank is at most `rank`; `None` if there is no such point.
    pub(crate) fn best(&self, rank: u32) -> Option<f64> {
        self.steps.at_or_below(rank).map(|step| self.third[step as usize])
    }

    /// Whether some point of the staircase is at least as good as a point with this rank of the second objective and
    /// this third objective.
    pub(crate) fn covers(&self, rank: u32, third: f64) -> bool {
        self.best(rank).is_some_and(|best| best <= third)
    }

    /// Adds a step that no other step covers, and removes the steps that it covers. The steps with larger ranks are
    /// examined in ascending order. `see` is called with the rank and the third objective of each step that is removed,
    /// and of the first step that stays.
    pub(crate) fn insert(&mut self, rank: u32, third: f64, mut see: impl FnMut(u32, f64)) {
        self.steps.insert(rank);
        self.third[rank as usize] = third;
        while let Some(next) = self.steps.above(rank) {
            see(next, self.third[next as usize]);
            if self.third[next as usize] < third {
                return;
            }
            self.steps.remove(next);
        }
    }
}

/// A set of integers from zero to below a bound. It finds the member nearest to a number.
struct RankSet {
    /// Bits, level by level. The first level has one bit for each possible member, every further level one bit for
    /// each word of the level before that is not empty.
    levels: Vec<Vec<u64>>,
}

impl RankSet {
    fn new(bound: usize) -> Self {
        let mut levels = vec![vec![0; bound.div_ceil(64).max(1)]];
        while levels[levels.len() - 1].len() > 1 {
            let words = levels[levels.len() - 1].len().div_ceil(64);
            levels.push(vec![0; words]);
        }
        Self { levels }
    }

    fn insert(&mut self, member: u32) {
        let mut place = member as usize;
        for level in &mut self.levels {
            level[place / 64] |= 1 << (place % 64);
            place /= 64;
        }
    }

    fn remove(&mut self, member: u32) {
        let mut place = member as usize;
        for level in &mut self.levels {
            level[place / 64] &= !(1 << (place % 64));
            if level[place / 64] != 0 {
                return;
            }
            place /= 64;
        }
    }

    /// The largest member that is at most `number`; `None` if there is none.
    fn at_or_below(&self, number: u32) -> Option<u32> {
        let mut place = number as usize;
        // The lowest level includes the number itself. The levels above include only words before the word of the
        // number.
        let mut kept = u64::MAX >> (63 - place % 64);
        for (height, level) in self.levels.iter().enumerate() {
            let word = level[place / 64] & kept;
            if word != 0 {
                let top = place / 64 * 64 + (63 - word.leading_zeros() as usize);
                return Some(self.descend(height, top, |word| 63 - word.leading_zeros() as usize));
            }
            place /= 64;
            kept = (1 << (place % 64)) - 1;
        }
        None
    }

    /// The smallest member above `number`; `None` if there is none.
    fn above(&self, number: u32) -> Option<u32> {
        let mut place = number as usize;
        for (height, level) in self.levels.iter().enumerate() {
            let word = level[place / 64] & (u64::MAX << (place % 64)) & !(1 << (place % 64));
            if word != 0 {
                let top = place / 64 * 64 + word.trailing_zeros() as usize;
                return Some(self.descend(height, top, |word| word.trailing_zeros() as usize));
            }
            place /= 64;
        }
        None
    }

    /// Descends from the bit with index `place` in the level `height` to one of the members that this bit stands for.
    /// `bit` selects one of the bits of a word, for example the highest.
    fn descend(&self, height: usize, mut place: usize, bit: impl Fn(u64) -> usize) -> u32 {
        for level in self.levels[..height].iter().rev() {
            place = place * 64 + bit(level[place]);
        }
        place as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    proptest! {
        #[test]
        fn the_set_of_ranks_is_a_set(
            bound in 1u32..300_000,
            changes in prop::collection::vec((any::<bool>(), any::<u32>()), 1..200),
        ) {
            let mut ours = RankSet::new(bound as usize);
            let mut plain = BTreeSet::new();
            for (adds, number) in changes {
                let number = number % bound;
                match adds {
                    true => { ours.insert(number); plain.insert(number); }
                    false if plain.remove(&number) => ours.remove(number),
                    false => {}
                }
                for probe in [number, number / 2, bound - 1, 0] {
                    prop_assert_eq!(ours.at_or_below(probe), plain.range(..=probe).next_back().copied());
                    prop_assert_eq!(ours.above(probe), plain.range(probe + 1..).next().copied());
                }
            }
        }
    }
}
