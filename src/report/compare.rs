//! Fronts compared: which is lightest at a given deflection, stiffest or of highest mode at a given mass, lightest
//! for a given lowest mode, and what the material costs.
//!
//! A *contender* is a front with a label: one material of a study, or one of several results. The front of all
//! materials mixed is at least as good as each of them, so it is shown as a reference and never counts as the
//! winner. The functions here have no side effects. `text` writes the comparison for people, `thresholds` chooses
//! round limits where the user gives none, and [`moved`] tells what changed between two runs of a study.

pub(crate) mod changes;
pub(crate) mod comparison;
pub(crate) mod contender;
pub mod moved;
pub(crate) mod question;
pub(crate) mod text;
pub(crate) mod thresholds;

pub use comparison::{Answer, Comparison, Reach, Row, compare};
pub use contender::Contender;
pub use question::Question;
pub use thresholds::Thresholds;
