//! Reads the three components of a displacement or a position, each with its standard deviation.
//!
//! An instrument may read fewer than three components: a dial gauge or a level reads one, and a theodolite reads two. A
//! component is not measured if its cell is blank or its column is absent. Some programs write zeros instead, which
//! `leave_out_idle` recognizes in two cases:
//!
//! - A column has the same value in all rows. An instrument with noise does not read that.
//! - Every row has one component at most that is not zero. Such zeros come from a gauge that is moved from one
//!   direction to the next.

use super::cells::{Purpose, measured, sigma};
use super::table::Table;

/// One component of a displacement or a position, as an instrument read it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Component {
    /// Measured value \[mm\].
    pub value_mm: f64,
    /// Standard deviation of the value \[mm\].
    pub sigma_mm: f64,
}

/// The components x, y and z of a vector; `None` for a component that was not measured.
pub type Components = [Option<Component>; 3];

/// Equal readings of a component are taken as not measured only if there are at least this many.
pub(crate) const FEWEST_ALIKE: usize = 4;

/// Names of the columns with the components of a vector and with their standard deviations.
pub(crate) struct Names {
    /// Names of the columns with the measured values, for x, y and z.
    pub values: [&'static str; 3],
    /// Names of the columns with the standard deviations, for x, y and z.
    pub sigmas: [&'static str; 3],
}

/// Names of the columns of tip displacements.
pub(crate) const DISPLACEMENT: Names =
    Names { values: ["dx_mm", "dy_mm", "dz_mm"], sigmas: ["sigma_dx_mm", "sigma_dy_mm", "sigma_dz_mm"] };

/// Names of the columns of absolute positions.
pub(crate) const POSITION: Names =
    Names { values: ["x_mm", "y_mm", "z_mm"], sigmas: ["sigma_x_mm", "sigma_y_mm", "sigma_z_mm"] };

/// Name of the column with one standard deviation for all components of a row.
const COMMON_SIGMA: &str = "sigma_mm";

/// Indices of the columns with the components of a vector and their standard deviations, in a table of readings; `None`
/// for a column that the table lacks.
pub(crate) struct VectorColumns<'a> {
    table: &'a Table,
    names: &'a Names,
    values: [Option<usize>; 3],
    sigmas: [Option<usize>; 3],
    common: Option<usize>,
    purpose: Purpose,
}

impl<'a> VectorColumns<'a> {
    /// Finds the columns `names` in the table. `None` if a column is missing that the purpose needs, or if one is
    /// misspelt; both are recorded as faults.
    pub(crate) fn find(table: &'a Table, names: &'a Names, purpose: Purpose) -> Option<Self> {
        table.check_family("sigma", &[names.sigmas.as_slice(), &[COMMON_SIGMA]].concat());
        let values = names.values.map(|name| table.optional(name));
        let sigmas = names.sigmas.map(|name| table.optional(name));
        let missing = names.values.iter().zip(&values).filter(|(_, found)| found.is_none());
        // a column with a misspelt name must not be taken for a component that was not measured
        let misspelt: Vec<bool> =
            missing.map(|(name, _)| table.check_spelling(name, &names.values)).collect();
        let mut common = table.optional(COMMON_SIGMA);
        if purpose == Purpose::Fit {
            if values.iter().all(Option::is_none) && !misspelt.contains(&true) {
                table.required(names.values[0]);
            }
            let has_own = |c: usize| values[c].is_none() || sigmas[c].is_some();
            if common.is_none() && !(0..3).all(has_own) {
                common = Some(table.required(COMMON_SIGMA)?);
            }
            if values.iter().all(Option::is_none) || misspelt.contains(&true) {
                return None;
            }
        }
        Some(Self { table, names, values, sigmas, common, purpose })
    }

    /// Reads the components of the row with index `row`. `None` if there is a fault, which is recorded. For a fit, a
    /// row without any component is a fault.
    pub(crate) fn read(&self, row: usize) -> Option<Components> {
        let read = [0, 1, 2].map(|component| self.component(row, component));
        let [Some(x), Some(y), Some(z)] = read else { return None };
        let out = [x, y, z];
        if self.purpose == Purpose::Fit && out.iter().all(Option::is_none) {
            let hint = "give what was measured, or remove the row";
            self.table.row_fault(row, &self.names.values.join(", "), "no component is given".into(), hint);
            return None;
        }
        Some(out)
    }

    /// Reads the value of a component from the cell at `row` and `column`. `None` if there is a fault, which is
    /// recorded.
    fn value(&self, row: usize, column: usize) -> Option<f64> {
        let text = self.table.text(row, column);
        if NOTHING.contains(&text.to_lowercase().as_str()) {
            let problem = format!("\"{text}\" is not a number");
            let hint = "leave the cell blank if nothing was read";
            self.table.row_fault(row, &self.table.columns[column], problem, hint);
            return None;
        }
        measured(self.table, row, column)
    }

    /// Reads the component with index `component` (0, 1, 2 for x, y, z) and its standard deviation. The outer value is
    /// `None` if there is a fault. The inner value is `None` if the component was not measured.
    fn component(&self, row: usize, component: usize) -> Option<Option<Component>> {
        let is_given = |c: &usize| !self.table.is_blank(row, *c);
        let Some(value) = self.values[component].filter(is_given) else { return Some(None) };
        let value_mm = self.value(row, value);
        let own = self.sigmas[component].filter(is_given).or(self.common).or(self.sigmas[component]);
        let sigma_mm = match (own, self.purpose) {
            (Some(column), Purpose::Fit) => sigma(self.table, row, column),
            (None, Purpose::Fit) => None,
            // a prediction does not use the standard deviation, so any positive value will do
            (_, Purpose::Predict) => Some(1.0),
        };
        Some(Some(Component { value_mm: value_mm?, sigma_mm: sigma_mm? }))
    }
}

/// Texts that people write into a cell if nothing was read. They are faults; a blank cell is expected.
const NOTHING: [&str; 9] = ["-", "--", "\u{2013}", "\u{2014}", "/", "?", "n/a", "na", "none"];

/// Sentence on the components that have a column without any reading; `None` if there are none.
pub(crate) fn never_read(table: &Table, names: &Names, rows: &[&mut Components]) -> Option<String> {
    let is_blank =
        |c: &usize| table.optional(names.values[*c]).is_some() && rows.iter().all(|row| row[*c].is_none());
    let blank: Vec<&str> = (0..3).filter(is_blank).map(|c| names.values[c]).collect();
    (!blank.is_empty() && !rows.is_empty()).then(|| {
        format!(
            "{}: columns without any reading, taken as not measured: {}",
            table.short_name(),
            blank.join(", ")
        )
    })
}

/// Replaces readings in `rows` that are in the file but were not measured by `None`, and returns a sentence on each
/// case. The cases are constant columns and zeros of other directions (see the head of this file). `file` is the name
/// of the file for the sentences. Nothing is replaced, and the result is empty, if there are fewer than
/// [`FEWEST_ALIKE`] rows.
pub(crate) fn leave_out_idle(file: &str, names: &Names, rows: &mut [&mut Components]) -> Vec<String> {
    if rows.len() < FEWEST_ALIKE {
        return Vec::new();
    }
    if let Some(sentence) = leave_out_other_directions(file, names, rows) {
        return vec![sentence];
    }
    let constants = [0, 1, 2].map(|component| constant(component, rows));
    let is_read = |component: usize| rows.iter().any(|row| row[component].is_some());
    // if no component varies, the instrument did not work; the readings stay, and the verdict reports it
    if (0..3).all(|component| constants[component].is_some() || !is_read(component)) {
        return Vec::new();
    }
    let idle = constants.into_iter().enumerate().filter_map(|(component, value)| Some((component, value?)));
    idle.map(|(component, (value_mm, count))| {
        rows.iter_mut().for_each(|row| row[component] = None);
        format!(
            "{file}: {} is {value_mm} in all {count} rows, which no instrument with noise reads: it is taken as not \
             measured; leave a direction that nothing reads blank",
            names.values[component]
        )
    })
    .collect()
}

/// Value \[mm\] of the component with index `component` if it is the same in all rows that have this component, and the
/// number of these rows. `None` if the values differ or are fewer than [`FEWEST_ALIKE`].
fn constant(component: usize, rows: &[&mut Components]) -> Option<(f64, usize)> {
    let mut values = rows.iter().filter_map(|row| row[component]).map(|read| read.value_mm);
    let first = values.next()?;
    let others: Vec<f64> = values.collect();
    let count = others.len() + 1;
    (count >= FEWEST_ALIKE && others.iter().all(|value| *value == first)).then_some((first, count))
}

/// Replaces the zeros of a gauge that was moved from one direction to the next by `None`, and returns a sentence on it.
/// Such zeros are recognized if every row has three components, at least two of which are exactly zero, and if not all
/// rows are about the same direction. Otherwise nothing is replaced, and the result is `None`.
fn leave_out_other_directions(file: &str, names: &Names, rows: &mut [&mut Components]) -> Option<String> {
    let is_zero = |read: &Option<Component>| read.is_some_and(|read| read.value_mm == 0.0);
    let has_one =
        |row: &Components| row.iter().all(Option::is_some) && row.iter().filter(|r| is_zero(r)).count() >= 2;
    let directions = (0..3).filter(|&c| rows.iter().any(|row| !is_zero(&row[c]))).count();
    if directions < 2 || !rows.iter().all(|row| has_one(row)) {
        return None;
    }
    for row in rows.iter_mut().filter(|row| row.iter().any(|read| !is_zero(read))) {
        row.iter_mut().filter(|read| is_zero(read)).for_each(|read| *read = None);
    }
    Some(format!(
        "{file}: every row has at least two zeros among {}: they are taken as not measured; leave a direction that \
         nothing reads blank",
        names.values.join(", ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn left(rows: &[[f64; 3]]) -> (Vec<Components>, Vec<String>) {
        let read = |value_mm: f64| Some(Component { value_mm, sigma_mm: 0.01 });
        let mut all: Vec<Components> = rows.iter().map(|row| row.map(read)).collect();
        let mut rows: Vec<&mut Components> = all.iter_mut().collect();
        let said = leave_out_idle("static.csv", &DISPLACEMENT, &mut rows);
        (all, said)
    }

    #[test]
    fn zeros_of_a_direction_that_nothing_reads_are_no_readings() {
        let (rows, said) = left(&[[0.0, 0.0, -0.1], [0.0, 0.0, -0.2], [0.0, 0.0, 0.0], [0.0, 0.0, -0.4]]);
        assert!(rows.iter().all(|row| row[0].is_none() && row[1].is_none() && row[2].is_some()));
        assert!(said.len() == 2 && said[0].contains("dx_mm is 0 in all 4 rows"), "{said:?}");
    }

    #[test]
    fn zeros_of_a_gauge_that_is_turned_are_no_readings() {
        let (rows, said) = left(&[[0.0, 0.0, -0.1], [0.2, 0.0, 0.0], [0.0, 0.3, 0.0], [0.0, 0.0, -0.4]]);
        assert!(rows.iter().all(|row| row.iter().flatten().count() == 1), "{rows:?}");
        assert_eq!(said.len(), 1);
    }

    #[test]
    fn what_varies_and_what_is_dead_altogether_is_kept() {
        let (rows, said) = left(&[[0.0, 0.1, -0.1], [0.1, 0.0, -0.2], [0.0, 0.0, -0.3], [0.0, 0.2, -0.4]]);
        assert!(said.is_empty() && rows.iter().flatten().all(Option::is_some));
        let (rows, said) = left(&[[0.5, 0.5, 0.5]; 5]);
        assert!(said.is_empty() && rows.iter().flatten().all(Option::is_some), "the verdict says it");
    }
}
