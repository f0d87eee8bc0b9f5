//! Writes text to standard output and standard error, and files that are not part of a study's or campaign's result.

use super::failure::Failure;
use super::manifest::{Earlier, MANIFESTS};
use crate::report::whole_file::{create_folder, folder_of, write_whole};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Writes the text of a verb to standard output. It is not an error if the reader has closed the pipe.
///
/// # Errors
/// Standard output cannot be written, for instance because it is a file on a full disk.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    let end = if text.is_empty() || text.ends_with('\n') { "" } else { "\n" };
    let written = out.write_all(text.as_bytes()).and_then(|()| out.write_all(end.as_bytes()));
    printed(written.and_then(|()| out.flush()))
}

/// Turns the result of writing to standard output into the result of the program: a closed pipe counts as success.
///
/// # Errors
/// Writing failed for another reason than a closed pipe.
pub fn printed(written: std::io::Result<()>) -> Result<(), Failure> {
    match written {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::File(format!("cannot write standard output: {e}")))
        }
        _ => Ok(()),
    }
}

/// Writes text to standard error. If that fails, the failure is ignored, so that the work continues.
pub(super) fn say(text: &str) {
    let mut out = std::io::stderr().lock();
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
}

/// Writes files into a folder. The folder is made if it is missing. Each file is replaced as a whole.
///
/// # Errors
/// A file cannot be written, is one of the `inputs`, or belongs to a result.
pub(super) fn write_all(folder: &Path, files: &[(String, Vec<u8>)], inputs: &[&Path]) -> Result<(), Failure> {
    let targets: Vec<PathBuf> = files.iter().map(|(name, _)| folder.join(name)).collect();
    refuse_overwriting(&targets, inputs)?;
    targets.iter().zip(files).try_for_each(|(target, (_, bytes))| write_file(target, bytes, inputs))
}

/// Writes a file. Its folder is made if it is missing. An existing file is replaced as a whole.
///
/// # Errors
/// The file cannot be written, is one of the `inputs`, or belongs to a result.
pub(super) fn write_file(target: &Path, bytes: &[u8], inputs: &[&Path]) -> Result<(), Failure> {
    refuse_overwriting(&[target.to_path_buf()], inputs)?;
    let folder = folder_of(target);
    create_folder(&folder).map_err(|e| Failure::file(&folder, "create", &e))?;
    write_whole(target, bytes).map_err(|e| Failure::file(target, "write", &e))
}

/// Refuses to write to a path that is an input of the command, or a file of a result.
///
/// # Errors
/// One of the targets is such a file.
pub(super) fn refuse_overwriting(targets: &[PathBuf], inputs: &[&Path]) -> Result<(), Failure> {
    refuse_inputs(targets, inputs)?;
    for target in targets {
        if let Some(manifest) = result_of(target)? {
            return Err(Failure::Usage(format!(
                "{} is a file of the result that {} lists and would be overwritten; choose another place to write to",
                target.display(),
                manifest.display()
            )));
        }
    }
    Ok(())
}

/// Refuses to write to a path that is an input of the command, even if it is reached by another path.
///
/// # Errors
/// One of the targets is an input.
pub(super) fn refuse_inputs(targets: &[PathBuf], inputs: &[impl AsRef<Path>]) -> Result<(), Failure> {
    let is_input = |target: &&PathBuf| inputs.iter().any(|input| is_same_file(input.as_ref(), target));
    match targets.iter().find(is_input) {
        None => Ok(()),
        Some(target) => Err(Failure::Usage(format!(
            "{} is an input of this command and would be overwritten; choose another place to write to",
            target.display()
        ))),
    }
}

/// Whether two paths lead to the same existing file.
pub(super) fn is_same_file(a: &Path, b: &Path) -> bool {
    matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b)
}

/// The manifest that lists this path as a file of a result in the same folder; `None` if there is none.
fn result_of(path: &Path) -> Result<Option<PathBuf>, Failure> {
    let (folder, name) =
        (folder_of(path), path.file_name().and_then(|name| name.to_str()).unwrap_or_default());
    for manifest in MANIFESTS {
        if let listed @ Earlier::Listed(_) = Earlier::read(&folder, manifest)?
            && listed.has(name, manifest)
        {
            return Ok(Some(folder.join(manifest)));
        }
    }
    Ok(None)
}
