//! Whether an exact search lists what a visit to every design finds.

use armwright::catalog::Catalogs;
use armwright::exact::Exact;
use armwright::input::Document;
use armwright::pareto::front::nondominated;
use armwright::search::Sweep;
use armwright::search::sweep::Candidate;
use armwright::space::ArmProblem;
use armwright::space::evaluate;
use armwright::study::{Study, read_study};
use serde_json::Value;
use std::path::Path;
use std::sync::atomic::AtomicBool;

pub fn read(study: &Value, catalogs: &Catalogs) -> Study {
    let text = study.to_string();
    let document = Document::parse("random study", &text).unwrap_or_else(|e| panic!("{e}"));
    read_study(document, catalogs).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// The designs of a front, judged by the full model.
pub fn judged(problem: &ArmProblem, candidates: &[Candidate]) -> Vec<u128> {
    let judged: Vec<_> = candidates.iter().filter_map(|c| evaluate(problem, c.number)).collect();
    let points: Vec<_> = judged.iter().map(|d| d.objectives.minimized()).collect();
    let mut numbers: Vec<u128> =
        nondominated(&points).expect("numbers").into_iter().flatten().map(|i| judged[i].number).collect();
    numbers.sort_unstable();
    numbers
}

/// How the fast objectives may differ from the full model's (tests/design/search_fast_vs_full.rs).
const ROUNDING: f64 = 2e-10;

/// Designs that are better than every other by at least `least` in something, or tie with what beats them.
pub fn with_merit(problem: &ArmProblem, numbers: &[u128], least: f64) -> Vec<u128> {
    let objectives =
        |n: &u128| evaluate(problem, *n).expect("a design of the front").objectives.minimized().map(f64::abs);
    let all: Vec<[f64; 3]> = numbers.iter().map(objectives).collect();
    let beats = |a: &[f64; 3], b: &[f64; 3]| {
        // mass and deflection small, frequency large
        let excess = [a[0] / b[0] - 1.0, a[1] / b[1] - 1.0, b[2] / a[2] - 1.0];
        excess.iter().all(|e| *e <= least) && excess.iter().any(|e| *e < -1e-7)
    };
    let kept = all.iter().map(|b| !all.iter().any(|a| beats(a, b)));
    numbers.iter().zip(kept).filter(|(_, kept)| *kept).map(|(n, _)| *n).collect()
}

/// Asserts that the exact search lists the designs of the sweep whose merit is at least 1e-9 (docs/exact.md), and returns
/// how many it lists. On that edge rounding decides. A design that the sweep does not list is one that lost to designs
/// without merit; it is no stranger to the study.
pub fn agrees(problem: &ArmProblem, exact: &[Candidate], sweep: &[Candidate], what: &str) -> usize {
    let (exact, swept) = (judged(problem, exact), judged(problem, sweep));
    let surely = with_merit(problem, &swept, 1e-9 + ROUNDING);
    let missing: Vec<_> = surely.iter().filter(|n| !exact.contains(n)).collect();
    let added: Vec<_> =
        exact.iter().filter(|n| !swept.contains(n) && !is_beaten(problem, **n, &swept)).collect();
    assert!(missing.is_empty() && added.is_empty(), "missing {missing:?}, added {added:?}: {what}");
    exact.len()
}

/// Whether a design of the list is no worse than the design `number` in any objective.
fn is_beaten(problem: &ArmProblem, number: u128, by: &[u128]) -> bool {
    let objectives = |n: u128| evaluate(problem, n).expect("a design that holds").objectives.minimized();
    let beaten = objectives(number);
    by.iter().any(|&n| objectives(n).iter().zip(&beaten).all(|(a, b)| a <= b))
}

/// Asserts that the exact search, by boxes and if asked by regions too, lists what the sweep lists. Returns the front of the
/// sweep and how many designs the exact search lists.
pub fn both_searches(
    study: &Study,
    catalogs: &Catalogs,
    by_regions: bool,
    what: &str,
) -> (Vec<Candidate>, usize) {
    let stop = AtomicBool::new(false);
    let problem = ArmProblem::new(&study.space, catalogs);
    let sweep = Sweep::new(&problem, study.space.constraints, &stop).run();
    let what = format!("{} designs: {what}", sweep.designs_total);
    let exact = || Exact::new(&study.space, catalogs, &stop, None);
    let listed = agrees(&problem, &exact().run(&[]).front, &sweep.front, &what);
    if by_regions {
        agrees(&problem, &exact().by_regions_from(100.0).run(&[]).front, &sweep.front, &what);
    }
    (sweep.front, listed)
}

/// Asserts that both searches find the same designs of a study, by boxes and if asked by regions, and returns how many.
/// Regions are for spaces far larger, and take by far the longest on small ones.
pub fn agree(text: &Value, by_regions: bool) -> usize {
    let catalogs = Catalogs::builtin();
    both_searches(&read(text, &catalogs), &catalogs, by_regions, &text.to_string()).1
}

/// Writes another text into a file of a result and into the list of its files, as a program would that is wrong and not torn.
pub fn write_listed(results: &Path, name: &str, text: &str) {
    std::fs::write(results.join(name), text).expect("written");
    let file = results.join("run.json");
    let mut run: Value = serde_json::from_str(&std::fs::read_to_string(&file).expect("a run")).expect("JSON");
    run["files"][name] = blake3::hash(text.as_bytes()).to_hex().to_string().into();
    run.as_object_mut().expect("keys").remove("manifest_hash");
    std::fs::write(&file, run.to_string()).expect("written");
}
