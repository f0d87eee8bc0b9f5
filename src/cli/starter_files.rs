//! The files with which a new study, arm or catalog folder starts. They are valid as they are, and a page explains
//! each block.

/// Name of the page that explains the files.
pub(super) const PAGE: &str = "STARTER.md";

/// Word in the files that is replaced by the name of the new study or arm.
const NAME: &str = "NAME";
/// Word in the files that is replaced by the path of the new folder.
const FOLDER: &str = "FOLDER";

type Texts = &'static [(&'static str, &'static str)];

/// The files of a study with two joints and two open links.
pub(super) const STUDY: Texts =
    &[("study.json", include_str!("starters/study.json")), (PAGE, include_str!("starters/study.md"))];

/// The files of an arm with two joints, and of cases for it.
pub(super) const ARM: Texts = &[
    ("arm.json", include_str!("starters/arm.json")),
    ("cases.json", include_str!("starters/cases.json")),
    (PAGE, include_str!("starters/arm.md")),
];

/// Catalog files with one example row each.
pub(super) const PARTS: Texts = &[
    ("gears.csv", include_str!("starters/gears.csv")),
    ("motors.csv", include_str!("starters/motors.csv")),
    ("materials.csv", include_str!("starters/materials.csv")),
    ("profiles.csv", include_str!("starters/profiles.csv")),
    (PAGE, include_str!("starters/parts.md")),
];

/// The files `texts` with `name`, the name of the new study or arm, and `folder`, its folder, filled in.
pub(super) fn filled(texts: Texts, name: &str, folder: &str) -> Vec<(String, Vec<u8>)> {
    // between quotation marks the name is a JSON string, so special characters in it are escaped
    let quoted = serde_json::Value::from(name).to_string();
    let fill = |(file, text): &(&str, &str)| {
        let text = text.replace(&format!("\"{NAME}\""), &quoted).replace(NAME, name).replace(FOLDER, folder);
        (file.to_string(), text.into_bytes())
    };
    texts.iter().map(fill).collect()
}
