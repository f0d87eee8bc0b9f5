//! Runs the program for the tests, and returns its exit code and what it printed.

use std::path::Path;
use std::process::Command;

/// Whether the program can stop or find a full disk at a chosen moment (`ARMWRIGHT_FAULT`). If not, the test that asks
/// is skipped, and this is said.
pub(crate) fn has_faults() -> bool {
    if !cfg!(feature = "faults") {
        eprintln!("SKIPPED faults at chosen moments: needs --features faults, which scripts/test gives");
    }
    cfg!(feature = "faults")
}

/// The program with these words, in a folder.
pub(crate) fn command(folder: &Path, words: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_armwright"));
    command.current_dir(folder).args(words);
    command
}

/// Exit code, -1 after a signal, and everything that was said.
pub(crate) fn said(command: &mut Command) -> (i32, String) {
    let output = command.output().expect("it runs");
    let text = [output.stdout, output.stderr].concat();
    (output.status.code().unwrap_or(-1), String::from_utf8_lossy(&text).into_owned())
}

/// Exit code, and everything that the program said to these words in a folder.
pub(crate) fn armwright(folder: &Path, words: &[&str]) -> (i32, String) {
    said(&mut command(folder, words))
}
