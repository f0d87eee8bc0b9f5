//! Branch and bound box by box.
//!
//! A box is a set of designs. It is bounded, and then either discarded (pruned) or halved; the halves are treated in
//! the same way. A box of one design is evaluated. The designs found so far are the incumbents; a box is pruned if one
//! of them dominates its bound. A *pass* is one search of the whole space with a fixed slack: the fraction by which a
//! box may be better than the incumbents and is still pruned. A *task* is the work of one thread between two exchanges
//! of findings, and a *round* is a set of tasks that run side by side.

use super::bound::{BoxBound, DesignBox, Verdict};
use super::box_work::BoxWork;
use super::budget::Budget;
use super::gap::gap;
use super::live_progress::LiveProgress;
use super::local_upper_bounds::LocalUpperBounds;
use super::problem::Problem;
use super::rounds::{Done, in_rounds};
use super::search_state::{Findings, SearchState};
use super::shape::Shape;
use std::sync::Arc;

/// Greatest number of boxes that one task bounds. After that, the task returns the boxes that are still open.
const BOXES_PER_TASK: usize = 32;

/// A box that waits to be bounded, with the trial shapes and the bound of its parent, the box of which it is a half.
/// Trial shapes are motions that bound the lowest mode.
pub(super) struct OpenBox {
    pub design_box: DesignBox,
    pub shapes: Arc<Vec<Shape>>,
    pub box_bound: BoxBound,
}

impl OpenBox {
    /// The box of all designs. `None` if no design meets the constraints.
    fn root(problem: &Problem) -> Option<Self> {
        Self::first(problem, &[problem.root()]).pop()
    }

    /// The boxes `boxes` as open boxes, with which a search starts. They have the first trial shapes of the whole
    /// space, and no bound yet. Empty if no design of the space meets the constraints.
    pub(super) fn first(problem: &Problem, boxes: &[DesignBox]) -> Vec<Self> {
        let Some(shapes) = problem.first_shapes(&mut BoxWork::default()).map(Arc::new) else {
            return Vec::new();
        };
        let open = |design_box: &DesignBox| Self {
            design_box: design_box.clone(),
            shapes: Arc::clone(&shapes),
            box_bound: BoxBound::OPEN,
        };
        boxes.iter().map(open).collect()
    }

    /// The two halves of this box along a level (the choice of one tube or drive). Empty if the level has a single
    /// option. `box_bound` is the bound of this box and is valid for both halves. The half that is to be bounded first
    /// comes last, because the stack is emptied from its end.
    pub(super) fn halves(&self, problem: &Problem, level: usize, box_bound: BoxBound) -> Vec<Self> {
        let half = |node: u32| {
            let mut design_box = self.design_box.clone();
            design_box[level] = node;
            Self { design_box, shapes: Arc::clone(&self.shapes), box_bound }
        };
        problem.halves(&self.design_box, level).map_or_else(Vec::new, |[a, b]| vec![half(b), half(a)])
    }
}

/// Bounds the box of all designs, then the boxes into which it is divided, and so on. `open` bounds one box and
/// returns the boxes into which it is divided. At the end of each round of tasks, `learn` adds the designs found to
/// `state`. Then `see` is called with `state` and the boxes that are still open. Returns the boxes that are open when
/// the search is stopped; there are none if the search came to its end.
pub(super) fn open_all_boxes<K: Sync, F: Send + Default>(
    budget: &Budget,
    problem: &Problem,
    state: &mut K,
    open: impl Fn(&K, OpenBox, &mut BoxWork, &mut F) -> Vec<OpenBox> + Sync,
    learn: impl Fn(&mut K, F),
    see: impl Fn(&K, &[OpenBox]),
) -> Vec<OpenBox> {
    let Some(root) = OpenBox::root(problem) else { return Vec::new() };
    go_through_boxes(budget, state, vec![root], open, learn, see)
}

/// Bounds the boxes in `first` and all boxes into which they are divided. The other parameters have the same meaning
/// as in [`open_all_boxes`].
fn go_through_boxes<K: Sync, F: Send + Default>(
    budget: &Budget,
    state: &mut K,
    first: Vec<OpenBox>,
    open: impl Fn(&K, OpenBox, &mut BoxWork, &mut F) -> Vec<OpenBox> + Sync,
    learn: impl Fn(&mut K, F),
    see: impl Fn(&K, &[OpenBox]),
) -> Vec<OpenBox> {
    let task = |state: &K, root: OpenBox| {
        open_boxes(budget, root, |next, work, findings| open(state, next, work, findings))
    };
    in_rounds(state, first, || budget.stopped(), task, learn, see)
}

/// Bounds the box `first` and then the boxes into which it is divided, depth first. It stops after [`BOXES_PER_TASK`]
/// boxes. `open` bounds one box and returns the boxes into which it is divided. Returns the boxes that are still open
/// and the designs found.
pub(super) fn open_boxes<F: Default>(
    budget: &Budget,
    first: OpenBox,
    open: impl Fn(OpenBox, &mut BoxWork, &mut F) -> Vec<OpenBox>,
) -> Done<OpenBox, F> {
    let (mut work, mut findings, mut stack) = (BoxWork::default(), F::default(), vec![first]);
    for _ in 0..BOXES_PER_TASK {
        if budget.stopped() {
            break;
        }
        let Some(next) = stack.pop() else { break };
        stack.extend(open(next, &mut work, &mut findings));
    }
    Done { tasks: stack, findings }
}

/// One pass with the slack `slack` over the boxes `first` and all boxes into which they are divided. `keep` is called
/// after each round with the state and the open boxes. Returns the bounds of the boxes that are still open when the
/// search is stopped; there are none if the pass is complete.
pub(super) fn pass_by_boxes(
    budget: &Budget,
    problem: &Problem,
    state: &mut SearchState,
    (slack, first): (f64, Vec<OpenBox>),
    live: Option<&LiveProgress>,
    keep: impl Fn(&SearchState, &[OpenBox]),
) -> Vec<BoxBound> {
    let bounds = |open: &[OpenBox]| open.iter().map(|opened| opened.box_bound).collect::<Vec<_>>();
    let left = go_through_boxes(
        budget,
        state,
        first,
        |state, next, work, findings| {
            Search { budget, problem, state, slack, below: None }.open(next, work, findings)
        },
        SearchState::learn,
        |state, open| {
            keep(state, open);
            live.into_iter().for_each(|live| {
                live.update(|| {
                    let front = state.front();
                    let gap = gap(&bounds(open), &front).map(|gap| gap.max(slack));
                    state.known(&front, open.len(), gap)
                });
            });
        },
    );
    bounds(&left)
}

/// The search for designs of a problem, with the state that was shared when the present round began.
pub(super) struct Search<'s, 'p> {
    pub budget: &'s Budget<'p>,
    pub problem: &'s Problem<'p>,
    pub state: &'s SearchState,
    /// The slack of the pass (relative; 0 for none). A box is pruned if an incumbent dominates its bound after the
    /// bound was made worse by the factor `1 + slack`.
    pub slack: f64,
    /// The local upper bounds below which the search looks for designs; `None` for the whole space.
    pub below: Option<&'s LocalUpperBounds>,
}

impl Search<'_, '_> {
    /// Bounds the box `here` and returns its two halves. Returns nothing if the box is pruned, or if it is a single
    /// design; that design is then evaluated and added to `findings`. If dominated drives are removed from the box, the
    /// smaller box is returned undivided, to be bounded again.
    pub(super) fn open(
        &self,
        mut here: OpenBox,
        work: &mut BoxWork,
        findings: &mut Findings,
    ) -> Vec<OpenBox> {
        self.budget.count_box();
        let verdict = self.problem.bound(
            &mut here.design_box,
            &mut here.shapes,
            work,
            |box_bound| {
                self.below.is_some_and(|below| !below.admit(box_bound)) || self.dominates(box_bound, findings)
            },
            |box_bound| {
                self.below.is_some()
                    || self.state.incumbents.nearly_dominates(&box_bound.slackened(self.slack))
            },
        );
        let Verdict::Open(box_bound) = verdict else { return Vec::new() };
        // The box may have lost drives. Then its numbers in `work` are out of date, and it has to be bounded again.
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

    /// Whether a known design dominates the bound `box_bound` after it was made worse by the slack. Known designs are
    /// the designs of the shared state and the designs in `findings`, which this task found.
    pub(super) fn dominates(&self, box_bound: &BoxBound, findings: &Findings) -> bool {
        let slackened = box_bound.slackened(self.slack);
        self.state.incumbents.dominates(&slackened) || findings.dominates(&slackened)
    }
}
