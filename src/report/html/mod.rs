//! Pages for a browser: one self-contained file a study, a campaign or a comparison.
//!
//! A page opens from disk: style, program, data and pictures are inside it, and its content security
//! policy forbids the network, `eval` and inline handlers. Everything can be read without the program:
//! pictures are the same SVG that stands beside the page in `plots/`, tables are tables. The program adds
//! views that are linked: hovering, brushing, filters. [`study`], [`campaign`] and [`comparison`] take plain
//! values from the rooms below and fill the templates beside this file.

pub mod campaign;
pub mod comparison;
pub mod document;
pub mod front_data;
pub mod front_views;
pub(crate) mod packed;
pub mod pick;
pub mod positions;
pub mod study;

use super::table::{Align, Table};
use minijinja::Environment;
use serde::Serialize;
use serde_json::{Value, json};

/// Folder beside a page that holds its pictures and the numbers behind them.
pub const PLOTS: &str = "plots";

const STYLE: &str = include_str!("page.css");
const PROGRAM: &str = include_str!("page.js");
const TEMPLATES: [(&str, &str); 7] = [
    ("macros.html", include_str!("macros.html")),
    ("base.html", include_str!("base.html")),
    ("front.html", include_str!("front.html")),
    ("study.html", include_str!("study.html")),
    ("campaign.html", include_str!("campaign.html")),
    ("comparison.html", include_str!("comparison.html")),
    ("document.html", include_str!("document.html")),
];

/// A picture with the numbers behind it.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Figure {
    /// Name of its files, without ending.
    pub name: String,
    /// What is said below it.
    pub caption: String,
    /// The picture.
    pub svg: String,
    /// The numbers behind it; empty if they stand in another file.
    pub csv: String,
}

/// A titled part of a page that another room fills: a stiffness budget, a certificate, a run with the
/// corrected arm.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Extra {
    /// Title.
    pub title: String,
    /// Paragraphs.
    pub words: Vec<String>,
    /// Tables with their captions.
    pub tables: Vec<(String, Table)>,
    /// Pictures.
    pub figures: Vec<Figure>,
}

/// A page and the files that go with it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Page {
    /// `report.html`.
    pub html: String,
    /// Pictures and tables with their names below [`PLOTS`].
    pub files: Vec<(String, Vec<u8>)>,
}

impl Page {
    /// All files with their paths beside the results.
    pub fn into_files(self) -> Vec<(String, Vec<u8>)> {
        let mut out = vec![("report.html".to_string(), self.html.into_bytes())];
        out.extend(self.files.into_iter().map(|(name, bytes)| (format!("{PLOTS}/{name}"), bytes)));
        out
    }
}

/// Collects the figures of a page: hands out their places on it and keeps their files.
#[derive(Debug, Default)]
pub(super) struct Gallery {
    files: Vec<(String, Vec<u8>)>,
}

impl Gallery {
    /// A figure as its template shows it; its files are kept.
    pub(super) fn show(&mut self, figure: &Figure) -> Value {
        let name = &figure.name;
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

    /// A part that another room filled, as its template shows it.
    pub(super) fn extra(&mut self, extra: &Extra) -> Value {
        let figures: Vec<Value> = extra.figures.iter().map(|f| self.show(f)).collect();
        let tables: Vec<Value> = extra
            .tables
            .iter()
            .map(|(caption, t)| json!({ "caption": caption, "table": table(t) }))
            .collect();
        json!({ "title": extra.title, "words": extra.words, "tables": tables, "figures": figures })
    }

    /// Fills a template and closes the collection.
    pub(super) fn page(self, template: &str, title: &str, content: Value, data: &Value) -> Page {
        Page { html: render(template, title, content, data), files: self.files }
    }
}

/// Letters from which on a cell needs room to be read.
const WORDY: usize = 40;

/// A table as its template shows it: headers and rows of cells, with the side each column stands on.
pub(super) fn table(table: &Table) -> Value {
    let is_wordy = |i: usize| table.rows().iter().any(|row| row[i].chars().count() > WORDY);
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

/// A picture to stand inside a page: names that pictures share are made its own, so that hiding one does
/// not take the markers of another with it.
fn inline(svg: &str, number: usize) -> String {
    svg.replace(" id=\"", &format!(" id=\"p{number}-"))
        .replace("url(#", &format!("url(#p{number}-"))
        .replacen("<svg ", "<svg class=\"plot\" ", 1)
}

/// Fills a template. The policy lets run and style only what carries the page's own word.
fn render(template: &str, title: &str, content: Value, data: &Value) -> String {
    let mut environment = Environment::new();
    environment.add_filter("anchor", |name: String| study::anchor(&name));
    environment.add_filter("bound", |words: String| bound(&words));
    for (name, text) in TEMPLATES {
        environment.add_template(name, text).expect("the templates are part of the program and parse");
    }
    let nonce = blake3::hash(format!("{STYLE}{PROGRAM}{title}").as_bytes()).to_hex().to_string();
    let page = json!({
        "title": title,
        "nonce": &nonce[..24],
        "style": STYLE,
        "program": PROGRAM,
        "data": script_json(data),
        "version": env!("CARGO_PKG_VERSION"),
        "plots": PLOTS,
    });
    let template = environment.get_template(template).expect("the template is listed above");
    let mut values = content;
    values["page"] = page;
    template
        .render(minijinja::value::Serde(&values))
        .expect("the templates use only what the pages give them")
}

/// Words whose numbers do not part from their units at the end of a line.
fn bound(words: &str) -> String {
    let units = ["%", "mm", "kg", "Hz", "EUR"].map(|unit| (format!(" {unit}"), format!("\u{a0}{unit}")));
    units.iter().fold(words.to_string(), |text, (apart, joined)| text.replace(apart, joined))
}

/// JSON that may stand in a script element: no `<`, which could end it.
fn script_json(data: &Value) -> String {
    data.to_string().replace('<', "\\u003c").replace('\u{2028}', "\\u2028").replace('\u{2029}', "\\u2029")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_in_a_page_cannot_end_its_script() {
        let data = json!({"name": "</script><script>alert(1)</script>"});
        assert!(!script_json(&data).contains('<'));
    }

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
