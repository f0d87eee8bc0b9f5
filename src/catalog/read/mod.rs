//! From the text of a catalog file to records, with every fault of it.
//!
//! [`table`] cuts the text into rows, [`row`] checks single cells, one module a file knows what must hold
//! within a row, [`trend`] looks across rows.

pub mod efficiency;
pub mod envelope;
pub mod gears;
pub mod materials;
pub mod motors;
pub mod profiles;
pub mod row;
pub mod table;
pub mod trend;
