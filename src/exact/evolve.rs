//! Better designs from those that the probes found, by exchange of parts.
//!
//! The proof of a front is only as good as its designs: what they leave open has to be taken apart. Probes find some
//! hundreds one by one. From these come others, as in a genetic algorithm: a child takes some parts of a design close by
//! in mass, or parts close to its own, and stays if nothing seen before beats it. So that the many that differ by
//! little do not crowd out the others, one design a cell of a grid is kept ([`thinned`](super::grid::thinned)). What is found proves nothing; it is judged and listed like every other design.

use super::bound::{DesignBox, Verdict};
use super::budget::Budget;
use super::grid::thinned;
use super::incumbents::Incumbents;
use super::problem::Problem;
use super::search_state::{Findings, SearchState};
use super::shape::Shape;
use super::work::Work;
use crate::pareto::objectives::Objectives;
use crate::search::sweep::Candidate;
use crate::space::design::number;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use rayon::prelude::*;
use std::sync::Arc;

/// Generations at most: later ones hardly find better designs.
const GENERATIONS: u64 = 20;
/// Children of a generation at most; a space has no more than the root of its designs.
const MOST_CHILDREN: f64 = 8192.0;
/// Step of the grid, in logarithms of the objectives.
const STEP: f64 = 0.02;
/// Places in the order of mass within which the other parent is.
const CLOSE: u64 = 12;

/// A design with the shapes that bound its modes, or those of a design like it.
pub(super) struct Individual {
    pub design_box: DesignBox,
    pub objectives: Objectives,
    pub shapes: Arc<Vec<Shape>>,
}

/// What became of a child of two designs.
enum Offspring {
    /// It has the parts of its parent.
    Unchanged,
    /// A design seen before is at least as good in every objective, or a part cannot carry its load.
    Dominated,
    /// Its objectives are known, and it breaks a constraint.
    Infeasible,
    /// It meets every constraint, and nothing seen before is better.
    Feasible(Individual),
}

impl Offspring {
    /// Whether its three objectives were computed.
    fn is_evaluated(&self) -> bool {
        matches!(self, Self::Infeasible | Self::Feasible(_))
    }

    fn feasible(self) -> Option<Individual> {
        match self {
            Self::Feasible(individual) => Some(individual),
            _ => None,
        }
    }
}

/// Finds designs that come of some, for generations.
pub(super) fn evolve<'p>(
    budget: &Budget,
    problem: &Problem<'p>,
    first: Vec<Individual>,
    state: &mut SearchState,
) {
    let mut seen = Incumbents::default();
    first.iter().for_each(|member| seen.enter(&member.objectives));
    let mut parents = by_mass(first);
    let children_per_generation = (problem.designs() as f64).sqrt().min(MOST_CHILDREN) as u64;
    let mut findings = Findings::default();
    for generation in 0..GENERATIONS {
        if parents.is_empty() || budget.stopped() {
            break;
        }
        let children = (0..children_per_generation).into_par_iter().map_init(Work::default, |work, n| {
            let rng = Xoshiro256PlusPlus::seed_from_u64(generation * children_per_generation + n);
            Recombination { budget, problem, parents: &parents, seen: &seen, rng }.child(work)
        });
        let offspring: Vec<Offspring> = children.collect();
        findings.evaluated += offspring.iter().filter(|child| child.is_evaluated()).count() as u64;
        let children: Vec<Individual> = offspring.into_iter().filter_map(Offspring::feasible).collect();
        children.iter().for_each(|member| seen.enter(&member.objectives));
        parents.extend(children);
        parents = by_mass(parents);
    }
    let candidate = |member: &Individual| {
        let options = problem.options(&member.design_box)?;
        Some(Candidate { number: number(&problem.level_sizes, &options), objectives: member.objectives })
    };
    findings.kept.extend(parents.iter().filter_map(candidate));
    state.learn(findings);
}

/// One design a cell, the lightest first.
fn by_mass(members: Vec<Individual>) -> Vec<Individual> {
    let mut kept = thinned(members, STEP, |member| &member.objectives);
    kept.sort_by(|a, b| a.objectives.mass_kg.total_cmp(&b.objectives.mass_kg));
    kept
}

/// Where one child comes from.
struct Recombination<'a, 'p> {
    budget: &'a Budget<'p>,
    problem: &'a Problem<'p>,
    parents: &'a [Individual],
    seen: &'a Incumbents,
    rng: Xoshiro256PlusPlus,
}

impl Recombination<'_, '_> {
    /// A child that nothing seen beats, if it meets the constraints; none at all if something beats it.
    fn child(mut self, work: &mut Work) -> Offspring {
        let first = self.below(self.parents.len() as u64);
        let from = first.saturating_sub(CLOSE);
        let to = (first + CLOSE + 1).min(self.parents.len() as u64);
        let second = from + self.below(to - from);
        let [parent, other] = [first, second].map(|i| &self.parents[i as usize]);
        let mut design_box = parent.design_box.clone();
        if self.below(2) == 0 {
            self.exchange(&mut design_box, &other.design_box);
        }
        let changes = self.below(2) + u64::from(design_box == parent.design_box);
        for _ in 0..changes {
            let level = self.below(design_box.len() as u64) as usize;
            self.change(&mut design_box, level);
        }
        if design_box == parent.design_box {
            return Offspring::Unchanged;
        }
        self.budget.count_box();
        let mut shapes = Arc::clone(&parent.shapes);
        let verdict =
            self.problem.bound(&mut design_box, &mut shapes, work, |c| self.seen.dominates(c), |_| true);
        let Verdict::Open(box_bound) = verdict else { return Offspring::Dominated };
        let objectives = self.problem.objectives(&box_bound, work);
        if !work.is_point() || self.problem.space.constraints.broken(&objectives).contains(&true) {
            return Offspring::Infeasible;
        }
        let shapes = Arc::clone(&parent.shapes);
        Offspring::Feasible(Individual { design_box, objectives, shapes })
    }

    /// Takes a third of another design's parts.
    fn exchange(&mut self, design_box: &mut DesignBox, other: &DesignBox) {
        for (mine, theirs) in design_box.iter_mut().zip(other) {
            if self.below(3) == 0 {
                *mine = *theirs;
            }
        }
    }

    /// Takes another option of a level: any below a box around the present one, more often a small box.
    fn change(&mut self, design_box: &mut DesignBox, level: usize) {
        let problem = self.problem;
        let option = std::mem::take(&mut design_box[level]);
        let mut around = vec![design_box[level]];
        while let Some([low, high]) = problem.halves(design_box, level) {
            // trees are numbered from the root, the first half before the second
            design_box[level] = if option < high { low } else { high };
            around.push(design_box[level]);
        }
        let mut up = 1 + self.below(3) as usize;
        while self.below(2) == 0 {
            up += 1;
        }
        design_box[level] = around[around.len().saturating_sub(1 + up)];
        while let Some(halves) = problem.halves(design_box, level) {
            design_box[level] = halves[self.below(2) as usize];
        }
    }

    /// A whole number below another.
    fn below(&mut self, n: u64) -> u64 {
        ((u128::from(self.rng.next_u64()) * u128::from(n)) >> 64) as u64
    }
}
