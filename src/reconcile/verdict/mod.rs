//! The conclusion of a reconciliation, and the files that state it.

pub mod correct;
pub mod files;
pub mod locate;
pub mod next_test;
pub mod outcome;
pub mod page;
pub mod report;
pub mod stage;
