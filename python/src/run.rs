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
use armwright::search::near::{NearDesigns, Slack};
use armwright::space::ArmProblem;
use armwright::study::{
    Asked as AskedStudy, Extent, NO_NEAR, NearFront, Refusal, Sampling, SearchMethod, SearchWish,
    StudyOutcome, Tolerance, caveats_on, corrections_json, effects_json, front_table, judged_cases,
    near_front, run_exact, run_study, scatter_front, table_and_remarks, why_infeasible,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::{Value, json};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// A table: its columns and rows.
type Table = (Vec<String>, Vec<Vec<String>>);

/// What a search found, as Python gets it: the front, the front of each material, the near designs and the scatter as CSV
/// text if they were asked for, facts in JSON, and the study's text.
type Found = (Table, Vec<(String, Table)>, [Option<String>; 2], String, String);

/// Scatter of ratings in words, number of samples, seed.
type Scatter = (String, u32, u64);

/// What a search tells while it runs.
#[derive(Debug, Clone, Copy, Default)]
struct Told {
    designs: u64,
    designs_total: Option<f64>,
    known: Option<Known>,
}

/// How a study is searched.
struct Asked<'a> {
    asked: &'a AskedStudy,
    catalogs: &'a catalog::Catalogs,
    /// Why this method was chosen, if an estimate chose it.
    why: Option<String>,
    method: SearchMethod,
    /// Gap at which an exact search may end, as a fraction.
    gap: f64,
    time_limit: Option<Duration>,
    /// How much worse near designs may be, and how many are listed; `None` if none are asked for.
    slack: Option<Slack>,
    /// How the ratings of parts scatter; `None` if this is not asked for.
    sampling: Option<Sampling>,
}

/// Why a search has no front.
enum NoFront {
    Refused(Refusal),
    OutOfTime,
}

#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "they are those of the Python function")]
#[pyo3(signature = (catalogs, study, effects, method, gap_percent, time_limit_s, within, scatter, threads, progress))]
pub(crate) fn run(
    py: Python<'_>,
    catalogs: &Catalogs,
    study: Source,
    effects: Option<Source>,
    method: Option<&str>,
    gap_percent: Option<f64>,
    time_limit_s: Option<f64>,
    within: Option<(f64, usize)>,
    scatter: Option<Scatter>,
    threads: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<Found> {
    let parts = catalogs.parts.clone();
    let pool = workers(threads)?;
    // a study of many parts takes a while to read
    let asked = py.detach(|| pool.install(|| asked_study(&study, effects, &parts)))?;
    let slack = within.map(|(percent, most)| Slack { part: 0.01 * percent, most });
    let sampling = scatter.map(sampling).transpose()?;
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
            let (method, why) = wish.method(&asked.study, &parts).map_err(NoFront::Refused)?;
            let gap = gap_percent.map_or(asked.study.gap, |percent| percent * 0.01);
            let (asked, catalogs) = (&asked, &*parts);
            let asked = Asked { asked, catalogs, why, method, gap, time_limit, slack, sampling };
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

/// The study of a name, file or text, with the effects of a measured arm if one is given.
fn asked_study(
    study: &Source,
    effects: Option<Source>,
    catalogs: &catalog::Catalogs,
) -> PyResult<AskedStudy> {
    let (study, text) = study.study(catalogs)?;
    match effects {
        None => Ok(AskedStudy::as_stated(study, text)),
        Some(arm) => {
            AskedStudy::corrected_by(arm.arm_document()?, &study, &text, catalogs).map_err(errors::refused)
        }
    }
}

fn sampling((scatter, samples, seed): Scatter) -> PyResult<Sampling> {
    let tolerance = scatter.parse::<Tolerance>().map_err(errors::usage)?;
    Ok(Sampling { tolerance, samples, seed })
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
    NoFront::Refused(Refusal::Infeasible(why_infeasible(&asked.asked.study, asked.catalogs, stop, deadline)))
}

/// Visits every design.
fn visit_all(asked: &Asked, stop: &AtomicBool, told: &Mutex<Told>) -> Result<Found, NoFront> {
    let &Asked { asked: AskedStudy { study, .. }, catalogs, .. } = asked;
    let started = Instant::now();
    let outcome = run_study(study, catalogs, stop, |total, visited, finished| {
        let designs_total = Some(total as f64);
        watch(told, finished, || Told { designs: visited(), designs_total, known: None });
    });
    if outcome.sweep.status == Status::Infeasible {
        return Err(infeasible(asked, stop, None));
    }
    let facts = facts(asked, &outcome, started, "exhaustive");
    let problem = ArmProblem::new(&study.space, catalogs);
    let near = asked.slack.and_then(|slack| near_front(&problem, catalogs, &outcome, slack, stop));
    Ok(tables(asked, (&problem, &outcome), near, stop, facts))
}

/// Finds the front without visiting every design.
fn search_exactly(asked: &Asked, stop: &AtomicBool, told: &Mutex<Told>) -> Result<Found, NoFront> {
    let &Asked { asked: AskedStudy { study, .. }, catalogs, gap, time_limit, slack, .. } = asked;
    let started = Instant::now();
    let deadline = time_limit.map(|limit| started + limit);
    let designs_total = study.space.designs(catalogs).map(|designs| designs as f64);
    let extent = Extent { deadline, gap, near: slack };
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
    let problem = ArmProblem::new(&found.study.space, catalogs);
    let of =
        |(near, slack): (&NearDesigns, Slack)| NearFront::of(&problem, catalogs, &outcome.front, near, slack);
    let near = found.near.as_ref().zip(slack).map(of);
    Ok(tables(asked, (&problem, outcome), near, stop, facts))
}

/// The facts of a search, by the keys that `run.json` has for them; `search_reason` is said on the terminal.
fn facts(asked: &Asked, outcome: &StudyOutcome, started: Instant, search: &str) -> Value {
    let (study, sweep) = (&asked.asked.study, &outcome.sweep);
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
        "within": null,
        "tolerance": null,
        "models": {"links": study.space.links.word(), "joints": study.space.joints.word()},
        "constraints": constraint_words(&study.space.constraints),
        "cases": judged_cases(study),
        "effects": effects_json(study),
        "effects_mass_kg": study.space.effects_mass_kg(),
        "carried_over": corrections_json(&asked.asked.corrections),
        "not_checked": study.not_checked,
        "tool_version": env!("CARGO_PKG_VERSION"),
    })
}

/// A count as a JSON number; above 2^64 it is rounded.
fn count(n: u128) -> Value {
    u64::try_from(n).map_or_else(|_| json!(n as f64), |n| json!(n))
}

/// The tables of a search, with what is to be said of them added to the facts. `problem` has the designs of the outcome.
fn tables(
    asked: &Asked,
    (problem, outcome): (&ArmProblem, &StudyOutcome),
    near: Option<NearFront>,
    stop: &AtomicBool,
    mut facts: Value,
) -> Found {
    let &Asked { asked: AskedStudy { study, text, .. }, catalogs, .. } = asked;
    let (front, mut remarks) = table_and_remarks(study, problem, catalogs, &outcome.front);
    if asked.slack.is_some() && near.is_none() {
        remarks.push(NO_NEAR.into());
    }
    facts["remarks"] = json!(remarks);
    facts["caveats"] = json!(caveats_on(study, catalogs, &front));
    facts["picks"] = picks(&designs(&front)).iter().map(pick_json).collect();
    let scatter =
        |sampling| scatter_front(problem, catalogs, &outcome.front, &designs(&front), &sampling, stop);
    let scattered = asked.sampling.and_then(scatter).map(|of| of.supplement());
    let near = near.map(|near| near.supplement());
    let further = [
        near.and_then(|of| added(of.run, of.file, &mut facts)),
        scattered.and_then(|of| added(of.run, of.file, &mut facts)),
    ];
    let table = |FrontTable { columns, rows }| (columns, rows);
    let of_material = |front| table(front_table(problem, catalogs, front));
    let by_material = outcome.by_material.iter().map(|of| (of.name.clone(), of_material(&of.front)));
    (table(front), by_material.collect(), further, facts.to_string(), text.to_string())
}

/// Adds the entry `run` that a list of designs has in `run.json` to `facts`, and returns its `file` as text.
fn added(
    run: Option<(&'static str, Value)>,
    file: Option<(&'static str, Vec<u8>)>,
    facts: &mut Value,
) -> Option<String> {
    if let Some((key, value)) = run {
        facts[key] = value;
    }
    file.map(|(_, csv)| String::from_utf8_lossy(&csv).into_owned())
}

/// A pick by the keys that it has in `run.json`, without what its budget adds there.
fn pick_json(pick: &Pick) -> Value {
    json!({"names": pick.names, "design_id": pick.design.design_id, "mass_kg": pick.design.mass_kg})
}
