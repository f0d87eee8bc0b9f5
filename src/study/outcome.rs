//! Running a study: sweep every design by the fast model, then judge what is left by the full one.

use super::Study;
use crate::catalog::Catalogs;
use crate::search::design::number;
use crate::search::exact::Exact;
use crate::search::front::nondominated;
use crate::search::sweep::{Candidate, Sweep, SweepOutcome};
use crate::search::{ArmProblem, Evaluated, OutwardIn, Status, evaluate};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// A design of a front, judged by the full model.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged {
    /// The design and its objectives.
    pub design: Evaluated,
    /// Number of its tie group in the front, from 1.
    pub tie_group: usize,
}

/// A front: the designs that no other dominates, lightest first.
pub type Front = Vec<Judged>;

/// What a study found.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyOutcome {
    /// The sweep's counts and candidates.
    pub sweep: SweepOutcome,
    /// Front of all designs.
    pub front: Front,
    /// Front of each material's designs, in the order of the study's materials.
    pub by_material: Vec<Front>,
}

/// Sweeps the study's designs. `watch` runs beside it with a function that tells how many designs are
/// done, and must return when its second argument says so.
pub fn run_study(
    study: &Study,
    catalogs: &Catalogs,
    stop: &AtomicBool,
    watch: impl FnOnce(u128, &(dyn Fn() -> u64 + Sync), &AtomicBool) + Send,
) -> StudyOutcome {
    let problem = ArmProblem::new(&study.space, catalogs);
    let sweep = Sweep::new(&problem, study.space.constraints, stop);
    let finished = AtomicBool::new(false);
    let outcome = std::thread::scope(|scope| {
        scope.spawn(|| watch(sweep.total(), &|| sweep.visited(), &finished));
        let outcome = sweep.run();
        finished.store(true, Ordering::Relaxed);
        outcome
    });
    // a design may be a candidate of two fronts
    let all = outcome.groups.iter().flatten().chain(&outcome.front).map(|c| c.number);
    let judged = by_full_model(&problem, all.collect());
    StudyOutcome {
        front: front_of(&judged, &outcome.front),
        by_material: outcome.groups.iter().map(|g| front_of(&judged, g)).collect(),
        sweep: outcome,
    }
}

/// What an exact search found.
#[derive(Debug, Clone)]
pub struct ExactStudy {
    /// The study with those link options alone that its front is made of.
    pub study: Study,
    /// Its front; the designs of one material have none of their own.
    pub outcome: StudyOutcome,
    /// Boxes bounded, and how many were left open.
    pub boxes: [u64; 2],
    /// By how much the front may be bettered; 0 if it is certified.
    pub gap: Option<f64>,
}

/// Finds the front of a space too large to visit, until `stop` is set or the deadline has passed. `watch`
/// runs beside it with a function that tells how many boxes are done, and must return when its second
/// argument says so.
pub fn run_exact(
    study: &Study,
    catalogs: &Catalogs,
    stop: &AtomicBool,
    deadline: Option<Instant>,
    watch: impl FnOnce(&(dyn Fn() -> u64 + Sync), &AtomicBool) + Send,
) -> ExactStudy {
    let search = Exact::new(&study.space, catalogs, stop, deadline);
    let finished = AtomicBool::new(false);
    let found = std::thread::scope(|scope| {
        scope.spawn(|| watch(&|| search.boxes(), &finished));
        let found = search.run(&[]);
        finished.store(true, Ordering::Relaxed);
        found
    });
    let status = match (stop.load(Ordering::Relaxed), found.boxes_open, found.front.is_empty()) {
        (true, _, _) => Status::Interrupted,
        (false, 0, true) => Status::Infeasible,
        (false, 0, false) => Status::Certified,
        (false, _, _) => Status::Partial,
    };
    let numbers: Vec<u128> = found.front.iter().map(|c| c.number).collect();
    let space = study.space.excerpt(catalogs, &numbers).unwrap_or_else(|| study.space.clone());
    let study = Study { space, ..study.clone() };
    let problem = ArmProblem::new(&study.space, catalogs);
    let candidates: Vec<Candidate> = found
        .front
        .iter()
        .filter_map(|c| {
            let options = problem.options_of_whole(c.number)?;
            Some(Candidate { number: number(problem.level_sizes(), &options), objectives: c.objectives })
        })
        .collect();
    let front = judge(&problem, &candidates);
    let evaluated = u128::from(found.designs_evaluated);
    let sweep = SweepOutcome {
        status,
        designs_total: found.designs_total,
        designs_evaluated: found.designs_evaluated,
        designs_excluded: found.designs_total.saturating_sub(evaluated),
        front: candidates,
        groups: Vec::new(),
        near_misses: [None; 3],
    };
    drop(problem);
    let outcome = StudyOutcome { sweep, front, by_material: Vec::new() };
    ExactStudy { study, outcome, boxes: [found.boxes, found.boxes_open], gap: found.gap }
}

/// Judges candidates by the full model and keeps what nothing dominates.
pub(super) fn judge(problem: &ArmProblem, candidates: &[Candidate]) -> Front {
    front_of(&by_full_model(problem, candidates.iter().map(|c| c.number).collect()), candidates)
}

/// Numbered designs by the full model, each once; those that cannot hold are left out.
pub(super) fn by_full_model(problem: &ArmProblem, mut numbers: Vec<u128>) -> HashMap<u128, Evaluated> {
    numbers.sort_unstable();
    numbers.dedup();
    numbers.into_par_iter().filter_map(|n| Some((n, evaluate(problem, n)?))).collect()
}

/// The candidates that no other dominates.
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
