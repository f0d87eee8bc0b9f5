//! Numbers, tables and pictures on paper.

pub mod number;
pub mod svg;
pub mod table;
