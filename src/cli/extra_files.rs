//! Files that are written in addition to a front. Each is made separately, so that the others are still written if
//! one fails.

use super::log::Log;
use super::manifest::{Files, another_stands};
use super::stop::stop_if_wanted;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Files that are written in addition to a front, and the names of those that could not be made.
#[derive(Default)]
pub(super) struct ExtraFiles {
    /// Name and contents of each file.
    pub files: Files,
    /// One entry for each file that could not be made: its name and the reason.
    pub missing: Vec<String>,
}

impl ExtraFiles {
    /// Calls `make`, which computes the file or files named `what`, and returns its result. If `make` panics, the panic
    /// is recorded in `missing` and the result is `None`, so that the other files are still written.
    pub(super) fn make<T>(&mut self, what: &str, make: impl FnOnce() -> T) -> Option<T> {
        // `make` only reads the results of the search, so a panic leaves nothing half changed behind
        let made = catch_unwind(AssertUnwindSafe(|| {
            fail_if_wanted(what);
            stop_if_wanted(what);
            make()
        }));
        made.map_err(|panic| self.missing.push(format!("{what}: {}", words_of(&*panic)))).ok()
    }

    /// One entry for each file that could not be made, and one for each name in `taken`, under which nothing was
    /// written because a file that is not part of a result has this name.
    pub(super) fn missing_with(&self, taken: &[String]) -> Vec<String> {
        self.missing.iter().cloned().chain(taken.iter().map(|name| another_stands(name))).collect()
    }

    /// Adds the file `name` with the contents that `make` computes. If `make` panics, the file is recorded in `missing`
    /// instead.
    pub(super) fn file(&mut self, name: &str, make: impl FnOnce() -> Vec<u8>) {
        let bytes = self.make(name, make);
        self.files.extend(bytes.map(|bytes| (name.to_string(), bytes)));
    }
}

/// The message of a caught panic, as the text of an internal error.
pub(super) fn words_of(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
    format!("internal error: {}", text.unwrap_or("it has no message"))
}

/// Prints a warning for each file that was not written because its name is `taken` by a file of someone else.
pub(super) fn say_taken(taken: &[String], log: Log) {
    say_missing(&ExtraFiles::default().missing_with(taken), log);
}

/// Prints a warning for each file that was not written.
pub(super) fn say_missing(missing: &[String], log: Log) {
    for what in missing {
        log.warning(&format!("not written: {what}"));
    }
}

/// Panics if a test asks for it: if the environment variable `ARMWRIGHT_FAULT` is `panic:` followed by `what`, such as
/// `panic:summary.md`. Only builds with the feature `faults` do so.
#[cfg(feature = "faults")]
fn fail_if_wanted(what: &str) {
    let wanted = std::env::var("ARMWRIGHT_FAULT").unwrap_or_default();
    assert!(wanted.strip_prefix("panic:") != Some(what), "a fault for a test");
}

#[cfg(not(feature = "faults"))]
fn fail_if_wanted(_: &str) {}
