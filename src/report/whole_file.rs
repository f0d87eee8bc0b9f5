//! Files that appear as a whole or not at all: written beside their place, synced to the disk, renamed into it.
//!
//! Every change that the program makes to a disk goes through the functions of this file. In builds with debug assertions
//! a test can stop the program, or fill its disk, at any one of them: `ARMWRIGHT_FAULT=kill:7` ends the process at the
//! seventh, `ARMWRIGHT_FAULT=full:7` lets every writing from the seventh on fail.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// How the names of temporary files begin and end.
const TEMPORARY: [&str; 2] = [".armwright-", ".tmp"];
/// A temporary file that is older and that no process has locked was left behind.
const LEFT_BEHIND_AFTER: Duration = Duration::from_secs(10);

/// Replaces a file: a reader sees the old one or the new one, and a fault leaves the old one. Permissions are those of
/// any new file (`umask`). A symbolic link at the path is replaced and not followed.
///
/// # Errors
/// The file cannot be written.
pub(crate) fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let folder = folder_of(path);
    sweep(&folder);
    fault(Step::Write)?;
    let [prefix, suffix] = TEMPORARY;
    let mut builder = tempfile::Builder::new();
    builder.prefix(prefix).suffix(suffix);
    as_any_new_file(&mut builder);
    let mut file = builder.tempfile_in(&folder)?;
    // a lock tells others that the file is in use; where there are no locks its age does
    let _ = file.as_file().try_lock();
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    fault(Step::Change)?;
    file.persist(path).map_err(|e| e.error)?;
    sync_folder(&folder)
}

/// Temporary files are private to their owner; results are as public as the user's other files.
#[cfg(unix)]
fn as_any_new_file(builder: &mut tempfile::Builder) {
    use std::os::unix::fs::PermissionsExt;
    // the system takes the bits of umask away
    builder.permissions(std::fs::Permissions::from_mode(0o666));
}

#[cfg(not(unix))]
fn as_any_new_file(_: &mut tempfile::Builder) {}

/// The folder that a file is in.
pub(crate) fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_path_buf(),
        _ => PathBuf::from("."),
    }
}

/// Removes temporary files that a stopped process left in a folder.
fn sweep(folder: &Path) {
    temporaries(folder).into_iter().filter(|path| is_left_behind(path)).for_each(|path| {
        let _ = std::fs::remove_file(path);
    });
}

/// Removes all temporary files from a folder in which no other process writes.
pub(crate) fn remove_temporaries(folder: &Path) {
    temporaries(folder).into_iter().for_each(|path| {
        let _ = std::fs::remove_file(path);
    });
}

/// The temporary files in a folder.
fn temporaries(folder: &Path) -> Vec<PathBuf> {
    let [prefix, suffix] = TEMPORARY;
    let is_ours = |name: &str| name.starts_with(prefix) && name.ends_with(suffix);
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries
        .filter(|entry| entry.file_name().to_str().is_some_and(is_ours))
        .map(|entry| entry.path())
        .collect()
}

fn is_left_behind(path: &Path) -> bool {
    let Ok(file) = File::open(path) else { return false };
    let age = file.metadata().and_then(|m| m.modified()).map(|at| at.elapsed().unwrap_or_default());
    age.is_ok_and(|age| age > LEFT_BEHIND_AFTER)
        && !matches!(file.try_lock(), Err(std::fs::TryLockError::WouldBlock))
}

/// Makes a folder and its parents.
///
/// # Errors
/// It cannot be made, or there is a file of this name.
pub(crate) fn create_folder(folder: &Path) -> io::Result<()> {
    fault(Step::Change)?;
    fs_err::create_dir_all(folder)
}

/// Writes a new file and syncs it to the disk. It is not at its place yet.
///
/// # Errors
/// The file cannot be written.
pub(crate) fn write_staged(path: &Path, bytes: &[u8]) -> io::Result<()> {
    fault(Step::Write)?;
    let mut file = fs_err::File::create(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

/// Gives a file or folder another name.
///
/// # Errors
/// It cannot be renamed.
pub(crate) fn rename(from: &Path, to: &Path) -> io::Result<()> {
    fault(Step::Change)?;
    fs_err::rename(from, to)
}

/// Removes a file; a symbolic link is removed and not followed.
///
/// # Errors
/// It cannot be removed.
pub(crate) fn remove_file(path: &Path) -> io::Result<()> {
    fault(Step::Change)?;
    fs_err::remove_file(path)
}

/// Writes to the disk which names a folder holds. Only Unix systems can.
///
/// # Errors
/// The disk cannot be written.
pub(crate) fn sync_folder(folder: &Path) -> io::Result<()> {
    fault(Step::Change)?;
    match cfg!(unix) {
        true => File::open(folder)?.sync_all(),
        false => Ok(()),
    }
}

/// What is about to be done to the disk.
#[derive(Clone, Copy, PartialEq)]
enum Step {
    /// Needs space.
    Write,
    /// Needs none.
    Change,
}

/// Stops the program, or reports a full disk, where a test wants it.
#[cfg(debug_assertions)]
fn fault(step: Step) -> io::Result<()> {
    use std::sync::atomic::{AtomicU64, Ordering};
    static STEPS: AtomicU64 = AtomicU64::new(0);
    let Ok(wanted) = std::env::var("ARMWRIGHT_FAULT") else { return Ok(()) };
    let here = STEPS.fetch_add(1, Ordering::Relaxed) + 1;
    match wanted.split_once(':').and_then(|(what, at)| Some((what, at.parse::<u64>().ok()?))) {
        Some(("kill", at)) if at == here => std::process::abort(),
        Some(("full", at)) if at <= here && step == Step::Write => Err(io::ErrorKind::StorageFull.into()),
        _ => Ok(()),
    }
}

#[cfg(not(debug_assertions))]
fn fault(_: Step) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_temporary_file_is_swept_when_it_is_old_and_nobody_has_it() {
        let here = tempfile::tempdir().expect("a folder");
        let old = std::time::SystemTime::now() - 2 * LEFT_BEHIND_AFTER;
        let make = |name: &str| {
            let file = File::create(here.path().join(name)).expect("a file");
            file.set_modified(old).expect("a time");
            file
        };
        drop((make(".armwright-left.tmp"), make(".armwright-notes.txt"), make("readings.tmp")));
        let used = make(".armwright-used.tmp");
        used.lock().expect("a lock");
        File::create(here.path().join(".armwright-new.tmp")).expect("a file");
        write_whole(&here.path().join("june.csv"), b"a\n").expect("written");
        let mut names: Vec<String> = std::fs::read_dir(here.path())
            .expect("a folder")
            .map(|entry| entry.expect("an entry").file_name().into_string().expect("text"))
            .collect();
        names.sort();
        let stay =
            [".armwright-new.tmp", ".armwright-notes.txt", ".armwright-used.tmp", "june.csv", "readings.tmp"];
        assert_eq!(names, stay);
    }
}
