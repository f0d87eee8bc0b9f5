//! The front of a study.

use crate::catalogs::Catalogs;
use crate::conduct::{conduct, workers};
use crate::errors;
use crate::source::Source;
use armwright::catalog;
use armwright::exact::Known;
use armwright::pareto::hypervolume::front_hypervolume;
use armwright::report::facts::constraint_words;
use armwright::report::front_table::FrontTable;
use armwright::report::picks::{Pick, designs, picks};
use armwright::search::Status;
use armwright::space::ArmProblem;
use armwright::study::{
    Extent, Refusal, SearchMethod, SearchWish, Study, StudyOutcome, caveats_on, effects_json, front_table,
    judged_cases, run_exact, run_study, table_and_remarks, why_infeasible,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::{Value, json};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// A table: its columns and rows.
type Table = (Vec<String>, Vec<Vec<String>>);

/// What a search found, as Python gets it: the front, the front of each material, facts in JSON, and the study's text.
type Found = (Table, Vec<(String, Table)>, String, String);

/// What a search tells while it runs.
#[derive(Debug, Clone, Copy, Default)]
struct Told {
    designs: u64,
    designs_total: Option<f64>,
    known: Option<Known>,
}

/// How a study is searched.
struct Asked<'a> {
    study: &'a Study,
    /// Text of the study's file.
    text: &'a str,
    catalogs: &'a catalog::Catalogs,
    /// Why this method was chosen, if an estimate chose it.
    why: Option<String>,
    method: SearchMethod,
    /// Gap at which an exact search may end, as a fraction.
    gap: f64,
    time_limit: Option<Duration>,
}

/// Why a search has no front.
enum NoFront {
    Refused(Refusal),
    OutOfTime,
}

#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "they are those of the Python function")]
#[pyo3(signature = (catalogs, study, method, gap_percent, time_limit_s, threads, progress))]
pub(crate) fn run(
    py: Python<'_>,
    catalogs: &Catalogs,
    study: Source,
    method: Option<&str>,
    gap_percent: Option<f64>,
    time_limit_s: Option<f64>,
    threads: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<Found> {
    let parts = catalogs.parts.clone();
    let pool = workers(threads)?;
    // a study of many parts takes a while to read
    let (study, text) = py.detach(|| pool.install(|| study.study(&parts)))?;
    let time_limit = time_limit_s.map(Duration::try_from_secs_f64).transpose().map_err(errors::usage)?;
    let wish = SearchWish {
        method: method.map(search_method).transpose()?,
        has_gap: gap_percent.is_some(),
        has_time_limit: time_limit.is_some(),
    };
    let told = Mutex::new(Told::default());
    let tell = |py: Python<'_>, elapsed: Duration| match &progress {
        Some(call) => call.call1(py, (progress_dict(py, &read(&told), elapsed)?,)).map(drop),
        None => Ok(()),
    };
    let (found, raised) = conduct(py, tell, |stop| {
        pool.install(|| {
            let (method, why) = wish.method(&study, &parts).map_err(NoFront::Refused)?;
            let gap = gap_percent.map_or(study.gap, |percent| percent * 0.01);
            let asked = Asked { study: &study, text: &text, catalogs: &parts, why, method, gap, time_limit };
            find(&asked, stop, &told)
        })
    });
    match (found, raised) {
        (Ok(found), None) => Ok(found),
        (found, Some(raised)) => {
            if let Ok(found) = found {
                raised.value(py).setattr("_found", found)?;
            }
            Err(raised)
        }
        (Err(NoFront::Refused(refusal)), None) => Err(errors::refused(refusal)),
        (Err(NoFront::OutOfTime), None) => {
            Err(errors::out_of_time("no design was found before the time limit; allow more time".into()))
        }
    }
}

fn search_method(word: &str) -> PyResult<SearchMethod> {
    match word {
        "exhaustive" => Ok(SearchMethod::Exhaustive),
        "exact" => Ok(SearchMethod::Exact),
        _ => Err(errors::usage(format!("search is \"{word}\": give \"exhaustive\", \"exact\" or None"))),
    }
}

fn read(told: &Mutex<Told>) -> Told {
    *told.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The argument of a progress function.
fn progress_dict<'py>(py: Python<'py>, told: &Told, elapsed: Duration) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("elapsed_s", elapsed.as_secs_f64())?;
    dict.set_item("designs", told.known.map_or(told.designs, |known| known.designs))?;
    dict.set_item("designs_total", told.designs_total)?;
    dict.set_item("gap", told.known.and_then(|known| known.gap))?;
    dict.set_item("front_size", told.known.map(|known| known.front_size))?;
    dict.set_item("boxes_open", told.known.map(|known| known.boxes_open))?;
    Ok(dict)
}

/// Copies what a search knows until it is finished.
fn watch(told: &Mutex<Told>, finished: &AtomicBool, now: impl Fn() -> Told) {
    let copy = || *told.lock().unwrap_or_else(PoisonError::into_inner) = now();
    while !finished.load(Ordering::Relaxed) {
        std::thread::sleep(Duration::from_millis(20));
        copy();
    }
    copy();
}

fn find(asked: &Asked, stop: &AtomicBool, told: &Mutex<Told>) -> Result<Found, NoFront> {
    match asked.method {
        SearchMethod::Exhaustive => visit_all(asked, stop, told),
        SearchMethod::Exact => search_exactly(asked, stop, told),
    }
}

fn infeasible(asked: &Asked, stop: &AtomicBool, deadline: Option<Instant>) -> NoFront {
    NoFront::Refused(Refusal::Infeasible(why_infeasible(asked.study, asked.catalogs, stop, deadline)))
}

/// Visits every design.
fn visit_all(asked: &Asked, stop: &AtomicBool, told: &Mutex<Told>) -> Result<Found, NoFront> {
    let &Asked { study, catalogs, .. } = asked;
    let started = Instant::now();
    let outcome = run_study(study, catalogs, stop, |total, visited, finished| {
        let designs_total = Some(total as f64);
        watch(told, finished, || Told { designs: visited(), designs_total, known: None });
    });
    if outcome.sweep.status == Status::Infeasible {
        return Err(infeasible(asked, stop, None));
    }
    let facts = facts(asked, &outcome, started, "exhaustive");
    Ok(tables(asked, study, &outcome, facts))
}

/// Finds the front without visiting every design.
fn search_exactly(asked: &Asked, stop: &AtomicBool, told: &Mutex<Told>) -> Result<Found, NoFront> {
    let &Asked { study, catalogs, gap, time_limit, .. } = asked;
    let started = Instant::now();
    let deadline = time_limit.map(|limit| started + limit);
    let designs_total = study.space.designs(catalogs).map(|designs| designs as f64);
    let extent = Extent { deadline, gap, near: None };
    let found = run_exact(study, catalogs, stop, extent, |known, finished| {
        watch(told, finished, || Told { designs: 0, designs_total, known: Some(known()) });
    });
    let outcome = &found.outcome;
    match outcome.sweep.status {
        Status::Infeasible => return Err(infeasible(asked, stop, deadline)),
        Status::Partial if outcome.front.is_empty() => return Err(NoFront::OutOfTime),
        _ => {}
    }
    let mut facts = facts(asked, outcome, started, "exact");
    facts["boxes"] = json!(found.boxes[0]);
    facts["boxes_open"] = json!(found.boxes[1]);
    facts["gap"] = json!(found.gap);
    facts["ties_listed"] = json!(found.ties_listed);
    Ok(tables(asked, &found.study, outcome, facts))
}

/// The facts of a search, by the keys that `run.json` has for them; `search_reason` is said on the terminal.
fn facts(asked: &Asked, outcome: &StudyOutcome, started: Instant, search: &str) -> Value {
    let (study, sweep) = (asked.study, &outcome.sweep);
    json!({
        "study": study.name,
        "question": study.question,
        "status": sweep.status.word(),
        "search": search,
        "search_reason": asked.why,
        "designs_total": count(sweep.designs_total),
        "designs_evaluated": sweep.designs_evaluated,
        "designs_excluded": count(sweep.designs_excluded),
        "front_size": outcome.front.len(),
        "hypervolume": front_hypervolume(outcome.front.iter().map(|judged| judged.design.objectives)),
        "elapsed_s": started.elapsed().as_secs_f64(),
        "threads": rayon::current_num_threads(),
        "boxes": null,
        "boxes_open": null,
        "gap": null,
        "ties_listed": true,
        "models": {"links": study.space.links.word(), "joints": study.space.joints.word()},
        "constraints": constraint_words(&study.space.constraints),
        "cases": judged_cases(study),
        "effects": effects_json(study),
        "effects_mass_kg": study.space.effects_mass_kg(),
        "not_checked": study.not_checked,
        "tool_version": env!("CARGO_PKG_VERSION"),
    })
}

/// A count as a JSON number; above 2^64 it is rounded.
fn count(n: u128) -> Value {
    u64::try_from(n).map_or_else(|_| json!(n as f64), |n| json!(n))
}

/// The tables of a search, with what is to be said of them added to the facts. `searched` has the designs of the outcome.
fn tables(asked: &Asked, searched: &Study, outcome: &StudyOutcome, mut facts: Value) -> Found {
    let &Asked { study, catalogs, text, .. } = asked;
    let problem = ArmProblem::new(&searched.space, catalogs);
    let (front, remarks) = table_and_remarks(study, &problem, catalogs, &outcome.front);
    facts["remarks"] = json!(remarks);
    facts["caveats"] = json!(caveats_on(study, catalogs, &front));
    facts["picks"] = picks(&designs(&front)).iter().map(pick_json).collect();
    let table = |FrontTable { columns, rows }| (columns, rows);
    let of_material = |front| table(front_table(&problem, catalogs, front));
    let by_material = outcome.by_material.iter().map(|of| (of.name.clone(), of_material(&of.front)));
    (table(front), by_material.collect(), facts.to_string(), text.to_string())
}

/// A pick by the keys that it has in `run.json`, without what its budget adds there.
fn pick_json(pick: &Pick) -> Value {
    json!({"names": pick.names, "design_id": pick.design.design_id, "mass_kg": pick.design.mass_kg})
}
