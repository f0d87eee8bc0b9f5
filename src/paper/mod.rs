//! Reproduces the paper *Mechanical analysis of high precision manipulator*, from which this program grew: its table
//! and its three figures, with every number computed.
//!
//! | study | what it answers |
//! |---|---|
//! | `paper-table1` | each number that the paper derives from its Table 1, next to the number of this program: the interpretation of the equation that gives the paper's number, the value of the general mechanics, and the reason for a difference; also the error that remains with the remedies of the paper's conclusions |
//! | `fig2-metals` | deflection against weight per length of three metals |
//! | `fig3-wall-or-width` | whether a kilogram is better spent on the wall or on the outer dimensions |
//! | `fig4-composites` | composites compared with the best metal |
//!
//! The paper's equations are written as printed ([`equations`], [`coupled`]), separately from the general mechanics. So
//! the equations and the mechanics can be checked against each other.

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
