//! The search for the first incumbents by quick descents (probes). Incumbents are designs that were found already;
//! boxes that they dominate are pruned.
//!
//! A probe minimizes one weighted sum of the logarithms of mass, deflection and the reciprocal of the mode. It follows
//! the half with the better bound of every box down to one design, and then optimizes one level at a time with the
//! other levels fixed. Its result proves nothing, but a search with good incumbents prunes early.

use super::bound::{BoxBound, DesignBox, Verdict};
use super::box_work::BoxWork;
use super::budget::Budget;
use super::evolve::Individual;
use super::problem::Problem;
use super::search_state::{Findings, SearchState};
use super::shape::Shape;
use crate::pareto::objectives::Objectives;
use rayon::prelude::*;
use std::sync::Arc;

/// Greatest number of boxes that the first descent of a probe bounds.
const DIVE_BOXES: usize = 2_000;
/// Greatest number of boxes of the only descent of a short probe ([`dives`]).
const QUICK_DIVE_BOXES: usize = 400;
/// Greatest number of boxes that are bounded while one level is optimized.
const LEVEL_BOXES: usize = 300;
/// Greatest number of rounds in which every level is optimized once.
const MOST_ROUNDS: usize = 3;
/// Fraction of a time limit after which a probe begins no further round.
const MOST_TIME: f64 = 0.1;

/// Weights of mass, deflection and mode in the objective of a probe. They sum to one.
#[derive(Clone, Copy)]
struct Merit([f64; 3]);

impl Merit {
    /// The weights of the three objectives in probe `n`. Roberts' sequence spreads the weights of all probes evenly
    /// over the triangle of possible weights.
    fn nth(n: usize) -> Self {
        const PLASTIC_NUMBER: f64 = 1.324_717_957_244_746;
        let at = |step: f64| (0.5 + (n + 1) as f64 / step).fract();
        let (u, v) = (at(PLASTIC_NUMBER), at(PLASTIC_NUMBER * PLASTIC_NUMBER));
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        Self([u, v, 1.0 - u - v])
    }

    /// The objective of a probe for a bound: the weighted sum of the logarithms of its mass, of its deflection and of
    /// the reciprocal of its mode. Less is better.
    fn of(&self, box_bound: &BoxBound) -> f64 {
        let [mass, tip, mode] = self.0;
        mass * libm::log(box_bound.mass_kg) + tip * libm::log(box_bound.tip_m.max(1e-12))
            - mode * libm::log(box_bound.hz)
    }
}

/// The best design that one probe has found so far, with its trial shapes (motions that bound the lowest mode).
struct Best {
    merit: f64,
    design_box: DesignBox,
    objectives: Objectives,
    shapes: Arc<Vec<Shape>>,
}

/// Runs `probes` probes, each with other weights of the objectives, and adds the designs found to `state`. Returns the
/// best design of each probe.
pub(super) fn probe<'p>(
    budget: &Budget,
    problem: &Problem<'p>,
    probes: usize,
    state: &mut SearchState,
) -> Vec<Individual> {
    let Some(shapes) = problem.first_shapes(&mut BoxWork::default()) else { return Vec::new() };
    let shapes = Arc::new(shapes);
    let probed: Vec<(Option<Individual>, Findings)> = (0..probes)
        .into_par_iter()
        .map(|n| {
            let probe = Probe { budget, problem, merit: Merit::nth(n) };
            let mut findings = Findings::default();
            (probe.best(&shapes, &mut findings), findings)
        })
        .collect();
    let (best, findings): (Vec<_>, Vec<_>) = probed.into_iter().unzip();
    findings.into_iter().for_each(|findings| state.learn(findings));
    best.into_iter().flatten().collect()
}

/// Makes as many short probes as `dives` says, and returns what they find. A short probe descends once and does not
/// optimize the levels one by one.
pub(super) fn dives(budget: &Budget, problem: &Problem, dives: usize) -> Findings {
    let mut all = Findings::default();
    let Some(shapes) = problem.first_shapes(&mut BoxWork::default()) else { return all };
    let shapes = Arc::new(shapes);
    let dive = |n: usize| {
        let (mut work, mut findings) = (BoxWork::default(), Findings::default());
        let probe = Probe { budget, problem, merit: Merit::nth(n) };
        probe.descend(problem.root(), &shapes, QUICK_DIVE_BOXES, None, &mut work, &mut findings);
        findings
    };
    let found: Vec<Findings> = (0..dives).into_par_iter().map(dive).collect();
    found.into_iter().for_each(|findings| all.append(findings));
    all
}

/// One probe: a descent to one good design for one set of weights of the objectives.
struct Probe<'a, 'p> {
    budget: &'a Budget<'p>,
    problem: &'a Problem<'p>,
    merit: Merit,
}

impl Probe<'_, '_> {
    /// The best design that the probe finds. The probe descends from the box of all designs and then optimizes each
    /// level separately. `None` if no design is found.
    fn best(&self, shapes: &Arc<Vec<Shape>>, findings: &mut Findings) -> Option<Individual> {
        let mut work = BoxWork::default();
        let mut best = self.descend(self.problem.root(), shapes, DIVE_BOXES, None, &mut work, findings)?;
        for _ in 0..MOST_ROUNDS {
            let before = best.merit;
            for level in 0..best.design_box.len() {
                let mut design_box = best.design_box.clone();
                design_box[level] = 0;
                let shapes = Arc::clone(&best.shapes);
                best = self.descend(design_box, &shapes, LEVEL_BOXES, Some(best), &mut work, findings)?;
            }
            // A round without improvement means that the design is a local optimum.
            if best.merit >= before || self.budget.has_spent(MOST_TIME) {
                break;
            }
        }
        Some(Individual { design_box: best.design_box, objectives: best.objectives, shapes: best.shapes })
    }

    /// Searches the box `design_box` for a better design than `best`. Better means a smaller merit, which is the
    /// objective of the probe. Of two halves, the half with the better bound is opened first, and at most `most_boxes`
    /// boxes are bounded. Returns the better design, or `best` if none was found.
    fn descend(
        &self,
        design_box: DesignBox,
        shapes: &Arc<Vec<Shape>>,
        most_boxes: usize,
        mut best: Option<Best>,
        work: &mut BoxWork,
        findings: &mut Findings,
    ) -> Option<Best> {
        let mut stack: Vec<Promising> =
            self.look(design_box, shapes, &mut best, work, findings).into_iter().collect();
        let mut boxes = 1;
        while let Some(next) = stack.pop() {
            if boxes >= most_boxes || self.budget.stopped() {
                break;
            }
            // The best design may have improved since this box was put on the stack.
            if best.as_ref().is_some_and(|b| next.merit >= b.merit) {
                continue;
            }
            let Some(halves) = self.problem.halves(&next.design_box, next.level) else { continue };
            let half = |node: u32| {
                let mut design_box = next.design_box.clone();
                design_box[next.level] = node;
                design_box
            };
            let mut open: Vec<Promising> = halves
                .iter()
                .filter_map(|&node| self.look(half(node), &next.shapes, &mut best, work, findings))
                .collect();
            boxes += 2;
            open.sort_by(|a, b| b.merit.total_cmp(&a.merit));
            stack.append(&mut open);
        }
        best
    }

    /// Bounds a box. If the box is one design, the design is evaluated. It replaces the design in `best` if it is
    /// better. Returns the box if it has several designs and one of them may be better than `best`; otherwise `None`.
    fn look(
        &self,
        mut design_box: DesignBox,
        shapes: &Arc<Vec<Shape>>,
        best: &mut Option<Best>,
        work: &mut BoxWork,
        findings: &mut Findings,
    ) -> Option<Promising> {
        let mut shapes = Arc::clone(shapes);
        let least = best.as_ref().map_or(f64::INFINITY, |b| b.merit);
        self.budget.count_box();
        let is_worse = |box_bound: &BoxBound| self.merit.of(box_bound) >= least;
        let verdict = self.problem.bound(&mut design_box, &mut shapes, work, is_worse, |_| true);
        let Verdict::Open(box_bound) = verdict else { return None };
        let merit = self.merit.of(&box_bound);
        match self.problem.widest_level(&design_box, &shapes, work) {
            Some(level) => Some(Promising { merit, design_box, shapes, level }),
            None => {
                let objectives = self.problem.judge(&design_box, &box_bound, work, findings)?;
                *best = Some(Best { merit, design_box, objectives, shapes });
                None
            }
        }
    }
}

/// A box that may contain a better design than the best so far. `merit` is the merit of its bound, and `level` the
/// level along which it is halved.
struct Promising {
    merit: f64,
    design_box: DesignBox,
    shapes: Arc<Vec<Shape>>,
    level: usize,
}
