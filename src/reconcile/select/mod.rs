//! Finds which effects are missing: screening of candidates, laws without a name, lack of fit, few readings,
//! and the quality of the readings.

pub(crate) mod empirical;
pub(crate) mod few_rows;
pub(crate) mod lack_of_fit;
pub(crate) mod laws;
pub(crate) mod screening;
pub(crate) mod search;
pub(crate) mod settle;
pub(crate) mod structure;
pub(crate) mod unnamed;
pub(crate) mod waves;
