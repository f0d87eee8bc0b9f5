//! A folder of results that only one process writes at a time. A new result replaces the earlier one as a whole.
//!
//! New files are written to `.armwright/next`. Renaming this folder to `.armwright/ready` is the moment from which
//! the new result counts. Its files are then moved to their places, files that only the earlier result had are
//! removed, and the manifest is moved last. If the process dies before the renaming, the earlier result stays. If it
//! dies later, the next process that reads or writes the folder completes the work ([`complete`]).

use super::exit::Exit;
use super::failure::Failure;
use super::links::{has_strange_parent, is_there, refuse_link, refuse_strange_parents};
use super::lock::Lock;
use super::manifest::{Earlier, Files, MANIFESTS, has_manifest, sealed};
use super::unfinished::{ENDING, remove};
use crate::report::whole_file::{
    create_folder, folder_of, remove_file, remove_temporaries, rename, sync_folder, write_staged,
};
use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Folder for unfinished work inside a folder of results.
const STATE: &str = ".armwright";
/// Name of the lock file in the folder [`STATE`].
const LOCK: &str = "lock";
/// How many times a reader waits until a writer is done, and how long each time.
const READER_WAITS: (u32, Duration) = (20, Duration::from_millis(100));

/// A folder of results that only this process writes, since it has the lock.
pub(super) struct ResultFolder {
    folder: PathBuf,
    manifest: &'static str,
    lock: Option<Lock>,
    /// Whether the folder had a result of which nothing lists the files when it was opened. Every file with the name of a
    /// result file may then be replaced.
    had_unlisted: bool,
}

impl ResultFolder {
    /// Opens a folder for a result. `manifest` is the name of the file that lists the files of the result. The folder
    /// is made if it is missing. Work that an earlier process left unfinished is completed or removed.
    ///
    /// # Errors
    /// The folder cannot be used: another process writes it, it cannot be written, its unfinished work is reached over
    /// a symbolic link, or some name in `planned` is taken by a file that is not part of an earlier result.
    pub(super) fn open(
        folder: &Path,
        manifest: &'static str,
        planned: &[impl AsRef<str>],
    ) -> Result<Self, Failure> {
        let state = folder.join(STATE);
        refuse_links(&state)?;
        create_folder(&state).map_err(|e| Failure::file(folder, "create", &e))?;
        // `out` is made before the lock is taken, so that its `drop` removes empty folders if anything fails from here
        // on
        let mut out = Self { folder: folder.to_path_buf(), manifest, lock: None, had_unlisted: false };
        out.lock = Some(Lock::take(&state.join(LOCK), folder)?);
        roll_forward(folder).map_err(|e| Failure::file(folder, "complete", &e))?;
        sweep(&state.join("next")).map_err(|e| Failure::file(folder, "write in", &e))?;
        let earlier = Earlier::read(folder, manifest)?;
        out.had_unlisted = matches!(earlier, Earlier::Unlisted);
        let foreign: Vec<&str> = planned
            .iter()
            .map(AsRef::as_ref)
            .filter(|name| is_foreign(folder, name, &earlier, manifest))
            .collect();
        match foreign.is_empty() {
            true => Ok(out),
            false => Err(Failure::Usage(format!(
                "{} has files that are no part of an earlier result and would be overwritten: {}; move them, or choose \
                 another folder with --out",
                folder.display(),
                foreign.join(", ")
            ))),
        }
    }

    /// Replaces the result in the folder by these files, which include the manifest. Returns the names of the files
    /// that were left out. A file is left out if its name is taken by something that is not part of the earlier result;
    /// the manifest says so.
    ///
    /// # Errors
    /// The folder cannot be written. Either the earlier result stays, or the new result counts and the next reader
    /// completes it.
    pub(super) fn publish(&self, files: &[(String, Vec<u8>)]) -> Result<Vec<String>, Failure> {
        let earlier = match self.had_unlisted {
            true => Earlier::Unlisted,
            false => Earlier::read(&self.folder, self.manifest)?,
        };
        let is_foreign = |(name, bytes): &(String, Vec<u8>)| {
            is_foreign(&self.folder, name, &earlier, self.manifest) && !self.has(name, bytes)
        };
        let (foreign, own): (Files, Files) = files.iter().cloned().partition(is_foreign);
        let taken: Vec<String> = foreign.into_iter().map(|(name, _)| name).collect();
        let state = self.folder.join(STATE);
        let staged = self.stage(&sealed(own, self.manifest, &taken)?).and_then(|()| {
            // by this renaming the new result begins to count
            rename(&state.join("next"), &state.join("ready"))
        });
        if let Err(e) = staged {
            let _ = sweep(&state.join("next"));
            return Err(Failure::file(&self.folder, "write in", &e));
        }
        let moved = sync_folder(&state).and_then(|()| roll_forward(&self.folder));
        moved.map_err(|e| Failure::file(&self.folder, "complete", &e))?;
        Ok(taken)
    }

    /// Removes the saved states of unfinished searches when a search has ended as `end` says. They are kept if the user
    /// stopped the search, or if its result could not be written.
    ///
    /// # Errors
    /// A saved state cannot be removed.
    pub(super) fn settle(&self, end: Result<Exit, &Failure>) -> Result<(), Failure> {
        let is_over = match end {
            Ok(exit) => exit != Exit::Interrupted,
            Err(failure) => matches!(failure, Failure::Infeasible(_) | Failure::Partial(_)),
        };
        if is_over {
            // a process that was killed while it saved a state leaves a temporary file; no other process can be
            // saving one now, because this one has the lock
            remove_temporaries(&self.folder.join(STATE));
        }
        let entries = std::fs::read_dir(self.folder.join(STATE)).into_iter().flatten().flatten();
        let states =
            entries.map(|entry| entry.path()).filter(|path| path.to_string_lossy().ends_with(ENDING));
        states.filter(|_| is_over).try_for_each(|path| remove(&path))
    }

    /// Whether the folder already has a file of this name with exactly this content.
    fn has(&self, name: &str, bytes: &[u8]) -> bool {
        let path = self.folder.join(name);
        !path.is_symlink() && std::fs::read(path).is_ok_and(|there| there == bytes)
    }

    /// Writes the files that are new or changed, and the manifest, to `.armwright/next`.
    fn stage(&self, files: &[(String, Vec<u8>)]) -> io::Result<()> {
        let next = self.folder.join(STATE).join("next");
        sweep(&next)?;
        create_folder(&next)?;
        let mut folders = BTreeSet::from([next.clone()]);
        for (name, bytes) in files {
            if self.has(name, bytes) && name != self.manifest {
                continue;
            }
            let path = next.join(name);
            if folders.insert(folder_of(&path)) {
                create_folder(&folder_of(&path))?;
            }
            write_staged(&path, bytes)?;
        }
        folders.iter().try_for_each(|folder| sync_folder(folder))
    }
}

impl Drop for ResultFolder {
    fn drop(&mut self) {
        // the lock file is removed first; a folder is removed only if it is empty, so that no result and no other
        // lock is lost
        self.lock = None;
        let _ = std::fs::remove_dir(self.folder.join(STATE));
        let _ = std::fs::remove_dir(&self.folder);
    }
}

/// Removes the file `state` with the state of an unfinished search. Its folder is removed too if it is then empty.
///
/// # Errors
/// The state cannot be removed.
pub(super) fn settle(state: &Path) -> Result<(), Failure> {
    remove(state)?;
    // a folder that is not empty is in use
    let _ = std::fs::remove_dir(folder_of(state));
    Ok(())
}

/// The path of the file that saves the state of an unfinished search, in a folder of results. `name` distinguishes the
/// searches that save their states in this folder.
pub(super) fn unfinished_in(folder: &Path, name: &str) -> PathBuf {
    folder.join(STATE).join(format!("{name}{ENDING}"))
}

/// Whether a process is writing the folder at the moment.
pub(super) fn is_being_written(folder: &Path) -> bool {
    Lock::is_held(&folder.join(STATE).join(LOCK))
}

/// Completes a result whose writer died after the new result began to count. A reader calls this function first.
///
/// # Errors
/// Another process is writing the folder at the moment, the folder cannot be written, or its unfinished work is reached
/// over a symbolic link.
pub(super) fn complete(folder: &Path) -> Result<(), Failure> {
    let state = folder.join(STATE);
    refuse_links(&state)?;
    let (mut waits, wait) = READER_WAITS;
    while state.join("ready").exists() {
        match Lock::take(&state.join(LOCK), folder) {
            Ok(_lock) => {
                return roll_forward(folder).map_err(|e| {
                    Failure::File(format!(
                        "{}: the writing of this result was interrupted and cannot be completed: {e}; make the folder \
                         writable and try again",
                        folder.display()
                    ))
                });
            }
            Err(Failure::Locked(_)) if waits > 0 => {
                waits -= 1;
                std::thread::sleep(wait);
            }
            Err(failure) => return Err(failure),
        }
    }
    Ok(())
}

/// Refuses unfinished work that is reached over a symbolic link. `state` is the folder for it.
fn refuse_links(state: &Path) -> Result<(), Failure> {
    let inside = [LOCK, "next", "ready"].map(|name| state.join(name));
    refuse_link(state).and_then(|()| inside.iter().try_for_each(|path| refuse_link(path)))
}

/// Moves the files of the new result to their places. Files that were moved before are not in `.armwright/ready` any
/// more. Therefore the function can be interrupted at any point and repeated. Nothing is moved if a symbolic link would
/// have to be followed.
fn roll_forward(folder: &Path) -> io::Result<()> {
    let ready = folder.join(STATE).join("ready");
    if !ready.exists() {
        return Ok(());
    }
    // the manifest is moved last, so without it everything has been moved already
    if let Some(manifest) = MANIFESTS.into_iter().find(|name| has_manifest(&ready, name)) {
        let read =
            |folder: &Path| Earlier::read(folder, manifest).map_err(|e| io::Error::other(e.to_string()));
        let (new, old) = (read(&ready)?, read(folder)?);
        let moved: Vec<&String> = new.names().filter(|name| is_there(&ready.join(name))).collect();
        new.names().try_for_each(|name| refuse_strange_parents(&ready, name))?;
        for name in moved.iter().copied().chain([&manifest.to_string()]) {
            refuse_strange_parents(folder, name)?;
            refuse_link(&ready.join(name)).map_err(|e| io::Error::other(e.to_string()))?;
        }
        let mut changed = BTreeSet::new();
        for name in moved {
            let target = folder.join(name);
            create_folder(&folder_of(&target))?;
            rename(&ready.join(name), &target)?;
            changed.insert(folder_of(&target));
        }
        for name in old.names().filter(|name| !new.has(name, manifest)) {
            remove_listed(folder, name)?;
        }
        changed.iter().try_for_each(|folder| sync_folder(folder))?;
        rename(&ready.join(manifest), &folder.join(manifest))?;
        sync_folder(folder)?;
    }
    sweep(&ready)
}

/// Removes a file of an earlier result, and its folders if they are then empty. No file is removed whose path leads
/// over a symbolic link, because such a file is not part of the result.
fn remove_listed(folder: &Path, name: &str) -> io::Result<()> {
    let path = folder.join(name);
    if has_strange_parent(folder, name) || !is_there(&path) || path.is_dir() && !path.is_symlink() {
        return Ok(());
    }
    remove_file(&path)?;
    let parents = Path::new(name).ancestors().skip(1).filter(|parent| !parent.as_os_str().is_empty());
    for parent in parents {
        let _ = std::fs::remove_dir(folder.join(parent));
    }
    Ok(())
}

/// Whether something exists under the name `name` that is not a file of the earlier result, so that it must not be
/// replaced.
fn is_foreign(folder: &Path, name: &str, earlier: &Earlier, manifest: &str) -> bool {
    let path = folder.join(name);
    let is_folder = path.is_dir() && !path.is_symlink();
    has_strange_parent(folder, name) || is_folder || is_there(&path) && !earlier.has(name, manifest)
}

/// Removes a folder for unfinished work if it exists. Symbolic links in it are not followed.
fn sweep(folder: &Path) -> io::Result<()> {
    match fs_err::remove_dir_all(folder) {
        Err(e) if e.kind() != io::ErrorKind::NotFound => Err(e),
        _ => Ok(()),
    }
}
