//! Reads the files of a campaign: its statement, its rows, and where the arm and the points stand.

pub(crate) mod campaign;
pub(crate) mod declared;
pub mod placement;
pub(crate) mod rows;
pub mod table;
