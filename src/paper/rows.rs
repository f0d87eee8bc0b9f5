//! Rows with a number of the paper next to the number of this program, and tables of such rows.

use crate::report::number::{fixed, shortest};
use crate::report::table::{Column, Table};
use serde_json::{Value, json};

/// One of the paper's numbers next to the number of this program. A *reading* of an equation is one interpretation of
/// it, where the paper is ambiguous.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PaperRow {
    /// Key of the row, which stays the same in all versions.
    pub id: &'static str,
    /// Name of the quantity.
    pub quantity: &'static str,
    /// Unit of the number; empty for a ratio.
    pub unit: &'static str,
    /// The number that the paper prints; `None` if it prints none.
    pub paper: Option<f64>,
    /// The paper's words for this number, such as `less than 3` or `about 70`.
    pub paper_words: &'static str,
    /// Our number, with the equation read in the way that gives the paper's number; `None` if there is no such
    /// reading.
    pub reading_value: Option<f64>,
    /// The number of the general mechanics, with all compliances and Table 1 as printed; `None` if it has no such
    /// number.
    pub exact: Option<f64>,
    /// Number of digits after the decimal point.
    pub decimals: usize,
    /// The reading of the equation that gives `reading_value`, in words.
    pub reading: String,
    /// The reason why our number and the paper's number differ; empty if they agree.
    pub reason: String,
}

impl PaperRow {
    /// A row with its name and unit, in which no number is set yet.
    pub fn new(id: &'static str, quantity: &'static str, unit: &'static str, decimals: usize) -> Self {
        Self { id, quantity, unit, decimals, ..Self::default() }
    }

    /// Sets the number of the paper and the words in which the paper states it.
    pub fn paper(mut self, value: f64, words: &'static str) -> Self {
        self.paper = Some(value);
        self.paper_words = words;
        self
    }

    /// Sets the number that we compute with one reading of the equation, and describes this reading in words.
    pub fn reading(mut self, value: f64, reading: impl Into<String>) -> Self {
        self.reading_value = Some(value);
        self.reading = reading.into();
        self
    }

    /// Sets the number that the general mechanics gives.
    pub fn exact(mut self, value: f64) -> Self {
        self.exact = Some(value);
        self
    }

    /// Sets the reason why our number and the paper's number differ.
    pub fn because(mut self, reason: impl Into<String>) -> Self {
        self.reason = reason.into();
        self
    }

    fn shown(&self, value: Option<f64>) -> String {
        value.map_or_else(|| "-".to_string(), |v| fixed(v, self.decimals))
    }

    fn paper_shown(&self) -> String {
        if self.paper.is_some() { self.paper_words.to_string() } else { "-".to_string() }
    }

    fn to_json(&self) -> Value {
        json!({
            "id": self.id,
            "quantity": self.quantity,
            "unit": self.unit,
            "paper": self.paper,
            "paper_words": self.paper_words,
            "reading_value": self.reading_value,
            "exact": self.exact,
            "reading": self.reading,
            "reason": self.reason,
        })
    }
}

/// The numbers of the rows as a table. Explanations are in [`notes`].
pub fn table(rows: &[PaperRow]) -> Table {
    let mut table = Table::new(vec![
        Column::right("#"),
        Column::left("quantity"),
        Column::left("unit"),
        Column::right("paper"),
        Column::right("ours, paper's reading"),
        Column::right("exact"),
    ]);
    for (i, row) in rows.iter().enumerate() {
        table.row([
            (i + 1).to_string(),
            row.quantity.to_string(),
            row.unit.to_string(),
            row.paper_shown(),
            row.shown(row.reading_value),
            row.shown(row.exact),
        ]);
    }
    table
}

/// Notes on the rows, numbered as in [`table`]: how the equation is read and why the numbers differ. If consecutive
/// rows have the same reading, it is written once.
pub fn notes(rows: &[PaperRow]) -> String {
    let mut text = String::new();
    let mut before = "";
    for (i, row) in rows.iter().enumerate() {
        let reading = if row.reading == before { "" } else { row.reading.as_str() };
        let words: Vec<&str> = [reading, row.reason.as_str()].into_iter().filter(|w| !w.is_empty()).collect();
        if !words.is_empty() {
            text.push_str(&format!("- ({}) {}\n", i + 1, words.join(" -- ")));
        }
        before = &row.reading;
    }
    text
}

/// The rows as CSV with all fields. Numbers are in the shortest form that reads back exactly.
pub fn csv(rows: &[PaperRow]) -> String {
    let mut table = Table::new(
        ["id", "quantity", "unit", "paper", "paper_words", "reading_value", "exact", "reading", "reason"]
            .map(Column::left)
            .to_vec(),
    );
    let number = |value: Option<f64>| value.map_or_else(String::new, shortest);
    for row in rows {
        table.row([
            row.id.to_string(),
            row.quantity.to_string(),
            row.unit.to_string(),
            number(row.paper),
            row.paper_words.to_string(),
            number(row.reading_value),
            number(row.exact),
            row.reading.clone(),
            row.reason.clone(),
        ]);
    }
    table.to_csv()
}

/// The rows as a JSON array.
pub fn json(rows: &[PaperRow]) -> Value {
    Value::Array(rows.iter().map(PaperRow::to_json).collect())
}
