//! Which effects are missing: screening, laws without a name, lack of fit, and the next test.

pub mod few_rows;
pub mod lack_of_fit;
pub mod laws;
pub mod screening;
pub mod search;
pub mod settle;
pub mod structure;
pub mod unnamed;
pub mod waves;
