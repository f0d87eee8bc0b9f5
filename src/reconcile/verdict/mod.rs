//! What is concluded, and the files that say it.

pub mod correct;
pub mod locate;
pub mod outcome;
pub mod page;
pub mod predict;
pub mod report;
