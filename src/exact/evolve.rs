//! Better designs from those that the probes found, by exchange of parts.
//!
//! The proof of a front is only as good as its designs: what they leave open has to be taken apart. Probes find some
//! hundreds one by one. From these come others, as in a genetic algorithm: a child takes some parts of a design close by
//! in mass, or parts close to its own, and stays if nothing seen before beats it. So that the many that differ by
//! little do not crowd out the others, one design a cell of a grid is kept ([`thinned`](super::grid::thinned)). What is found proves nothing; it is judged and listed like every other design.

use super::archive::Found;
use super::bound::{Cell, Verdict, Work};
use super::budget::Budget;
use super::grid::thinned;
use super::known::{Finds, Known};
use super::problem::Problem;
use super::shape::Shape;
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
pub(super) struct Member {
    pub cell: Cell,
    pub objectives: Objectives,
    pub shapes: Arc<Vec<Shape>>,
}

/// Finds designs that come of some, for generations.
pub(super) fn evolve<'p>(budget: &Budget, problem: &Problem<'p>, first: Vec<Member>, known: &mut Known) {
    let mut seen = Found::default();
    first.iter().for_each(|member| seen.enter(&member.objectives));
    let mut parents = by_mass(first);
    let brood = (problem.designs() as f64).sqrt().min(MOST_CHILDREN) as u64;
    let mut finds = Finds::default();
    for generation in 0..GENERATIONS {
        if parents.is_empty() || budget.stopped() {
            break;
        }
        let children = (0..brood).into_par_iter().map_init(Work::default, |work, n| {
            let dice = Xoshiro256PlusPlus::seed_from_u64(generation * brood + n);
            Mating { budget, problem, parents: &parents, seen: &seen, dice }.child(work)
        });
        let judged: Vec<Option<Member>> = children.flatten().collect();
        finds.evaluated += judged.len() as u64;
        let children: Vec<Member> = judged.into_iter().flatten().collect();
        children.iter().for_each(|member| seen.enter(&member.objectives));
        parents.extend(children);
        parents = by_mass(parents);
    }
    let candidate = |member: &Member| {
        let options = problem.options(&member.cell)?;
        Some(Candidate { number: number(&problem.level_sizes, &options), objectives: member.objectives })
    };
    finds.kept.extend(parents.iter().filter_map(candidate));
    known.learn(finds);
}

/// One design a cell, the lightest first.
fn by_mass(members: Vec<Member>) -> Vec<Member> {
    let mut kept = thinned(members, STEP, |member| &member.objectives);
    kept.sort_by(|a, b| a.objectives.mass_kg.total_cmp(&b.objectives.mass_kg));
    kept
}

/// Where one child comes from.
struct Mating<'a, 'p> {
    budget: &'a Budget<'p>,
    problem: &'a Problem<'p>,
    parents: &'a [Member],
    seen: &'a Found,
    dice: Xoshiro256PlusPlus,
}

impl Mating<'_, '_> {
    /// A child that nothing seen beats, if it meets the constraints; none at all if something beats it.
    fn child(mut self, work: &mut Work) -> Option<Option<Member>> {
        let first = self.below(self.parents.len() as u64);
        let from = first.saturating_sub(CLOSE);
        let to = (first + CLOSE + 1).min(self.parents.len() as u64);
        let second = from + self.below(to - from);
        let [parent, other] = [first, second].map(|i| &self.parents[i as usize]);
        let mut cell = parent.cell.clone();
        if self.below(2) == 0 {
            self.exchange(&mut cell, &other.cell);
        }
        let changes = self.below(2) + u64::from(cell == parent.cell);
        for _ in 0..changes {
            let level = self.below(cell.len() as u64) as usize;
            self.change(&mut cell, level);
        }
        if cell == parent.cell {
            return None;
        }
        self.budget.count_box();
        let mut shapes = Arc::clone(&parent.shapes);
        let verdict = self.problem.bound(&mut cell, &mut shapes, work, |c| self.seen.beats(c), |_| true);
        let Verdict::Open(ceiling) = verdict else { return None };
        let objectives = self.problem.objectives(&ceiling, work);
        let holds = work.is_point() && !self.problem.space.constraints.broken(&objectives).contains(&true);
        let shapes = Arc::clone(&parent.shapes);
        Some(holds.then_some(Member { cell, objectives, shapes }))
    }

    /// Takes a third of another design's parts.
    fn exchange(&mut self, cell: &mut Cell, other: &Cell) {
        for (mine, theirs) in cell.iter_mut().zip(other) {
            if self.below(3) == 0 {
                *mine = *theirs;
            }
        }
    }

    /// Takes another option of a level: any below a box around the present one, more often a small box.
    fn change(&mut self, cell: &mut Cell, level: usize) {
        let problem = self.problem;
        let option = std::mem::take(&mut cell[level]);
        let mut around = vec![cell[level]];
        while let Some([low, high]) = problem.halves(cell, level) {
            // trees are numbered from the root, the first half before the second
            cell[level] = if option < high { low } else { high };
            around.push(cell[level]);
        }
        let mut up = 1 + self.below(3) as usize;
        while self.below(2) == 0 {
            up += 1;
        }
        cell[level] = around[around.len().saturating_sub(1 + up)];
        while let Some(halves) = problem.halves(cell, level) {
            cell[level] = halves[self.below(2) as usize];
        }
    }

    /// A whole number below another.
    fn below(&mut self, n: u64) -> u64 {
        ((u128::from(self.dice.next_u64()) * u128::from(n)) >> 64) as u64
    }
}
