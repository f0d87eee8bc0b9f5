//! Finding fault with a finished front.

use super::Study;
use super::outcome::{Front, judge};
use super::table::front_table;
use crate::catalog::Catalogs;
use crate::report::front_table::FrontTable;
use crate::search::design::{Evaluated, id_of, number, number_of, options};
use crate::search::exact::{self, Exact};
use crate::search::front::nondominated;
use crate::search::sweep::Candidate;
use crate::search::{ArmProblem, Objectives, OutwardIn, evaluate, witness};
use std::collections::{BTreeSet, HashMap, HashSet};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// Largest relative difference of a number in a row from what the full model gives.
const AGREE: f64 = 1e-9;
/// Faults of one kind that are listed one by one.
const LISTED: usize = 10;

/// What a check of a front found.
#[derive(Debug, Clone, PartialEq)]
pub struct FrontCheck {
    /// What is wrong, in words; empty if nothing is.
    pub faults: Vec<String>,
    /// Rows checked.
    pub rows: usize,
    /// How it was settled that no design is missing but those among the faults; if it was not, why.
    pub completeness: Result<Completeness, String>,
}

/// A look at all designs that came to its end.
#[derive(Debug, Clone, PartialEq)]
pub struct Completeness {
    /// Boxes bounded.
    pub boxes: u64,
    /// Why the exact search's own bounds were used; `None` if it was by bounds that share no code with them.
    pub by_exact_search: Option<String>,
}

/// Checks a front against its study: every row by the full model, rows against each other, and, unless
/// `claims_all` is false, all other designs by a search that starts from the rows.
pub fn check_front(
    study: &Study,
    catalogs: &Catalogs,
    table: &FrontTable,
    claims_all: bool,
    stop: &AtomicBool,
    deadline: Option<Instant>,
) -> FrontCheck {
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
        return FrontCheck { faults, rows: table.rows.len(), completeness: Err("no row is a design".into()) };
    };
    let problem = ArmProblem::new(&space, catalogs);
    let candidates: Vec<Candidate> = known.iter().filter_map(|&n| candidate(&problem, n)).collect();
    let front = judge(&problem, &candidates);
    compare_rows(&front_table(&problem, catalogs, &front), table, &front, &problem, &mut faults);
    broken_limits(study, &front, &problem, &mut faults);
    let completeness = if claims_all {
        let (found, completeness) = look_for_missing(study, catalogs, &front, stop, deadline);
        list(&mut faults, missing(study, catalogs, &front, &problem, &found), "designs are missing");
        completeness
    } else {
        Err("the run was stopped early and claims no more than its rows".into())
    };
    FrontCheck { faults, rows: table.rows.len(), completeness }
}

/// Numbers of designs that may be missing, and whether the look at all designs came to its end.
type Look = (Vec<u128>, Result<Completeness, String>);

/// Looks at all designs beside a front, by bounds that share no code with the exact search's where they can.
fn look_for_missing(
    study: &Study,
    catalogs: &Catalogs,
    front: &Front,
    stop: &AtomicBool,
    deadline: Option<Instant>,
) -> Look {
    let objectives: Vec<Objectives> = front.iter().map(|d| d.design.objectives).collect();
    let unseen = witness::conditions(&study.space).err();
    let (numbers, boxes, open) = match unseen {
        None => {
            let looked = witness::missing(&study.space, catalogs, &objectives, stop, deadline);
            (looked.candidates, looked.boxes, looked.open)
        }
        Some(_) => {
            if let Err(why) = exact::conditions(&study.space) {
                let why = format!("the exact search does not see this study as it is: {why}");
                return (Vec::new(), Err(why));
            }
            let found = Exact::new(&study.space, catalogs, stop, deadline).run(&objectives);
            (found.front.iter().map(|c| c.number).collect(), found.boxes, found.boxes_open)
        }
    };
    let completeness = match open {
        0 => Ok(Completeness { boxes, by_exact_search: unseen }),
        open => Err(format!("stopped with {open} boxes unopened")),
    };
    (numbers, completeness)
}

fn candidate(problem: &ArmProblem, whole: u128) -> Option<Candidate> {
    let options = problem.options_of_whole(whole)?;
    let number = number(problem.level_sizes(), &options);
    let objectives = Objectives { tip_deflection_m: 0.0, mass_kg: 0.0, lowest_mode_hz: 0.0 };
    Some(Candidate { number, objectives })
}

/// Every row against what it should be.
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
        (Ok(a), Ok(b)) => (a - b).abs() <= AGREE * b.abs(),
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

/// Designs found by a search that belong on the front and are not in it.
fn missing(
    study: &Study,
    catalogs: &Catalogs,
    front: &Front,
    problem: &ArmProblem,
    found: &[u128],
) -> Vec<String> {
    let listed: BTreeSet<u128> = front.iter().map(|d| problem.whole_number(d.design.number)).collect();
    let others: Vec<u128> = found.iter().copied().filter(|n| !listed.contains(n)).collect();
    let Some(space) = study.space.excerpt(catalogs, &others) else { return Vec::new() };
    let beyond = ArmProblem::new(&space, catalogs);
    let judged: Vec<(u128, Evaluated)> = others
        .iter()
        .filter_map(|&whole| Some((whole, evaluate(&beyond, candidate(&beyond, whole)?.number)?)))
        .collect();
    let own = front.iter().map(|d| d.design.objectives.minimized());
    let points: Vec<[f64; 3]> = own.chain(judged.iter().map(|(_, d)| d.objectives.minimized())).collect();
    let mut ids: Vec<u128> = nondominated(&points)
        .expect("objectives are numbers")
        .into_iter()
        .flatten()
        .filter_map(|i| i.checked_sub(front.len()))
        .map(|i| judged[i].0)
        .collect();
    ids.sort_unstable();
    ids.into_iter().map(|n| format!("design {} belongs on the front and is not there", id_of(n))).collect()
}

/// The first few of many faults, and how many there are.
fn list(faults: &mut Vec<String>, found: Vec<String>, what: &str) {
    let more = found.len().saturating_sub(LISTED);
    faults.extend(found.into_iter().take(LISTED));
    if more > 0 {
        faults.push(format!("and {more} more {what}"));
    }
}
