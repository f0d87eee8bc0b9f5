//! Branch and bound box by box.

use super::bound::{Ceiling, Cell, Verdict, Work};
use super::budget::Budget;
use super::corners::Corner;
use super::known::{Finds, Known};
use super::problem::Problem;
use super::rounds::{Done, in_rounds};
use super::shape::Shape;
use std::sync::Arc;

/// Boxes that a task opens.
const BOXES: usize = 32;

/// A box on its way, with what its parent knew.
pub(super) struct Opened {
    pub cell: Cell,
    pub shapes: Arc<Vec<Shape>>,
    pub ceiling: Ceiling,
}

impl Opened {
    /// The halves of a level, the first last: it is opened first.
    pub fn halves(&self, problem: &Problem, level: usize, ceiling: Ceiling) -> Vec<Self> {
        let half = |node: u32| {
            let mut cell = self.cell.clone();
            cell[level] = node;
            Self { cell, shapes: Arc::clone(&self.shapes), ceiling }
        };
        problem.halves(&self.cell, level).map_or_else(Vec::new, |[a, b]| vec![half(b), half(a)])
    }
}

/// Opens the box of everything and all that comes of it, and learns what is found; returns the boxes that are left
/// when the search is stopped.
pub(super) fn every_box<K: Sync, F: Send + Default>(
    budget: &Budget,
    problem: &Problem,
    known: &mut K,
    open: impl Fn(&K, Opened, &mut Work, &mut F) -> Vec<Opened> + Sync,
    learn: impl Fn(&mut K, F),
) -> Vec<Opened> {
    let Some(shapes) = problem.first_shapes(&mut Work::default()) else { return Vec::new() };
    let root = Opened { cell: problem.root(), shapes: Arc::new(shapes), ceiling: Ceiling::OPEN };
    let task = |known: &K, root: Opened| {
        some_boxes(budget, root, |next, work, finds| open(known, next, work, finds))
    };
    in_rounds(known, vec![root], || budget.stopped(), task, learn)
}

/// Opens a box and some of those that come of it.
pub(super) fn some_boxes<F: Default>(
    budget: &Budget,
    first: Opened,
    open: impl Fn(Opened, &mut Work, &mut F) -> Vec<Opened>,
) -> Done<Opened, F> {
    let (mut work, mut finds, mut stack) = (Work::default(), F::default(), vec![first]);
    for _ in 0..BOXES {
        if budget.stopped() {
            break;
        }
        let Some(next) = stack.pop() else { break };
        stack.extend(open(next, &mut work, &mut finds));
    }
    Done { tasks: stack, finds }
}

/// One pass over all boxes; returns the ceilings of those that were left.
pub(super) fn pass_by_boxes(
    budget: &Budget,
    problem: &Problem,
    known: &mut Known,
    slack: f64,
) -> Vec<Ceiling> {
    let left = every_box(
        budget,
        problem,
        known,
        |known, next, work, finds| {
            Search { budget, problem, known, slack, below: None }.open(next, work, finds)
        },
        Known::learn,
    );
    left.iter().map(|opened| opened.ceiling).collect()
}

/// A search of a problem, or of a part of it, as far as it goes with what is known.
pub(super) struct Search<'s, 'p> {
    pub budget: &'s Budget<'p>,
    pub problem: &'s Problem<'p>,
    pub known: &'s Known,
    /// How close a design found must come to a box's ceiling to cut it.
    pub slack: f64,
    /// The corner below which designs are looked for.
    pub below: Option<Corner>,
}

impl Search<'_, '_> {
    /// Bounds a box and halves it, or judges it if it is one design.
    pub fn open(&self, mut here: Opened, work: &mut Work, finds: &mut Finds) -> Vec<Opened> {
        self.budget.count_box();
        let verdict = self.problem.bound(
            &mut here.cell,
            &mut here.shapes,
            work,
            |ceiling| {
                self.below.is_some_and(|corner| !corner.is_in_reach_of(ceiling)) || self.beats(ceiling, finds)
            },
            |ceiling| self.below.is_some() || self.known.found.nearly_beats(&ceiling.slackened(self.slack)),
        );
        let Verdict::Open(ceiling) = verdict else { return Vec::new() };
        match self.problem.without_pointless(&mut here.cell, ceiling.tip_m, work) {
            None => return Vec::new(),
            Some(true) => return vec![here],
            Some(false) => {}
        }
        let Some(level) = self.problem.widest_level(&here.cell, &here.shapes, work) else {
            self.problem.judge(&here.cell, &ceiling, work, finds);
            return Vec::new();
        };
        here.halves(self.problem, level, ceiling)
    }

    /// Whether a design that is known or was found since comes within the slack of a ceiling.
    pub fn beats(&self, ceiling: &Ceiling, finds: &Finds) -> bool {
        let slackened = ceiling.slackened(self.slack);
        self.known.found.beats(&slackened) || finds.beats(&slackened)
    }
}
