//! Near designs: a table of designs that are almost as good as the front. It helps if a part of the best design is
//! not in stock.

use super::outcome::by_full_model;
use super::outcome::{Front, Judged, StudyOutcome};
use super::table::front_table;
use crate::catalog::Catalogs;
use crate::pareto::front::rounded;
use crate::pareto::objectives::Objectives;
use crate::report::front_table::FrontTable;
use crate::report::number::{shortest, significant};
use crate::report::picks::choices;
use crate::report::section::PageSection;
use crate::report::supplement::Supplement;
use crate::report::table::{Column, Table};
use crate::report::words::{TERMINAL, wrap};
use crate::search::near::{NearDesigns, Shortfall, Slack, near_designs, worse_by};
use crate::space::design::Evaluated;
use crate::space::design::id_of;
use crate::space::problem::ArmProblem;
use serde_json::{Value, json};
use std::collections::{BTreeMap, HashSet};
use std::sync::atomic::AtomicBool;

/// Name of the file that lists the near designs.
pub(crate) const FILE: &str = "near.csv";
/// Key of the near designs in `run.json`.
pub(crate) const KEY: &str = "within";

/// The designs near a front, with the extent of the list.
#[derive(Debug, Clone, PartialEq)]
pub struct NearFront {
    /// Slack: the largest shortfall of a near design, as a fraction.
    pub slack: f64,
    /// The near designs, nearest first, with every choice, objective and margin. Further columns have the shortfall,
    /// the nearest design of the front, by how much each objective is worse, and the parts that may be exchanged.
    pub table: FrontTable,
    /// Number of near designs, including those that are not listed; `None` if they were not counted.
    pub total: Option<u64>,
    /// Whether near designs are missing from the table because the number of its rows is limited.
    pub capped: bool,
}

/// The reason why there is no list of near designs although the user asks for one.
pub const NO_NEAR: &str = "Near designs are not listed: they are listed only if the front is complete and has all ties as rows. A longer \
                       time limit, a gap of 0 % or tighter constraints help.";

/// Finds the near designs of an exhaustive search, by a second search of the same space. `slack` says how much worse
/// they may be. `None` if the user stopped it.
pub fn near_front(
    problem: &ArmProblem,
    catalogs: &Catalogs,
    outcome: &StudyOutcome,
    slack: Slack,
    stop: &AtomicBool,
) -> Option<NearFront> {
    // the full model may have removed candidates of the sweep from the front; they may be near designs, so only the
    // designs that stayed on the front count as the front here
    let numbers: HashSet<u128> = outcome.front.iter().map(|j| j.design.number).collect();
    let on_front: Vec<_> =
        outcome.sweep.front.iter().filter(|c| numbers.contains(&c.number)).copied().collect();
    let found = near_designs(problem, &problem.space().constraints, &on_front, slack, stop)?;
    Some(NearFront::of(problem, catalogs, &outcome.front, &found, slack))
}

impl NearFront {
    /// Evaluates the near designs with the full model, and makes the table. `found` is the result of the search for
    /// them. Designs that are not near by the full model are left out.
    pub fn of(
        problem: &ArmProblem,
        catalogs: &Catalogs,
        front: &Front,
        found: &NearDesigns,
        slack: Slack,
    ) -> Self {
        let judged = by_full_model(problem, found.nearest.iter().map(|n| n.candidate.number).collect());
        let shortfall = Shortfall::of(front.iter().map(|j| j.design.objectives));
        let near: Vec<(f64, Evaluated)> = judged
            .into_values()
            .filter_map(|d| Some((shortfall.within(slack.part, &d.objectives)?, d)))
            .collect();
        let left_out = (found.nearest.len() - near.len()) as u64;
        Self {
            slack: slack.part,
            capped: found.total.is_none_or(|total| total > found.nearest.len() as u64),
            total: found.total.map(|total| total - left_out),
            table: table(problem, catalogs, front, near),
        }
    }
}

/// The three objectives of a design, rounded to twelve digits, as bit patterns. Designs for which these are equal count
/// as ties.
fn key(o: &Objectives) -> [u64; 3] {
    o.minimized().map(|x| rounded(x).to_bits())
}

/// Groups near designs with equal objectives. Each item of `near` is the shortfall and the design. The group with the
/// smallest shortfall comes first.
fn grouped(near: Vec<(f64, Evaluated)>) -> Vec<Vec<(f64, Evaluated)>> {
    let mut groups: BTreeMap<[u64; 3], Vec<(f64, Evaluated)>> = BTreeMap::new();
    for (shortfall, design) in near {
        groups.entry(key(&design.objectives)).or_default().push((shortfall, design));
    }
    let mut groups: Vec<Vec<(f64, Evaluated)>> = groups.into_values().collect();
    groups.iter_mut().for_each(|group| group.sort_by_key(|(_, d)| d.number));
    groups.sort_by(|a, b| a[0].0.total_cmp(&b[0].0).then(a[0].1.number.cmp(&b[0].1.number)));
    groups
}

fn table(
    problem: &ArmProblem,
    catalogs: &Catalogs,
    front: &Front,
    near: Vec<(f64, Evaluated)>,
) -> FrontTable {
    let groups = grouped(near);
    let members = groups.iter().enumerate().flat_map(|(g, group)| group.iter().map(move |d| (g + 1, d)));
    let as_front: Front =
        members.clone().map(|(tie_group, (_, d))| Judged { design: d.clone(), tie_group }).collect();
    let mut table = front_table(problem, catalogs, &as_front);
    let words: Vec<Vec<String>> = (0..table.rows.len()).map(|row| choices(&table, row)).collect();
    let mut first = 0;
    for group in &groups {
        let rows = first..first + group.len();
        for ((shortfall, design), row) in group.iter().zip(rows.clone()) {
            let (neighbour, worse) = nearest(front, &design.objectives);
            let swaps = rows.clone().filter_map(|other| {
                Some(format!("{} ({})", only_difference(&words[row], &words[other])?, table.rows[other][0]))
            });
            let swaps = swaps.collect::<Vec<_>>().join("; ");
            let [deflection, mass, mode] = worse.map(|part| shortest(100.0 * part));
            let near_to = id_of(problem.whole_number(neighbour));
            table.rows[row].extend([shortest(100.0 * shortfall), near_to, deflection, mass, mode, swaps]);
        }
        first += group.len();
    }
    table.columns.extend(
        [
            "shortfall_percent",
            "near_to",
            "tip_deflection_worse_percent",
            "mass_worse_percent",
            "lowest_mode_worse_percent",
            "interchangeable",
        ]
        .map(String::from),
    );
    table
}

/// The number of the design of the front that is nearest to `design`, and the fractions by which `design` is worse in
/// deflection, mass and lowest mode. The nearest design is the one for which the largest of the three fractions is
/// smallest. Of equally near designs it is the one with the smallest differences.
fn nearest(front: &Front, design: &Objectives) -> (u128, [f64; 3]) {
    let shortfall = |worse: &[f64; 3]| worse.iter().fold(0.0f64, |most, part| most.max(*part));
    let apart = |worse: &[f64; 3]| worse.iter().fold(0.0f64, |most, part| most.max(part.abs()));
    let all = front.iter().map(|j| (j.design.number, worse_by(design, &j.design.objectives)));
    all.min_by(|(m, a), (n, b)| {
        shortfall(a).total_cmp(&shortfall(b)).then(apart(a).total_cmp(&apart(b))).then(m.cmp(n))
    })
    .unwrap_or_default()
}

/// The entry of `other` that differs from the entry of `one` at the same place, if exactly one entry differs; otherwise
/// `None`. Entries are the choices of a design in words.
fn only_difference<'w>(one: &[String], other: &'w [String]) -> Option<&'w str> {
    let mut different = one.iter().zip(other).filter(|(a, b)| a != b);
    let (_, word) = different.next()?;
    different.next().is_none().then_some(word)
}

/// Number of near designs that an HTML page lists.
const DESIGNS_LISTED: usize = 12;

impl NearFront {
    /// Sentences about the near designs for summaries and the terminal.
    pub fn sentences(&self) -> Vec<String> {
        let percent = shortest((100.0 * self.slack * 1e9).round() / 1e9);
        let groups = self.tied_groups();
        let mut out = vec![match self.total {
            Some(0) => format!("No design off the front is within {percent} % of it."),
            Some(n) => format!(
                "Within {percent} % of the front: {n} designs that are not on it, nearest first in near.csv."
            ),
            None => {
                format!("Within {percent} % of the front there are more designs than near.csv lists.")
            }
        }];
        if self.capped {
            out.push(format!(
                "Only the nearest {} are listed; --within-most sets how many.",
                self.table.rows.len()
            ));
        }
        if groups > 0 {
            out.push(format!(
                "{groups} groups of these designs have equal objectives; the column interchangeable lists the parts that may be exchanged."
            ));
        }
        out
    }

    /// Number of sets of near designs with equal objectives. Sets of a single design do not count.
    fn tied_groups(&self) -> usize {
        let Some(column) = self.table.column("tie_group") else { return 0 };
        let groups: Vec<&str> = self.table.rows.iter().map(|r| r[column].as_str()).collect();
        groups.chunk_by(|a, b| a == b).filter(|group| group.len() > 1).count()
    }

    /// Everything that a result reports about near designs: file, sections, entry of `run.json`, terminal text.
    pub fn supplement(&self) -> Supplement {
        Supplement {
            file: Some((FILE, self.table.to_csv())),
            markdown: self.to_markdown(),
            section: Some(self.section()),
            run: Some((KEY, self.to_json())),
            terminal: self.sentences().iter().map(|s| wrap(s, TERMINAL, "")).collect(),
        }
    }

    /// The entry on near designs in `run.json`.
    fn to_json(&self) -> Value {
        json!({
            "slack_percent": 100.0 * self.slack,
            "designs": self.total,
            "listed": self.table.rows.len(),
            "capped": self.capped,
        })
    }

    /// The section on near designs for the HTML page: sentences, and a table of the nearest designs.
    pub fn section(&self) -> PageSection {
        let words = [("design_id", "design"), ("near_to", "near to")];
        let numbers = [
            ("shortfall_percent", "worse by at most [%]"),
            ("tip_deflection_mm", "tip [mm]"),
            ("mass_kg", "mass [kg]"),
            ("lowest_mode_hz", "mode [Hz]"),
        ];
        let headers = words.map(|(_, header)| Column::left(header)).into_iter();
        let mut nearest = Table::new(headers.chain(numbers.map(|(_, h)| Column::right(h))).collect());
        let cell = |row: &[String], name: &str| self.table.column(name).map_or("", |c| &row[c]).to_string();
        for row in self.table.rows.iter().take(DESIGNS_LISTED) {
            let number = |(name, _): (&str, &str)| {
                let cell = cell(row, name);
                cell.parse().map_or(cell, |x| significant(x, 4))
            };
            let named = words.map(|(name, _)| cell(row, name)).into_iter();
            nearest.row(named.chain(numbers.map(number)));
        }
        let some = !self.table.rows.is_empty();
        PageSection {
            title: "Near the front".into(),
            words: self.sentences(),
            tables: some.then(|| ("The nearest; near.csv has all".into(), nearest)).into_iter().collect(),
            figures: Vec::new(),
        }
    }

    /// The section on near designs for the Markdown summary.
    pub fn to_markdown(&self) -> String {
        let lines: Vec<String> = self.sentences().iter().map(|s| format!("- {s}\n")).collect();
        format!("\n## Near the front\n\n{}", lines.concat())
    }
}
