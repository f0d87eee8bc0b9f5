//! Searches a study: chooses the method and stops when asked.

use super::asked::{Asked, refuse_empty};
use super::exit::Exit;
use super::failure::Failure;
use super::finished::{Finished, FoundExactly, Keep, Written};
use super::log::Log;
use super::progress::{Record, Watch};
use super::supplements::SupplementArgs;
use super::time_limit::time_limit;
use crate::catalog::Catalogs;
use crate::report::certificate::certificate_words;
use crate::report::words::{TERMINAL, wrap};
use crate::search::sweep::Status;
use crate::space::problem::ArmProblem;
use crate::study::definition::Study;
use crate::study::diagnose::why_infeasible;
use crate::study::outcome::{ExactStudy, Extent, StudyOutcome, run_exact, run_study};
use crate::study::search_cost::SearchCost;
use crate::study::tolerance::part;
use clap::{Args, ValueEnum};
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
    search: Option<SearchKind>,
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
}

/// The two methods of searching for a front.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum SearchKind {
    /// Every design is visited
    Exhaustive,
    /// Groups (boxes) of designs that cannot be on the front are discarded without evaluation; for spaces of
    /// any size
    Exact,
}

/// Above this many designs an exhaustive search would take years.
const MOST_CONCEIVABLE: u128 = 1_000_000_000_000_000;

impl SearchArgs {
    /// The search that was asked for, or the one that is estimated to cost less, which is told on the terminal.
    ///
    /// # Errors
    /// It does not suit the study, or would take years.
    fn kind(&self, study: &Study, catalogs: &Catalogs, log: Log) -> Result<SearchKind, Failure> {
        let designs = self.check(study, catalogs)?;
        Ok(match (self.search, self.gap.is_some() || self.time_limit.is_some()) {
            (Some(kind), _) => kind,
            (None, true) => SearchKind::Exact,
            (None, false) if study.space.beyond_bounds().is_some() => SearchKind::Exhaustive,
            (None, false) => cheaper(study, catalogs, designs as f64, log),
        })
    }

    /// Checks that what was asked for suits the study, and counts its designs.
    ///
    /// # Errors
    /// The study has nothing to choose from, what was asked for does not suit it, or it would take years.
    pub(super) fn check(&self, study: &Study, catalogs: &Catalogs) -> Result<u128, Failure> {
        refuse_empty(study, catalogs)?;
        let refused = |why: String| Err(Failure::Usage(why));
        let Some(designs) = study.space.designs(catalogs) else {
            return refused(format!("the study \"{}\" has more than 1e38 designs; thin a grid", study.name));
        };
        let exhaustive = self.search == Some(SearchKind::Exhaustive);
        let by_bounds =
            self.search == Some(SearchKind::Exact) || self.time_limit.is_some() || self.gap.is_some();
        if let Some(unknown) = study.space.beyond_bounds().filter(|_| by_bounds) {
            return refused(format!(
                "the study \"{}\" has {unknown}, which the bounds of the exact search do not cover; leave --search \
                 exact, --gap and --time-limit away, and every design is visited",
                study.name
            ));
        }
        if exhaustive && designs > MOST_CONCEIVABLE {
            return refused(format!(
                "visiting the {:.1e} designs of the study \"{}\" would take years; use --search exact",
                designs as f64, study.name
            ));
        }
        if exhaustive && self.time_limit.is_some() {
            return refused("--time-limit goes with --search exact".into());
        }
        if exhaustive && self.gap.is_some() {
            return refused("--gap goes with --search exact".into());
        }
        Ok(designs)
    }

    /// Checks that nothing but a visit to every design was asked for, and counts the designs.
    ///
    /// # Errors
    /// Something else was asked for, or the visit would take years.
    pub(super) fn check_exhaustive(&self, study: &Study, catalogs: &Catalogs) -> Result<u128, Failure> {
        if self.search == Some(SearchKind::Exact) {
            return Err(Failure::Usage(
                "--shard goes with --search exhaustive: the exact search runs on one machine".into(),
            ));
        }
        Self { search: Some(SearchKind::Exhaustive), ..*self }.check(study, catalogs)
    }

    /// Whether anything is asked for.
    pub(crate) fn is_default(&self) -> bool {
        self.search.is_none() && self.time_limit.is_none() && self.gap.is_none()
    }
}

/// The search that is estimated to cost less.
fn cheaper(study: &Study, catalogs: &Catalogs, designs: f64, log: Log) -> SearchKind {
    let cost = SearchCost::of(&study.space, catalogs, designs);
    if let Some(words) = cost.words() {
        log.note(&wrap(&words, TERMINAL, ""));
    }
    if cost.speaks_for_exact() { SearchKind::Exact } else { SearchKind::Exhaustive }
}

/// A percentage, which may be 0.
fn part_or_none(text: &str) -> Result<f64, String> {
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
    if asked.study.space.has_linkages() && with.supplements.scatters() {
        return Err(Failure::Usage(format!(
            "--tolerance samples a front without coupled joints, and the study \"{}\" has some; leave it away",
            asked.study.name
        )));
    }
    let written = match with.how.kind(&asked.study, with.catalogs, with.log)? {
        SearchKind::Exhaustive => visit_all(asked, with),
        SearchKind::Exact => search_exactly(asked, with),
    }?;
    if let Some(record) = with.record {
        record.add(written.elapsed_s, &written.progress)?;
    }
    Ok(written)
}

/// Visits every design of a study.
fn visit_all(asked: &Asked, with: &With) -> Result<Written, Failure> {
    let study = &asked.study;
    let With { catalogs, overlay, dir, keep, supplements, record, log, .. } = *with;
    let problem = ArmProblem::new(&study.space, catalogs);
    let stop = stopped_by_signal();
    let started = Instant::now();
    let outcome = run_study(study, catalogs, stop, |total, visited, finished| {
        Watch::new(started, record, log).designs(total, visited, finished);
    });
    let elapsed_s = started.elapsed().as_secs_f64();
    let exit = match outcome.sweep.status {
        Status::Interrupted if outcome.front.is_empty() => {
            return Err(Failure::Interrupted(format!(
                "{}, and none of them meets the study; nothing was written, run again to start over",
                stopped_words(&outcome)
            )));
        }
        Status::Interrupted => {
            log.note(&format!("{}; the front of these is written", stopped_words(&outcome)));
            Exit::Interrupted
        }
        Status::Infeasible => {
            return Err(Failure::Infeasible(why_infeasible(study, catalogs, stop, None)));
        }
        _ => Exit::Done,
    };
    let finished = Finished::visit(asked, (&problem, &outcome), elapsed_s, (catalogs, overlay), dir);
    // further searches are not for who wants to stop
    let none = SupplementArgs::default();
    let supplements = if exit == Exit::Interrupted { &none } else { supplements };
    Ok(Written { exit, ..finished.keep(supplements, stop, keep)? })
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
fn search_exactly(Asked { study, text, corrections }: &Asked, with: &With) -> Result<Written, Failure> {
    let With { catalogs, overlay, dir, keep, how, supplements, record, log } = *with;
    let stop = stopped_by_signal();
    let started = Instant::now();
    let extent = Extent {
        deadline: how.time_limit.map(|limit| started + limit),
        gap: how.gap.unwrap_or(study.gap),
        near: supplements.slack(),
    };
    let ExactStudy { study: part, outcome, boxes, gap, near, ties_listed } =
        run_exact(study, catalogs, stop, extent, |known, finished| {
            Watch::new(started, record, log).search(known, finished);
        });
    // what was found is written; a further signal stops that too
    let is_interrupted = stop.swap(false, Ordering::Relaxed);
    match outcome.sweep.status {
        Status::Infeasible => {
            Err(Failure::Infeasible(why_infeasible(study, catalogs, stop, extent.deadline)))
        }
        Status::Partial if outcome.front.is_empty() => {
            let why = format!(
                "no design was found before the search was stopped ({} boxes); nothing was written, allow more time",
                boxes[0]
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
            let mut written = finished.keep(supplements, stop, keep)?;
            written.exit = match outcome.sweep.status {
                _ if is_interrupted => Exit::Interrupted,
                Status::Partial => Exit::Partial,
                _ => Exit::Done,
            };
            written.terminal.push_str(&certificate_words(boxes, gap, written.proved_to_mass_kg));
            Ok(written)
        }
    }
}
