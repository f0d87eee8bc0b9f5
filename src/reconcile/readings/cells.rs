//! Reads single cells of a table of readings: values, standard deviations, and blanks.

use super::table::Table;

/// Upper limit of the magnitude of readings and loads, in their units. A larger number is a fault in the file.
pub(crate) const ABSURD: f64 = 1e9;

/// Purpose for which the rows of a file are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// A model is fitted to the readings: every row must have a reading with its standard deviation.
    Fit,
    /// A model predicts the readings: cells of readings may be blank, and their columns may be absent.
    Predict,
}

/// Reads a cell as a number whose magnitude is below [`ABSURD`]. `None` if it is not; this is recorded as a fault.
pub(crate) fn measured(table: &Table, row: usize, column: usize) -> Option<f64> {
    table.number_that(row, column, |x| x.abs() < ABSURD, "too large for any unit: is it a slip?")
}

/// Reads a cell as a standard deviation, which must be above zero. `None` if it is not; this is recorded as a fault.
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

/// Reads a cell with `read`, or takes zero if the cell is blank or its column is absent. `None` if the cell has a
/// fault, which is recorded.
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

/// Reads a cell that a fit needs and a prediction does not. If `purpose` is a prediction, a blank cell or an absent
/// column gives zero. `None` if there is a fault, which is recorded.
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

/// Index of a column of readings. For a prediction the column may be absent, and the inner value is then `None`. The
/// outer value is `None` if a fit needs the column and it is missing, which is recorded as a fault.
pub(crate) fn reading_column(table: &Table, name: &str, purpose: Purpose) -> Option<Option<usize>> {
    match purpose {
        Purpose::Predict => Some(table.optional(name)),
        Purpose::Fit => table.required(name).map(Some),
    }
}
