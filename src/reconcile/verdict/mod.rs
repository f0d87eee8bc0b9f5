//! The verdict of a reconciliation, and the files that state it.

pub(crate) mod caution;
pub(crate) mod correct;
pub(crate) mod corrected_model;
pub(crate) mod files;
pub(crate) mod fitted;
pub(crate) mod in_series;
pub mod joint_record;
pub(crate) mod judgement;
pub(crate) mod locate;
pub(crate) mod next_test;
pub(crate) mod outcome;
pub mod page;
pub(crate) mod record_report;
pub(crate) mod report;
pub(crate) mod stage;
pub(crate) mod too_little;
pub(crate) mod unit_words;
