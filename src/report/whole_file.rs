//! Files that are written completely or not at all. Each is written under a temporary name in the same folder,
//! synced to the disk and then renamed.
//!
//! Every change of the disk by the program goes through the functions of this file. In builds with the feature `faults`
//! a test can stop the program, or simulate a full disk, at any of these changes. `ARMWRIGHT_FAULT=kill:7` ends the
//! process at the seventh change. `ARMWRIGHT_FAULT=full:7` lets every write fail from the seventh change on.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Beginning and end of the names of temporary files.
const TEMPORARY: [&str; 2] = [".armwright-", ".tmp"];
/// A temporary file is removed if it is older than this and no process has locked it. Such a file was left by a process
/// that was stopped.
const LEFT_BEHIND_AFTER: Duration = Duration::from_secs(10);

/// Replaces a file as a whole: a reader sees either the old or the new content, and after a fault the old one is
/// still there. Permissions are those of any new file (`umask`). A symbolic link at the path is replaced and not
/// followed.
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
    // the lock tells other processes that the file is in use; on a system without locks they judge this by the age of
    // the file
    let _ = file.as_file().try_lock();
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    fault(Step::Change)?;
    file.persist(path).map_err(|e| e.error)?;
    sync_folder(&folder)
}

/// Gives a temporary file the permissions of any new file. It would otherwise be private to its owner, but results
/// should be as readable as other files of the user.
#[cfg(unix)]
fn as_any_new_file(builder: &mut tempfile::Builder) {
    use std::os::unix::fs::PermissionsExt;
    // the operating system removes the permissions that `umask` excludes
    builder.permissions(std::fs::Permissions::from_mode(0o666));
}

#[cfg(not(unix))]
fn as_any_new_file(_: &mut tempfile::Builder) {}

/// The folder that contains a file.
pub(crate) fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_path_buf(),
        _ => PathBuf::from("."),
    }
}

/// Removes temporary files that a stopped process has left in a folder.
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

/// Creates a folder and its parents.
///
/// # Errors
/// The folder cannot be created, or a file has this name.
pub(crate) fn create_folder(folder: &Path) -> io::Result<()> {
    fault(Step::Change)?;
    fs_err::create_dir_all(folder)
}

/// Writes a new file under a temporary name and syncs it to the disk. The caller renames it afterwards.
///
/// # Errors
/// The file cannot be written.
pub(crate) fn write_staged(path: &Path, bytes: &[u8]) -> io::Result<()> {
    fault(Step::Write)?;
    let mut file = fs_err::File::create(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

/// Renames a file or folder.
///
/// # Errors
/// The file or folder cannot be renamed.
pub(crate) fn rename(from: &Path, to: &Path) -> io::Result<()> {
    fault(Step::Change)?;
    fs_err::rename(from, to)
}

/// Removes a file. A symbolic link is removed and not followed.
///
/// # Errors
/// The file cannot be removed.
pub(crate) fn remove_file(path: &Path) -> io::Result<()> {
    fault(Step::Change)?;
    fs_err::remove_file(path)
}

/// Syncs the list of names in a folder to the disk. Only Unix systems can do this; on others nothing happens.
///
/// # Errors
/// The folder cannot be synced.
pub(crate) fn sync_folder(folder: &Path) -> io::Result<()> {
    fault(Step::Change)?;
    match cfg!(unix) {
        true => File::open(folder)?.sync_all(),
        false => Ok(()),
    }
}

/// Kind of the next change of the disk.
#[derive(Clone, Copy, PartialEq)]
enum Step {
    /// A change that needs space on the disk.
    Write,
    /// A change that needs no space.
    Change,
}

/// Ends the process or reports a full disk, if a test asks for it at this change.
#[cfg(feature = "faults")]
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

#[cfg(not(feature = "faults"))]
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
