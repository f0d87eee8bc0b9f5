//! Region by region: what the designs found leave open is taken apart, and for each part of it the options are
//! narrowed to those that a design there may have at all.
//!
//! A region is all that is below a [`Corner`]. Far fewer options reach into it than there are: a weighting of what a
//! corner allows excludes every option that costs more than the corner can afford ([`narrow`](super::narrow)), and
//! with fewer options the bounds are sharper, so more can be excluded. Whole groups of corners are refuted so, under the
//! corner that bounds them; those that are not are taken apart, then their options or a torque parted
//! ([`parting`](super::parting)) until few designs are left, which are searched box by box.

use super::bound::{BoxBound, DesignBox, Verdict};
use super::boxes::{OpenBox, Search, open_boxes};
use super::budget::Budget;
use super::grid::thinned;
use super::local_upper_bounds::{LocalUpperBound, LocalUpperBounds};
use super::problem::Problem;
use super::region_bound::Survivors;
use super::rounds::{Done, in_rounds};
use super::search_state::{Findings, SearchState};
use super::work::Work;

use super::rows::{BEATEN, WarmStart};
use super::shape::Shape;
use crate::pareto::objectives::Objectives;
use crate::space::design::number;
use std::sync::Arc;

/// Part of the designs that must be excluded for the options to be narrowed once more.
const WORTH_IT: f64 = 0.1;
/// Part of the slack by which corners may be apart.
const THINNED: f64 = 0.45;

/// Options that may reach into a region, with what the region around it knew.
#[derive(Clone)]
pub(super) struct Subproblem<'p> {
    problem: Arc<Problem<'p>>,
    design_box: DesignBox,
    shapes: Arc<Vec<Shape>>,
    warm_start: Arc<WarmStart>,
    /// How many of the designs found the region knows of.
    incumbents_seen: usize,
}

/// What is to be searched.
enum Task<'p> {
    /// What is below a node of a tree of corners.
    Region { upper_bounds: Arc<LocalUpperBounds>, at: usize, subproblem: Subproblem<'p> },
    /// Few designs of a region, box by box.
    Boxes { problem: Arc<Problem<'p>>, upper: LocalUpperBound, first: OpenBox },
}

/// One pass over everything that the designs known leave open; returns a ceiling for everything that was left.
pub(super) fn pass_by_regions<'p>(
    budget: &Budget<'p>,
    problem: &Problem<'p>,
    state: &mut SearchState,
    slack: f64,
    regions_to: f64,
) -> Vec<BoxBound> {
    let mut found: Vec<Objectives> =
        state.incumbents.all().iter().map(|o| improved_by_slack(o, slack)).collect();
    // fewer designs leave more open, by less than the slack
    found = thinned(found, THINNED * slack, |o| o);
    let upper_bounds = Arc::new(LocalUpperBounds::new(&mut found, problem.limits()));
    let subproblem = Subproblem::whole(problem, state.incumbents.all().len(), &mut Work::default());
    let first = subproblem.map(|subproblem| Task::Region { upper_bounds, at: 0, subproblem });
    let task = |state: &SearchState, task: Task<'p>| match task {
        Task::Region { upper_bounds, at, subproblem } => {
            let mut findings = Findings::default();
            let search = Search { budget, problem, state, slack, below: None };
            let tasks = search.region(upper_bounds, at, subproblem, regions_to, &mut findings);
            Done { tasks, findings }
        }
        Task::Boxes { problem, upper, first } => {
            let search = Search { budget, problem: &problem, state, slack, below: Some(upper) };
            let Done { tasks, findings } =
                open_boxes(budget, first, |next, work, findings| search.open(next, work, findings));
            let boxes = |first: OpenBox| Task::Boxes { problem: Arc::clone(&problem), upper, first };
            Done { tasks: tasks.into_iter().map(boxes).collect(), findings }
        }
    };
    let survivors =
        in_rounds(state, first.into_iter().collect(), || budget.stopped(), task, SearchState::learn);
    survivors.iter().map(|_| BoxBound::OPEN).collect()
}

impl<'p> Search<'_, 'p> {
    /// Searches what is below a node of a tree of corners; returns what is left to be searched.
    fn region(
        &self,
        upper_bounds: Arc<LocalUpperBounds>,
        at: usize,
        mut subproblem: Subproblem<'p>,
        regions_to: f64,
        findings: &mut Findings,
    ) -> Vec<Task<'p>> {
        let Some((upper, halves)) = upper_bounds.node(at) else { return Vec::new() };
        if halves.is_none()
            && let Some(clipped) = self.clipped(&upper, &mut subproblem.incumbents_seen)
        {
            return self.region(Arc::new(clipped), 0, subproblem, regions_to, findings);
        }
        let mut work = Work::default();
        let Some(survivors) = self.reduce(&mut subproblem, &upper, &mut work, findings) else {
            return Vec::new();
        };
        if subproblem.designs_of(&survivors) <= regions_to {
            return vec![subproblem.in_boxes(upper)];
        }
        let subproblems = match halves {
            Some(_) => Some([subproblem.clone(), subproblem.clone()]),
            None => subproblem.branch(&survivors, &mut work),
        };
        let Some([a, b]) = subproblems else { return vec![subproblem.in_boxes(upper)] };
        let [first, second] = halves.unwrap_or([at; 2]);
        // the first is searched first
        [(second, b), (first, a)]
            .map(|(at, subproblem)| Task::Region { upper_bounds: Arc::clone(&upper_bounds), at, subproblem })
            .into()
    }

    /// Narrows the options as long as that is worth it; `None` if no design is below the corner.
    fn reduce(
        &self,
        subproblem: &mut Subproblem<'p>,
        upper: &LocalUpperBound,
        work: &mut Work,
        findings: &mut Findings,
    ) -> Option<Survivors> {
        loop {
            self.budget.count_box();
            let (survivors, reduced) =
                subproblem.reduce(upper, work, |box_bound| self.dominates(box_bound, findings))?;
            if !reduced {
                survivors
                    .candidates
                    .iter()
                    .for_each(|design_box| self.try_design(subproblem, design_box.clone(), findings));
                return Some(survivors);
            }
        }
    }

    /// Judges what may be a good design, once.
    fn try_design(&self, subproblem: &Subproblem<'p>, mut design_box: DesignBox, findings: &mut Findings) {
        let problem = &subproblem.problem;
        let Some(options) = problem.options(&design_box) else { return };
        let number = number(&problem.level_sizes, &options);
        if self.state.tried.contains(&number) || findings.tried.contains(&number) {
            return;
        }
        findings.tried.push(number);
        let (mut shapes, mut work) = (Arc::clone(&subproblem.shapes), Work::default());
        self.budget.count_box();
        let beaten = |box_bound: &BoxBound| {
            self.state.incumbents.dominates(box_bound) || findings.dominates(box_bound)
        };
        if let Verdict::Open(box_bound) =
            problem.bound(&mut design_box, &mut shapes, &mut work, beaten, |_| true)
        {
            problem.judge(&design_box, &box_bound, &work, findings);
        }
    }

    /// The corners that designs found since leave of a region; `None` if none of them is in it.
    fn clipped(&self, upper: &LocalUpperBound, incumbents_seen: &mut usize) -> Option<LocalUpperBounds> {
        let is_inside = |o: &Objectives| {
            o.mass_kg < upper.mass_kg && o.tip_deflection_m < upper.tip_m && o.lowest_mode_hz > upper.hz
        };
        let all = self.state.incumbents.all();
        let since = all[*incumbents_seen..].iter().map(|o| improved_by_slack(o, self.slack));
        let mut inside: Vec<Objectives> = since.filter(is_inside).collect();
        *incumbents_seen = all.len();
        (!inside.is_empty()).then(|| LocalUpperBounds::new(&mut inside, *upper))
    }
}

/// A design taken for better than it is by the slack, so that what is left is missed by more.
fn improved_by_slack(found: &Objectives, slack: f64) -> Objectives {
    found.better_by(1.0 + slack - BEATEN)
}

impl<'p> Subproblem<'p> {
    /// Everything, to begin with.
    pub fn whole(problem: &Problem<'p>, incumbents_seen: usize, work: &mut Work) -> Option<Self> {
        let shapes = problem.first_shapes(work)?;
        Some(Self {
            problem: Arc::new(problem.clone()),
            design_box: problem.root(),
            warm_start: Arc::new(WarmStart::new(&shapes)),
            shapes: Arc::new(shapes),
            incumbents_seen,
        })
    }

    /// What is left of the zone below a corner, and whether its options were narrowed to it: if enough designs went.
    /// `None` if none is left.
    pub fn reduce(
        &mut self,
        upper: &LocalUpperBound,
        work: &mut Work,
        is_beaten: impl Fn(&BoxBound) -> bool,
    ) -> Option<(Survivors, bool)> {
        let before = self.problem.members(&self.design_box);
        let verdict = self.problem.bound(
            &mut self.design_box,
            &mut self.shapes,
            work,
            |box_bound| !upper.is_in_reach_of(box_bound) || is_beaten(box_bound),
            |_| true,
        );
        let Verdict::Open(box_bound) = verdict else { return None };
        let warm_start = Arc::make_mut(&mut self.warm_start);
        let survivors = self.problem.bound_below(&self.design_box, &box_bound, warm_start, work, upper)?;
        let reduced = self.designs_of(&survivors) <= (1.0 - WORTH_IT) * before;
        if reduced {
            self.problem = Arc::new(self.problem.restricted_to(&survivors.options)?);
            self.design_box = self.problem.root();
        }
        Some((survivors, reduced))
    }

    /// The zone box by box, whatever the forces: that is quick where designs are few.
    fn in_boxes(self, upper: LocalUpperBound) -> Task<'p> {
        let problem = Arc::new(self.problem.without_force_bounds());
        Task::Boxes {
            problem,
            upper,
            first: OpenBox { design_box: self.design_box, shapes: self.shapes, box_bound: BoxBound::OPEN },
        }
    }

    /// Designs of what is left.
    pub fn designs_of(&self, survivors: &Survivors) -> f64 {
        self.problem.designs_below(&survivors.options)
    }

    /// Two zones with half the options of a level each, the level that should gain most; `None` if a single design is
    /// left.
    pub fn branch(&self, survivors: &Survivors, work: &mut Work) -> Option<[Self; 2]> {
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
