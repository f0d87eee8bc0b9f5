//! One writer for a folder of results: a lock that the system takes back when its process ends, however it ends.

use super::failure::Failure;
use std::fs::{File, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};

/// The lock of a folder, held until it is dropped.
pub(super) struct Lock {
    path: PathBuf,
    // closed, and with it unlocked, when dropped
    file: File,
}

impl Lock {
    /// Takes the lock `path` of a folder. A lock that a dead process left is taken over.
    ///
    /// # Errors
    /// Another process holds it, or the file cannot be written.
    pub(super) fn take(path: &Path, folder: &Path) -> Result<Self, Failure> {
        let failure = |e: &std::io::Error| Failure::file(path, "write", e);
        loop {
            let file = File::options()
                .create(true)
                .truncate(false)
                .read(true)
                .write(true)
                .open(path)
                .map_err(|e| failure(&e))?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(held(path, folder)),
                // the file system has no locks: work goes on as without them
                Err(TryLockError::Error(_)) => {}
            }
            // the holder before may have removed the file between opening and locking it
            if !is_the_file_at(&file, path) {
                continue;
            }
            let mut lock = Self { path: path.to_path_buf(), file };
            let text = format!("process {}\n", std::process::id());
            let told = lock.file.set_len(0).and_then(|()| lock.file.write_all(text.as_bytes()));
            return told.map(|()| lock).map_err(|e| failure(&e));
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // removed while it is held: nobody else can have it now
        let _ = std::fs::remove_file(&self.path);
    }
}

fn held(path: &Path, folder: &Path) -> Failure {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let by = match text.trim() {
        "" => "another process",
        process => process,
    };
    Failure::Locked(format!(
        "{} is being written by {by}: wait until it ends, or choose another folder with --out",
        folder.display()
    ))
}

#[cfg(unix)]
fn is_the_file_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let place = |m: &std::fs::Metadata| (m.dev(), m.ino());
    matches!((file.metadata(), std::fs::metadata(path)), (Ok(a), Ok(b)) if place(&a) == place(&b))
}

#[cfg(not(unix))]
fn is_the_file_at(_: &File, path: &Path) -> bool {
    path.exists()
}
