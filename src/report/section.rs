//! A section of a page, with a title, paragraphs, tables and pictures.

use super::table::Table;
use serde::Serialize;

/// A picture, with the numbers that it shows.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Figure {
    /// Name of the picture's files, without ending.
    pub name: String,
    /// Caption below the picture.
    pub caption: String,
    /// The picture as SVG.
    pub svg: String,
    /// The numbers of the picture as CSV; empty if they are in another file.
    pub csv: String,
}

/// A section of a page whose content comes from another folder of the source: a stiffness budget, a certificate, a
/// run with the corrected arm.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PageSection {
    /// Title of the section.
    pub title: String,
    /// Paragraphs of text, at the beginning of the section.
    pub words: Vec<String>,
    /// Tables with their captions.
    pub tables: Vec<(String, Table)>,
    /// Pictures.
    pub figures: Vec<Figure>,
}
