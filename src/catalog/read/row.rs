//! One row of a catalog file. Every cell is checked once, by the kind of its column. A cell that is not valid is
//! then read as unknown, so that it causes only one fault.

use super::log::Log;
use crate::catalog::schema::{CatalogFile, Cell};
use crate::catalog::{Confidence, Provenance};
use crate::input::json::closest;
use crate::input::magnitude::{beyond_calculation, not_positive};
use crate::input::names::{unfit_cell, unfit_name};

/// The order in which numbers must follow each other.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Order {
    /// Each number is larger than the one before.
    Rising,
    /// No number is smaller than the one before.
    NotFalling,
}

impl Order {
    /// Whether `next` may follow `before`.
    pub(crate) fn holds(self, before: f64, next: f64) -> bool {
        !(next < before || (self == Self::Rising && next == before))
    }
}

/// One row: the cells in the order of the file's known columns. `None` is the cell of an absent column.
pub(crate) struct Row<'a> {
    file: CatalogFile,
    name: &'a str,
    line: usize,
    cells: Vec<Option<String>>,
    log: &'a Log,
}

impl<'a> Row<'a> {
    /// The row in the line `line` of a file of the kind `file`. `name` is the name of the file in messages; faults and
    /// warnings go to `log`.
    pub(crate) fn new(
        file: CatalogFile,
        name: &'a str,
        line: usize,
        cells: Vec<Option<String>>,
        log: &'a Log,
    ) -> Self {
        Self { file, name, line, cells, log }
    }

    /// Line in the file, counted from 1.
    pub(crate) fn line(&self) -> usize {
        self.line
    }

    /// All cells with their columns, as they are written in the file. Cells of absent columns are blank.
    pub(crate) fn printed(&self) -> Vec<(&'static str, String)> {
        let cells = self.cells.iter().map(|cell| cell.clone().unwrap_or_default());
        self.file.columns().iter().map(|c| c.name).zip(cells).collect()
    }

    /// Records a fault of the row, for which the file is refused.
    pub(crate) fn fault(&self, column: &str, problem: impl Into<String>, hint: &str) {
        self.log.fault(self.name, Some(self.line), column, problem.into(), hint.into());
    }

    /// Records a warning about an unusual cell.
    pub(crate) fn warn(&self, column: &str, problem: impl Into<String>, hint: &str) {
        self.log.warn(self.name, Some(self.line), column, problem.into(), hint.into());
    }

    fn cell(&self, column: &str) -> Option<&str> {
        let place = self.file.columns().iter().position(|c| c.name == column)?;
        self.cells.get(place)?.as_deref()
    }

    /// The text of a cell; empty if the cell is blank or the column is absent.
    pub(crate) fn text(&self, column: &str) -> &str {
        self.cell(column).unwrap_or_default()
    }

    /// The number in a cell; `None` if the cell is blank, absent or not valid.
    pub(crate) fn number(&self, column: &str) -> Option<f64> {
        let kind = self.file.columns().iter().find(|c| c.name == column)?.cell;
        read_number(kind, self.text(column)).ok()?
    }

    /// The whole number in a cell; `None` if the cell is blank, absent or not valid.
    pub(crate) fn count(&self, column: &str) -> Option<u32> {
        self.text(column).parse().ok().filter(|&n| n > 0)
    }

    /// Records the faults of single cells: a required cell that is blank, or a cell that is not a number, not
    /// positive or not an allowed word. Absent columns are reported with the header.
    pub(crate) fn check_cells(&self) {
        for (column, text) in self.file.columns().iter().zip(&self.cells) {
            match text.as_deref() {
                Some("") if column.required => self.fault(column.name, "is blank", "every row needs it"),
                Some("") | None => {}
                Some(text) => {
                    let is_name = self.file.key().contains(&column.name);
                    let unfit = if is_name { unfit_name(text) } else { unfit_cell(text) };
                    if let Some((problem, hint)) = unfit {
                        self.fault(column.name, problem, hint);
                        continue;
                    }
                    if let Err(Refusal { problem, hint }) = check_cell(column.cell, text) {
                        self.fault(column.name, problem, &hint);
                    }
                }
            }
        }
        self.check_column_list("unverified_fields");
        self.check_column_list("derived_fields");
    }

    /// Where the numbers of the row come from: source, confidence, file and line. `None` if the source is blank or the
    /// confidence is not valid.
    pub(crate) fn provenance(&self) -> Option<Provenance> {
        Some(Provenance {
            source: self.filled("source")?.to_string(),
            confidence: Confidence::from_word(self.text("confidence"))?,
            unverified_fields: self.unverified_fields(),
            file: self.name.to_string(),
            line: self.line,
        })
    }

    /// The text of a cell; `None` if it is blank or absent.
    pub(crate) fn filled(&self, column: &str) -> Option<&str> {
        self.cell(column).filter(|text| !text.is_empty())
    }

    /// The columns of this row that are listed as unverified. In the list, `all` and `all except ...` stand for the
    /// filled cells with properties of the part.
    fn unverified_fields(&self) -> Vec<String> {
        let (all, named) = column_list(self.text("unverified_fields"));
        if !all {
            return named.iter().map(ToString::to_string).collect();
        }
        let figures = self.file.columns().iter().filter(|c| c.figure && !self.text(c.name).is_empty());
        figures.map(|c| c.name).filter(|name| !named.contains(name)).map(String::from).collect()
    }

    fn check_column_list(&self, column: &str) {
        let known: Vec<_> = self.file.columns().iter().map(|c| c.name).collect();
        let (_, named) = column_list(self.text(column));
        for word in named.iter().filter(|word| !known.contains(word)) {
            let hint = format!(
                "{}name columns of this file separated by blanks, or `all`, or `all except ...`",
                did_you_mean(word, &known)
            );
            self.fault(column, format!("\"{word}\" is not a column"), &hint);
        }
    }

    /// Reports those of the numbers in `figures` (column and value) that are smaller than the number before them.
    /// Unknown numbers are skipped.
    pub(crate) fn ascending(&self, figures: &[(&str, Option<f64>)], order: Order, hint: &str) {
        let known: Vec<_> = figures.iter().filter_map(|(column, x)| Some((*column, (*x)?))).collect();
        for pair in known.windows(2) {
            let [(low_column, low), (column, x)] = [pair[0], pair[1]];
            if !order.holds(low, x) {
                let relation = if x == low { "must exceed" } else { "is below" };
                self.fault(column, format!("= {x} {relation} {low_column} = {low}"), hint);
            }
        }
    }

    /// Compares `printed`, a number in the column `column`, with `computed`, the same number computed from other
    /// numbers of the row. `from` names these numbers in the message. A relative deviation of more than `warn` gives a
    /// warning, and a deviation of more than `refuse` gives a fault.
    pub(crate) fn agrees(
        &self,
        column: &str,
        printed: f64,
        computed: f64,
        from: &str,
        warn: f64,
        refuse: f64,
    ) {
        let deviation = printed / computed - 1.0;
        let problem =
            || format!("= {printed} is {:+.1} % off {computed:.4e}, computed from {from}", 100.0 * deviation);
        if deviation.abs() > refuse {
            self.fault(
                column,
                problem(),
                &format!("more than {:.1} % apart: check unit and digits", 100.0 * refuse),
            );
        } else if deviation.abs() > warn {
            self.warn(column, problem(), &format!("more than {:.1} % apart", 100.0 * warn));
        }
    }

    /// Compares `x`, the number in the column `column`, with two ranges. Outside the physically possible range it is a
    /// fault, outside the usual range a warning. Returns whether the number is possible.
    pub(crate) fn within(
        &self,
        column: &str,
        x: f64,
        possible: [f64; 2],
        usual: [f64; 2],
        hint: &str,
    ) -> bool {
        let problem =
            |[low, high]: [f64; 2], what: &str| format!("= {x} is outside {low:e} to {high:e}, {what}");
        let is_possible = (possible[0]..=possible[1]).contains(&x);
        if !is_possible {
            self.fault(column, problem(possible, "what is possible"), hint);
        } else if !(usual[0]..=usual[1]).contains(&x) {
            self.warn(column, problem(usual, "what is usual"), hint);
        }
        is_possible
    }
}

/// Reason why a cell is not valid, with a hint.
struct Refusal {
    problem: String,
    hint: String,
}

fn refusal<T>(problem: String, hint: &str) -> Result<T, Refusal> {
    Err(Refusal { problem, hint: hint.into() })
}

fn check_cell(kind: Cell, text: &str) -> Result<(), Refusal> {
    match kind {
        Cell::Text => Ok(()),
        Cell::Word(words) if words.iter().any(|word| word.eq_ignore_ascii_case(text)) => Ok(()),
        Cell::Word(words) => {
            let hint = format!("{}allowed: {}", did_you_mean(text, words), words.join("; "));
            refusal(format!("\"{text}\" is not known"), &hint)
        }
        Cell::Count if text.parse::<u32>().is_ok_and(|n| n > 0) => Ok(()),
        Cell::Count => refusal(format!("\"{text}\" is not a whole number greater than 0"), "write e.g. 100"),
        number => read_number(number, text).map(|_| ()),
    }
}

/// The number that the text of a cell states, or the reason why a cell of this kind must not have this text. `None` if
/// the cell is blank.
fn read_number(kind: Cell, text: &str) -> Result<Option<f64>, Refusal> {
    const BLANK: &str = "leave the cell blank if the figure is unknown";
    if text.is_empty() {
        return Ok(None);
    }
    let x = finite_number(text)?;
    if let (Cell::Positive | Cell::Fraction, Some((problem, _))) = (kind, not_positive(x)) {
        return refusal(problem, BLANK);
    }
    match kind {
        Cell::NonNegative if x < 0.0 => refusal(format!("= {x} must not be negative"), BLANK),
        Cell::Fraction if x > 1.0 => {
            refusal(format!("= {x} must not exceed 1"), "write a fraction, 0.75 for 75 %")
        }
        _ => Ok(Some(x)),
    }
}

fn finite_number(text: &str) -> Result<f64, Refusal> {
    match text.parse::<f64>() {
        Ok(x) => match beyond_calculation(x) {
            None => Ok(x),
            Some((problem, _)) => {
                refusal(problem, "check the exponent, or leave the cell blank if the figure is unknown")
            }
        },
        Err(_) if text.contains(',') && text.replace(',', "").parse::<f64>().is_ok() => refusal(
            format!("\"{text}\" has a comma"),
            "the decimal sign is a point, and thousands are not separated",
        ),
        Err(_) => refusal(
            format!("\"{text}\" is not a number"),
            "write a bare number such as 12.5 or 3.3e-06 (the unit is in the column's name), or leave the cell blank",
        ),
    }
}

fn did_you_mean(word: &str, known: &[&str]) -> String {
    closest(word, known).map(|near| format!("did you mean \"{near}\"? ")).unwrap_or_default()
}

/// The content of a list of columns in a cell: whether it begins with `all`, and the columns that it names (after `all
/// except`, if it begins so).
fn column_list(text: &str) -> (bool, Vec<&str>) {
    let mut words = text.split([' ', ',', ';']).filter(|w| !w.is_empty()).peekable();
    let all = words.next_if_eq(&"all").is_some();
    if all {
        words.next_if_eq(&"except");
    }
    // The trade name of a motor whose part number was verified is a part of the column `model`.
    (all, words.map(|word| if word == "model_name" { "model" } else { word }).collect())
}
