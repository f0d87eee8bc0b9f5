//! Finds which effects are missing: screening of candidates, laws without a name, tests for lack of fit, analysis of
//! few readings, and judgement of the readings' quality.

pub(crate) mod added_laws;
pub(crate) mod empirical;
mod event_rows;
pub(crate) mod few_rows;
pub(crate) mod lack_of_fit;
pub(crate) mod laws;
pub(crate) mod screening;
pub(crate) mod search;
pub(crate) mod seen;
pub(crate) mod settle;
pub(crate) mod structure;
pub(crate) mod unnamed;
pub(crate) mod waves;
