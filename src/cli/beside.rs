//! What goes with a front: made piece by piece, so that a piece that fails costs no other.

use super::manifest::Files;
use super::write::say;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Files that go with a front, and the pieces that could not be made.
#[derive(Default)]
pub(super) struct Beside {
    pub files: Files,
    /// What is missing, and why.
    pub missing: Vec<String>,
}

impl Beside {
    /// What `make` returns. If it panics, that is noted and there is nothing.
    pub(super) fn make<T>(&mut self, what: &str, make: impl FnOnce() -> T) -> Option<T> {
        // a piece only reads what was found, so that nothing half-done is seen afterwards
        let made = catch_unwind(AssertUnwindSafe(|| {
            fail_if_wanted(what);
            make()
        }));
        made.map_err(|panic| self.missing.push(format!("{what}: {}", words_of(&*panic)))).ok()
    }

    /// Adds a file, unless making it panics.
    pub(super) fn file(&mut self, name: &str, make: impl FnOnce() -> Vec<u8>) {
        let bytes = self.make(name, make);
        self.files.extend(bytes.map(|bytes| (name.to_string(), bytes)));
    }
}

/// The message of a panic.
pub(super) fn words_of(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
    format!("internal error: {}", text.unwrap_or("it has no message"))
}

/// Why a file is missing where it would have replaced one that is no part of the result.
pub(super) fn another_stands(name: &str) -> String {
    format!("{name}: a file that is no part of the result stands there")
}

/// Warns of what is missing.
pub(super) fn say_missing(missing: &[String]) {
    for what in missing {
        say(&format!("warning: not written: {what}\n"));
    }
}

/// Fails where a test wants it (`ARMWRIGHT_FAULT=panic:summary.md`), in builds with debug assertions.
#[cfg(debug_assertions)]
fn fail_if_wanted(what: &str) {
    let wanted = std::env::var("ARMWRIGHT_FAULT").unwrap_or_default();
    assert!(wanted.strip_prefix("panic:") != Some(what), "a fault for a test");
}

#[cfg(not(debug_assertions))]
fn fail_if_wanted(_: &str) {}
