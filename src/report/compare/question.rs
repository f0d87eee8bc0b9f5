//! The questions that every front answers: the best value of one objective under a limit on another.

use crate::report::number::shortest;
use crate::report::picks::{Design, Objective};
use serde::Serialize;

/// A question to every front: the best value of one objective under a limit on another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Question {
    /// The smallest mass among the designs whose tip deflection is at most the limit.
    LightestAtDeflection,
    /// The smallest tip deflection among the designs whose mass is at most the limit.
    StiffestAtMass,
    /// The highest lowest mode among the designs whose mass is at most the limit.
    HighestModeAtMass,
    /// The smallest mass among the designs whose lowest mode is at least the limit.
    LightestAtMode,
}

impl Question {
    /// All questions.
    pub const ALL: [Self; 4] =
        [Self::LightestAtDeflection, Self::StiffestAtMass, Self::HighestModeAtMass, Self::LightestAtMode];

    /// The objective whose best value the question asks for.
    pub fn sought(self) -> Objective {
        match self {
            Self::LightestAtDeflection | Self::LightestAtMode => Objective::Mass,
            Self::StiffestAtMass => Objective::Deflection,
            Self::HighestModeAtMass => Objective::Mode,
        }
    }

    /// The objective that has a limit in the question.
    pub fn limited(self) -> Objective {
        match self {
            Self::LightestAtDeflection => Objective::Deflection,
            Self::StiffestAtMass | Self::HighestModeAtMass => Objective::Mass,
            Self::LightestAtMode => Objective::Mode,
        }
    }

    /// The name of the question in files.
    pub fn word(self) -> &'static str {
        match self {
            Self::LightestAtDeflection => "lightest_at_deflection",
            Self::StiffestAtMass => "stiffest_at_mass",
            Self::HighestModeAtMass => "highest_mode_at_mass",
            Self::LightestAtMode => "lightest_at_mode",
        }
    }

    /// The limit in words: `tip deflection at most 2 mm`.
    pub fn limit_words(self, limit: f64) -> String {
        let limit = shortest(limit);
        match self.limited() {
            Objective::Deflection => format!("tip deflection at most {limit} mm"),
            Objective::Mass => format!("mass at most {limit} kg"),
            Objective::Mode => format!("lowest mode at least {limit} Hz"),
        }
    }

    pub(super) fn holds(self, limit: f64, design: &Design) -> bool {
        let value = self.limited().of(design);
        if self.limited() == Objective::Mode { value >= limit } else { value <= limit }
    }
}

/// The words that say in what the winner is best: `is lightest`.
pub(super) fn superlative(question: Question, several: bool) -> &'static str {
    match (question.sought(), several) {
        (Objective::Mass, false) => "is lightest",
        (Objective::Mass, true) => "are lightest",
        (Objective::Deflection, false) => "is stiffest",
        (Objective::Deflection, true) => "are stiffest",
        (Objective::Mode, false) => "has the highest lowest mode",
        (Objective::Mode, true) => "have the highest lowest mode",
    }
}

/// The comparative that says in what the winner is better than the others: `lighter`.
pub(super) fn comparative(question: Question) -> &'static str {
    match question.sought() {
        Objective::Mass => "lighter",
        Objective::Deflection => "less",
        Objective::Mode => "higher",
    }
}
