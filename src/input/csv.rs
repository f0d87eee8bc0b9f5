//! CSV text divided into records. Catalogs and readings are both read with it.
//!
//! Every record keeps its line number, so that messages about faults can name it. The caller checks the content of
//! the records.

use super::lines::LineCounter;
use csv::{ByteRecord, ReaderBuilder, StringRecord, Trim};

/// Byte order mark that some programs put before UTF-8 text.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// One record of a CSV text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Record {
    /// Line at which the record begins, counted from 1.
    pub line: usize,
    /// Cells of the record, without blanks at their ends.
    pub cells: Vec<String>,
}

/// Largest number of rows of any table. A larger table is a mistake, or too large for this program.
const MOST_ROWS: usize = 2_000_000;

/// A CSV text divided into records. Blank lines and comments are no records.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Csv {
    /// The records in the order of the text, including the header.
    pub records: Vec<Record>,
    /// Line and reason of each record that cannot be read.
    pub unreadable: Vec<(usize, String)>,
}

impl Csv {
    /// Divides a text into records. Lines that begin with the byte `comment` are left out.
    pub(crate) fn parse(bytes: &[u8], comment: Option<u8>) -> Self {
        Self::parse_up_to(MOST_ROWS, bytes, comment)
    }

    /// Divides a text into records as [`Csv::parse`] does, but with `most` as the largest number of rows. If the text
    /// has more rows, this is recorded in `unreadable`.
    pub(crate) fn parse_up_to(most: usize, bytes: &[u8], comment: Option<u8>) -> Self {
        let bytes = bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes);
        let mut reader = ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(Trim::All)
            .comment(comment)
            .from_reader(bytes);
        let mut lines = match comment {
            Some(comment) => LineCounter::with_comments(bytes, comment),
            None => LineCounter::new(bytes),
        };
        let mut out = Self::default();
        for record in reader.byte_records() {
            if out.records.len() > most {
                out.unreadable.push((lines.line(), format!("has more than {most} rows, which is the limit")));
                // a text with too many rows is refused as a whole, so its rows are not examined one by one
                out.records.truncate(1);
                break;
            }
            match record.map_err(|e| e.to_string()).and_then(|r| Ok((lines.of(r.position()), utf8(r)?))) {
                Ok((line, record)) => {
                    out.records.push(Record { line, cells: record.iter().map(String::from).collect() });
                }
                Err(problem) => out.unreadable.push((lines.line(), problem)),
            }
        }
        out
    }
}

fn utf8(record: ByteRecord) -> Result<StringRecord, String> {
    StringRecord::from_byte_record(record).map_err(|e| e.utf8_error().to_string())
}

/// The separators other than commas that occur at least `least` times in the first cell of a header. Spaces count as
/// separators only in a header of one cell without other separators. A run of spaces counts once.
pub(crate) fn other_separators(header: &[String], least: usize) -> impl Iterator<Item = &'static str> + '_ {
    let occurs = move |separator: char| header.first().is_some_and(|c| c.matches(separator).count() >= least);
    let words = [(';', "semicolons"), ('\t', "tabs")].map(|(separator, word)| (occurs(separator), word));
    let spaces = match header {
        [only] => only.split_whitespace().count() > least && !words.iter().any(|(occurs, _)| *occurs),
        _ => false,
    };
    words.into_iter().chain([(spaces, "spaces")]).filter(|(occurs, _)| *occurs).map(|(_, word)| word)
}

/// Whether an earlier column of the header has the same name as the column with the index `column`.
pub(crate) fn is_repeated(header: &[String], column: usize) -> bool {
    header[..column].contains(&header[column])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_keep_the_line_where_they_begin() {
        let text = "\u{feff}a, b\r\n# drawn by hand\r\n\r\n1,\"two\r\nlines\"\r\n3,4\r\n";
        let csv = Csv::parse(text.as_bytes(), Some(b'#'));
        assert_eq!(csv.records.iter().map(|r| r.line).collect::<Vec<_>>(), [1, 4, 6]);
        assert_eq!(csv.records[0].cells, ["a", "b"]);
    }

    #[test]
    fn bytes_that_are_not_text_are_named_by_line() {
        let csv = Csv::parse(b"a,b\n\xff,1\n2,3\n", None);
        assert_eq!((csv.records.len(), csv.unreadable[0].0), (2, 2));
    }

    #[test]
    fn a_header_says_what_separates_it_and_what_it_names_twice() {
        let header = |text: &str| Csv::parse(text.as_bytes(), None).records.remove(0).cells;
        assert_eq!(other_separators(&header("a;b;c"), 2).collect::<Vec<_>>(), ["semicolons"]);
        assert_eq!(other_separators(&header("a,b"), 1).next(), None);
        assert_eq!(other_separators(&header("q1   q2  x"), 2).collect::<Vec<_>>(), ["spaces"]);
        assert_eq!(other_separators(&header("a\tb\tc d"), 2).collect::<Vec<_>>(), ["tabs"]);
        assert_eq!(other_separators(&header("a long name,b"), 1).next(), None);
        assert!(is_repeated(&header("a,b,a"), 2) && !is_repeated(&header("a,b,a"), 1));
    }
}
