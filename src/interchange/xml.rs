//! Writer of XML text: indented elements with attributes, whose values are escaped.

use nalgebra::Vector3;
use std::fmt::Write;

/// An XML document that is written element by element.
#[derive(Debug, Default)]
pub(crate) struct Xml {
    text: String,
    open: Vec<&'static str>,
}

impl Xml {
    /// Begins a document, with a comment that says what it is.
    pub(crate) fn new(comment: &str) -> Self {
        // XML allows no two hyphens inside a comment
        let comment = comment.replace("--", "- -");
        Self { text: format!("<?xml version=\"1.0\"?>\n<!-- {comment} -->\n"), open: Vec::new() }
    }

    fn tag(&mut self, name: &str, attributes: &[(&str, String)], end: &str) {
        let indent = "  ".repeat(self.open.len());
        let attributes: String =
            attributes.iter().map(|(key, value)| format!(" {key}=\"{}\"", escaped(value))).collect();
        let _ = writeln!(self.text, "{indent}<{name}{attributes}{end}");
    }

    /// Opens an element with attributes.
    pub(crate) fn open(&mut self, name: &'static str, attributes: &[(&str, String)]) {
        self.tag(name, attributes, ">");
        self.open.push(name);
    }

    /// Adds an element without content.
    pub(crate) fn leaf(&mut self, name: &str, attributes: &[(&str, String)]) {
        self.tag(name, attributes, "/>");
    }

    /// Closes the element that was opened last.
    pub(crate) fn close(&mut self) {
        if let Some(name) = self.open.pop() {
            let indent = "  ".repeat(self.open.len());
            let _ = writeln!(self.text, "{indent}</{name}>");
        }
    }

    /// The text of the document. Elements that are still open are closed.
    pub(crate) fn finish(mut self) -> String {
        while !self.open.is_empty() {
            self.close();
        }
        self.text
    }
}

/// A text with the characters escaped that have a meaning in XML.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Three numbers as text, each in the shortest form that reads back unchanged.
pub(crate) fn triple(vector: &Vector3<f64>) -> String {
    numbers(vector.as_slice())
}

/// Numbers as text with spaces between them. A negative zero is written as zero.
pub(crate) fn numbers(numbers: &[f64]) -> String {
    numbers.iter().map(|x| format!("{}", x + 0.0)).collect::<Vec<_>>().join(" ")
}
