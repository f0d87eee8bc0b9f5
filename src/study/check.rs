//! Checks a finished front for faults: wrong rows, and missing designs.

use super::definition::Study;
use super::outcome::{Front, judge};
use super::question::{number_of_picks, picks, question, words};
use super::table::front_table;
use super::ties::ties;
use crate::catalog::Catalogs;
use crate::exact::run::Exact;
use crate::pareto::front::nondominated;
use crate::pareto::objectives::Objectives;
use crate::report::front_table::FrontTable;
use crate::report::number::significant;
use crate::search::resume::Resume;
use crate::search::sweep::Candidate;
use crate::space::design::{id_of, number, number_of, options};
use crate::space::levels::OutwardIn;
use crate::space::problem::ArmProblem;
use crate::verify::judge::{Judge, Judged, Pick};
use crate::verify::ledger::Ledger;
use crate::verify::missing::conditions;
use crate::verify::settings::Settings;
use rayon::prelude::*;
use std::collections::{BTreeSet, HashMap, HashSet};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// Relative allowance for rounding when a gap is claimed.
const ROUNDING: f64 = 1e-6;
/// Largest relative difference that is allowed between an objective that a row states and the same objective by the
/// full model.
const AGREEMENT: f64 = 1e-9;
/// Of the missing designs that differ from one another by less than this fraction of the claimed gap, the search for
/// missing designs reports only one.
const PART_OF_GAP: f64 = 0.45;
/// Largest number of faults of one kind that are listed one by one.
const FAULTS_LISTED: usize = 10;

/// The result of checking a finished front.
#[derive(Debug, Clone, PartialEq)]
pub struct FrontCheck {
    /// The faults, in words; empty if the front is correct.
    pub faults: Vec<String>,
    /// Number of rows that were checked.
    pub rows: usize,
    /// How it was proved that no design is missing except those among the faults, or the reason why it was not
    /// proved.
    pub completeness: Result<Completeness, String>,
}

/// Facts of a completed search for missing designs.
#[derive(Debug, Clone, PartialEq)]
pub struct Completeness {
    /// Number of boxes that were bounded.
    pub boxes: u64,
    /// The gap that was proved: for every design of the study some row is worse by at most this fraction in each
    /// objective. 0 means that no design is missing.
    pub gap: f64,
    /// The reason why the bounds of the exact search itself had to be used; `None` if independent bounds were used.
    pub by_exact_search: Option<String>,
}

/// A finished front, and the claims about it that are checked.
#[derive(Debug, Clone, Copy)]
pub struct Claim<'t> {
    /// The rows of the front.
    pub table: &'t FrontTable,
    /// The claimed gap: for every design of the study some row is worse by at most this fraction in each objective. 0
    /// claims the whole front; `None` claims nothing.
    pub gap: Option<f64>,
    /// Whether every design has a row even if it differs from another only in drives of equal mass and torsion curve.
    pub ties_listed: bool,
    /// The content of `ties.csv`. If `ties_listed` is false, this file lists the drives of equal mass and torsion curve
    /// that may replace each other.
    pub ties_csv: &'t [u8],
}

/// Checks a front against its study. The objectives of every row are computed again by the full model, and a row that
/// another row dominates is a fault. Then a search that starts from the rows looks for missing designs.
pub fn check_front(
    study: &Study,
    catalogs: &Catalogs,
    claim: &Claim,
    stop: &AtomicBool,
    deadline: Option<Instant>,
) -> FrontCheck {
    let until = (stop, deadline);
    // the only error is a state of another search, and no state is given here
    resume_check(study, catalogs, claim, until, None).unwrap_or_else(|why| FrontCheck {
        faults: Vec::new(),
        rows: 0,
        completeness: Err(why),
    })
}

/// As [`check_front`], but continues the search for missing designs from the state in `resume`, and saves its own
/// states there.
///
/// # Errors
/// A message if the saved state belongs to another search.
pub fn resume_check(
    study: &Study,
    catalogs: &Catalogs,
    Claim { table, gap, ties_listed, ties_csv }: &Claim,
    until: (&AtomicBool, Option<Instant>),
    resume: Option<Resume>,
) -> Result<FrontCheck, String> {
    let mut faults = Vec::new();
    let ids: Vec<&str> = table.rows.iter().map(|row| row[0].as_str()).collect();
    let sizes = study.space.level_sizes(catalogs);
    let numbers: BTreeSet<u128> = ids.iter().filter_map(|id| number_of(id)).collect();
    let (known, unknown) = numbers.iter().partition::<Vec<u128>, _>(|n| options(&sizes, **n).is_some());
    let strange = ids.iter().filter(|id| number_of(id).is_none_or(|n| unknown.contains(&n)));
    faults.extend(strange.map(|id| format!("design_id {id}: the study has no such design")));
    if known.len() + unknown.len() < ids.len() {
        faults.push("a design_id is there twice, or is none".into());
    }
    let Some(space) = study.space.excerpt(catalogs, &known) else {
        let completeness = Err("no row is a design".into());
        return Ok(FrontCheck { faults, rows: table.rows.len(), completeness });
    };
    let problem = ArmProblem::new(&space, catalogs);
    let candidates: Vec<Candidate> = known.iter().filter_map(|&n| candidate(&problem, n)).collect();
    let front = judge(&problem, &candidates);
    compare_rows(&front_table(&problem, catalogs, &front), table, &front, &problem, &mut faults);
    broken_limits(study, &front, &problem, &mut faults);
    let question = question(&study.space);
    let judge = Judge::new(&question, catalogs);
    let rows: Vec<Row> = front
        .iter()
        .filter_map(|design| Some(Row { design, picks: picks(&problem, catalogs, design.design.number)? }))
        .collect();
    judge_rows(&judge, &rows, &problem, &mut faults);
    if !ties_listed {
        list(&mut faults, ties(&problem, &front).faults_of(ties_csv), "ties are wrong");
    }
    let completeness = match gap {
        Some(gap) => {
            let front = Claimed { front: &front, gap: *gap, ties_listed: *ties_listed };
            let look = look_for_missing(study, &judge, catalogs, &front, until, resume)?;
            let missing = missing(study, &judge, catalogs, &front, (&problem, &rows), &look.designs);
            list(&mut faults, missing, "designs are missing");
            if *ties_listed && look.lacks_ties {
                faults.push(
                    "the run claims that its rows include all ties, but there are ties that are not rows"
                        .into(),
                );
            }
            look.completeness
        }
        None => Err("the run was stopped early and claims no more than its rows".into()),
    };
    Ok(FrontCheck { faults, rows: table.rows.len(), completeness })
}

/// The design that a row of a front states. `picks` are its parts as the verifier names them, by their places in
/// catalogs and in the study's lists.
struct Row<'f> {
    design: &'f super::outcome::Judged,
    picks: Vec<Pick>,
}

/// A front with the gap that it claims.
struct Claimed<'f> {
    front: &'f Front,
    gap: f64,
    ties_listed: bool,
}

impl Claimed<'_> {
    /// The objectives of the rows, improved by the claimed gap. A design is missing from the front if none of these
    /// dominates it.
    fn objectives(&self) -> Vec<Objectives> {
        let by = if self.gap > 0.0 { 1.0 + self.gap + ROUNDING } else { 1.0 };
        self.front.iter().map(|d| d.design.objectives.better_by(by)).collect()
    }
}

/// The result of the search for missing designs.
struct Look {
    /// Designs that may be missing from the front.
    designs: Vec<Judged>,
    /// Facts of the search if it was completed, else the reason why not.
    completeness: Result<Completeness, String>,
    /// Whether designs with equal objectives were left out of `designs`, because there are too many.
    lacks_ties: bool,
}

/// Searches for designs that are missing from the front. It uses bounds that `verify` computes without the code of the
/// search, if they cover the study. Otherwise it uses the bounds of the exact search.
fn look_for_missing(
    study: &Study,
    judge: &Judge,
    catalogs: &Catalogs,
    front: &Claimed,
    until: (&AtomicBool, Option<Instant>),
    resume: Option<Resume>,
) -> Result<Look, String> {
    let (stop, deadline) = until;
    let unseen = conditions(judge.question()).err();
    let (designs, boxes, open, lacks_ties) = match unseen {
        None => {
            let settings = Settings { apart: PART_OF_GAP * front.gap, ..Default::default() };
            let keep = |state: &dyn Fn() -> Vec<u8>| {
                let due = resume.filter(|resume| resume.keeper.is_due());
                due.into_iter().for_each(|resume| resume.keeper.keep(&state()));
            };
            let ledger = match resume {
                Some(Resume { from, .. }) => Ledger::resumed(from, &keep)?,
                None => Ledger::default(),
            };
            let looked = judge.missing_since(&ledger, &front.objectives(), settings, until);
            let lacks_ties = front.gap == 0.0 && !looked.ties_listed;
            (looked.candidates, looked.boxes, looked.open, lacks_ties)
        }
        Some(_) => {
            let rows: Vec<Objectives> = front.front.iter().map(|d| d.design.objectives).collect();
            let search = Exact::new(&study.space, catalogs, stop, deadline).to_gap(front.gap);
            let search = match resume {
                Some(resume) => search.resumed(resume)?,
                None => search,
            };
            let found = search.run(&rows);
            let numbers: Vec<u128> = found.front.iter().map(|c| c.number).collect();
            let designs = judged(study, judge, catalogs, &numbers);
            (designs, found.boxes, found.boxes_open, front.gap == 0.0 && !found.ties_listed)
        }
    };
    let completeness = match open {
        0 => Ok(Completeness { boxes, gap: front.gap, by_exact_search: unseen }),
        open => Err(format!("stopped with {open} boxes or regions unopened")),
    };
    Ok(Look { designs, completeness, lacks_ties })
}

/// Evaluates the designs with these numbers by the verifier's own model. The numbers are those of the whole study.
/// Designs that do not meet their limits by this model are left out.
fn judged(study: &Study, judge: &Judge, catalogs: &Catalogs, numbers: &[u128]) -> Vec<Judged> {
    let Some(space) = study.space.excerpt(catalogs, numbers) else { return Vec::new() };
    let problem = ArmProblem::new(&space, catalogs);
    let design = |&whole: &u128| judge.judge(&picks(&problem, catalogs, candidate(&problem, whole)?.number)?);
    numbers.iter().filter_map(design).collect()
}

/// Checks every row with the verifier's own drives, thresholds and model: the design must meet its limits and have the
/// objectives that the row states. Faults are added to `faults`.
fn judge_rows(judge: &Judge, rows: &[Row], problem: &ArmProblem, faults: &mut Vec<String>) {
    let fault = |row: &Row| {
        let id = id_of(problem.whole_number(row.design.design.number));
        let Some(Judged { objectives, .. }) = judge.judge(&row.picks) else {
            return Some(format!("design {id}: by the check's own drives and thresholds it does not hold"));
        };
        let told = row.design.design.objectives.minimized();
        let differs =
            told.iter().zip(objectives.minimized()).any(|(a, b)| (a - b).abs() > AGREEMENT * b.abs());
        differs.then(|| format!("design {id}: the check's own arm gives {objectives:?}"))
    };
    let found: Vec<String> = rows.par_iter().filter_map(fault).collect();
    list(faults, found, "rows do not hold, or have other objectives");
}

fn candidate(problem: &ArmProblem, whole: u128) -> Option<Candidate> {
    let options = problem.options_of_whole(whole)?;
    let number = number(problem.level_sizes(), &options);
    let objectives = Objectives { tip_deflection_m: 0.0, mass_kg: 0.0, lowest_mode_hz: 0.0 };
    Some(Candidate { number, objectives })
}

/// Compares every row of `table` with the row in `expected`, which the full model gives for the same design. Designs
/// that others dominate, so that they are not in `front`, are faults too.
fn compare_rows(
    expected: &FrontTable,
    table: &FrontTable,
    front: &Front,
    problem: &ArmProblem,
    faults: &mut Vec<String>,
) {
    let mut found = Vec::new();
    let on_front: HashSet<u128> = front.iter().map(|d| problem.whole_number(d.design.number)).collect();
    let expected_rows: HashMap<&str, &Vec<String>> =
        expected.rows.iter().map(|row| (row[0].as_str(), row)).collect();
    for row in &table.rows {
        let is_on_front = number_of(&row[0]).is_some_and(|number| on_front.contains(&number));
        let right = expected_rows.get(row[0].as_str()).filter(|_| is_on_front);
        let Some(right) = right else {
            found.push(format!("design {}: does not hold, or another row beats it", row[0]));
            continue;
        };
        for (name, value) in table.columns.iter().zip(row) {
            let Some(column) = expected.columns.iter().position(|c| c == name) else { continue };
            if name != "tie_group" && !agree(value, &right[column]) {
                found
                    .push(format!("design {}: {name} is {value}, the model gives {}", row[0], right[column]));
            }
        }
    }
    list(faults, found, "cells or rows are wrong");
}

fn agree(a: &str, b: &str) -> bool {
    match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() <= AGREEMENT * b.abs(),
        _ => a == b,
    }
}

fn broken_limits(study: &Study, front: &Front, problem: &ArmProblem, faults: &mut Vec<String>) {
    let breaks = |o: &Objectives| study.space.constraints.broken(o).contains(&true);
    let broken = front.iter().filter(|d| breaks(&d.design.objectives));
    let ids = broken.map(|d| id_of(problem.whole_number(d.design.number)));
    list(
        faults,
        ids.map(|id| format!("design {id}: breaks a constraint")).collect(),
        "designs break a constraint",
    );
}

/// The designs among `found` that are missing: they belong on the front, but are neither on it nor close enough to one
/// of its rows. Each is described in a sentence.
fn missing(
    study: &Study,
    judge: &Judge,
    catalogs: &Catalogs,
    claimed: &Claimed,
    (problem, rows): (&ArmProblem, &[Row]),
    found: &[Judged],
) -> Vec<String> {
    let listed: HashSet<&[Pick]> = rows.iter().map(|row| &row.picks[..]).collect();
    let others: Vec<&Judged> = found.iter().filter(|d| !listed.contains(&d.picks[..])).collect();
    let own = claimed.objectives().into_iter().map(|o| o.minimized());
    let points: Vec<[f64; 3]> = own.chain(others.iter().map(|d| d.objectives.minimized())).collect();
    // designs with equal objectives need no row of their own if ties are listed separately
    let behind: HashSet<Vec<Pick>> = match claimed.ties_listed {
        true => HashSet::new(),
        false => rows.iter().map(|row| judge.first_tie(&row.picks)).collect(),
    };
    let sizes = study.space.level_sizes(catalogs);
    let name = |design: &Judged| {
        let number = number_of_picks(problem, catalogs, &sizes, &design.picks);
        let words = || words(&study.space, catalogs, &design.picks);
        (number.is_none(), number, number.map_or_else(words, id_of))
    };
    let mut names: Vec<(bool, Option<u128>, String)> = nondominated(&points)
        .expect("objectives are numbers")
        .into_iter()
        .flatten()
        .filter_map(|i| i.checked_sub(claimed.front.len()))
        .map(|i| others[i])
        .filter(|design| behind.is_empty() || !behind.contains(&judge.first_tie(&design.picks)))
        .map(name)
        .collect();
    names.sort_unstable();
    let what = match claimed.gap > 0.0 {
        true => {
            format!("is not there, and no row comes within {} % of it", significant(1e2 * claimed.gap, 3))
        }
        false => "belongs on the front and is not there".into(),
    };
    let sentence = |(is_unknown, _, name): (bool, Option<u128>, String)| match is_unknown {
        true => format!("a design that the search's tables lack ({name}) {what}"),
        false => format!("design {name} {what}"),
    };
    names.into_iter().map(sentence).collect()
}

/// Appends the first few of the faults `found` to `faults`, and then the number of the others. `what` are words for
/// these faults, in the plural.
fn list(faults: &mut Vec<String>, found: Vec<String>, what: &str) {
    let more = found.len().saturating_sub(FAULTS_LISTED);
    faults.extend(found.into_iter().take(FAULTS_LISTED));
    if more > 0 {
        faults.push(format!("and {more} more {what}"));
    }
}
