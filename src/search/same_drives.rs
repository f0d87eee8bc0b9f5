//! Lighter arms with the same drives as a design.
//!
//! With first fit, every joint gets the lightest drive that meets the demand. A lighter link may then lead to a
//! smaller and softer drive inboard. A design with a heavy link can therefore be on a front only because the heavy
//! link made the drive larger. It is recognized by an arm with the same drives at the joints sized by first fit that
//! is lighter, deflects no more and has as high a lowest mode. This arm is not a design of the study, because first
//! fit would give it smaller drives.

use crate::pareto::objectives::Objectives;
use crate::space::levels::OutwardIn;
use crate::space::problem::{ArmProblem, Partial};
use crate::space::slot::Slot;

/// An arm that is lighter than a design and has the same drives at the joints sized by first fit.
pub struct OnSameDrives {
    /// Pieces whose parts differ from the parts of the design, numbered from the base to the tip.
    pub exchanged: Vec<usize>,
    /// Joints at which first fit would take a smaller drive in the lighter arm, as numbers of pieces from the base to
    /// the tip.
    pub oversized: Vec<usize>,
    /// The lighter arm.
    pub(crate) arm: Partial,
}

impl ArmProblem<'_> {
    /// An arm that is lighter than the design with the options `options`, has the same drives at the joints sized by
    /// first fit, and is no worse in deflection and lowest mode. Parts are exchanged one at a time, each time in the
    /// way that gives the lightest arm. There may be a still lighter arm that this search does not find. `None` if no
    /// joint is sized by first fit, if no exchange helps, or if first fit would give the lighter arm the same drives.
    pub fn lighter_on_same_drives(&self, options: &[u32]) -> Option<OnSameDrives> {
        let design = self.walk(options, |_, _| {}).ok()?;
        let first_fit = |slot: &Slot| matches!(slot, Slot::Sized(sized) if !sized.all_fits);
        if !self.slots().iter().any(first_fit) {
            return None;
        }
        let judged = self.objectives(&design)?;
        let mut arm = design.clone();
        while let Some(lighter) = self.lightest_exchange(&arm, &judged) {
            arm = lighter;
        }
        let exchanged = self.pieces_where(&arm, &design);
        if exchanged.is_empty() {
            return None;
        }
        let levels: Vec<u32> = self.level_slots().iter().map(|&slot| arm.options[slot]).collect();
        let sized_anew = self.walk(&levels, |_, _| {}).ok()?;
        let oversized = self.pieces_where(&sized_anew, &arm);
        // If first fit gives the lighter arm the same drives, this arm is a design of the study. Only an unfinished
        // search can have failed to list it.
        (!oversized.is_empty()).then_some(OnSameDrives { exchanged, oversized, arm })
    }

    /// The lightest arm that differs from `arm` in one part, weighs less than `arm`, and is no worse than the
    /// objectives `judged` in deflection and lowest mode. `None` if there is no such arm.
    fn lightest_exchange(&self, arm: &Partial, judged: &Objectives) -> Option<Partial> {
        let sizes = self.level_slots().iter().zip(self.level_sizes());
        let exchanges = sizes.flat_map(|(&slot, &size)| (0..size).map(move |option| (slot, option)));
        let others = exchanges.filter_map(|(slot, option)| {
            let mut options = arm.options.clone();
            options[slot] = option;
            let other = self.assemble(&options)?;
            let is_lighter = other.mass_kg < arm.mass_kg;
            (is_lighter && no_worse(&self.objectives(&other)?, judged)).then_some(other)
        });
        others.min_by(|a, b| a.mass_kg.total_cmp(&b.mass_kg))
    }

    /// Numbers of the pieces (base to tip) at which two arms have different parts.
    fn pieces_where(&self, a: &Partial, b: &Partial) -> Vec<usize> {
        let pieces = self.options(a).zip(self.options(b)).enumerate();
        pieces.filter(|(_, (a, b))| a != b).map(|(piece, _)| piece).collect()
    }
}

/// Whether `arm` is no worse than `than` in deflection and lowest mode. The mass is not compared.
fn no_worse(arm: &Objectives, than: &Objectives) -> bool {
    arm.tip_deflection_m <= than.tip_deflection_m && arm.lowest_mode_hz >= than.lowest_mode_hz
}
