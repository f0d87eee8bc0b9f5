//! Results for people and programs: numbers, tables, pictures, pages (CSV, JSON, SVG, HTML, terminal).

pub mod analysis;
pub(crate) mod braille;
pub mod budget;
pub mod caveats;
pub(crate) mod certificate;
pub mod compare;
pub mod facts;
pub mod file_names;
pub(crate) mod front_svg;
pub mod front_table;
pub mod html;
pub mod number;
pub mod picks;
pub(crate) mod pose;
pub(crate) mod resonance;
pub(crate) mod section;
pub(crate) mod small_displacement;
pub(crate) mod springs;
pub mod summary;
pub(crate) mod supplement;
pub mod svg;
pub(crate) mod table;
pub mod tolerance;
pub(crate) mod tube;
pub(crate) mod whole_file;
pub(crate) mod words;
