//! What `armwright run` works out beside the front: files, words and facts of the run.

use super::failure::Failure;
use crate::catalog::Catalogs;
use crate::report::front_table::FrontTable;
use crate::report::picks;
use crate::report::section::Extra;
use crate::report::tolerance::Scattered;
use crate::report::words::wrap;
use crate::search::near::{NearDesigns, Slack};
use crate::space::problem::ArmProblem;
use crate::study::ballast::ballast_flags;
use crate::study::near::{NearFront, near_front};
use crate::study::outcome::StudyOutcome;
use crate::study::ties;
use crate::study::tolerance::{Sampling, Tolerance, part, scatter_front};
use clap::Args;
use serde_json::{Map, Value, json};
use std::sync::atomic::AtomicBool;

/// Files beside the front that not every run has.
pub(super) const FILES: [&str; 4] = [BALLAST, TIES, TOLERANCE, NEAR];
const BALLAST: &str = "ballast.csv";
pub(super) const TIES: &str = "ties.csv";
const TOLERANCE: &str = "tolerance.csv";
const NEAR: &str = "near.csv";

/// What may be asked for beside a front.
#[derive(Debug, Clone, Default, Args)]
pub(super) struct BesideArgs {
    /// How far catalog figures scatter, such as gear_stiffness=20%,modulus=3%,mass=2%: the front is sampled,
    /// and each design's share of samples on the front goes to tolerance.csv. A name alone stands for the
    /// number above. 95 % of the rows of a catalog lie within it (log-normal)
    #[arg(long, value_name = "SCATTER")]
    tolerance: Option<Tolerance>,
    /// Number of samples of --tolerance
    #[arg(long, value_name = "N", default_value_t = 1000, requires = "tolerance",
          value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    samples: u32,
    /// Seed of the samples; the same seed gives the same samples on any number of threads
    #[arg(long, value_name = "N", default_value_t = 1, requires = "tolerance")]
    seed: u64,
    /// Also list the designs that come within this part of a design of the front in mass, in deflection and in
    /// lowest mode, such as 2%, in near.csv. The designs are searched a second time; after an exact search that
    /// was stopped, whose front may not be the front, there is no such list
    #[arg(long, value_name = "PERCENT", value_parser = part)]
    within: Option<f64>,
    /// How many designs --within lists at most, the nearest first
    #[arg(long, value_name = "N", default_value_t = 10_000, requires = "within",
          value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    within_most: u32,
}

/// Files, words and facts that go beside a front's own.
#[derive(Debug, Default)]
pub(super) struct Beside {
    /// Files by name.
    pub files: Vec<(String, Vec<u8>)>,
    /// Sections of `summary.md`.
    pub markdown: String,
    /// Text for the terminal.
    pub terminal: String,
    /// Sections of the page.
    pub sections: Vec<Extra>,
    /// Keys of `run.json`.
    pub run: Map<String, Value>,
}

/// A finished search.
pub(super) struct Found<'a> {
    pub problem: &'a ArmProblem<'a>,
    pub catalogs: &'a Catalogs,
    pub outcome: &'a StudyOutcome,
    /// The designs near the front that an exact search found.
    pub near: Option<&'a NearDesigns>,
    pub is_exact: bool,
    /// Whether drives of equal mass and curve are rows of the front.
    pub ties_listed: bool,
    pub stop: &'a AtomicBool,
}

impl BesideArgs {
    /// Works out what was asked for; `front` is the table of the front.
    pub(super) fn work(&self, found: &Found, front: &FrontTable) -> Result<Beside, Failure> {
        let mut beside = Beside::default();
        let flags = ballast_flags(found.problem, &found.outcome.front);
        beside.run.insert("ballast_designs".into(), json!(flags.len()));
        if !flags.is_empty() {
            beside.files.push((BALLAST.into(), flags.to_csv()));
            beside.markdown.push_str(&flags.to_markdown());
            beside.sections.push(flags.section());
            beside.terminal.push_str(&format!("\n{}", wrap(&flags.sentence(), 80, "")));
        }
        if !found.ties_listed {
            let ties = ties(found.problem, &found.outcome.front);
            beside.files.push((TIES.into(), ties.to_csv()));
            beside.markdown.push_str(&ties.to_markdown());
            beside.sections.push(ties.section());
            beside.terminal.push_str(&format!("\n{}", ties.to_text()));
        }
        let stopped = || Failure::Interrupted("stopped after the search; nothing was written".into());
        let scattered = self.scattered(found, front).map_err(|()| stopped())?;
        beside.run.insert("tolerance".into(), scattered.as_ref().map_or(Value::Null, Scattered::to_json));
        if let Some(scattered) = scattered {
            beside.files.push((TOLERANCE.into(), scattered.to_csv().into_bytes()));
            beside.markdown.push_str(&scattered.to_markdown());
            beside.sections.push(scattered.section());
            let sentences: String = scattered.sentences().iter().map(|s| wrap(s, 80, "")).collect();
            beside.terminal.push_str(&format!("\n{}\n{sentences}", scattered.table().to_text()));
        }
        let near = self.near(found).map_err(|()| stopped())?;
        beside.run.insert("within".into(), near.as_ref().map_or(Value::Null, near_json));
        if near.is_none() && self.within.is_some() {
            beside.terminal.push_str(&format!("\n{}", wrap(NO_NEAR, 80, "")));
        }
        if let Some(near) = near {
            beside.files.push((NEAR.into(), near.table.to_csv()));
            beside.markdown.push_str(&near.to_markdown());
            beside.sections.push(near.section());
            let sentences: String = near.sentences().iter().map(|s| wrap(s, 80, "")).collect();
            beside.terminal.push_str(&format!("\n{sentences}"));
        }
        Ok(beside)
    }

    /// Which designs near the front are asked for, if any are.
    pub(super) fn slack(&self) -> Option<Slack> {
        self.within.map(|part| Slack { part, most: self.within_most as usize })
    }

    /// The designs near the front, if they were asked for and found.
    fn near(&self, found: &Found) -> Result<Option<NearFront>, ()> {
        let Some(slack) = self.slack() else { return Ok(None) };
        let Found { problem, catalogs, outcome, near, is_exact, stop, .. } = *found;
        match is_exact {
            true => Ok(near.map(|near| NearFront::of(problem, catalogs, &outcome.front, near, slack))),
            false => near_front(problem, catalogs, outcome, slack, stop).map(Some).ok_or(()),
        }
    }

    /// The front under scatter, if that was asked for.
    fn scattered(&self, found: &Found, front: &FrontTable) -> Result<Option<Scattered>, ()> {
        let Some(tolerance) = self.tolerance else { return Ok(None) };
        let sampling = Sampling { tolerance, samples: self.samples, seed: self.seed };
        let designs = picks::designs(front);
        let (problem, outcome) = (found.problem, found.outcome);
        scatter_front(problem, found.catalogs, &outcome.front, &designs, &sampling, found.stop)
            .map(Some)
            .ok_or(())
    }
}

/// Why there is no list of designs near a front although it was asked for.
const NO_NEAR: &str = "No near.csv: designs near a front are looked for if it is whole and has its ties as rows; a longer \
                       --time-limit, --gap 0% and narrower constraints help.";

fn near_json(near: &NearFront) -> Value {
    json!({
        "slack_percent": 100.0 * near.slack, "designs": near.total, "listed": near.table.rows.len(),
        "capped": near.capped,
    })
}
