//! Runs a study: a search with the fast model finds candidates, and the full model evaluates them.

use super::definition::Study;
use crate::catalog::Catalogs;
use crate::exact::Known;
use crate::exact::outcome::ExactOutcome;
use crate::exact::run::Exact;
use crate::pareto::front::nondominated;
use crate::search::near::{NearDesign, NearDesigns, Slack};
use crate::search::resume::Resume;
use crate::search::sweep::{Candidate, Shard, Status, Sweep, SweepOutcome, SweepState};
use crate::space::design::number;
use crate::space::design::{Evaluated, evaluate};
use crate::space::design_space::DesignSpace;
use crate::space::levels::OutwardIn;
use crate::space::problem::ArmProblem;
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// A design of a front, evaluated by the full model.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// Number and objectives of the design.
    pub design: Evaluated,
    /// Number of the tie group of the design, from 1: all designs of the front with the same objectives have the same
    /// number.
    pub tie_group: usize,
}

/// A front: the designs that no other dominates, lightest first.
pub type Front = Vec<Judged>;

/// The result of a study: fronts, and facts of the search.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyOutcome {
    /// The result of the search with the fast model: counts of designs, and candidates for the fronts.
    pub sweep: SweepOutcome,
    /// The front of all designs.
    pub front: Front,
    /// The fronts of single materials, in the order of the study's materials.
    pub by_material: Vec<OfMaterial>,
}

/// The front of the designs whose chosen links are all of one material.
#[derive(Debug, Clone, PartialEq)]
pub struct OfMaterial {
    /// Name of the material.
    pub name: String,
    /// How the search for this front ended.
    pub status: Status,
    /// The front of the designs of this material, lightest first.
    pub front: Front,
    /// Whether the front lists all designs that differ only in drives of equal mass and torsion curve. If not, it has
    /// only one of each such set.
    pub ties_listed: bool,
}

/// Runs an exhaustive search: evaluates every design of the study. `watch` runs on another thread to show progress. Its
/// arguments are the number of designs, a function that returns how many of them were visited, and a flag. `watch` must
/// return when the flag is set.
pub fn run_study(
    study: &Study,
    catalogs: &Catalogs,
    stop: &AtomicBool,
    watch: impl FnOnce(u128, &(dyn Fn() -> u64 + Sync), &AtomicBool) + Send,
) -> StudyOutcome {
    let problem = ArmProblem::new(&study.space, catalogs);
    let sweep = Sweep::new(&problem, study.space.constraints, stop);
    let swept = watched(|finished| watch(sweep.total(), &|| sweep.visited(), finished), || sweep.run());
    judge_swept(study, &problem, swept)
}

/// Evaluates the designs of one shard, which is a range of design numbers. Returns the candidates of the shard and the
/// range. The search continues from the saved state in `resume`, and saves its own states there. `watch` is as in
/// [`run_study`].
///
/// # Errors
/// A message if the saved state belongs to another search.
pub fn sweep_shard(
    study: &Study,
    catalogs: &Catalogs,
    shard: Shard,
    stop: &AtomicBool,
    Resume { from, keeper }: Resume,
    watch: impl FnOnce(u128, &(dyn Fn() -> u64 + Sync), &AtomicBool) + Send,
) -> Result<(SweepOutcome, Range<u128>), String> {
    let problem = ArmProblem::new(&study.space, catalogs);
    let mut sweep = Sweep::new(&problem, study.space.constraints, stop).of_shard(shard);
    if let Some(bytes) = from {
        sweep = sweep.go_on_from(SweepState::from_bytes(bytes)?)?;
    }
    let range = sweep.range();
    let designs = range.end - range.start;
    let keep = |finished: &AtomicBool| {
        while !finished.load(Ordering::Relaxed) {
            std::thread::sleep(LOOK_EVERY);
            if keeper.is_due() {
                keeper.keep(&sweep.state().to_bytes());
            }
        }
    };
    let outcome =
        watched(keep, || watched(|finished| watch(designs, &|| sweep.visited(), finished), || sweep.run()));
    // the state is saved now, so that no design is evaluated twice even if the result is lost later
    if keeper.is_due() || stop.load(Ordering::Relaxed) {
        keeper.keep(&sweep.state().to_bytes());
    }
    Ok((outcome, range))
}

/// Time between two checks whether the state of a search is due to be saved.
const LOOK_EVERY: Duration = Duration::from_millis(10);

/// Evaluates the candidates of a sweep (a search that visits every design) by the full model and finds the fronts.
pub fn judge_swept(study: &Study, problem: &ArmProblem, outcome: SweepOutcome) -> StudyOutcome {
    // a design may be a candidate of two fronts, and is evaluated once
    let all = outcome.groups.iter().flatten().chain(&outcome.front).map(|c| c.number);
    let judged = by_full_model(problem, all.collect());
    let of_material = |(name, candidates): (String, &Vec<Candidate>)| {
        let front = front_of(&judged, candidates);
        let is_known_empty = front.is_empty() && outcome.status != Status::Interrupted;
        let status = if is_known_empty { Status::Infeasible } else { outcome.status };
        OfMaterial { name, status, front, ties_listed: true }
    };
    let names = study.space.material_names();
    StudyOutcome {
        front: front_of(&judged, &outcome.front),
        by_material: names.into_iter().zip(&outcome.groups).map(of_material).collect(),
        sweep: outcome,
    }
}

/// Runs `work` and returns its result, while `watch` runs on another thread. The flag that `watch` is given is set when
/// `work` ends, even by a panic.
pub(super) fn watched<T>(watch: impl FnOnce(&AtomicBool) + Send, work: impl FnOnce() -> T) -> T {
    struct EndOnDrop<'f>(&'f AtomicBool);
    impl Drop for EndOnDrop<'_> {
        fn drop(&mut self) {
            self.0.store(true, Ordering::Relaxed);
        }
    }
    let finished = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| watch(&finished));
        let _end = EndOnDrop(&finished);
        work()
    })
}

/// The result of an exact search.
#[derive(Debug, Clone)]
pub struct ExactStudy {
    /// The study, reduced to the link options that occur in the designs found.
    pub study: Study,
    /// The fronts. Those of single materials are searched only if the front of all designs is whole.
    pub outcome: StudyOutcome,
    /// Number of boxes bounded for the front of all designs, and number of boxes left open.
    pub boxes: [u64; 2],
    /// The gap: for every design of the study, some listed design is worse by at most this fraction in each
    /// objective. 0 means that the front is whole; `None` that no gap was proved.
    pub gap: Option<f64>,
    /// The near designs; `None` if they were not asked for, or if time ran out before all were found.
    pub near: Option<NearDesigns>,
    /// Whether the front lists all designs that differ only in drives of equal mass and torsion curve. If not, it has
    /// only one of each such set.
    pub ties_listed: bool,
}

/// How far an exact search goes before it may end.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Extent {
    /// Time at which the search must stop; `None` means no time limit.
    pub deadline: Option<Instant>,
    /// The gap at which the search may end: for every design of the study, some listed design is worse by at most
    /// this fraction in each objective. 0 asks for the whole front.
    pub gap: f64,
    /// How near the near designs may be that are asked for, and how many of them are listed; `None` if none are asked
    /// for.
    pub near: Option<Slack>,
}

/// The results of the searches, one for each front. Their designs are numbered in the whole space.
pub(super) struct Searched {
    whole: ExactOutcome,
    by_material: Vec<(String, ExactOutcome)>,
    near: Option<NearDesigns>,
}

impl Searched {
    /// Starts from the result `whole` of the search for the front of all designs. If this front is whole, the fronts of
    /// the materials and the designs near the front are searched too. `of_material` searches the front of the material
    /// with a given index.
    pub(super) fn new(
        search: &Exact,
        space: &DesignSpace,
        (whole, of_material): (ExactOutcome, impl Fn(usize) -> ExactOutcome),
        near: Option<Slack>,
    ) -> Self {
        if whole.boxes_open > 0 || whole.gap != Some(0.0) || whole.front.is_empty() {
            return Self { whole, by_material: Vec::new(), near: None };
        }
        let names = space.material_names();
        let by_material: Vec<ExactOutcome> = match names.len() {
            1 => vec![whole.clone()],
            materials => (0..materials).map(of_material).collect(),
        };
        Self {
            // if the front leaves out millions of ties, these ties would be the only near designs
            near: near.filter(|_| whole.ties_listed).and_then(|slack| {
                let most = slack.most + whole.front.len();
                search.near(&whole.front, Slack { most, ..slack })
            }),
            by_material: names.into_iter().zip(by_material).collect(),
            whole,
        }
    }

    /// The numbers, in the whole space, of all designs that were found: those of the fronts and the near designs.
    fn numbers(&self) -> Vec<u128> {
        let fronts = std::iter::once(&self.whole).chain(self.by_material.iter().map(|(_, of)| of));
        let near = self.near.iter().flat_map(|near| near.nearest.iter().map(|n| n.candidate.number));
        fronts.flat_map(|of| of.front.iter().map(|c| c.number)).chain(near).collect()
    }

    /// Evaluates, with the full model, the designs that the searches found: all those of the fronts, and at most `most`
    /// near designs. `problem` is an excerpt of the space, so the numbers of the designs are converted to it.
    fn judged(&self, problem: &ArmProblem, most: Option<usize>) -> (StudyOutcome, Option<NearDesigns>) {
        let here = |candidate: &Candidate| {
            let options = problem.options_of_whole(candidate.number)?;
            Some(Candidate { number: number(problem.level_sizes(), &options), ..*candidate })
        };
        let all_here = |found: &ExactOutcome| found.front.iter().filter_map(here).collect::<Vec<_>>();
        let Self { whole, by_material, near } = self;
        let front = all_here(whole);
        let groups: Vec<Vec<Candidate>> = by_material.iter().map(|(_, found)| all_here(found)).collect();
        // a design may be a candidate of two fronts, and is evaluated once
        let judged =
            by_full_model(problem, groups.iter().flatten().chain(&front).map(|c| c.number).collect());
        let of_material =
            |((name, found), candidates): (&(String, ExactOutcome), &Vec<Candidate>)| OfMaterial {
                name: name.clone(),
                status: status(found),
                front: front_of(&judged, candidates),
                ties_listed: found.ties_listed,
            };
        let whole_front = front_of(&judged, &front);
        let on_front: HashSet<u128> = whole_front.iter().map(|j| j.design.number).collect();
        let near = near.as_ref().zip(most).map(|(near, most)| {
            let moved = |n: &NearDesign| Some(NearDesign { candidate: here(&n.candidate)?, ..*n });
            let off_front = |n: &NearDesign| !on_front.contains(&n.candidate.number);
            let mut nearest: Vec<NearDesign> =
                near.nearest.iter().filter_map(moved).filter(off_front).collect();
            let listed_of_front = (near.nearest.len() - nearest.len()) as u64;
            nearest.truncate(most);
            NearDesigns { nearest, total: near.total.map(|total| total - listed_of_front) }
        });
        let outcome = StudyOutcome {
            front: whole_front,
            by_material: by_material.iter().zip(&groups).map(of_material).collect(),
            sweep: SweepOutcome {
                status: status(whole),
                designs_total: whole.designs_total,
                designs_evaluated: whole.designs_evaluated,
                designs_excluded: whole.designs_total.saturating_sub(u128::from(whole.designs_evaluated)),
                front,
                groups,
            },
        };
        (outcome, near)
    }
}

fn status(found: &ExactOutcome) -> Status {
    match (found.boxes_open, found.front.is_empty()) {
        (0, true) => Status::Infeasible,
        (0, false) => Status::Certified,
        _ => Status::Partial,
    }
}

/// Runs an exact search: finds the fronts of a space without evaluating every design, and the near designs if they are
/// asked for. It ends as `extent` says, or when `stop` is set. `watch` runs on another thread to show progress; its
/// arguments are a function that returns what is known so far, and a flag. `watch` must return when the flag is set.
pub fn run_exact(
    study: &Study,
    catalogs: &Catalogs,
    stop: &AtomicBool,
    extent: Extent,
    watch: impl FnOnce(&(dyn Fn() -> Known + Sync), &AtomicBool) + Send,
) -> ExactStudy {
    let search = Exact::new(&study.space, catalogs, stop, extent.deadline).to_gap(extent.gap);
    searched_by(&search, study, catalogs, extent, watch)
}

/// Runs an exact search as [`run_exact`] does, but continues from the state in `resume`, and saves its own states
/// there.
///
/// # Errors
/// A message if the saved state belongs to another search.
pub fn resume_exact(
    study: &Study,
    catalogs: &Catalogs,
    stop: &AtomicBool,
    extent: Extent,
    resume: Resume,
    watch: impl FnOnce(&(dyn Fn() -> Known + Sync), &AtomicBool) + Send,
) -> Result<ExactStudy, String> {
    let search = Exact::new(&study.space, catalogs, stop, extent.deadline).to_gap(extent.gap);
    Ok(searched_by(&search.resumed(resume)?, study, catalogs, extent, watch))
}

fn searched_by(
    search: &Exact,
    study: &Study,
    catalogs: &Catalogs,
    Extent { near, .. }: Extent,
    watch: impl FnOnce(&(dyn Fn() -> Known + Sync), &AtomicBool) + Send,
) -> ExactStudy {
    let of_material = |index: usize| search.run_of_material(index);
    let work = || Searched::new(search, &study.space, (search.run(&[]), of_material), near);
    let searched = watched(|finished| watch(&|| search.known(), finished), work);
    judged_exactly(&searched, study, catalogs, near)
}

/// Evaluates, with the full model and in an excerpt of the study's space, all designs that the searches found.
pub(super) fn judged_exactly(
    searched: &Searched,
    study: &Study,
    catalogs: &Catalogs,
    near: Option<Slack>,
) -> ExactStudy {
    let most = near.map(|slack| slack.most);
    let space = study.space.excerpt(catalogs, &searched.numbers()).unwrap_or_else(|| study.space.clone());
    let study = Study { space, ..study.clone() };
    let whole = &searched.whole;
    let (boxes, gap) = ([whole.boxes, whole.boxes_open], whole.gap);
    let ties_listed = whole.ties_listed;
    let (outcome, near) = searched.judged(&ArmProblem::new(&study.space, catalogs), most);
    ExactStudy { study, outcome, boxes, gap, near, ties_listed }
}

/// Evaluates candidates with the full model and keeps those that no other one dominates.
pub(super) fn judge(problem: &ArmProblem, candidates: &[Candidate]) -> Front {
    front_of(&by_full_model(problem, candidates.iter().map(|c| c.number).collect()), candidates)
}

/// Evaluates the designs with the given numbers by the full model, each once. Designs that it finds infeasible are left
/// out.
pub(super) fn by_full_model(problem: &ArmProblem, mut numbers: Vec<u128>) -> HashMap<u128, Evaluated> {
    numbers.sort_unstable();
    numbers.dedup();
    numbers.into_par_iter().filter_map(|n| Some((n, evaluate(problem, n)?))).collect()
}

/// The designs of `candidates` that no other one dominates by the full model, with their tie groups. `judged` are the
/// designs by number as the full model evaluates them; candidates that are not in it are infeasible.
fn front_of(judged: &HashMap<u128, Evaluated>, candidates: &[Candidate]) -> Front {
    let judged: Vec<&Evaluated> = candidates.iter().filter_map(|c| judged.get(&c.number)).collect();
    let points: Vec<[f64; 3]> = judged.iter().map(|d| d.objectives.minimized()).collect();
    nondominated(&points)
        .expect("the full model answers in numbers")
        .into_iter()
        .enumerate()
        .flat_map(|(group, members)| members.into_iter().map(move |i| (group + 1, i)))
        .map(|(tie_group, i)| Judged { design: judged[i].clone(), tie_group })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_watcher_is_told_of_the_end_even_if_it_is_a_panic() {
        let wait = |finished: &AtomicBool| {
            while !finished.load(Ordering::Relaxed) {
                std::thread::yield_now();
            }
        };
        assert_eq!(watched(wait, || 7), 7);
        let broken = || watched(wait, || -> u8 { panic!("broken on purpose") });
        assert!(std::panic::catch_unwind(broken).is_err());
    }
}
