//! Numbers, tables and pictures on paper: csv, json, svg, terminal.

pub mod front_table;
pub mod number;
pub mod picks;
pub mod svg;
pub mod table;
