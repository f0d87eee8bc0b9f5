//! The saved state of an unfinished search in a folder of results. It is written every few seconds, and removed when
//! the search is finished. The same command reads it if it is given again.
//!
//! The file has a line of JSON that identifies the search, and then the state. It is written under a temporary name,
//! synced to disk and renamed. Therefore the file is complete whenever the process ends.

use super::failure::Failure;
use super::log::Log;
use super::manifest::hash;
use crate::report::whole_file::{create_folder, folder_of, remove_file, write_whole};
use crate::search::resume::{KeepState, Resume};
use serde_json::{Value, json};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Shortest time between two saved states.
const KEEP_EVERY: Duration = Duration::from_secs(2);
/// Running time divided by the time that may be spent on saving states. If saving takes more than this share (1/200),
/// the time between two saves is made longer.
const SAVING_SHARE_OF_TIME: u32 = 200;
/// Ending of the file name of a saved state.
pub(super) const ENDING: &str = ".unfinished";
/// Keys that must be equal in the saved state and in the search that is to be continued. Each comes with the word for
/// it in messages.
const SAME: [(&str, &str); 4] = [
    ("study_hash", "study"),
    ("catalogs_hash", "catalogs"),
    ("tool_version", "version of armwright"),
    ("flags", "search"),
];

/// A search whose state is saved.
pub(super) struct Unfinished {
    /// File of the state.
    path: PathBuf,
    /// Keys that identify the search.
    search: Value,
    /// The state that an earlier process saved; `None` if there is none.
    from: Option<Vec<u8>>,
    /// Time that earlier processes spent on the search.
    earlier: Duration,
    /// Start of this process's search.
    started: Instant,
    due: Mutex<Due>,
    log: Log,
}

struct Due {
    at: Instant,
    /// Moment at which a state was last found to be due; `None` if none is due. The time from then until the state is
    /// saved counts as the cost of saving.
    since: Option<Instant>,
    every: Duration,
    has_failed: bool,
}

/// What is done with a state that an earlier process saved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Earlier {
    /// The search goes on from it.
    Read,
    /// It is removed, and the search begins anew.
    Removed,
}

impl Unfinished {
    /// Opens the file of a state. If it exists, the state is read or removed, as `earlier` says. `search` identifies
    /// the search by the keys `study_hash`, `catalogs_hash`, `tool_version` and `flags`.
    ///
    /// # Errors
    /// The state belongs to another search, is damaged, or cannot be read.
    pub(super) fn open(path: &Path, search: Value, earlier: Earlier, log: Log) -> Result<Self, Failure> {
        let every = keep_every();
        let due = Mutex::new(Due { at: Instant::now() + every, since: None, every, has_failed: false });
        let (path, started) = (path.to_path_buf(), Instant::now());
        let mut out = Self { path, search, from: None, earlier: Duration::ZERO, started, due, log };
        match std::fs::read(&out.path) {
            Err(e) if e.kind() == ErrorKind::NotFound => return Ok(out),
            Err(e) => return Err(Failure::file(&out.path, "read", &e)),
            Ok(_) if earlier == Earlier::Removed => remove(&out.path)?,
            Ok(bytes) => out.go_on_from(&bytes)?,
        }
        Ok(out)
    }

    /// Like [`open`](Self::open), but removes a damaged state, or one of another search, and begins the search anew.
    ///
    /// # Errors
    /// The state cannot be read or removed.
    pub(super) fn open_or_begin(path: &Path, search: &Value, log: Log) -> Result<Self, Failure> {
        let open = |earlier| Self::open(path, search.clone(), earlier, log);
        open(Earlier::Read).or_else(|_| open(Earlier::Removed))
    }

    fn go_on_from(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        let (head, state) = parts(bytes).ok_or_else(|| self.damaged())?;
        let other = |(key, _): &&(&str, &str)| head[*key] != self.search[*key];
        let other: Vec<&str> = SAME.iter().filter(other).map(|(_, what)| *what).collect();
        if !other.is_empty() {
            return Err(Failure::Usage(format!(
                "{} holds an unfinished search with another {}; give --fresh to discard it and begin anew, the same command \
                 as before to go on, or another folder with --out",
                self.folder(),
                other.join(", another ")
            )));
        }
        let earlier_s = head["elapsed_s"].as_f64().unwrap_or_default();
        self.earlier = Duration::try_from_secs_f64(earlier_s).unwrap_or_default();
        self.from = Some(state.to_vec());
        self.log.note(&format!("goes on where an earlier run was after {earlier_s:.1} s"));
        Ok(())
    }

    /// The error that is reported if the saved state is damaged.
    pub(super) fn damaged(&self) -> Failure {
        Failure::File(format!(
            "{}: the state of the unfinished search is damaged; give --fresh to discard it and begin anew",
            self.path.display()
        ))
    }

    fn due(&self) -> MutexGuard<'_, Due> {
        self.due.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Path of the folder of results, for messages.
    fn folder(&self) -> std::path::Display<'_> {
        self.path.ancestors().nth(2).unwrap_or(&self.path).display()
    }

    /// The state from which to continue, and the means to save further states.
    pub(super) fn resume(&self) -> Resume<'_> {
        Resume { from: self.from.as_deref(), keeper: self }
    }

    /// The time at which the search would have started if this process had done all of it. The time of earlier
    /// processes is thus counted.
    pub(super) fn started(&self) -> Instant {
        self.started.checked_sub(self.earlier).unwrap_or(self.started)
    }
}

impl KeepState for Unfinished {
    fn is_due(&self) -> bool {
        let (now, mut due) = (Instant::now(), self.due());
        due.since = (now >= due.at).then_some(now);
        due.since.is_some()
    }

    fn keep(&self, state: &[u8]) {
        let begun = self.due().since.take().unwrap_or_else(Instant::now);
        let mut head = self.search.clone();
        head["elapsed_s"] = json!(self.started().elapsed().as_secs_f64());
        head["hash"] = json!(hash(state));
        let folder = folder_of(&self.path);
        let there = if folder.is_dir() { Ok(()) } else { create_folder(&folder) };
        let written =
            there.and_then(|()| write_whole(&self.path, &[format!("{head}\n").as_bytes(), state].concat()));
        let mut due = self.due();
        due.at = Instant::now() + due.every.max(begun.elapsed() * SAVING_SHARE_OF_TIME);
        if let Err(e) = written
            && !std::mem::replace(&mut due.has_failed, true)
        {
            let words = "the search goes on, but a run after this one would begin before this point";
            self.log.note(&format!("cannot write {}: {e}; {words}", self.path.display()));
        }
    }
}

/// The line of JSON and the saved state, taken from the bytes of a file; `None` if the file is damaged.
fn parts(bytes: &[u8]) -> Option<(Value, &[u8])> {
    let end = bytes.iter().position(|byte| *byte == b'\n')?;
    let head: Value = serde_json::from_slice(&bytes[..end]).ok()?;
    let state = &bytes[end + 1..];
    (head["hash"].as_str()? == hash(state)).then_some((head, state))
}

/// Removes a saved state, if it exists.
///
/// # Errors
/// The file cannot be removed.
pub(super) fn remove(path: &Path) -> Result<(), Failure> {
    match remove_file(path) {
        Err(e) if e.kind() != ErrorKind::NotFound => Err(Failure::file(path, "remove", &e)),
        _ => Ok(()),
    }
}

/// Time between two saved states. The environment variable `ARMWRIGHT_KEEP_EVERY_MS` may set another time, such as a
/// longer one for a slow shared disk or a shorter one for a test.
fn keep_every() -> Duration {
    let asked = std::env::var("ARMWRIGHT_KEEP_EVERY_MS").ok();
    asked.and_then(|ms| ms.parse().ok()).map_or(KEEP_EVERY, Duration::from_millis)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn search(study: &str) -> Value {
        json!({"study_hash": study, "catalogs_hash": "c", "tool_version": "1", "flags": {"search": "exact"}})
    }

    #[test]
    fn a_state_is_read_by_the_same_search_alone_and_only_if_it_is_whole() {
        let here = tempfile::tempdir().expect("a folder");
        let path = here.path().join("x.unfinished");
        let open = |study: &str, earlier| Unfinished::open(&path, search(study), earlier, Log::default());
        let first = open("a", Earlier::Read).expect("nothing there");
        assert!(first.from.is_none() && !first.is_due());
        first.keep(b"one\ntwo");
        assert_eq!(open("a", Earlier::Read).expect("the same").from.as_deref(), Some(&b"one\ntwo"[..]));
        let refused = open("b", Earlier::Read).err().expect("another study");
        assert!(refused.exit_code() == 2 && refused.to_string().contains("--fresh"), "{refused}");
        let whole = std::fs::read(&path).expect("a state");
        for cut in 0..whole.len() {
            std::fs::write(&path, &whole[..cut]).expect("written");
            assert_eq!(open("a", Earlier::Read).err().expect("damaged").exit_code(), 7, "{cut} bytes");
        }
        assert!(open("b", Earlier::Removed).expect("anew").from.is_none());
        assert!(!path.exists());
    }
}
