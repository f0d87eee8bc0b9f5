//! Finds better incumbents than the probes did, by a genetic algorithm that starts with their designs.
//!
//! Incumbents are the designs found so far. The proof of a front is faster with better incumbents, because every design
//! that no incumbent dominates has to be searched. A probe is a quick descent to one good design; the probes find some
//! hundreds of designs one by one. The algorithm makes further designs from these. A child
//! takes some parts from a parent of similar mass, or options close to its first parent's, and is kept if no design
//! seen before dominates it. Of designs that differ by little, one is kept for each cell of a grid
//! ([`thinned`]), so that they do not crowd out the others.
//!
//! The result proves nothing. Its designs are evaluated and listed like all others.

use super::bound::{DesignBox, Verdict};
use super::box_work::BoxWork;
use super::budget::Budget;
use super::grid::thinned;
use super::incumbents::Incumbents;
use super::problem::Problem;
use super::search_state::{Findings, SearchState};
use super::shape::Shape;
use crate::pareto::objectives::Objectives;
use crate::search::sweep::Candidate;
use crate::space::design::number;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use rayon::prelude::*;
use std::sync::Arc;

/// Greatest number of generations. Later generations hardly find better designs.
const GENERATIONS: u64 = 20;
/// Fraction of a time limit after which no further generation begins. The rest of the time is for the passes of the
/// search, because a pass proves a gap and a generation proves nothing.
const MOST_TIME: f64 = 0.25;
/// Greatest number of children in a generation. In a small space, a generation has as many children as the square
/// root of the number of designs.
const MOST_CHILDREN: f64 = 8192.0;
/// Width of a cell of the grid that thins out similar designs, in logarithms of the objectives.
const CELL_WIDTH: f64 = 0.02;
/// Greatest distance between the two parents of a child, in places of the list of designs by mass.
const MATING_DISTANCE: u64 = 12;

/// A design with trial shapes that bound its modes. The shapes were computed for this design or for a similar design.
pub(super) struct Individual {
    pub design_box: DesignBox,
    pub objectives: Objectives,
    pub shapes: Arc<Vec<Shape>>,
}

/// The result of one recombination.
enum Offspring {
    /// The child has the same parts as its first parent.
    Unchanged,
    /// A design that was found before dominates the child, a part of the child cannot carry its load, or even the
    /// bound of the child breaks a limit.
    Dominated,
    /// The child breaks a constraint, or rounding leaves open whether a part of it carries its load.
    Infeasible,
    /// The child meets every constraint, and no design that was found before dominates it.
    Feasible(Individual),
}

impl Offspring {
    /// Whether the three objectives of the child were computed.
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

/// Evolves new designs from the designs in `first` and adds them to `state`. After each generation, `tell` receives
/// the objectives of the designs from which the next generation is made, and the number of designs whose objectives
/// were computed.
pub(super) fn evolve<'p>(
    budget: &Budget,
    problem: &Problem<'p>,
    first: Vec<Individual>,
    state: &mut SearchState,
    tell: impl Fn(&[Objectives], u64),
) {
    let mut seen = Incumbents::default();
    first.iter().for_each(|member| seen.enter(&member.objectives));
    let mut parents = by_mass(first);
    let children_per_generation = (problem.designs() as f64).sqrt().min(MOST_CHILDREN) as u64;
    let mut findings = Findings::default();
    for generation in 0..GENERATIONS {
        if parents.is_empty() || budget.has_spent(MOST_TIME) {
            break;
        }
        let children = (0..children_per_generation).into_par_iter().map_init(BoxWork::default, |work, n| {
            let rng = Xoshiro256PlusPlus::seed_from_u64(generation * children_per_generation + n);
            Recombination { budget, problem, parents: &parents, seen: &seen, rng }.child(work)
        });
        let offspring: Vec<Offspring> = children.collect();
        findings.evaluated += offspring.iter().filter(|child| child.is_evaluated()).count() as u64;
        let children: Vec<Individual> = offspring.into_iter().filter_map(Offspring::feasible).collect();
        children.iter().for_each(|member| seen.enter(&member.objectives));
        parents.extend(children);
        parents = by_mass(parents);
        let found: Vec<Objectives> = parents.iter().map(|member| member.objectives).collect();
        tell(&found, state.evaluated + findings.evaluated);
    }
    let candidate = |member: &Individual| {
        let options = problem.options(&member.design_box)?;
        Some(Candidate { number: number(&problem.level_sizes, &options), objectives: member.objectives })
    };
    findings.kept.extend(parents.iter().filter_map(candidate));
    state.learn(findings);
}

/// Keeps one design for each cell of the grid over the objectives, and sorts them by mass, the lightest first.
fn by_mass(members: Vec<Individual>) -> Vec<Individual> {
    let mut kept = thinned(members, CELL_WIDTH, |member| &member.objectives);
    kept.sort_by(|a, b| a.objectives.mass_kg.total_cmp(&b.objectives.mass_kg));
    kept
}

/// The inputs for making one child.
struct Recombination<'a, 'p> {
    budget: &'a Budget<'p>,
    problem: &'a Problem<'p>,
    /// The designs of the present generation, by rising mass.
    parents: &'a [Individual],
    /// All designs found before, against which the child is compared.
    seen: &'a Incumbents,
    rng: Xoshiro256PlusPlus,
}

impl Recombination<'_, '_> {
    /// Makes one child of two parents, bounds it and tests the constraints.
    fn child(mut self, work: &mut BoxWork) -> Offspring {
        let first = self.below(self.parents.len() as u64);
        let from = first.saturating_sub(MATING_DISTANCE);
        let to = (first + MATING_DISTANCE + 1).min(self.parents.len() as u64);
        let second = from + self.below(to - from);
        let [parent, other] = [first, second].map(|i| &self.parents[i as usize]);
        let mut design_box = parent.design_box.clone();
        if self.below(2) == 0 {
            self.exchange(&mut design_box, &other.design_box);
        }
        // A child that has only the parts of its first parent is changed in any case.
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

    /// Replaces each option of `design_box` with a probability of about a third by the option of `other` at the same
    /// level.
    fn exchange(&mut self, design_box: &mut DesignBox, other: &DesignBox) {
        for (mine, theirs) in design_box.iter_mut().zip(other) {
            if self.below(3) == 0 {
                *mine = *theirs;
            }
        }
    }

    /// Replaces the option of a level by a random option below a node of the tree that contains the present option.
    /// Small nodes, and thus similar options, are more likely.
    fn change(&mut self, design_box: &mut DesignBox, level: usize) {
        let problem = self.problem;
        let option = std::mem::take(&mut design_box[level]);
        let mut around = vec![design_box[level]];
        while let Some([low, high]) = problem.halves(design_box, level) {
            // The nodes of a tree are numbered from the root. All nodes of the first half have lower numbers than those
            // of the second half.
            design_box[level] = if option < high { low } else { high };
            around.push(design_box[level]);
        }
        // Each further step up the tree is half as likely, which favours similar options.
        let mut up = 1 + self.below(3) as usize;
        while self.below(2) == 0 {
            up += 1;
        }
        design_box[level] = around[around.len().saturating_sub(1 + up)];
        while let Some(halves) = problem.halves(design_box, level) {
            design_box[level] = halves[self.below(2) as usize];
        }
    }

    /// A random whole number below `n`.
    fn below(&mut self, n: u64) -> u64 {
        ((u128::from(self.rng.next_u64()) * u128::from(n)) >> 64) as u64
    }
}
