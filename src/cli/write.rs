//! Output: text to standard output, files to a folder of results.

use super::failure::Failure;
use std::io::Write;
use std::path::Path;

/// Writes a verb's text to standard output; a closed pipe is no error.
pub fn print(text: &str) {
    let mut out = std::io::stdout().lock();
    let _ = out.write_all(text.as_bytes());
    if !text.is_empty() && !text.ends_with('\n') {
        let _ = out.write_all(b"\n");
    }
}

/// Writes files into a folder, all or none: temporary files first, which are then renamed.
pub(crate) fn write_all(dir: &Path, files: &[(String, Vec<u8>)]) -> Result<(), Failure> {
    fs_err::create_dir_all(dir).map_err(|e| Failure::file(dir, "create", &e))?;
    let mut staged = Vec::with_capacity(files.len());
    for (name, bytes) in files {
        let path = dir.join(name);
        let folder = path.parent().unwrap_or(dir);
        fs_err::create_dir_all(folder).map_err(|e| Failure::file(folder, "create", &e))?;
        let mut file =
            tempfile::NamedTempFile::new_in(folder).map_err(|e| Failure::file(dir, "write in", &e))?;
        file.write_all(bytes).map_err(|e| Failure::file(dir, "write in", &e))?;
        staged.push((file, path));
    }
    for (file, path) in staged {
        file.persist(&path).map_err(|e| Failure::file(&path, "write", &e.error))?;
        make_readable(&path);
    }
    Ok(())
}

/// Temporary files are private to their owner; results are not.
#[cfg(unix)]
fn make_readable(path: &Path) {
    use std::os::unix::fs::PermissionsExt;
    let _ = std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o644));
}

#[cfg(not(unix))]
fn make_readable(_: &Path) {}
