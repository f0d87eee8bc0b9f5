//! The command line: one file a verb. A verb returns the text it prints; [`print()`] is the one place
//! that writes to standard output.

pub(crate) mod analyze;
pub(crate) mod asked;
pub(crate) mod capacity;
pub(crate) mod catalog;
pub(crate) mod compare;
pub(crate) mod corrections;
pub(crate) mod design;
pub(crate) mod failure;
pub(crate) mod finished;
pub(crate) mod front;
pub(crate) mod new;
pub(crate) mod predict;
pub(crate) mod progress;
pub(crate) mod reconcile;
pub(crate) mod rerun;
pub(crate) mod run;
pub(crate) mod search;
pub(crate) mod size;
pub(crate) mod supplements;
pub(crate) mod values;
pub(crate) mod verbs;
pub(crate) mod version;
pub(crate) mod write;

pub use failure::Failure;
pub use verbs::{Cli, run};
pub use write::print;
