//! Named questions: read, resolve, run.

pub mod paper;
