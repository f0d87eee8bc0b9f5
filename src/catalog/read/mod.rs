//! From the text of a catalog file to parts, with a list of all faults.
//!
//! [`table`] divides the text into rows, [`row`] checks single cells, and one module for each file has the checks
//! within a row. [`usual`] compares the numbers of a row with each other, [`trend`] rows with each other.

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
pub(crate) mod usual;
