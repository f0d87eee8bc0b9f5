//! Named questions: read, resolve, run.

pub mod paper;
mod read;
mod sections;

pub use read::{Study, read_study};
