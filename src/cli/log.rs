//! Messages and progress on standard error, in the form that the user asks for. If standard error is closed or full,
//! the work continues all the same.

use super::failure::Failure;
use super::write::say;
use clap::ValueEnum;
use serde_json::{Value, json};
use std::ffi::OsString;
use std::io::IsTerminal;

/// The form of messages and progress.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum LogForm {
    /// Sentences, and a bar on a terminal
    Text,
    /// One JSON object in each line: the event, with its numbers or its message
    Json,
}

/// A log: the form in which messages and progress are printed, and whether they are printed at all.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Log {
    form: LogForm,
    is_quiet: bool,
}

impl Default for Log {
    /// A log that prints all messages as sentences.
    fn default() -> Self {
        Self::new(LogForm::Text, false)
    }
}

impl Log {
    /// A log in the given form. If `is_quiet`, it prints errors only.
    pub(super) fn new(form: LogForm, is_quiet: bool) -> Self {
        Self { form, is_quiet }
    }

    /// The log that the words of a command line ask for. This also works for a command line that has other mistakes.
    pub fn asked_by(words: impl IntoIterator<Item = OsString>) -> Self {
        let words: Vec<OsString> = words.into_iter().take_while(|word| word != "--").collect();
        let is_json = words.iter().any(|word| word == "--log=json")
            || words.windows(2).any(|pair| pair[0] == "--log" && pair[1] == "json");
        Self::new(if is_json { LogForm::Json } else { LogForm::Text }, false)
    }

    /// Prints why a command line is wrong.
    pub fn wrong_usage(self, why: &clap::Error) {
        match self.form {
            // if standard error cannot be written, the exit code is all that the user gets
            LogForm::Text => drop(why.print()),
            LogForm::Json => {
                let text = why.render().to_string();
                self.error(&Failure::Usage(text.trim().trim_start_matches("error: ").into()));
            }
        }
    }

    /// Whether progress is shown as a bar that is redrawn in place. Only a terminal can do this.
    pub(super) fn draws(self) -> bool {
        self.form == LogForm::Text && !self.is_quiet && std::io::stderr().is_terminal()
    }

    /// Prints how far a search is: the text `words`, or a JSON object with the name `event` and `numbers`, as the form
    /// of the log says.
    pub(super) fn progress(self, event: &str, words: &str, numbers: Value) {
        if self.is_quiet {
            return;
        }
        match self.form {
            LogForm::Text => say(&format!("{words}\n")),
            LogForm::Json => {
                let mut object = json!({"event": event});
                for (key, value) in numbers.as_object().into_iter().flatten() {
                    object[key] = value.clone();
                }
                say(&format!("{object}\n"));
            }
        }
    }

    /// Prints a message for the user.
    pub(super) fn note(self, words: &str) {
        self.progress("note", words.trim_end(), json!({"message": words.trim_end()}));
    }

    /// Prints a warning, even if the log is quiet.
    pub(super) fn warning(self, words: &str) {
        match self.form {
            LogForm::Text => say(&format!("warning: {words}\n")),
            LogForm::Json => say(&format!("{}\n", json!({"event": "warning", "message": words}))),
        }
    }

    /// Prints why a verb failed, even if the log is quiet.
    pub fn error(self, failure: &Failure) {
        match self.form {
            LogForm::Text => say(&format!("error: {failure}\n")),
            LogForm::Json => {
                let object = json!({"event": "error", "exit_code": failure.exit_code(), "message": failure.to_string()});
                say(&format!("{object}\n"));
            }
        }
    }
}
