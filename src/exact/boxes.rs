//! Branch and bound box by box.

use super::bound::{BoxBound, DesignBox, Verdict};
use super::budget::Budget;
use super::local_upper_bounds::LocalUpperBound;
use super::problem::Problem;
use super::rounds::{Done, in_rounds};
use super::search_state::{Findings, SearchState};
use super::shape::Shape;
use super::work::Work;
use std::sync::Arc;

/// Boxes that a task opens.
const BOXES: usize = 32;

/// A box on its way, with what its parent knew.
pub(super) struct OpenBox {
    pub design_box: DesignBox,
    pub shapes: Arc<Vec<Shape>>,
    pub box_bound: BoxBound,
}

impl OpenBox {
    /// The halves of a level, the first last: it is opened first.
    pub fn halves(&self, problem: &Problem, level: usize, box_bound: BoxBound) -> Vec<Self> {
        let half = |node: u32| {
            let mut design_box = self.design_box.clone();
            design_box[level] = node;
            Self { design_box, shapes: Arc::clone(&self.shapes), box_bound }
        };
        problem.halves(&self.design_box, level).map_or_else(Vec::new, |[a, b]| vec![half(b), half(a)])
    }
}

/// Opens the box of everything and all that comes of it, and learns what is found; returns the boxes that are left
/// when the search is stopped.
pub(super) fn open_all_boxes<K: Sync, F: Send + Default>(
    budget: &Budget,
    problem: &Problem,
    state: &mut K,
    open: impl Fn(&K, OpenBox, &mut Work, &mut F) -> Vec<OpenBox> + Sync,
    learn: impl Fn(&mut K, F),
) -> Vec<OpenBox> {
    let Some(shapes) = problem.first_shapes(&mut Work::default()) else { return Vec::new() };
    let root = OpenBox { design_box: problem.root(), shapes: Arc::new(shapes), box_bound: BoxBound::OPEN };
    let task = |state: &K, root: OpenBox| {
        open_boxes(budget, root, |next, work, findings| open(state, next, work, findings))
    };
    in_rounds(state, vec![root], || budget.stopped(), task, learn)
}

/// Opens a box and some of those that come of it.
pub(super) fn open_boxes<F: Default>(
    budget: &Budget,
    first: OpenBox,
    open: impl Fn(OpenBox, &mut Work, &mut F) -> Vec<OpenBox>,
) -> Done<OpenBox, F> {
    let (mut work, mut findings, mut stack) = (Work::default(), F::default(), vec![first]);
    for _ in 0..BOXES {
        if budget.stopped() {
            break;
        }
        let Some(next) = stack.pop() else { break };
        stack.extend(open(next, &mut work, &mut findings));
    }
    Done { tasks: stack, findings }
}

/// One pass over all boxes; returns the ceilings of those that were left.
pub(super) fn pass_by_boxes(
    budget: &Budget,
    problem: &Problem,
    state: &mut SearchState,
    slack: f64,
) -> Vec<BoxBound> {
    let left = open_all_boxes(
        budget,
        problem,
        state,
        |state, next, work, findings| {
            Search { budget, problem, state, slack, below: None }.open(next, work, findings)
        },
        SearchState::learn,
    );
    left.iter().map(|opened| opened.box_bound).collect()
}

/// A search of a problem, or of a part of it, as far as it goes with what is known.
pub(super) struct Search<'s, 'p> {
    pub budget: &'s Budget<'p>,
    pub problem: &'s Problem<'p>,
    pub state: &'s SearchState,
    /// How close a design found must come to a box's ceiling to cut it.
    pub slack: f64,
    /// The corner below which designs are looked for.
    pub below: Option<LocalUpperBound>,
}

impl Search<'_, '_> {
    /// Bounds a box and halves it, or judges it if it is one design.
    pub fn open(&self, mut here: OpenBox, work: &mut Work, findings: &mut Findings) -> Vec<OpenBox> {
        self.budget.count_box();
        let verdict = self.problem.bound(
            &mut here.design_box,
            &mut here.shapes,
            work,
            |box_bound| {
                self.below.is_some_and(|upper| !upper.is_in_reach_of(box_bound))
                    || self.dominates(box_bound, findings)
            },
            |box_bound| {
                self.below.is_some()
                    || self.state.incumbents.nearly_dominates(&box_bound.slackened(self.slack))
            },
        );
        let Verdict::Open(box_bound) = verdict else { return Vec::new() };
        match self.problem.prune_dominated_drives(&mut here.design_box, box_bound.tip_m, work) {
            None => return Vec::new(),
            Some(true) => return vec![here],
            Some(false) => {}
        }
        let Some(level) = self.problem.widest_level(&here.design_box, &here.shapes, work) else {
            self.problem.judge(&here.design_box, &box_bound, work, findings);
            return Vec::new();
        };
        here.halves(self.problem, level, box_bound)
    }

    /// Whether a design that is known or was found since comes within the slack of a ceiling.
    pub fn dominates(&self, box_bound: &BoxBound, findings: &Findings) -> bool {
        let slackened = box_bound.slackened(self.slack);
        self.state.incumbents.dominates(&slackened) || findings.dominates(&slackened)
    }
}
