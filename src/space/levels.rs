//! A design space as a tree: levels from the tip inward, one option at each.

use crate::pareto::objectives::Objectives;

/// A design finished.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finished {
    /// Its objectives.
    pub objectives: Objectives,
    /// The group it belongs to, if it belongs to one.
    pub group: Option<usize>,
}

/// What becomes of the designs that a walk comes to.
pub trait Keep {
    /// A design that holds.
    fn complete(&mut self, number: u128, finished: Finished);

    /// So many designs cannot hold.
    fn exclude(&mut self, designs: u128);

    /// The lowest mode \[Hz\] below which a design of a group, with this mass and tip deflection, need not be
    /// finished; 0 if every design is of interest. It serves for heavier and softer ones too.
    fn bar_hz(&self, group: Option<usize>, mass_kg: f64, tip_deflection_m: f64) -> f64 {
        let _ = (group, mass_kg, tip_deflection_m);
        0.0
    }

    /// So many designs hold, and their lowest modes are below the bar.
    fn below_bar(&mut self, designs: u64) {
        let _ = designs;
    }
}

/// A tree of designs whose levels go from the tip of the arm inward.
pub trait OutwardIn: Sync {
    /// A partial arm: everything outboard of the next level.
    type Partial: Clone + Send + Sync;

    /// Number of options at each level, tip first.
    fn level_sizes(&self) -> &[u32];

    /// The empty arm; `None` if no design can hold.
    fn root(&self) -> Option<Self::Partial>;

    /// Extends `from` by an option of a level and by all that follows without a choice, into `to`.
    /// `false` if no design with this beginning meets the constraints.
    fn extend(&self, level: usize, option: u32, from: &Self::Partial, to: &mut Self::Partial) -> bool;

    /// Finishes one design by itself, in `complete`.
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

    /// Objectives of a complete arm; `None` if it breaks a constraint.
    fn objectives(&self, complete: &Self::Partial) -> Option<Objectives>;

    /// Number of groups that get a front of their own (materials).
    fn groups(&self) -> usize;

    /// The group a complete arm belongs to, if it belongs to one.
    fn group(&self, complete: &Self::Partial) -> Option<usize>;
}
