//! Reads the files of a campaign: `campaign.json`, the tables of readings, and the records against time. Also reads and
//! writes the placement of an arm in the frame of an instrument.

pub(crate) mod campaign;
pub(crate) mod cells;
pub mod components;
pub(crate) mod declared;
pub(crate) mod keys;
pub(crate) mod median;
pub mod placement;
pub mod record;
pub mod record_spec;
pub(crate) mod rows;
pub(crate) mod source;
pub(crate) mod spreadsheet;
pub mod table;
#[cfg(test)]
mod tests;
