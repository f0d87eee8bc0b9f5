//! Divides the text of a catalog file into rows. Faults of its form are recorded in the log, not returned.

use super::log::Log;
use super::row::Row;
use crate::catalog::schema::CatalogFile;
use crate::input::csv::{Csv, Record, is_repeated, other_separators};
use crate::input::json::closest;
use std::collections::BTreeMap;

/// The rows of a catalog file. A row that has not as many fields as the header is reported and left out.
pub(crate) fn rows<'a>(file: CatalogFile, name: &'a str, bytes: &[u8], log: &'a Log) -> Vec<Row<'a>> {
    let mut records = records(name, bytes, log).into_iter();
    let Some(Record { line, cells: header }) = records.next() else {
        log.fault(name, None, "", "is empty".into(), format!("begin with the header {}", required(file)));
        return Vec::new();
    };
    let Some(places) = header_places(file, name, line, &header, log) else {
        return Vec::new();
    };
    let mut out = Vec::new();
    for Record { line, cells } in records.filter(|r| r.cells.iter().any(|cell| !cell.is_empty())) {
        if cells.len() == header.len() {
            let cells = places.iter().map(|place| place.map(|i| cells[i].clone())).collect();
            let row = Row::new(file, name, line, cells, log);
            row.check_cells();
            out.push(row);
        } else {
            log.fault(
                name,
                Some(line),
                "",
                format!("has {} fields, not the {} of the header", cells.len(), header.len()),
                "put text that contains a comma in \"quotes\"; the decimal sign is a point".into(),
            );
        }
    }
    refuse_duplicates(file, &out);
    out
}

/// Largest number of parts in a catalog file. It is limited because every gear is paired with every motor, and
/// every material with every section.
const MOST_PARTS: usize = 100_000;

/// The records of a CSV text. Records that cannot be read are reported and left out.
fn records(name: &str, bytes: &[u8], log: &Log) -> Vec<Record> {
    let csv = Csv::parse_up_to(MOST_PARTS, bytes, None);
    for (line, problem) in csv.unreadable {
        let problem = format!("cannot be read: {problem}");
        log.fault(
            name,
            Some(line),
            "",
            problem,
            "save the file as UTF-8 text, and keep the parts that matter".into(),
        );
    }
    csv.records
}

fn required(file: CatalogFile) -> String {
    let names: Vec<_> = file.columns().iter().filter(|c| c.required).map(|c| c.name).collect();
    names.join(",")
}

/// The place of each known column in the header; `None` for a column that the header does not have. The whole result is
/// `None` if the text is not separated by commas.
fn header_places(
    file: CatalogFile,
    name: &str,
    line: usize,
    header: &[String],
    log: &Log,
) -> Option<Vec<Option<usize>>> {
    let joined = if header.len() == 1 { header } else { &[] };
    if let Some(separator) = other_separators(joined, 1).next() {
        let problem = format!("the columns are separated by {separator}");
        log.fault(
            name,
            Some(line),
            "",
            problem,
            "separate them by commas; the decimal sign is a point".into(),
        );
        return None;
    }
    let unknown = unknown_columns(file, name, line, header, log);
    let columns = file.columns();
    let places: Vec<_> = columns.iter().map(|c| header.iter().position(|h| h == c.name)).collect();
    for (column, _) in columns.iter().zip(&places).filter(|(c, place)| c.required && place.is_none()) {
        // a missing column is not reported again if an unknown column with a similar name has been reported
        if !unknown.contains(&Some(column.name)) {
            let hint = format!("required columns: {}", required(file));
            log.fault(name, Some(line), column.name, "this column is missing".into(), hint);
        }
    }
    Some(places)
}

/// Reports columns that are unknown or repeated. Returns, for each unknown column, the known name that is most
/// similar.
fn unknown_columns(
    file: CatalogFile,
    name: &str,
    line: usize,
    header: &[String],
    log: &Log,
) -> Vec<Option<&'static str>> {
    let known: Vec<_> = file.columns().iter().map(|c| c.name).collect();
    let mut nearest = Vec::new();
    for (i, column) in header.iter().enumerate() {
        if is_repeated(header, i) {
            log.fault(name, Some(line), column, "this column is there twice".into(), "keep one".into());
        } else if !known.contains(&column.as_str()) {
            let absent: Vec<_> = known.iter().copied().filter(|k| !header.iter().any(|h| h == *k)).collect();
            let near = closest(column, &absent);
            let hint = match near {
                Some(near) => format!("did you mean \"{near}\"? known columns: {}", known.join(", ")),
                None => format!("known columns: {}", known.join(", ")),
            };
            log.fault(name, Some(line), column, "unknown column".into(), hint);
            nearest.push(near);
        }
    }
    nearest
}

fn refuse_duplicates(file: CatalogFile, rows: &[Row]) {
    let mut first: BTreeMap<String, usize> = BTreeMap::new();
    for row in rows {
        let cells: Vec<_> = file.key().iter().map(|column| row.text(column)).collect();
        if cells.iter().all(|cell| cell.is_empty()) {
            continue;
        }
        let id = cells.join("-");
        match first.get(&id.to_lowercase()) {
            None => {
                first.insert(id.to_lowercase(), row.line());
            }
            Some(earlier) => row.fault(
                &file.key().join(","),
                format!("\"{id}\" is already on line {earlier}"),
                "a file names each part once; delete one of the rows",
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn faults(text: &str) -> Vec<String> {
        let log = Log::default();
        rows(CatalogFile::Materials, "m.csv", text.as_bytes(), &log);
        log.faults.into_inner().iter().map(ToString::to_string).collect()
    }

    #[test]
    fn lines_are_counted_with_blank_lines_crlf_quotes_and_a_byte_order_mark() {
        let text = "\u{feff}name,class,e_pa,density_kg_m3,source,confidence\r\n\r\na,metal,1,1,\"two\r\nlines\",verified\r\nb,metal,1,1,s,verified\r\n";
        let log = Log::default();
        let rows = rows(CatalogFile::Materials, "m.csv", text.as_bytes(), &log);
        assert_eq!(rows.iter().map(Row::line).collect::<Vec<_>>(), [3, 5]);
        assert!(log.faults.borrow().is_empty(), "{:?}", log.faults);
    }

    #[test]
    fn a_semicolon_file_is_one_fault() {
        let found = faults("name;class;e_pa\nx;metal;2,1e11\ny;metal;2\n");
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].contains("semicolons"), "{found:?}");
    }

    #[test]
    fn a_misspelt_required_column_is_reported_once() {
        let found = faults("name,class,e_Pa,density_kg_m3,source,confidence\n");
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].starts_with("m.csv:1: e_Pa: unknown column; did you mean \"e_pa\"?"), "{found:?}");
    }

    #[test]
    fn an_empty_file_says_so() {
        assert!(faults("")[0].contains("is empty"));
    }

    #[test]
    fn bytes_that_are_not_utf8_are_named_by_line() {
        let log = Log::default();
        rows(
            CatalogFile::Materials,
            "m.csv",
            b"name,class,e_pa,density_kg_m3,source,confidence\n\xff,metal,1,1,s,verified\n",
            &log,
        );
        assert_eq!(log.faults.borrow()[0].line, Some(2));
    }
}
