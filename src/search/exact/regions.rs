//! Region by region: what the designs found leave open is taken apart, and for each part of it the options are
//! narrowed to those that a design there may have at all.
//!
//! A region is all that is below a [`Corner`]. Far fewer options reach into it than there are: a weighting of what a
//! corner allows excludes every option that costs more than the corner can afford ([`narrow`](super::narrow)), and
//! with fewer options the bounds are sharper, so more can be excluded. Whole groups of corners are refuted so, under the
//! corner that bounds them; those that are not are taken apart, then their options or a torque parted
//! ([`parting`](super::parting)) until few designs are left, which are searched box by box.

use super::bound::{Ceiling, Cell, Verdict, Work};
use super::corners::{Corner, Corners};
use super::grid::thinned;
use super::left::Left;
use super::problem::Problem;
use super::run::{Opened, Search, lock};
use super::shape::Shape;
use super::tradeoff::{BEATEN, Trade};
use crate::search::Objectives;
use crate::search::design::number;
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

impl<'p> Search<'_, 'p> {
    /// One pass over everything that the designs found leave open.
    pub fn run_by_regions(&self) {
        let mut work = Work::default();
        let tightened = |all: &[Objectives]| all.iter().map(|o| self.tightened(o)).collect();
        let found: Vec<Objectives> = self.shared.found.look_at_all(tightened);
        let known = found.len();
        // fewer designs leave more open, by less than the slack
        let mut found = thinned(found, THINNED * self.slack, |o| o);
        let corners = Corners::new(&mut found, self.limits());
        let Some(zone) = Zone::whole(self.problem, known, &mut work) else { return };
        self.search_region(&corners, 0, zone);
    }

    /// Searches what is below a node of a tree of corners.
    fn search_region(&self, corners: &Corners, at: usize, mut zone: Zone<'p>) {
        let Some((corner, halves)) = corners.node(at) else { return };
        if halves.is_none()
            && let Some(clipped) = self.clipped(&corner, &mut zone.known)
        {
            return self.search_region(&clipped, 0, zone);
        }
        let mut work = Work::default();
        let Some(left) = self.narrow(&mut zone, &corner, &mut work) else { return };
        if zone.designs_of(&left) <= self.down_to() {
            return self.search_boxes(zone, corner, work);
        }
        let zones = match halves {
            Some(_) => Some([zone.clone(), zone.clone()]),
            None => zone.parted(&left, &mut work),
        };
        let Some([a, b]) = zones else { return self.search_boxes(zone, corner, work) };
        let [first, second] = halves.unwrap_or([at; 2]);
        rayon::join(|| self.search_region(corners, first, a), || self.search_region(corners, second, b));
    }

    /// Narrows the options as long as that is worth it; `None` if no design is below the corner, or if the search was
    /// stopped.
    fn narrow(&self, zone: &mut Zone<'p>, corner: &Corner, work: &mut Work) -> Option<Left> {
        loop {
            if self.stopped() {
                lock(&self.shared.open).push(Ceiling::OPEN);
                return None;
            }
            self.count_box();
            let beaten = |ceiling: &Ceiling| self.shared.found.beats(&ceiling.slackened(self.slack));
            let (left, narrowed) = zone.narrow(corner, work, beaten)?;
            if !narrowed {
                left.likely.iter().for_each(|cell| self.try_design(zone, cell.clone()));
                return Some(left);
            }
        }
    }

    /// Judges what may be a good design, once.
    fn try_design(&self, zone: &Zone<'p>, mut cell: Cell) {
        let Some(options) = zone.problem.options(&cell) else { return };
        if !lock(&self.shared.tried).insert(number(&zone.problem.level_sizes, &options)) {
            return;
        }
        let (mut shapes, mut work) = (Arc::clone(&zone.shapes), Work::default());
        self.count_box();
        let beaten = |ceiling: &Ceiling| self.shared.found.beats(ceiling);
        if let Verdict::Open(ceiling) =
            zone.problem.bound(&mut cell, &mut shapes, &mut work, beaten, |_| true)
        {
            self.of_part(&zone.problem, None).judge(&cell, &ceiling, &work);
        }
    }

    /// Searches the designs left in a region box by box, whatever the forces: that is quick where designs are few.
    fn search_boxes(&self, zone: Zone<'p>, corner: Corner, mut work: Work) {
        let problem = zone.problem.holding_nothing();
        let search = self.of_part(&problem, Some(corner));
        let (cell, shapes) = (zone.cell.clone(), Arc::clone(&zone.shapes));
        let mut stack = vec![Opened { cell, shapes, ceiling: Ceiling::OPEN }];
        while let Some(next) = stack.pop() {
            if self.stopped() {
                return lock(&self.shared.open).push(Ceiling::OPEN);
            }
            search.open(next, &mut work, &mut stack);
        }
    }

    /// A design taken for better than it is by the slack, so that what is left is missed by more.
    fn tightened(&self, found: &Objectives) -> Objectives {
        found.better_by(1.0 + self.slack - BEATEN)
    }

    /// The corners that designs found since leave of a region; `None` if none of them is in it.
    fn clipped(&self, corner: &Corner, known: &mut usize) -> Option<Corners> {
        let is_inside = |o: &Objectives| {
            o.mass_kg < corner.mass_kg && o.tip_deflection_m < corner.tip_m && o.lowest_mode_hz > corner.hz
        };
        let mut inside: Vec<Objectives> = self.shared.found.look_at_all(|all| {
            let since = &all[*known..];
            *known = all.len();
            since.iter().map(|o| self.tightened(o)).filter(is_inside).collect()
        });
        (!inside.is_empty()).then(|| Corners::new(&mut inside, *corner))
    }
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
