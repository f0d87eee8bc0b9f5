//! A design space as a tree: one level for each choice, from the tip to the base.

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

    /// Finishes one design by itself and shows it to `keep`. `first` is the number of the design with option 0;
    /// `complete` is working space.
    fn finish_one(
        &self,
        level: usize,
        option: u32,
        from: &Self::Partial,
        first: u128,
        complete: &mut Self::Partial,
        keep: &mut dyn Keep,
    ) {
        let holds = self.extend(level, option, from, complete);
        match if holds { self.objectives(complete) } else { None } {
            Some(objectives) => {
                let group = self.group(complete);
                keep.complete(first + u128::from(option), Finished { objectives, group });
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
