//! A CSV file or a sheet of a spreadsheet as a table with named columns. Faults are collected with file, line, column,
//! value and hint, so that all of them can be reported at once.

use super::source::Source;
use super::spreadsheet::{is_spreadsheet, read_sheet};
use crate::input::csv::{Csv, Record, is_repeated, other_separators};
use crate::input::json::{Fault, InputError, closest, read_text};
use crate::input::names::{unfit_cell, unfit_name};
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::path::Path;

/// First character of a comment line.
const COMMENT: u8 = b'#';

/// Columns whose cells are names and not numbers.
const NAMES: [&str; 3] = ["test", "joint", "point"];

/// A CSV file or a sheet of a spreadsheet, whose first row names the columns.
#[derive(Debug)]
pub struct Table {
    /// Path of the file; for a spreadsheet followed by the name of the sheet.
    pub file: String,
    /// Names of the columns in this program.
    pub columns: Vec<String>,
    /// Cells of each row as text.
    pub rows: Vec<Vec<String>>,
    /// Line number of each row in the file, from 1.
    pub lines: Vec<usize>,
    /// Line number of the column names in the file, from 1.
    header_line: usize,
    /// Names of the columns as the file has them, before they are mapped to the names in this program.
    shown: Vec<String>,
    /// Letters of the columns of a spreadsheet; empty for a CSV file.
    letters: Vec<String>,
    faults: RefCell<Vec<Fault>>,
    /// Names of the columns that the readers of the table know, whether or not it has them.
    asked: RefCell<BTreeSet<String>>,
}

impl Table {
    /// Reads a CSV file as a table. Rows of the wrong length are recorded as faults.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        let file = path.display().to_string();
        Ok(Self::parse(&file, &read_text(path)?))
    }

    /// Reads a CSV file or a sheet of a spreadsheet, and gives its columns the names of this program. `source` names
    /// the sheet and the columns.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn read_from(path: &Path, source: &Source) -> Result<Self, InputError> {
        let mut table = match is_spreadsheet(path) {
            true => Self::of_spreadsheet(path, source)?,
            false => Self::read(path)?,
        };
        table.rename(&source.columns);
        Ok(table)
    }

    /// Reads the sheet of a spreadsheet that `source` names. A problem with the file as a whole is recorded as a
    /// fault.
    fn of_spreadsheet(path: &Path, source: &Source) -> Result<Self, InputError> {
        let file = path.display().to_string();
        std::fs::metadata(path).map_err(|source| InputError::Unreadable { file: file.clone(), source })?;
        let mut table = Self::empty(&file);
        let sheet = match read_sheet(path, source.sheet.as_deref()) {
            Ok(sheet) => sheet,
            Err((problem, hint)) => {
                table.fault(None, "", problem, &hint);
                return Ok(table);
            }
        };
        table.file = format!("{file}, sheet \"{}\"", sheet.name);
        table.letters = sheet.letters;
        let first = source.header_row.unwrap_or(0);
        for (line, cells) in sheet.rows.into_iter().filter(|(line, _)| *line >= first) {
            table.push(Record { line, cells });
        }
        table.finish();
        Ok(table)
    }

    fn empty(file: &str) -> Self {
        Self {
            file: file.to_string(),
            columns: Vec::new(),
            rows: Vec::new(),
            lines: Vec::new(),
            header_line: 1,
            shown: Vec::new(),
            letters: Vec::new(),
            faults: RefCell::default(),
            asked: RefCell::default(),
        }
    }

    /// Reads CSV text as a table; `file` is the name of the file for messages. Rows of the wrong length are recorded
    /// as faults.
    pub fn parse(file: &str, text: &str) -> Self {
        let mut table = Self::empty(file);
        let csv = Csv::parse(text.as_bytes(), Some(COMMENT));
        for (_, problem) in &csv.unreadable {
            table.fault(None, "", format!("not valid CSV: {problem}"), "save the table as plain CSV");
        }
        csv.records.into_iter().for_each(|record| table.push(record));
        table.finish();
        table
    }

    /// Checks the column names, removes a row of units, and records a fault if the table is empty.
    fn finish(&mut self) {
        self.shown = self.columns.clone();
        self.check_header();
        self.check_units();
        if self.columns.is_empty() {
            self.fault(None, "", "is empty".into(), "the first row names the columns");
        }
    }

    /// Renames columns. Each pair in `names` is the name in this program and the name in the file. A fault is recorded
    /// for a name that the file lacks, and for a column name that two columns then have.
    fn rename(&mut self, names: &[(String, String)]) {
        for (name, shown) in names {
            match self.shown.iter().position(|column| column == shown) {
                Some(column) => self.columns[column].clone_from(name),
                None if self.columns.contains(name) => {}
                None => {
                    let hint = format!("campaign.json names it; columns found: {}", self.shown.join(", "));
                    self.fault(Some(self.header_line), shown, "the column is missing".into(), &hint);
                }
            }
        }
        for column in 0..self.columns.len() {
            let name = &self.columns[column];
            if *name != self.shown[column] && self.columns.iter().filter(|c| *c == name).count() > 1 {
                let problem = format!("is {name}, and so is another column");
                let hint = "map one of them, or rename one in the file";
                self.fault(Some(self.header_line), &self.shown[column], problem, hint);
            }
        }
    }

    /// Removes a row of units below the column names, and records a fault for it. A row counts as one if it has no
    /// numbers and the next row has some.
    fn check_units(&mut self) {
        let is_number = |cell: &String| cell.replace(',', ".").parse::<f64>().is_ok();
        let [first, second, ..] = self.rows.as_slice() else { return };
        let given: Vec<&String> = first.iter().filter(|cell| !cell.is_empty()).collect();
        if given.len() > 1 && !given.into_iter().any(is_number) && second.iter().any(is_number) {
            let problem = format!("has no numbers ({})", first.join(", "));
            let line = self.lines[0];
            self.rows.remove(0);
            self.lines.remove(0);
            self.fault(Some(line), "", problem, "remove a row of units: the names of the columns have them");
        }
    }

    /// Records a fault if columns are separated by something other than commas, if a column name has characters that
    /// are not allowed, or if two columns have the same name.
    fn check_header(&self) {
        let separators: Vec<&str> = other_separators(&self.columns, 2).collect();
        for word in &separators {
            let hint = "separate columns with commas, write decimals with a point, and name the columns in the first row";
            self.fault(Some(self.header_line), "", format!("its columns are separated by {word}"), hint);
        }
        // if the whole line was read as one column, there are no column names to check
        if !separators.is_empty() && !self.has_header() {
            return;
        }
        for name in &self.columns {
            if let Some((problem, hint)) = unfit_name(name) {
                self.fault(Some(self.header_line), name, problem, hint);
            }
        }
        for (i, name) in self.columns.iter().enumerate() {
            if !name.is_empty() && is_repeated(&self.columns, i) {
                self.fault(
                    Some(self.header_line),
                    name,
                    "the column is there twice".into(),
                    "keep the one that holds",
                );
            }
        }
    }

    /// Whether the header has more than one column. If not, the text was probably not separated by commas, and further
    /// faults would only confuse.
    fn has_header(&self) -> bool {
        self.columns.len() > 1
    }

    /// Records a fault if there are more than `most` rows, and removes the rows beyond.
    pub fn refuse_more_than(&mut self, most: usize) {
        if self.rows.len() > most {
            let problem = format!("has {} rows, and the limit is {most}", self.rows.len());
            self.fault(None, "", problem, "average repeated readings, or leave some poses out");
            self.rows.truncate(most);
        }
    }

    /// Adds a line of the file: the first as the column names, every other as a row. A row with another number of cells
    /// than the header is a fault.
    fn push(&mut self, Record { line, cells }: Record) {
        // spreadsheets are often saved with rows of commas below their last row
        if cells.iter().all(String::is_empty) {
            return;
        }
        if self.columns.is_empty() {
            self.header_line = line;
            self.columns = cells;
        } else if !self.has_header() || cells.len() == self.columns.len() {
            for (column, cell) in self.columns.iter().zip(&cells) {
                let is_name = NAMES.contains(&column.as_str());
                if let Some((problem, hint)) = if is_name { unfit_name(cell) } else { unfit_cell(cell) } {
                    self.fault(Some(line), column, problem, hint);
                }
            }
            self.rows.push(cells);
            self.lines.push(line);
        } else {
            let problem = format!("has {} cells, the header has {}", cells.len(), self.columns.len());
            self.fault(Some(line), "", problem, "give every row a value for every column");
        }
    }

    /// Records a fault of the file. `line` is the line number in the file and `column` the name of the column; they are
    /// `None` and empty if the fault is not at one place.
    pub fn fault(&self, line: Option<usize>, column: &str, problem: String, hint: &str) {
        let field = self.place(line, column);
        let fault = Fault { file: self.file.clone(), line, field, problem, hint: hint.to_string() };
        let mut faults = self.faults.borrow_mut();
        // several readings of a row may share a cell, such as that of their standard deviation
        if faults.last() != Some(&fault) {
            faults.push(fault);
        }
    }

    /// Name of the column `column` for a message: its names in this program and in the file and, for a spreadsheet,
    /// the cell or the column's letters.
    fn place(&self, line: Option<usize>, column: &str) -> String {
        let known = self.columns.iter().position(|c| c == column).or_else(|| {
            let shown = self.shown.iter().position(|c| c == column);
            shown.filter(|_| !column.is_empty())
        });
        let Some(index) = known else { return column.to_string() };
        let (name, shown) = (&self.columns[index], self.shown.get(index).unwrap_or(&self.columns[index]));
        let named = if name == shown { name.clone() } else { format!("{name} = \"{shown}\"") };
        match (self.letters.get(index), line) {
            (Some(letters), Some(line)) => format!("cell {letters}{line} ({named})"),
            (Some(letters), None) => format!("column {letters} ({named})"),
            (None, _) => named,
        }
    }

    /// Records a fault of the row with index `row`, in the column named `column`.
    pub fn row_fault(&self, row: usize, column: &str, problem: String, hint: &str) {
        self.fault(self.lines.get(row).copied(), column, problem, hint);
    }

    /// All faults that were recorded.
    pub fn into_faults(self) -> Vec<Fault> {
        self.faults.into_inner()
    }

    /// Index of the column `name`, which must exist. If it does not, a fault is recorded and the result is `None`.
    pub fn required(&self, name: &str) -> Option<usize> {
        self.optional(name).or_else(|| {
            if !self.has_header() && !self.faults.borrow().is_empty() {
                return None;
            }
            let found = format!("columns found: {}", self.columns.join(", "));
            let unasked = self.unasked();
            let hint = match closest(name, &unasked) {
                Some(near) => format!("is it \"{near}\"? {}; {found}", renamed(name, near)),
                None => converted(name, &unasked).map_or(found.clone(), |text| format!("{text}; {found}")),
            };
            self.fault(Some(self.header_line), name, "the column is missing".into(), &hint);
            None
        })
    }

    /// Index of the column `name`; `None` if there is no such column.
    pub fn optional(&self, name: &str) -> Option<usize> {
        self.asked.borrow_mut().insert(name.to_string());
        self.columns.iter().position(|c| c == name)
    }

    /// The columns for which no reader has asked.
    fn unasked(&self) -> Vec<&str> {
        let asked = self.asked.borrow();
        self.columns.iter().map(String::as_str).filter(|c| !c.is_empty() && !asked.contains(*c)).collect()
    }

    /// Sentence on the columns that no reader asked for, each with the columns that it may be meant for; `None` if there
    /// are none. It is known after the rows were read.
    pub(crate) fn unused(&self) -> Option<String> {
        let asked = self.asked.borrow();
        let lacks = |name: &&String| !self.columns.contains(name);
        let words = |column: &str| {
            let is_meant = |name: &&String| unit_of(name).is_some() && unit_of(name) == unit_of(column);
            let meant: Vec<&str> = asked
                .iter()
                .filter(lacks)
                .filter(is_meant)
                .filter(not_of_sigma)
                .map(String::as_str)
                .collect();
            match meant.is_empty() {
                true => column.to_string(),
                false => format!("{column} (is it {}?)", meant.join(" or ")),
            }
        };
        let unused: Vec<String> = self.unasked().into_iter().map(words).collect();
        (!unused.is_empty())
            .then(|| format!("{}: columns that are not used: {}", self.short_name(), unused.join(", ")))
    }

    /// Records a fault for each column whose name begins with `beginning` and an underscore follows somewhere, unless
    /// the name is in `family`. An example is a misspelt `sigma_...`.
    pub(crate) fn check_family(&self, beginning: &str, family: &[&str]) {
        let begins = |column: &&String| column.starts_with(beginning) && column.contains('_');
        for column in self.columns.iter().filter(begins).filter(|column| !family.contains(&column.as_str())) {
            let hint = format!("the columns of this kind: {}", family.join(", "));
            self.fault(Some(self.header_line), column, "is not known".into(), &hint);
        }
    }

    /// Records a fault if one of the columns is probably a misspelt `name`, and returns whether there is one. `name` is
    /// an optional column that the table lacks. Columns whose names are in `known` are not suspected.
    pub(crate) fn check_spelling(&self, name: &str, known: &[&str]) -> bool {
        let others: Vec<&str> =
            self.columns.iter().map(String::as_str).filter(|column| !known.contains(column)).collect();
        let near = closest(name, &others);
        if let Some(near) = near {
            let hint = format!("{}, or remove it", renamed(name, near));
            self.fault(Some(self.header_line), near, format!("is it {name}?"), &hint);
        }
        near.is_some()
    }

    /// A number from 1 to 999,999,999 that is made from the cells of all rows. Files with the same readings have the same
    /// mark, and other files have another one, but for chance.
    pub(crate) fn mark(&self) -> usize {
        let mut hasher = blake3::Hasher::new();
        for cell in self.rows.iter().flatten() {
            hasher.update(cell.as_bytes());
            hasher.update(b"\n");
        }
        let [a, b, c, d, ..] = *hasher.finalize().as_bytes();
        1 + u32::from_le_bytes([a, b, c, d]) as usize % 999_999_999
    }

    /// Name of the file without its folder; for a spreadsheet followed by the name of the sheet.
    pub(crate) fn short_name(&self) -> String {
        self.file.rsplit(['/', '\\']).next().unwrap_or(&self.file).to_string()
    }

    /// Names of the columns as the file has them.
    pub(crate) fn shown(&self) -> &[String] {
        &self.shown
    }

    /// Whether a cell is blank.
    pub(crate) fn is_blank(&self, row: usize, column: usize) -> bool {
        self.text(row, column).is_empty()
    }

    /// Text of a cell.
    pub fn text(&self, row: usize, column: usize) -> &str {
        &self.rows[row][column]
    }

    /// Reads a cell as a finite number. If it is not one, a fault is recorded and the result is `None`.
    pub fn number(&self, row: usize, column: usize) -> Option<f64> {
        let text = self.text(row, column);
        match text.parse::<f64>() {
            Ok(x) if x.is_finite() => Some(x),
            Ok(_) => self.number_fault(row, column, &format!("{text} is not a finite number")),
            Err(_) if text.is_empty() => self.number_fault(row, column, "the cell is empty"),
            Err(_) if text.replace(',', ".").parse::<f64>().is_ok() => {
                let problem = format!("\"{text}\" has a decimal comma");
                self.row_fault(row, &self.columns[column], problem, "write decimals with a point");
                None
            }
            Err(_) => self.number_fault(row, column, &format!("\"{text}\" is not a number")),
        }
    }

    /// Reads a cell as a number for which `condition` is true. If it is not one, a fault with the text `hint` is
    /// recorded and the result is `None`.
    pub fn number_that(
        &self,
        row: usize,
        column: usize,
        condition: impl Fn(f64) -> bool,
        hint: &str,
    ) -> Option<f64> {
        let value = self.number(row, column)?;
        if condition(value) {
            return Some(value);
        }
        self.row_fault(row, &self.columns[column], format!("= {}", self.text(row, column)), hint);
        None
    }

    fn number_fault(&self, row: usize, column: usize, problem: &str) -> Option<f64> {
        let hint = "remove the row, or give the value that was measured";
        self.row_fault(row, &self.columns[column], problem.into(), hint);
        None
    }
}

/// Units with which names of columns end.
const UNITS: [&str; 24] = [
    "mm", "m", "um", "cm", "in", "mil", "deg", "rad", "mrad", "arcmin", "arcsec", "kg", "g", "lb", "n", "kn",
    "kgf", "lbf", "nm", "hz", "rpm", "s", "ms", "us",
];

/// The unit with which the name of a column ends, in lower case.
fn unit_of(column: &str) -> Option<&'static str> {
    let (_, end) = column.rsplit_once('_')?;
    UNITS.into_iter().find(|unit| end.eq_ignore_ascii_case(unit))
}

/// Readings that are often given as another quantity: the column of this program, the end of the other column's name,
/// and how its values are converted.
const CONVERSIONS: [(&str, &str, &str); 7] = [
    ("windup_arcmin", "_deg", "multiply its values by 60"),
    ("windup_arcmin", "_mrad", "multiply its values by 3.43775"),
    ("windup_arcmin", "_rad", "multiply its values by 3437.75"),
    ("windup_arcmin", "_arcsec", "divide its values by 60"),
    ("frequency_hz", "_rad_s", "divide its values by 2 pi"),
    ("frequency_hz", "_rpm", "divide its values by 60"),
    ("frequency_hz", "_khz", "multiply its values by 1000"),
];

/// What to write if the column `name` is missing and none of the columns `unasked` has nearly its name; `None` if that
/// is not known.
fn converted(name: &str, unasked: &[&str]) -> Option<String> {
    if name.starts_with("sigma_") {
        let text = "write into every row the standard deviation of one reading, for example that of ten repeated readings";
        return Some(text.into());
    }
    CONVERSIONS.into_iter().filter(|(own, ..)| *own == name).find_map(|(_, end, how)| {
        let has_end = |column: &&&str| column.ends_with(end) && !column.starts_with("sigma_");
        let column = unasked.iter().find(has_end)?;
        Some(format!(
            "is it \"{column}\"? {how}, and the standard deviations if they are in that unit too, and name the column {name}"
        ))
    })
}

/// Whether a column is none of standard deviations. Those are known by the beginning of their names.
fn not_of_sigma(name: &&String) -> bool {
    !name.starts_with("sigma_")
}

/// What to do if the column `column` is meant to be the one that this program calls `name`.
pub(super) fn renamed(name: &str, column: &str) -> String {
    match (unit_of(name), unit_of(column)) {
        (Some(unit), Some(other)) if unit != other => {
            format!("convert its values from {other} to {unit}, and write the name of the column so")
        }
        _ => "write the name of the column so".into(),
    }
}
