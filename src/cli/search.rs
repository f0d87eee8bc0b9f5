//! Searches a study: chooses the method and stops when asked.

use super::asked::Asked;
use super::exit::Exit;
use super::failure::Failure;
use super::finished::{Finished, FoundExactly, Keep, Written, catalogs_hash};
use super::log::Log;
use super::manifest::hash;
use super::progress::{Record, Watch};
use super::supplements::SupplementArgs;
use super::time_limit::time_limit;
use super::unfinished::Unfinished;
use crate::catalog::Catalogs;
use crate::exact::Known;
use crate::report::certificate::certificate_words;
use crate::report::words::{TERMINAL, wrap};
use crate::search::sweep::{Shard, Status};
use crate::space::problem::ArmProblem;
use crate::study::definition::Study;
use crate::study::diagnose::why_infeasible;
use crate::study::outcome::{ExactStudy, Extent, StudyOutcome, judge_swept, resume_exact, sweep_shard};
use crate::study::search_method::{SearchMethod, SearchWish};
use crate::study::tolerance::part;
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Once;
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
    /// Discard what an earlier run left in the folder of results, and begin anew. Without it the same command goes on where
    /// a search was when it was stopped, killed, or lost its machine
    #[arg(long)]
    fresh: bool,
}

impl SearchArgs {
    /// What asks for a method and a gap.
    pub(super) fn asking_for(search: Option<SearchMethod>, gap: Option<f64>) -> Self {
        Self { search, gap, ..Self::default() }
    }

    /// What is asked of the search.
    fn wish(&self) -> SearchWish {
        let (has_gap, has_time_limit) = (self.gap.is_some(), self.time_limit.is_some());
        SearchWish { method: self.search, has_gap, has_time_limit }
    }

    /// The search that was asked for, or the one that is estimated to cost less, which is told on the terminal.
    ///
    /// # Errors
    /// It does not suit the study, or would take years.
    fn kind(&self, study: &Study, catalogs: &Catalogs, log: Log) -> Result<SearchMethod, Failure> {
        let (method, words) = self.wish().method(study, catalogs)?;
        if let Some(words) = words {
            log.note(&wrap(&words, TERMINAL, ""));
        }
        Ok(method)
    }

    /// Checks that what was asked for suits the study, and counts its designs.
    ///
    /// # Errors
    /// The study has nothing to choose from, what was asked for does not suit it, or it would take years.
    pub(super) fn check(&self, study: &Study, catalogs: &Catalogs) -> Result<u128, Failure> {
        Ok(self.wish().check(study, catalogs)?)
    }

    /// Checks that a search of one shard suits the study, and counts the study's designs. Every design is visited unless the
    /// exact search or a gap is asked for: an estimate must not decide otherwise for another shard.
    ///
    /// # Errors
    /// It does not suit the study, would take years, or a time limit is asked for.
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

    /// The gap to which an exact search of a study goes.
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

    /// Whether what an earlier process left is not to be used.
    pub(super) fn is_fresh(&self) -> bool {
        self.fresh
    }

    /// Whether anything is asked for.
    pub(crate) fn is_default(&self) -> bool {
        self.search.is_none() && self.time_limit.is_none() && self.gap.is_none()
    }
}

/// A percentage, which may be 0.
pub(super) fn part_or_none(text: &str) -> Result<f64, String> {
    match text.trim_end_matches('%').trim_end().parse::<f64>() {
        Ok(0.0) => Ok(0.0),
        _ => part(text),
    }
}

/// The settings and catalogs that a study is searched with.
pub(super) struct With<'a> {
    pub catalogs: &'a Catalogs,
    /// Folder of the catalogs that are laid over the built-in ones.
    pub overlay: Option<&'a Path>,
    /// Where the results go.
    pub dir: &'a Path,
    /// How they are kept.
    pub keep: &'a Keep<'a>,
    /// Where the state of the search is kept until it is done.
    pub unfinished: &'a Path,
    pub how: &'a SearchArgs,
    /// What is asked for in addition to the front.
    pub supplements: &'a SupplementArgs,
    /// Where progress is recorded.
    pub record: Option<&'a Record>,
    /// Where messages and progress go.
    pub log: Log,
}

/// Searches a study and keeps its result.
///
/// # Errors
/// The search that is asked for does not suit the study, finds nothing, is interrupted, or its front cannot be written.
pub(super) fn search(asked: &Asked, with: &With) -> Result<Written, Failure> {
    let space = &asked.study.space;
    if (space.has_linkages() || space.has_motors_elsewhere()) && with.supplements.scatters() {
        return Err(Failure::Usage(format!(
            "--tolerance samples a front without joints that turn with others and without motors elsewhere, and the study \
             \"{}\" has some; leave it away",
            asked.study.name
        )));
    }
    let written = match with.how.kind(&asked.study, with.catalogs, with.log)? {
        SearchMethod::Exhaustive => visit_all(asked, with),
        SearchMethod::Exact => search_exactly(asked, with),
    }?;
    if let Some(record) = with.record {
        record.add(written.elapsed_s, &written.progress)?;
    }
    Ok(written)
}

impl With<'_> {
    /// The state in which an earlier process left a search of this kind, and the keeping of the next ones.
    ///
    /// # Errors
    /// The state is of another search, or cannot be read.
    pub(super) fn go_on(&self, asked: &Asked, flags: Value) -> Result<Unfinished, Failure> {
        let search = json!({
            "schema_version": 1,
            "study": asked.study.name,
            "study_hash": hash(asked.text.as_bytes()),
            "catalogs_hash": catalogs_hash(self.catalogs),
            "tool_version": env!("CARGO_PKG_VERSION"),
            "flags": flags,
        });
        Unfinished::open(self.unfinished, search, self.how.fresh, self.log)
    }
}

/// Visits every design of a study.
fn visit_all(asked: &Asked, with: &With) -> Result<Written, Failure> {
    let study = &asked.study;
    let With { catalogs, overlay, dir, keep, supplements, record, log, .. } = *with;
    let problem = ArmProblem::new(&study.space, catalogs);
    let stop = stopped_by_signal();
    let unfinished = with.go_on(asked, json!({"search": "exhaustive"}))?;
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
    let finished = Finished::visit(asked, (&problem, &outcome), elapsed_s, (catalogs, overlay), dir);
    let written = finished.keep(supplements, stop, keep)?;
    // a signal that came after the search costs what goes with the front
    let exit = if stop.load(Ordering::Relaxed) { Exit::Interrupted } else { exit };
    Ok(Written { exit, ..written })
}

/// How far a visit came that was stopped.
fn stopped_words(outcome: &StudyOutcome) -> String {
    let sweep = &outcome.sweep;
    let done = u128::from(sweep.designs_evaluated) + sweep.designs_excluded;
    format!("stopped after {done} of {} designs", sweep.designs_total)
}

/// A flag that is set when the user wants to stop. Code that reacts to it and continues must clear it: a
/// second signal while the flag is set ends the program.
pub(super) fn stopped_by_signal() -> &'static AtomicBool {
    static STOP: AtomicBool = AtomicBool::new(false);
    static HANDLER: Once = Once::new();
    HANDLER.call_once(|| {
        // where signals cannot be handled they end the program
        let _ = ctrlc::set_handler(|| {
            if STOP.swap(true, Ordering::Relaxed) {
                std::process::exit(Failure::Interrupted(String::new()).exit_code().into());
            }
        });
    });
    &STOP
}

/// Finds the front of a study without visiting every design.
fn search_exactly(asked: &Asked, with: &With) -> Result<Written, Failure> {
    let Asked { study, text, corrections } = asked;
    let With { catalogs, overlay, dir, keep, how, supplements, record, log, .. } = *with;
    let stop = stopped_by_signal();
    let gap = how.gap_of(study);
    let unfinished = with.go_on(asked, json!({"search": "exact", "gap": gap}))?;
    let started = unfinished.started();
    let extent =
        Extent { deadline: how.time_limit.map(|limit| started + limit), gap, near: supplements.slack() };
    let watch = |known: &(dyn Fn() -> Known + Sync), finished: &AtomicBool| {
        Watch::new(started, record, log).search(known, finished);
    };
    let ExactStudy { study: part, outcome, boxes, gap, near, ties_listed } =
        resume_exact(study, catalogs, stop, extent, unfinished.resume(), watch)
            .map_err(|_| unfinished.damaged())?;
    // what was found is written; a further signal ends that at once
    let is_interrupted = stop.load(Ordering::Relaxed);
    match outcome.sweep.status {
        Status::Infeasible => {
            Err(Failure::Infeasible(why_infeasible(study, catalogs, stop, extent.deadline)))
        }
        Status::Partial if outcome.front.is_empty() => {
            let why = format!(
                "no design was found before the search was stopped ({} boxes); nothing was written, {}",
                boxes[0],
                if is_interrupted { "the same command goes on" } else { "allow more time" }
            );
            Err(if is_interrupted { Failure::Interrupted(why) } else { Failure::Partial(why) })
        }
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
                overlay,
                catalogs,
                dir,
            };
            let finishing = Instant::now();
            let mut written = finished.keep(supplements, stop, keep)?;
            if how.time_limit.is_some() {
                let more_s = finishing.elapsed().as_secs_f64();
                written
                    .terminal
                    .push_str(&format!("Working out and writing the files took {more_s:.1} s more.\n"));
            }
            if is_interrupted {
                log.note("stopped; the front so far is written without summary, page and plots, and the same command goes on");
            }
            written.exit = match outcome.sweep.status {
                _ if stop.load(Ordering::Relaxed) => Exit::Interrupted,
                Status::Partial => Exit::Partial,
                _ => Exit::Done,
            };
            written.terminal.push_str(&certificate_words(boxes, gap, written.proved_to_mass_kg));
            Ok(written)
        }
    }
}
