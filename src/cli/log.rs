//! What the program says on standard error while it works, in the form that was asked for. A standard error that is closed or
//! full never ends the work.

use super::failure::Failure;
use clap::ValueEnum;
use serde_json::{Value, json};
use std::io::{IsTerminal, Write};

/// The form of messages and progress.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum LogForm {
    /// Sentences, and a bar on a terminal
    Text,
    /// A JSON object a line: event, and what belongs to it
    Json,
}

/// Where messages and progress go.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Log {
    form: LogForm,
    is_quiet: bool,
}

impl Log {
    /// A log in a form. A quiet one has errors alone.
    pub(super) fn new(form: LogForm, is_quiet: bool) -> Self {
        Self { form, is_quiet }
    }

    /// Whether progress is a bar that is drawn anew, which only a terminal can do.
    pub(super) fn draws(self) -> bool {
        self.form == LogForm::Text && !self.is_quiet && std::io::stderr().is_terminal()
    }

    /// Says how far a search is: a line of words, or an event with its numbers.
    pub(super) fn progress(self, event: &str, words: &str, numbers: Value) {
        if self.is_quiet {
            return;
        }
        match self.form {
            LogForm::Text => line(words),
            LogForm::Json => {
                let mut object = json!({"event": event});
                for (key, value) in numbers.as_object().into_iter().flatten() {
                    object[key] = value.clone();
                }
                line(&object.to_string());
            }
        }
    }

    /// Says something that a user should know.
    pub(super) fn note(self, words: &str) {
        self.progress("note", words.trim_end(), json!({"message": words.trim_end()}));
    }

    /// Says why a verb failed, however quiet the log is.
    pub fn error(self, failure: &Failure) {
        match self.form {
            LogForm::Text => line(&format!("error: {failure}")),
            LogForm::Json => {
                let object = json!({"event": "error", "exit_code": failure.exit_code(), "message": failure.to_string()});
                line(&object.to_string());
            }
        }
    }
}

/// Writes a line in one piece; an error is no reason to end.
fn line(words: &str) {
    let _ = std::io::stderr().write_all(format!("{words}\n").as_bytes());
}
