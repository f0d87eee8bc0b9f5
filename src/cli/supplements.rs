//! What `armwright run` computes in addition to the front: ballast, ties, the front under scatter, and near designs.

use super::failure::Failure;
use crate::catalog::Catalogs;
use crate::report::front_table::FrontTable;
use crate::report::picks;
use crate::report::supplement::Supplement;
use crate::report::tolerance::{self, Scattered};
use crate::report::words::{TERMINAL, wrap};
use crate::search::near::{NearDesigns, Slack};
use crate::space::problem::ArmProblem;
use crate::study::ballast::{self, ballast_flags};
use crate::study::near::{self, NO_NEAR, NearFront, near_front};
use crate::study::outcome::StudyOutcome;
use crate::study::pick_poses::picks_in_poses;
use crate::study::same_drives::picks_on_same_drives;
use crate::study::ties::{self, ties};
use crate::study::tolerance::{Sampling, Tolerance, part, scatter_front};
use clap::Args;
use serde_json::Value;
use std::sync::atomic::AtomicBool;

/// Names of all files that supplements may write. Which of them a run has depends on its options and its front.
pub(super) const FILES: [&str; 4] = [ballast::FILE, ties::FILE, tolerance::FILE, near::FILE];

/// What may be asked for in addition to a front.
#[derive(Debug, Clone, Default, Args)]
pub(super) struct SupplementArgs {
    /// Scatter of catalog ratings, such as
    /// gear_stiffness=20%,bearing_stiffness=20%,modulus=3%,mass=2%. The front is sampled, and
    /// tolerance.csv lists for each design the share of samples in which it is on the front. A name alone
    /// stands for the number above. 95 % of the rows of a catalog lie within the scatter (log-normal)
    #[arg(long, value_name = "SCATTER")]
    tolerance: Option<Tolerance>,
    /// Number of samples of --tolerance
    #[arg(long, value_name = "N", default_value_t = 1000, requires = "tolerance",
          value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    samples: u32,
    /// Seed of the samples; the same seed gives the same samples on any number of threads
    #[arg(long, value_name = "N", default_value_t = 1, requires = "tolerance")]
    seed: u64,
    /// Also list in near.csv the designs that are worse than some design of the front by at most this
    /// percentage, such as 2%, in mass, deflection and lowest mode. This needs a second search. There is no
    /// list after an exact search that was stopped, because its front may be incomplete
    #[arg(long, value_name = "PERCENT", value_parser = part)]
    within: Option<f64>,
    /// The largest number of designs that --within lists, the nearest first
    #[arg(long, value_name = "N", default_value_t = 10_000, requires = "within",
          value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    within_most: u32,
}

/// A finished search, as the supplements need it.
pub(super) struct Found<'a> {
    pub problem: &'a ArmProblem<'a>,
    pub catalogs: &'a Catalogs,
    /// The fronts that were found.
    pub outcome: &'a StudyOutcome,
    /// The near designs that an exact search listed; `None` if it was not asked for them, or could not list them.
    pub near: Option<&'a NearDesigns>,
    /// Whether the search was exact.
    pub is_exact: bool,
    /// Whether each design has a row of its own even if it differs from another one only in drives of equal mass and
    /// torsion curve (ties). If not, one row stands for all of them.
    pub ties_listed: bool,
    /// Set when the user wants to stop the program.
    pub stop: &'a AtomicBool,
}

impl SupplementArgs {
    /// Computes the supplements that the user asks for. `front` is the table of the front.
    ///
    /// # Errors
    /// The user stops the computation.
    pub(super) fn work_out(&self, found: &Found, front: &FrontTable) -> Result<Vec<Supplement>, Failure> {
        let stopped = || {
            let words = "stopped after the search: the front is written, what goes with it is not";
            Failure::Interrupted(words.into())
        };
        let mut out = vec![
            picks_in_poses(found.problem, front).supplement(),
            picks_on_same_drives(found.problem, front).supplement(),
            ballast_flags(found.problem, &found.outcome.front).supplement(),
        ];
        if !found.ties_listed {
            out.push(ties(found.problem, &found.outcome.front).supplement());
        }
        out.push(match self.scattered(found, front).map_err(|()| stopped())? {
            Some(scattered) => scattered.supplement(),
            None => Supplement::fact(tolerance::KEY, Value::Null),
        });
        out.push(match self.near(found).map_err(|()| stopped())? {
            Some(near) => near.supplement(),
            None => Supplement { terminal: self.why_no_near(), ..Supplement::fact(near::KEY, Value::Null) },
        });
        Ok(out)
    }

    /// The names of the options, and whether the user gives each.
    pub(super) fn given(&self) -> [(&'static str, bool); 2] {
        [("--tolerance", self.tolerance.is_some()), ("--within", self.within.is_some())]
    }

    /// Whether the user asks for neither scatter nor near designs.
    pub(super) fn is_default(&self) -> bool {
        self.given().iter().all(|(_, is_given)| !is_given)
    }

    /// A sentence on why there is no list of near designs; empty if the user asks for none.
    fn why_no_near(&self) -> String {
        if self.within.is_some() { wrap(NO_NEAR, TERMINAL, "") } else { String::new() }
    }

    /// Whether the user asks for scatter of catalog ratings.
    pub(super) fn scatters(&self) -> bool {
        self.tolerance.is_some()
    }

    /// How much worse near designs may be, and how many are listed; `None` if the user asks for none.
    pub(super) fn slack(&self) -> Option<Slack> {
        self.within.map(|part| Slack { part, most: self.within_most as usize })
    }

    /// The near designs; `None` if the user asks for none, or if an exact search could not list them.
    fn near(&self, found: &Found) -> Result<Option<NearFront>, ()> {
        let Some(slack) = self.slack() else { return Ok(None) };
        let Found { problem, catalogs, outcome, near, is_exact, stop, .. } = *found;
        match is_exact {
            true => Ok(near.map(|near| NearFront::of(problem, catalogs, &outcome.front, near, slack))),
            false => near_front(problem, catalogs, outcome, slack, stop).map(Some).ok_or(()),
        }
    }

    /// The front under scatter; `None` if the user does not ask for it.
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
