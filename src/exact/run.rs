//! Branch and bound: cut, halve, judge. First with slack, so that little is left open if time runs out; in rounds, so
//! that it does not matter who is quicker.

use super::boxes::pass_by_boxes;
use super::budget::Budget;
use super::evolve::evolve;
use super::gap::gap;
use super::kinds::Ties;
use super::probe::probe;
use super::problem::Problem;
use super::regions::pass_by_regions;
use super::search_state::SearchState;
use crate::catalog::Catalogs;
use crate::pareto::objectives::Objectives;
use crate::search::sweep::Candidate;
use crate::space::design_space::{DesignSpace, LinkOption};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// Slacks of the passes over a large space: with slack a box is also cut if a design found comes that close
/// to its ceiling, so a pass that comes to its end proves that nothing is missing by more.
const SLACKS: [f64; 25] = [
    1.0, 0.7, 0.5, 0.42, 0.35, 0.3, 0.25, 0.2, 0.16, 0.12, 0.09, 0.075, 0.06, 0.05, 0.04, 0.035, 0.03, 0.025,
    0.02, 0.015, 0.01, 0.007, 0.005, 0.0035, 0.0025,
];
/// Slacks below this are for regions alone: boxes find as much on the way.
const FINE: f64 = 0.02;
/// Slacks are passed over, at most so many at once, where a pass should take less than this part of the time left; if a gap
/// was asked for so many whatever it takes.
const MOST_PASSED_OVER: usize = 4;
const PASSED_OVER_TO_A_GAP: usize = 8;
const QUICK: f64 = 0.65;
/// The time of a pass goes as this power of one over the slack, about.
const GROWTH: f64 = 2.5;
/// Designs above which a space is large.
const LARGE: f64 = 1e9;
/// Designs above which a space is searched region by region.
pub const VAST: f64 = 1e14;
/// Designs that are sooner searched box by box than narrowed to regions.
const FEW: f64 = 1e6;
/// Probes by the square of the powers of ten of designs: a large space repays many, a small one none.
const PROBES: f64 = 0.12;
/// The same where others evolve from what they find.
const PROBES_TO_EVOLVE: f64 = 0.04;
/// Designs that are listed with all their ties at the most, unless it is said otherwise.
const MOST_WITH_TIES: usize = 20_000;

/// A search for the exact front that others can watch and stop.
pub struct Exact<'p> {
    space: &'p DesignSpace,
    catalogs: &'p Catalogs,
    pub(super) budget: Budget<'p>,
    /// The slack with which the search is content: that of the last pass, or of a search from known designs.
    gap: f64,
    /// Designs above which a space is searched region by region, and down to how many.
    regions_from: f64,
    regions_to: f64,
    /// Designs that are listed with all their ties at the most.
    most_with_ties: usize,
}

/// What the search found.
#[derive(Debug, Clone, PartialEq)]
pub struct ExactOutcome {
    /// Designs in the space.
    pub designs_total: u128,
    /// Designs whose three objectives were computed.
    pub designs_evaluated: u64,
    /// Boxes bounded.
    pub boxes: u64,
    /// Boxes left unopened because the search was stopped; none if the front is certified.
    pub boxes_open: u64,
    /// By what factor, at most, a design in an open box may be better than a design of the front in every
    /// objective at once; if no box is open what was asked for, 0 for the whole front; `None` if nothing can be
    /// said.
    pub gap: Option<f64>,
    /// Designs that no other one found beats.
    pub front: Vec<Candidate>,
    /// Whether designs that differ only in drives of equal mass and curve are all in it; if they would be too many, one of
    /// them is.
    pub ties_listed: bool,
}

impl<'p> Exact<'p> {
    /// A search of a space; it ends early when `stop` is set or the deadline has passed.
    pub fn new(
        space: &'p DesignSpace,
        catalogs: &'p Catalogs,
        stop: &'p AtomicBool,
        deadline: Option<Instant>,
    ) -> Self {
        Self {
            space,
            catalogs,
            budget: Budget::new(stop, deadline),
            gap: 0.0,
            regions_from: VAST,
            regions_to: FEW,
            most_with_ties: MOST_WITH_TIES,
        }
    }

    /// Searches a space of more designs than this, instead of 1e14, region by region down to so few. It changes how
    /// long the search takes, not what it finds.
    #[must_use]
    pub fn by_regions_from(self, designs: f64) -> Self {
        Self { regions_from: designs, regions_to: designs.min(FEW), ..self }
    }

    /// Lists designs that differ in drives of equal mass and curve only up to so many, instead of 20,000; beyond that one
    /// of them each.
    #[must_use]
    pub fn with_ties_up_to(self, designs: usize) -> Self {
        Self { most_with_ties: designs, ..self }
    }

    /// Is content once no design beats every one that is known or found by more than this part in all three objectives
    /// at once.
    #[must_use]
    pub fn to_gap(self, gap: f64) -> Self {
        Self { gap, ..self }
    }

    /// Boxes bounded so far.
    pub fn boxes(&self) -> u64 {
        self.budget.boxes()
    }

    /// The pass after one that began then and has just ended: the one with the least slack that there should be time
    /// for. A front with a gap depends on the passes before it, so these then do not ask for the time.
    fn next_pass(&self, passes: &[f64], last: usize, started: Instant) -> usize {
        let left = self.budget.deadline().map(|deadline| deadline.saturating_duration_since(Instant::now()));
        let took_s = started.elapsed().as_secs_f64();
        let has_gap = self.gap > 0.0;
        let most = if has_gap { PASSED_OVER_TO_A_GAP } else { MOST_PASSED_OVER };
        let is_quick = |pass: &usize| {
            let should_take_s = took_s * (passes[last] / passes[*pass]).powf(GROWTH);
            has_gap || left.is_none_or(|left| should_take_s < QUICK * left.as_secs_f64())
        };
        let ahead = last + 2..(last + 2 + most).min(passes.len());
        // one without any slack comes after all
        ahead.take_while(|pass| passes[*pass] > 0.0 && is_quick(pass)).last().unwrap_or(last + 1)
    }

    /// Finds the front, starting from designs that are known already.
    pub fn run(&self, state: &[Objectives]) -> ExactOutcome {
        self.run_of(self.problem(&|_| true, Ties::Merged), state)
    }

    /// Finds the front of the designs whose chosen links are all of one material, by its index in the study.
    pub fn run_of_material(&self, material_index: usize) -> ExactOutcome {
        let is_of_it = |option: &LinkOption| option.material_index == material_index;
        self.run_of(self.problem(&is_of_it, Ties::Merged), &[])
    }

    /// The space with some of its link options; `None` if a level has none.
    pub(super) fn problem(&self, takes: &dyn Fn(&LinkOption) -> bool, ties: Ties) -> Option<Problem<'p>> {
        Problem::new(self.space, self.catalogs, takes, ties)
    }

    fn run_of(&self, whole: Option<Problem<'p>>, given: &[Objectives]) -> ExactOutcome {
        let mut state = SearchState::default();
        given.iter().for_each(|objectives| state.enter(objectives));
        let (mut proven, mut last_slack, mut open) = (None, 0.0, Vec::new());
        if let Some(whole) = &whole {
            let designs = whole.designs() as f64;
            let by_regions = designs > self.regions_from;
            let is_large = by_regions || designs > LARGE;
            if given.is_empty() {
                let probes = if by_regions { PROBES_TO_EVOLVE } else { PROBES };
                let probed =
                    probe(&self.budget, whole, (probes * designs.log10().powi(2)) as usize, &mut state);
                if by_regions {
                    evolve(&self.budget, whole, probed, &mut state);
                }
            }
            let helps = |slack: &f64| is_large && given.is_empty() && (by_regions || *slack >= FINE);
            let coarser = SLACKS.into_iter().filter(|slack| helps(slack) && *slack > self.gap);
            let passes: Vec<f64> = coarser.chain([self.gap]).collect();
            let mut next = 0;
            while let Some(&slack) = passes.get(next) {
                let started = Instant::now();
                open = match by_regions {
                    true => pass_by_regions(&self.budget, whole, &mut state, slack, self.regions_to),
                    false => pass_by_boxes(&self.budget, whole, &mut state, slack),
                };
                if !open.is_empty() {
                    last_slack = slack;
                    break;
                }
                proven = Some(slack);
                next = self.next_pass(&passes, next, started);
            }
        }
        let designs_evaluated = state.evaluated;
        let front = state.into_front();
        let (mut front, ties_listed) = match &whole {
            Some(whole) => whole.with_ties(&front, self.most_with_ties),
            None => (front, true),
        };
        front.sort_unstable_by_key(|c| c.number);
        front.dedup_by_key(|c| c.number);
        ExactOutcome {
            designs_total: whole.as_ref().map_or(0, Problem::designs),
            designs_evaluated,
            boxes: self.boxes(),
            boxes_open: open.len() as u64,
            gap: match open.is_empty() {
                true => proven.or(Some(0.0)),
                false => least(proven, gap(&open, &front).map(|gap| gap.max(last_slack))),
            },
            front,
            ties_listed,
        }
    }
}

/// The smaller of two bounds that may be unknown.
fn least(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    a.into_iter().chain(b).reduce(f64::min)
}
