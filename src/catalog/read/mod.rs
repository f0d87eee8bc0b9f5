//! From the text of a catalog file to records, with every fault of it.
//!
//! [`table`] cuts the text into rows, [`row`] checks single cells, one module a file knows what must hold
//! within a row, [`trend`] looks across rows.

pub(crate) mod actuators;
pub(crate) mod efficiency;
pub(crate) mod envelope;
pub(crate) mod gears;
pub(crate) mod log;
pub(crate) mod materials;
pub(crate) mod motor_curves;
pub(crate) mod motors;
pub(crate) mod profiles;
pub(crate) mod row;
pub(crate) mod table;
pub(crate) mod trend;
