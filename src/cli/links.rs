//! Symbolic links in folders that the program writes: none is followed.

use super::failure::Failure;
use std::io;
use std::path::{Path, PathBuf};

/// Refuses a path that is a symbolic link, whether or not it leads anywhere.
///
/// # Errors
/// The path is a link.
pub(super) fn refuse_link(path: &Path) -> Result<(), Failure> {
    match path.is_symlink() {
        true => Err(Failure::File(format!(
            "{} is a symbolic link, and none is followed where a result is written; remove it",
            path.display()
        ))),
        false => Ok(()),
    }
}

/// Checks that the file `name` of `folder` can be moved to or from its place without following a symbolic link.
///
/// # Errors
/// A folder on the way from `folder` to the file is a link or no folder.
pub(super) fn refuse_strange_parents(folder: &Path, name: &str) -> io::Result<()> {
    match strange_parent(folder, name) {
        Some(parent) => Err(io::Error::other(format!(
            "{} is a symbolic link or no folder, and no link is followed where a result is written; remove it",
            parent.display()
        ))),
        None => Ok(()),
    }
}

/// Whether the path of a file leads over something that is not a real folder, such as a symbolic link.
pub(super) fn has_strange_parent(folder: &Path, name: &str) -> bool {
    strange_parent(folder, name).is_some()
}

fn strange_parent(folder: &Path, name: &str) -> Option<PathBuf> {
    let parents = Path::new(name).ancestors().skip(1).filter(|parent| !parent.as_os_str().is_empty());
    let mut parents = parents.map(|parent| folder.join(parent));
    parents.find(|parent| is_there(parent) && (parent.is_symlink() || !parent.is_dir()))
}

/// Whether anything exists at a path; a broken symbolic link counts too.
pub(super) fn is_there(path: &Path) -> bool {
    path.symlink_metadata().is_ok()
}
