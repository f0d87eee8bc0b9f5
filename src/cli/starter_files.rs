//! The files of a new study, a new arm and new parts: sound as they are, with a page that explains each block.

/// Name of the page that says what to put where.
pub(super) const PAGE: &str = "STARTER.md";

/// What a file may say for the name of what is started.
const NAME: &str = "NAME";
/// What a file may say for the folder.
const FOLDER: &str = "FOLDER";

type Texts = &'static [(&'static str, &'static str)];

/// A study with two joints and two open links.
pub(super) const STUDY: Texts =
    &[("study.json", include_str!("starters/study.json")), (PAGE, include_str!("starters/study.md"))];

/// An arm with two joints, and cases for it.
pub(super) const ARM: Texts = &[
    ("arm.json", include_str!("starters/arm.json")),
    ("cases.json", include_str!("starters/cases.json")),
    (PAGE, include_str!("starters/arm.md")),
];

/// Catalog files with one row each.
pub(super) const PARTS: Texts = &[
    ("gears.csv", include_str!("starters/gears.csv")),
    ("motors.csv", include_str!("starters/motors.csv")),
    ("materials.csv", include_str!("starters/materials.csv")),
    ("profiles.csv", include_str!("starters/profiles.csv")),
    (PAGE, include_str!("starters/parts.md")),
];

/// The files with the name and the folder filled in.
pub(super) fn filled(texts: Texts, name: &str, folder: &str) -> Vec<(String, Vec<u8>)> {
    // inside JSON a name is a text
    let quoted = serde_json::Value::from(name).to_string();
    let fill = |(file, text): &(&str, &str)| {
        let text = text.replace(&format!("\"{NAME}\""), &quoted).replace(NAME, name).replace(FOLDER, folder);
        (file.to_string(), text.into_bytes())
    };
    texts.iter().map(fill).collect()
}
