//! Reads a sheet of a spreadsheet (xlsx, xlsm, xlsb, xls, ods) as rows of text.

use calamine::{Data, Reader, open_workbook_auto};
use std::path::Path;

/// Extensions of spreadsheets.
const EXTENSIONS: [&str; 5] = ["xlsx", "xlsm", "xlsb", "xls", "ods"];

/// A sheet of a spreadsheet as text.
#[derive(Debug)]
pub(crate) struct Sheet {
    /// Name of the sheet.
    pub name: String,
    /// Rows that are not blank, each with its row number as the spreadsheet shows it.
    pub rows: Vec<(usize, Vec<String>)>,
    /// Letters by which the spreadsheet shows the columns, such as A, B, AA.
    pub letters: Vec<String>,
}

/// Whether a file is a spreadsheet, judged by the extension of its name.
pub(crate) fn is_spreadsheet(path: &Path) -> bool {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
    EXTENSIONS.contains(&extension.as_str())
}

/// Reads the sheet with the name `sheet`. If `sheet` is `None`, the file must have one sheet only, which is read.
///
/// # Errors
/// The problem, and a hint on what to do.
pub(crate) fn read_sheet(path: &Path, sheet: Option<&str>) -> Result<Sheet, (String, String)> {
    let unreadable = |e: String| {
        (
            format!("cannot be read as a spreadsheet: {e}"),
            "save it again as .xlsx or .ods, or as CSV".to_string(),
        )
    };
    let mut book = open_workbook_auto(path).map_err(|e| unreadable(e.to_string()))?;
    let names = book.sheet_names();
    let name = match (sheet, names.as_slice()) {
        (Some(sheet), names) if names.iter().any(|name| name == sheet) => sheet.to_string(),
        (None, [only]) => only.clone(),
        (Some(sheet), names) => {
            return Err((format!("has no sheet \"{sheet}\""), format!("its sheets: {}", names.join(", "))));
        }
        (None, names) => {
            let hint = format!("name one in campaign.json: \"sheet\"; its sheets: {}", names.join(", "));
            return Err((format!("has {} sheets", names.len()), hint));
        }
    };
    let range = book.worksheet_range(&name).map_err(|e| unreadable(e.to_string()))?;
    let (row, column) = range.start().map_or((0, 0), |(row, column)| (row as usize, column as usize));
    // a file that no spreadsheet program has stored has formulas without values
    let formulas = book.worksheet_formula(&name).unwrap_or_default();
    let text_at = |row: usize, column: usize, cell: &Data| {
        let formula = formulas.get_value((row as u32, column as u32)).filter(|formula| !formula.is_empty());
        match (text(cell), formula) {
            (blank, Some(formula)) if blank.is_empty() => format!("formula {formula} without a value"),
            (given, _) => given,
        }
    };
    let texts = |i: usize, cells: &[Data]| -> Vec<String> {
        cells.iter().enumerate().map(|(j, cell)| text_at(row + i, column + j, cell)).collect()
    };
    let rows = range.rows().enumerate().map(|(i, cells)| (row + i + 1, texts(i, cells)));
    Ok(Sheet {
        name,
        rows: rows.filter(|(_, cells)| cells.iter().any(|cell| !cell.is_empty())).collect(),
        letters: (column..column + range.width()).map(letters).collect(),
    })
}

fn text(cell: &Data) -> String {
    match cell {
        // a spreadsheet program may turn 3.5 or 1-2 into a date without being asked
        Data::DateTime(_) | Data::DateTimeIso(_) | Data::DurationIso(_) => format!("{cell} (a date)"),
        other => other.to_string().trim().to_string(),
    }
}

/// The letters by which a spreadsheet shows a column, counted from 0: A, B, ..., Z, AA, AB ...
fn letters(mut column: usize) -> String {
    let mut out = Vec::new();
    loop {
        out.push(b'A' + (column % 26) as u8);
        if column < 26 {
            break;
        }
        column = column / 26 - 1;
    }
    out.iter().rev().map(|letter| *letter as char).collect()
}

#[cfg(test)]
mod tests {
    use super::letters;

    #[test]
    fn columns_have_the_letters_of_a_spreadsheet() {
        let of = [0, 25, 26, 51, 52, 701, 702].map(letters);
        assert_eq!(of, ["A", "Z", "AA", "AZ", "BA", "ZZ", "AAA"]);
    }
}
