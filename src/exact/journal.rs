//! The states that an exact search saves on the way, so that another process can continue it.
//!
//! A study is searched in *parts*: first the front of all designs, then the front of each material. The state contains
//! the results of the finished parts and the progress of the present part.
//!
//! A part is searched in *passes* over the whole space, each with less *slack* than the pass before. The slack is a
//! fraction: a box of designs is discarded although it may be better than the designs found by this fraction. A pass
//! over boxes is saved between two rounds of parallel tasks, together with the open boxes. A pass over regions (all
//! designs below a mass, a deflection and a frequency) is saved only at its start, because each open region is a
//! separate problem. Rounds do not depend on the number of threads, so a search that is continued takes the same steps
//! as a search that was never stopped.

use super::bound::{BoxBound, DesignBox};
use super::boxes::OpenBox;
use super::budget::Budget;
use super::outcome::FoundInShard;
use super::plan::Pass;
use super::problem::Problem;
use super::search_state::{KeptState, SearchState};
use super::shape::Shape;
use crate::search::resume::{KeepState, Resume};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The journal of a search: it saves states and returns what an earlier process saved. If `keeper` is `None`, nothing
/// is saved.
#[derive(Default)]
pub(super) struct Journal<'s> {
    keeper: Option<&'s dyn KeepState>,
    state: Mutex<State>,
    /// The state at the start of the present pass over regions, as bytes; `None` once it is saved.
    start: Mutex<Option<Vec<u8>>>,
}

#[derive(Default, Serialize, Deserialize)]
struct State {
    /// The results of the parts that are finished.
    finished: Vec<FoundInShard>,
    /// Number of finished parts whose results this process has taken from `finished` or added to it.
    #[serde(skip)]
    used: usize,
    /// Number of boxes bounded in all parts.
    boxes: u64,
    /// The progress of the unfinished part; `None` if none was begun.
    begun: Option<Begun>,
}

/// The progress of one part of a search: between two passes, or within one.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct Begun {
    state: KeptState,
    /// The completed passes of the present part.
    pub passes: Vec<Pass>,
    /// The gap of the present part that was reported to other threads so far (relative); `None` if none was.
    pub told: Option<f64>,
    /// The pass that was begun; `None` between two passes.
    open: Option<OpenPass>,
}

/// The open boxes of a pass. `shapes` has each list of trial shapes (motions that bound the lowest mode) once, because
/// several boxes share it. A box refers to its list by index.
#[derive(Clone, Serialize, Deserialize)]
struct OpenPass {
    slack: f64,
    shapes: Vec<Vec<Shape>>,
    boxes: Vec<(DesignBox, u32, BoxBound)>,
}

impl<'s> Journal<'s> {
    /// Makes the journal of a search that continues from a state, if there is one, and that saves later states.
    ///
    /// # Errors
    /// Returns a message if the bytes are not a saved state.
    pub(super) fn resumed(Resume { from, keeper }: Resume<'s>, budget: &Budget) -> Result<Self, String> {
        let state: State = match from {
            Some(bytes) => postcard::from_bytes(bytes).map_err(|e| e.to_string())?,
            None => State::default(),
        };
        budget.set_boxes(state.boxes);
        Ok(Self { keeper: Some(keeper), state: Mutex::new(state), start: Mutex::default() })
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The result of the next part of the search, which this call marks as used. `None` if no earlier process finished
    /// this part.
    pub(super) fn next_finished(&self) -> Option<FoundInShard> {
        let mut state = self.lock();
        let found = state.finished.get(state.used).cloned()?;
        state.used += 1;
        Some(found)
    }

    /// Takes the progress that an earlier process made with the next part out of the journal. `None` if that part was
    /// not begun.
    pub(super) fn begun(&self) -> Option<Begun> {
        self.lock().begun.take()
    }

    /// Records the result of a finished part of the search.
    pub(super) fn finish(&self, found: &FoundInShard) {
        if let Some(keeper) = self.keeper {
            let mut state = self.lock();
            state.finished.push(found.clone());
            state.used += 1;
            state.boxes = found.boxes;
            state.begun = None;
            if keeper.is_due() {
                keeper.keep(&bytes(&state));
            }
        }
    }

    /// Saves the state of a pass over boxes between two rounds, if enough time has passed since the last save. `begun`
    /// makes the progress of the present part, `slack` is the slack of the pass, and `open` are its open boxes.
    pub(super) fn keep_round(
        &self,
        budget: &Budget,
        begun: impl FnOnce() -> Begun,
        (slack, open): (f64, &[OpenBox]),
    ) {
        // A round that was stopped half-way is not saved, because a search that continues from it would take other
        // steps.
        let due = self.keeper.filter(|keeper| keeper.is_due() && !budget.stopped());
        if let Some(keeper) = due {
            keeper.keep(
                &self.serialized_with(budget, Begun { open: Some(OpenPass::of(slack, open)), ..begun() }),
            );
        }
    }

    /// Stores the state at the start of a pass over regions. [`keep_start`](Self::keep_start) saves it later.
    pub(super) fn begin_pass(&self, budget: &Budget, begun: impl FnOnce() -> Begun) {
        if self.keeper.is_some() && !budget.stopped() {
            let bytes = self.serialized_with(budget, begun());
            *self.start.lock().unwrap_or_else(PoisonError::into_inner) = Some(bytes);
        }
    }

    /// Saves the state at the start of the present pass over regions, if enough time has passed since the last save and
    /// this state is not saved yet.
    pub(super) fn keep_start(&self) {
        if let Some(keeper) = self.keeper.filter(|keeper| keeper.is_due()) {
            let start = self.start.lock().unwrap_or_else(PoisonError::into_inner).take();
            start.into_iter().for_each(|bytes| keeper.keep(&bytes));
        }
    }

    /// Serializes the whole state: the finished parts, the number of boxes so far, and `begun`, the progress of the
    /// unfinished part.
    fn serialized_with(&self, budget: &Budget, begun: Begun) -> Vec<u8> {
        let mut state = self.lock();
        (state.boxes, state.begun) = (budget.boxes(), Some(begun));
        let bytes = bytes(&state);
        state.begun = None;
        bytes
    }
}

fn bytes(state: &State) -> Vec<u8> {
    postcard::to_stdvec(state).expect("numbers can be written to memory")
}

impl Begun {
    /// The progress between two passes. `told` is the gap that was reported.
    pub(super) fn between(state: &SearchState, passes: &[Pass], told: Option<f64>) -> Self {
        Self { state: state.to_kept(), passes: passes.to_vec(), told, open: None }
    }

    /// Moves the state of the search out of this progress, which has an empty state afterwards.
    pub(super) fn state(&mut self) -> KeptState {
        std::mem::take(&mut self.state)
    }

    /// The slack of the pass that was begun, and the boxes that were open in it. `None` between two passes, or if a
    /// saved box does not exist in `problem`.
    pub(super) fn open_pass(&mut self, problem: &Problem) -> Option<(f64, Vec<OpenBox>)> {
        let OpenPass { slack, shapes, boxes } = self.open.take()?;
        let shapes: Vec<Arc<Vec<Shape>>> = shapes.into_iter().map(Arc::new).collect();
        let open = |(design_box, at, box_bound): (DesignBox, u32, BoxBound)| {
            let shapes = Arc::clone(shapes.get(at as usize)?);
            problem.has_box(&design_box).then_some(OpenBox { design_box, shapes, box_bound })
        };
        let boxes: Option<Vec<OpenBox>> = boxes.into_iter().map(open).collect();
        Some((slack, boxes?))
    }
}

impl OpenPass {
    fn of(slack: f64, open: &[OpenBox]) -> Self {
        let (mut shapes, mut places) = (Vec::new(), HashMap::new());
        let boxes = open.iter().map(|opened| {
            let place = *places.entry(Arc::as_ptr(&opened.shapes)).or_insert_with(|| {
                shapes.push(Vec::clone(&opened.shapes));
                shapes.len() as u32 - 1
            });
            (opened.design_box.clone(), place, opened.box_bound)
        });
        let boxes = boxes.collect();
        Self { slack, shapes, boxes }
    }
}
