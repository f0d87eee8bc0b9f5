//! Makes a page from its template. Style, program and data are put into the one file.

use minijinja::Environment;
use serde_json::{Value, json};

/// Name of the folder next to a page that contains its pictures, and the numbers of the pictures as CSV.
pub(crate) const PLOTS: &str = "plots";

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

/// Fills a template. The content security policy of the page allows only those scripts and styles that are marked with
/// its nonce, a hash of style, program and title.
pub(super) fn render(template: &str, title: &str, content: Value, data: &Value) -> String {
    let mut environment = Environment::new();
    environment.add_filter("anchor", |name: String| anchor(&name));
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

/// The text with a no-break space between each number and its unit.
fn bound(words: &str) -> String {
    let units = ["%", "mm", "kg", "Hz", "EUR"].map(|unit| (format!(" {unit}"), format!("\u{a0}{unit}")));
    units.iter().fold(words.to_string(), |text, (apart, joined)| text.replace(apart, joined))
}

/// JSON that can be put into a script element: it has no `<`, which could end the element.
fn script_json(data: &Value) -> String {
    data.to_string().replace('<', "\\u003c").replace('\u{2028}', "\\u2028").replace('\u{2029}', "\\u2029")
}

/// Name of the anchor of the part `name`, to which links on the page refer.
pub(super) fn anchor(name: &str) -> String {
    let letters = name.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' });
    format!("part-{}", letters.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_in_a_page_cannot_end_its_script() {
        let data = json!({"name": "</script><script>alert(1)</script>"});
        assert!(!script_json(&data).contains('<'));
    }
}
