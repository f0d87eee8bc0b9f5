//! Reads single cells of a table of readings as values or standard deviations, and says what a blank cell means.

use super::table::Table;

/// Readings and loads must be smaller than this, in the unit of their column. A larger number is a fault of the file.
pub(crate) const ABSURD: f64 = 1e9;

/// What the rows of a file are read for. This decides whether cells of readings may be blank.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// A model is fitted to the readings: every row must have a reading with its standard deviation.
    Fit,
    /// A model predicts the readings: cells of readings may be blank, and their columns may be absent.
    Predict,
}

/// Reads the cell at `row` and `column` as a number whose magnitude is below [`ABSURD`]. `None` if it is not such a
/// number; this is recorded as a fault in `table`.
pub(crate) fn measured(table: &Table, row: usize, column: usize) -> Option<f64> {
    table.number_that(row, column, |x| x.abs() < ABSURD, "too large for any unit: is it a slip?")
}

/// Reads the cell at `row` and `column` as a standard deviation, which must be above zero. `None` if it is not, or if
/// its magnitude is absurd; this is recorded as a fault in `table`.
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

/// Reads a cell that a fit needs and a prediction does not. For a prediction, a blank cell or an absent column gives
/// zero. `None` if there is a fault, which is recorded in `table`; for a fit also if `column` is `None`.
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

/// Index of the column `name`, which has readings. The outer value is `None` if a fit needs the column and it is
/// missing; this is recorded as a fault. The inner value is `None` if the column is absent and the purpose is a
/// prediction.
pub(crate) fn reading_column(table: &Table, name: &str, purpose: Purpose) -> Option<Option<usize>> {
    match purpose {
        Purpose::Predict => Some(table.optional(name)),
        Purpose::Fit => table.required(name).map(Some),
    }
}
