//! Named questions: read, resolve, run.

pub(crate) mod alternatives;
pub(crate) mod ballast;
pub(crate) mod bounds;
pub(crate) mod budget;
pub(crate) mod check;
pub(crate) mod diagnose;
pub(crate) mod effects;
pub(crate) mod near;
pub(crate) mod outcome;
pub(crate) mod page;
pub mod question;
pub(crate) mod read;
pub(crate) mod sections;
pub(crate) mod table;
pub(crate) mod ties;
pub(crate) mod tolerance;

pub use ballast::{BallastFlags, ballast_flags};
pub use budget::budgets;
pub use check::{Claim, Completeness, FrontCheck, check_front};
pub use diagnose::{empty_pieces, why_infeasible};
pub use effects::{Carried, CorrectedStudy, carry_over, left_out};
pub use near::{NearFront, near_front};
pub use outcome::{ExactStudy, Extent, Front, Judged, OfMaterial, StudyOutcome, run_exact, run_study};
pub use page::study_page;
pub use read::{Study, read_study};
pub use table::{front_table, slug};
pub use ties::{Ties, ties};
pub use tolerance::{Sampling, Tolerance, part, scatter_front};

/// The built-in studies: name and text.
pub const NAMED: [(&str, &str); 7] = [
    ("compare-materials", include_str!("../../studies/compare-materials.json")),
    ("light-arm", include_str!("../../studies/light-arm.json")),
    ("stiff-arm", include_str!("../../studies/stiff-arm.json")),
    ("underwater-arm", include_str!("../../studies/underwater-arm.json")),
    ("full-catalog", include_str!("../../studies/full-catalog.json")),
    ("paper-hydraulic", include_str!("../../studies/paper-hydraulic.json")),
    ("paper-electric", include_str!("../../studies/paper-electric.json")),
];

/// The text of a built-in study.
pub fn named(name: &str) -> Option<&'static str> {
    NAMED.iter().find(|(n, _)| *n == name).map(|(_, text)| *text)
}

/// Names of all built-in studies, the paper's included.
pub fn names() -> Vec<&'static str> {
    NAMED.iter().map(|(name, _)| *name).chain(crate::paper::NAMES).collect()
}

/// The built-in studies with their questions, as a list.
pub fn list() -> String {
    let mut out = String::from("Built-in studies (armwright run NAME):\n");
    for (name, text) in NAMED {
        let study: serde_json::Value = serde_json::from_str(text).unwrap_or_default();
        let question = study["question"].as_str().unwrap_or_default();
        out.push_str(&format!("  {name:<20} {question}\n"));
    }
    out.push_str("The paper's own:\n");
    for (name, what) in crate::paper::NAMES.iter().zip(PAPER_QUESTIONS) {
        out.push_str(&format!("  {name:<20} {what}\n"));
    }
    out
}

/// What one of the paper's studies shows.
pub fn paper_question(name: &str) -> Option<&'static str> {
    crate::paper::NAMES.iter().zip(PAPER_QUESTIONS).find(|(n, _)| **n == name).map(|(_, what)| what)
}

/// What each of the paper's studies shows, in the order of [`paper::NAMES`].
const PAPER_QUESTIONS: [&str; 4] = [
    "Table 1: deflection, frequencies, stiffer drives; the paper's numbers beside ours",
    "Fig 2: deflection of a steel, titanium and aluminium beam over its weight",
    "Fig 3: is weight better spent in width or in wall?",
    "Fig 4: composites against aluminium",
];
