//! The front as a table, with one row per design and units in the column names.

use std::path::Path;

/// A table of designs, as written to and read from `front.csv`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FrontTable {
    /// Column names.
    pub columns: Vec<String>,
    /// Rows; each has as many cells as there are columns.
    pub rows: Vec<Vec<String>>,
}

/// Reason why a front could not be read.
#[derive(Debug, thiserror::Error)]
pub enum FrontTableError {
    /// The file is missing or not CSV.
    #[error("cannot read {file}: {source}")]
    Unreadable {
        /// Name of the file.
        file: String,
        /// Reason that the CSV reader gives.
        source: csv::Error,
    },
    /// A column that every front must have is missing.
    #[error("{file} has no column \"{column}\": is it a front written by `armwright run`?")]
    NoColumn {
        /// Name of the file.
        file: String,
        /// Name of the missing column.
        column: &'static str,
    },
}

/// Columns of the objectives, which every front must have.
pub const OBJECTIVE_COLUMNS: [&str; 3] = ["tip_deflection_mm", "mass_kg", "lowest_mode_hz"];

impl FrontTable {
    /// The table as CSV text.
    pub fn to_csv(&self) -> Vec<u8> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        for record in std::iter::once(&self.columns).chain(&self.rows) {
            writer.write_record(record).expect("writing to memory does not fail and rows are of one length");
        }
        writer.into_inner().expect("flushing to memory does not fail")
    }

    /// Reads a front from a file.
    ///
    /// # Errors
    /// The file is missing, is not CSV, or lacks a column that every front has.
    pub fn read(path: &Path) -> Result<Self, FrontTableError> {
        let bytes = std::fs::read(path);
        let unreadable = |e: std::io::Error| FrontTableError::Unreadable {
            file: path.display().to_string(),
            source: e.into(),
        };
        Self::parse(path, &bytes.map_err(unreadable)?)
    }

    /// Reads a front from the bytes of its file. `path` is used only in messages.
    ///
    /// # Errors
    /// The bytes are not CSV, or a column is missing that every front must have.
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Self, FrontTableError> {
        let file = path.display().to_string();
        let unreadable = |source| FrontTableError::Unreadable { file: file.clone(), source };
        let mut reader = csv::Reader::from_reader(bytes);
        let columns: Vec<String> = reader.headers().map_err(unreadable)?.iter().map(String::from).collect();
        for column in OBJECTIVE_COLUMNS.into_iter().chain(["design_id"]) {
            if !columns.iter().any(|c| c == column) {
                return Err(FrontTableError::NoColumn { file, column });
            }
        }
        let rows = reader
            .records()
            .map(|r| r.map(|r| r.iter().map(String::from).collect()))
            .collect::<Result<_, _>>()
            .map_err(unreadable)?;
        Ok(Self { columns, rows })
    }

    /// Index of the column `name`; `None` if there is no such column.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|c| c == name)
    }

    /// The values of the column `name` as numbers, one for each row; `None` for a blank cell.
    pub fn numbers(&self, name: &str) -> Vec<Option<f64>> {
        match self.column(name) {
            Some(i) => self.rows.iter().map(|r| r[i].parse().ok()).collect(),
            None => vec![None; self.rows.len()],
        }
    }
}
