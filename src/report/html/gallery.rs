//! The pictures of a page, with their files, and tables in the form that templates need.

use super::render::{PLOTS, render};
use crate::report::file_names::unique_file_name;
use crate::report::section::{Figure, PageSection};
use crate::report::table::{Align, Table};
use serde_json::{Value, json};
use std::collections::HashSet;

/// A page, with the files that belong to it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Page {
    /// Content of `report.html`.
    pub html: String,
    /// Pictures and tables: name of the file in the folder [`PLOTS`], and content.
    pub files: Vec<(String, Vec<u8>)>,
}

impl Page {
    /// All files, with their paths relative to the result folder.
    pub fn into_files(self) -> Vec<(String, Vec<u8>)> {
        let mut out = vec![("report.html".to_string(), self.html.into_bytes())];
        out.extend(self.files.into_iter().map(|(name, bytes)| (format!("{PLOTS}/{name}"), bytes)));
        out
    }
}

/// Collects the figures of a page and their files.
#[derive(Debug, Default)]
pub(super) struct Gallery {
    names: HashSet<String>,
    files: Vec<(String, Vec<u8>)>,
}

impl Gallery {
    /// A figure in the form that templates need. Its picture and its numbers are added to the files of the page.
    pub(super) fn show(&mut self, figure: &Figure) -> Value {
        let name = unique_file_name(&figure.name, &mut self.names);
        self.files.push((format!("{name}.svg"), figure.svg.clone().into_bytes()));
        if !figure.csv.is_empty() {
            self.files.push((format!("{name}.csv"), figure.csv.clone().into_bytes()));
        }
        json!({
            "name": name,
            "caption": figure.caption,
            "svg": inline(&figure.svg, self.files.len()),
            "has_csv": !figure.csv.is_empty(),
        })
    }

    /// A section that comes from another folder of the source, in the form that templates need.
    pub(super) fn extra(&mut self, extra: &PageSection) -> Value {
        let figures: Vec<Value> = extra.figures.iter().map(|f| self.show(f)).collect();
        let tables: Vec<Value> = extra
            .tables
            .iter()
            .map(|(caption, t)| json!({ "caption": caption, "table": table(t) }))
            .collect();
        json!({ "title": extra.title, "words": extra.words, "tables": tables, "figures": figures })
    }

    /// Fills a template, and returns the page with the collected files.
    pub(super) fn page(self, template: &str, title: &str, content: Value, data: &Value) -> Page {
        Page { html: render(template, title, content, data), files: self.files }
    }
}

/// A column gets the wide style if a cell has more letters than this.
const WORDY_LETTERS: usize = 40;

/// A table in the form that templates need: headers and rows of cells, with a style class for each column.
pub(super) fn table(table: &Table) -> Value {
    let is_wordy = |i: usize| table.rows().iter().any(|row| row[i].chars().count() > WORDY_LETTERS);
    let columns: Vec<Value> = table
        .columns()
        .iter()
        .enumerate()
        .map(|(i, c)| {
            let class = match c.align {
                Align::Right => "n",
                Align::Left if is_wordy(i) => "wordy",
                Align::Left => "",
            };
            json!({ "name": c.header, "class": class })
        })
        .collect();
    json!({ "columns": columns, "rows": table.rows() })
}

/// An SVG picture to be put into a page. Its ids are made unique on the page, so that hiding one picture does not
/// remove the markers of another.
fn inline(svg: &str, number: usize) -> String {
    svg.replace(" id=\"", &format!(" id=\"p{number}-"))
        .replace("url(#", &format!("url(#p{number}-"))
        .replacen("<svg ", "<svg class=\"plot\" ", 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_escaped_and_the_policy_forbids_the_network() {
        let mut gallery = Gallery::default();
        let content = json!({ "question": "<b>", "words": vec!["a < b"], "tables": Vec::<Value>::new(),
            "figures": vec![gallery.show(&Figure::default())], "facts": Vec::<Value>::new() });
        let html = gallery.page("document.html", "a & b", content, &json!({})).html;
        assert!(html.contains("a &amp; b") && html.contains("a &lt; b") && !html.contains("<b>"));
        assert!(html.contains("default-src &#x27;none&#x27;") || html.contains("default-src 'none'"));
        for forbidden in ["http://", "https://", "eval(", "new Function", "onclick=", "onload=", "unsafe"] {
            let inside = html.replace("http://www.w3.org/2000/svg", "");
            assert!(!inside.contains(forbidden), "the page contains {forbidden}");
        }
    }

    #[test]
    fn pictures_in_one_page_have_names_of_their_own() {
        let svg = "<svg x><marker id=\"m0\"/><path marker-mid=\"url(#m0)\"/></svg>";
        assert_eq!(
            inline(svg, 3),
            "<svg class=\"plot\" x><marker id=\"p3-m0\"/><path marker-mid=\"url(#p3-m0)\"/></svg>"
        );
    }
}
