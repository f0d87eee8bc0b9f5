//! The page of a study that consists of pictures and tables, such as the paper's own.

use super::gallery::{Gallery, Page, table};
use crate::report::section::Figure;
use crate::report::table::Table;
use serde_json::{Value, json};

/// The contents of a page of pictures and tables.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct DocumentPage {
    /// Title of the page.
    pub title: String,
    /// The question that the study answers.
    pub question: String,
    /// Paragraphs of text.
    pub words: Vec<String>,
    /// Pictures.
    pub figures: Vec<Figure>,
    /// Tables with their captions.
    pub tables: Vec<(String, Table)>,
    /// Facts of the run: pairs of name and value.
    pub facts: Vec<(String, String)>,
    /// The facts that differ from run to run, such as how long the run took.
    pub timing: Vec<(String, String)>,
}

impl DocumentPage {
    /// The page of the study as HTML, with its pictures.
    pub(crate) fn page(&self) -> Page {
        let mut gallery = Gallery::default();
        let figures: Vec<Value> = self.figures.iter().map(|f| gallery.show(f)).collect();
        let tables: Vec<Value> =
            self.tables.iter().map(|(caption, t)| json!({"caption": caption, "table": table(t)})).collect();
        let content = json!({
            "question": self.question, "words": self.words, "figures": figures, "tables": tables, "facts": self.facts,
            "timing": self.timing,
        });
        gallery.page("document.html", &self.title, content, &json!({}))
    }
}
