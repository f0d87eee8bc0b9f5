//! The paper, reproduced: its table and its three figures, every number computed.
//!
//! | study | what it answers |
//! |---|---|
//! | `paper-table1` | each number the paper gets from its Table 1 beside ours: the reading that gives it, the exact frame's value, the reason for a difference; and what the conclusions' remedies would leave |
//! | `fig2-metals` | deflection against weight per length of three metals |
//! | `fig3-wall-or-width` | whether a kilogram belongs into wall or outer dimensions |
//! | `fig4-composites` | composites against the best metal |
//!
//! The paper's equations are written down as printed ([`equations`], [`coupled`]) and separately from the
//! general mechanics, so that each checks the other.

pub mod arm;
pub mod claim;
pub mod coupled;
pub mod equations;
pub mod figures;
pub(crate) mod modes_rows;
pub mod names;
pub mod output;
pub mod parts;
pub mod remedies;
pub mod rows;
pub mod run;
pub(crate) mod statics_rows;
pub mod table1;
pub mod third_spring;
pub(crate) mod torque_rows;

pub use names::{NAMES, QUESTIONS, question};
pub use output::{PaperError, PaperStudyOutput};
pub use run::run;
