//! The names of the paper's studies, and the question that each answers.

/// The names of the paper's studies.
pub const NAMES: [&str; 4] = ["paper-table1", "fig2-metals", "fig3-wall-or-width", "fig4-composites"];

/// The question that one of the paper's studies answers; `None` if the name is not in [`NAMES`].
pub fn question(name: &str) -> Option<&'static str> {
    NAMES.iter().zip(QUESTIONS).find(|(n, _)| **n == name).map(|(_, what)| what)
}

/// The question that each of the paper's studies answers, in the order of [`NAMES`].
pub const QUESTIONS: [&str; 4] = [
    "Table 1: deflection, frequencies, stiffer drives; the paper's numbers beside ours",
    "Fig 2: deflection of a steel, titanium and aluminium beam over its weight",
    "Fig 3: is weight better spent in width or in wall?",
    "Fig 4: composites against aluminium",
];
