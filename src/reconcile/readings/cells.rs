//! Reads single cells of a table of readings: values, standard deviations, and blanks.

use super::table::Table;

/// No reading and no load is as large in its unit.
pub(crate) const ABSURD: f64 = 1e9;

/// What the rows of a file are read for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// A model is fitted to the readings: every row has one, with its standard deviation.
    Fit,
    /// A model predicts the readings: they may be blank, or their columns absent.
    Predict,
}

/// Reads a cell as a number of a size that can be measured or applied.
pub(crate) fn measured(table: &Table, row: usize, column: usize) -> Option<f64> {
    table.number_that(row, column, |x| x.abs() < ABSURD, "too large for any unit: is it a slip?")
}

/// Reads a cell as a standard deviation.
pub(crate) fn sigma(table: &Table, row: usize, column: usize) -> Option<f64> {
    const SIGMA: &str = "a standard deviation is greater than 0";
    let value = table.number_that(row, column, |s| s > 0.0, SIGMA)?;
    if (1.0 / ABSURD..ABSURD).contains(&value) {
        return Some(value);
    }
    let hint = "no instrument has this standard deviation; state the one it has";
    table.row_fault(row, &table.columns[column], format!("= {}", table.text(row, column)), hint);
    None
}

/// Reads a cell, or takes zero where it is blank or its column absent. `None` is a fault.
pub(crate) fn or_zero(
    table: &Table,
    row: usize,
    column: Option<usize>,
    read: impl Fn(&Table, usize, usize) -> Option<f64>,
) -> Option<f64> {
    match column.filter(|&c| !table.is_blank(row, c)) {
        Some(column) => read(table, row, column),
        None => Some(0.0),
    }
}

/// Reads a cell where a prediction may do without it: zero where it is blank or its column absent.
pub(crate) fn needed(
    table: &Table,
    row: usize,
    column: Option<usize>,
    purpose: Purpose,
    read: impl Fn(&Table, usize, usize) -> Option<f64>,
) -> Option<f64> {
    match (purpose, column) {
        (Purpose::Predict, _) => or_zero(table, row, column, read),
        (Purpose::Fit, column) => read(table, row, column?),
    }
}

/// Index of a column of readings, which a prediction may do without. The outer `None` is a fault.
pub(crate) fn reading_column(table: &Table, name: &str, purpose: Purpose) -> Option<Option<usize>> {
    match purpose {
        Purpose::Predict => Some(table.optional(name)),
        Purpose::Fit => table.required(name).map(Some),
    }
}
