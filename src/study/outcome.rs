//! Running a study: sweep every design by the fast model, then judge what is left by the full one.

use super::Study;
use crate::catalog::Catalogs;
use crate::search::front::nondominated;
use crate::search::sweep::{Candidate, Sweep, SweepOutcome};
use crate::search::{ArmProblem, Evaluated, evaluate};
use rayon::prelude::*;
use std::sync::atomic::AtomicBool;

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
        finished.store(true, std::sync::atomic::Ordering::Relaxed);
        outcome
    });
    StudyOutcome {
        front: judge(&problem, &outcome.front),
        by_material: outcome.groups.iter().map(|g| judge(&problem, g)).collect(),
        sweep: outcome,
    }
}

/// Judges candidates by the full model and keeps what nothing dominates.
fn judge(problem: &ArmProblem, candidates: &[Candidate]) -> Front {
    let judged: Vec<Evaluated> = candidates.par_iter().filter_map(|c| evaluate(problem, c.number)).collect();
    let points: Vec<[f64; 3]> = judged.iter().map(|d| d.objectives.minimized()).collect();
    nondominated(&points)
        .expect("the full model answers in numbers")
        .into_iter()
        .enumerate()
        .flat_map(|(group, members)| members.into_iter().map(move |i| (group + 1, i)))
        .map(|(tie_group, i)| Judged { design: judged[i].clone(), tie_group })
        .collect()
}
