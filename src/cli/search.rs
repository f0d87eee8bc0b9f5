//! Searches a study: chooses the method, and stops when the user asks for it.

use super::exit::Exit;
use super::extra_files::say_missing;
use super::failure::Failure;
use super::finished::{Finished, FoundExactly, Keep, NOTHING_ELSE, Visited, Written, catalogs_hash};
use super::log::Log;
use super::manifest::hash;
use super::progress::{Record, Watch};
use super::setup::Setup;
use super::stop::stopped_by_signal;
use super::supplements::SupplementArgs;
use super::time_limit::time_limit;
use super::unfinished::{Earlier, Unfinished};
use crate::catalog::Catalogs;
use crate::exact::Known;
use crate::report::certificate::certificate_words;
use crate::report::words::{TERMINAL, wrap};
use crate::search::sweep::{Shard, Status};
use crate::space::problem::ArmProblem;
use crate::study::asked::Asked;
use crate::study::definition::Study;
use crate::study::diagnose::why_infeasible;
use crate::study::outcome::{ExactStudy, Extent, StudyOutcome, judge_swept, resume_exact, sweep_shard};
use crate::study::search_method::{SearchMethod, SearchWish};
use crate::study::tolerance::part;
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// How the front is searched for, and how long.
#[derive(Debug, Clone, Copy, Default, Args)]
pub(crate) struct SearchArgs {
    /// How the front is searched for. Default: exact with --gap or --time-limit, or where it is estimated to
    /// take less than half the processor time of visiting every design; else exhaustive
    #[arg(long, value_enum)]
    search: Option<SearchMethod>,
    /// Stop the exact search after so many seconds, as Ctrl-C does; write what it found and how much may be
    /// missing, which takes some seconds more for a front of thousands of designs
    #[arg(long, value_name = "SECONDS", value_parser = time_limit)]
    time_limit: Option<Duration>,
    /// End the exact search once it is proved that for every design of the study some listed one is worse by
    /// at most this percentage in each of tip deflection, mass and lowest mode, such as 2%. With 0% the whole
    /// front is found; only then are per-material fronts and near-front lists written. Default: the study's
    /// gap_percent
    #[arg(long, value_name = "PERCENT", value_parser = part_or_none)]
    gap: Option<f64>,
    /// Discard what an earlier run left in the folder of results, and begin anew. Without it the same command goes on
    /// where a search was when it was stopped, killed, or lost its machine
    #[arg(long)]
    fresh: bool,
}

impl SearchArgs {
    /// Options that ask for the method `search` and the gap `gap`, as far as they are given.
    pub(super) fn asking_for(search: Option<SearchMethod>, gap: Option<f64>) -> Self {
        Self { search, gap, ..Self::default() }
    }

    /// The wishes of the user for the search: the method, and whether there is a gap and a time limit.
    fn wish(&self) -> SearchWish {
        let (has_gap, has_time_limit) = (self.gap.is_some(), self.time_limit.is_some());
        SearchWish { method: self.search, has_gap, has_time_limit }
    }

    /// The method that the user asks for, or else the one that is estimated to take less time. A choice by estimate
    /// is reported to the user.
    ///
    /// # Errors
    /// The method does not suit the study, or would take years.
    fn kind(&self, study: &Study, catalogs: &Catalogs, log: Log) -> Result<SearchMethod, Failure> {
        let (method, words) = self.wish().method(study, catalogs)?;
        if let Some(words) = words {
            log.note(&wrap(&words, TERMINAL, ""));
        }
        Ok(method)
    }

    /// Checks that the search options suit the study. Returns the number of its designs.
    ///
    /// # Errors
    /// The design space is empty, the options do not suit the study, or the search would take years.
    pub(super) fn check(&self, study: &Study, catalogs: &Catalogs) -> Result<u128, Failure> {
        Ok(self.wish().check(study, catalogs)?)
    }

    /// Checks that the search options suit a search of one shard. Returns the search method and the number of designs
    /// of the study. The method is the exhaustive search unless the user asks for the exact search or for a gap. No
    /// estimate decides, because it could decide otherwise for another shard.
    ///
    /// # Errors
    /// The options do not suit the study, the search would take years, or the user gives a time limit.
    pub(super) fn check_shard(
        &self,
        study: &Study,
        catalogs: &Catalogs,
    ) -> Result<(SearchMethod, u128), Failure> {
        if self.time_limit.is_some() {
            return Err(Failure::Usage(
                "--shard does not go with --time-limit: a shard that is stopped goes on with the same command".into(),
            ));
        }
        let of_gap = if self.gap.is_some() { SearchMethod::Exact } else { SearchMethod::Exhaustive };
        let method = self.search.unwrap_or(of_gap);
        let designs = Self { search: Some(method), ..*self }.check(study, catalogs)?;
        Ok((method, designs))
    }

    /// The gap at which an exact search of the study ends, as a fraction: the one that the user gives, or else that of
    /// the study.
    pub(super) fn gap_of(&self, study: &Study) -> f64 {
        self.gap.unwrap_or(study.gap)
    }

    /// The words of the command line that ask for this search again.
    pub(super) fn words(&self) -> Vec<String> {
        let method = self.search.iter().flat_map(|method| {
            let word = method.to_possible_value().map(|value| value.get_name().to_string());
            std::iter::once("--search".to_string()).chain(word)
        });
        let gap = self.gap.iter().flat_map(|gap| ["--gap".to_string(), gap.to_string()]);
        method.chain(gap).collect()
    }

    /// The time after which the user wants the exact search to stop; `None` if the user gives none.
    pub(super) fn time_limit(&self) -> Option<Duration> {
        self.time_limit
    }

    /// These options without the wish to discard an earlier state.
    pub(super) fn without_fresh(&self) -> Self {
        Self { fresh: false, ..*self }
    }

    /// These options with another time limit.
    pub(super) fn limited_to(&self, time_limit: Option<Duration>) -> Self {
        Self { time_limit, ..*self }
    }

    /// Whether a state that an earlier process saved is to be discarded.
    pub(super) fn is_fresh(&self) -> bool {
        self.fresh
    }

    /// Whether a state that an earlier process saved is read or removed.
    pub(super) fn earlier(&self) -> Earlier {
        if self.fresh { Earlier::Removed } else { Earlier::Read }
    }

    /// The names of the options on method, time limit and gap, and whether the user gives each.
    pub(super) fn given(&self) -> [(&'static str, bool); 3] {
        [
            ("--search", self.search.is_some()),
            ("--gap", self.gap.is_some()),
            ("--time-limit", self.time_limit.is_some()),
        ]
    }

    /// Whether the user gives none of the options on method, time limit and gap.
    pub(crate) fn is_default(&self) -> bool {
        self.given().iter().all(|(_, is_given)| !is_given)
    }
}

/// Reads a percentage such as `2%`, or a fraction such as `0.02`, which may be 0. Returns the fraction.
pub(super) fn part_or_none(text: &str) -> Result<f64, String> {
    match text.trim_end_matches('%').trim_end().parse::<f64>() {
        Ok(0.0) => Ok(0.0),
        _ => part(text)
            .map_err(|_| format!("\"{text}\" is not a percentage from 0 % to below 100 %, such as 2%")),
    }
}

/// The settings with which a study is searched.
pub(super) struct SearchSettings<'a> {
    pub setup: Setup<'a>,
    /// Folder of the results.
    pub dir: &'a Path,
    /// Function that writes the files of the result.
    pub keep: &'a Keep<'a>,
    /// File in which the state of the search is saved until it is finished.
    pub unfinished: &'a Path,
    /// The search options.
    pub how: &'a SearchArgs,
    /// Supplements that the user asks for in addition to the front.
    pub supplements: &'a SupplementArgs,
    /// File in which the progress is recorded; `None` if the user does not ask for it.
    pub record: Option<&'a Record>,
}

/// Searches a study and writes its result.
///
/// # Errors
/// The method does not suit the study, the search finds no design, the user stops it, or the front cannot be written.
pub(super) fn search(asked: &Asked, settings: &SearchSettings) -> Result<Written, Failure> {
    let space = &asked.study.space;
    if (space.has_linkages() || space.has_motors_elsewhere()) && settings.supplements.scatters() {
        return Err(Failure::Usage(format!(
            "--tolerance samples a front without joints that turn with others and without motors elsewhere, and the study \
             \"{}\" has some; leave it away",
            asked.study.name
        )));
    }
    let written = match settings.how.kind(&asked.study, settings.setup.catalogs, settings.setup.log)? {
        SearchMethod::Exhaustive => visit_all(asked, settings),
        SearchMethod::Exact => search_exactly(asked, settings),
    }?;
    if let Some(record) = settings.record {
        record.add(written.elapsed_s, &written.progress)?;
    }
    Ok(written)
}

impl SearchSettings<'_> {
    /// Reads the state that an earlier process saved of the same search, if there is one. The result also saves further
    /// states.
    ///
    /// # Errors
    /// The state belongs to another search, or cannot be read.
    pub(super) fn go_on(&self, asked: &Asked, flags: Value) -> Result<Unfinished, Failure> {
        let search = json!({
            "schema_version": 1,
            "study": asked.study.name,
            "study_hash": hash(asked.text.as_bytes()),
            "catalogs_hash": catalogs_hash(self.setup.catalogs),
            "tool_version": env!("CARGO_PKG_VERSION"),
            "flags": flags,
        });
        Unfinished::open(self.unfinished, search, self.how.earlier(), self.setup.log)
    }
}

/// Searches a study by visiting every design.
fn visit_all(asked: &Asked, settings: &SearchSettings) -> Result<Written, Failure> {
    let study = &asked.study;
    let SearchSettings { setup, dir, keep, supplements, record, .. } = *settings;
    let Setup { catalogs, log, .. } = setup;
    let problem = ArmProblem::new(&study.space, catalogs);
    let stop = stopped_by_signal();
    let unfinished = settings.go_on(asked, json!({"search": "exhaustive"}))?;
    let started = unfinished.started();
    let watch = |total: u128, visited: &(dyn Fn() -> u64 + Sync), finished: &AtomicBool| {
        Watch::new(started, record, log).designs(total, visited, finished);
    };
    let (swept, _) = sweep_shard(study, catalogs, Shard::WHOLE, stop, unfinished.resume(), watch)
        .map_err(|_| unfinished.damaged())?;
    let outcome = judge_swept(study, &problem, swept);
    let elapsed_s = started.elapsed().as_secs_f64();
    let exit = match outcome.sweep.status {
        Status::Interrupted if outcome.front.is_empty() => {
            return Err(Failure::Interrupted(format!(
                "{}, and none of them meets the study; nothing was written, the same command goes on from there",
                stopped_words(&outcome)
            )));
        }
        Status::Interrupted => {
            log.note(&format!(
                "{}; the front of these is written without summary, page and plots, and the same command goes on from there",
                stopped_words(&outcome)
            ));
            Exit::Interrupted
        }
        Status::Infeasible => {
            return Err(Failure::Infeasible(why_infeasible(study, catalogs, stop, None)));
        }
        _ => Exit::Done,
    };
    if exit == Exit::Done {
        say_search_is_over(log, elapsed_s);
    }
    let visited = Visited { problem: &problem, outcome: &outcome, elapsed_s };
    let finished = Finished::visit(asked, visited, dir, setup);
    let written = finished.keep(supplements, stop, keep)?;
    Ok(match exit {
        Exit::Done => written.after_search(log),
        exit => Written { exit, ..written },
    })
}

/// Search time from which the program says that the search is over and other work follows \[s\].
const LONG_SEARCH_S: f64 = 10.0;

/// Prints, after a long search, that the files of the result are being made. Otherwise the last line of progress would
/// stay on the terminal for long, as if the search still ran.
fn say_search_is_over(log: Log, elapsed_s: f64) {
    if elapsed_s >= LONG_SEARCH_S {
        log.note(&format!(
            "searched for {elapsed_s:.0} s; making the budget, the worst poses and the pages of the front"
        ));
    }
}

impl Written {
    /// This result of a search that ended by itself. If the user stopped the program before the files in addition to
    /// the front were made, a warning says so, and the exit status is that of a stopped program.
    pub(super) fn after_search(self, log: Log) -> Self {
        if !self.is_front_only {
            return self;
        }
        let again = "the program was stopped after the search; the same command writes the rest";
        say_missing(&[format!("{NOTHING_ELSE}: {again}")], log);
        Self { exit: Exit::Interrupted, ..self }
    }
}

/// A text on how many designs were visited before the search was stopped.
fn stopped_words(outcome: &StudyOutcome) -> String {
    let sweep = &outcome.sweep;
    let done = u128::from(sweep.designs_evaluated) + sweep.designs_excluded;
    format!("stopped after {done} of {} designs", sweep.designs_total)
}

/// Searches a study by the exact method, which does not visit every design.
fn search_exactly(asked: &Asked, settings: &SearchSettings) -> Result<Written, Failure> {
    let Asked { study, text, corrections } = asked;
    let SearchSettings { setup, dir, keep, how, supplements, record, .. } = *settings;
    let Setup { catalogs, log, .. } = setup;
    let stop = stopped_by_signal();
    let gap = how.gap_of(study);
    let unfinished = settings.go_on(asked, json!({"search": "exact", "gap": gap}))?;
    let started = unfinished.started();
    let extent =
        Extent { deadline: how.time_limit.map(|limit| started + limit), gap, near: supplements.slack() };
    let watch = |known: &(dyn Fn() -> Known + Sync), finished: &AtomicBool| {
        Watch::new(started, record, log).search(known, finished);
    };
    let ExactStudy { study: part, outcome, boxes, gap, near, ties_listed } =
        resume_exact(study, catalogs, stop, extent, unfinished.resume(), watch)
            .map_err(|_| unfinished.damaged())?;
    // the front found so far is written; if the user stops the program again, it ends at once
    let is_interrupted = stop.load(Ordering::Relaxed);
    match outcome.sweep.status {
        Status::Infeasible => {
            Err(Failure::Infeasible(why_infeasible(study, catalogs, stop, extent.deadline)))
        }
        Status::Partial if outcome.front.is_empty() => Err(none_found(boxes[0], is_interrupted)),
        _ => {
            let problem = ArmProblem::new(&part.space, catalogs);
            let finished = Finished {
                study: &part,
                text,
                corrections,
                problem: &problem,
                whole: &study.space,
                outcome: &outcome,
                near: near.as_ref(),
                exact: Some(FoundExactly { boxes, gap, ties_listed }),
                elapsed_s: started.elapsed().as_secs_f64(),
                setup,
                dir,
            };
            if !is_interrupted {
                say_search_is_over(log, finished.elapsed_s);
            }
            let finishing = Instant::now();
            let mut written = finished.keep(supplements, stop, keep)?;
            if how.time_limit.is_some() {
                written.terminal.push_str(&finishing_words(finishing.elapsed()));
            }
            let is_partial = outcome.sweep.status == Status::Partial;
            let mut written = after_exact_search(written, is_partial, is_interrupted, log);
            written.terminal.push_str(&certificate_words(boxes, gap, written.proved_to_mass_kg));
            Ok(written)
        }
    }
}

/// The result of an exact search, with its exit code. `is_partial` is true if the front is not yet proved, and
/// `is_interrupted` if the user stopped the search.
fn after_exact_search(written: Written, is_partial: bool, is_interrupted: bool, log: Log) -> Written {
    let exit = |written: Written, exit: Exit| Written { exit, ..written };
    if is_interrupted && is_partial {
        log.note("stopped; the front so far is written without summary, page and plots, and the same command goes on");
        return exit(written, Exit::Interrupted);
    }
    let written = written.after_search(log);
    match (is_partial, written.exit) {
        (true, Exit::Done) => exit(written, Exit::Partial),
        _ => written,
    }
}

/// The failure of an exact search that was stopped, by the user or by its time limit, before it found a design.
/// `boxes` is the number of boxes that it bounded.
fn none_found(boxes: u64, is_interrupted: bool) -> Failure {
    let why = format!(
        "no design was found before the search was stopped ({boxes} boxes); nothing was written, {}",
        if is_interrupted { "the same command goes on" } else { "allow more time" }
    );
    if is_interrupted { Failure::Interrupted(why) } else { Failure::Partial(why) }
}

/// Words on the time that a search with a time limit took after the limit, to evaluate designs and write files.
fn finishing_words(finishing: Duration) -> String {
    format!("Working out and writing the files took {:.1} s more.\n", finishing.as_secs_f64())
}
