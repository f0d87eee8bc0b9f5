//! Numbers and pictures on paper: csv, json, svg, terminal.

pub mod front_table;
