//! The readings of a campaign: files, rows, units, what stands where.

pub mod campaign;
pub mod placement;
pub mod rows;
pub mod table;
