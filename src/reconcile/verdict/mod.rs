//! What is concluded, and the files that say it.

pub mod correct;
pub mod files;
pub mod locate;
pub mod next_test;
pub mod outcome;
pub mod page;
pub mod report;
pub mod stage;
