//! A titled part of a page: paragraphs, tables, pictures.

use super::table::Table;
use serde::Serialize;

/// A picture with the numbers behind it.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Figure {
    /// Name of its files, without ending.
    pub name: String,
    /// What is said below it.
    pub caption: String,
    /// The picture.
    pub svg: String,
    /// The numbers behind it; empty if they stand in another file.
    pub csv: String,
}

/// A titled part of a page that another room fills: a stiffness budget, a certificate, a run with the
/// corrected arm.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PageSection {
    /// Title.
    pub title: String,
    /// Paragraphs.
    pub words: Vec<String>,
    /// Tables with their captions.
    pub tables: Vec<(String, Table)>,
    /// Pictures.
    pub figures: Vec<Figure>,
}
