//! The designs of fronts as columns of data, which the linked views draw, filter and label.
//!
//! Numbers are rounded to the digits that are shown ([`SHOWN_DIGITS`]), so that a number on the page is the number of
//! `front.csv` rounded once. If there are too many designs, some are left out: first those that are only on the front
//! of their own group, then those on the front of all designs. The picks always stay. The designs that are best for
//! their mass in a view get up to half of the places. The others are thinned evenly along the mass.

use super::packed::{self, packed};
use crate::report::front_svg::LOGARITHMIC_ABOVE;
use crate::report::front_table::FrontTable;
use crate::report::number::significant;
use crate::report::picks::Objective;
use crate::report::svg::draw::{MUTED, colour};
use crate::report::svg::marker::outline;
use crate::report::svg::scale::Scale;
use crate::report::svg::ticks::rule;
use serde_json::{Value, json};
use std::cmp::Ordering;
use std::collections::HashSet;

/// Significant digits of the numbers on the page.
pub(crate) const SHOWN_DIGITS: usize = 5;
/// Largest number of designs that are drawn.
pub(crate) const MOST_ROWS: usize = 20_000;
/// Largest size of the data on the page \[bytes\].
pub(crate) const MOST_BYTES: usize = 1_200_000;
/// Axes with at most this many distinct values have one label per value.
const MOST_LABELS: usize = 18;
/// Distinct values get one label each only if neighbours differ by at least this fraction of the range. Otherwise
/// labels would overlap.
const LEAST_LABEL_DISTANCE: f64 = 0.04;

/// A group of designs that are drawn in the same style.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Group {
    /// Name in the legend.
    pub name: String,
    /// Index of colour and marker; [`crate::report::svg::MUTED`] is grey in the background.
    pub style: usize,
}

/// One design of a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Row<'a> {
    /// Table that contains the design.
    pub table: &'a FrontTable,
    /// Index of the design's row in the table.
    pub row: usize,
    /// Index of the design's group.
    pub group: usize,
    /// Whether the design is on the front of all designs.
    pub on_front: bool,
}

/// One axis of the views: a choice or a result.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Axis {
    /// Name of the column in `front.csv`.
    pub column: String,
    /// Name of the axis, for people.
    pub label: String,
    /// Unit; empty if the axis has none.
    pub unit: &'static str,
    /// Ends and scale of an axis of numbers; `None` for an axis of words.
    pub range: Option<(f64, f64, Scale)>,
    /// Labels: position on the axis from 0 to 1, and text.
    pub ticks: Vec<(f64, String)>,
    /// Words of an axis of words, bottom to top; empty for an axis of numbers.
    pub words: Vec<String>,
    /// Value of each design: a number, or the index of its word; `None` is blank.
    pub values: Vec<Option<f64>>,
}

/// The data that the linked views show.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FrontData<'a> {
    /// The groups, in the order of the legend.
    pub groups: Vec<Group>,
    /// The designs that are drawn, lightest first.
    pub rows: Vec<Row<'a>>,
    /// Numbers of designs before some were left out to save space: on the front of all designs, and only on the front
    /// of their group.
    pub rows_total: [usize; 2],
    /// Axes of the choices that differ among the designs, base to tip, then of mass, tip deflection and lowest
    /// mode.
    pub axes: Vec<Axis>,
    /// Choices that are equal in all designs, in words.
    pub constants: Vec<String>,
}

impl<'a> FrontData<'a> {
    /// The data of the designs `rows`, in at most `most_bytes` bytes: designs are left out until they fit. The designs
    /// named in `kept` are drawn in any case.
    pub(crate) fn new(groups: Vec<Group>, rows: Vec<Row<'a>>, kept: &[String], most_bytes: usize) -> Self {
        let rows_total = counts(&rows);
        let mut room = MOST_ROWS;
        loop {
            let data = Self::of(groups.clone(), sampled(&rows, room, kept), rows_total);
            let bytes = data.to_json(&[]).to_string().len();
            if bytes <= most_bytes || room < 100 {
                return data;
            }
            room = (data.rows.len() * most_bytes / bytes).saturating_sub(1);
        }
    }

    /// Numbers of designs that are drawn, in the order of [`Self::rows_total`].
    pub(crate) fn rows_drawn(&self) -> [usize; 2] {
        counts(&self.rows)
    }

    fn of(groups: Vec<Group>, rows: Vec<Row<'a>>, rows_total: [usize; 2]) -> Self {
        let mut constants = Vec::new();
        let mut axes = Vec::new();
        for column in choice_columns(&rows) {
            let cells: Vec<&str> = rows.iter().map(|r| cell(r, column)).collect();
            let first = cells.first().copied().unwrap_or_default();
            if cells.iter().all(|c| *c == first) {
                if !first.is_empty() {
                    constants.push(format!("{} {first}", label(column).0));
                }
            } else if let Some(twin) = same_as_width(column, &rows, &cells) {
                constants.push(twin);
            } else {
                axes.push(axis(column, &cells, &groups));
            }
        }
        for objective in [Objective::Mass, Objective::Deflection, Objective::Mode] {
            let column = objective_column(objective);
            let cells: Vec<&str> = rows.iter().map(|r| cell(r, column)).collect();
            axes.push(axis(column, &cells, &groups));
        }
        Self { groups, rows, rows_total, axes, constants }
    }

    /// The data as JSON for the page's program. `picks` are pairs of a name and a `design_id`.
    pub(crate) fn to_json(&self, picks: &[(String, String)]) -> Value {
        let ids: Vec<&str> = self.rows.iter().map(|r| cell(r, "design_id")).collect();
        let picks: Vec<Value> = picks
            .iter()
            .filter_map(|(name, id)| Some(json!({"name": name, "row": ids.iter().position(|i| i == id)?})))
            .collect();
        let groups: Vec<Value> = self
            .groups
            .iter()
            .map(|g| {
                let (colour, path) = (colour(g.style), outline(g.style, 1.0));
                json!({"name": g.name, "colour": colour, "path": path, "muted": u8::from(g.style == MUTED)})
            })
            .collect();
        json!({
            "ids": ids.join(" "),
            "groups": groups,
            "group": packed(self.rows.iter().map(|r| r.group), self.groups.len()),
            "front": packed(self.rows.iter().map(|r| usize::from(r.on_front)), 2),
            "axes": self.axes.iter().map(Axis::to_json).collect::<Vec<_>>(),
            "digits": SHOWN_DIGITS,
            "letters": *packed::ALPHABET,
            "picks": picks,
        })
    }

    /// Position of a design on each axis, from 0 to 1; `None` where its cell is blank.
    pub(crate) fn places(&self, row: usize) -> Vec<Option<f64>> {
        self.axes.iter().map(|a| a.values[row].map(|v| a.place(v))).collect()
    }
}

impl Axis {
    /// Position of a value on the axis, from 0 to 1.
    pub(crate) fn place(&self, value: f64) -> f64 {
        match self.range {
            Some((low, high, Scale::Log)) => libm::log(value / low) / libm::log(high / low),
            Some((low, high, Scale::Linear)) => (value - low) / (high - low),
            None => (value + 0.5) / self.words.len().max(1) as f64,
        }
    }

    fn to_json(&self) -> Value {
        let range = self.range.map(|(low, high, scale)| json!([low, high, u8::from(scale == Scale::Log)]));
        json!({
            "key": self.column, "label": self.label, "unit": self.unit, "range": range,
            "ticks": self.ticks, "words": self.words,
            "values": packed::column(&self.values),
        })
    }
}

/// Numbers of designs among `rows`: on the front of all designs, and only on the front of their group.
fn counts(rows: &[Row]) -> [usize; 2] {
    let front = rows.iter().filter(|r| r.on_front).count();
    [front, rows.len() - front]
}

/// The cell of a design in a column; blank if its table lacks the column.
fn cell<'a>(row: &Row<'a>, column: &str) -> &'a str {
    row.table.column(column).map_or("", |c| row.table.rows[row.row][c].as_str())
}

/// Name of the column of an objective.
pub(crate) fn objective_column(objective: Objective) -> &'static str {
    match objective {
        Objective::Mass => "mass_kg",
        Objective::Deflection => "tip_deflection_mm",
        Objective::Mode => "lowest_mode_hz",
    }
}

/// Names of the columns with choices that the tables of all designs have, in the order of the first table.
fn choice_columns<'a>(rows: &[Row<'a>]) -> Vec<&'a str> {
    let Some(first) = rows.first() else { return Vec::new() };
    let end = first.table.column("tip_deflection_mm").unwrap_or(0);
    let everywhere = |c: &&String| {
        rows.iter().all(|r| r.table.columns.len() == first.table.columns.len() || r.table.column(c).is_some())
    };
    first.table.columns[..end]
        .iter()
        .filter(|c| *c != "design_id")
        .filter(everywhere)
        .map(String::as_str)
        .collect()
}

/// Label and unit of a column: `upper_arm_wall_mm` gives `upper_arm wall` and mm.
fn label(column: &str) -> (String, &'static str) {
    let objective = match column {
        "mass_kg" => Some(("mass", "kg")),
        "tip_deflection_mm" => Some(("tip deflection", "mm")),
        "lowest_mode_hz" => Some(("lowest mode", "Hz")),
        _ => None,
    };
    if let Some((label, unit)) = objective {
        return (label.into(), unit);
    }
    let (name, unit) = column.strip_suffix("_mm").map_or((column, ""), |name| (name, "mm"));
    let (piece, what) = name.rsplit_once('_').unwrap_or(("", name));
    (format!("{piece} {what}").trim().to_string(), unit)
}

/// A sentence that says that a height equals the width in every design; `None` if it does not. The height is then no
/// choice of its own, and the sentence replaces its axis.
fn same_as_width(column: &str, rows: &[Row], cells: &[&str]) -> Option<String> {
    let width = format!("{}_width_mm", column.strip_suffix("_height_mm")?);
    let same = rows.iter().zip(cells).all(|(row, c)| cell(row, &width) == *c);
    same.then(|| format!("{} = width", label(column).0))
}

fn axis(column: &str, cells: &[&str], groups: &[Group]) -> Axis {
    let (label, unit) = label(column);
    let numbers: Vec<Option<f64>> = cells.iter().map(|c| c.parse().ok()).collect();
    let is_number = |(cell, n): (&&str, &Option<f64>)| cell.is_empty() || n.is_some_and(f64::is_finite);
    let empty = Axis {
        column: column.into(),
        label,
        unit,
        range: None,
        ticks: Vec::new(),
        words: Vec::new(),
        values: Vec::new(),
    };
    if cells.iter().zip(&numbers).all(is_number) {
        return number_axis(empty, &numbers);
    }
    let distinct: HashSet<&str> = cells.iter().copied().filter(|c| !c.is_empty()).collect();
    let mut words: Vec<&str> = distinct.into_iter().collect();
    let place = |w: &str| groups.iter().position(|g| g.name == w).map_or(0, |i| groups.len() - i);
    words.sort_by(|a, b| place(a).cmp(&place(b)).then_with(|| natural(a, b)));
    let values = cells.iter().map(|c| words.iter().position(|w| w == c).map(|i| i as f64)).collect();
    let words: Vec<String> = words.into_iter().map(String::from).collect();
    let mut axis = Axis { words, values, ..empty };
    let every = axis.words.len().div_ceil(24).max(1);
    let shown = axis.words.iter().enumerate().step_by(every);
    axis.ticks = shown.map(|(i, w)| (axis.place(i as f64), w.clone())).collect();
    axis
}

fn number_axis(empty: Axis, numbers: &[Option<f64>]) -> Axis {
    let rounded = |v: f64| significant(v, SHOWN_DIGITS).parse::<f64>().unwrap_or(v);
    let values: Vec<Option<f64>> = numbers.iter().map(|n| n.map(rounded)).collect();
    let mut distinct: Vec<f64> = values.iter().flatten().copied().collect();
    distinct.sort_by(f64::total_cmp);
    distinct.dedup();
    let (low, high) = (distinct.first().copied().unwrap_or(1.0), distinct.last().copied().unwrap_or(10.0));
    let scale = if low > 0.0 && high > LOGARITHMIC_ABOVE * low { Scale::Log } else { Scale::Linear };
    let ruling = rule(scale, low, high, 6);
    let mut axis = Axis { range: Some((ruling.low, ruling.high, scale)), values, ..empty };
    let nearest = distinct.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    if distinct.len() <= MOST_LABELS && distinct.len() > 1 && nearest >= LEAST_LABEL_DISTANCE * (high - low) {
        let margin = 0.04 * (high - low);
        axis.range = Some((low - margin, high + margin, Scale::Linear));
        axis.ticks = distinct.iter().map(|v| (axis.place(*v), crate::report::number::shortest(*v))).collect();
    } else {
        let labelled = ruling.ticks.iter().filter_map(|t| Some((t.value, t.label.clone()?)));
        axis.ticks = labelled.map(|(v, l)| (axis.place(v), l)).collect();
    }
    axis
}

/// Order of words in which numbers count by value: `CSG-14-100` comes before `CSG-100-50`.
fn natural(a: &str, b: &str) -> Ordering {
    // the word as pieces of text, each with the number that follows it
    let pieces = |word: &str| -> Vec<(String, u64)> {
        let (mut out, mut rest) = (Vec::new(), word);
        while !rest.is_empty() {
            let (text, tail) = rest.split_at(rest.find(|c: char| c.is_ascii_digit()).unwrap_or(rest.len()));
            let (digits, tail) =
                tail.split_at(tail.find(|c: char| !c.is_ascii_digit()).unwrap_or(tail.len()));
            out.push((text.to_string(), digits.parse().unwrap_or(0)));
            rest = tail;
        }
        out
    };
    pieces(a).cmp(&pieces(b)).then_with(|| a.cmp(b))
}

/// At most `room` designs, lightest first. The front of all designs gets at least four fifths of the places, if it has
/// that many designs. Designs whose `design_id` is in `kept` stay.
fn sampled<'a>(rows: &[Row<'a>], room: usize, kept: &[String]) -> Vec<Row<'a>> {
    let (front, own): (Vec<Row>, Vec<Row>) = rows.iter().partition(|r| r.on_front);
    let room_of_front = room.saturating_sub(own.len().min(room / 5));
    let front = thinned(front, room_of_front, kept);
    let own = thinned(own, room - front.len(), kept);
    by_mass(front.into_iter().chain(own).collect())
}

/// At most `room` of the designs `rows`. Designs whose `design_id` is in `kept` stay. The designs that [`edges`] finds
/// get up to half of the places. The others are taken at even steps in the order of mass.
fn thinned<'a>(rows: Vec<Row<'a>>, room: usize, kept: &[String]) -> Vec<Row<'a>> {
    if rows.len() <= room {
        return rows;
    }
    let rows = by_mass(rows);
    let named = |i: &usize| kept.iter().any(|k| k == cell(&rows[*i], "design_id"));
    let mut chosen: HashSet<usize> = (0..rows.len()).filter(named).collect();
    let mut edge = edges(&rows);
    thin(&mut edge, room / 2);
    chosen.extend(edge);
    let mut rest: Vec<usize> = (0..rows.len()).filter(|i| !chosen.contains(i)).collect();
    thin(&mut rest, room.saturating_sub(chosen.len()));
    chosen.extend(rest);
    rows.into_iter().enumerate().filter(|(i, _)| chosen.contains(i)).map(|(_, row)| row).collect()
}

/// Sorts by mass, the lightest first; rows of equal mass keep their order.
fn by_mass(rows: Vec<Row>) -> Vec<Row> {
    let mass = |r: &Row| cell(r, "mass_kg").parse().unwrap_or(f64::INFINITY);
    let mut weighed: Vec<(f64, Row)> = rows.into_iter().map(|r| (mass(&r), r)).collect();
    weighed.sort_by(|a, b| a.0.total_cmp(&b.0));
    weighed.into_iter().map(|(_, row)| row).collect()
}

/// Shortens a list to `room` entries, which are taken at even steps.
fn thin(list: &mut Vec<usize>, room: usize) {
    let count = list.len();
    if count > room {
        *list = (0..room).map(|i| list[i * count / room]).collect();
    }
}

/// Indices of the designs that are best for their mass in a view: in each group, those with the best deflection or the
/// best mode among all designs of no more mass.
fn edges(rows: &[Row]) -> Vec<usize> {
    let groups = rows.iter().map(|r| r.group).max().map_or(0, |g| g + 1);
    let mut out = Vec::new();
    for (group, objective) in
        (0..groups).flat_map(|g| [Objective::Deflection, Objective::Mode].map(|o| (g, o)))
    {
        let number = |r: &Row, column: &str| cell(r, column).parse::<f64>().ok();
        let sign = if objective == Objective::Mode { -1.0 } else { 1.0 };
        let place = |r: &Row| Some((number(r, "mass_kg")?, sign * number(r, objective_column(objective))?));
        let members = rows.iter().enumerate().filter(|(_, r)| r.group == group);
        let mut own: Vec<((f64, f64), usize)> = members.filter_map(|(i, r)| Some((place(r)?, i))).collect();
        own.sort_by(|a, b| a.0.0.total_cmp(&b.0.0).then(a.0.1.total_cmp(&b.0.1)));
        let mut best = f64::INFINITY;
        for ((_, value), i) in own {
            if value < best {
                best = value;
                out.push(i);
            }
        }
    }
    out.sort_unstable();
    out.dedup();
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(count: usize) -> FrontTable {
        let columns = [
            "design_id",
            "a_material",
            "a_width_mm",
            "a_height_mm",
            "j_gear",
            "tip_deflection_mm",
            "mass_kg",
            "lowest_mode_hz",
        ];
        let row = |i: usize| {
            let size = (60 + 20 * (i % 4)).to_string();
            let (material, gear) = (["steel", "alu"][i % 2], ["CSG-100-50", "CSG-14-100"][i % 2]);
            let x = i as f64 + 1.0;
            [
                format!("d{i}"),
                material.into(),
                size.clone(),
                size,
                gear.into(),
                (9.0 / x).to_string(),
                x.to_string(),
                x.sqrt().to_string(),
            ]
            .to_vec()
        };
        FrontTable { columns: columns.map(String::from).to_vec(), rows: (0..count).map(row).collect() }
    }

    fn data(table: &FrontTable) -> FrontData<'_> {
        let groups = ["steel", "alu"].iter().enumerate();
        let groups = groups.map(|(style, name)| Group { name: (*name).into(), style }).collect();
        let rows = (0..table.rows.len()).map(|row| Row { table, row, group: row % 2, on_front: true });
        FrontData::new(groups, rows.collect(), &["d7".into()], MOST_BYTES)
    }

    #[test]
    fn axes_are_the_choices_that_differ_and_the_objectives() {
        let table = table(40);
        let data = data(&table);
        let labels: Vec<&str> = data.axes.iter().map(|a| a.label.as_str()).collect();
        assert_eq!(labels, ["a material", "a width", "j gear", "mass", "tip deflection", "lowest mode"]);
        assert_eq!(data.constants, ["a height = width"]);
        assert_eq!(data.axes[2].words, ["CSG-14-100", "CSG-100-50"]);
    }

    #[test]
    fn numbers_are_those_of_the_table_to_the_digits_shown() {
        let table = table(40);
        let data = data(&table);
        let deflection = &data.axes[4];
        for (i, row) in data.rows.iter().enumerate() {
            let exact: f64 = cell(row, "tip_deflection_mm").parse().expect("a number");
            assert_eq!(deflection.values[i], significant(exact, 5).parse().ok());
        }
    }

    #[test]
    fn a_front_that_is_too_large_is_sampled_and_keeps_what_is_named() {
        let table = table(30_000);
        let data = data(&table);
        assert!(data.rows.len() <= MOST_ROWS && data.rows.len() > MOST_ROWS / 2);
        assert!(data.rows.iter().any(|r| cell(r, "design_id") == "d7"));
        assert!(data.to_json(&[]).to_string().len() <= MOST_BYTES);
        assert_eq!(data.rows_total, [30_000, 0]);
    }

    #[test]
    fn the_front_of_all_designs_is_whole_before_groups_have_more_than_a_fifth() {
        let table = table(60_000);
        let drawn = |front: usize| {
            let group = Group { name: "steel".into(), style: 0 };
            let row = |row: usize| Row { table: &table, row, group: 0, on_front: row < front };
            let rows: Vec<Row> = (0..60_000).map(row).collect();
            FrontData::new(vec![group], rows, &[], MOST_BYTES).rows_drawn()
        };
        assert_eq!(drawn(10_000), [10_000, 10_000]);
        assert_eq!(drawn(50_000), [16_000, 4_000]);
    }
}
