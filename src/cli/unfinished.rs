//! The state of an unfinished search in a folder of results: written every few seconds, read by the same command when it is
//! given again, removed when the search is done.
//!
//! The file is a line of JSON, which says what search it is of, and the state. It is written beside its place, synced and
//! renamed, so that whatever ends the process leaves a whole state.

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

/// Least time between two states.
const KEEP_EVERY: Duration = Duration::from_secs(2);
/// Keeping states may take at most one part in this of the time.
const SHARE: u32 = 200;
/// How a file of a state ends.
pub(super) const ENDING: &str = ".unfinished";
/// What two searches of one study may differ in, and what it is called in messages.
const SAME: [(&str, &str); 4] = [
    ("study_hash", "study"),
    ("catalogs_hash", "catalogs"),
    ("tool_version", "version of armwright"),
    ("flags", "search"),
];

/// A search whose state is kept.
pub(super) struct Unfinished {
    path: PathBuf,
    search: Value,
    from: Option<Vec<u8>>,
    earlier: Duration,
    started: Instant,
    due: Mutex<Due>,
    log: Log,
}

struct Due {
    at: Instant,
    /// When a state was found to be due that is not kept yet: from then on it costs time.
    since: Option<Instant>,
    every: Duration,
    has_failed: bool,
}

impl Unfinished {
    /// Reads the state at `path`, if there is one. `search` says what is searched, in the keys `study_hash`, `catalogs_hash`,
    /// `tool_version` and `flags`. With `is_fresh` a state is removed and not read.
    ///
    /// # Errors
    /// The state is of another search, is damaged, or cannot be read.
    pub(super) fn open(path: &Path, search: Value, is_fresh: bool, log: Log) -> Result<Self, Failure> {
        let every = keep_every();
        let due = Mutex::new(Due { at: Instant::now() + every, since: None, every, has_failed: false });
        let (path, started) = (path.to_path_buf(), Instant::now());
        let mut out = Self { path, search, from: None, earlier: Duration::ZERO, started, due, log };
        match std::fs::read(&out.path) {
            Err(e) if e.kind() == ErrorKind::NotFound => return Ok(out),
            Err(e) => return Err(Failure::file(&out.path, "read", &e)),
            Ok(_) if is_fresh => remove(&out.path)?,
            Ok(bytes) => out.go_on_from(&bytes)?,
        }
        Ok(out)
    }

    /// As [`open`](Self::open), but a state of another search or a damaged one is removed, and the search begins.
    ///
    /// # Errors
    /// The state cannot be read or removed.
    pub(super) fn open_or_begin(path: &Path, search: &Value, log: Log) -> Result<Self, Failure> {
        Self::open(path, search.clone(), false, log).or_else(|_| Self::open(path, search.clone(), true, log))
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

    /// The state cannot be used.
    pub(super) fn damaged(&self) -> Failure {
        Failure::File(format!(
            "{}: the state of the unfinished search is damaged; give --fresh to discard it and begin anew",
            self.path.display()
        ))
    }

    fn due(&self) -> MutexGuard<'_, Due> {
        self.due.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The folder of results, for messages.
    fn folder(&self) -> std::path::Display<'_> {
        self.path.ancestors().nth(2).unwrap_or(&self.path).display()
    }

    /// The state to go on from, and who keeps the next ones.
    pub(super) fn resume(&self) -> Resume<'_> {
        Resume { from: self.from.as_deref(), keeper: self }
    }

    /// When the search would have started if one process had done it all.
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
        due.at = Instant::now() + due.every.max(begun.elapsed() * SHARE);
        if let Err(e) = written
            && !std::mem::replace(&mut due.has_failed, true)
        {
            let words = "the search goes on, but a run after this one would begin before this point";
            self.log.note(&format!("cannot write {}: {e}; {words}", self.path.display()));
        }
    }
}

/// The head and the state of a file; `None` if it is damaged.
fn parts(bytes: &[u8]) -> Option<(Value, &[u8])> {
    let end = bytes.iter().position(|byte| *byte == b'\n')?;
    let head: Value = serde_json::from_slice(&bytes[..end]).ok()?;
    let state = &bytes[end + 1..];
    (head["hash"].as_str()? == hash(state)).then_some((head, state))
}

/// Removes a state, if it is there.
///
/// # Errors
/// It cannot be removed.
pub(super) fn remove(path: &Path) -> Result<(), Failure> {
    match remove_file(path) {
        Err(e) if e.kind() != ErrorKind::NotFound => Err(Failure::file(path, "remove", &e)),
        _ => Ok(()),
    }
}

/// Time between two states, unless the environment asks for another one: a slow shared disk is written less often, and a test
/// writes more often.
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
        let open = |study: &str, fresh| Unfinished::open(&path, search(study), fresh, Log::default());
        let first = open("a", false).expect("nothing there");
        assert!(first.from.is_none() && !first.is_due());
        first.keep(b"one\ntwo");
        assert_eq!(open("a", false).expect("the same").from.as_deref(), Some(&b"one\ntwo"[..]));
        let refused = open("b", false).err().expect("another study");
        assert!(refused.exit_code() == 2 && refused.to_string().contains("--fresh"), "{refused}");
        let whole = std::fs::read(&path).expect("a state");
        for cut in 0..whole.len() {
            std::fs::write(&path, &whole[..cut]).expect("written");
            assert_eq!(open("a", false).err().expect("damaged").exit_code(), 7, "{cut} bytes");
        }
        assert!(open("b", true).expect("anew").from.is_none());
        assert!(!path.exists());
    }
}
