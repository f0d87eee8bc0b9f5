//! Finds the limits that exclude every design, and by how much they have to be relaxed.
//!
//! One limit is dropped at a time. An exact search then finds the design that is best in the limited quantity and meets
//! all other limits. If the quantity is no objective, the search finds any such design. The limit is then bisected
//! between the stated limit and the value of this design, and each step searches for any design that meets the middle.
//! If no limit helps alone, pairs of limits are tried, then triples.

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

/// The bisection of a limit ends when the two ends of its interval differ by no more than this fraction.
const BISECTION_TOLERANCE: f64 = 2e-6;
/// Lower end of the bisection if the stated limit is zero, as a fraction of the value that a design reaches. Bisection
/// takes geometric means, so it must not start at zero.
const LEAST_LIMIT: f64 = 1e-12;
/// A gap so large that any design satisfies it. A search with this gap ends with the first design.
const ANY_GAP: f64 = 1e9;

/// Limits that have to be relaxed together, each with the value that is then reached.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Relaxation {
    pub limits: Vec<(Quantity, f64)>,
    /// Whether it is known that a smaller relaxation does not suffice. It is not known if time ran out.
    pub is_smallest: bool,
}

/// The answer to the question whether a space has a design that meets its limits.
enum Answer<T> {
    Yes(T),
    No,
    /// Time ran out before the answer was known.
    Unknown,
}

/// A space whose limits are changed, with the means to search it.
pub(super) struct Limited<'a> {
    pub space: &'a DesignSpace,
    pub catalogs: &'a Catalogs,
    /// The joints of the space with the tables of their drives, which no limit changes.
    pub joints: TabulatedJoints<'a>,
    pub stop: &'a AtomicBool,
    pub deadline: Instant,
}

impl Limited<'_> {
    /// Whether some design is feasible if all limits are dropped; `None` if time ran out before this was known.
    pub(super) fn holds_without_limits(&self) -> Option<bool> {
        match self.find(&Constraints::default(), Quantity::Mass, |search| search.to_gap(ANY_GAP)) {
            Answer::Yes(_) => Some(true),
            Answer::No => Some(false),
            Answer::Unknown => None,
        }
    }

    /// The relaxations (sets of limits with changed values) that admit a design, each of as few limits as possible. The
    /// flag is false if time ran out before all were tried.
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

    /// The smallest relaxation of the limits in `set` together. The first limit is relaxed as little as possible with
    /// the others of the set dropped, then the second, and so on.
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
            // slightly more than the value reached, so that rounding does not exclude the design that reaches it
            let roomy = if quantity.is_least() {
                reached / (1.0 + BISECTION_TOLERANCE)
            } else {
                reached * (1.0 + BISECTION_TOLERANCE)
            };
            quantity.set(&mut constraints, Some(roomy));
            limits.push((quantity, reached));
            is_smallest &= is_least;
        }
        Answer::Yes(Relaxation { limits, is_smallest })
    }

    /// The best value of `quantity` that a design reaches under `constraints`. The flag is false if time ran out before
    /// it was known that no design reaches a better value.
    fn best(&self, constraints: &Constraints, quantity: Quantity) -> Answer<(f64, bool)> {
        if let Some(objective) = quantity.objective() {
            return self.find(constraints, quantity, |search| search.toward(objective));
        }
        match self.find(constraints, quantity, |search| search.to_gap(ANY_GAP)) {
            Answer::Yes((reached, _)) => Answer::Yes(self.bisected(constraints, quantity, reached)),
            other => other,
        }
    }

    /// The value of `quantity` nearest to its stated limit that some design reaches. It lies between the stated limit,
    /// which no design meets, and `reached`, the value of a known design. The flag is false if time ran out.
    fn bisected(&self, constraints: &Constraints, quantity: Quantity, reached: f64) -> (f64, bool) {
        // the bisection runs over a cost that rises from the stated limit to the value reached: the value itself or,
        // for lower limits, its reciprocal
        let cost = |value: f64| if quantity.is_least() { value.recip() } else { value };
        let asked = quantity.asked(&self.space.constraints).unwrap_or_default();
        let (mut in_vain, mut enough) = (cost(asked).max(cost(reached) * LEAST_LIMIT), cost(reached));
        while enough > in_vain * (1.0 + BISECTION_TOLERANCE) {
            let middle = (in_vain * enough).sqrt();
            let mut tried = *constraints;
            quantity.set(&mut tried, Some(cost(middle)));
            match self.find(&tried, quantity, |search| search.to_gap(ANY_GAP)) {
                Answer::Yes((reached, _)) => enough = cost(reached).min(middle),
                Answer::No => in_vain = middle,
                Answer::Unknown => return (cost(enough), false),
            }
        }
        (cost(enough), true)
    }

    /// The best value of `quantity` among the designs that an exact search finds under `constraints`, and whether the
    /// search was completed. `how` sets the aim of the search, such as the best design or any design.
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

/// The value of `quantity` by the full model for a design, given by its number in the whole space; `None` if the design
/// does not meet the limits.
fn reached(problem: &ArmProblem, design: u128, quantity: Quantity) -> Option<f64> {
    let options = problem.options_of_whole(design)?;
    let judged = evaluate(problem, number(problem.level_sizes(), &options))?;
    if problem.space().constraints.broken(&judged.objectives).contains(&true) {
        return None;
    }
    let arm = problem.walk(&options, |_, _| {}).ok()?;
    quantity.of(problem, &arm, &judged.objectives)
}

/// All subsets of `list` with `size` elements. The elements of each are in the order of the list.
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
