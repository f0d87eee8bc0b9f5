//! Which limits stand in the way of every design, and how far they have to be relaxed.
//!
//! A limit is dropped, and an exact search is asked for the best design in the limited quantity that meets all else. If the
//! quantity is no objective, the search is asked for any design, and the limit is bisected between what is asked and what
//! that design reaches; each step asks for any design that meets the middle. If no limit helps alone, pairs are tried,
//! then triples.

use super::limit::Quantity;
use crate::catalog::Catalogs;
use crate::exact::run::Exact;
use crate::space::constraint::Constraints;
use crate::space::design::{evaluate, number};
use crate::space::design_space::DesignSpace;
use crate::space::joints::TabulatedJoints;
use crate::space::levels::OutwardIn;
use crate::space::problem::ArmProblem;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// A limit is known well enough when it is bracketed to this (relative).
const CLOSE: f64 = 2e-6;
/// A limit of zero is bisected from this part of what is reached: the middle is a geometric mean.
const LEAST: f64 = 1e-12;
/// A gap that any design closes.
const ANY: f64 = 1e9;

/// Limits that have to be relaxed together, each with the value that is reached then.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Relaxation {
    pub limits: Vec<(Quantity, f64)>,
    /// Whether less would not do. If not, time ran out before this was known.
    pub is_smallest: bool,
}

/// Whether a space has a design.
enum Answer<T> {
    Yes(T),
    No,
    /// Time ran out.
    Unknown,
}

/// A space whose limits can be changed.
pub(super) struct Limited<'a> {
    pub space: &'a DesignSpace,
    pub catalogs: &'a Catalogs,
    /// The joints of the space, which no limit changes.
    pub joints: TabulatedJoints<'a>,
    pub stop: &'a AtomicBool,
    pub deadline: Instant,
}

impl Limited<'_> {
    /// Whether some design holds if all limits are dropped; `None` if time ran out before this was known.
    pub(super) fn holds_without_limits(&self) -> Option<bool> {
        match self.find(&Constraints::default(), Quantity::Mass, |search| search.to_gap(ANY)) {
            Answer::Yes(_) => Some(true),
            Answer::No => Some(false),
            Answer::Unknown => None,
        }
    }

    /// The relaxations that help, of as few limits as possible; with `false` if time ran out before all were tried.
    pub(super) fn relaxations(&self) -> (Vec<Relaxation>, bool) {
        let limits = Quantity::limited(&self.space.constraints);
        let mut is_all = true;
        for size in 1..=limits.len() {
            let mut found = Vec::new();
            for set in subsets(&limits, size) {
                match self.relaxed(&set) {
                    Answer::Yes(relaxation) => found.push(relaxation),
                    Answer::No => {}
                    Answer::Unknown => is_all = false,
                }
            }
            if !found.is_empty() {
                return (found, is_all);
            }
        }
        (Vec::new(), is_all)
    }

    /// The smallest relaxation of some limits together: of the first as little as possible with the others dropped, then
    /// of the second, and so on.
    fn relaxed(&self, set: &[Quantity]) -> Answer<Relaxation> {
        let mut constraints = self.space.constraints;
        set.iter().for_each(|quantity| quantity.set(&mut constraints, None));
        let (mut limits, mut is_smallest) = (Vec::new(), true);
        for &quantity in set {
            let (reached, is_least) = match self.best(&constraints, quantity) {
                Answer::Yes(best) => best,
                Answer::No => return Answer::No,
                Answer::Unknown => return Answer::Unknown,
            };
            // a little room, so that rounding does not exclude the design that reaches it
            let roomy = if quantity.is_least() { reached / (1.0 + CLOSE) } else { reached * (1.0 + CLOSE) };
            quantity.set(&mut constraints, Some(roomy));
            limits.push((quantity, reached));
            is_smallest &= is_least;
        }
        Answer::Yes(Relaxation { limits, is_smallest })
    }

    /// The best value of a quantity under some limits, with `false` if time ran out before none was known to be better.
    fn best(&self, constraints: &Constraints, quantity: Quantity) -> Answer<(f64, bool)> {
        if let Some(objective) = quantity.objective() {
            return self.find(constraints, quantity, |search| search.toward(objective));
        }
        match self.find(constraints, quantity, |search| search.to_gap(ANY)) {
            Answer::Yes((reached, _)) => Answer::Yes(self.bisected(constraints, quantity, reached)),
            other => other,
        }
    }

    /// The value of a limit nearest to what is asked that some design reaches, between what is asked, in vain, and what is
    /// reached; with `false` if time ran out.
    fn bisected(&self, constraints: &Constraints, quantity: Quantity, reached: f64) -> (f64, bool) {
        // what a limit costs rises from the value asked to the value reached, for minima from the reciprocals
        let cost = |value: f64| if quantity.is_least() { value.recip() } else { value };
        let asked = quantity.asked(&self.space.constraints).unwrap_or_default();
        let (mut in_vain, mut enough) = (cost(asked).max(cost(reached) * LEAST), cost(reached));
        while enough > in_vain * (1.0 + CLOSE) {
            let middle = (in_vain * enough).sqrt();
            let mut tried = *constraints;
            quantity.set(&mut tried, Some(cost(middle)));
            match self.find(&tried, quantity, |search| search.to_gap(ANY)) {
                Answer::Yes((reached, _)) => enough = cost(reached).min(middle),
                Answer::No => in_vain = middle,
                Answer::Unknown => return (cost(enough), false),
            }
        }
        (cost(enough), true)
    }

    /// The best value of a quantity among the designs that an exact search finds under some limits, and whether the search
    /// was done. `how` says what it is to find.
    fn find(
        &self,
        constraints: &Constraints,
        quantity: Quantity,
        how: impl for<'p> Fn(Exact<'p>) -> Exact<'p>,
    ) -> Answer<(f64, bool)> {
        let space = DesignSpace { constraints: *constraints, ..self.space.clone() };
        let search = Exact::new(&space, self.catalogs, self.stop, Some(self.deadline));
        let search = search.with_joints(self.joints.clone()).by_regions_from(f64::INFINITY);
        let found = how(search).run(&[]);
        let numbers: Vec<u128> = found.front.iter().map(|candidate| candidate.number).collect();
        let best = space.excerpt_with(&self.joints, &numbers).and_then(|part| {
            let problem = ArmProblem::with_joints(&part, &self.joints);
            let values = numbers.iter().filter_map(|&design| reached(&problem, design, quantity));
            values.reduce(if quantity.is_least() { f64::max } else { f64::min })
        });
        match (best, found.boxes_open) {
            (Some(value), open) => Answer::Yes((value, open == 0)),
            (None, 0) => Answer::No,
            (None, _) => Answer::Unknown,
        }
    }
}

/// What a design of the whole space reaches by the full model; `None` if it does not meet the limits.
fn reached(problem: &ArmProblem, design: u128, quantity: Quantity) -> Option<f64> {
    let options = problem.options_of_whole(design)?;
    let judged = evaluate(problem, number(problem.level_sizes(), &options))?;
    if problem.space().constraints.broken(&judged.objectives).contains(&true) {
        return None;
    }
    let arm = problem.walk(&options, |_, _| {}).ok()?;
    quantity.of(problem, &arm, &judged.objectives)
}

/// The subsets of a size, in the order of the list.
fn subsets<T: Copy>(list: &[T], size: usize) -> Vec<Vec<T>> {
    match (size, list) {
        (0, _) => vec![Vec::new()],
        (_, []) => Vec::new(),
        (_, [first, rest @ ..]) => {
            let with = subsets(rest, size - 1).into_iter().map(|set| [&[*first], &set[..]].concat());
            with.chain(subsets(rest, size)).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_subsets_of_a_size_are_all_of_them() {
        assert_eq!(subsets(&[1, 2, 3], 2), [[1, 2], [1, 3], [2, 3]]);
        assert_eq!(subsets(&[1, 2, 3], 3), [[1, 2, 3]]);
        assert_eq!(subsets::<u8>(&[], 1), Vec::<Vec<u8>>::new());
    }
}
