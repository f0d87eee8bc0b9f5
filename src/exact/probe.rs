//! Good designs to start from: what the bounds think best, then each part at its best given the others.
//!
//! A probe minimizes one weighting of the logarithms of mass, deflection and mode. It follows the better
//! half of every box down to one design, then lets one level at a time go free. What it finds proves
//! nothing and is not lost: a search that knows good designs cuts early.

use super::bound::{Ceiling, Cell, Verdict, Work};
use super::budget::Budget;
use super::evolve::Member;
use super::known::{Finds, Known};
use super::problem::Problem;
use super::shape::Shape;
use crate::pareto::objectives::Objectives;
use rayon::prelude::*;
use std::sync::Arc;

/// Boxes that the way down from the box of everything may open.
const DIVE_BOXES: usize = 2_000;
/// Boxes that a level left free may open.
const LEVEL_BOXES: usize = 300;
/// Times every level is let go free.
const ROUNDS: usize = 3;

/// Weights of mass, deflection and mode.
#[derive(Clone, Copy)]
struct Merit([f64; 3]);

impl Merit {
    /// Spread evenly over all proportions: Roberts' sequence with the plastic number, folded into the
    /// triangle of weights that add up to one.
    fn nth(n: usize) -> Self {
        const PLASTIC: f64 = 1.324_717_957_244_746;
        let at = |step: f64| (0.5 + (n + 1) as f64 / step).fract();
        let (u, v) = (at(PLASTIC), at(PLASTIC * PLASTIC));
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        Self([u, v, 1.0 - u - v])
    }

    /// Less is better.
    fn of(&self, ceiling: &Ceiling) -> f64 {
        let [mass, tip, mode] = self.0;
        mass * ceiling.mass_kg.ln() + tip * ceiling.tip_m.max(1e-12).ln() - mode * ceiling.hz.ln()
    }
}

/// The best design so far of one probe.
struct Best {
    merit: f64,
    cell: Cell,
    objectives: Objectives,
    shapes: Arc<Vec<Shape>>,
}

/// Probes the space in so many proportions of the objectives.
pub(super) fn probe<'p>(
    budget: &Budget,
    problem: &Problem<'p>,
    probes: usize,
    known: &mut Known,
) -> Vec<Member> {
    let Some(shapes) = problem.first_shapes(&mut Work::default()) else { return Vec::new() };
    let shapes = Arc::new(shapes);
    let probed: Vec<(Option<Member>, Finds)> = (0..probes)
        .into_par_iter()
        .map(|n| {
            let probe = Probe { budget, problem, merit: Merit::nth(n) };
            let mut finds = Finds::default();
            (probe.best(&shapes, &mut finds), finds)
        })
        .collect();
    let (best, finds): (Vec<_>, Vec<_>) = probed.into_iter().unzip();
    finds.into_iter().for_each(|finds| known.learn(finds));
    best.into_iter().flatten().collect()
}

/// One probe.
struct Probe<'a, 'p> {
    budget: &'a Budget<'p>,
    problem: &'a Problem<'p>,
    merit: Merit,
}

impl Probe<'_, '_> {
    /// The best design that it finds: down from the box of everything, then each level by itself.
    fn best(&self, shapes: &Arc<Vec<Shape>>, finds: &mut Finds) -> Option<Member> {
        let mut work = Work::default();
        let mut best = self.descend(self.problem.root(), shapes, DIVE_BOXES, None, &mut work, finds)?;
        for _ in 0..ROUNDS {
            let before = best.merit;
            for level in 0..best.cell.len() {
                let mut cell = best.cell.clone();
                cell[level] = 0;
                let shapes = Arc::clone(&best.shapes);
                best = self.descend(cell, &shapes, LEVEL_BOXES, Some(best), &mut work, finds)?;
            }
            if best.merit >= before || self.budget.stopped() {
                break;
            }
        }
        Some(Member { cell: best.cell, objectives: best.objectives, shapes: best.shapes })
    }

    /// The design of most merit in a box, or the best known, the better half looked at first.
    fn descend(
        &self,
        cell: Cell,
        shapes: &Arc<Vec<Shape>>,
        most_boxes: usize,
        mut best: Option<Best>,
        work: &mut Work,
        finds: &mut Finds,
    ) -> Option<Best> {
        let mut stack: Vec<Promising> = self.look(cell, shapes, &mut best, work, finds).into_iter().collect();
        let mut boxes = 1;
        while let Some(next) = stack.pop() {
            if boxes >= most_boxes || self.budget.stopped() {
                break;
            }
            if best.as_ref().is_some_and(|b| next.merit >= b.merit) {
                continue;
            }
            let Some(halves) = self.problem.halves(&next.cell, next.level) else { continue };
            let half = |node: u32| {
                let mut cell = next.cell.clone();
                cell[next.level] = node;
                cell
            };
            let mut open: Vec<Promising> = halves
                .iter()
                .filter_map(|&node| self.look(half(node), &next.shapes, &mut best, work, finds))
                .collect();
            boxes += 2;
            open.sort_by(|a, b| b.merit.total_cmp(&a.merit));
            stack.append(&mut open);
        }
        best
    }

    /// Bounds a box; a box of one design is judged and remembered if it is the best.
    fn look(
        &self,
        mut cell: Cell,
        shapes: &Arc<Vec<Shape>>,
        best: &mut Option<Best>,
        work: &mut Work,
        finds: &mut Finds,
    ) -> Option<Promising> {
        let mut shapes = Arc::clone(shapes);
        let least = best.as_ref().map_or(f64::INFINITY, |b| b.merit);
        self.budget.count_box();
        let is_worse = |ceiling: &Ceiling| self.merit.of(ceiling) >= least;
        let verdict = self.problem.bound(&mut cell, &mut shapes, work, is_worse, |_| true);
        let Verdict::Open(ceiling) = verdict else { return None };
        let merit = self.merit.of(&ceiling);
        match self.problem.widest_level(&cell, &shapes, work) {
            Some(level) => Some(Promising { merit, cell, shapes, level }),
            None => {
                let objectives = self.problem.judge(&cell, &ceiling, work, finds)?;
                *best = Some(Best { merit, cell, objectives, shapes });
                None
            }
        }
    }
}

/// A box that may hold a design of more merit than the best.
struct Promising {
    merit: f64,
    cell: Cell,
    shapes: Arc<Vec<Shape>>,
    level: usize,
}
