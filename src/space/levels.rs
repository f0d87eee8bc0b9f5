//! A design space as a tree: each open choice is one level, in order from the tip to the base.
//!
//! A *row* is the set of designs that differ in one level alone, the *row level*. They have the arm outboard of this
//! level in common, and the option of every level inboard of it.

use crate::pareto::objectives::Objectives;

/// The results of a complete design.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finished {
    /// The objectives of the design.
    pub objectives: Objectives,
    /// The group (material) of the design; `None` if its links are of several materials.
    pub group: Option<usize>,
}

/// Receives the designs that a search evaluates.
pub trait Keep {
    /// Receives a design that meets the limits on its parts.
    fn complete(&mut self, number: u128, finished: Finished);

    /// Counts designs that a limit on a part excludes.
    fn exclude(&mut self, designs: u128);

    /// The bar \[Hz\] for designs of this group, with at least this mass \[kg\] and at least this tip deflection \[m\].
    /// If the lowest mode of such a design is below the bar, the design is of no interest, and its mode need not be
    /// computed. A bar of 0 means that every design is of interest.
    fn bar_hz(&self, group: Option<usize>, mass_kg: f64, tip_deflection_m: f64) -> f64 {
        let _ = (group, mass_kg, tip_deflection_m);
        0.0
    }

    /// Counts designs that meet the limits on their parts, but whose lowest modes are below the bar.
    fn below_bar(&mut self, designs: u64) {
        let _ = designs;
    }
}

/// A row: designs that differ in one level alone.
#[derive(Debug, Clone)]
pub struct DesignRow<P> {
    /// The arm outboard of the row level.
    pub from: P,
    /// Number of the arm `from` among all arms outboard of the row level.
    pub arm: u128,
    /// Option of each level inboard of the row level, in order from the row level to the base.
    pub inner: Vec<u32>,
    /// Number of the design that has the first option of the row level.
    pub first: u128,
    /// Difference between the numbers of two neighbouring designs of the row.
    pub step: u128,
}

impl<P> DesignRow<P> {
    /// Whether this row and the row `other` have the same arm outboard and the same first `levels` entries of `inner`.
    pub(crate) fn begins_like(&self, other: &Self, levels: usize) -> bool {
        self.arm == other.arm && self.inner[..levels] == other.inner[..levels]
    }

    /// Number of the design with this option of the row level.
    pub fn number(&self, option: u32) -> u128 {
        self.first + self.step * u128::from(option)
    }
}

/// A tree of designs whose levels go from the tip of the arm to the base.
pub trait OutwardIn: Sync {
    /// A partial arm: everything outboard of the next level to be chosen.
    type Partial: Clone + Send + Sync;

    /// Number of options at each level, tip first.
    fn level_sizes(&self) -> &[u32];

    /// The arm before any choice; `None` if no design can meet the limits.
    fn root(&self) -> Option<Self::Partial>;

    /// Writes into `to` the arm `from` after option `option` was chosen at `level`, and after all given pieces up to
    /// the next level were added. Returns `false` if no design that begins in this way meets the limits.
    fn extend(&self, level: usize, option: u32, from: &Self::Partial, to: &mut Self::Partial) -> bool;

    /// Index of the level whose options form a row, counted from the tip. By default it is the innermost level.
    fn row_level(&self) -> usize {
        self.level_sizes().len().saturating_sub(1)
    }

    /// Evaluates the design of `row` with the option `option` of the row level and reports it to `keep`. `complete` is
    /// working space for one arm.
    fn finish_one(
        &self,
        row: &DesignRow<Self::Partial>,
        option: u32,
        complete: &mut Self::Partial,
        keep: &mut dyn Keep,
    ) {
        let level = self.row_level();
        let mut holds = self.extend(level, option, &row.from, complete);
        for (inner, &option) in (level + 1..).zip(&row.inner) {
            holds = holds && self.extend(inner, option, &complete.clone(), complete);
        }
        match if holds { self.objectives(complete) } else { None } {
            Some(objectives) => {
                let group = self.group(complete);
                keep.complete(row.number(option), Finished { objectives, group });
            }
            None => keep.exclude(1),
        }
    }

    /// Objectives of a complete arm; `None` if the arm breaks a limit.
    fn objectives(&self, complete: &Self::Partial) -> Option<Objectives>;

    /// Number of groups (materials) that get a front of their own.
    fn groups(&self) -> usize;

    /// The group of a complete arm; `None` if it belongs to no group.
    fn group(&self, complete: &Self::Partial) -> Option<usize>;
}
