//! A CSV file as named columns. Every fault is recorded with file, line, column, value and hint.

use crate::input::csv::{Csv, Record, is_repeated, other_separators};
use crate::input::json::{Fault, InputError, closest};
use std::cell::RefCell;
use std::path::Path;

/// First character of a comment line.
const COMMENT: u8 = b'#';

/// A CSV file whose first row names the columns.
#[derive(Debug)]
pub struct Table {
    /// File name as given.
    pub file: String,
    /// Column names.
    pub columns: Vec<String>,
    /// Rows of text.
    pub rows: Vec<Vec<String>>,
    /// Line of each row in the file.
    pub lines: Vec<usize>,
    faults: RefCell<Vec<Fault>>,
}

impl Table {
    /// Reads a file; rows of the wrong length are faults.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        let file = path.display().to_string();
        let text = std::fs::read_to_string(path)
            .map_err(|source| InputError::Unreadable { file: file.clone(), source })?;
        Ok(Self::parse(&file, &text))
    }

    /// Parses CSV text. Rows of the wrong length are faults.
    pub fn parse(file: &str, text: &str) -> Self {
        let mut table = Self {
            file: file.to_string(),
            columns: Vec::new(),
            rows: Vec::new(),
            lines: Vec::new(),
            faults: RefCell::default(),
        };
        let csv = Csv::parse(text.as_bytes(), Some(COMMENT));
        for (_, problem) in &csv.unreadable {
            table.fault(None, "", format!("not valid CSV: {problem}"), "save the table as plain CSV");
        }
        csv.records.into_iter().for_each(|record| table.push(record));
        table.check_header();
        if table.columns.is_empty() {
            table.fault(None, "", "is empty".into(), "the first row names the columns");
        }
        table
    }

    /// Reports columns that are separated by something other than commas, or named twice.
    fn check_header(&self) {
        for word in other_separators(&self.columns, 2) {
            let hint = "separate columns with commas and write decimals with a point";
            self.fault(Some(1), "", format!("its columns are separated by {word}"), hint);
        }
        for (i, name) in self.columns.iter().enumerate() {
            if !name.is_empty() && is_repeated(&self.columns, i) {
                self.fault(Some(1), name, "the column is there twice".into(), "keep the one that holds");
            }
        }
    }

    /// Whether the first row names columns. If it does not, further faults would only confuse.
    fn has_header(&self) -> bool {
        self.columns.len() > 1
    }

    fn push(&mut self, Record { line, cells }: Record) {
        if self.columns.is_empty() {
            self.columns = cells;
        } else if !self.has_header() || cells.len() == self.columns.len() {
            self.rows.push(cells);
            self.lines.push(line);
        } else {
            let problem = format!("has {} cells, the header has {}", cells.len(), self.columns.len());
            self.fault(Some(line), "", problem, "give every row a value for every column");
        }
    }

    /// Records a fault.
    pub fn fault(&self, line: Option<usize>, column: &str, problem: String, hint: &str) {
        self.faults.borrow_mut().push(Fault {
            file: self.file.clone(),
            line,
            field: column.to_string(),
            problem,
            hint: hint.to_string(),
        });
    }

    /// Records a fault of a row.
    pub fn row_fault(&self, row: usize, column: &str, problem: String, hint: &str) {
        self.fault(self.lines.get(row).copied(), column, problem, hint);
    }

    /// All faults found.
    pub fn into_faults(self) -> Vec<Fault> {
        self.faults.into_inner()
    }

    /// Index of a column that must exist; its absence is a fault.
    pub fn required(&self, name: &str) -> Option<usize> {
        self.optional(name).or_else(|| {
            if !self.has_header() && !self.faults.borrow().is_empty() {
                return None;
            }
            let known: Vec<&str> = self.columns.iter().map(String::as_str).collect();
            let hint = match closest(name, &known) {
                Some(near) => format!("is it \"{near}\"? columns found: {}", known.join(", ")),
                None => format!("columns found: {}", known.join(", ")),
            };
            self.fault(Some(1), name, "the column is missing".into(), &hint);
            None
        })
    }

    /// Index of a column, if it exists.
    pub fn optional(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|c| c == name)
    }

    /// A cell's text.
    pub fn text(&self, row: usize, column: usize) -> &str {
        &self.rows[row][column]
    }

    /// Reads a cell as a finite number; anything else is a fault.
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

    /// Reads a cell as a number that satisfies a condition; anything else is a fault.
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
