//! `armwright run`: find a study's front and write it.

use super::beside::{Beside, BesideArgs, Found};
use super::progress::{watch, watch_boxes};
use super::{Failure, carry, write_all};
use crate::arm::Effect;
use crate::catalog::Catalogs;
use crate::fault::Document;
use crate::report::budget::{PickBudget, budget_csv};
use crate::report::certificate::{certificate_section, certificate_words};
use crate::report::compare::text::wrap;
use crate::report::front_svg::{FrontPicture, PlottedFront, designs_of, mixed_designs};
use crate::report::front_table::FrontTable;
use crate::report::html::{Extra, Figure, PLOTS, Page, document::DocumentPage, study::StudyPage};
use crate::report::number::significant;
use crate::report::picks;
use crate::report::summary::{
    MaterialFront, SummaryFacts, SummaryInput, constraint_words, single_materials, summary_md,
    terminal_summary,
};
use crate::report::table::Table;
use crate::search::hypervolume::front_hypervolume;
use crate::search::near::NearDesigns;
use crate::search::{ArmProblem, DesignSpace, Status};
use crate::study::{
    Carried, ExactStudy, Study, StudyOutcome, budgets, empty_pieces, front_table, left_out, named,
    paper_question, read_study, run_exact, run_study, slug, study_page, why_infeasible,
};
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Runs a study: visits every design in parallel, keeps the Pareto front on tip deflection, mass and
/// lowest mode, and one front per material.
#[derive(Debug, Args)]
#[command(
    after_help = "Example: armwright run compare-materials\n         armwright run my-study.json --out results/mine\n         \
                  armwright run my-study.json --effects results/may/arm.corrected.json\n         \
                  armwright run my-study.json --within 2% --tolerance gear_stiffness=20%"
)]
pub struct RunArgs {
    /// A built-in study (see `armwright studies`) or a study file
    study: String,
    /// Folder for the results; default results/<study>, or results/<study>-with-effects
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Arm file, such as the arm.corrected.json of `reconcile`, whose effects the study's arm has too, at the
    /// joints and links of the same name; every effect that does not carry over is listed
    #[arg(long, value_name = "ARM")]
    effects: Option<PathBuf>,
    /// How the front is looked for; default exhaustive up to 1e9 designs, exact beyond
    #[arg(long, value_enum)]
    search: Option<SearchKind>,
    /// Stop the exact search after so long and write what it found, with how much it may lack
    #[arg(long, value_name = "SECONDS")]
    time_limit: Option<f64>,
    #[command(flatten)]
    beside: BesideArgs,
}

/// How a front is looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum SearchKind {
    /// Every design is visited
    Exhaustive,
    /// Boxes of designs that cannot be on the front are cut unvisited: for spaces of any size
    Exact,
}

/// Above this many designs the exact search is the default.
const MOST_VISITED: u128 = 1_000_000_000;

/// Above this many designs nobody lives to see the end of an exhaustive search.
const MOST_CONCEIVABLE: u128 = 1_000_000_000_000_000;

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
    let (asked, suffix) = match &args.effects {
        None => (Asked { carried: left_out(&study), study, text }, ""),
        Some(path) => (carry::from_arm_file(path, &study, &text, catalogs)?, "-with-effects"),
    };
    let name = format!("{}{suffix}", slug(&asked.study.name));
    let dir = args.out.clone().unwrap_or_else(|| Path::new("results").join(name));
    let written = match search_kind(args, &asked.study, catalogs)? {
        SearchKind::Exhaustive => search_with(&asked, catalogs, overlay, &dir, &args.beside)?,
        SearchKind::Exact => search_exactly(&asked, catalogs, overlay, &dir, args)?,
    };
    write_all(&dir, &written.files)?;
    let carried = carry::to_text(&asked.carried);
    Ok(format!("{}{carried}\n{}", written.terminal, told(&dir, &written.files)))
}

/// A study to be searched.
pub(super) struct Asked {
    /// The study.
    pub study: Study,
    /// Its file's text.
    pub text: String,
    /// What of a measured arm carries over to it, and what does not.
    pub carried: Vec<Carried>,
}

/// Searches a study; the folder is where its results go, and nothing is written yet.
pub(super) fn search(
    asked: &Asked,
    catalogs: &Catalogs,
    overlay: Option<&Path>,
    dir: &Path,
) -> Result<Written, Failure> {
    search_with(asked, catalogs, overlay, dir, &BesideArgs::default())
}

/// Searches a study and works out what is asked for beside its front.
fn search_with(
    Asked { study, text, carried }: &Asked,
    catalogs: &Catalogs,
    overlay: Option<&Path>,
    dir: &Path,
    beside: &BesideArgs,
) -> Result<Written, Failure> {
    let problem = ArmProblem::new(&study.space, catalogs);
    refuse_empty(study, &problem)?;
    // a folder that cannot be written fails now, not after the search
    write_all(dir, &[])?;
    let stop = stopped_by_signal();
    let started = Instant::now();
    let outcome = run_study(study, catalogs, &stop, watch);
    let elapsed_s = started.elapsed().as_secs_f64();
    match outcome.sweep.status {
        Status::Interrupted => {
            let _ = std::fs::remove_dir(dir);
            let done = u128::from(outcome.sweep.designs_evaluated) + outcome.sweep.designs_excluded;
            Err(Failure::Interrupted(format!(
                "stopped after {done} of {} designs; nothing was written, run again to start over",
                outcome.sweep.designs_total
            )))
        }
        Status::Infeasible => {
            // succeeds only on an empty folder: earlier results stay
            let _ = std::fs::remove_dir(dir);
            Err(Failure::Infeasible(why_infeasible(study, catalogs, &outcome)))
        }
        _ => {
            let finished = Finished {
                study,
                text,
                carried,
                problem: &problem,
                whole: &study.space,
                outcome: &outcome,
                near: None,
                exact: None,
                elapsed_s,
                overlay,
                catalogs,
                dir,
            };
            finished.files(beside, &stop)
        }
    }
}

/// A flag that is set when the user wants to stop.
pub(super) fn stopped_by_signal() -> Arc<AtomicBool> {
    let stop = Arc::new(AtomicBool::new(false));
    let on_signal = Arc::clone(&stop);
    // a second handler cannot be set; the first one serves
    let _ = ctrlc::set_handler(move || on_signal.store(true, Ordering::Relaxed));
    stop
}

/// The search that was asked for, or the one that suits the number of designs.
fn search_kind(args: &RunArgs, study: &Study, catalogs: &Catalogs) -> Result<SearchKind, Failure> {
    let designs = study.space.designs(catalogs).ok_or_else(|| {
        Failure::Usage(format!("the study \"{}\" has more than 1e38 designs; thin a grid", study.name))
    })?;
    let suits = if designs > MOST_VISITED { SearchKind::Exact } else { SearchKind::Exhaustive };
    let kind = args.search.unwrap_or(suits);
    if kind == SearchKind::Exhaustive && designs > MOST_CONCEIVABLE {
        return Err(Failure::Usage(format!(
            "visiting the {:.1e} designs of the study \"{}\" would take years; use --search exact",
            designs as f64, study.name
        )));
    }
    if kind == SearchKind::Exhaustive && args.time_limit.is_some() {
        return Err(Failure::Usage("--time-limit goes with --search exact".into()));
    }
    if args.time_limit.is_some_and(|s| s.is_nan() || s <= 0.0) {
        return Err(Failure::Usage("--time-limit is a number of seconds above zero".into()));
    }
    Ok(kind)
}

/// Finds the front of a study without visiting every design.
fn search_exactly(
    Asked { study, text, carried }: &Asked,
    catalogs: &Catalogs,
    overlay: Option<&Path>,
    dir: &Path,
    args: &RunArgs,
) -> Result<Written, Failure> {
    write_all(dir, &[])?;
    let stop = stopped_by_signal();
    let started = Instant::now();
    let deadline = args.time_limit.map(|s| started + Duration::from_secs_f64(s));
    let ExactStudy { study: part, outcome, boxes, gap, near } =
        run_exact(study, catalogs, &stop, deadline, args.beside.slack(), watch_boxes);
    let nothing = |problem: String| {
        let _ = std::fs::remove_dir(dir);
        problem
    };
    let designs = outcome.sweep.designs_total as f64;
    match outcome.sweep.status {
        Status::Interrupted => Err(Failure::Interrupted(nothing(format!(
            "stopped after {} boxes; nothing was written, run again to start over, or give --time-limit",
            boxes[0]
        )))),
        Status::Infeasible => Err(Failure::Infeasible(nothing(format!(
            "none of the {designs:.3e} designs of the study \"{}\" meets its constraints (proved by {} boxes); \
             loosen one, or run a coarser grid with --search exhaustive to see which of them it is",
            study.name, boxes[0]
        )))),
        Status::Partial if outcome.front.is_empty() => Err(Failure::Interrupted(nothing(format!(
            "no design was found in the time limit ({} boxes); nothing was written, allow more time",
            boxes[0]
        )))),
        _ => {
            let problem = ArmProblem::new(&part.space, catalogs);
            let finished = Finished {
                study: &part,
                text,
                carried,
                problem: &problem,
                whole: &study.space,
                outcome: &outcome,
                near: near.as_ref(),
                exact: Some((boxes, gap)),
                elapsed_s: started.elapsed().as_secs_f64(),
                overlay,
                catalogs,
                dir,
            };
            let mut written = finished.files(&args.beside, &stop)?;
            written.terminal.push_str(&certificate_words(boxes, gap));
            Ok(written)
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
    let page = paper_page(&args.study, &files, &run).page();
    files.push(("run.json".into(), pretty(&run)));
    files.extend(page.into_files());
    write_all(&dir, &files)?;
    Ok(format!("{}\n{}", output.terminal, told(&dir, &files)))
}

/// Digits of the numbers in the tables of a page; files have all.
const PAGE_DIGITS: usize = 5;

/// The page of a study of the paper: its pictures and tables.
fn paper_page(study: &str, files: &[(String, Vec<u8>)], run: &Value) -> DocumentPage {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let ending = |end: &'static str| files.iter().filter_map(move |(n, b)| Some((n.strip_suffix(end)?, b)));
    DocumentPage {
        title: study.to_string(),
        question: paper_question(study).unwrap_or_default().to_string(),
        words: Vec::new(),
        figures: ending(".svg")
            .map(|(name, bytes)| Figure { name: name.into(), svg: text(bytes), ..Figure::default() })
            .collect(),
        tables: ending(".csv")
            .map(|(name, bytes)| {
                let caption = format!("{name}.csv, its numbers to {PAGE_DIGITS} digits");
                (caption, Table::from_csv(&text(bytes)).rounded(PAGE_DIGITS))
            })
            .collect(),
        facts: facts_of(run),
    }
}

/// Where the files are, in lines of at most 80 columns.
fn told(dir: &Path, files: &[(String, Vec<u8>)]) -> String {
    wrap(&format!("written to {}: {}", dir.display(), names(files)), 80, "")
}

/// The files that were written, those of one kind counted.
fn names(files: &[(String, Vec<u8>)]) -> String {
    let kind = |name: &str| match name {
        n if n.starts_with(PLOTS) => 2,
        n if n.starts_with("front.") && n != "front.csv" && n != "front.svg" => 1,
        _ => 0,
    };
    let count = |which: usize| files.iter().filter(|(n, _)| kind(n) == which).count();
    let mut names: Vec<String> = files.iter().map(|(n, _)| n.clone()).filter(|n| kind(n) == 0).collect();
    match count(1) {
        0 => {}
        1 => names.push("one front by material".into()),
        n => names.push(format!("{n} fronts by material")),
    }
    if count(2) > 0 {
        names.push(format!("{} files in {PLOTS}", count(2)));
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

/// What a finished search has to say.
pub(super) struct Written {
    /// Files by name.
    pub files: Vec<(String, Vec<u8>)>,
    /// Text for the terminal.
    pub terminal: String,
    /// The front of all designs.
    pub front: FrontTable,
}

/// A finished search and what it was made with.
struct Finished<'a> {
    study: &'a Study,
    text: &'a str,
    carried: &'a [Carried],
    problem: &'a ArmProblem<'a>,
    /// The space with all options of the study.
    whole: &'a DesignSpace,
    outcome: &'a StudyOutcome,
    /// The designs near the front that an exact search found.
    near: Option<&'a NearDesigns>,
    /// Boxes bounded and left open, and the gap, of an exact search.
    exact: Option<([u64; 2], Option<f64>)>,
    elapsed_s: f64,
    overlay: Option<&'a Path>,
    catalogs: &'a Catalogs,
    dir: &'a Path,
}

impl Finished<'_> {
    fn files(&self, asked: &BesideArgs, stop: &AtomicBool) -> Result<Written, Failure> {
        let summary = self.summary();
        let Self { problem, catalogs, outcome, near, .. } = *self;
        let is_exact = self.exact.is_some();
        let beside =
            asked.work(&Found { problem, catalogs, outcome, near, is_exact, stop }, &summary.overall);
        // succeeds only on an empty folder: earlier results stay
        let beside = beside.inspect_err(|_| drop(std::fs::remove_dir(self.dir)))?;
        let mut files = vec![("front.csv".to_string(), summary.overall.to_csv())];
        for material in &summary.materials {
            files.push((format!("front.{}.csv", slug(&material.name)), material.front.to_csv()));
        }
        let picture = picture(&summary);
        files.push(("front.svg".into(), picture.clone().into_bytes()));
        files.push(("budget.csv".into(), budget_csv(&summary.budgets).into_bytes()));
        let Beside { files: more, markdown, terminal, sections, run: mut facts } = beside;
        files.extend(more);
        files.push(("summary.md".into(), (summary_md(&summary) + &markdown).into_bytes()));
        let mut run = self.run_json(&summary);
        run.as_object_mut().into_iter().for_each(|run| run.append(&mut facts));
        files.push(("run.json".into(), pretty(&run)));
        files.extend(self.page(&summary, picture, sections, &run).into_files());
        files.push(("study.json".into(), self.text.as_bytes().to_vec()));
        let terminal = terminal_summary(&summary) + &terminal;
        Ok(Written { files, terminal, front: summary.overall })
    }

    fn summary(&self) -> SummaryInput {
        let (study, sweep) = (self.study, &self.outcome.sweep);
        let cost = |name: &str| self.catalogs.materials.iter().find(|m| m.name == name)?.cost_eur_per_kg;
        let overall = front_table(self.problem, self.catalogs, &self.outcome.front);
        SummaryInput {
            budgets: budgets(self.problem, self.whole, self.catalogs, &overall),
            facts: SummaryFacts {
                study: study.name.clone(),
                question: study.question.clone(),
                status: sweep.status.word().into(),
                designs_total: sweep.designs_total,
                designs_evaluated: sweep.designs_evaluated.into(),
                designs_excluded: sweep.designs_excluded,
                gap: self.exact.and_then(|(_, gap)| gap),
                elapsed_s: self.elapsed_s,
                threads: rayon::current_num_threads(),
                tool_version: env!("CARGO_PKG_VERSION").into(),
                constraints: constraint_words(&study.space.constraints),
                cases: self.judged_cases(),
                not_checked: study.not_checked.clone(),
                results: self.dir.display().to_string(),
            },
            overall,
            materials: self
                .outcome
                .by_material
                .iter()
                .map(|of| MaterialFront {
                    cost_eur_per_kg: cost(&of.name),
                    name: of.name.clone(),
                    status: of.status.word().into(),
                    front: front_table(self.problem, self.catalogs, &of.front),
                })
                .collect(),
        }
    }

    /// The study's effects, each with whether it counts: those that describe a test do not.
    fn effects(&self) -> Vec<Value> {
        let counted = |effect: &Effect| {
            let mut value = effect.to_json();
            value["counts"] = json!(!effect.is_of_test());
            value
        };
        self.study.space.effects.iter().map(counted).collect()
    }

    /// The page for a browser.
    fn page(&self, summary: &SummaryInput, picture: String, sections: Vec<Extra>, run: &Value) -> Page {
        let mut page = study_page(self.study, self.problem, self.catalogs, summary);
        page.extras.extend(sections);
        page.extras.push(certificate_section(&summary.facts, self.exact.map(|(boxes, _)| boxes)));
        StudyPage { scatter_svg: picture, run: facts_of(run), ..page }.page()
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
                    "name": m.name, "slug": slug(&m.name), "status": m.status,
                    "front_size": m.front.rows.len(), "cost_eur_per_kg": m.cost_eur_per_kg,
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
            "picks": summary.budgets.iter().map(PickBudget::to_json).collect::<Vec<Value>>(),
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
            "effects": self.effects(),
            "effects_mass_kg": study.space.effects_mass_kg(),
            "carried_over": carry::to_json(self.carried),
            "catalogs": self.overlay.map(|p| p.display().to_string()),
            "study_hash": blake3::hash(self.text.as_bytes()).to_hex().to_string(),
            "catalogs_hash": catalogs_hash(self.catalogs),
            "search": if self.exact.is_some() { "exact" } else { "exhaustive" },
            "boxes": self.exact.map(|([boxes, _], _)| boxes),
            "boxes_open": self.exact.map(|([_, open], _)| open),
            "gap": self.exact.and_then(|(_, gap)| gap),
        })
    }
}

/// The facts of `run.json` that are a word or a number, for people.
fn facts_of(run: &Value) -> Vec<(String, String)> {
    let plain = |value: &Value| match value {
        Value::String(text) => Some(text.clone()),
        Value::Number(number) if number.is_f64() => Some(significant(number.as_f64()?, 4)),
        Value::Number(number) => Some(number.to_string()),
        Value::Object(map) => {
            let parts = map.iter().filter_map(|(k, v)| Some(format!("{k} {}", v.as_str()?)));
            Some(parts.collect::<Vec<_>>().join(", ")).filter(|words| !words.is_empty())
        }
        _ => None,
    };
    let facts = run.as_object().into_iter().flatten();
    facts
        .filter(|(key, _)| !["schema_version", "study", "question"].contains(&key.as_str()))
        .filter_map(|(key, value)| Some((key.replace('_', " "), plain(value)?)))
        .collect()
}

/// The picture of the front: designs of mixed materials in grey, each material in colour, by its own front
/// where the search found one.
fn picture(summary: &SummaryInput) -> String {
    let mixed = mixed_designs(&summary.overall);
    let pure: Vec<(String, FrontTable)> = single_materials(summary)
        .into_iter()
        .map(|name| {
            let own = summary.materials.iter().find(|m| m.name == name).map(|m| m.front.clone());
            (name.to_string(), own.unwrap_or_else(|| designs_of(&summary.overall, name)))
        })
        .collect();
    let mut fronts = vec![PlottedFront { name: "mixed".into(), front: &mixed, muted: true }];
    fronts.extend(pure.iter().map(|(name, front)| PlottedFront { name: name.clone(), front, muted: false }));
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
