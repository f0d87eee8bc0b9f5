//! The options that a design may have if it is as good as a known design in all three objectives.
//!
//! In a space that is too large to tabulate these options are few, so the relaxation (`src/relax`), a linear program
//! over mixtures of parts, can be solved with them alone.
//!
//! A subproblem is the problem with only some of its options. It is first reduced: options that no design below the
//! known design's objectives can have are excluded. Then it may be branched, which divides it into two subproblems.

use super::box_work::BoxWork;
use super::kinds::Ties;
use super::local_upper_bounds::{LocalUpperBound, LocalUpperBounds};
use super::problem::Problem;
use super::region_bound::Survivors;
use super::regions::Subproblem;
use crate::catalog::Catalogs;
use crate::pareto::objectives::Objectives;
use crate::space::design_space::DesignSpace;
use std::collections::BTreeSet;

/// The search looks for designs below the known design's objectives after these were made worse by this fraction. With
/// this margin, rounding excludes no part of the known design itself.
const OBJECTIVE_MARGIN: f64 = 1e-6;
/// Greatest number of subproblems that are branched. A subproblem of at most [`SMALL_SPACE`] designs is not branched,
/// because that is not worth the time.
const MOST_BRANCHED: usize = 50;
const SMALL_SPACE: f64 = 1e6;

/// A compiled design space that tells which parts can belong to a design as good as a known design.
pub struct DomainReduction<'p> {
    problem: Problem<'p>,
}

impl<'p> DomainReduction<'p> {
    /// Compiles a space. `None` if some level (choice of a part) has no option, or if this search cannot treat a piece
    /// of the arm.
    pub fn new(space: &'p DesignSpace, catalogs: &'p Catalogs) -> Option<Self> {
        Some(Self { problem: Problem::new(space, catalogs, &|_| true, Ties::Merged)? })
    }

    /// For each level, tip first, the numbers of the options that a design may have if it is no worse than a known
    /// design in all three objectives, ascending. `None` if no design is that good, not even the known one.
    pub fn options_as_good(&self, known: &Objectives) -> Option<Vec<Vec<u32>>> {
        let upper = LocalUpperBound {
            mass_kg: known.mass_kg * (1.0 + OBJECTIVE_MARGIN),
            tip_m: known.tip_deflection_m * (1.0 + OBJECTIVE_MARGIN),
            hz: known.lowest_mode_hz * (1.0 - OBJECTIVE_MARGIN),
        };
        let mut work = BoxWork::default();
        let whole = Subproblem::whole(&self.problem, 0, &mut work)?;
        let mut open = Vec::from_iter(Reduced::new(whole, &upper, &mut work));
        let mut closed = Vec::new();
        for _ in 0..MOST_BRANCHED {
            let largest = (0..open.len()).max_by(|&a, &b| open[a].designs.total_cmp(&open[b].designs));
            // The largest subproblem contributes most options, so branching it helps most.
            let Some(at) = largest.filter(|&at| open[at].designs > SMALL_SPACE) else { break };
            let next = open.swap_remove(at);
            match next.subproblem.branch(&next.survivors, &mut work) {
                Some(halves) => {
                    open.extend(halves.into_iter().filter_map(|half| Reduced::new(half, &upper, &mut work)));
                }
                None => closed.push(next),
            }
        }
        open.append(&mut closed);
        let mut options = vec![BTreeSet::new(); self.problem.level_sizes.len()];
        for reduced in &open {
            let below = self.problem.options_below(&reduced.survivors.options);
            options.iter_mut().zip(below).for_each(|(all, some)| all.extend(some));
        }
        (!open.is_empty()).then(|| options.into_iter().map(Vec::from_iter).collect())
    }
}

/// A subproblem whose options have been excluded as far as that is worth the time. `survivors` are the options that
/// remain, and `designs` is the number of designs that they make.
struct Reduced<'p> {
    subproblem: Subproblem<'p>,
    survivors: Survivors,
    designs: f64,
}

impl<'p> Reduced<'p> {
    /// Excludes the options of a subproblem that no design below the local upper bound `upper` can have. `None` if no
    /// design lies below it.
    fn new(mut subproblem: Subproblem<'p>, upper: &LocalUpperBound, work: &mut BoxWork) -> Option<Self> {
        let mut below = LocalUpperBounds::single(*upper);
        loop {
            let (survivors, reduced) = subproblem.reduce(&mut below, work, |_| false)?;
            if !reduced {
                let designs = subproblem.designs_of(&survivors);
                return Some(Self { subproblem, survivors, designs });
            }
        }
    }
}
