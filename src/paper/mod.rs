//! Reproduces the paper: its table and its three figures, with every number computed.
//!
//! | study | what it answers |
//! |---|---|
//! | `paper-table1` | each number that the paper derives from its Table 1, next to ours: the reading of the equation that gives it, the value of the exact model, and the reason for a difference; also the error that the remedies of the conclusions would leave |
//! | `fig2-metals` | deflection against weight per length of three metals |
//! | `fig3-wall-or-width` | whether a kilogram is better spent on the wall or on the outer dimensions |
//! | `fig4-composites` | composites compared with the best metal |
//!
//! The paper's equations are written as printed ([`equations`], [`coupled`]), separately from the general
//! mechanics. So each can be checked with the other.

pub mod arm;
pub mod claim;
pub mod coupled;
pub mod equations;
pub mod figures;
pub(crate) mod modes_rows;
pub(crate) mod names;
pub(crate) mod output;
pub(crate) mod parts;
pub mod remedies;
pub mod rows;
pub(crate) mod run;
pub(crate) mod statics_rows;
pub mod table1;
pub mod third_spring;
pub(crate) mod torque_rows;

pub use names::{NAMES, QUESTIONS, question};
pub use output::{PaperError, PaperStudyOutput};
pub use run::run;
