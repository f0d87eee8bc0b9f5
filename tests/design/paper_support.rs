//! Files of a study's output as the paper's tests read them.

use armwright::paper::PaperStudyOutput;
use std::collections::HashMap;

/// One row of a CSV file by column name.
pub type Row = HashMap<String, String>;

/// A text file of an output.
pub fn file(out: &PaperStudyOutput, name: &str) -> String {
    let found = out.files.iter().find(|(n, _)| n == name).unwrap_or_else(|| panic!("no file {name}"));
    String::from_utf8(found.1.clone()).expect("text")
}

/// A CSV file of an output, row by row.
pub fn table(out: &PaperStudyOutput, name: &str) -> Vec<Row> {
    let text = file(out, name);
    csv::Reader::from_reader(text.as_bytes()).deserialize().map(|row| row.expect("row")).collect()
}

/// Panics unless tags are balanced, attributes quoted and bare `&` and `<` absent.
pub fn check_xml(text: &str) {
    let mut open: Vec<&str> = Vec::new();
    let mut pieces = text.split('<');
    assert_eq!(pieces.next(), Some(""), "text before the root");
    for piece in pieces {
        let (tag, content) = piece.split_once('>').expect("tag without end");
        check_text(content);
        let name = tag.trim_start_matches('/').split([' ', '/']).next().expect("name");
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name));
        } else {
            assert_eq!(tag.matches('"').count() % 2, 0, "unbalanced quotes in <{tag}>");
            if !tag.ends_with('/') {
                open.push(name);
            }
        }
    }
    assert!(open.is_empty(), "not closed: {open:?}");
}

fn check_text(content: &str) {
    for after in content.split('&').skip(1) {
        assert!(["amp;", "lt;", "gt;", "quot;"].iter().any(|e| after.starts_with(e)), "bare & in {content}");
    }
}
