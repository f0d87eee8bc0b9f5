//! How often the 95 % intervals contain the truth, for each kind of readings. `ARMWRIGHT_COVERAGE` is the number of
//! campaigns of each kind. By default it is small, so that only gross faults show. The test prints a table.

use crate::generator;
use crate::scoring;
use crate::yielding_arm;
use armwright::catalog::Catalogs;
use armwright::reconcile::{Campaign, Outcome, reconcile};
use std::path::Path;

/// From this many parameters on the rates must be those that are promised.
const TELLING: usize = 100;

/// Intervals that hold, ends that are open, and all intervals.
#[derive(Default)]
struct Coverage {
    hold: usize,
    open: usize,
    all: usize,
}

impl Coverage {
    fn add(&mut self, low: Option<f64>, high: Option<f64>, truth: f64) {
        self.hold += usize::from(low.is_none_or(|l| l <= truth) && high.is_none_or(|h| truth <= h));
        self.open += usize::from(low.is_none()) + usize::from(high.is_none());
        self.all += 1;
    }

    /// Prints the row of a kind of readings and checks it.
    fn check(&self, channel: &str) {
        let Self { hold, open, all } = self;
        println!("{channel:<10} {hold:>4} of {all:>4} hold, {open:>3} of {:>4} ends are open", 2 * all);
        assert!(*all > 0, "{channel}: nothing was named");
        if *all < TELLING {
            assert!(hold * 4 >= all * 3, "{channel}: {hold} of {all}");
            return;
        }
        assert!(*hold as f64 >= 0.92 * *all as f64, "{channel}: {hold} of {all}");
        assert!(*open as f64 <= 0.05 * 2.0 * *all as f64, "{channel}: {open} of {} ends", 2 * all);
    }
}

fn campaigns(otherwise: usize) -> usize {
    std::env::var("ARMWRIGHT_COVERAGE").ok().and_then(|n| n.parse().ok()).unwrap_or(otherwise)
}

fn reconciled(folder: &Path) -> Outcome {
    reconcile(&Campaign::read(folder, &Catalogs::default()).unwrap_or_else(|e| panic!("{e}")))
}

#[test]
fn intervals_hold_in_each_kind_of_readings() {
    let folder = tempfile::tempdir().expect("temporary folder");
    for channel in ["static", "modal", "windup"] {
        let mut names = Vec::new();
        for number in 0..campaigns(1) {
            let (name, _) = generator::make(folder.path(), channel, "one", 301, number, 0);
            let outcome = reconciled(&folder.path().join("campaigns").join(&name));
            outcome.write(&folder.path().join("verdicts").join(&name)).expect("written");
            names.push(name);
        }
        let score = scoring::score(&names, &folder.path().join("verdicts"), &folder.path().join("keys"));
        let score = score.expect("scored");
        let mut coverage = Coverage::default();
        for line in &score.intervals {
            let cells: Vec<Option<f64>> = line.split(',').map(|cell| cell.parse().ok()).collect();
            coverage.add(cells[6], cells[7], cells[4].expect("the true value"));
        }
        score.misses.iter().for_each(|miss| println!("  {miss}"));
        coverage.check(channel);
    }
}

/// Joints and bearings that yield too little to be named must not spoil the intervals of those that are.
#[test]
fn intervals_of_positions_leave_room_for_what_yields_too_little_to_be_named() {
    of_yielding_arms("positions", 1_100, &yielding_arm::USUAL);
}

/// Lengths along a vertical axis, for example, show in positions only by the levers of what deflects.
#[test]
fn intervals_of_positions_leave_room_for_geometry_that_the_readings_hardly_show() {
    of_yielding_arms("far off", 3_400, &yielding_arm::FAR);
}

/// Counts the intervals of stiffnesses of made arms that are `off` their drawing, from the seed `first` on.
fn of_yielding_arms(name: &str, first: u64, off: &yielding_arm::Off) {
    let folder = tempfile::tempdir().expect("temporary folder");
    let mut coverage = Coverage::default();
    // one campaign names three compliances, of which one may well miss
    for seed in 0..campaigns(4) as u64 {
        let own = folder.path().join(seed.to_string());
        let truth = yielding_arm::make(&own, first + seed, off);
        let outcome = reconciled(&own);
        for finding in outcome.effects.iter().chain(&outcome.suspects) {
            let Some(compliance) = truth.of(&finding.effect, &finding.at) else { continue };
            for (_, estimates) in &finding.parameters {
                let stiffness = if compliance > 0.0 { 1.0 / compliance } else { f64::INFINITY };
                estimates.iter().for_each(|own| coverage.add(own.low, own.high, stiffness));
            }
        }
    }
    coverage.check(name);
}
