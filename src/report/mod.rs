//! Results for people and programs: numbers, tables, pictures, pages (CSV, JSON, SVG, HTML, terminal).

pub mod braille;
pub mod budget;
pub mod certificate;
pub mod compare;
pub mod facts;
pub mod front_svg;
pub mod front_table;
pub mod html;
pub mod number;
pub mod picks;
pub mod section;
pub mod summary;
pub mod supplement;
pub mod svg;
pub mod table;
pub mod tolerance;
pub mod tube;
pub mod words;
