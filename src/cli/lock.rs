//! A lock that lets only one process write a folder of results. The operating system releases the lock when the
//! process ends, however it ends.

use super::failure::Failure;
use super::links::refuse_link;
use std::fs::{File, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};

/// The lock of a folder. It is released when this value is dropped.
pub(super) struct Lock {
    path: PathBuf,
    // dropping the value closes the file, which releases the lock
    file: File,
}

impl Lock {
    /// Takes the lock of `folder`, which is the lock file at `path`. A lock file that a dead process left behind is
    /// taken over.
    ///
    /// # Errors
    /// Another process has the lock, the file cannot be written, or it is a symbolic link.
    pub(super) fn take(path: &Path, folder: &Path) -> Result<Self, Failure> {
        let failure = |e: &std::io::Error| Failure::file(path, "write", e);
        loop {
            refuse_link(path)?;
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
                // this file system has no locks, so the work continues without one
                Err(TryLockError::Error(_)) => {}
            }
            // between opening and locking, the process that had the lock may have removed the file, or another one may
            // have put a link there; nothing is written before this is checked
            if !is_the_file_at(&file, path) {
                continue;
            }
            let mut lock = Self { path: path.to_path_buf(), file };
            let text = format!("process {}\n", std::process::id());
            let told = lock.file.set_len(0).and_then(|()| lock.file.write_all(text.as_bytes()));
            return told.map(|()| lock).map_err(|e| failure(&e));
        }
    }

    /// Whether a process has the lock that is the file at `path`. The lock is not taken.
    pub(super) fn is_held(path: &Path) -> bool {
        // a shared lock is refused exactly while another process holds the lock
        File::open(path).is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // the file is removed while it is still locked, so that no other process can have locked it
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
    matches!((file.metadata(), std::fs::symlink_metadata(path)), (Ok(a), Ok(b)) if place(&a) == place(&b))
}

#[cfg(not(unix))]
fn is_the_file_at(_: &File, path: &Path) -> bool {
    path.exists() && !path.is_symlink()
}
