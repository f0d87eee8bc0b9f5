//! The search region by region.
//!
//! Incumbents are the designs found so far. A region is the part of the objective space below a
//! [`LocalUpperBound`](super::local_upper_bounds::LocalUpperBound) of the incumbents. Far fewer options can belong to a
//! design of a region than the space has. A dual point is a set of weights for the inequalities that bound a region
//! ([`rows`](super::rows)); the price of a part is what it adds to their weighted sum. A dual point excludes every
//! option whose price exceeds what the local upper bound allows ([`reduced_cost`](super::reduced_cost)). With fewer
//! options the bounds are sharper, and more options can be excluded.
//!
//! A local upper bound is *refuted* if no design is below it. Local upper bounds are refuted several at a time, by one
//! bound that covers all of them. A set of bounds that is not refuted is divided into two. A region below a single
//! bound that is not refuted is branched on options or on a torque ([`branching`](super::branching)) until few designs
//! are left. These are searched box by box.

use super::bound::{BoxBound, DesignBox, Verdict};
use super::box_work::BoxWork;
use super::boxes::{OpenBox, Search, open_boxes};
use super::budget::Budget;
use super::grid::thinned;
use super::live_progress::LiveProgress;
use super::local_upper_bounds::LocalUpperBounds;
use super::problem::Problem;
use super::region_bound::Survivors;
use super::rounds::{Done, in_rounds};
use super::search_state::{Findings, SearchState};

use super::rows::{DOMINANCE_MARGIN, WarmStart};
use super::shape::Shape;
use crate::pareto::objectives::Objectives;
use crate::space::design::number;
use std::sync::Arc;

/// The bound of a region is computed again with the remaining options if at least this fraction of the region's designs
/// was excluded.
const WORTH_IT: f64 = 0.1;
/// Width of a grid cell for the thinning of incumbents, as a fraction of the slack. The slack is the fraction by which
/// a design may be better than the incumbents and still be missed in this pass.
const THINNING_CELL: f64 = 0.45;

/// The options that may belong to a design of a region. Its trial shapes (motions that bound the lowest mode) and its
/// multipliers (in `warm_start`) first come from the larger region of which it is a part. They are replaced when its
/// own are computed.
#[derive(Clone)]
pub(super) struct Subproblem<'p> {
    problem: Arc<Problem<'p>>,
    design_box: DesignBox,
    shapes: Arc<Vec<Shape>>,
    warm_start: Arc<WarmStart>,
    /// Number of incumbents from which the local upper bounds of this region were made.
    incumbents_seen: usize,
}

/// A task of the search.
enum Task<'p> {
    /// The region below a group of local upper bounds.
    Region { below: LocalUpperBounds, subproblem: Subproblem<'p> },
    /// The designs of a region with few designs. They are searched box by box.
    Boxes { problem: Arc<Problem<'p>>, below: Arc<LocalUpperBounds>, first: OpenBox },
}

/// One pass with the slack `slack` over the whole search region, for the designs of the boxes `boxes`. A region of at
/// most `regions_to` designs is searched box by box. `seen` is called after each round. Returns one bound for each task
/// that is left when the search is stopped.
pub(super) fn pass_by_regions<'p>(
    budget: &Budget<'p>,
    problem: &Problem<'p>,
    state: &mut SearchState,
    (slack, boxes): (f64, &[DesignBox]),
    regions_to: f64,
    (live, seen): (Option<&LiveProgress>, impl Fn()),
) -> Vec<BoxBound> {
    let mut found: Vec<Objectives> =
        state.incumbents.all().iter().map(|o| improved_by_slack(o, slack)).collect();
    // Fewer incumbents leave a larger region open, so nothing is missed. The cells are narrower than the slack, so the
    // gap is still proved.
    found = thinned(found, THINNING_CELL * slack, |o| o);
    let below = LocalUpperBounds::new(&mut found, problem.limits());
    let (seen_to, mut work) = (state.incumbents.all().len(), BoxWork::default());
    let subproblems = boxes.iter().filter_map(|of| Subproblem::of_box(problem, of, seen_to, &mut work));
    let region = |subproblem| Task::Region { below: below.clone(), subproblem };
    let first: Vec<Task<'p>> = subproblems.map(region).collect();
    let task = |state: &SearchState, task: Task<'p>| match task {
        Task::Region { below, subproblem } => {
            let mut findings = Findings::default();
            let search = Search { budget, problem, state, slack, below: None };
            let tasks = search.region(below, subproblem, regions_to, &mut findings);
            Done { tasks, findings }
        }
        Task::Boxes { problem, below, first } => {
            let search = Search { budget, problem: &problem, state, slack, below: Some(&below) };
            let Done { tasks, findings } =
                open_boxes(budget, first, |next, work, findings| search.open(next, work, findings));
            let boxes = |first: OpenBox| Task::Boxes {
                problem: Arc::clone(&problem),
                below: Arc::clone(&below),
                first,
            };
            Done { tasks: tasks.into_iter().map(boxes).collect(), findings }
        }
    };
    let see = |state: &SearchState, open: &[Task<'p>]| {
        seen();
        live.into_iter().for_each(|live| {
            live.update(|| state.known(&state.front(), open.len(), None));
        });
    };
    let remaining = in_rounds(state, first, || budget.stopped(), task, SearchState::learn, see);
    remaining.iter().map(|_| BoxBound::OPEN).collect()
}

impl<'p> Search<'_, 'p> {
    /// Searches the region below a group of local upper bounds. If it has at most `regions_to` designs, it is searched
    /// box by box. Returns the tasks that remain.
    fn region(
        &self,
        mut below: LocalUpperBounds,
        mut subproblem: Subproblem<'p>,
        regions_to: f64,
        findings: &mut Findings,
    ) -> Vec<Task<'p>> {
        // Incumbents that were found after the bounds were made reduce the region below them.
        let all = self.state.incumbents.all();
        let since = all[subproblem.incumbents_seen..].iter().map(|o| improved_by_slack(o, self.slack));
        below.cut_by(&since.collect::<Vec<_>>());
        subproblem.incumbents_seen = all.len();
        let (was_single, mut work) = (below.all().len() == 1, BoxWork::default());
        let Some(survivors) = self.reduce(&mut subproblem, &mut below, &mut work, findings) else {
            return Vec::new();
        };
        // A box takes microseconds and a region milliseconds, so few designs are searched faster box by box.
        if subproblem.designs_of(&survivors) <= regions_to {
            return vec![subproblem.in_boxes(below)];
        }
        if let Some(halves) = below.clone().halves() {
            // Tasks are taken from the end, so the first half is searched first.
            let [first, second] = halves.map(|below| Task::Region { below, subproblem: subproblem.clone() });
            return vec![second, first];
        }
        // The options that are left were found for the bound that covers the whole group. They do not tell how to
        // divide the options for the single bound that is left, so the region of this bound is bounded anew.
        if !was_single {
            return vec![Task::Region { below, subproblem }];
        }
        let Some(halves) = subproblem.branch(&survivors, &mut work) else {
            return vec![subproblem.in_boxes(below)];
        };
        let [first, second] = halves.map(|subproblem| Task::Region { below: below.clone(), subproblem });
        vec![second, first]
    }

    /// Excludes options of a subproblem, and local upper bounds, as long as that is worth the time. Then evaluates
    /// promising designs. Returns the remaining options. `None` if the region is empty.
    fn reduce(
        &self,
        subproblem: &mut Subproblem<'p>,
        below: &mut LocalUpperBounds,
        work: &mut BoxWork,
        findings: &mut Findings,
    ) -> Option<Survivors> {
        loop {
            self.budget.count_box();
            let (survivors, reduced) =
                subproblem.reduce(below, work, |box_bound| self.dominates(box_bound, findings))?;
            if !reduced {
                survivors
                    .candidates
                    .iter()
                    .for_each(|design_box| self.try_design(subproblem, design_box.clone(), findings));
                return Some(survivors);
            }
        }
    }

    /// Evaluates a design that may be a good incumbent, unless it was evaluated before.
    fn try_design(&self, subproblem: &Subproblem<'p>, mut design_box: DesignBox, findings: &mut Findings) {
        let problem = &subproblem.problem;
        let Some(options) = problem.options(&design_box) else { return };
        let number = number(&problem.level_sizes, &options);
        // The same design comes up in many neighbouring regions.
        if self.state.tried.contains(&number) || findings.tried.contains(&number) {
            return;
        }
        findings.tried.push(number);
        let (mut shapes, mut work) = (Arc::clone(&subproblem.shapes), BoxWork::default());
        self.budget.count_box();
        let is_dominated = |box_bound: &BoxBound| {
            self.state.incumbents.dominates(box_bound) || findings.dominates(box_bound)
        };
        if let Verdict::Open(box_bound) =
            problem.bound(&mut design_box, &mut shapes, &mut work, is_dominated, |_| true)
        {
            problem.judge(&design_box, &box_bound, &work, findings);
        }
    }
}

/// The objectives of an incumbent, improved by the slack. With them in the place of the incumbent, the search looks
/// only for designs that are better than the incumbent by more than the slack.
fn improved_by_slack(found: &Objectives, slack: f64) -> Objectives {
    found.better_by(1.0 + slack - DOMINANCE_MARGIN)
}

impl<'p> Subproblem<'p> {
    /// The subproblem with all options of the space. `incumbents_seen` is the number of incumbents from which its local
    /// upper bounds were made. `None` if no design meets the constraints.
    pub(super) fn whole(problem: &Problem<'p>, incumbents_seen: usize, work: &mut BoxWork) -> Option<Self> {
        let shapes = problem.first_shapes(work)?;
        Some(Self {
            problem: Arc::new(problem.clone()),
            design_box: problem.root(),
            warm_start: Arc::new(WarmStart::new(&shapes)),
            shapes: Arc::new(shapes),
            incumbents_seen,
        })
    }

    /// The subproblem of a box of a whole space. `None` if none of its designs meets the constraints.
    fn of_box(
        problem: &Problem<'p>,
        design_box: &DesignBox,
        incumbents_seen: usize,
        work: &mut BoxWork,
    ) -> Option<Self> {
        if *design_box == problem.root() {
            return Self::whole(problem, incumbents_seen, work);
        }
        let nodes: Vec<Vec<u32>> = design_box.iter().map(|&node| vec![node]).collect();
        Self::whole(&problem.restricted_to(&nodes)?, incumbents_seen, work)
    }

    /// Bounds a subproblem below a group of local upper bounds and removes the bounds that are refuted. Returns the
    /// survivors, and whether the subproblem was restricted to them. It is restricted if enough designs were excluded.
    /// `is_beaten` tells whether a known design dominates every design with a given bound. `None` if the region is
    /// empty.
    pub(super) fn reduce(
        &mut self,
        below: &mut LocalUpperBounds,
        work: &mut BoxWork,
        is_beaten: impl Fn(&BoxBound) -> bool,
    ) -> Option<(Survivors, bool)> {
        let before = self.problem.members(&self.design_box);
        let verdict = self.problem.bound(
            &mut self.design_box,
            &mut self.shapes,
            work,
            |box_bound| !below.admit(box_bound) || is_beaten(box_bound),
            |_| true,
        );
        let Verdict::Open(box_bound) = verdict else { return None };
        below.retain(|upper| upper.admits(&box_bound));
        let warm_start = Arc::make_mut(&mut self.warm_start);
        let survivors = self.problem.bound_below(&self.design_box, &box_bound, warm_start, work, below)?;
        let reduced = self.designs_of(&survivors) <= (1.0 - WORTH_IT) * before;
        if reduced {
            self.problem = Arc::new(self.problem.restricted_to(&survivors.options)?);
            self.design_box = self.problem.root();
        }
        Some((survivors, reduced))
    }

    /// A task that searches the designs of the subproblem box by box. Force bounds are dropped, because they take time
    /// and help little where designs are few.
    fn in_boxes(self, below: LocalUpperBounds) -> Task<'p> {
        let problem = Arc::new(self.problem.without_force_bounds());
        Task::Boxes {
            problem,
            below: Arc::new(below),
            first: OpenBox { design_box: self.design_box, shapes: self.shapes, box_bound: BoxBound::OPEN },
        }
    }

    /// Number of designs that the options in `survivors` make.
    pub(super) fn designs_of(&self, survivors: &Survivors) -> f64 {
        self.problem.designs_below(&survivors.options)
    }

    /// Divides the subproblem into two. The first branching of `survivors` that separates its options is taken; if
    /// there is none, a level is halved. `None` if a single design is left.
    pub(super) fn branch(&self, survivors: &Survivors, work: &mut BoxWork) -> Option<[Self; 2]> {
        let branch = survivors
            .branchings
            .iter()
            .find_map(|branching| self.problem.branch(&survivors.options, branching));
        if let Some(halves) = branch {
            return Some(halves.map(|half| Self {
                design_box: half.root(),
                problem: Arc::new(half),
                ..self.clone()
            }));
        }
        let level = self.problem.widest_level(&self.design_box, &self.shapes, work)?;
        let halves = self.problem.halves(&self.design_box, level)?;
        Some(halves.map(|half| {
            let mut subproblem = self.clone();
            subproblem.design_box[level] = half;
            subproblem
        }))
    }
}
