//! The exact search: probes, passes with less and less slack, and the listing of the front.

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

/// Slacks of the passes over a large space. With slack a box is also pruned if an incumbent comes that close
/// to its bound. A completed pass therefore proves that every design has a found one that close.
const SLACKS: [f64; 25] = [
    1.0, 0.7, 0.5, 0.42, 0.35, 0.3, 0.25, 0.2, 0.16, 0.12, 0.09, 0.075, 0.06, 0.05, 0.04, 0.035, 0.03, 0.025,
    0.02, 0.015, 0.01, 0.007, 0.005, 0.0035, 0.0025,
];
/// Slacks below this are used only in searches by regions. A search by boxes finds as much without such passes.
const FINE: f64 = 0.02;
/// A pass may be skipped if the next finer pass should take less than the part [`QUICK`] of the time left. At most
/// this many passes are skipped at once. With a target gap at most [`PASSED_OVER_TO_A_GAP`] are skipped, whatever
/// time they take.
const MOST_PASSED_OVER: usize = 4;
const PASSED_OVER_TO_A_GAP: usize = 8;
const QUICK: f64 = 0.65;
/// The time of a pass grows about as this power of the reciprocal of its slack.
const GROWTH: f64 = 2.5;
/// Number of designs above which a space is searched in passes.
const LARGE: f64 = 1e9;
/// Number of designs above which a space is searched region by region.
pub const VAST: f64 = 1e14;
/// Number of designs below which a region is searched box by box.
const FEW: f64 = 1e6;
/// Number of probes, divided by the square of the number of designs' common logarithm. A large space repays many
/// probes, a small one none.
const PROBES: f64 = 0.12;
/// The factor that replaces [`PROBES`] where the genetic algorithm ([`evolve`]) follows.
const PROBES_TO_EVOLVE: f64 = 0.04;
/// Default for the greatest number of designs that are listed with all their ties.
const MOST_WITH_TIES: usize = 20_000;

/// A search for the exact front. Other threads can watch and stop it.
///
/// ```
/// use armwright::catalog::Catalogs;
/// use armwright::exact::Exact;
/// use armwright::input::Document;
/// use armwright::study::read_study;
/// use std::sync::atomic::AtomicBool;
///
/// let text = r#"{"name": "one link",
///     "chain": [
///         {"type": "joint", "name": "j2", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e5, "mass_kg": 8},
///         {"type": "link", "name": "arm", "vector_m": [0.5, 0, 0], "choose": {
///             "materials": ["Structural steel S355"],
///             "sections": [{"shape": "round_tube", "diameter_mm": 70, "wall_mm": [2, 3, 4]}]}}],
///     "payload": {"mass_kg": 5},
///     "poses": [{"name": "stretched", "pose_deg": [0]}]}"#;
/// let catalogs = Catalogs::builtin();
/// let study = read_study(Document::parse("study.json", text).expect("JSON"), &catalogs).expect("a sound study");
/// let stop = AtomicBool::new(false);
/// let outcome = Exact::new(&study.space, &catalogs, &stop, None).run(&[]);
/// assert_eq!((outcome.designs_total, outcome.boxes_open), (3, 0), "the front is certified");
/// assert!(!outcome.front.is_empty());
/// ```
pub struct Exact<'p> {
    space: &'p DesignSpace,
    catalogs: &'p Catalogs,
    pub(super) budget: Budget<'p>,
    /// The slack of the last pass, after which the search is complete.
    gap: f64,
    /// Number of designs above which the space is searched by regions. `regions_to` is the number below which a
    /// region is searched by boxes.
    regions_from: f64,
    regions_to: f64,
    /// Greatest number of designs that are listed with all their ties.
    most_with_ties: usize,
}

/// The result of the search.
#[derive(Debug, Clone, PartialEq)]
pub struct ExactOutcome {
    /// Number of designs in the space.
    pub designs_total: u128,
    /// Number of designs whose three objectives were computed.
    pub designs_evaluated: u64,
    /// Number of boxes bounded.
    pub boxes: u64,
    /// Number of boxes or regions that were still open when the search was stopped. It is 0 if the front is
    /// certified.
    pub boxes_open: u64,
    /// The greatest factor, less one, by which an undiscovered design may be better than the whole front in every
    /// objective at once. After a complete search this is the gap that was asked for, 0 for the whole front. `None`
    /// if nothing is known.
    pub gap: Option<f64>,
    /// The designs found that no other dominates.
    pub front: Vec<Candidate>,
    /// Whether the front lists every design that differs only in drives of equal mass and curve. If there are too
    /// many, one of each set of ties is listed.
    pub ties_listed: bool,
}

impl<'p> Exact<'p> {
    /// A search of a space. It ends early when `stop` is set or the deadline has passed.
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

    /// Searches the space region by region if it has more designs than this. The default is 1e14. It changes the time
    /// of the search, not its result.
    #[must_use]
    pub fn by_regions_from(self, designs: f64) -> Self {
        Self { regions_from: designs, regions_to: designs.min(FEW), ..self }
    }

    /// Lists designs that differ only in drives of equal mass and curve if they are at most this many. The default is
    /// 20,000. If there are more, one of each set of ties is listed.
    #[must_use]
    pub fn with_ties_up_to(self, designs: usize) -> Self {
        Self { most_with_ties: designs, ..self }
    }

    /// Completes the search once for every design some known or found one is worse by at most this part in each
    /// objective.
    #[must_use]
    pub fn to_gap(self, gap: f64) -> Self {
        Self { gap, ..self }
    }

    /// Number of boxes bounded so far.
    pub fn boxes(&self) -> u64 {
        self.budget.boxes()
    }

    /// The index of the next pass: the one with the least slack for which there should be time. With a target gap the
    /// choice does not depend on the time. A front with a gap depends on the passes before it and must be the same on
    /// every machine.
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
        // The pass without slack is never skipped to; it comes last in any case.
        ahead.take_while(|pass| passes[*pass] > 0.0 && is_quick(pass)).last().unwrap_or(last + 1)
    }

    /// Finds the front. `known` holds the objectives of designs that are known already. They prune boxes, but these
    /// designs are not listed.
    pub fn run(&self, known: &[Objectives]) -> ExactOutcome {
        self.run_of(self.problem(&|_| true, Ties::Merged), known)
    }

    /// Finds the front of the designs whose chosen links are all of one material, given by its index in the
    /// study.
    pub fn run_of_material(&self, material_index: usize) -> ExactOutcome {
        let is_of_it = |option: &LinkOption| option.material_index == material_index;
        self.run_of(self.problem(&is_of_it, Ties::Merged), &[])
    }

    /// The compiled space with the link options for which `takes` is true. `None` if a level has no option.
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
            // With given designs there is something to prune with from the start.
            if given.is_empty() {
                let probes = if by_regions { PROBES_TO_EVOLVE } else { PROBES };
                let probed =
                    probe(&self.budget, whole, (probes * designs.log10().powi(2)) as usize, &mut state);
                if by_regions {
                    evolve(&self.budget, whole, probed, &mut state);
                }
            }
            // Small spaces, and searches with given designs, need no passes with slack.
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
        // Tied kinds may stand for the same design.
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

/// The smaller of two bounds; a bound that is `None` is unknown and does not count.
fn least(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    a.into_iter().chain(b).reduce(f64::min)
}
