//! Line numbers of the records in a CSV file.

/// Counts the lines up to the first byte of a record. The CSV reader itself gives the line at which the previous
/// record ends. This line is wrong if blank lines follow it, or if lines end with CR and LF.
pub struct LineCounter<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
    comment: Option<u8>,
}

impl<'a> LineCounter<'a> {
    /// A counter for the text that the CSV reader reads.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, line: 1, comment: None }
    }

    /// A counter for a text in which lines that begin with `comment` are comments.
    pub fn with_comments(bytes: &'a [u8], comment: u8) -> Self {
        Self { comment: Some(comment), ..Self::new(bytes) }
    }

    /// The line, counted from 1, of the record at this position. Records must be asked for in the order of the
    /// text.
    pub fn of(&mut self, position: Option<&csv::Position>) -> usize {
        let begin = position.map_or(self.at, |p| p.byte() as usize).min(self.bytes.len());
        let end = self.skipped(begin).max(self.at);
        self.line += self.bytes[self.at..end].iter().filter(|&&b| b == b'\n').count();
        self.at = end;
        self.line
    }

    /// The first position at or after `from` that is not in a blank line or a comment.
    fn skipped(&self, from: usize) -> usize {
        let mut at = from;
        loop {
            at += self.bytes[at..].iter().take_while(|b| matches!(b, b'\r' | b'\n')).count();
            if self.comment.is_none() || self.bytes.get(at) != self.comment.as_ref() {
                return at;
            }
            at += self.bytes[at..].iter().take_while(|b| **b != b'\n').count();
        }
    }

    /// The line of the last record that was asked for.
    pub fn line(&self) -> usize {
        self.line
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_those_of_an_editor_with_any_line_end_blank_lines_and_comments() {
        for end in ["\n", "\r\n"] {
            let text = ["a,b", "# drawn by hand", "1,2", "", "# twice", "# more", "3,4", "5,6"].join(end);
            let mut reader =
                csv::ReaderBuilder::new().has_headers(false).comment(Some(b'#')).from_reader(text.as_bytes());
            let mut lines = LineCounter::with_comments(text.as_bytes(), b'#');
            let found: Vec<usize> =
                reader.records().map(|record| lines.of(record.expect("sound").position())).collect();
            assert_eq!(found, [1, 3, 7, 8], "{end:?}");
        }
    }
}
