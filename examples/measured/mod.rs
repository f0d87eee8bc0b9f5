//! Campaign folders that are made from published measurements of real machines. These data may not be redistributed, so
//! they are read from a file that the user has downloaded.

pub mod frames;
pub mod justin;
pub mod motoman;

use std::io;
use std::path::Path;

/// Writes the files of a campaign folder. `files` has the name and the text of each file.
///
/// # Errors
/// An error if the folder cannot be written.
pub fn write(folder: &Path, files: &[(&str, String)]) -> io::Result<()> {
    std::fs::create_dir_all(folder)?;
    files.iter().try_for_each(|(name, text)| std::fs::write(folder.join(name), text))
}

/// The rows of a file of comma-separated numbers, without its header.
///
/// # Errors
/// An error if the file cannot be read, or if a cell is not a number.
pub fn read_numbers(path: &Path) -> io::Result<Vec<Vec<f64>>> {
    let text = std::fs::read_to_string(path)?;
    let bad =
        |cell: &str| io::Error::new(io::ErrorKind::InvalidData, format!("{}: \"{cell}\"", path.display()));
    let row = |line: &str| line.split(',').map(|c| c.trim().parse().map_err(|_| bad(c))).collect();
    text.lines().skip(1).map(row).collect()
}
