//! A design space as a tree: one level for each choice, from the tip to the base.
//!
//! A *row* is the set of designs that differ in one level alone, the *row level*. They share the arm outboard of it and the
//! option of every level inboard of it.

use crate::pareto::objectives::Objectives;

/// A complete design with what a walk keeps of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finished {
    /// The objectives of the design.
    pub objectives: Objectives,
    /// The group (material) of the design; `None` if its links are of several.
    pub group: Option<usize>,
}

/// Takes the designs that a walk through the tree comes to.
pub trait Keep {
    /// Takes a design that holds.
    fn complete(&mut self, number: u128, finished: Finished);

    /// Counts designs that cannot hold.
    fn exclude(&mut self, designs: u128);

    /// The bar \[Hz\]: a design of this group, mass \[kg\] and tip deflection \[m\] with a lowest mode below it is of no
    /// interest and need not be finished. The bar also holds for heavier and softer designs. 0 means that every design
    /// is of interest.
    fn bar_hz(&self, group: Option<usize>, mass_kg: f64, tip_deflection_m: f64) -> f64 {
        let _ = (group, mass_kg, tip_deflection_m);
        0.0
    }

    /// Counts designs that hold and have their lowest modes below the bar.
    fn below_bar(&mut self, designs: u64) {
        let _ = designs;
    }
}

/// A row of designs.
#[derive(Debug, Clone)]
pub struct DesignRow<P> {
    /// The arm outboard of the row level.
    pub from: P,
    /// Number of that arm among those outboard of the row level.
    pub arm: u128,
    /// Option of each level inboard of the row level.
    pub inner: Vec<u32>,
    /// Number of the design with the first option.
    pub first: u128,
    /// Difference between the numbers of neighbours in the row.
    pub step: u128,
}

impl<P> DesignRow<P> {
    /// Whether another row has the same outboard arm and the same options in the first `levels` entries of `inner`.
    pub(crate) fn begins_like(&self, other: &Self, levels: usize) -> bool {
        self.arm == other.arm && self.inner[..levels] == other.inner[..levels]
    }

    /// Number of the design with an option of the row level.
    pub fn number(&self, option: u32) -> u128 {
        self.first + self.step * u128::from(option)
    }
}

/// A tree of designs whose levels go from the tip of the arm to the base.
pub trait OutwardIn: Sync {
    /// A partial arm: everything outboard of the next level.
    type Partial: Clone + Send + Sync;

    /// Number of options at each level, tip first.
    fn level_sizes(&self) -> &[u32];

    /// The empty arm; `None` if no design can hold.
    fn root(&self) -> Option<Self::Partial>;

    /// Writes into `to` the arm `from` with one more option, and with all pieces that follow it without a choice.
    /// Returns `false` if no design with this beginning meets the constraints.
    fn extend(&self, level: usize, option: u32, from: &Self::Partial, to: &mut Self::Partial) -> bool;

    /// The level whose options make a row; the innermost one if nothing speaks for another.
    fn row_level(&self) -> usize {
        self.level_sizes().len().saturating_sub(1)
    }

    /// Finishes one design of a row by itself and shows it to `keep`; `complete` is working space.
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

    /// Objectives of a complete arm; `None` if the arm breaks a constraint.
    fn objectives(&self, complete: &Self::Partial) -> Option<Objectives>;

    /// Number of groups that get a front of their own (materials).
    fn groups(&self) -> usize;

    /// The group of a complete arm; `None` if it belongs to none.
    fn group(&self, complete: &Self::Partial) -> Option<usize>;
}
