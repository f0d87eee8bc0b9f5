//! The built-in studies.

use crate::paper::names::{NAMES, QUESTIONS};

/// Name and text of each built-in study.
pub const NAMED: [(&str, &str); 7] = [
    ("compare-materials", include_str!("../../studies/compare-materials.json")),
    ("light-arm", include_str!("../../studies/light-arm.json")),
    ("stiff-arm", include_str!("../../studies/stiff-arm.json")),
    ("underwater-arm", include_str!("../../studies/underwater-arm.json")),
    ("full-catalog", include_str!("../../studies/full-catalog.json")),
    ("paper-hydraulic", include_str!("../../studies/paper-hydraulic.json")),
    ("paper-electric", include_str!("../../studies/paper-electric.json")),
];

/// The text of the built-in study with this name; `None` if there is none.
pub fn named(name: &str) -> Option<&'static str> {
    NAMED.iter().find(|(n, _)| *n == name).map(|(_, text)| *text)
}

/// Names of all built-in studies, including those of the paper.
pub fn names() -> Vec<&'static str> {
    NAMED.iter().map(|(name, _)| *name).chain(NAMES).collect()
}

/// The built-in studies with their questions, as text for the terminal.
pub fn list() -> String {
    let mut out = String::from("Built-in studies (armwright run NAME):\n");
    for (name, text) in NAMED {
        let study: serde_json::Value = serde_json::from_str(text).unwrap_or_default();
        let question = study["question"].as_str().unwrap_or_default();
        out.push_str(&format!("  {name:<20} {question}\n"));
    }
    out.push_str("The paper's own:\n");
    for (name, what) in NAMES.iter().zip(QUESTIONS) {
        out.push_str(&format!("  {name:<20} {what}\n"));
    }
    out
}
