//! Pages for a browser: one self-contained file per study, campaign or comparison.
//!
//! A page opens from disk. Style, program (JavaScript), data and pictures are inside it, and its content security
//! policy forbids the network, `eval` and inline handlers. Everything can be read without the program: pictures are the
//! same SVG as in the folder `plots/`, and tables are HTML tables. The program adds linked views with hovering,
//! brushing and filters. [`study`], `campaign` and `comparison` take plain values and fill the templates in this
//! folder.

pub(crate) mod campaign;
pub(crate) mod campaign_page;
pub(crate) mod comparison;
pub(crate) mod document;
pub(crate) mod front_data;
pub(crate) mod front_views;
pub(crate) mod gallery;
pub(crate) mod packed;
pub(crate) mod pick;
pub(crate) mod positions;
pub(crate) mod render;
pub mod study;
