//! `armwright run`: find a study's front and write it.

use super::{Failure, write_all};
use crate::catalog::Catalogs;
use crate::fault::Document;
use crate::report::front_svg::{FrontPicture, PlottedFront, mixed_designs};
use crate::report::picks;
use crate::report::summary::{
    MaterialFront, SummaryFacts, SummaryInput, constraint_words, summary_md, terminal_summary,
};
use crate::search::hypervolume::front_hypervolume;
use crate::search::{ArmProblem, Status};
use crate::study::{
    Study, StudyOutcome, empty_pieces, front_table, named, read_study, run_study, slug, why_infeasible,
};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Runs a study: visits every design in parallel, keeps the Pareto front on tip deflection, mass and
/// lowest mode, and one front per material.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: armwright run compare-materials\n         armwright run my-study.json --out results/mine"
)]
pub struct RunArgs {
    /// A built-in study (see `armwright studies`) or a study file
    study: String,
    /// Folder for the results; default results/<study>
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// The text of a study and the name it goes by in messages.
pub(super) fn study_text(name: &str) -> Result<(String, String), Failure> {
    if let Some(text) = named(name) {
        return Ok((format!("{name} (built in)"), text.to_string()));
    }
    let path = Path::new(name);
    match fs_err::read_to_string(path) {
        Ok(text) => Ok((name.to_string(), text)),
        Err(_) if !name.contains(['/', '.']) => {
            let known = crate::study::names();
            let near =
                crate::fault::closest(name, &known).map_or(String::new(), |n| format!("; did you mean {n}?"));
            Err(Failure::Usage(format!("no study is called \"{name}\"{near}; known: {}", known.join(", "))))
        }
        Err(error) => Err(Failure::File(error.to_string())),
    }
}

/// Reads a study by name or file.
pub(super) fn load_study(name: &str, catalogs: &Catalogs) -> Result<(Study, String), Failure> {
    let (file, text) = study_text(name)?;
    Ok((read_study(Document::parse(&file, &text)?, catalogs)?, text))
}

/// Carries out the verb.
pub(super) fn run(args: &RunArgs, catalogs: &Catalogs, overlay: Option<&Path>) -> Result<String, Failure> {
    if crate::study::paper::NAMES.contains(&args.study.as_str()) {
        return run_paper(args, catalogs);
    }
    let (study, text) = load_study(&args.study, catalogs)?;
    let dir = args.out.clone().unwrap_or_else(|| Path::new("results").join(slug(&study.name)));
    let problem = ArmProblem::new(&study.space, catalogs);
    refuse_empty(&study, &problem)?;
    // a folder that cannot be written fails now, not after the search
    write_all(&dir, &[])?;
    let stop = Arc::new(AtomicBool::new(false));
    let on_signal = Arc::clone(&stop);
    // a second handler cannot be set; the first one serves
    let _ = ctrlc::set_handler(move || on_signal.store(true, Ordering::Relaxed));
    let started = Instant::now();
    let outcome = run_study(&study, catalogs, &stop, watch);
    let elapsed_s = started.elapsed().as_secs_f64();
    match outcome.sweep.status {
        Status::Interrupted => {
            let _ = std::fs::remove_dir(&dir);
            let done = u128::from(outcome.sweep.designs_evaluated) + outcome.sweep.designs_excluded;
            Err(Failure::Interrupted(format!(
                "stopped after {done} of {} designs; nothing was written, run again to start over",
                outcome.sweep.designs_total
            )))
        }
        Status::Infeasible => {
            // succeeds only on an empty folder: earlier results stay
            let _ = std::fs::remove_dir(&dir);
            Err(Failure::Infeasible(why_infeasible(&study, catalogs, &outcome)))
        }
        Status::Complete => {
            let finished = Finished {
                study: &study,
                text: &text,
                problem: &problem,
                outcome: &outcome,
                elapsed_s,
                overlay,
                catalogs,
                dir: &dir,
            };
            let written = finished.files();
            write_all(&dir, &written.files)?;
            Ok(format!("{}\nwritten to {}: {}\n", written.terminal, dir.display(), names(&written.files)))
        }
    }
}

/// Runs one of the paper's studies, which have a course of their own.
fn run_paper(args: &RunArgs, catalogs: &Catalogs) -> Result<String, Failure> {
    let dir = args.out.clone().unwrap_or_else(|| Path::new("results").join(&args.study));
    write_all(&dir, &[])?;
    let started = Instant::now();
    let output =
        crate::study::paper::run(&args.study, catalogs).map_err(|e| Failure::Usage(e.to_string()))?;
    let run = json!({
        "schema_version": 1,
        "study": args.study,
        "status": Status::Complete.word(),
        "elapsed_s": started.elapsed().as_secs_f64(),
        "tool_version": env!("CARGO_PKG_VERSION"),
        "catalogs_hash": catalogs_hash(catalogs),
    });
    let mut files = output.files;
    files.push(("run.json".into(), pretty(&run)));
    write_all(&dir, &files)?;
    Ok(format!("{}\nwritten to {}: {}\n", output.terminal, dir.display(), names(&files)))
}

fn names(files: &[(String, Vec<u8>)]) -> String {
    let fronts =
        files.iter().filter(|(n, _)| n.starts_with("front.") && n != "front.csv" && n != "front.svg").count();
    let mut names: Vec<&str> = files
        .iter()
        .map(|(n, _)| n.as_str())
        .filter(|n| !n.starts_with("front.") || *n == "front.csv" || *n == "front.svg")
        .collect();
    let by_material = match fronts {
        1 => "one front by material".to_string(),
        n => format!("{n} fronts by material"),
    };
    if fronts > 0 {
        names.push(&by_material);
    }
    names.join(", ")
}

fn refuse_empty(study: &Study, problem: &ArmProblem) -> Result<(), Failure> {
    match empty_pieces(problem).as_slice() {
        [] => Ok(()),
        pieces => Err(Failure::EmptySpace(format!(
            "the study \"{}\" has nothing to choose from\n  {}",
            study.name,
            pieces.join("\n  ")
        ))),
    }
}

struct Written {
    files: Vec<(String, Vec<u8>)>,
    terminal: String,
}

/// A finished search and what it was made with.
struct Finished<'a> {
    study: &'a Study,
    text: &'a str,
    problem: &'a ArmProblem<'a>,
    outcome: &'a StudyOutcome,
    elapsed_s: f64,
    overlay: Option<&'a Path>,
    catalogs: &'a Catalogs,
    dir: &'a Path,
}

impl Finished<'_> {
    fn files(&self) -> Written {
        let summary = self.summary();
        let mut files = vec![("front.csv".to_string(), summary.overall.to_csv())];
        for material in &summary.materials {
            files.push((format!("front.{}.csv", slug(&material.name)), material.front.to_csv()));
        }
        files.push(("front.svg".into(), picture(&summary).into_bytes()));
        files.push(("summary.md".into(), summary_md(&summary).into_bytes()));
        files.push(("run.json".into(), pretty(&self.run_json(&summary))));
        files.push(("study.json".into(), self.text.as_bytes().to_vec()));
        Written { files, terminal: terminal_summary(&summary) }
    }

    fn summary(&self) -> SummaryInput {
        let (study, sweep) = (self.study, &self.outcome.sweep);
        let cost = |name: &str| self.catalogs.materials.iter().find(|m| m.name == name)?.cost_eur_per_kg;
        let materials = study.space.material_names();
        SummaryInput {
            facts: SummaryFacts {
                study: study.name.clone(),
                question: study.question.clone(),
                status: sweep.status.word().into(),
                designs_total: sweep.designs_total,
                designs_evaluated: sweep.designs_evaluated.into(),
                designs_excluded: sweep.designs_excluded,
                elapsed_s: self.elapsed_s,
                threads: rayon::current_num_threads(),
                tool_version: env!("CARGO_PKG_VERSION").into(),
                constraints: constraint_words(&study.space.constraints),
                cases: self.judged_cases(),
                not_checked: study.not_checked.clone(),
                results: self.dir.display().to_string(),
            },
            overall: front_table(self.problem, self.catalogs, &self.outcome.front),
            materials: materials
                .into_iter()
                .zip(&self.outcome.by_material)
                .map(|(name, front)| MaterialFront {
                    cost_eur_per_kg: cost(&name),
                    name,
                    front: front_table(self.problem, self.catalogs, front),
                })
                .collect(),
        }
    }

    fn judged_cases(&self) -> Vec<String> {
        let space = &self.study.space;
        space.judged_cases.iter().map(|&i| space.cases[i].name.clone()).collect()
    }

    fn run_json(&self, summary: &SummaryInput) -> Value {
        let (study, sweep) = (self.study, &self.outcome.sweep);
        let materials: Vec<Value> = summary
            .materials
            .iter()
            .map(|m| {
                json!({
                    "name": m.name, "slug": slug(&m.name), "front_size": m.front.rows.len(),
                    "cost_eur_per_kg": m.cost_eur_per_kg,
                })
            })
            .collect();
        json!({
            "schema_version": 1,
            "study": study.name,
            "question": study.question,
            "status": sweep.status.word(),
            "designs_total": count(sweep.designs_total),
            "designs_evaluated": sweep.designs_evaluated,
            "designs_excluded": count(sweep.designs_excluded),
            "front_size": self.outcome.front.len(),
            "hypervolume": front_hypervolume(self.outcome.front.iter().map(|d| d.design.objectives)),
            "elapsed_s": self.elapsed_s,
            "designs_per_s": sweep.designs_evaluated as f64 / self.elapsed_s,
            "threads": rayon::current_num_threads(),
            "tool_version": env!("CARGO_PKG_VERSION"),
            "platform": format!("{}-{}", std::env::consts::OS, std::env::consts::ARCH),
            "models": {"links": study.space.links.word(), "joints": study.space.joints.word()},
            "constraints": summary.facts.constraints,
            "cases": summary.facts.cases,
            "materials": materials,
            "not_checked": study.not_checked,
            "catalogs": self.overlay.map(|p| p.display().to_string()),
            "study_hash": blake3::hash(self.text.as_bytes()).to_hex().to_string(),
            "catalogs_hash": catalogs_hash(self.catalogs),
        })
    }
}

/// The picture of the front: designs of mixed materials in grey, each material's own front in colour.
fn picture(summary: &SummaryInput) -> String {
    let mixed = mixed_designs(&summary.overall);
    let mut fronts = vec![PlottedFront { name: "mixed".into(), front: &mixed, muted: true }];
    fronts.extend(summary.materials.iter().map(|m| PlottedFront {
        name: m.name.clone(),
        front: &m.front,
        muted: false,
    }));
    let picks = picks::picks(&picks::designs(&summary.overall));
    FrontPicture { title: summary.facts.study.clone(), fronts, picks }.to_svg()
}

fn pretty(value: &Value) -> Vec<u8> {
    serde_json::to_vec_pretty(value).expect("a value of numbers and strings serializes")
}

/// A count as a JSON number; above 2^53 it is rounded.
fn count(n: u128) -> Value {
    u64::try_from(n).map_or_else(|_| json!(n as f64), |n| json!(n))
}

/// A hash of every figure of every part: results taken from other catalogs are told apart.
pub(super) fn catalogs_hash(catalogs: &Catalogs) -> String {
    blake3::hash(format!("{catalogs:?}").as_bytes()).to_hex().to_string()
}

/// Shows progress: a bar on a terminal, a plain line every ten seconds otherwise.
fn watch(total: u128, visited: &(dyn Fn() -> u64 + Sync), finished: &AtomicBool) {
    if std::io::stderr().is_terminal() {
        bar(total, visited, finished);
    } else {
        lines(total, visited, finished);
    }
}

fn bar(total: u128, visited: &(dyn Fn() -> u64 + Sync), finished: &AtomicBool) {
    let bar = ProgressBar::new(u64::try_from(total).unwrap_or(u64::MAX));
    let style =
        ProgressStyle::with_template("{bar:30} {human_pos}/{human_len} designs, {per_sec}, {eta} left");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    while !finished.load(Ordering::Relaxed) {
        bar.set_position(visited());
        std::thread::sleep(Duration::from_millis(100));
    }
    bar.finish_and_clear();
}

const LINE_EVERY: Duration = Duration::from_secs(10);

fn lines(total: u128, visited: &(dyn Fn() -> u64 + Sync), finished: &AtomicBool) {
    let started = Instant::now();
    let mut next = LINE_EVERY;
    while !finished.load(Ordering::Relaxed) {
        std::thread::sleep(Duration::from_millis(50));
        if started.elapsed() < next {
            continue;
        }
        next += LINE_EVERY;
        let (done, elapsed_s) = (visited() as f64, started.elapsed().as_secs_f64());
        let rate = done / elapsed_s;
        eprintln!(
            "{elapsed_s:.0} s: {done:.3e} of {:.3e} designs ({:.0} %), {rate:.0} designs/s, about {:.0} s left",
            total as f64,
            100.0 * done / total as f64,
            (total as f64 - done) / rate.max(1.0)
        );
    }
}
