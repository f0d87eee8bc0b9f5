//! A comparison of fronts as text tables, Markdown and CSV.

use super::comparison::{Answer, Comparison, Reach, Row};
use super::question::Question;
use crate::report::number::{cost_words, shortest, significant};
use crate::report::picks::{Design, Objective};
use crate::report::table::{Column, Table, csv_line};
use crate::report::words::{TERMINAL, wrap};

/// Labels longer than this are shortened in text tables \[characters\].
const LONGEST_LABEL: usize = 24;

impl Comparison {
    /// A table of the best value of each objective that each front reaches, without any limit.
    pub fn reach_table(&self) -> Table {
        reach_table(&self.reach, &self.labels())
    }

    /// A table of the answers to a question, with one column per limit.
    pub fn table(&self, question: Question) -> Table {
        let rows: Vec<&Row> = self.rows.iter().filter(|r| r.question == question).collect();
        table(&rows, &self.labels())
    }

    /// The explanation of the star before a number. `None` for a single front, whose numbers have no star.
    pub(crate) fn star_words(&self) -> Option<&'static str> {
        (self.reach.len() > 1)
            .then_some("A star (*) marks the best value of its column among the compared fronts.")
    }

    /// Tables and sentences, at most 80 columns wide. Long labels are shortened.
    pub fn to_text(&self) -> String {
        let labels = short_labels(&self.labels());
        let mut out =
            format!("{SHORT_REACH_TITLE}\n{}", indent(&short_reach_table(&self.reach, &labels).to_text()));
        if let Some(legend) = self.star_words() {
            out.push_str(&format!("  {legend}\n"));
        }
        for question in Question::ALL {
            let rows: Vec<&Row> = self.rows.iter().filter(|r| r.question == question).collect();
            if rows.is_empty() {
                continue;
            }
            out.push_str(&format!("\n{}\n", title(question)));
            for group in groups(&rows, &labels) {
                out.push_str(&indent(&table(&group, &labels).to_text()));
                out.push('\n');
            }
            for row in rows {
                out.push_str(&item(&row.sentence));
                let missed = out_of_reach(row, &labels);
                out.push_str(&if missed.is_empty() { missed } else { item(&missed) });
            }
        }
        for moved in &self.moved {
            out.push_str(&format!("\n{}", wrap(&moved.words, TERMINAL, "")));
        }
        if !self.remarks.is_empty() {
            out.push('\n');
            self.remarks.iter().for_each(|words| out.push_str(&wrap(words, TERMINAL, "")));
        }
        out
    }

    /// The comparison as a Markdown document with full labels.
    pub fn to_markdown(&self) -> String {
        let labels = self.labels();
        let mut out = format!("# Fronts compared\n\n{REACH_TITLE}.\n\n");
        out.push_str(&reach_table(&self.reach, &labels).to_markdown());
        if let Some(legend) = self.star_words() {
            out.push_str(&format!("\n{legend}\n"));
        }
        for question in Question::ALL {
            let rows: Vec<&Row> = self.rows.iter().filter(|r| r.question == question).collect();
            if rows.is_empty() {
                continue;
            }
            out.push_str(&format!("\n## {}\n\n{}\n", title(question), table(&rows, &labels).to_markdown()));
            for row in rows {
                let missed = out_of_reach(row, &labels);
                let missed = if missed.is_empty() { missed } else { format!(" {missed}") };
                out.push_str(&format!("- {}{missed}\n", row.sentence));
            }
        }
        if !self.moved.is_empty() {
            out.push_str("\n## What moved\n\n");
            self.moved.iter().for_each(|m| out.push_str(&format!("- {}\n", m.words)));
        }
        if !self.remarks.is_empty() {
            out.push_str("\n## Remarks\n\n");
            self.remarks.iter().for_each(|words| out.push_str(&format!("- {words}\n")));
        }
        out
    }

    /// The comparison as CSV, one line per answer. Numbers are in the shortest form that reads back exactly. A
    /// front that cannot meet the limit has `reached` = `no` and the design that comes nearest.
    pub fn to_csv(&self) -> String {
        let columns = [
            "question",
            "limit",
            "limit_unit",
            "front",
            "reference",
            "reached",
            "winner",
            "design_id",
            "tip_deflection_mm",
            "mass_kg",
            "lowest_mode_hz",
            "material_cost_eur",
        ];
        let mut out = csv_line(&columns.map(String::from));
        for reach in &self.reach {
            for (question, design) in [
                ("lightest", &reach.lightest),
                ("stiffest", &reach.stiffest),
                ("highest_mode", &reach.highest_mode),
            ] {
                let head = [question, "", "", &reach.label, yes(reach.reference), yes(design.is_some()), ""];
                out.push_str(&record(head, design.as_ref()));
            }
        }
        for row in &self.rows {
            let (limit, unit) = (shortest(row.limit), row.question.limited().unit());
            for a in &row.answers {
                let flags = [yes(a.reference), yes(a.reached), yes(a.winner)];
                let head = [row.question.word(), &limit, unit, &a.label, flags[0], flags[1], flags[2]];
                out.push_str(&record(head, a.design.as_ref()));
            }
        }
        out
    }

    fn labels(&self) -> Vec<String> {
        self.reach.iter().map(|r| r.label.clone()).collect()
    }
}

const SHORT_REACH_TITLE: &str =
    "The best of each front, with its design: lightest, stiffest, highest lowest mode";

const REACH_TITLE: &str = "The best of each front: lightest [kg], stiffest [mm] and highest lowest mode [Hz], \
                           each with its design\nand material cost [EUR]";

fn title(question: Question) -> &'static str {
    match question {
        Question::LightestAtDeflection => {
            "Lightest at a given tip deflection: mass [kg], design, material cost [EUR]"
        }
        Question::StiffestAtMass => {
            "Stiffest at a given mass: tip deflection [mm], design, material cost [EUR]"
        }
        Question::HighestModeAtMass => {
            "Highest mode at a given mass: lowest mode [Hz], design, material cost [EUR]"
        }
        Question::LightestAtMode => {
            "Lightest for a given lowest mode: mass [kg], design, material cost [EUR]"
        }
    }
}

fn yes(flag: bool) -> &'static str {
    if flag { "yes" } else { "no" }
}

fn record(head: [&str; 7], design: Option<&Design>) -> String {
    let mut cells: Vec<String> = head.map(String::from).into();
    match design {
        Some(d) => {
            cells.push(d.design_id.clone());
            cells.extend(Objective::ALL.map(|o| shortest(o.of(d))));
            cells.push(d.material_cost_eur.map_or(String::new(), shortest));
        }
        None => cells.extend(vec![String::new(); 5]),
    }
    csv_line(&cells)
}

fn reach_table(reach: &[Reach], labels: &[String]) -> Table {
    let mut columns = vec![Column::left("front"), Column::right("designs")];
    for unit in ["kg", "mm", "Hz"] {
        columns.extend([Column::right(unit), Column::left("design"), Column::right("EUR")]);
    }
    let mut table = Table::new(columns);
    for (r, label) in reach.iter().zip(labels) {
        let mut cells = vec![label.clone(), r.designs.to_string()];
        let bests = [
            (Objective::Mass, &r.lightest),
            (Objective::Deflection, &r.stiffest),
            (Objective::Mode, &r.highest_mode),
        ];
        for (objective, best) in bests {
            let marked = !r.reference && is_best(objective, best, reach);
            cells.extend(triple(objective, best.as_ref(), marked));
        }
        table.row(cells);
    }
    table
}

/// The table of the best values of each front, without counts and cost, so that it fits a terminal.
fn short_reach_table(reach: &[Reach], labels: &[String]) -> Table {
    let mut columns = vec![Column::left("front")];
    for unit in ["kg", "mm", "Hz"] {
        columns.extend([Column::right(unit), Column::left("design")]);
    }
    let mut short = Table::new(columns);
    for row in reach_table(reach, labels).rows() {
        short.row([0, 2, 3, 5, 6, 8, 9].map(|i| row[i].clone()));
    }
    short
}

/// Whether `own`, the best design of one front in the objective, has the best value among all competing fronts.
fn is_best(objective: Objective, own: &Option<Design>, reach: &[Reach]) -> bool {
    let of = |r: &Reach| match objective {
        Objective::Mass => r.lightest.clone(),
        Objective::Deflection => r.stiffest.clone(),
        Objective::Mode => r.highest_mode.clone(),
    };
    let all = reach.iter().filter(|r| !r.reference).filter_map(|r| Some(objective.minimized(&of(r)?)));
    let best = all.fold(f64::INFINITY, f64::min);
    reach.len() > 1 && own.as_ref().is_some_and(|d| objective.minimized(d) == best)
}

/// Value of the objective, name and cost of a design, as three cells. A star before the value marks the best one.
fn triple(objective: Objective, design: Option<&Design>, starred: bool) -> [String; 3] {
    let Some(d) = design else { return ["none".into(), String::new(), String::new()] };
    let star = if starred { "* " } else { "" };
    [
        format!("{star}{}", significant(objective.of(d), 4)),
        d.design_id.clone(),
        d.material_cost_eur.map_or("?".into(), cost_words),
    ]
}

/// One table of the answers to one question at several limits.
fn table(rows: &[&Row], labels: &[String]) -> Table {
    let mut columns = vec![Column::left("front")];
    for row in rows {
        columns.extend([Column::right(&header(row)), Column::left("design"), Column::right("EUR")]);
    }
    let mut table = Table::new(columns);
    for (i, label) in labels.iter().enumerate() {
        let mut cells = vec![label.clone()];
        rows.iter().for_each(|row| cells.extend(answer_cells(row.question, &row.answers[i])));
        table.row(cells);
    }
    table
}

fn header(row: &Row) -> String {
    let sign = if row.question.limited() == Objective::Mode { '≥' } else { '≤' };
    format!("{sign} {} {}", shortest(row.limit), row.question.limited().unit())
}

fn answer_cells(question: Question, answer: &Answer) -> [String; 3] {
    let design = answer.design.as_ref().filter(|_| answer.reached);
    triple(question.sought(), design, answer.winner)
}

/// Splits the limits of a question into groups, each of which gives a table that fits the width.
fn groups<'a>(rows: &[&'a Row], labels: &[String]) -> Vec<Vec<&'a Row>> {
    let mut out: Vec<Vec<&Row>> = Vec::new();
    for row in rows {
        let fits = |group: &Vec<&'a Row>| {
            let tried: Vec<&Row> = group.iter().chain([row]).copied().collect();
            let text = table(&tried, labels).to_text();
            text.lines().all(|l| l.chars().count() + 2 <= TERMINAL)
        };
        match out.last_mut() {
            Some(group) if fits(group) => group.push(row),
            _ => out.push(vec![row]),
        }
    }
    out
}

/// A sentence about the fronts that cannot meet the limit of `row`, and how near each comes to it.
fn out_of_reach(row: &Row, labels: &[String]) -> String {
    let limited = row.question.limited();
    let missed: Vec<String> = row
        .answers
        .iter()
        .zip(labels)
        .filter(|(a, _)| !a.reached && !a.reference)
        .filter_map(|(a, label)| {
            // an empty front is a matter of what the study offers, and not of this limit; its cells say "none"
            let d = a.design.as_ref()?;
            let value = significant(limited.of(d), 4);
            Some(format!("{label} ({value} {}, design {})", limited.unit(), d.design_id))
        })
        .collect();
    if missed.is_empty() {
        return String::new();
    }
    format!("Cannot reach {}; nearest: {}.", header(row), missed.join(", "))
}

/// Labels that are short enough for a narrow table and still differ from each other.
pub(crate) fn short_labels(labels: &[String]) -> Vec<String> {
    let short: Vec<String> = labels.iter().map(|l| shorten(l)).collect();
    let unique = |i: usize| short.iter().filter(|s| **s == short[i]).count() == 1;
    (0..labels.len()).map(|i| if unique(i) { short[i].clone() } else { labels[i].clone() }).collect()
}

/// Removes text in brackets and abbreviates common words. If the label is still too long, cuts it.
fn shorten(label: &str) -> String {
    if label.chars().count() <= LONGEST_LABEL {
        return label.to_string();
    }
    let mut out = String::new();
    let mut depth = 0;
    for c in label.chars() {
        match c {
            '(' => depth += 1,
            ')' => depth = (depth - 1).max(0),
            c if depth == 0 => out.push(c),
            _ => {}
        }
    }
    for (long, short) in
        [("quasi-isotropic", "QI"), ("unidirectional", "UD"), ("particle/", "p/"), ("Structural ", "")]
    {
        out = out.replace(long, short);
    }
    let out = out.split_whitespace().collect::<Vec<_>>().join(" ");
    if out.chars().count() <= LONGEST_LABEL {
        return out;
    }
    let cut: String = out.chars().take(LONGEST_LABEL - 1).collect();
    format!("{}…", cut.trim_end())
}

fn indent(text: &str) -> String {
    text.lines().map(|l| format!("  {l}\n")).collect()
}

fn item(sentence: &str) -> String {
    wrap(sentence, TERMINAL, "    ").replacen("    ", "  - ", 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_shortened_only_where_they_must_and_stay_different() {
        let long = |s: &str| s.to_string();
        let labels = [
            long("Aluminium 6061-T6"),
            long("CFRP T300/5208 (standard modulus) quasi-isotropic"),
            long("SiC particle/Al 2124 25 vol% wrought PM"),
        ];
        assert_eq!(
            short_labels(&labels),
            ["Aluminium 6061-T6", "CFRP T300/5208 QI", "SiC p/Al 2124 25 vol% w…"]
        );
        let similar = [long("Titanium Ti-6Al-4V sheet (annealed)"), long("Titanium Ti-6Al-4V sheet (aged)")];
        assert_eq!(short_labels(&similar), similar);
    }
}
