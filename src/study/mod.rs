//! Named questions: read, resolve, run.

mod read;
mod sections;

pub use read::{Study, read_study};
