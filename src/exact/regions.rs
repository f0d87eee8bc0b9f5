//! Region by region: what the designs found leave open is taken apart, and for each part of it the options are
//! narrowed to those that a design there may have at all.
//!
//! A region is all that is below a [`Corner`]. Far fewer options reach into it than there are: a weighting of what a
//! corner allows excludes every option that costs more than the corner can afford ([`narrow`](super::narrow)), and
//! with fewer options the bounds are sharper, so more can be excluded. Whole groups of corners are refuted so, under the
//! corner that bounds them; those that are not are taken apart, then their options or a torque parted
//! ([`parting`](super::parting)) until few designs are left, which are searched box by box.

use super::bound::{Ceiling, Cell, Verdict, Work};
use super::boxes::{Opened, Search, some_boxes};
use super::budget::Budget;
use super::corners::{Corner, Corners};
use super::grid::thinned;
use super::known::{Finds, Known};
use super::left::Left;
use super::problem::Problem;
use super::rounds::{Done, in_rounds};

use super::shape::Shape;
use super::tradeoff::{BEATEN, Trade};
use crate::pareto::objectives::Objectives;
use crate::space::design::number;
use std::sync::Arc;

/// Part of the designs that must be excluded for the options to be narrowed once more.
const WORTH_IT: f64 = 0.1;
/// Part of the slack by which corners may be apart.
const THINNED: f64 = 0.45;

/// Options that may reach into a region, with what the region around it knew.
#[derive(Clone)]
pub(super) struct Zone<'p> {
    problem: Arc<Problem<'p>>,
    cell: Cell,
    shapes: Arc<Vec<Shape>>,
    trade: Arc<Trade>,
    /// How many of the designs found the region knows of.
    known: usize,
}

/// What is to be searched.
enum Task<'p> {
    /// What is below a node of a tree of corners.
    Region { corners: Arc<Corners>, at: usize, zone: Zone<'p> },
    /// Few designs of a region, box by box.
    Boxes { problem: Arc<Problem<'p>>, corner: Corner, first: Opened },
}

/// One pass over everything that the designs known leave open; returns a ceiling for everything that was left.
pub(super) fn pass_by_regions<'p>(
    budget: &Budget<'p>,
    problem: &Problem<'p>,
    known: &mut Known,
    slack: f64,
    regions_to: f64,
) -> Vec<Ceiling> {
    let mut found: Vec<Objectives> = known.found.all().iter().map(|o| tightened(o, slack)).collect();
    // fewer designs leave more open, by less than the slack
    found = thinned(found, THINNED * slack, |o| o);
    let corners = Arc::new(Corners::new(&mut found, problem.limits()));
    let zone = Zone::whole(problem, known.found.all().len(), &mut Work::default());
    let first = zone.map(|zone| Task::Region { corners, at: 0, zone });
    let task = |known: &Known, task: Task<'p>| match task {
        Task::Region { corners, at, zone } => {
            let mut finds = Finds::default();
            let search = Search { budget, problem, known, slack, below: None };
            let tasks = search.region(corners, at, zone, regions_to, &mut finds);
            Done { tasks, finds }
        }
        Task::Boxes { problem, corner, first } => {
            let search = Search { budget, problem: &problem, known, slack, below: Some(corner) };
            let Done { tasks, finds } =
                some_boxes(budget, first, |next, work, finds| search.open(next, work, finds));
            let boxes = |first: Opened| Task::Boxes { problem: Arc::clone(&problem), corner, first };
            Done { tasks: tasks.into_iter().map(boxes).collect(), finds }
        }
    };
    let left = in_rounds(known, first.into_iter().collect(), || budget.stopped(), task, Known::learn);
    left.iter().map(|_| Ceiling::OPEN).collect()
}

impl<'p> Search<'_, 'p> {
    /// Searches what is below a node of a tree of corners; returns what is left to be searched.
    fn region(
        &self,
        corners: Arc<Corners>,
        at: usize,
        mut zone: Zone<'p>,
        regions_to: f64,
        finds: &mut Finds,
    ) -> Vec<Task<'p>> {
        let Some((corner, halves)) = corners.node(at) else { return Vec::new() };
        if halves.is_none()
            && let Some(clipped) = self.clipped(&corner, &mut zone.known)
        {
            return self.region(Arc::new(clipped), 0, zone, regions_to, finds);
        }
        let mut work = Work::default();
        let Some(left) = self.narrow(&mut zone, &corner, &mut work, finds) else { return Vec::new() };
        if zone.designs_of(&left) <= regions_to {
            return vec![zone.in_boxes(corner)];
        }
        let zones = match halves {
            Some(_) => Some([zone.clone(), zone.clone()]),
            None => zone.parted(&left, &mut work),
        };
        let Some([a, b]) = zones else { return vec![zone.in_boxes(corner)] };
        let [first, second] = halves.unwrap_or([at; 2]);
        // the first is searched first
        [(second, b), (first, a)]
            .map(|(at, zone)| Task::Region { corners: Arc::clone(&corners), at, zone })
            .into()
    }

    /// Narrows the options as long as that is worth it; `None` if no design is below the corner.
    fn narrow(
        &self,
        zone: &mut Zone<'p>,
        corner: &Corner,
        work: &mut Work,
        finds: &mut Finds,
    ) -> Option<Left> {
        loop {
            self.budget.count_box();
            let (left, narrowed) = zone.narrow(corner, work, |ceiling| self.beats(ceiling, finds))?;
            if !narrowed {
                left.likely.iter().for_each(|cell| self.try_design(zone, cell.clone(), finds));
                return Some(left);
            }
        }
    }

    /// Judges what may be a good design, once.
    fn try_design(&self, zone: &Zone<'p>, mut cell: Cell, finds: &mut Finds) {
        let problem = &zone.problem;
        let Some(options) = problem.options(&cell) else { return };
        let number = number(&problem.level_sizes, &options);
        if self.known.tried.contains(&number) || finds.tried.contains(&number) {
            return;
        }
        finds.tried.push(number);
        let (mut shapes, mut work) = (Arc::clone(&zone.shapes), Work::default());
        self.budget.count_box();
        let beaten = |ceiling: &Ceiling| self.known.found.beats(ceiling) || finds.beats(ceiling);
        if let Verdict::Open(ceiling) = problem.bound(&mut cell, &mut shapes, &mut work, beaten, |_| true) {
            problem.judge(&cell, &ceiling, &work, finds);
        }
    }

    /// The corners that designs found since leave of a region; `None` if none of them is in it.
    fn clipped(&self, corner: &Corner, known: &mut usize) -> Option<Corners> {
        let is_inside = |o: &Objectives| {
            o.mass_kg < corner.mass_kg && o.tip_deflection_m < corner.tip_m && o.lowest_mode_hz > corner.hz
        };
        let all = self.known.found.all();
        let since = all[*known..].iter().map(|o| tightened(o, self.slack));
        let mut inside: Vec<Objectives> = since.filter(is_inside).collect();
        *known = all.len();
        (!inside.is_empty()).then(|| Corners::new(&mut inside, *corner))
    }
}

/// A design taken for better than it is by the slack, so that what is left is missed by more.
fn tightened(found: &Objectives, slack: f64) -> Objectives {
    found.better_by(1.0 + slack - BEATEN)
}

impl<'p> Zone<'p> {
    /// Everything, to begin with.
    pub fn whole(problem: &Problem<'p>, known: usize, work: &mut Work) -> Option<Self> {
        let shapes = problem.first_shapes(work)?;
        Some(Self {
            problem: Arc::new(problem.clone()),
            cell: problem.root(),
            trade: Arc::new(Trade::new(&shapes)),
            shapes: Arc::new(shapes),
            known,
        })
    }

    /// What is left of the zone below a corner, and whether its options were narrowed to it: if enough designs went.
    /// `None` if none is left.
    pub fn narrow(
        &mut self,
        corner: &Corner,
        work: &mut Work,
        is_beaten: impl Fn(&Ceiling) -> bool,
    ) -> Option<(Left, bool)> {
        let before = self.problem.members(&self.cell);
        let verdict = self.problem.bound(
            &mut self.cell,
            &mut self.shapes,
            work,
            |ceiling| !corner.is_in_reach_of(ceiling) || is_beaten(ceiling),
            |_| true,
        );
        let Verdict::Open(ceiling) = verdict else { return None };
        let trade = Arc::make_mut(&mut self.trade);
        let left = self.problem.left_below(&self.cell, &ceiling, trade, work, corner)?;
        let narrowed = self.designs_of(&left) <= (1.0 - WORTH_IT) * before;
        if narrowed {
            self.problem = Arc::new(self.problem.narrowed_to(&left.kept)?);
            self.cell = self.problem.root();
        }
        Some((left, narrowed))
    }

    /// The zone box by box, whatever the forces: that is quick where designs are few.
    fn in_boxes(self, corner: Corner) -> Task<'p> {
        let problem = Arc::new(self.problem.holding_nothing());
        Task::Boxes {
            problem,
            corner,
            first: Opened { cell: self.cell, shapes: self.shapes, ceiling: Ceiling::OPEN },
        }
    }

    /// Designs of what is left.
    pub fn designs_of(&self, left: &Left) -> f64 {
        self.problem.designs_below(&left.kept)
    }

    /// Two zones with half the options of a level each, the level that should gain most; `None` if a single design is
    /// left.
    pub fn parted(&self, left: &Left, work: &mut Work) -> Option<[Self; 2]> {
        let parted = left.partings.iter().find_map(|parting| self.problem.parted(&left.kept, parting));
        if let Some(halves) = parted {
            return Some(halves.map(|half| Self {
                cell: half.root(),
                problem: Arc::new(half),
                ..self.clone()
            }));
        }
        let level = self.problem.widest_level(&self.cell, &self.shapes, work)?;
        let halves = self.problem.halves(&self.cell, level)?;
        Some(halves.map(|half| {
            let mut zone = self.clone();
            zone.cell[level] = half;
            zone
        }))
    }
}
