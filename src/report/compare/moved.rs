//! What changed between two runs of a study: designs that stayed, entered and left, and how the best values
//! changed.

use super::contender::Contender;
use crate::report::front_table::{FrontTable, OBJECTIVE_COLUMNS};
use crate::report::number::percent_rounded;
use crate::report::picks::{BEST, Objective, best, designs};
use crate::report::words::capital;
use serde::Serialize;
use std::collections::HashMap;

/// The changes from one front to another.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Moved {
    /// Label of the earlier front.
    pub from: String,
    /// Label of the later front.
    pub to: String,
    /// Number of designs (equal in every choice) that are on both fronts with the same objectives.
    pub unchanged: usize,
    /// Number of designs on both fronts whose objectives differ, because they were evaluated again with other numbers.
    pub judged_anew: usize,
    /// Number of designs that are only on the later front.
    pub came: usize,
    /// Number of designs that are only on the earlier front.
    pub went: usize,
    /// The changes in sentences.
    pub words: String,
}

/// Compares the front `before` with the front `after` of the same study.
pub fn moved(before: &Contender, after: &Contender) -> Moved {
    let (old, new) = (by_choice(&before.front), by_choice(&after.front));
    let shared = || new.iter().filter_map(|(key, row)| Some((row, old.get(key)?)));
    let unchanged = shared().filter(|(a, b)| a == b).count();
    let both = shared().count();
    let mut moved = Moved {
        from: before.label.clone(),
        to: after.label.clone(),
        unchanged,
        judged_anew: both - unchanged,
        came: new.len() - both,
        went: old.len() - both,
        words: String::new(),
    };
    moved.words = words(&moved, before, after);
    moved
}

/// A map with one entry for each design of a front, as texts of the table. The key is the choices of the design, and
/// the value is its objectives. If the table has no choices, the key is the name of the design.
fn by_choice(front: &FrontTable) -> HashMap<Vec<&str>, Vec<&str>> {
    let objectives: Vec<usize> = OBJECTIVE_COLUMNS.iter().filter_map(|c| front.column(c)).collect();
    let first = objectives.iter().copied().min().unwrap_or(0);
    let name = front.column("design_id");
    let chosen: Vec<usize> = (0..first).filter(|i| Some(*i) != name).collect();
    let key = if chosen.is_empty() { name.into_iter().collect() } else { chosen };
    front.rows.iter().map(|row| (pick(row, &key), pick(row, &objectives))).collect()
}

fn pick<'a>(row: &'a [String], columns: &[usize]) -> Vec<&'a str> {
    columns.iter().map(|c| row[*c].as_str()).collect()
}

fn words(moved: &Moved, before: &Contender, after: &Contender) -> String {
    let counts = format!(
        "From {} to {}: {} designs unchanged, {} judged anew, {} came, {} went.",
        moved.from, moved.to, moved.unchanged, moved.judged_anew, moved.came, moved.went
    );
    let (old, new) = (designs(&before.front), designs(&after.front));
    let changes = BEST
        .into_iter()
        .filter_map(|(name, o)| Some(change(name, o, o.of(best(o, &old)?), o.of(best(o, &new)?))));
    let changes: Vec<String> = changes.collect();
    if changes.is_empty() { counts } else { format!("{counts} {}.", capital(&changes.join("; "))) }
}

fn change(name: &str, objective: Objective, old: f64, new: f64) -> String {
    if old == new {
        return format!("{name} still {}", objective.amount(new));
    }
    let percent = 100.0 * (new / old - 1.0);
    let sign = if percent > 0.0 { "+" } else { "" };
    format!(
        "{name} {} to {} ({sign}{})",
        objective.amount(old),
        objective.amount(new),
        percent_rounded(percent, 2)
    )
}
