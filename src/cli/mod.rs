//! The command line: one file a verb. A verb returns the text it prints; [`print()`] is the one place
//! that writes to standard output.

pub(crate) mod analyze;
pub(crate) mod asked;
pub(crate) mod beside;
pub(crate) mod capacity;
pub(crate) mod catalog;
mod catalog_check;
mod catalog_table;
pub(crate) mod check;
pub(crate) mod compare;
pub(crate) mod corrections;
pub(crate) mod design;
pub(crate) mod exit;
pub(crate) mod export;
pub(crate) mod failure;
pub(crate) mod finished;
pub(crate) mod front;
pub(crate) mod import;
pub(crate) mod lock;
pub(crate) mod log;
pub(crate) mod manifest;
pub(crate) mod merge;
pub(crate) mod new;
pub(crate) mod predict;
pub(crate) mod progress;
pub(crate) mod reconcile;
pub(crate) mod rerun;
pub(crate) mod result_folder;
pub(crate) mod results;
pub(crate) mod run;
pub(crate) mod search;
pub(crate) mod shard;
pub(crate) mod size;
pub(crate) mod slurm;
pub(crate) mod supplements;
pub(crate) mod time_limit;
pub(crate) mod values;
pub(crate) mod verbs;
pub(crate) mod version;
pub(crate) mod write;

pub use exit::{Answer, Exit};
pub use failure::Failure;
pub use log::Log;
pub use verbs::{Cli, run};
pub use write::{print, printed};
