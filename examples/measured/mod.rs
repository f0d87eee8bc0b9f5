//! Campaign folders made from published measurements of real machines, which may not be redistributed:
//! the data are read from where they were downloaded to.

pub mod frames;
pub mod justin;
pub mod motoman;

use std::io;
use std::path::Path;

/// Writes the files of a campaign folder.
///
/// # Errors
/// The folder cannot be written.
pub fn write(folder: &Path, files: &[(&str, String)]) -> io::Result<()> {
    std::fs::create_dir_all(folder)?;
    files.iter().try_for_each(|(name, text)| std::fs::write(folder.join(name), text))
}

/// The rows of a table of numbers, without its header.
///
/// # Errors
/// The file cannot be read, or a cell is no number.
pub fn read_numbers(path: &Path) -> io::Result<Vec<Vec<f64>>> {
    let text = std::fs::read_to_string(path)?;
    let bad =
        |cell: &str| io::Error::new(io::ErrorKind::InvalidData, format!("{}: \"{cell}\"", path.display()));
    let row = |line: &str| line.split(',').map(|c| c.trim().parse().map_err(|_| bad(c))).collect();
    text.lines().skip(1).map(row).collect()
}
