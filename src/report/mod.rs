//! Numbers and pictures on paper: csv, json, svg, terminal.

pub mod front_table;
pub mod number;
pub mod svg;
pub mod table;
