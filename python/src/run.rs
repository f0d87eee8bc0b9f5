//! `armwright.run` of the package: the search for the front of a study.

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

/// A table: the names of its columns, and its rows of cells.
type Table = (Vec<String>, Vec<Vec<String>>);

/// What a search found, as Python gets it, in this order: the table of the front; name and table of the front of each
/// material; near designs and scatter as CSV text, each `None` if it was not asked for; facts on the search as JSON
/// text; the text of the study file.
type Found = (Table, Vec<(String, Table)>, [Option<String>; 2], String, String);

/// How the ratings of parts scatter: the scatter as text in the form that `--tolerance` takes, the number of samples,
/// and the seed of the random numbers.
type Scatter = (String, u32, u64);

/// Progress of a search that runs.
#[derive(Debug, Clone, Copy, Default)]
struct Told {
    /// Number of designs that the exhaustive search has visited; 0 in an exact search.
    designs: u64,
    /// Number of designs of the study; `None` if it is not known.
    designs_total: Option<f64>,
    /// What an exact search knows so far; `None` in an exhaustive search.
    known: Option<Known>,
}

/// A study, and how it is to be searched.
struct Asked<'a> {
    asked: &'a AskedStudy,
    catalogs: &'a catalog::Catalogs,
    /// Reason for the method, if the program chose it by an estimate; `None` if the caller chose it.
    why: Option<String>,
    method: SearchMethod,
    /// Gap at which an exact search may end, as a fraction: 0.02 is 2 %.
    gap: f64,
    time_limit: Option<Duration>,
    /// By which fraction near designs may be worse, and how many are listed; `None` if none are asked for.
    slack: Option<Slack>,
    /// How the ratings of parts scatter, for the scatter of the front; `None` if this is not asked for.
    sampling: Option<Sampling>,
}

/// Reason why a search has no front.
enum NoFront {
    /// The study cannot be searched, or no design meets its limits.
    Refused(Refusal),
    /// The time limit ended the search before a design was found.
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
    // reading takes long for a study of many parts, so the interpreter is free meanwhile
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

/// Reads the study. If `effects` names the arm file of a measured arm, its effects are applied to the study.
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

/// Reads the three values of a scatter. An error is a `UsageError`.
fn sampling((scatter, samples, seed): Scatter) -> PyResult<Sampling> {
    let tolerance = scatter.parse::<Tolerance>().map_err(errors::usage)?;
    Ok(Sampling { tolerance, samples, seed })
}

/// The search method with the name `word`. Another word is a `UsageError`.
fn search_method(word: &str) -> PyResult<SearchMethod> {
    match word {
        "exhaustive" => Ok(SearchMethod::Exhaustive),
        "exact" => Ok(SearchMethod::Exact),
        _ => Err(errors::usage(format!("search is \"{word}\": give \"exhaustive\", \"exact\" or None"))),
    }
}

/// A copy of the progress of the search.
fn read(told: &Mutex<Told>) -> Told {
    *told.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The dictionary that the progress function of the caller gets as its argument.
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

/// Copies the progress `now` of a search to `told` every 20 ms, until `finished` is set, and once more after that.
fn watch(told: &Mutex<Told>, finished: &AtomicBool, now: impl Fn() -> Told) {
    let copy = || *told.lock().unwrap_or_else(PoisonError::into_inner) = now();
    while !finished.load(Ordering::Relaxed) {
        std::thread::sleep(Duration::from_millis(20));
        copy();
    }
    copy();
}

/// Searches the front by the method that `asked` names. The search stops early if `stop` is set.
fn find(asked: &Asked, stop: &AtomicBool, told: &Mutex<Told>) -> Result<Found, NoFront> {
    match asked.method {
        SearchMethod::Exhaustive => visit_all(asked, stop, told),
        SearchMethod::Exact => search_exactly(asked, stop, told),
    }
}

/// The refusal for a study without a feasible design, with the reason. The reason is sought until `stop` is set or the
/// time is `deadline`.
fn infeasible(asked: &Asked, stop: &AtomicBool, deadline: Option<Instant>) -> NoFront {
    NoFront::Refused(Refusal::Infeasible(why_infeasible(&asked.asked.study, asked.catalogs, stop, deadline)))
}

/// Searches the front by visiting every design.
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

/// Searches the front by branch and bound, without visiting every design.
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

/// Facts on a search, with the keys that `run.json` has for them. The key `search_reason` is added; the command line
/// prints this reason instead.
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

/// A count as a JSON number. Counts of 2^64 and more become floating-point numbers, which are rounded.
fn count(n: u128) -> Value {
    u64::try_from(n).map_or_else(|_| json!(n as f64), |n| json!(n))
}

/// The result of a search for Python. `problem` and `outcome` are the design space and what was found in it. Remarks,
/// caveats, picks, and entries on near designs and scatter are added to `facts`.
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

/// Adds `run`, a key and a value for `run.json`, to `facts`. Returns the content of `file` as text; `None` if there is
/// no file.
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

/// A pick as JSON with its names, design and mass, as in `run.json`. The stiffness budget, which `run.json` adds, is
/// left out.
fn pick_json(pick: &Pick) -> Value {
    json!({"names": pick.names, "design_id": pick.design.design_id, "mass_kg": pick.design.mass_kg})
}
