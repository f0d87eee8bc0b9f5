//! Finds which effects are missing: screening of candidates, laws without a name, lack of fit, few readings,
//! and the quality of the readings.

pub mod few_rows;
pub mod lack_of_fit;
pub mod laws;
pub mod screening;
pub mod search;
pub mod settle;
pub mod structure;
pub mod unnamed;
pub mod waves;
