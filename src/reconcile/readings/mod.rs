//! Reads the files of a campaign: its statement, its rows, and where the arm and the points stand.

pub mod campaign;
pub mod placement;
pub mod rows;
pub mod table;
