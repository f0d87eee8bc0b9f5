//! The exact search: probes, passes with less and less slack, and the listing of the front. A probe quickly finds a
//! good design. A pass searches the whole space. The slack of a pass is the fraction by which a design may be better
//! than the designs found already (the *incumbents*) and still be missed.

use super::bound::BoxBound;
use super::bound::DesignBox;
use super::boxes::{OpenBox, pass_by_boxes};
use super::budget::Budget;
use super::early::Early;
use super::evolve::evolve;
use super::gap::gap;
use super::journal::{Begun, Journal};
use super::kinds::Ties;
use super::live_progress::{Known, LiveProgress, least};
use super::outcome::{ExactOutcome, FoundInShard};
use super::plan::{Pass, Plan};
use super::probe::probe;
use super::problem::Problem;
use super::regions::pass_by_regions;
use super::search_state::SearchState;
use crate::catalog::Catalogs;
use crate::pareto::objectives::{Objective, Objectives};
use crate::search::resume::Resume;
use crate::search::sweep::Shard;
use crate::space::design_space::{DesignSpace, LinkOption};
use crate::space::joints::TabulatedJoints;
use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// Stack size that each worker thread needs \[bytes\]. An exact search by regions makes nested calls, and a worker that
/// waits for others runs their tasks on its own stack. A program that builds its own thread pool has to give its
/// workers this much.
pub const WORKER_STACK_BYTES: usize = 64 << 20;

/// Number of designs above which a space is searched in passes with less and less slack.
const LARGE_SPACE: f64 = 1e9;
/// Number of designs above which a space is searched region by region and not box by box.
pub const VAST: f64 = 1e14;
/// Number of designs below which a region is searched box by box.
const SMALL_REGION: f64 = 1e6;
/// Number of probes per squared decade of designs: a space of `10^n` designs gets `0.12 n²` probes. More probes shorten
/// the search only in a large space.
const PROBES_PER_SQUARED_DECADE: f64 = 0.12;
/// Number of probes per squared decade of designs if the genetic algorithm ([`evolve`]) follows. It is a third of
/// [`PROBES_PER_SQUARED_DECADE`].
const PROBES_TO_EVOLVE: f64 = 0.04;
/// Greatest number of designs up to which all ties are listed, unless the caller sets another number. A tie is a
/// design that differs from another only in drives of equal mass, torsion curve and bearing stiffness.
const MOST_WITH_TIES: usize = 20_000;

/// A search for the exact front. Other threads can watch and stop it.
///
/// ```
/// use armwright::catalog::Catalogs;
/// use armwright::exact::Exact;
/// use armwright::input::Document;
/// use armwright::study::read_study;
/// use std::sync::atomic::AtomicBool;
///
/// let text = r#"{"name": "one link",
///     "chain": [
///         {"type": "joint", "name": "j2", "axis": [0, 1, 0], "stiffness_nm_per_rad": 1e5, "mass_kg": 8},
///         {"type": "link", "name": "arm", "vector_m": [0.5, 0, 0], "choose": {
///             "materials": ["Structural steel S355"],
///             "sections": [{"shape": "round_tube", "diameter_mm": 70, "wall_mm": [2, 3, 4]}]}}],
///     "payload": {"mass_kg": 5},
///     "poses": [{"name": "stretched", "pose_deg": [0]}]}"#;
/// let catalogs = Catalogs::builtin();
/// let study = read_study(Document::parse("study.json", text).expect("JSON"), &catalogs).expect("a sound study");
/// let stop = AtomicBool::new(false);
/// let outcome = Exact::new(&study.space, &catalogs, &stop, None).run(&[]);
/// assert_eq!((outcome.designs_total, outcome.boxes_open), (3, 0), "the front is certified");
/// assert!(!outcome.front.is_empty());
/// ```
pub struct Exact<'p> {
    space: &'p DesignSpace,
    catalogs: &'p Catalogs,
    pub(super) budget: Budget<'p>,
    /// Gap that was asked for: the slack of the last pass (relative, 0 for the whole front).
    gap: f64,
    /// The only objective that counts; `None` if all three count.
    pub(super) only: Option<Objective>,
    /// The part of the space that is searched.
    pub(super) shard: Shard,
    /// Number of designs above which the space is searched by regions. `regions_to` is the number below which a
    /// region is searched by boxes.
    regions_from: f64,
    regions_to: f64,
    /// Greatest number of designs that are listed with all their ties. If there are more, one design of each set of
    /// ties is listed.
    most_with_ties: usize,
    pub(super) live: LiveProgress,
    journal: Journal<'p>,
    /// The joints with their drives, once they are tabulated.
    joints: OnceLock<TabulatedJoints<'p>>,
}

/// How the passes of a search ended. `gap` is the gap that was proved (relative; `None` if no gap was proved). `open`
/// are the bounds of the boxes or regions that are not searched to the end; there are none after a complete search.
struct Ended {
    gap: Option<f64>,
    open: Vec<BoxBound>,
}

impl<'p> Exact<'p> {
    /// Prepares a search of a space. The search ends early when `stop` is set or the deadline has passed.
    pub fn new(
        space: &'p DesignSpace,
        catalogs: &'p Catalogs,
        stop: &'p AtomicBool,
        deadline: Option<Instant>,
    ) -> Self {
        Self {
            space,
            catalogs,
            budget: Budget::new(stop, deadline),
            gap: 0.0,
            only: None,
            shard: Shard::WHOLE,
            regions_from: VAST,
            regions_to: SMALL_REGION,
            most_with_ties: MOST_WITH_TIES,
            live: LiveProgress::default(),
            journal: Journal::default(),
            joints: OnceLock::new(),
        }
    }

    /// Makes the search use joints that are tabulated already. They may come from another space, if it has the same
    /// joints and cases.
    pub(crate) fn with_joints(self, joints: TabulatedJoints<'p>) -> Self {
        Self { joints: OnceLock::from(joints), ..self }
    }

    fn joints(&self) -> &TabulatedJoints<'p> {
        self.joints.get_or_init(|| TabulatedJoints::new(self.space, self.catalogs))
    }

    /// Searches the space region by region if it has more than `designs` designs. The default is 1e14. The number
    /// changes the time of the search, not its result.
    #[must_use]
    pub fn by_regions_from(self, designs: f64) -> Self {
        Self { regions_from: designs, regions_to: designs.min(SMALL_REGION), ..self }
    }

    /// Sets the greatest number of designs up to which every tie is listed. Ties are designs that differ only in
    /// drives of equal mass, torsion curve and bearing stiffness. The default is 20,000. If there are more, one design
    /// of each set of ties is listed.
    #[must_use]
    pub fn with_ties_up_to(self, designs: usize) -> Self {
        Self { most_with_ties: designs, ..self }
    }

    /// Sets the gap at which the search is complete (relative; 0 for the whole front). For every design of the space,
    /// some design that is known or found is then worse by at most this fraction in each objective.
    #[must_use]
    pub fn to_gap(self, gap: f64) -> Self {
        Self { gap, ..self }
    }

    /// Makes the search look only for a design that is best in one objective. The front then contains such a design.
    /// The search goes box by box, because the bounds of regions are about all three objectives.
    #[must_use]
    pub fn toward(self, objective: Objective) -> Self {
        Self { only: Some(objective), regions_from: f64::INFINITY, ..self }
    }

    /// Makes [`found`](Self::found) search one shard of the space. [`joined`](Self::joined) makes one front of the
    /// findings of all shards.
    #[must_use]
    pub fn of_shard(self, shard: Shard) -> Self {
        Self { shard, ..self }
    }

    /// Goes on where an earlier process ended, and saves states for a later process. All these processes must make the
    /// same calls of [`run`](Self::run) and [`run_of_material`](Self::run_of_material), in the same order.
    ///
    /// # Errors
    /// Returns a message if the bytes are not a saved state of an exact search.
    pub fn resumed(self, resume: Resume<'p>) -> Result<Self, String> {
        let journal = Journal::resumed(resume, &self.budget)?;
        Ok(Self { journal, ..self })
    }

    /// The progress of the search for the front of all designs at this moment. The gap in it never rises.
    pub fn known(&self) -> Known {
        Known { boxes: self.budget.boxes(), ..self.live.known() }
    }

    /// Finds the front. `known` are the objectives of designs that are known already. These designs prune boxes, but
    /// they are not listed.
    pub fn run(&self, known: &[Objectives]) -> ExactOutcome {
        let mut state = SearchState::toward(self.only);
        known.iter().for_each(|objectives| state.enter(objectives));
        let whole = self.space_of(None);
        let found = self.search_part(whole.as_ref(), (state, known.is_empty()), Some(&self.live));
        self.listed(whole.as_ref(), found)
    }

    /// Finds the front of the designs whose chosen links are all of one material, given by its index in the
    /// study.
    pub fn run_of_material(&self, material_index: usize) -> ExactOutcome {
        let whole = self.space_of(Some(material_index));
        let found = self.search_part(whole.as_ref(), (SearchState::toward(self.only), true), None);
        self.listed(whole.as_ref(), found)
    }

    /// The compiled space of all designs, or of the designs whose chosen links are all of one material.
    pub(super) fn space_of(&self, material_index: Option<usize>) -> Option<Problem<'p>> {
        let is_of_it =
            |option: &LinkOption| material_index.is_none_or(|index| option.material_index == index);
        self.problem(&is_of_it, Ties::Merged)
    }

    /// The compiled space with the link options for which `takes` is true. `None` if a level has no option.
    pub(super) fn problem(&self, takes: &dyn Fn(&LinkOption) -> bool, ties: Ties) -> Option<Problem<'p>> {
        Problem::with_joints(self.space, self.joints(), takes, ties)
    }

    /// Searches one part of the study: all designs, or the designs of one material. The search starts from the given
    /// state; the flag tells whether no designs are known in it. `whole` is the compiled space of the part; `None` if
    /// it has no design. If an earlier process has finished this part, its result is returned.
    pub(super) fn search_part(
        &self,
        whole: Option<&Problem<'p>>,
        (mut state, is_new): (SearchState, bool),
        live: Option<&LiveProgress>,
    ) -> FoundInShard {
        if let Some(found) = self.journal.next_finished() {
            return found;
        }
        let (mut subtrees, mut ended) = (Vec::new(), Ended { gap: Some(0.0), open: Vec::new() });
        match whole {
            Some(whole) => {
                let names_and_boxes = self.subtrees(whole, self.is_by_regions(whole));
                subtrees = names_and_boxes.0;
                ended = self.search((whole, &names_and_boxes.1), is_new, &mut state, live);
            }
            // A space without designs has one subtree with an empty name. It belongs to the first shard.
            None if self.shard.number == 1 => subtrees.push(String::new()),
            None => {}
        }
        let designs_evaluated = state.evaluated;
        let [decided, undecided] = state.into_found();
        let found = FoundInShard {
            subtrees,
            designs_evaluated,
            boxes: self.budget.boxes(),
            boxes_open: ended.open.len() as u64,
            gap: ended.gap,
            decided,
            undecided,
        };
        if found.boxes_open == 0 {
            self.journal.finish(&found);
        }
        found
    }

    /// Lists the designs found. All ties are listed if there are not too many.
    pub(super) fn listed(&self, whole: Option<&Problem<'p>>, found: FoundInShard) -> ExactOutcome {
        let FoundInShard { designs_evaluated, boxes, boxes_open, gap, decided: mut front, undecided, .. } =
            found;
        front.extend(undecided);
        let (mut front, ties_listed) = match whole {
            Some(whole) => whole.with_ties(&front, self.most_with_ties),
            None => (front, true),
        };
        front.sort_unstable_by_key(|c| c.number);
        // An undecided design may be in the list more than once, because a probe and a box can find it independently.
        front.dedup_by_key(|c| c.number);
        ExactOutcome {
            // This is the number of designs in the study, even if the space was not compiled because a level has no
            // usable option.
            designs_total: self.space.designs_with(self.joints()).unwrap_or(u128::MAX),
            designs_evaluated,
            boxes,
            boxes_open,
            gap,
            front,
            ties_listed,
        }
    }

    /// Whether a space is so large that it is searched region by region.
    fn is_by_regions(&self, whole: &Problem) -> bool {
        whole.designs() as f64 > self.regions_from
    }

    /// Searches some boxes of a compiled space in passes. `is_new` tells whether no designs are known at the start.
    fn search(
        &self,
        (whole, boxes): (&Problem<'p>, &[DesignBox]),
        is_new: bool,
        state: &mut SearchState,
        live: Option<&LiveProgress>,
    ) -> Ended {
        let (designs, by_regions) = (whole.designs() as f64, self.is_by_regions(whole));
        // Small spaces need no passes with slack. If designs are given, boxes can be pruned from the start.
        let in_passes = is_new && (by_regions || designs > LARGE_SPACE);
        let early = live.filter(|_| in_passes).map(|live| Early::new(&self.budget, whole, live));
        let mut begun = self.journal.begun();
        match &mut begun {
            Some(begun) => *state = SearchState::from_kept(begun.state(), self.only),
            None if is_new => self.first_incumbents(whole, by_regions, state, early.as_ref()),
            None => {}
        }
        let (mut done, told, mut left) = match begun {
            Some(mut begun) => (std::mem::take(&mut begun.passes), begun.told, begun.open_pass(whole)),
            None => (Vec::<Pass>::new(), None, None),
        };
        live.into_iter().for_each(|live| live.prove(told));
        let plan = if in_passes { Plan::new(self.gap, by_regions) } else { Plan::single(self.gap) };
        let mut open = Vec::new();
        let begun = |left: &Option<(f64, Vec<OpenBox>)>| left.as_ref().map(|(slack, _)| *slack);
        while let Some(slack) = begun(&left).or_else(|| plan.next(&done, self.budget.left_s())) {
            let (started, from) = (Instant::now(), left.take().map(|(_, boxes)| boxes));
            let told = || live.and_then(|live| live.known().gap);
            let between = |state: &SearchState| Begun::between(state, &done, told());
            open = if by_regions {
                self.journal.begin_pass(&self.budget, || between(state));
                let seen = (live, || self.journal.keep_start());
                pass_by_regions(&self.budget, whole, state, (slack, boxes), self.regions_to, seen)
            } else {
                let keep = |state: &SearchState, open: &[OpenBox]| {
                    self.journal.keep_round(&self.budget, || between(state), (slack, open));
                };
                let first = from.unwrap_or_else(|| OpenBox::first(whole, boxes));
                pass_by_boxes(&self.budget, whole, state, (slack, first), live, keep)
            };
            if !open.is_empty() {
                // A gap that was reported once stays proved for the designs found since.
                let told = live.and_then(|live| live.known().gap);
                let of_early = early.and_then(|early| early.into_state(state));
                let of_open = gap(&open, &state.front()).map(|gap| gap.max(slack));
                let proven = done.last().map(|pass| pass.slack);
                let gap = [proven, told, of_early, of_open].into_iter().reduce(least).flatten();
                return Ended { gap, open };
            }
            done.push(Pass { slack, took_s: started.elapsed().as_secs_f64() });
            live.into_iter().for_each(|live| live.prove(Some(slack)));
        }
        Ended { gap: done.last().map(|pass| pass.slack), open }
    }

    /// Finds the first incumbents by probes. If the space is searched by regions, a genetic algorithm improves them.
    fn first_incumbents(
        &self,
        whole: &Problem<'p>,
        by_regions: bool,
        state: &mut SearchState,
        early: Option<&Early>,
    ) {
        let tell = |found: &[Objectives], designs: u64| {
            early.into_iter().for_each(|early| early.tell(found, designs));
        };
        let per_decade = if by_regions { PROBES_TO_EVOLVE } else { PROBES_PER_SQUARED_DECADE };
        let probes = (per_decade * libm::log10(whole.designs() as f64).powi(2)) as usize;
        let probed = probe(&self.budget, whole, probes, state);
        tell(&state.front(), state.evaluated);
        if by_regions {
            evolve(&self.budget, whole, probed, state, tell);
        }
    }
}
